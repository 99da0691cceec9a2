//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A file that is written under another name until it is complete. What stood at its place stays
/// until then; an interrupted run leaves what it had in the file ending in `.partial`.
pub struct Pending {
    target: PathBuf,
    partial: PathBuf,
    pub writer: BufWriter<File>,
}

impl Pending {
    pub fn create(target: &Path) -> Result<Self, String> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".partial");
        let partial = target.with_file_name(name);
        let file = if target.is_dir() {
            Err(io::Error::from(io::ErrorKind::IsADirectory))
        } else {
            File::create(&partial)
        };
        let file = file.map_err(|error| format!("cannot write {}: {error}", target.display()))?;
        Ok(Self { target: target.to_owned(), partial, writer: BufWriter::new(file) })
    }

    pub fn complete(self) -> Result<(), String> {
        let finish = || {
            self.writer.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
            fs::rename(&self.partial, &self.target)
        };
        finish().map_err(|error| format!("cannot write {}: {error}", self.target.display()))
    }
}
