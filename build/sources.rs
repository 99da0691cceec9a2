//! Digest of the sources of the library inside an FMU. The library contains it, so that a program is never built
//! around a library of other sources.

use std::fs;
use std::path::{Path, PathBuf};
use uuid::Uuid;

/// All files and folders on which the library's code depends.
const SOURCES: [&str; 7] =
    ["Cargo.toml", "Cargo.lock", "build.rs", "build", "modelDescription", "src", "scenes"];

/// Returns a digest of 36 characters that changes with any of the sources.
pub fn digest() -> String {
    let mut files = Vec::new();
    for path in SOURCES {
        println!("cargo::rerun-if-changed={path}");
        find(Path::new(path), &mut files);
    }
    // Sorting by text, not by path components, gives the same order for paths written with backslashes.
    let mut files: Vec<(String, PathBuf)> = files
        .into_iter()
        .map(|file| (file.display().to_string().replace('\\', "/"), file))
        .collect();
    files.sort();
    let mut all = Vec::new();
    for (name, file) in files {
        let mut content = read(&file);
        // Git may check out text with Windows line ends.
        content.retain(|&byte| byte != b'\r');
        all.extend(format!("{name}\n{}\n", content.len()).into_bytes());
        all.extend(content);
    }
    Uuid::new_v5(&Uuid::NAMESPACE_OID, &all).to_string()
}

fn find(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_file() {
        files.push(path.to_owned());
        return;
    }
    let entries = fs::read_dir(path)
        .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
    for entry in entries {
        let path = entry.expect("a folder's entry can be read").path();
        if path.is_dir() || is_source(&path) {
            find(&path, files);
        }
    }
}

/// `true` for Rust and TOML files; pictures and files that editors leave behind are not sources.
fn is_source(path: &Path) -> bool {
    let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    !is_hidden && path.extension().is_some_and(|end| end == "rs" || end == "toml")
}

fn read(path: &Path) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()))
}
