//! The folder of a study: its journal, its results as CSV and JSON, its pictures.

use super::arguments::{Pictures, StudyArguments};
use amontons::scene::{Scene, Source};
use amontons_analysis::journal::Journal;
use amontons_analysis::output::{self, AtomicFile};
use amontons_analysis::watch::Watch;
use amontons_cli::shards::{Pieces, Program, ShardArguments, identity, other};
use amontons_pictures::picture::Chart;
use serde::Serialize;
use serde_json::{Value, json};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

pub struct Folder {
    path: PathBuf,
    pictures: Pictures,
    study: Value,
    pieces: Pieces,
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
        scene: (&Scene, &Source),
        settings: impl Serialize,
    ) -> Result<Self, Box<dyn Error>> {
        Self::open_shared(common, ShardArguments::default(), kind, scene, settings)
    }

    /// Opens or creates the folder as [`Self::open`] does, for a study whose pieces several workers may share.
    ///
    /// # Errors
    /// Returns an error as [`Self::open`] does, or if workers do not name their folder.
    pub fn open_shared(
        common: &StudyArguments,
        shared: ShardArguments,
        kind: &str,
        (scene, source): (&Scene, &Source),
        settings: impl Serialize,
    ) -> Result<Self, Box<dyn Error>> {
        let study = identity(kind, (scene, source), &common.set, settings);
        let path = match &common.output {
            Some(path) => path.clone(),
            None if shared.is_part() => return Err(shared.without_folder().into()),
            None => free(&format!("{}-{kind}", scene.name), &study)?,
        };
        let pieces = Pieces::open(&path, Program::Amontons, shared, &study, common.anew)?;
        Ok(Self { path, pictures: common.pictures, study, pieces })
    }

    /// The results of the study's work; `None` if they need pieces of other workers, and this command has done its part.
    ///
    /// # Errors
    /// Returns an error if the work fails, is ended by the user, or cannot have its results yet ([`Pieces::found`]).
    pub fn found<T>(
        &mut self,
        work: impl Fn(&Journal, Watch<'_>) -> Result<Option<T>, amontons::Error>,
    ) -> Result<Option<T>, Box<dyn Error>> {
        self.pieces.found("the study", work)
    }

    pub fn journal(&self) -> &Journal {
        self.pieces.journal()
    }

    /// Tells how to continue the study that the user has ended, and returns the error for it.
    pub fn interrupted(&self) -> Box<dyn Error> {
        self.pieces.interrupted()
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
        let mut study = self.study.clone();
        study["command"] = json!(self.pieces.command());
        study["results"] = serde_json::to_value(results)?;
        Ok(output::write(&path, format!("{study:#}\n").as_bytes())?)
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
fn free(name: &str, study: &Value) -> Result<PathBuf, amontons::Error> {
    let first = PathBuf::from(name);
    let Some(why) = other(&first, study)? else { return Ok(first) };
    for number in 2_u32.. {
        let path = PathBuf::from(format!("{name}-{number}"));
        if !path.exists() || (path.is_dir() && other(&path, study)?.is_none()) {
            eprintln!("note: {name} holds another study: {why}; this one is in {}", path.display());
            return Ok(path);
        }
    }
    unreachable!("there are more numbers than folders")
}

/// Quotes a text as a field of a CSV file.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The command, the scene and all settings of a study, and its results.
pub const STUDY: &str = "study.json";
