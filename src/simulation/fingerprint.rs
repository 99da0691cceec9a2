//! The GUID that ties a model description to the library that reads it.

use super::catalogue::CATALOGUE_TEXT;
use crate::scene::Source;
use uuid::Uuid;

/// The fingerprint of a scene's files, the catalogue and this version of the program, in the braces
/// that FMI's examples use. Name-based (UUID version 5).
#[must_use]
pub fn fingerprint(source: &Source) -> String {
    let version = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    let tables = source.tables.iter().flat_map(|(name, text)| [&**name, text]);
    let mut name = Vec::new();
    for part in [version, &*source.text].into_iter().chain(CATALOGUE_TEXT).chain(tables) {
        // Lengths keep different parts from giving the same text.
        name.extend_from_slice(&part.len().to_le_bytes());
        name.extend_from_slice(part.as_bytes());
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
    }
}
