//! A page of `tests/golden/`, as it was and as it is now.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Command that writes the pages anew.
const RENEW: &str = "AMONTONS_WRITE=1 cargo test --release --locked --test golden";

pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// Compares pages, each a name and a text, with the files of these names; with `AMONTONS_WRITE`, writes them.
#[track_caller]
pub fn compare(pages: &[(String, String)]) {
    let mut wrong = String::new();
    for (name, now) in pages {
        let path = folder().join(name);
        if std::env::var_os("AMONTONS_WRITE").is_some() {
            fs::write(&path, now).unwrap();
        }
        let before = fs::read_to_string(&path).unwrap_or_default();
        if let Some(difference) = difference(&before, now) {
            let _ = writeln!(wrong, "crates/cli/tests/golden/{name}, {difference}.");
        }
    }
    assert!(wrong.is_empty(), "{wrong}Where that is meant, `{RENEW}` writes the files anew.");
}

/// Describes the first difference between two texts, with the number of different lines.
fn difference(before: &str, now: &str) -> Option<String> {
    // A checkout may have other line ends.
    let mut lines = [before.lines(), now.lines()];
    let (mut first, mut count) = (None, 0);
    for number in 1.. {
        let [expected, found] = lines.each_mut().map(Iterator::next);
        if expected.is_none() && found.is_none() {
            break;
        }
        if expected != found {
            count += 1;
            first.get_or_insert((number, expected, found));
        }
    }
    let (number, expected, found) = first?;
    let quoted = |line: Option<&str>| line.map_or("no line".to_owned(), |line| format!("`{line}`"));
    let others = match count - 1 {
        0 => String::new(),
        1 => ", and so does 1 line after it".to_owned(),
        others => format!(", and so do {others} lines after it"),
    };
    let (expected, found) = (quoted(expected), quoted(found));
    Some(format!("line {number} differs: expected {expected}, found {found}{others}"))
}

#[test]
fn a_difference_is_told_by_its_first_line_and_how_many_there_are() {
    assert_eq!(difference("a\nb\n", "a\r\nb\r\n"), None);
    let one = difference("a\nb\n", "a\nc\n").unwrap();
    assert_eq!(one, "line 2 differs: expected `b`, found `c`");
    let more = difference("a\n", "b\nc\nd\n").unwrap();
    assert_eq!(more, "line 1 differs: expected `a`, found `b`, and so do 2 lines after it");
    let end = difference("a\nb\n", "a\n").unwrap();
    assert_eq!(end, "line 2 differs: expected `b`, found no line");
}
