//! The reasons for which an examination cannot be carried out. Mistakes in an FMU are [`Finding`](crate::Finding)s
//! instead.

use std::io;
use std::path::Path;

/// The reason for which an examination cannot be carried out, in words for the user: the mistake and its place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Error(String);

impl Error {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }

    pub(crate) fn file(path: &Path, error: &io::Error) -> Self {
        Self(format!("cannot use {}: {error}", path.display()))
    }
}
