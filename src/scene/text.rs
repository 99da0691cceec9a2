//! Text of a file, decoded from its bytes, with limits on the size of both.

use super::MAX_PARTS;
use super::keys::has_more_different;
use crate::Error;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest size of a scene file, in bytes: half a million masses, each on a spring and a contact.
pub(super) const MAX_SCENE: u64 = 64_000_000;
/// Largest size of the CSV files that a scene names, together, and of one that gives inputs, in bytes.
pub(super) const MAX_TABLES: u64 = 256_000_000;
/// Largest number of values in a scene file: each takes about a hundred bytes once read.
const MAX_VALUES: usize = 8_000_000;
/// Largest number of different keys in a scene file, of which a scene knows about a hundred: each takes about five
/// hundred bytes once read.
const MAX_KEYS: usize = 100_000;

/// Returns the bytes of a file, or `None` if it has more than `most`; no more than that are read from an endless file.
pub(super) fn read(path: &Path, most: u64) -> io::Result<Option<Vec<u8>>> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0) + 1);
    file.take(most + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

/// Number of bytes as text for a message.
pub(super) fn megabytes(bytes: u64) -> String {
    format!("{} MB", bytes / 1_000_000)
}

/// Refuses a text with more values or parts than a scene may have, before it is parsed, which would take time and memory.
///
/// # Errors
/// Returns an error that names what there is too much of.
pub(super) fn check_amount(place: &str, text: &str) -> Result<(), Error> {
    let mut counts = ["mass", "spring", "damper", "contact"].map(|kind| (kind, 0));
    for line in text.lines().filter(|line| line.starts_with("[[")) {
        let name = line[2..].split(']').next().unwrap_or_default().trim();
        if let Some((_, count)) = counts.iter_mut().find(|(kind, _)| *kind == name) {
            *count += 1;
        }
    }
    if let Some((kind, count)) = counts.into_iter().find(|(_, count)| *count > MAX_PARTS) {
        return Err(Error::scene(format!(
            "{place} has {count} [[{kind}]]: a network has at most {MAX_PARTS} of each kind"
        )));
    }
    let (mut values, mut lines, mut points, mut gaps) = (0, 0, 0, 0);
    let mut was_blank = false;
    for byte in text.bytes() {
        let is_blank = matches!(byte, b' ' | b'\t');
        gaps += usize::from(is_blank && !was_blank);
        was_blank = is_blank;
        match byte {
            b'=' | b',' | b'[' | b'{' => values += 1,
            b'\n' => lines += 1,
            b'.' => points += 1,
            _ => {}
        }
    }
    // A value has at most a line, a decimal point and two gaps, and the parser keeps each of them.
    if values > MAX_VALUES || lines.max(points).max(gaps) > 2 * MAX_VALUES {
        return Err(Error::scene(format!(
            "{place} has more than {MAX_VALUES} values, the limit for scene files; put values over time into a CSV \
             file beside it"
        )));
    }
    if values > MAX_KEYS && has_more_different(text, MAX_KEYS) {
        return Err(Error::scene(format!(
            "{place} has more than {MAX_KEYS} different keys, but scene files know only about a hundred"
        )));
    }
    Ok(())
}

/// Returns the text of the file at `place`, which should be `what` (a scene file), without its byte order mark.
///
/// # Errors
/// Returns an error if the bytes are UTF-16, are not a text, or are not UTF-8; the last names the first wrong byte.
pub(super) fn decode(place: &str, what: &str, bytes: Vec<u8>) -> Result<String, Error> {
    let is_utf16 = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    if is_utf16 {
        return Err(Error::scene(format!("{place} is UTF-16; save it as UTF-8")));
    }
    if bytes.contains(&0) {
        return Err(Error::scene(format!("{place} is not a text file; give {what}")));
    }
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let before = String::from_utf8_lossy(&bytes[..at]);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        Error::scene(format!(
            "{place}:{line}:{column}: the byte 0x{:02x} is not UTF-8; save the file as UTF-8",
            bytes[at]
        ))
    })?;
    if text.starts_with('\u{FEFF}') {
        text.remove(0);
    }
    Ok(text)
}
