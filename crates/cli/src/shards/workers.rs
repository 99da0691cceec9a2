//! The journals of all workers of a folder.

use super::Shard;
use amontons::Error;
use amontons_analysis::journal::{Found, difference};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The journals of the workers, in the order of their numbers.
pub(super) struct Workers(Vec<Worker>);

struct Worker {
    shard: Shard,
    path: PathBuf,
    found: Found,
}

impl Workers {
    /// No journals, those of a study that begins anew.
    pub(super) fn none() -> Self {
        Self(Vec::new())
    }

    /// The journals in a folder. A journal of which not even the first line is whole is none yet.
    pub(super) fn of(folder: &Path) -> Result<Self, Error> {
        let mut workers = Vec::new();
        for (shard, path) in files(folder)? {
            workers.extend(Found::at(&path)?.map(|found| Worker { shard, path, found }));
        }
        workers.sort_by_key(|worker| worker.shard);
        Ok(Self(workers))
    }

    /// The command of the workers, without the shard.
    pub(super) fn command(&self, folder: &Path) -> Result<Vec<String>, Error> {
        let Some(first) = self.first() else {
            return Err(Error::unusable_file(format!(
                "there are no pieces of workers in {}: begin with a command that has -o {} --shard I/N",
                folder_of(folder).display(),
                folder.display()
            )));
        };
        command_of(&first.found.study).ok_or_else(|| {
            Error::unusable_file(format!(
                "{} is damaged, or was not written by a worker of this version; remove it, and run its shard again",
                first.path.display()
            ))
        })
    }

    /// The worker whose study the others have: the first with pieces.
    fn first(&self) -> Option<&Worker> {
        self.0.iter().find(|worker| worker.has_pieces()).or(self.0.first())
    }

    /// The most workers that have shared the study.
    pub(super) fn most(&self) -> usize {
        self.0.iter().map(|worker| worker.shard.of).max().unwrap_or(1)
    }

    /// In what the study of a worker with pieces differs from this one; `None` if none does.
    pub(super) fn other(&self, study: &Value) -> Option<(&Path, String)> {
        let mut workers = self.0.iter().filter(|worker| worker.has_pieces());
        workers.find_map(|worker| {
            let known = without_command(&worker.found.study);
            (known != *study).then(|| (&*worker.path, difference(&known, study)))
        })
    }

    /// Refuses workers of another study, or of another command.
    pub(super) fn check(&self, study: &Value, command: &[String]) -> Result<(), Error> {
        if let Some((path, why)) = self.other(study) {
            return Err(Error::unusable_file(format!(
                "{} belongs to another study: {why}; the workers of a folder and the merge take the same scene file, values and version",
                path.display()
            )));
        }
        let given = Some(command);
        let is_other = |worker: &&Worker| {
            worker.has_pieces() && command_of(&worker.found.study).as_deref() != given
        };
        let Some(other) = self.0.iter().find(is_other) else { return Ok(()) };
        let theirs = command_of(&other.found.study).unwrap_or_default();
        Err(Error::unusable_file(format!(
            "{} belongs to another command: `{}` there, `{}` here; all workers of a folder take the same one. Give \
             another folder with -o; or, if the results of that command are written, remove {}",
            other.path.display(),
            theirs.join(" "),
            command.join(" "),
            other.path.parent().unwrap_or(&other.path).display()
        )))
    }

    /// The pieces of all workers but one, beside those that are known from a file.
    ///
    /// # Errors
    /// Returns an error if a piece is not the same in two journals.
    pub(super) fn pieces(
        &self,
        but: Option<Shard>,
        (known, path): (&BTreeMap<String, Value>, &Path),
    ) -> Result<BTreeMap<String, Value>, Error> {
        let known = known.iter().map(|(key, piece)| (&**key, (piece, path)));
        let mut all: BTreeMap<&str, (&Value, &Path)> = known.collect();
        for worker in self.0.iter().filter(|worker| Some(worker.shard) != but) {
            for (key, piece) in &worker.found.pieces {
                let (first, path) = all.entry(key).or_insert((piece, &worker.path));
                if *first != piece {
                    return Err(Error::unusable_file(format!(
                        "{} and {} have different results for {key}, which every machine computes alike: remove the \
                         one that is wrong, and run its shard again",
                        path.display(),
                        worker.path.display()
                    )));
                }
            }
        }
        Ok(all.into_iter().map(|(key, (piece, _))| (key.to_owned(), piece.clone())).collect())
    }
}

impl Worker {
    fn has_pieces(&self) -> bool {
        !self.found.pieces.is_empty()
    }
}

/// The folder of the workers' journals.
pub(super) fn folder_of(folder: &Path) -> PathBuf {
    folder.join("shards")
}

/// The path of a worker's journal.
pub(super) fn path_of(folder: &Path, shard: Shard) -> PathBuf {
    folder_of(folder).join(format!("{}-of-{}.jsonl", shard.number, shard.of))
}

/// The paths of all workers' journals.
fn files(folder: &Path) -> Result<Vec<(Shard, PathBuf)>, Error> {
    let folder = folder_of(folder);
    let failed = |error: std::io::Error| Error::file(&folder, &error);
    let entries = match fs::read_dir(&folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let shard = name.strip_suffix(".jsonl").and_then(|name| name.split_once("-of-"));
        let shard = shard.and_then(|(number, of)| Shard::parse(&format!("{number}/{of}")).ok());
        files.extend(shard.map(|shard| (shard, path)));
    }
    Ok(files)
}

/// Removes all workers' journals.
pub(super) fn discard(folder: &Path) -> Result<(), Error> {
    for (_, path) in files(folder)? {
        fs::remove_file(&path).map_err(|error| Error::file(&path, &error))?;
    }
    Ok(())
}

/// The study as the first line of a worker's journal has it.
pub(super) fn with_command(study: &Value, command: &[String]) -> Value {
    let mut study = study.clone();
    study["command"] = json!(command);
    study
}

fn without_command(study: &Value) -> Value {
    let mut study = study.clone();
    if let Some(study) = study.as_object_mut() {
        study.remove("command");
    }
    study
}

fn command_of(study: &Value) -> Option<Vec<String>> {
    serde_json::from_value(study.get("command")?.clone()).ok()
}
