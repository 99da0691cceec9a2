//! The text of a file, from its bytes.

use crate::Error;

/// The text of the file at `place`, which should be `what` (a scene file). A byte order mark is not part
/// of it.
///
/// # Errors
/// Bytes that are not UTF-8: what they seem to be, and where the first stands.
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
