//! How programs and tests are built.

use crate::licences::cargo;
use std::collections::BTreeSet;

/// Packages with their features, for a selection of the workspace's packages and of their dependencies.
fn packages(selection: &[&str]) -> BTreeSet<String> {
    let tree = cargo(
        &[&["tree", "--locked", "--prefix", "none", "--format", "{p} {f}"], selection].concat(),
    );
    // A package that the tree has already shown is marked.
    tree.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// Cargo gives a package all features that any selected package asks for, tests included. Where a test asks for one more, a
/// package and all that depend on it are compiled once for the program and once more for the tests: a zip archive with
/// each method of compression made the tests compile 34 packages again, the library of all FMUs among them.
#[test]
fn the_tests_compile_no_package_of_the_programs_again() {
    let programs = packages(&["--edges", "normal,build", "--package", "amontons-cli"]);
    let tests = packages(&["--edges", "normal,build,dev"]);
    let again: Vec<_> = programs.difference(&tests).collect();
    assert!(programs.len() > 80 && again.is_empty(), "{again:#?}");
}
