//! The libraries that the program carries, one for each platform of its FMUs: those of the folder that
//! `AMONTONS_FMU_LIBRARIES` names (`linux64/amontons.so`, `win64/amontons.dll`; a release has both), or the
//! host's own, built here.

use super::host;
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// FMI's names of the platforms, and the ends of their libraries' names.
const PLATFORMS: [(&str, &str); 2] = [("linux64", "so"), ("win64", "dll")];

/// Writes the table that `src/package/library.rs` includes; `root` is the folder of the crate that is the library, and
/// `sources` what a library must say of itself.
pub fn write(out: &Path, root: &Path, sources: &str) {
    println!("cargo::rerun-if-env-changed=AMONTONS_FMU_LIBRARIES");
    let host = platform();
    let found = match env::var_os("AMONTONS_FMU_LIBRARIES").filter(|folder| !folder.is_empty()) {
        // What is fuzzed is linked, not carried; and the flags that watch it leave symbols for its program to
        // define.
        _ if env::var_os("CARGO_CFG_FUZZING").is_some() => Vec::new(),
        Some(folder) => given(Path::new(&folder), sources),
        None => vec![(host.0, host.1, host::library(out, root))],
    };
    let mut code = "pub(super) const CARRIED: &[Library] = &[\n".to_owned();
    for (platform, extension, path) in &found {
        writeln!(
            code,
            "    Library {{ platform: {platform:?}, extension: {extension:?}, bytes: include_bytes!({path:?}) }},"
        )
        .unwrap();
        // For the tests that load it.
        if *platform == host.0 {
            println!("cargo::rustc-env=AMONTONS_FMU_LIBRARY={}", path.display());
        }
    }
    code.push_str("];\n");
    fs::write(out.join("libraries.rs"), code).expect("OUT_DIR is writable");
}

/// The platform that the program is built for.
fn platform() -> (&'static str, &'static str) {
    let target = env::var("TARGET").expect("cargo sets it");
    let name = match &*target {
        target if !target.starts_with("x86_64-") => None,
        target if target.contains("-linux-") => Some("linux64"),
        target if target.contains("-windows-") => Some("win64"),
        _ => None,
    };
    let name = name.unwrap_or_else(|| {
        panic!(
            "FMUs are made for x86_64 Linux and Windows so far, not for {target}; only amontons-export and \
             amontons-cli need them"
        )
    });
    PLATFORMS.into_iter().find(|platform| platform.0 == name).expect("it is one of them")
}

/// The libraries in a folder.
fn given(folder: &Path, sources: &str) -> Vec<(&'static str, &'static str, PathBuf)> {
    // Paths in included code would start at that code's folder.
    let whole = fs::canonicalize(folder).unwrap_or_else(|error| {
        panic!("AMONTONS_FMU_LIBRARIES names {}: {error}", folder.display())
    });
    println!("cargo::rerun-if-changed={}", whole.display());
    let mut found = Vec::new();
    for (platform, extension) in PLATFORMS {
        let path = whole.join(platform).join(format!("amontons.{extension}"));
        let Ok(bytes) = fs::read(&path) else { continue };
        let sign = format!("amontons sources {sources}");
        assert!(
            bytes.windows(sign.len()).any(|part| part == sign.as_bytes()),
            "{} is not built from these sources; build it anew (release/make does)",
            path.display()
        );
        found.push((platform, extension, path));
    }
    assert!(
        !found.is_empty(),
        "AMONTONS_FMU_LIBRARIES names {}, in which there is neither linux64/amontons.so nor \
         win64/amontons.dll",
        folder.display()
    );
    found
}
