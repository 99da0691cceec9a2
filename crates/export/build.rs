//! Finds or builds the libraries that FMUs carry (`libraries`).

#[path = "build/host.rs"]
mod host;
#[path = "build/libraries.rs"]
mod libraries;

use std::env;
use std::path::PathBuf;

fn main() {
    let folder = |name: &str| PathBuf::from(env::var_os(name).expect("cargo sets it"));
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    let sources = env::var("DEP_AMONTONS_SOURCES").expect("the crate amontons tells it");
    libraries::write(&folder("OUT_DIR"), &folder("DEP_AMONTONS_ROOT"), &sources);
}
