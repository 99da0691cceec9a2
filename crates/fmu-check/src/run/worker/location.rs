//! The resource location that `fmi2Instantiate` takes.

use std::path::Path;

/// Returns a folder as a URI that begins with `file:` and `slashes`.
pub(super) fn uri(folder: &Path, slashes: &str) -> String {
    let path = folder.to_string_lossy().replace('\\', "/");
    let mut uri = format!("file:{slashes}");
    for byte in path.trim_start_matches('/').bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/:".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_written_as_rfc_3986_has_it() {
        assert_eq!(uri(Path::new("/a b/é"), "///"), "file:///a%20b/%C3%A9");
        assert_eq!(uri(Path::new("/a"), "/"), "file:/a");
    }
}
