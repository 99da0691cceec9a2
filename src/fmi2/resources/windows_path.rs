//! Windows' spelling of the path in a `file:` URI; this module handles text only, so that it is tested on every system.

/// The path that an importer's URI names, in Windows' own spelling: `C:\…`, `\\host\share\…`, or `\…` on the
/// drive that the process is on.
pub(super) fn located(uri: &[u8]) -> Option<String> {
    let slashes = |&byte: &u8| if byte == b'\\' { b'/' } else { byte };
    super::located(&uri.iter().map(slashes).collect::<Vec<_>>(), spelled)
}

fn spelled(host: &[u8], path: Vec<u8>) -> Option<String> {
    let path = String::from_utf8(path).ok()?.replace('/', r"\");
    let host = str::from_utf8(host).ok()?;
    if is_drive(host) {
        // The URI file://C:/… results if "file://" is put before a path.
        return path.starts_with('\\').then(|| with_colon(host) + &path);
    }
    if !host.is_empty() {
        return path.starts_with('\\').then(|| format!(r"\\{host}{path}"));
    }
    let after_slashes = path.trim_start_matches('\\');
    if let Some(rest) = after_slashes.get(2..).filter(|_| is_drive(&after_slashes[..2])) {
        return rest.starts_with('\\').then(|| with_colon(&after_slashes[..2]) + rest);
    }
    match path.len() - after_slashes.len() {
        0 => None,
        1 => Some(path),
        // These are file:////host/share/… and file://///host/share/….
        _ => Some(format!(r"\\{after_slashes}")),
    }
}

/// `true` for a letter followed by a colon, or by the bar that stands for it in old URIs.
fn is_drive(text: &str) -> bool {
    matches!(text.as_bytes(), [letter, b':' | b'|'] if letter.is_ascii_alphabetic())
}

fn with_colon(drive: &str) -> String {
    drive.replace('|', ":")
}

#[cfg(test)]
mod tests {
    fn windows(uri: &str) -> Option<String> {
        super::located(uri.as_bytes())
    }

    #[test]
    fn every_spelling_of_a_folder_on_a_drive_names_it() {
        for uri in [
            "file:///C:/a%20b/%C3%BC/resources",
            "file:///C%3A/a%20b/%c3%bc/resources",
            "file:///C%3a%5Ca%20b%5C%C3%BC%5Cresources",
            "file:/C:/a%20b/%C3%BC/resources",
            "file:C:/a%20b/%C3%BC/resources",
            "file:///C|/a%20b/%C3%BC/resources",
            "file:////C:/a%20b/%C3%BC/resources",
            "file://localhost/C:/a%20b/%C3%BC/resources",
            "file://LOCALHOST/C:/a%20b/%C3%BC/resources",
            "file://C:/a%20b/%C3%BC/resources",
            r"file://C:\a b\ü\resources",
            r"file:///C:\a b\ü\resources",
            r"file:\\\C:\a b\ü\resources",
            "C:/a b/ü/resources",
            r"C:\a b\ü\resources",
        ] {
            assert_eq!(windows(uri).as_deref(), Some(r"C:\a b\ü\resources"), "{uri}");
        }
        assert_eq!(windows("file:///d:/x/").as_deref(), Some(r"d:\x\"));
    }

    #[test]
    fn a_host_is_where_the_share_is() {
        for uri in [
            "file://host/share/a%20b",
            "file:////host/share/a%20b",
            "file://///host/share/a%20b",
            r"file:\\host\share\a b",
            r"\\host\share\a b",
            "//host/share/a b",
        ] {
            assert_eq!(windows(uri).as_deref(), Some(r"\\host\share\a b"), "{uri}");
        }
        // Windows' own prefix of long paths.
        assert_eq!(windows(r"\\?\C:\a").as_deref(), Some(r"\\?\C:\a"));
    }

    #[test]
    fn a_path_without_a_drive_is_on_the_present_one() {
        assert_eq!(windows("file:///a/b").as_deref(), Some(r"\a\b"));
        assert_eq!(windows("/a%20b").as_deref(), Some(r"\a%20b"));
    }

    #[test]
    fn a_bare_path_is_not_decoded() {
        assert_eq!(windows(r"C:\100%25").as_deref(), Some(r"C:\100%25"));
    }

    #[test]
    fn what_names_no_folder_is_refused() {
        for uri in [
            "http://host/x",
            "relative/path",
            "C:relative",
            "file:relative",
            "file:///C:relative",
            "file:",
            "file://host",
            "file:///C:/a%2",
            "file:///C:/a%FF",
        ] {
            assert_eq!(windows(uri), None, "{uri}");
        }
    }
}
