//! Faults of files, with their places.

use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Offset(usize),
    /// The file as a whole.
    Whole,
}

/// A fault in the content of a file: its place, and a message with the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The place in the content.
    pub place: Place,
    /// A sentence without its full stop: what is wrong, and after a semicolon the remedy.
    pub message: String,
}

impl Fault {
    /// A fault in a line of text, counted from 1.
    pub fn line(line: usize, message: impl Into<String>) -> Self {
        Self { place: Place::Line(line), message: message.into() }
    }

    /// A fault at a byte, counted from 0.
    pub fn offset(offset: usize, message: impl Into<String>) -> Self {
        Self { place: Place::Offset(offset), message: message.into() }
    }

    /// A fault of the file as a whole.
    pub fn whole(message: impl Into<String>) -> Self {
        Self { place: Place::Whole, message: message.into() }
    }
}

/// A file that could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    path: PathBuf,
    fault: Fault,
}

impl Error {
    /// The error of a file with this fault.
    #[must_use]
    pub fn new(path: &Path, fault: Fault) -> Self {
        Self { path: path.to_owned(), fault }
    }

    /// The fault in the file.
    #[must_use]
    pub const fn fault(&self) -> &Fault {
        &self.fault
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        match self.fault.place {
            Place::Line(line) => write!(f, ", line {line}")?,
            Place::Offset(offset) => write!(f, ", byte {offset}")?,
            Place::Whole => {}
        }
        write!(f, ": {}", self.fault.message)
    }
}

impl std::error::Error for Error {}
