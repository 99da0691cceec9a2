//! The fuzz targets in `fuzz/`, each over what it has met and then for a while beyond.

use crate::page::{cases, pages};
use std::path::Path;
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
/// The longest that one input may take, s, on a machine that is busy with other things: a saved state takes several calls,
/// of which each may take `MOST_TIME` of its target.
const LONGEST: u32 = 600;

/// Runs a target over the files in these folders, and on further inputs from one seed, up to `runs` runs; findings are
/// written to a folder that is deleted.
fn fuzz(target: &str, runs: u32, folders: &[&str], more: &[&str]) {
    let scratch = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let found = scratch.path().join("found");
    std::fs::create_dir(&found).unwrap();
    // Beside the tests' own, and the same however often it is run.
    let built = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("fuzz");
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .current_dir(ROOT)
        .args(["fuzz", "run", "--sanitizer", "none", "--codegen-units", "16", target])
        .arg(&found)
        .args(folders)
        .args(["--", "-seed=1", "-rss_limit_mb=2048"])
        .args(more)
        .args([format!("-runs={runs}"), format!("-timeout={LONGEST}")])
        // An artifact would be lost with the folder: what failed is printed.
        .arg(format!("-artifact_prefix={}/", scratch.path().display()))
        .env("CARGO_TARGET_DIR", built)
        // The instrumentation of branches is unstable; this variable enables it in a stable compiler.
        .env("RUSTC_BOOTSTRAP", "1")
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    let output = cargo.output().expect("cargo can be started");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{target}: {} (cargo-fuzz is installed by `cargo install --locked cargo-fuzz`)\n{told}",
        output.status
    );
    // "Done 12345 runs in 21 second(s)"
    let done = told.lines().find_map(|line| line.strip_prefix("Done ")).unwrap_or_default();
    let made: u32 = done.split(' ').next().unwrap_or_default().parse().unwrap_or(0);
    assert!(made >= runs, "{target} has hardly been fuzzed:\n{told}");
    println!("{target}: {done}");
}

#[test]
#[ignore = "long"]
fn scene_files_of_any_bytes_are_read_or_refused() {
    let wrong = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    for (_, text) in pages() {
        for (name, content) in cases(&text).into_iter().flat_map(|case| case.files) {
            std::fs::write(wrong.path().join(name), content).unwrap();
        }
    }
    let folders = ["fuzz/corpus/scene", "scenes", wrong.path().to_str().unwrap()];
    fuzz("scene", 8000, &folders, &["-dict=fuzz/scene.dict"]);
}

#[test]
#[ignore = "long"]
fn bytes_that_pose_as_a_saved_state_are_refused_or_run() {
    fuzz("saved_state", 10_000, &["fuzz/corpus/saved_state"], &[]);
}
