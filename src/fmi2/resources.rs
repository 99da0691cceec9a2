//! Where the FMU's resources lie.

use std::ffi::{CStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};

/// The folder of the resources: from the importer's URI or, where it gives none, beside the
/// library.
pub(super) fn folder(location: Option<&CStr>) -> Option<PathBuf> {
    match location.map(CStr::to_bytes).filter(|uri| !uri.is_empty()) {
        Some(uri) => path_of(uri),
        None => Some(library()?.parent()?.parent()?.parent()?.join("resources")),
    }
}

/// The path that a `file:` URI (RFC 8089) names, in the spellings that importers use:
/// `file:/…`, `file:///…`, `file:////…`, `file://localhost/…`, percent-encoded, with a slash at
/// the end. A bare path is taken as it is.
fn path_of(uri: &[u8]) -> Option<PathBuf> {
    let Some(rest) = uri.strip_prefix(b"file:") else {
        let is_path = uri.starts_with(b"/");
        return is_path.then(|| PathBuf::from(OsString::from_vec(uri.to_vec())));
    };
    let path = match rest.strip_prefix(b"//") {
        Some(authority) => {
            let slash = authority.iter().position(|&byte| byte == b'/')?;
            let host = &authority[..slash];
            if !host.is_empty() && !host.eq_ignore_ascii_case(b"localhost") {
                return None;
            }
            &authority[slash..]
        }
        None => rest,
    };
    Some(PathBuf::from(OsString::from_vec(percent_decode(path)?)))
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

/// The file that this code was loaded from.
#[allow(unsafe_code)]
fn library() -> Option<PathBuf> {
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::uninit();
    let here = library as *const libc::c_void;
    // SAFETY: `here` is an address in this library and `info` has room for the answer.
    let found = unsafe { libc::dladdr(here, info.as_mut_ptr()) };
    if found == 0 {
        return None;
    }
    // SAFETY: dladdr filled it in, as its result says.
    let name = unsafe { info.assume_init() }.dli_fname;
    if name.is_null() {
        return None;
    }
    // SAFETY: dladdr gives a terminated string that lives as long as the library is loaded.
    let name = unsafe { CStr::from_ptr(name) };
    std::fs::canonicalize(Path::new(std::ffi::OsStr::from_bytes(name.to_bytes()))).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_that_importers_use_names_the_same_folder() {
        for uri in [
            "file:/a%20b/%C3%BC/resources",
            "file:///a%20b/%C3%BC/resources",
            "file:///a b/ü/resources",
            "file://localhost/a%20b/%c3%bc/resources",
            "file:///a%20b/%C3%BC/resources/",
            "file:////a%20b/%C3%BC/resources",
            "/a b/ü/resources",
        ] {
            let found = path_of(uri.as_bytes()).unwrap();
            let plain: PathBuf = found.components().collect();
            assert_eq!(plain, Path::new("/a b/ü/resources"), "{uri}");
        }
    }

    #[test]
    fn what_names_no_local_file_is_refused() {
        for uri in ["http://host/x", "file://elsewhere/x", "relative/path", "file:///a%2"] {
            assert_eq!(path_of(uri.as_bytes()), None, "{uri}");
        }
    }
}
