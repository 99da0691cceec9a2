//! `amontons check`: sound FMUs pass, and each rule finds what breaks it, and nothing else.
#![cfg(all(feature = "tools", target_os = "linux", target_arch = "x86_64"))]

#[path = "check/archive.rs"]
mod archive;
#[path = "check/description.rs"]
mod description;
#[path = "check/fmu.rs"]
mod fmu;
#[path = "check/libraries.rs"]
mod libraries;
mod program;

use amontons::check::Rule;
use fmu::{PROGRAM, check, sound};
use program::{assert_refused, folder, run, text};
use std::fs;

/// A build on this machine may need the newest glibc; releases are built for an old one.
const ANY_GLIBC: &[&str] = &["--glibc", "2.99"];

#[test]
fn a_sound_fmu_of_another_maker_passes() {
    assert_eq!(check(&sound().pack(), &[]), (0, String::new()));
}

#[test]
fn every_built_in_scene_passes_by_every_integrator() {
    let folder = folder();
    for scene in amontons::scene::BUILTIN {
        for arguments in [&[][..], &["--integrator", "event-driven", "--step", "1e-5"]] {
            let export = [&["export", scene.name, "-o", "a.fmu"], arguments].concat();
            let output = run(PROGRAM, folder.path(), &export);
            if !output.status.success() {
                // Not every scene can be run event by event.
                assert!(!arguments.is_empty(), "{}", text(&output.stderr));
                continue;
            }
            let fmu = fs::read(folder.path().join("a.fmu")).unwrap();
            assert_eq!(check(&fmu, ANY_GLIBC), (0, String::new()), "{} {arguments:?}", scene.name);
        }
    }
}

#[test]
fn all_rules_are_listed() {
    let folder = folder();
    let listed = text(&run(PROGRAM, folder.path(), &["check", "--rules"]).stdout);
    let help = text(&run(PROGRAM, folder.path(), &["check", "--help"]).stdout);
    assert_eq!(listed.lines().count(), Rule::ALL.len());
    for (line, rule) in listed.lines().zip(Rule::ALL) {
        let (id, what) = line.split_once(' ').unwrap();
        assert_eq!((id, what.trim_start()), (rule.id(), rule.line()));
        assert!(help.contains(line), "{line}");
    }
}

#[test]
fn every_rule_has_an_fmu_that_breaks_it() {
    let tests = [
        include_str!("check/archive.rs"),
        include_str!("check/description.rs"),
        include_str!("check/libraries.rs"),
    ];
    for rule in Rule::ALL {
        let name = format!("\"{}\"", rule.id());
        assert!(tests.iter().any(|test| test.contains(&name)), "no test breaks {name}");
    }
}

#[test]
fn what_cannot_be_read_is_said_on_standard_error() {
    let folder = folder();
    assert_refused(&run(PROGRAM, folder.path(), &["check", "none.fmu"]), 2, &["none.fmu"]);
    assert_refused(&run(PROGRAM, folder.path(), &["check"]), 2, &["FILE"]);
    assert_refused(&run(PROGRAM, folder.path(), &["check", "a.fmu", "--glibc", "x"]), 2, &["2.17"]);
}
