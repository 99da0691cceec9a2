//! Which study a folder holds.

use super::workers::Workers;
use amontons::Error;
use amontons::scene::{Scene, Source};
use amontons_analysis::journal::Owner;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::path::Path;

/// All that a piece of a study depends on, as journals identify it: `settings` beside the scene and its values.
pub fn identity(
    kind: &str,
    (scene, source): (&Scene, &Source),
    set: &[(String, f64)],
    settings: impl Serialize,
) -> Value {
    let set: Map<String, Value> =
        set.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    let mut identity = json!({
        "study": kind,
        "version": env!("CARGO_PKG_VERSION"),
        "format": FORMAT,
        "scene": scene.name,
        "file": source.text,
        "tables": source.tables,
        "set": set,
        "method": scene.method,
        "step": scene.step,
        "settings": settings,
    });
    if !source.binaries.is_empty() {
        identity["matrices"] = matrices(source);
    }
    identity
}

/// The packed matrices of a scene as a study identifies them: names, sizes and checksums.
pub fn matrices(source: &Source) -> Value {
    let packed = |(name, bytes): &(String, Vec<u8>)| {
        // The packed form ends in its checksum.
        let sum = bytes.last_chunk().map_or(0, |sum| u64::from_le_bytes(*sum));
        json!({ "name": name, "bytes": bytes.len(), "checksum": format!("{sum:016x}") })
    };
    source.binaries.iter().map(packed).collect()
}

/// Returns the reason why a folder belongs to another study: settings that differ, or results of an unknown study;
/// `None` if it does not.
///
/// # Errors
/// Returns an error if a worker's journal cannot be read.
pub fn other(folder: &Path, study: &Value) -> Result<Option<String>, Error> {
    let has_results = RESULTS.iter().any(|name| folder.join(name).exists());
    let why = match Owner::of(&folder.join(JOURNAL), study) {
        Owner::This => None,
        // A folder with neither pieces nor results was left by a study that ended before its first piece.
        Owner::Another { why, has_pieces } => (has_pieces || has_results).then_some(why),
        Owner::Nobody if has_results => {
            Some(format!("the folder has results, but no {JOURNAL} that identifies their study"))
        }
        Owner::Nobody => None,
    };
    Ok(why.or(Workers::of(folder)?.other(study).map(|(_, why)| why)))
}

/// Version of the journals; it changes when pieces are computed in another way, so that old pieces are not reused.
const FORMAT: u32 = 1;

/// The journal of a folder.
pub(super) const JOURNAL: &str = "journal.jsonl";

/// Files that every study writes at its end.
const RESULTS: [&str; 2] = ["results.csv", "study.json"];

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{Freedom, SuperelementMatrices, builtin};

    #[test]
    fn a_study_of_other_matrices_is_another_study() {
        let scene = builtin("set1").unwrap().scene();
        let of = |stiffness: f64| {
            let freedoms = vec![Freedom { node: 1, direction: 1 }];
            let one = SuperelementMatrices::new(freedoms, vec![1.0], vec![stiffness], vec![]);
            let binaries = vec![("pad.superelement".to_owned(), one.unwrap().to_bytes())];
            identity("sweep", (&scene, &Source { binaries, ..Source::default() }), &[], ())
        };
        assert_eq!(of(2.0), of(2.0));
        assert_ne!(of(2.0), of(3.0));
        let none = identity("sweep", (&scene, &Source::default()), &[], ());
        assert!(none.get("matrices").is_none());
    }
}
