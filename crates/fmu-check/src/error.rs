//! Reasons why an examination cannot be carried out. What is wrong with an FMU is a [`Finding`](crate::Finding)
//! instead.

use std::io;
use std::path::Path;

/// Why an examination cannot be carried out, in words for the user: what is wrong, and where.
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
