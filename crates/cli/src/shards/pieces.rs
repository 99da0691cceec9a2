//! The pieces of a study, as one machine, a worker or a merge computes them.
//!
//! The merged journal changes only at the end of a round, when no piece is missing that the study asks for with those
//! that are merged: so all workers of a round, and a worker that is started again, find the same pieces due and divide
//! them in the same way. Keys that are not among these belong to whoever reaches them: they are further steps of work that
//! the worker has begun, as those of a bisection.

use super::identity::{JOURNAL, other};
use super::workers::{Workers, discard, folder_of, path_of, with_command};
use super::{Missing, Program, Shard, ShardArguments};
use crate::interrupt::{Interrupted, listen, stopped, watched};
use crate::progress::Progress;
use crate::say;
use amontons::Error;
use amontons_analysis::journal::{Found, Journal};
use amontons_analysis::watch::Watch;
use amontons_export::documentation::counted;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The pieces of one study in a folder.
pub struct Pieces {
    folder: PathBuf,
    program: Program,
    command: Vec<String>,
    /// The journal that this command writes.
    journal: Journal,
    path: PathBuf,
    part: Part,
}

type Known = BTreeMap<String, Value>;

/// The part that a command has in the work.
enum Part {
    /// All of it.
    Whole,
    /// One of several workers.
    Shard {
        shard: Shard,
        /// The pieces that it goes on from: those of the rounds before.
        merged: Known,
        /// The pieces that other workers have finished.
        others: Known,
    },
    /// Putting together the pieces of all workers.
    Merge {
        /// The pieces of all workers, those of the rounds before among them.
        all: Known,
        /// Number of the workers.
        workers: usize,
    },
}

impl Pieces {
    /// Opens or creates a folder with the pieces of a study.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be read or written, or if it holds another study.
    pub fn open(
        folder: &Path,
        program: Program,
        arguments: ShardArguments,
        study: &Value,
        anew: bool,
    ) -> Result<Self, Error> {
        if arguments.is_part() && anew {
            return Err(Error::argument(format!(
                "--anew would discard the pieces of the other workers; to begin again, remove {} or give another \
                 folder with -o",
                folder.display()
            )));
        }
        let workers = if anew { Workers::none() } else { Workers::of(folder)? };
        if arguments.merge {
            workers.check(study, &workers.command(folder)?)?;
        }
        begin(folder, arguments, study, anew)?;
        let path = folder.join(JOURNAL);
        let (command, path, journal, part) = if let Some(shard) = arguments.shard {
            let command = given(program);
            workers.check(study, &command)?;
            let merged = Found::at(&path)?.map(|found| found.pieces).unwrap_or_default();
            let others = workers.pieces(Some(shard), (&merged, &path))?;
            // A worker alone leaves nothing to others: it goes on from their pieces, through all rounds.
            let (merged, others) =
                if shard.of == 1 { (others, Known::new()) } else { (merged, others) };
            let path = path_of(folder, shard);
            let journal = Journal::open(&path, &with_command(study, &command), false)?;
            (command, path, journal, Part::Shard { shard, merged, others })
        } else {
            let journal = Journal::open(&path, study, anew)?;
            let all = workers.pieces(None, (&journal.pieces(), &path))?;
            if arguments.merge {
                let part = Part::Merge { all, workers: workers.most() };
                (workers.command(folder)?, path, journal, part)
            } else {
                journal.adopt(all)?;
                (given(program), path, journal, Part::Whole)
            }
        };
        Ok(Self { folder: folder.to_owned(), program, command, journal, path, part })
    }

    /// The command whose results these are, as one machine would be given it.
    #[must_use]
    pub fn command(&self) -> &[String] {
        &self.command
    }

    /// The journal that this command writes.
    #[must_use]
    pub fn journal(&self) -> &Journal {
        &self.journal
    }

    /// The results of the work, under a bar named `what`. `None` if they need pieces of other workers: this one has done
    /// its part.
    ///
    /// # Errors
    /// Returns an error if the work fails, [`Interrupted`] if the user has ended it, or [`Missing`] if the pieces of all
    /// workers are not all that the results need.
    pub fn found<T>(
        &mut self,
        what: &str,
        work: impl Fn(&Journal, Watch<'_>) -> Result<Option<T>, Error>,
    ) -> Result<Option<T>, Box<dyn std::error::Error>> {
        match &self.part {
            Part::Whole => {
                let bar = Progress::in_parts(what);
                match watched(&bar, |watch| work(&self.journal, watch))? {
                    None => Err(self.interrupted()),
                    found => Ok(found),
                }
            }
            Part::Shard { shard, merged, others } => {
                let (shard, due) = (*shard, due(merged, &work)?);
                let places = due.iter().skip(shard.number - 1).step_by(shard.of);
                let ours = places.filter(|key| !others.contains_key(*key)).cloned();
                let ours: BTreeSet<String> = ours.collect();
                self.journal.learn(merged.clone());
                self.share(shard, &due, &ours, work)?;
                Ok(None)
            }
            Part::Merge { all, workers } => self.merged(all, *workers, work).map(Some),
        }
    }

    /// Computes those of the pieces that are due which are ours.
    fn share<T>(
        &mut self,
        shard: Shard,
        due: &[String],
        ours: &BTreeSet<String>,
        work: impl Fn(&Journal, Watch<'_>) -> Result<Option<T>, Error>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let (folder, merge) = (self.folder.display(), self.program.merge());
        let (count, all) = (ours.len(), due.len());
        if count == 0 {
            say!("{shard}: done, no piece is left for it; `{merge} {folder}` tells what is next");
            return Ok(());
        }
        let before = self.journal.len();
        let known = self.journal.pieces();
        let finished = ours.iter().filter(|key| known.contains_key(*key)).count();
        let theirs: BTreeSet<String> =
            due.iter().filter(|key| !ours.contains(*key)).cloned().collect();
        let journal = std::mem::replace(&mut self.journal, Journal::forgotten());
        self.journal = journal.shared(move |key| !theirs.contains(key));
        listen();
        let bar = Progress::new(&shard.to_string(), count as u64);
        let progress = |_: f64| bar.set((finished + self.journal.len() - before) as u64);
        let found = work(&self.journal, Watch { go_on: &stopped, progress: &progress });
        bar.finish();
        if found?.is_none() && stopped().is_break() {
            return Err(self.interrupted());
        }
        say!(
            "{shard}: done, {count} of {} are in {}; `{merge} {folder}` tells what is next",
            counted(all, "piece", "pieces"),
            self.path.display()
        );
        Ok(())
    }

    /// The results from the pieces of all workers; if a round is complete, its pieces are merged, and the next round is
    /// open.
    fn merged<T>(
        &self,
        all: &Known,
        workers: usize,
        work: impl Fn(&Journal, Watch<'_>) -> Result<Option<T>, Error>,
    ) -> Result<T, Box<dyn std::error::Error>> {
        let folder = self.folder.display();
        let rest = "--shard 1/1 computes the rest on this machine";
        let due = due(&self.journal.pieces(), &work)?;
        let missing = due.iter().enumerate().filter(|(_, key)| !all.contains_key(*key));
        let missing: Vec<usize> = missing.map(|(place, _)| place).collect();
        if !missing.is_empty() {
            let shards: BTreeSet<usize> = missing.iter().map(|place| place % workers + 1).collect();
            say!(
                "{folder}: {} of {} of this round are missing\nrun these shards of {workers} again: {}; or {rest}",
                missing.len(),
                counted(due.len(), "piece", "pieces"),
                ranges(&shards)
            );
            return Err(Box::new(Missing));
        }
        self.journal.adopt(all.clone())?;
        let journal = Journal::of(all.clone()).shared(|_| false);
        if let Some(found) = work(&journal, quiet())? {
            return Ok(found);
        }
        say!(
            "{folder}: this round is complete; {} missing\nrun all shards again, for the next round; or {rest}",
            counted(
                journal.missing().len(),
                "piece of the next one is",
                "pieces of the next one are"
            )
        );
        Err(Box::new(Missing))
    }

    /// Tells how to continue work that the user has ended, and returns the error for it.
    #[must_use]
    pub fn interrupted(&self) -> Box<dyn std::error::Error> {
        eprintln!(
            "note: {} kept in {}; the same command continues from there",
            counted(self.journal.len(), "finished piece is", "finished pieces are"),
            self.path.display()
        );
        Box::new(Interrupted)
    }
}

/// Creates the folder of a study where there is none, and refuses one that holds another study.
fn begin(folder: &Path, arguments: ShardArguments, study: &Value, anew: bool) -> Result<(), Error> {
    let refused = |error| Err(Error::file(folder, &error));
    if folder.exists() && !folder.is_dir() {
        return refused(ErrorKind::NotADirectory.into());
    }
    if anew {
        discard(folder)?;
    } else if let Some(why) = other(folder, study)? {
        let discard = if arguments.is_part() { "" } else { ", or discard its journal with --anew" };
        return refused(std::io::Error::other(format!(
            "the folder holds another study: {why}; give another folder with -o{discard}"
        )));
    }
    let journals = arguments.shard.map(|_| folder_of(folder));
    let created = journals.as_deref().unwrap_or(folder);
    fs::create_dir_all(created).map_err(|error| Error::file(created, &error))
}

/// The keys of the pieces that are missing beside those that are known, in the order of their text.
fn due<T>(
    known: &Known,
    work: impl Fn(&Journal, Watch<'_>) -> Result<Option<T>, Error>,
) -> Result<Vec<String>, Error> {
    let journal = Journal::of(known.clone()).shared(|_| false);
    work(&journal, quiet())?;
    Ok(journal.missing())
}

/// A watch of work that computes no piece.
fn quiet() -> Watch<'static> {
    Watch { go_on: &stopped, progress: &|_| {} }
}

/// Numbers as a Slurm array takes them: `3,17,20-22`.
fn ranges(numbers: &BTreeSet<usize>) -> String {
    let numbers: Vec<usize> = numbers.iter().copied().collect();
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let run = |run: &[usize]| match run {
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    runs.map(run).collect::<Vec<_>>().join(",")
}

/// The command line of this program, without the shard.
fn given(program: Program) -> Vec<String> {
    let arguments = std::env::args_os().skip(1);
    without_shard(arguments.map(|word| word.to_string_lossy().into_owned()), program)
}

fn without_shard(words: impl Iterator<Item = String>, program: Program) -> Vec<String> {
    let mut command = vec![program.name().to_owned()];
    let mut is_value = false;
    for word in words {
        if !is_value && word != "--shard" && !word.starts_with("--shard=") {
            command.push(word.clone());
        }
        is_value = !is_value && word == "--shard";
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_of_one_machine_is_that_of_a_worker_without_the_shard() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        for given in ["study basin set2 --shard 3/64 -o a", "study basin set2 --shard=3/64 -o a"] {
            let command = without_shard(words(given).into_iter(), Program::Amontons);
            assert_eq!(command, words("amontons study basin set2 -o a"));
        }
    }

    #[test]
    fn numbers_are_told_as_ranges() {
        assert_eq!(ranges(&BTreeSet::from([3, 17, 20, 21, 22, 63, 64])), "3,17,20-22,63-64");
    }
}
