//! A program of ours as its user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// Runs a program (`env!("CARGO_BIN_EXE_…")`) in a folder.
pub fn run(program: &str, folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder of its own, deleted at the end of the test.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap()
}

/// A run must have failed with this exit code and these words on standard error.
pub fn assert_refused(output: &Output, code: i32, words: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "{word} is missing in: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
}
