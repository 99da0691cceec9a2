//! One study on many machines: each worker computes a part of the pieces and notes them in a journal of its own, and
//! merging puts all journals together.
//!
//! | file | contents |
//! | --- | --- |
//! | `identity` | which study a folder holds |
//! | `workers` | the journals of all workers in a folder |
//! | `pieces` | the pieces of a study, as one machine, a worker or a merge computes them |

mod identity;
mod pieces;
mod workers;

pub use identity::{identity, matrices, other};
pub use pieces::Pieces;

use amontons::Error;
use clap::{Args, CommandFactory, FromArgMatches};
use std::fmt;
use std::path::Path;
use workers::Workers;

/// The options of a command whose work several workers can share.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct ShardArguments {
    /// Compute only part I of N of the pieces that are due, as one of N workers that share the folder of -o; `merge DIR`
    /// puts the pieces of all workers together, tells what is missing, and writes the results when nothing is
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub shard: Option<Shard>,
    /// Put the pieces of all workers together.
    #[arg(long, hide = true, conflicts_with = "shard")]
    pub merge: bool,
}

impl ShardArguments {
    /// `true` if the command is a part of the work of several workers.
    #[must_use]
    pub fn is_part(&self) -> bool {
        self.shard.is_some() || self.merge
    }

    /// The folder that -o names, for a command that has a file there without workers.
    ///
    /// # Errors
    /// Returns an error if -o is missing, or names a file.
    pub fn folder<'a>(&self, output: Option<&'a Path>) -> Result<&'a Path, Error> {
        let folder = output.ok_or_else(|| self.without_folder())?;
        if folder.extension().is_some_and(|ending| ending == "csv") {
            return Err(Error::argument(format!(
                "with --shard, -o names the folder that all workers share, in which merging writes results.csv; {} is \
                 the name of a file",
                folder.display()
            )));
        }
        Ok(folder)
    }

    /// The error that a worker is given no folder.
    #[must_use]
    pub fn without_folder(&self) -> Error {
        Error::argument("--shard needs -o DIR: the folder that all workers share")
    }
}

/// One of several workers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    /// Number of all workers.
    of: usize,
    /// Number of this one, from 1 on.
    number: usize,
}

impl Shard {
    /// Parses `I/N`.
    ///
    /// # Errors
    /// Returns the mistake, for the message of the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let whole = |text: &str| text.parse::<usize>().ok();
        match text.split_once('/').and_then(|(number, of)| whole(number).zip(whole(of))) {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { of, number }),
            _ => Err("must be the number of this worker and that of all workers, from 1/N to N/N, such as 3/64"
                .to_owned()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "shard {} of {}", self.number, self.of)
    }
}

/// The program that computes the pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// `amontons`
    Amontons,
    /// `amontons-stability`
    Stability,
}

impl Program {
    const ALL: [Self; 2] = [Self::Amontons, Self::Stability];

    fn name(self) -> &'static str {
        match self {
            Self::Amontons => "amontons",
            Self::Stability => "amontons-stability",
        }
    }

    /// The command of this program that puts the pieces of all workers together.
    fn merge(self) -> &'static str {
        match self {
            Self::Amontons => "amontons study merge",
            Self::Stability => "amontons-stability merge",
        }
    }
}

/// The error that pieces are missing, which was told.
#[derive(Debug)]
pub struct Missing;

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("pieces are missing")
    }
}

impl std::error::Error for Missing {}

/// Tells the command of the workers of a folder, after merging has failed.
pub fn tell_command(folder: &Path) {
    if let Ok(command) = Workers::of(folder).and_then(|workers| workers.command(folder)) {
        eprintln!(
            "note: this merges the workers of `{}`; relative paths in it are those of the folder in which they were started",
            command.join(" ")
        );
    }
}

/// The arguments with which a program puts the pieces in a folder together: those of the workers, with the folder.
///
/// # Errors
/// Returns an error if the folder has no journal of a worker, or one of another program.
pub fn merging<T: CommandFactory + FromArgMatches>(
    program: Program,
    folder: &Path,
) -> Result<T, Error> {
    let command = Workers::of(folder)?.command(folder)?;
    let first = command.first().map(String::as_str);
    if let Some(other) = Program::ALL.into_iter().find(|other| *other != program)
        && first == Some(other.name())
    {
        return Err(Error::argument(format!(
            "the workers of {0} are of another program: use `{1} {0}`",
            folder.display(),
            other.merge()
        )));
    }
    let unknown = |error: &dyn fmt::Display| {
        Error::unusable_file(format!(
            "the command of the workers of {} is not one of this version: {error}",
            folder.display()
        ))
    };
    let arguments = command.iter().map(Into::into);
    let folder_again = ["--merge".into(), "--output".into(), folder.as_os_str().to_owned()];
    let matches = T::command()
        .args_override_self(true)
        .try_get_matches_from(arguments.chain(folder_again))
        .map_err(|error| unknown(&error))?;
    T::from_arg_matches(&matches).map_err(|error| unknown(&error))
}
