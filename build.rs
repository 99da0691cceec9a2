//! Three things are made before the crate is compiled:
//!
//! * the catalogue of FMI variables becomes typed Rust tables (`catalogue`);
//! * what the sources of the library that goes into an FMU are is put into one word (`sources`);
//! * with the feature `tools`, the libraries that the program carries are found or built (`libraries`).

#[path = "build/catalogue.rs"]
mod catalogue;
#[path = "build/host.rs"]
mod host;
#[path = "build/libraries.rs"]
mod libraries;
#[path = "build/sources.rs"]
mod sources;

use std::env;
use std::path::PathBuf;

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    catalogue::write(&out);
    let sources = sources::digest();
    println!("cargo::rustc-env=AMONTONS_SOURCES={sources}");
    if env::var_os("CARGO_FEATURE_TOOLS").is_some() {
        libraries::write(&out, &sources);
    }
}
