//! Importers of others on FMUs of ours: FMPy, fmi-rs, libcosimpy and ecospy run Set 1 and the ring of twelve, alone and
//! coupled to the drive, and get the doubles that a run without an importer has. What runs are the examples in
//! `examples/importers/`; each says itself whether its run is equal, and must deny it of wrong ones.

use crate::coupled;
use crate::program;
use crate::python;
use clap::Parser;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

const AMONTONS: &str = env!("CARGO_BIN_EXE_amontons");
/// Scenes to be run, each with its end and communication step (s) and a start value that makes contacts stick and slip.
/// 3e-4 s is less than 300,000 ns by rounding.
const RUNS: [[&str; 4]; 2] = [
    ["set1", "0.1", "1e-4", "initial.module[1].v2=0.3"],
    ["ring12", "0.018", "3e-4", "initial.module[7].v1=-0.5"],
];

/// With what a scene is run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Alone,
    Coupled,
    /// Coupled, with rates of change exchanged too.
    WithRates,
}

/// The ways of importers that hand no derivatives on.
const HELD: &[Way] = &[Way::Alone, Way::Coupled];

/// FMUs, and runs without an importer, in a folder of their own.
struct Bench {
    folder: TempDir,
    /// The time at which the coupled run without an importer reads outputs: before or after inputs.
    rows: &'static str,
}

impl Bench {
    fn new(rows: &'static str) -> Self {
        Self { folder: program::folder(), rows }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn amontons(&self, arguments: &[&str]) {
        let output = program::run(AMONTONS, self.folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", program::text(&output.stderr));
    }

    /// Writes `set1.fmu` and so on.
    fn export(&self, scene: &str) -> String {
        let file = format!("{scene}.fmu");
        self.amontons(&["export", scene, "-o", &file]);
        file
    }

    /// The arguments of an example for a run, and those of the CSV file that it is to be compared with.
    fn prepare(&self, [scene, stop_time, interval, set]: [&str; 4], way: Way) -> Vec<String> {
        let mut arguments = vec![self.export(scene)];
        let reference = format!("{scene}-{way:?}.csv");
        let experiment = ["--stop-time", stop_time, "--set", set];
        if way != Way::Alone {
            let rates = (way == Way::WithRates).then_some("--rates");
            arguments.extend(["--drive".into(), self.export("drive")]);
            arguments.extend(rates.map(str::to_owned));
            let output = self.path(&reference);
            let start = ["coupled", scene, "drive", "--interval", interval, "--rows", self.rows];
            let end = ["-o", output.to_str().unwrap()];
            let coupled = start.into_iter().chain(rates).chain(experiment).chain(end);
            coupled::run(&coupled::Arguments::parse_from(coupled)).unwrap();
        } else {
            let start = ["simulate", scene, "--output-interval", interval, "-o", &reference];
            self.amontons(&start.into_iter().chain(experiment).collect::<Vec<_>>());
        }
        let rest = ["--interval", interval, "--compare", &reference];
        arguments.extend(experiment.into_iter().chain(rest).map(str::to_owned));
        arguments
    }

    /// The rows of a run without an importer, as text.
    fn rows(&self, reference: &str) -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(self.path(reference)).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    }
}

/// The example of fmi-rs, a Rust project by itself.
const FMI_RS: &str = "fmi-rs";

/// The program of that project, which is built once.
static FMI_RS_PROGRAM: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmi-rs");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--release", "--locked", "--quiet", "--manifest-path"]);
    cargo.arg(examples().join("fmi-rs/Cargo.toml")).arg("--target-dir").arg(&folder);
    assert!(cargo.status().unwrap().success(), "{cargo:?}");
    folder.join("release/fmi-rs-example")
});

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/importers")
}

/// Runs the example of an importer, whatever comes of it.
fn output(importer: &str, bench: &Bench, arguments: &[String]) -> Output {
    let mut command = if importer == FMI_RS {
        Command::new(&*FMI_RS_PROGRAM)
    } else {
        let mut python = Command::new(python::interpreter());
        python.arg("-B").arg(examples().join(importer));
        python
    };
    command.args(arguments).current_dir(&bench.folder).output().unwrap()
}

/// Runs the example of an importer. Returns the number of values that it says are equal to those of the run that it is
/// compared with; `None` if it says that one is not.
fn equal_values(importer: &str, bench: &Bench, arguments: &[String]) -> Option<usize> {
    let output = output(importer, bench, arguments);
    let said = format!("{}{}", program::text(&output.stdout), program::text(&output.stderr));
    let verdict = said.lines().find_map(|line| line.split_once(" to the last bit: "));
    let verdict =
        verdict.unwrap_or_else(|| panic!("{importer} {arguments:?}: {}\n{said}", output.status)).1;
    let values = verdict.strip_prefix("yes, all ").and_then(|rest| rest.strip_suffix(" values"));
    assert_eq!(output.status.code(), Some(i32::from(values.is_none())), "{said}");
    println!("{said}");
    values.map(|values| values.parse().unwrap())
}

/// The example gets the doubles of the runs without an importer: all rows but the `unread` first ones, and all columns
/// but those of contact states if `states` are not read.
fn assert_equal(importer: &str, bench: &Bench, ways: &[Way], unread: usize, states: bool) {
    for run in RUNS {
        for &way in ways {
            let arguments = bench.prepare(run, way);
            let rows = bench.rows(arguments.last().unwrap());
            assert_moves(&rows);
            let is_read = |name: &&String| *name != "time" && (states || !name.ends_with(".state"));
            let columns = rows[0].iter().filter(is_read).count();
            assert!(columns > 12);
            let values = (rows.len() - 1 - unread) * columns;
            assert_eq!(equal_values(importer, bench, &arguments), Some(values), "{arguments:?}");
        }
    }
}

/// More than uniform sliding: contacts change their states, and a slider that is driven its velocity.
fn assert_moves(rows: &[Vec<String>]) {
    let column = |end: &str| {
        let place = rows[0].iter().position(|name| name.ends_with(end))?;
        Some(rows[1..].iter().map(move |row| row[place].parse::<f64>().unwrap()))
    };
    assert!(column("statistics.state_changes").unwrap().next_back().unwrap() > 3.0);
    if let Some(velocity) = column("drive.contact.guide.slip_velocity") {
        let (low, high) = velocity.fold((1.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        assert!(high - low > 1e-3, "{low} {high}");
    }
}

/// The example denies that a scene which is stiffer by a thousandth, a reference with another last bit in one value, and
/// one without numbers are equal.
fn assert_rejected(importer: &str, bench: &Bench) {
    for &way in HELD {
        let mut arguments = bench.prepare(RUNS[0], way);
        assert!(equal_values(importer, bench, &arguments).is_some());

        let shown = program::run(AMONTONS, bench.folder.path(), &["scenes", "show", "set1"]);
        let text = program::text(&shown.stdout);
        assert!(text.contains("k6 = 250e3 "));
        let stiff = text.replace("k6 = 250e3 ", "k6 = 250.25e3 ");
        std::fs::write(bench.path("stiff.toml"), stiff).unwrap();
        bench.amontons(&["export", "stiff.toml", "-o", "stiff.fmu"]);
        arguments[0] = "stiff.fmu".into();
        assert_eq!(equal_values(importer, bench, &arguments), None);

        arguments[0] = "set1.fmu".into();
        let reference = arguments.last().unwrap();
        let right = bench.rows(reference);
        let assert_denied = |rows: &[Vec<String>]| {
            let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
            std::fs::write(bench.path(reference), lines.join("\n")).unwrap();
            assert_eq!(equal_values(importer, bench, &arguments), None);
        };
        let mut last_bit = right.clone();
        let value = &mut last_bit[700][3];
        *value = format!("{:?}", value.parse::<f64>().unwrap().next_up());
        assert_denied(&last_bit);

        let mut no_numbers = right;
        for row in &mut no_numbers[1..] {
            row[1..].fill("nan".into());
        }
        assert_denied(&no_numbers);
    }
}

macro_rules! importer {
    ($name:ident, $example:expr, $ways:expr, rows: $rows:literal, unread: $unread:literal, states: $states:literal) => {
        mod $name {
            use super::*;

            #[test]
            #[ignore = "some seconds: an importer of another house"]
            fn gets_the_doubles_of_the_program() {
                assert_equal($example, &Bench::new($rows), $ways, $unread, $states);
            }

            #[test]
            #[ignore = "some seconds: an importer of another house"]
            fn is_not_content_with_another_run() {
                assert_rejected($example, &Bench::new($rows));
            }
        }
    };
}

const ALL: &[Way] = &[Way::Alone, Way::Coupled, Way::WithRates];

importer!(fmpy, "fmpy_example.py", ALL, rows: "before", unread: 0, states: true);
importer!(fmi_rs, FMI_RS, HELD, rows: "before", unread: 0, states: true);
// Initializes with its first step, so there is nothing to be read before; and reads no enumerations.
importer!(libcosimpy, "libcosimpy_example.py", HELD, rows: "before", unread: 1, states: false);
// Shows outputs with the inputs of the step that begins; reads no enumerations.
importer!(ecospy, "ecospy_example.py", HELD, rows: "after", unread: 0, states: false);

/// Each example reports mistakes that a user can mend in a sentence.
#[test]
#[ignore = "some seconds: importers of other houses"]
fn what_is_wrong_is_told() {
    let bench = Bench::new("after");
    let (set1, drive) = (bench.export("set1"), bench.export("drive"));
    // The signal raises the friction above what static friction is: the steps from then on fail.
    let shown = program::run(AMONTONS, bench.folder.path(), &["scenes", "show", "set1"]);
    let scene = program::text(&shown.stdout).replace("[friction]", "[friction]\nstatic = 2.5");
    let signal =
        "[[signal]]\ninput = \"friction.coefficient\"\npulse = { value = 1.0, start = 5e-4 }\n";
    std::fs::write(bench.path("fails.toml"), format!("{scene}\n{signal}")).unwrap();
    bench.amontons(&["export", "fails.toml", "-o", "fails.fmu"]);
    std::fs::write(bench.path("text.fmu"), "no archive").unwrap();

    let cases: [(&[&str], &str); 10] = [
        (
            &["fails.fmu"],
            "at 0.0005 s the static friction coefficient of contact[1] is 2.5, below its kinetic one",
        ),
        (
            &["fails.fmu", "--drive", &drive],
            "at 0.0005 s the static friction coefficient of contact[1] is 2.5",
        ),
        (&["nowhere.fmu"], "nowhere.fmu: there is no such file"),
        (&["text.fmu"], "text.fmu: this is not an FMU"),
        (&["."], ".: this is a folder, not an FMU"),
        (&[&set1, "--set", "friction.coeficient=0.5"], "friction.coeficient: set1.fmu has no such"),
        (&[&set1, "--set", "friction"], "write it as NAME=VALUE"),
        (&[&drive, "--drive", &set1], "slider.tangential_reaction: drive.fmu has no such output"),
        (&[&set1, "--interval", "3e-4"], "is not a whole multiple of --interval 0.0003"),
        (&[&set1, "--compare", "nowhere.csv"], "nowhere.csv: there is no such file"),
    ];
    for (given, sentence) in cases {
        let short = ["--stop-time", "1e-3"].map(str::to_owned);
        let arguments: Vec<String> = given.iter().map(|&g| g.to_owned()).chain(short).collect();
        for importer in [FMI_RS, "fmpy_example.py", "libcosimpy_example.py", "ecospy_example.py"] {
            let output = output(importer, &bench, &arguments);
            let said =
                format!("{}{}", program::text(&output.stdout), program::text(&output.stderr));
            assert!(!output.status.success(), "{importer} {arguments:?}: {said}");
            assert!(said.contains(sentence), "{importer} {arguments:?}: {said}");
            assert!(!said.contains("Traceback"), "{importer} {arguments:?}: {said}");
        }
    }
    let above_critical = [&set1, "--set", "integrator.step=0.01"].map(str::to_owned);
    let refused = output("ecospy_example.py", &bench, &above_critical);
    program::assert_refused(&refused, 1, &["set1.fmu: integrator.step = 1e-2 s is above"]);
}

/// A network has no reaction, and the drive alone nothing that moves: what there is is shown, the same by all.
#[test]
#[ignore = "some seconds: importers of other houses"]
fn scenes_without_a_reaction_run() {
    let bench = Bench::new("before");
    let drive = bench.export("drive");
    for script in ["fmpy_example.py", "libcosimpy_example.py", "ecospy_example.py"] {
        let output = output(script, &bench, std::slice::from_ref(&drive));
        let said = program::text(&output.stdout);
        assert!(output.status.success(), "{script}: {}", program::text(&output.stderr));
        assert!(said.contains("normal forces      2000 to 2000 N"), "{script}: {said}");
        assert!(!said.contains("reaction"), "{script}: {said}");
    }
}
