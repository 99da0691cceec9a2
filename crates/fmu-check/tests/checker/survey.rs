//! `tools/survey.py`, which runs the checker over a folder of FMUs.

use std::process::Command;

#[test]
fn the_survey_tells_findings_from_crashes_and_hangs_of_the_checker() {
    let tools = concat!(env!("CARGO_MANIFEST_DIR"), "/tools");
    let mut python = Command::new("python3");
    python.args(["-B", "-m", "unittest", "-q", "test_survey"]).current_dir(tools);
    let done = python.output().expect("python3 runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
