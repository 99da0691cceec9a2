//! The GUID that ties a model description to the library that reads it.

use super::catalogue::CATALOGUE_TEXT;
use crate::scene::Source;
use uuid::Uuid;

/// The fingerprint of a scene's files, the catalogue and this version of the program, in the braces
/// that FMI's examples use. Name-based (UUID version 5).
#[must_use]
pub fn fingerprint(source: &Source) -> String {
    let version = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    let Source { text, tables, binaries } = source;
    let tables = tables.iter().flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()]);
    let binaries = binaries.iter().flat_map(|(name, bytes)| [name.as_bytes(), bytes]);
    let texts = [version, &**text].into_iter().chain(CATALOGUE_TEXT).map(str::as_bytes);
    let mut name = Vec::new();
    for part in texts.chain(tables).chain(binaries) {
        // Lengths keep different parts from giving the same text.
        name.extend_from_slice(&part.len().to_le_bytes());
        name.extend_from_slice(part);
    }
    Uuid::new_v5(&Uuid::NAMESPACE_OID, &name).braced().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_scene_has_another_fingerprint() {
        let [a, b] = ["a", "b"].map(Source::from);
        assert_eq!(fingerprint(&a), fingerprint(&a));
        assert_ne!(fingerprint(&a), fingerprint(&b));
        assert_eq!(fingerprint(&a).len(), 38);
        let with = |name: &str, text: &str| Source {
            tables: vec![(name.to_owned(), text.to_owned())],
            ..a.clone()
        };
        let tables = [with("f.csv", "1"), with("f.csv", "2"), with("g.csv", "1"), a.clone()];
        let prints = tables.each_ref().map(fingerprint);
        assert!((0..4).all(|i| !prints[..i].contains(&prints[i])), "{prints:?}");
        let packed = |bytes: &[u8]| Source {
            binaries: vec![("pad.superelement".to_owned(), bytes.to_vec())],
            ..a.clone()
        };
        let prints = [packed(&[0xFF, 1]), packed(&[0xFF, 2]), a.clone()].map(|it| fingerprint(&it));
        assert!(prints[0] != prints[1] && prints[0] != prints[2], "{prints:?}");
    }
}
