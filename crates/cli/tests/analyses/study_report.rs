//! The page of `study report`: its numbers are those of the single commands, it needs nothing else, and a study that was ended or
//! shared has the bytes of one that was not.

use crate::program::{assert_refused, folder, run, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

pub fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

fn stability(folder: &Path, arguments: &[&str]) -> String {
    let output = run(env!("CARGO_BIN_EXE_amontons-stability"), folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// Runs `study report` into `out`, and returns what it printed.
pub fn report(folder: &Path, arguments: &[&str]) -> String {
    let output = amontons(folder, &[&["study", "report"], arguments, &["-o", "out"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

pub fn page(folder: &Path) -> String {
    fs::read_to_string(folder.join("out/report.html")).unwrap()
}

pub fn study(folder: &Path, name: &str) -> Value {
    let text = fs::read_to_string(folder.join(name).join("study.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["results"].clone()
}

/// The parts of a text between two others.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Vec<&'a str> {
    text.split(from).skip(1).map(|after| after.split(to).next().unwrap()).collect()
}

/// The rows of the table whose caption begins so, cell by cell.
pub fn cells(page: &str, caption: &str) -> Vec<Vec<String>> {
    let table = page.split("<table>").find(|table| {
        between(table, "<span>", "</span>").first().is_some_and(|found| found.starts_with(caption))
    });
    let table = table.unwrap_or_else(|| panic!("no table {caption}"));
    let plain = |cell: &str| {
        let text = cell.split_once('>').unwrap().1.replace("<strong>", "").replace("</strong>", "");
        let text = text.replace("<wbr>", "");
        text.replace("</th>", "").replace("</td>", "")
    };
    let row = |row: &str| {
        let row = row.replace("<th scope=\"row\"", "<td");
        row.split("<td").skip(1).map(plain).collect()
    };
    between(table.split("<tbody>").nth(1).unwrap(), "<tr>", "</tr>").into_iter().map(row).collect()
}

const QUICK: [&str; 2] = ["disc_brake", "--points=64"];

#[test]
fn the_numbers_of_the_page_are_those_of_the_single_commands() {
    let folder = folder();
    let at = folder.path();
    report(at, &QUICK);
    let (page, found) = (page(at), study(at, "out"));

    let output = amontons(at, &["study", "loudness", "disc_brake", "-o", "loudness"]);
    let printed = text(&output.stdout);
    let alone = study(at, "loudness");
    assert_eq!(found["loudness"], alone["found"]);
    let row = printed.lines().find(|line| line.starts_with("mode 3")).unwrap();
    let on_page = &cells(&page, "Growth on the left")[0];
    assert_eq!(
        on_page.join(" ").split_whitespace().collect::<Vec<_>>(),
        row.split_whitespace().collect::<Vec<_>>()
    );

    let scatter = [
        "--uncertain=friction.coefficient=normal(±10%)",
        "--uncertain=mass.*.mass=normal(±5%)",
        "--uncertain=spring.*.stiffness=normal(±5%)",
    ];
    let command = [&["study", "robustness"], &QUICK[..], &scatter, &["-o", "robustness"]].concat();
    assert!(amontons(at, &command).status.success());
    assert_eq!(found["robustness"], study(at, "robustness")["eigenvalues"]);
    let unstable = found["robustness"]["unstable"]["value"].as_f64().unwrap();
    assert_eq!(
        cells(&page, "Probabilities")[0][..2],
        ["P(unstable)".to_owned(), format!("{:.4} %", 100.0 * unstable)]
    );

    let command = ["sensitivity", "disc_brake", "--critical", "0:0.9", "--format", "json"];
    let sensitivity: Value = serde_json::from_str(&stability(at, &command)).unwrap();
    let critical = &sensitivity["critical"][0]["friction"];
    assert_eq!(&found["sliding"]["critical"][0]["friction"], critical);
    let printed = stability(at, &["sensitivity", "disc_brake"]);
    for row in cells(&page, "Mode at 1087.91 Hz, growth rate 175.8 1/s: changes") {
        let line = printed.lines().find(|line| line.contains(&row[0])).unwrap();
        let [.., frequency, rate] = line.split_whitespace().collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        assert_eq!([&*row[3], &*row[2]], [frequency, rate].map(|it| it.replace('-', "−")));
    }
}

#[test]
fn a_change_on_the_page_has_the_growth_rate_of_the_changed_scene() {
    let folder = folder();
    report(folder.path(), &QUICK);
    let found = study(folder.path(), "out");
    let changes = found["sliding"]["changes"].as_array().unwrap();
    let is_one =
        |change: &&Value| change["parameters"] == serde_json::json!([["mass.upper.mass", 0.1]]);
    let change = changes.iter().find(is_one).unwrap();
    let command =
        ["states", "disc_brake", "--state=Sl-R-Sl", "--set=mass.upper.mass=0.33", "--format=json"];
    let states: Value = serde_json::from_str(&stability(folder.path(), &command)).unwrap();
    let rates = states.to_string();
    let rate = change["computed"].as_f64().unwrap();
    let all: Vec<f64> = between(&rates, "\"growth_rate\":", ",")
        .iter()
        .filter_map(|it| it.trim_end_matches(['}', ']']).parse().ok())
        .collect();
    assert!(all.iter().any(|one| (one - rate).abs() < 1e-6), "{rate} {rates}");
    // The derivative is 14.21 1/s for 1 %, so 10 % are told as 142.1 1/s, of which eigenvalues know less.
    let predicted = change["predicted"].as_f64().unwrap();
    assert!((175.78 - predicted - 142.1).abs() < 0.1 && rate > predicted, "{change}");
    // Growth begins where the locus of the changed scene says.
    let onset = change["onset"]["at"].as_f64().unwrap();
    let command = ["locus", "disc_brake", "--set=mass.upper.mass=0.33", "--friction=0:0.9/201"];
    let told = stability(folder.path(), &command);
    assert!(told.contains(&format!("{onset:.9}")[..8]), "{onset} {told}");
}

#[test]
fn the_page_refers_to_nothing_outside_it_and_its_links_lead_somewhere() {
    let folder = folder();
    report(folder.path(), &QUICK);
    let page = page(folder.path());
    let rest = page.replace("\"http://www.w3.org/2000/svg\"", "");
    for wrong in ["http:", "https:", "src=", "@import", "url(", "<script"] {
        assert!(!rest.contains(wrong), "{wrong}");
    }
    let policy = between(&page, "Content-Security-Policy\" content=\"", "\"")[0];
    assert!(policy.starts_with("default-src 'none';") && !policy.contains("unsafe"), "{policy}");
    let names = between(&page, " id=\"", "\"");
    for name in &names {
        assert_eq!(names.iter().filter(|other| other == &name).count(), 1, "{name}");
    }
    let links =
        [between(&page, "href=\"#", "\""), between(&page, "aria-labelledby=\"", "\"")].concat();
    assert!(links.len() > 15 && links.iter().all(|link| names.contains(link)), "{links:?}");
    assert_eq!(page.matches("<section").count(), page.matches("</section>").count());
}

#[test]
fn the_answers_tell_growth_a_push_that_squeals_and_quiet_apart() {
    let cases: [(&[&str], &[&str]); 3] = [
        (
            &["disc_brake"],
            &[
                "Yes. Uniform sliding is unstable: 1 mode grows",
                "1087.907 Hz",
                "periodic at 1121.71 Hz",
                "(assumed standard deviations)",
            ],
        ),
        (
            &["set2", "--set=friction.coefficient=1.96"],
            &[
                "A push can make it squeal.",
                "A push along a candidate led to a lasting motion",
                "periodic at 167.27 Hz",
                "raise this µ most",
            ],
        ),
        (
            &["set2", "--set=friction.coefficient=0.1"],
            &[
                "No squeal was found with the scene",
                "No candidate",
                "no motion whose loudness",
                "Nothing needs to change",
            ],
        ),
    ];
    for (arguments, words) in cases {
        let folder = folder();
        let told = report(folder.path(), &[arguments, &["--points=16"]].concat());
        let page = page(folder.path());
        for word in words {
            assert!(told.contains(word), "{word} is missing in {told}");
            assert!(page.contains(word), "{word} is missing on the page of {arguments:?}");
        }
    }
}

/// Modes of Set 1 begin to grow at µ = 1.1836 and 2.0626: growth begins at the first.
#[test]
fn growth_begins_where_no_mode_grows_below() {
    let folder = folder();
    let told = report(folder.path(), &["set1", "--set=friction.coefficient=2.5", "--points=16"]);
    assert!(told.contains("Growth begins at µ = 1.184; the scene has µ = 2.5."), "{told}");
    assert!(
        told.contains(
            "module[1].k6 +10 %: the largest growth rate is 5.982 1/s, a mode still grows"
        ),
        "{told}"
    );
}

/// Ten per cent of a negative angle might be more or less of it: the values say which.
#[test]
fn changes_of_negative_values_are_told_by_their_values() {
    let folder = folder();
    let set = ["set1", "--set=friction.coefficient=1.9", "--set=slider.angle=-0.5"];
    let told = report(folder.path(), &[&set[..], &["--points=16"]].concat());
    assert!(told.contains("slider.angle from −0.5 to −0.45: "), "{told}");
}

#[test]
fn what_is_unknown_is_called_unknown_with_the_reason() {
    let folder = folder();
    // At this angle so much friction jams the sliders.
    let jammed =
        ["set1", "--set=slider.angle=-0.5", "--set=friction.coefficient=3.9", "--points=16"];
    let told = report(folder.path(), &jammed);
    assert!(
        told.contains("Does it squeal?\n  Unknown: ")
            && told.contains("have no equilibrium in sliding"),
        "{told}"
    );
    let scene = stick_slip_with_a_signal();
    fs::write(folder.path().join("driven.toml"), scene).unwrap();
    let other = tempfile::tempdir_in(folder.path()).unwrap();
    let told = report(other.path(), &["../driven.toml", "--points=16"]);
    assert!(told.contains("Unknown: driven has signals"), "{told}");
}

/// The belt of Stribeck's law in `docs/analyses/stability.md`, on which a force acts that changes over time.
fn stick_slip_with_a_signal() -> &'static str {
    "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.3 }\nintegrator = { step = 1e-5 }\n\
     mass = [{ name = \"block\", mass = 1.0, force = [0.0, -10.0] }]\n\
     spring = [{ name = \"hold\", between = [\"block\", \"ground\"], direction = \"x\", stiffness = 1e4 }]\n\
     damper = [{ name = \"loss\", between = [\"block\", \"ground\"], direction = \"x\", damping = 5.0 }]\n\
     contact = [{ name = \"belt\", mass = \"block\" }]\n\
     signal = [{ input = \"mass.block.fx\", sine = { amplitude = 1.0, frequency = 3.0 } }]\n"
}

#[test]
fn a_study_that_was_killed_goes_on_to_the_same_bytes() {
    let folder = folder();
    let arguments = ["disc_brake", "--points=256", "--pushes=uniform(0,0.2)", "--runs=3"];
    let told = report(folder.path(), &arguments);
    assert!(
        told.contains("it squeals after a random push of uniform(0,0.2) m/s with a probability of"),
        "{told}"
    );
    let path = |file: &str| folder.path().join("out").join(file);
    let files = ["results.csv", "study.json", "report.html"];
    let before = files.map(|file| fs::read(path(file)).unwrap());
    let csv = String::from_utf8(before[0].clone()).unwrap();
    assert!(
        csv.starts_with("quantity,value,low,high,unit\n") && csv.contains("\"P(squeals)\","),
        "{csv}"
    );
    // The journal ends within a line, as one does whose program was killed.
    let journal = fs::read_to_string(path("journal.jsonl")).unwrap();
    let whole: usize = journal.split_inclusive('\n').take(6).map(str::len).sum();
    fs::write(path("journal.jsonl"), &journal[..whole + 20]).unwrap();
    for file in files {
        fs::remove_file(path(file)).unwrap();
    }
    assert_eq!(report(folder.path(), &arguments), told);
    for (file, before) in files.iter().zip(before) {
        assert!(fs::read(path(file)).unwrap() == before, "{file}");
    }
}

#[test]
fn scatter_that_is_given_replaces_the_assumptions_and_is_told_as_given() {
    let folder = folder();
    let told = report(
        folder.path(),
        &["disc_brake", "--points=16", "--uncertain=friction.coefficient=uniform(0.7,0.8)"],
    );
    assert!(
        told.contains("With the scatter given for 1 parameter") && !told.contains("assumed"),
        "{told}"
    );
    let page = page(folder.path());
    assert!(!page.contains("is an assumption of this report"));
    assert!(
        page.contains("--uncertain &apos;friction.coefficient=uniform(0.7,0.8)&apos;"),
        "the command that repeats it"
    );
}

#[test]
fn a_report_that_makes_no_sense_is_refused_before_its_folder_is_made() {
    let folder = folder();
    let refused = |more: &[&str], code, words: &[&str]| {
        let all = [&["study", "report"], more].concat();
        assert_refused(&amontons(folder.path(), &all), code, words);
    };
    refused(&["den_hartog"], 3, &["no surface moves"]);
    refused(&["corner"], 3, &["no motion is possible in uniform sliding"]);
    refused(&["set1", "--points", "100"], 2, &["100 points are not possible", "128"]);
    refused(&["set1", "--runs", "3"], 2, &["--pushes"]);
    refused(&["set1", "--pushes", "uniform(0,0.1)", "--runs", "0"], 2, &["0 runs show nothing"]);
    refused(&["set1", "--uncertain", "module[*].k9=uniform(0,1)"], 2, &["module[*].k9"]);
    refused(&["set1", "--shard", "1/2"], 2, &["-o"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
