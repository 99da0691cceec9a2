//! Derivatives of eigenvalues beside differences in numbers of 40 digits, of models that `sensitivity.py` assembles.

use crate::parallel::on_each;
use crate::program::{assert_refused, folder, run, text};
use crate::python;
use std::fs;
use std::path::Path;
use std::process::Command;

const PROGRAM: &str = env!("CARGO_BIN_EXE_amontons-stability");

/// The scenes folder of the repository.
fn scenes() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// A scene in a contact state, other options of the command, the parameters that are compared, and values of parameters.
struct Case<'a> {
    scene: &'a str,
    states: &'a [&'a str],
    options: &'a [&'a str],
    parameters: &'a str,
    values: &'a [&'a str],
}

impl Case<'_> {
    fn compare(&self) {
        let folder = folder();
        let scene = scenes().join(self.scene);
        let state = self.states.join("-");
        let mut arguments =
            vec!["sensitivity", scene.to_str().unwrap(), "--format", "json", "--state", &state];
        arguments.extend(self.options);
        arguments.extend(self.values.iter().flat_map(|value| ["--set", *value]));
        let output = run(PROGRAM, folder.path(), &arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let found = folder.path().join("found.json");
        fs::write(&found, &output.stdout).unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/analyses/sensitivity.py");
        let mut command = Command::new(python::interpreter());
        command.arg(script).arg(&scene).arg(self.states.join(",")).arg(&found);
        let output = command.arg(self.parameters).args(self.values).output().unwrap();
        let said = text(&output.stdout);
        assert!(output.status.success(), "{} {state}: {}", self.scene, text(&output.stderr));
        let count: usize = said.split(' ').next().and_then(|count| count.parse().ok()).unwrap();
        assert!(count > 5, "{} {state}: {said}", self.scene);
    }
}

#[test]
fn derivatives_are_the_limits_of_differences_in_forty_digits() {
    let case =
        |scene, states, options| Case { scene, states, options, parameters: "all", values: &[] };
    case("set1.toml", &["Sl", "Sl"], &["--critical", "0.9:1.4"]).compare();
    case("set2.toml", &["Sl", "St"], &[]).compare();
    case("disc_brake.toml", &["Sl", "R-Sl"], &["--critical", "0.3:1"]).compare();
    case("effects/stribeck.toml", &["Sl"], &[]).compare();
    case("hoffmann.toml", &["Sl"], &["--critical", "0.1:0.5"]).compare();
    // Two modes merge at µ = 1.94137371 and at µ = 0.55051.
    for value in ["friction.coefficient=1.9413756", "friction.coefficient=1.941373710"] {
        let near = case("set1.toml", &["Sl", "Sl"], &["--frequencies", "170:180"]);
        Case { values: &[value], ..near }.compare();
    }
    let undamped = case("disc_brake.toml", &["Sl", "R-Sl"], &["--critical", "0.3:1"]);
    Case { values: &["damping.beta=0"], ..undamped }.compare();
}

#[test]
#[ignore = "long: all contact states, and double eigenvalues of a ring"]
fn derivatives_of_all_contact_states_are_the_limits_of_differences() {
    const STATES: [&str; 4] = ["Sl", "R-Sl", "St", "Dt"];
    let pairs = STATES.iter().flat_map(|first| STATES.map(|second| [*first, second]));
    let all = ["set1.toml", "set2.toml", "disc_brake.toml"];
    let all: Vec<_> = pairs.flat_map(|states| all.map(|scene| (scene, states))).collect();
    on_each(&all, |(scene, states)| {
        Case { scene, states, options: &[], parameters: "all", values: &[] }.compare();
    });
    let parameters = "friction.coefficient,damping.beta,module[1].k5,module[3].m2,slider.angle";
    Case {
        scene: "ring12.toml",
        states: &["Sl"; 12],
        options: &["--frequencies", "170:180"],
        parameters,
        values: &[],
    }
    .compare();
}

#[test]
fn requests_that_have_no_answer_are_refused_with_what_would_be_right() {
    let folder = folder();
    let ask = |arguments: &[&str]| run(PROGRAM, folder.path(), arguments);
    let wrong = ask(&["sensitivity", "set1", "--frequencies", "1000:2000"]);
    assert_refused(&wrong, 2, &["no mode of the state Sl-Sl has a frequency from 1000 to 2000 Hz"]);
    let wrong = ask(&["sensitivity", "set1", "--plot", "bars.pdf"]);
    assert_refused(&wrong, 1, &["bars.pdf", "svg"]);
    let stands = ["sensitivity", "set1", "--set", "slider.velocity=0"];
    assert_refused(&ask(&stands), 3, &["no surface moves"]);
    let drawn = ask(&["sensitivity", "set1", "--plot", "bars.svg", "--critical", "1:1.3"]);
    assert!(drawn.status.success());
    let svg = fs::read_to_string(folder.path().join("bars.svg")).unwrap();
    for words in ["Mode at 219.38 Hz", "Critical µ = 1.18361", "module[1].k5"] {
        assert!(svg.contains(words), "{words}");
    }
}
