//! Location of the FMU's resources.

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;
#[cfg(any(windows, test))]
mod windows_path;

use std::ffi::CStr;
use std::path::PathBuf;
#[cfg(unix)]
use unix as platform;
#[cfg(windows)]
use windows as platform;

/// Folder of the resources: from the importer's URI or, if there is none, beside the library.
pub(super) fn folder(location: Option<&CStr>) -> Option<PathBuf> {
    match location.map(CStr::to_bytes).filter(|uri| !uri.is_empty()) {
        Some(uri) => platform::located(uri),
        None => Some(platform::library()?.parent()?.parent()?.parent()?.join("resources")),
    }
}

/// The path that a `file:` URI (RFC 8089) names, in the spellings that importers use: `file:/…`, `file:///…`,
/// `file:////…`, `file://localhost/…`, percent-encoded, with a slash at the end. A bare path is taken unchanged.
/// `spelled` makes a path from a host, which is empty for a local file, and the rest of the URI.
fn located<T>(uri: &[u8], spelled: fn(&[u8], Vec<u8>) -> Option<T>) -> Option<T> {
    let Some((_, rest)) =
        uri.split_at_checked(5).filter(|(scheme, _)| scheme.eq_ignore_ascii_case(b"file:"))
    else {
        return spelled(b"", uri.to_vec());
    };
    let Some(authority) = rest.strip_prefix(b"//") else {
        return spelled(b"", percent_decode(rest)?);
    };
    let slash = authority.iter().position(|&byte| byte == b'/')?;
    let (host, path) = authority.split_at(slash);
    let host: &[u8] = if host.eq_ignore_ascii_case(b"localhost") { b"" } else { host };
    spelled(host, percent_decode(path)?)
}

fn percent_decode(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.iter().copied();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let mut digit = || char::from(rest.next()?).to_digit(16);
            let (high, low) = (digit()?, digit()?);
            bytes.push(u8::try_from(16 * high + low).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    Some(bytes)
}
