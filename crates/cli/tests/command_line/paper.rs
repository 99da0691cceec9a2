//! The example that reproduces the paper: its report, as its reader gets it.

use crate::browser::Browser;
use crate::program::{assert_refused, folder, run, text};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Statements of the paper that the results do not confirm; the page gives the reason for each, or says that it is not
/// known.
const DIFFERING: [&str; 6] = [
    "k2 = 53 kN/m",
    "an unstable mode at approximately 215 Hz",
    "For 0 < v < 0.1 m/s",
    "The second band lies at about 180 Hz",
    "about 170 and 215 Hz appear together",
    "one transition between two unstable branches",
];
/// Statements that no computed result can decide.
const UNKNOWN: [&str; 1] = ["The band at about 220 Hz begins at 0.6 s"];
/// Claims of the paper that have been judged too loosely once, or not at all.
const HOLDING: [&str; 12] = [
    "mode shapes of Set 2 are very similar",
    "one instability, at about 219 Hz",
    "two unstable modes, at about 168 and 217 Hz",
    "three nearly straight portions with different slopes",
    "first change of slope lies at v of about 0.1 m/s",
    "second change of slope lies at v of about 0.2 m/s",
    "first orbit at about 1 s",
    "the two modules stick in turn",
    "From 0.6 s on the spectrogram has a band at about 220 Hz",
    "a second exponential growth follows",
    "leads to another orbit, which is stable",
    "comes from the states with one contact stuck",
];

/// Runs the example in a folder. Cargo, which builds it only for a whole test run, is asked to do so.
fn paper(folder: &Path) -> Output {
    let programs = Path::new(env!("CARGO_BIN_EXE_amontons")).parent().unwrap();
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--locked", "--package", "amontons-cli", "--example", "paper"]);
    build.arg("--target-dir").arg(programs.parent().unwrap());
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    let built = build.current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(built.status.success(), "{}", text(&built.stderr));
    let program = programs.join("examples/paper");
    run(program.to_str().unwrap(), folder, &["-o", "report"])
}

#[test]
#[ignore = "long: all of the paper's runs"]
fn the_papers_claims_hold_but_for_those_whose_difference_is_told() {
    let folder = folder();
    let output = paper(folder.path());
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told} {}", text(&output.stderr));
    let with = |verdict: &str| -> Vec<&str> {
        told.lines().filter_map(|line| line.strip_prefix(verdict)).collect()
    };
    for (verdict, known) in
        [("differs ", &DIFFERING[..]), ("unknown ", &UNKNOWN), ("holds ", &HOLDING)]
    {
        for known in known {
            let count = with(verdict).iter().filter(|claim| claim.contains(known)).count();
            assert_eq!(count, 1, "{verdict} {known}: {told}");
        }
    }
    assert_eq!(with("differs ").len(), DIFFERING.len(), "{told}");
    assert_eq!(with("unknown ").len(), UNKNOWN.len(), "{told}");
    assert_eq!(with("holds ").len(), 41, "{told}");
    // No part is silent: the first line comes after two seconds, then one each ten.
    let progress = text(&output.stderr);
    assert!(progress.contains("Fig"), "{progress}");

    let path = folder.path().join("report/index.html");
    let page = fs::read_to_string(&path).unwrap();
    // Figures 2 (a, b; c is a table), 3 (a; b and c at three velocities), 4, 5 with two beside it, 6 and 7.
    assert_eq!(page.matches("<figure").count(), 15);
    assert!(page.contains("Computing time on"));
    let mut browser = Browser::start();
    for width in [1280, 500, 390] {
        browser.open(&path, width);
        assert_eq!(browser.complaints, Vec::<String>::new());
        let is_narrow = "document.documentElement.scrollWidth <= window.innerWidth";
        assert_eq!(browser.eval(is_narrow), true, "at {width} px");
        let drawn = "[...document.querySelectorAll('figure')].every(f => f.querySelector('svg polyline, svg circle, svg image'))";
        assert_eq!(browser.eval(drawn), true, "at {width} px");
    }
}

#[test]
fn a_page_that_cannot_be_written_is_refused_before_the_work() {
    let folder = folder();
    fs::write(folder.path().join("report"), "a file").unwrap();
    let output = paper(folder.path());
    assert_refused(&output, 1, &["report"]);
    assert_eq!(fs::read_to_string(folder.path().join("report")).unwrap(), "a file");
}
