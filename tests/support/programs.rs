//! For build scripts: a `cfg` for each program that tests want, so that they are ignored where it is not installed.

use std::env;

/// Sets the cfg `has_NAME` if one of these executables is on the `PATH`, or if the environment variable
/// `AMONTONS_TESTS` is `all`: a test whose program is missing then runs, and fails.
pub fn find(name: &str, executables: &[&str]) {
    println!("cargo::rustc-check-cfg=cfg(has_{name})");
    println!("cargo::rerun-if-env-changed=AMONTONS_TESTS");
    println!("cargo::rerun-if-env-changed=PATH");
    let path = env::var_os("PATH").unwrap_or_default();
    let folders: Vec<_> = env::split_paths(&path).filter(|folder| folder.is_dir()).collect();
    let is_required = env::var_os("AMONTONS_TESTS").is_some_and(|tests| tests == "all");
    let found = folders
        .iter()
        .flat_map(|folder| executables.iter().map(|name| folder.join(name)))
        .find(|path| path.is_file());
    if let Some(program) = &found {
        println!("cargo::rerun-if-changed={}", program.display());
    } else {
        // The time of a folder changes when a program is installed in it.
        for folder in &folders {
            println!("cargo::rerun-if-changed={}", folder.display());
        }
    }
    if is_required || found.is_some() {
        println!("cargo::rustc-cfg=has_{name}");
    }
}
