//! The library built with AddressSanitizer, and an importer that has the sanitizer's runtime.

use super::{Importer, succeed};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "x86_64-unknown-linux-gnu";

/// An importer of FMUs whose library watches each of its accesses to memory.
pub fn importer() -> Importer {
    // The runtime comes with rustc, so that it fits to what rustc has compiled; a C compiler's may be of another
    // version. It has to be in the program: it takes malloc's place before anything else runs. Libraries find it
    // there by its exported names.
    let mut link: Vec<OsString> = vec!["-Wl,--whole-archive".into(), runtime().into()];
    link.extend(
        ["-Wl,--no-whole-archive", "-Wl,--export-dynamic", "-lrt", "-lresolv"].map(OsString::from),
    );
    Importer::with(Some(&library()), &link)
}

/// Builds the library into a folder of its own, where cargo finds it again.
fn library() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("it has a parent");
    let folder = target.join("sanitized");
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args([
            "rustc",
            "--package",
            "amontons",
            "--lib",
            "--crate-type",
            "cdylib",
            "--profile",
            "fmu",
            "--quiet",
        ])
        .args(["--no-default-features", "--locked", "--target", TARGET, "--target-dir"])
        .arg(&folder)
        // Sanitizers are not stable yet; a stable compiler has them all the same.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_ENCODED_RUSTFLAGS", "-Zsanitizer=address")
        // The profile of the FMU, but quick to build, with line numbers and with the checks of debug builds.
        .env("CARGO_PROFILE_FMU_LTO", "off")
        .env("CARGO_PROFILE_FMU_OPT_LEVEL", "1")
        .env("CARGO_PROFILE_FMU_CODEGEN_UNITS", "16")
        .env("CARGO_PROFILE_FMU_DEBUG", "line-tables-only")
        .env("CARGO_PROFILE_FMU_STRIP", "none")
        .env("CARGO_PROFILE_FMU_DEBUG_ASSERTIONS", "true");
    succeed(&mut cargo);
    folder.join(TARGET).join("fmu").join("libamontons.so")
}

/// AddressSanitizer's runtime among the libraries of the compiler.
fn runtime() -> PathBuf {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut rustc = Command::new(rustc);
    let printed = rustc.args(["--print", "target-libdir", "--target", TARGET]).output();
    let folder = String::from_utf8(printed.expect("rustc is there").stdout).expect("a path");
    let files = std::fs::read_dir(folder.trim()).expect("it can be read");
    let mut paths = files.map(|entry| entry.expect("it can be read").path());
    paths.find(|path| path.to_string_lossy().ends_with("_rt.asan.a")).unwrap_or_else(|| {
        panic!("no AddressSanitizer comes with this compiler: {}", folder.trim())
    })
}
