//! Location of the FMU's resources on Unix, where paths may hold any bytes.

use std::ffi::{CStr, OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};

/// The path that an importer's URI names.
pub(super) fn located(uri: &[u8]) -> Option<PathBuf> {
    super::located(uri, spelled)
}

/// Makes the path of a local file; `None` for a path on another host.
fn spelled(host: &[u8], path: Vec<u8>) -> Option<PathBuf> {
    let is_local = host.is_empty() && path.starts_with(b"/");
    is_local.then(|| PathBuf::from(OsString::from_vec(path)))
}

/// The file that this code was loaded from.
#[allow(unsafe_code)]
pub(super) fn library() -> Option<PathBuf> {
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
    std::fs::canonicalize(Path::new(OsStr::from_bytes(name.to_bytes()))).ok()
}

#[cfg(test)]
mod tests {
    use super::located;
    use std::path::{Path, PathBuf};

    #[test]
    fn every_spelling_that_importers_use_names_the_same_folder() {
        for uri in [
            "file:/a%20b/%C3%BC/resources",
            "file:///a%20b/%C3%BC/resources",
            "file:///a b/ü/resources",
            "file://localhost/a%20b/%c3%bc/resources",
            "file:///a%20b/%C3%BC/resources/",
            "file:////a%20b/%C3%BC/resources",
            "FILE:///a%20b/%C3%BC/resources",
            "/a b/ü/resources",
        ] {
            let found = located(uri.as_bytes()).unwrap();
            let plain: PathBuf = found.components().collect();
            assert_eq!(plain, Path::new("/a b/ü/resources"), "{uri}");
        }
    }

    #[test]
    fn what_names_no_local_file_is_refused() {
        for uri in
            ["http://host/x", "file://elsewhere/x", "relative/path", "file:relative", "file:///a%2"]
        {
            assert_eq!(located(uri.as_bytes()), None, "{uri}");
        }
    }
}
