//! Libraries that break one rule by what they are.

use super::fmu::{LIBRARY, assert_breaks, check, compile, library, sound, with_library};

fn broken(rule: &str, flags: &[&str]) {
    assert_breaks(rule, &with_library(library(flags)).pack(), &["--no-run"]);
}

#[test]
fn each_fault_of_a_library_file_is_found_by_its_rule_alone() {
    broken("function-missing", &["-DFAULT_function"]);
    broken("symbol-undefined", &["-DFAULT_undefined"]);
    broken("run-path", &["-Wl,-rpath,/home/builder/lib"]);
    broken("executable-stack", &["-Wl,-z,execstack"]);
}

#[test]
fn libraries_and_folders_are_of_their_platforms() {
    let so = library(&[]);
    let text = with_library(b"#!/bin/sh\n".to_vec());
    assert_breaks("library-format", &text.pack(), &["--no-run"]);
    let mut program = so.clone();
    program[16] = 2;
    let printed = assert_breaks("library-format", &with_library(program).pack(), &["--no-run"]);
    assert!(printed.contains("not a shared library"), "{printed}");
    let mut arm = so.clone();
    arm[18..20].copy_from_slice(&183_u16.to_le_bytes());
    assert_breaks("library-format", &with_library(arm).pack(), &["--no-run"]);
    let windows = sound().rename(LIBRARY, "binaries/win64/decay.dll");
    assert_breaks("library-format", &windows.pack(), &["--no-run"]);
    assert_breaks(
        "library-missing",
        &sound().rename(LIBRARY, "binaries/linux64/other.so").pack(),
        &[],
    );
    assert_breaks(
        "platform-folder",
        &sound().add("binaries/linux/decay.so", &so).pack(),
        &["--no-run"],
    );
    let (code, printed) = check(&sound().add("binaries/aarch64-linux/decay.so", &so).pack(), &[]);
    assert_eq!(code, 0, "{printed}");
    assert!(printed.starts_with("note: binaries/aarch64-linux/ "), "{printed}");
}

#[test]
fn other_libraries_are_the_systems_or_beside_it() {
    let folder = super::program::folder();
    let helper = compile(
        "int helper(void) { return 1; }",
        &["-fvisibility=default", "-Wl,-soname,libhelper.so"],
    );
    let path = folder.path().join("libhelper.so");
    std::fs::write(&path, &helper).unwrap();
    let link = ["-Wl,--no-as-needed", path.to_str().unwrap()];
    let alone = with_library(library(&link));
    assert_breaks("needed-library", &alone.pack(), &["--no-run"]);
    // Beside it, but the loader does not look there.
    let beside = alone.add("binaries/linux64/libhelper.so", &helper);
    assert_breaks("needed-library", &beside.pack(), &["--no-run"]);
    let found = with_library(library(&[link[0], link[1], "-Wl,-rpath,$ORIGIN"]));
    let found = found.add("binaries/linux64/libhelper.so", &helper);
    assert_eq!(check(&found.pack(), &[]), (0, String::new()));
    // Or anywhere else in the FMU where it does.
    let resources =
        with_library(library(&[link[0], link[1], "-Wl,-rpath,$ORIGIN/../../resources"]));
    assert_breaks("needed-library", &resources.pack(), &["--no-run"]);
    let resources = resources.add("resources/libhelper.so", &helper);
    assert_eq!(check(&resources.pack(), &[]), (0, String::new()));
}

#[test]
fn a_newer_glibc_than_asked_for_is_told() {
    let (code, printed) = check(&sound().pack(), &["--no-run", "--glibc", "2.1"]);
    assert!(printed.starts_with("defect: glibc-floor "), "{printed}");
    assert!(printed.contains("needs glibc 2."), "{printed}");
    assert_eq!((code, printed.lines().count()), (3, 1), "{printed}");
}

/// The sound library, as if a later compiler had made it: every version of glibc that it names is 2.99.
fn of_a_newer_glibc() -> Vec<u8> {
    let (old, new) = (b"GLIBC_2.2.5\0", b"GLIBC_2.99\0\0");
    let mut made = library(&[]);
    let mut places = made.windows(old.len()).enumerate().filter(|(_, bytes)| bytes == old);
    let place = places.next().expect("it calls functions of glibc").0;
    made[place..place + new.len()].copy_from_slice(new);
    made
}

#[test]
fn a_newer_glibc_than_old_hosts_have_is_a_hint_unless_hints_or_a_floor_are_asked_for() {
    let fmu = with_library(of_a_newer_glibc()).pack();
    let told = "glibc-floor binaries/linux64/decay.so: needs glibc 2.99 (GLIBC_2.99";
    let printed = assert_breaks("glibc-floor", &fmu, &["--no-run"]);
    assert!(printed.starts_with(&format!("hint: {told}")), "{printed}");
    let (code, printed) = check(&fmu, &["--no-run", "--strict"]);
    assert_eq!(code, 4, "{printed}");
    assert!(printed.starts_with(&format!("hint: {told}")), "{printed}");
    let (code, printed) = check(&fmu, &["--no-run", "--glibc", "2.17"]);
    assert_eq!(code, 3, "{printed}");
    assert!(printed.starts_with(&format!("defect: {told}")), "{printed}");
    assert_eq!(check(&fmu, &["--no-run", "--strict", "--glibc", "2.99"]), (0, String::new()));
    assert_eq!(check(&sound().pack(), &["--strict"]), (0, String::new()));
}
