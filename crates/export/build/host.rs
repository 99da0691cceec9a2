//! The library for the platform that the program is built for. Cargo does not install a cdylib beside a binary, and
//! cannot yet hand one to it, so the crate amontons is compiled once more, as a library by itself.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the library from the crate in the folder `root`, and returns its path.
pub fn library(out: &Path, root: &Path) -> PathBuf {
    let target = env::var("TARGET").expect("cargo sets it");
    // Programs, tests, benchmarks and lints have an OUT_DIR each (`<target>/<profile>/build/<package>/out`); one folder
    // for all of them lets cargo find the library that it has built.
    let target_dir = out.ancestors().nth(4).expect("it is in a target folder").join("fmu-library");
    let mut cargo = Command::new(env::var_os("CARGO").expect("cargo sets it"));
    cargo
        .current_dir(root)
        .args([
            "rustc",
            "--package",
            "amontons",
            "--lib",
            "--crate-type",
            "cdylib",
            "--profile",
            "fmu",
        ])
        .args(["--no-default-features", "--locked", "--target", &target, "--target-dir"])
        .arg(&target_dir);
    // Set by `cargo clippy` for its own run; the library is compiled, not linted.
    cargo.env_remove("RUSTC_WORKSPACE_WRAPPER");
    // Describes the outer build; the inner one gets its own.
    for (name, _) in env::vars_os() {
        let inherited = name.to_string_lossy();
        if inherited.starts_with("CARGO_FEATURE_") || inherited.starts_with("CARGO_CFG_") {
            cargo.env_remove(name);
        }
    }
    let mut flags = portable(&env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default());
    if target.contains("-linux-") {
        // An undefined symbol fails here, not in an importer; Windows' linkers refuse them by themselves.
        flags.push("-Clink-arg=-Wl,-z,defs".to_owned());
    }
    // Messages of panics name source files; where this machine keeps them is not for an FMU to tell.
    let home = |name: &str| env::home_dir().map(|home| home.join(name));
    let cargo_home = env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| home(".cargo"));
    for (path, name) in [
        (cargo_home, "cargo"),
        (Some(root.to_owned()), "amontons"),
        (Some(target_dir.clone()), "target"),
    ] {
        flags.extend(path.map(|path| format!("--remap-path-prefix={}={name}", path.display())));
    }
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    let status = cargo.status().expect("cargo can be started");
    assert!(status.success(), "the library that goes into an FMU does not compile");

    let name = if target.contains("-windows-") { "amontons.dll" } else { "libamontons.so" };
    target_dir.join(&target).join("fmu").join(name)
}

/// The flags of the outer build without those that bind code to this machine's processor: an FMU runs on others.
fn portable(encoded: &str) -> Vec<String> {
    let mut flags = Vec::new();
    let mut given = encoded.split('\x1f').filter(|flag| !flag.is_empty());
    while let Some(flag) = given.next() {
        // `-C target-cpu=native` comes as one word or as two.
        let (option, words) = match flag {
            "-C" | "--codegen" => {
                let option = given.next().unwrap_or_default();
                (option, vec![flag, option])
            }
            _ => (flag.trim_start_matches("-C").trim_start_matches("--codegen="), vec![flag]),
        };
        if !option.starts_with("target-cpu=") && !option.starts_with("target-feature=") {
            flags.extend(words.into_iter().map(str::to_owned));
        }
    }
    flags
}
