//! An importer in C (`tests/host/`), compiled against FMI's own headers, loads FMUs and takes nothing on trust.
//!
//! `cargo test --release --test export host:: -- --nocapture` shows what it has done. What takes longer runs where it is
//! asked for: `cargo test --release --test export host:: -- --ignored --nocapture`.

use crate::importer::{Importer, fail, sanitized, succeed};
use std::process::Command;

#[test]
fn every_function_answers_good_and_bad_arguments_with_the_right_status() {
    succeed(&mut Importer::new().command("calls"));
}

#[test]
fn a_thousand_instances_of_two_fmus_step_in_turn_as_each_would_alone() {
    succeed(&mut Importer::new().command("many 1000 20"));
}

#[test]
fn sixteen_threads_with_instances_of_their_own_get_the_doubles_of_one() {
    succeed(&mut Importer::new().command("threads 16 20"));
}

#[test]
fn a_library_can_be_unloaded_while_another_fmu_runs() {
    succeed(&mut Importer::new().command("unload 20"));
}

#[test]
fn rounds_from_load_to_unload_leave_nothing_behind() {
    succeed(&mut Importer::new().command("rounds 3000 500 64"));
}

#[test]
fn sixteen_bytes_that_stay_behind_in_each_round_are_noticed() {
    let report = fail(&mut Importer::new().command("rounds 3000 500 64 leak"));
    assert!(report.contains("what is allocated grew"), "{report}");
}

#[test]
#[ignore = "long"]
fn a_hundred_thousand_rounds_from_load_to_unload_leave_nothing_behind() {
    succeed(&mut Importer::new().command("rounds 100000 500 64"));
}

/// Debian's valgrind; it sees what the library in an FMU does as it is. It runs one thread at a time, and must take
/// them in turn: one that steps without a pause would keep the others waiting for ever.
const MEMCHECK: [&str; 6] = [
    "valgrind",
    "--fair-sched=yes",
    "--error-exitcode=9",
    "--leak-check=full",
    "--errors-for-leak-kinds=definite,indirect",
    "--keep-debuginfo=yes",
];

#[test]
#[ignore = "long"]
fn memcheck_finds_no_error_and_no_leak() {
    let importer = Importer::new();
    for task in ["calls", "many 24 2", "threads 4 2", "unload 3", "rounds 8 0 0"] {
        let report = succeed(&mut importer.under(&MEMCHECK, task));
        assert!(report.contains("ERROR SUMMARY: 0 errors"), "{task}\n{report}");
    }
    // It is on: it sees an error in the library, and what the library has leaked.
    let report = fail(&mut importer.under(&MEMCHECK, "overrun"));
    let (_, error) = report.split_once("Invalid write of size 8").expect(&report);
    assert!(error.lines().nth(1).is_some_and(|frame| frame.contains("set1.so")), "{report}");
    let report = fail(&mut importer.under(&MEMCHECK, "leak"));
    assert!(report.contains("definitely lost"), "{report}");
    assert!(report.contains("fmi2Instantiate (in "), "{report}");
}

#[test]
#[ignore = "long"]
fn helgrind_finds_no_race_between_threads_with_instances_of_their_own() {
    let importer = Importer::new();
    let helgrind = ["valgrind", "--tool=helgrind", "--fair-sched=yes", "--error-exitcode=9"];
    for task in ["threads 4 2", "unload 3"] {
        let report = succeed(&mut importer.under(&helgrind, task));
        assert!(report.contains("ERROR SUMMARY: 0 errors"), "{task}\n{report}");
    }
}

#[test]
#[ignore = "long"]
fn address_sanitizer_finds_no_error_and_no_leak() {
    let importer = sanitized::importer();
    for task in ["calls", "many 1000 3", "threads 16 4", "unload 10", "rounds 200 0 0"] {
        succeed(&mut watched(&importer, task, "detect_leaks=1"));
    }
    // It is on: it sees an error in the library, and what the library has leaked. Without symbols, so that each
    // frame tells its file.
    let report = fail(&mut watched(&importer, "overrun", "symbolize=0"));
    let (_, error) =
        report.split_once("ERROR: AddressSanitizer: heap-buffer-overflow").expect(&report);
    let (_, frames) = error.split_once("WRITE of size 8").expect(&report);
    assert!(frames.lines().nth(1).is_some_and(|frame| frame.contains("set1.so+0x")), "{report}");
    let report = fail(&mut watched(&importer, "leak", "symbolize=0:detect_leaks=1"));
    let (_, leaks) =
        report.split_once("ERROR: LeakSanitizer: detected memory leaks").expect(&report);
    let (_, frames) = leaks.split_once("Direct leak of").expect(&report);
    // The first frame is malloc's, which is the sanitizer's own.
    assert!(frames.lines().nth(2).is_some_and(|frame| frame.contains("set1.so+0x")), "{report}");
}

fn watched(importer: &Importer, task: &str, options: &str) -> Command {
    let mut command = importer.command(task);
    command.env("ASAN_OPTIONS", format!("{options}:abort_on_error=0")).env_remove("LSAN_OPTIONS");
    command
}
