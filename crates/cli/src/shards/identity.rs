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
    json!({
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
    })
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
