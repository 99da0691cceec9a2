//! `amontons check` finds nothing in the FMUs that Amontons makes. What it finds in others is tested where its rules are, in
//! the package `fmu-check`.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use crate::program::{assert_refused, folder, run, text};
use amontons_export::package::Library;

const PROGRAM: &str = env!("CARGO_BIN_EXE_amontons");

#[test]
fn every_built_in_scene_passes_by_every_integrator() {
    let folder = folder();
    let is_of_a_release = Library::carried().len() == 2;
    for scene in amontons::scene::BUILTIN {
        for arguments in [&[][..], &["--integrator", "event-driven", "--step", "1e-5"]] {
            let export = [&["export", scene.name, "-o", "a.fmu"], arguments].concat();
            let output = run(PROGRAM, folder.path(), &export);
            if !output.status.success() {
                // Not every scene can be run event by event.
                assert!(!arguments.is_empty(), "{}", text(&output.stderr));
                continue;
            }
            let output = run(PROGRAM, folder.path(), &["check", "a.fmu"]);
            let (code, printed) = (output.status.code().unwrap(), text(&output.stdout));
            // A library built on this machine may need its glibc; that of a release must run with an old one too.
            let expected =
                if is_of_a_release { "note: binaries/win64/" } else { "hint: glibc-floor " };
            let findings: Vec<&str> =
                printed.lines().filter(|line| !line.starts_with(expected)).collect();
            assert_eq!((code, findings), (0, vec![]), "{} {arguments:?}", scene.name);
        }
    }
}

#[test]
fn a_file_that_is_no_fmu_is_refused_with_the_checkers_own_exit_code() {
    let folder = folder();
    assert_refused(&run(PROGRAM, folder.path(), &["check", "none.fmu"]), 2, &["none.fmu"]);
    let listed = text(&run(PROGRAM, folder.path(), &["check", "--rules"]).stdout);
    assert_eq!(listed.lines().count(), fmu_check::Rule::ALL.len());
}
