//! The report of the paper's experiments, as its reader gets it.
#![cfg(feature = "tools")]

#[allow(dead_code)]
mod browser;
mod program;

use browser::Browser;
use program::{assert_refused, folder, run, text};
use std::fs;

/// What the paper says and does not come out; each has its reason on the page, or says that it is not known.
const DIFFERING: [&str; 4] =
    ["k2 = 53 kN/m", "about 0.1 m/s", "first orbit at about 1 s", "one such transition"];

#[test]
#[ignore = "long: all of the paper's runs"]
fn the_papers_claims_hold_but_for_those_whose_difference_is_told() {
    let folder = folder();
    let output = run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &["paper", "-o", "report"]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told} {}", text(&output.stderr));
    let verdicts = |verdict: &str| told.lines().filter(|line| line.starts_with(verdict)).count();
    assert!(verdicts("holds ") >= 20, "{told}");
    for claim in told.lines().filter(|line| line.starts_with("differs ")) {
        assert!(DIFFERING.iter().any(|known| claim.contains(known)), "{claim}");
    }
    assert_eq!(verdicts("differs "), DIFFERING.len());

    let path = folder.path().join("report/index.html");
    let page = fs::read_to_string(&path).unwrap();
    // Figures 2 (a, b; c is a table), 3 (a; b and c at three velocities), 4, 5 with two beside it, 6 and 7.
    assert_eq!(page.matches("<figure").count(), 15);
    assert!(page.contains("Computing time on"));
    let mut browser = Browser::start();
    for width in [1280, 390] {
        browser.open(&path, width);
        assert_eq!(browser.complaints, Vec::<String>::new());
        let is_narrow = "document.documentElement.scrollWidth <= window.innerWidth";
        assert_eq!(browser.eval(is_narrow), true, "at {width} px");
        let drawn =
            "[...document.querySelectorAll('figure')].every(f => f.querySelector('svg path'))";
        assert_eq!(browser.eval(drawn), true, "at {width} px");
    }
}

#[test]
fn a_page_that_cannot_be_written_is_refused_before_the_work() {
    let folder = folder();
    fs::write(folder.path().join("report"), "a file").unwrap();
    let output = run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &["paper", "-o", "report"]);
    assert_refused(&output, 1, &["report"]);
    assert_eq!(fs::read_to_string(folder.path().join("report")).unwrap(), "a file");
}
