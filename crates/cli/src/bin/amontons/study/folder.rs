//! The folder of a study: its journal, its results as CSV and JSON, its pictures.

use super::arguments::{Pictures, StudyArguments};
use amontons::scene::{Scene, Source};
use amontons_analysis::output::AtomicFile;
use amontons_analysis::study::{Journal, Owner};
use amontons_pictures::picture::Chart;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::error::Error;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

pub struct Folder {
    path: PathBuf,
    pictures: Pictures,
    study: Value,
    journal: Journal,
}

impl Folder {
    /// Opens or creates the folder with the journal of this study. `settings` are all settings on which a piece of the
    /// study depends besides the scene and its values. If the folder is not named on the command line and the default
    /// one holds another study, the next free name with a number is used.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created or written, or if it is named and holds another study.
    pub fn open(
        common: &StudyArguments,
        kind: &str,
        (scene, source): (&Scene, &Source),
        settings: impl Serialize,
    ) -> Result<Self, Box<dyn Error>> {
        let set: Map<String, Value> =
            common.set.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        let study = json!({
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
        let path = match &common.output {
            Some(path) => path.clone(),
            None => free(&format!("{}-{kind}", scene.name), &study),
        };
        if path.exists() && !path.is_dir() {
            let error = std::io::ErrorKind::NotADirectory.into();
            return Err(amontons::Error::file(&path, &error).into());
        }
        if let (Some(why), false) = (other(&path, &study), common.anew) {
            let error = std::io::Error::other(format!(
                "the folder holds another study: {why}; give another folder with -o, or discard its journal with --anew"
            ));
            return Err(amontons::Error::file(&path, &error).into());
        }
        fs::create_dir_all(&path).map_err(|error| amontons::Error::file(&path, &error))?;
        let journal = Journal::open(&path.join(JOURNAL), &study, common.anew)?;
        Ok(Self { path, pictures: common.pictures, study, journal })
    }

    pub fn journal(&self) -> &Journal {
        &self.journal
    }

    pub fn journal_path(&self) -> PathBuf {
        self.path.join(JOURNAL)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `results.csv`: a head and rows.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written; its previous content is kept.
    pub fn write_csv<R: AsRef<[String]>>(
        &self,
        head: &[&str],
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), Box<dyn Error>> {
        self.write_table("results", head, rows)
    }

    /// Writes `NAME.csv`: a head and rows.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written; its previous content is kept.
    pub fn write_table<R: AsRef<[String]>>(
        &self,
        name: &str,
        head: &[&str],
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), Box<dyn Error>> {
        let path = self.path.join(format!("{name}.csv"));
        let failed = |error: &std::io::Error| amontons::Error::file(&path, error);
        let mut file = AtomicFile::create(&path)?;
        writeln!(file, "{}", head.join(",")).map_err(|error| failed(&error))?;
        for row in rows {
            writeln!(file, "{}", row.as_ref().join(",")).map_err(|error| failed(&error))?;
        }
        Ok(file.complete()?)
    }

    /// Writes `study.json`: the command, the scene and all settings, and the results.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written; its previous content is kept.
    pub fn write_json(&self, results: impl Serialize) -> Result<(), Box<dyn Error>> {
        let path = self.path.join(STUDY);
        let command: Vec<String> = std::env::args().skip(1).collect();
        let mut study = self.study.clone();
        study["command"] =
            json!(["amontons".to_owned()].into_iter().chain(command).collect::<Vec<_>>());
        study["results"] = serde_json::to_value(results)?;
        let mut file = AtomicFile::create(&path)?;
        let written = file.write_all(format!("{study:#}\n").as_bytes());
        written.map_err(|error| amontons::Error::file(&path, &error))?;
        Ok(file.complete()?)
    }

    /// Path of the picture of this name.
    pub fn picture(&self, name: &str) -> PathBuf {
        self.path.join(format!("{name}.{}", self.pictures.ending()))
    }

    /// Draws a chart, unless it has no values; if all runs have failed, the reason is printed with each of them.
    ///
    /// # Errors
    /// Returns an error if the chart cannot be drawn or written.
    pub fn draw(&self, name: &str, chart: &Chart) -> Result<(), amontons::Error> {
        if chart.is_empty() {
            eprintln!(
                "note: {} is not drawn: there is no value to show",
                self.picture(name).display()
            );
            return Ok(());
        }
        chart.write(&self.picture(name))
    }
}

/// The first folder of this name, or of this name and a number, that holds no other study.
fn free(name: &str, study: &Value) -> PathBuf {
    let first = PathBuf::from(name);
    let Some(why) = other(&first, study) else { return first };
    let path = (2..)
        .map(|number| PathBuf::from(format!("{name}-{number}")))
        .find(|path| !path.exists() || (path.is_dir() && other(path, study).is_none()))
        .expect("there are more numbers than folders");
    eprintln!("note: {name} holds another study: {why}; this one is in {}", path.display());
    path
}

/// Returns the reason why a folder belongs to another study: settings that differ, or results of an unknown study;
/// `None` if it does not.
fn other(path: &Path, study: &Value) -> Option<String> {
    let has_results = RESULTS.iter().any(|name| path.join(name).exists());
    match Owner::of(&path.join(JOURNAL), study) {
        Owner::This => None,
        // A folder with neither pieces nor results was left by a study that ended before its first piece.
        Owner::Another { why, has_pieces } => (has_pieces || has_results).then_some(why),
        Owner::Nobody if has_results => {
            Some(format!("the folder has results, but no {JOURNAL} that identifies their study"))
        }
        Owner::Nobody => None,
    }
}

/// Quotes a text as a field of a CSV file.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Version of the journals; it changes when pieces are computed in another way, so that old pieces are not reused.
const FORMAT: u32 = 1;

const JOURNAL: &str = "journal.jsonl";

/// The command, the scene and all settings of a study, and its results.
pub const STUDY: &str = "study.json";

/// Files that every study writes at its end.
const RESULTS: [&str; 2] = ["results.csv", STUDY];
