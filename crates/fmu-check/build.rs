//! Says which programs the tests can use.

#[path = "../../tests/support/programs.rs"]
mod programs;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../../tests/support/programs.rs");
    programs::find("valgrind", &["valgrind"]);
}
