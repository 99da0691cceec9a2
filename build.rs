//! Two steps before the crate is compiled:
//!
//! * the catalogue of FMI variables is turned into typed Rust tables (`catalogue`);
//! * a digest of the sources of the library that goes into an FMU is computed (`sources`).
//!
//! The build script of the crate that makes FMUs compiles these sources once more, as that library; it receives their
//! location (`DEP_AMONTONS_ROOT`) and their digest (`DEP_AMONTONS_SOURCES`).

#[path = "build/catalogue.rs"]
mod catalogue;
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
    println!("cargo::metadata=sources={sources}");
    let root = env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    println!("cargo::metadata=root={root}");
}
