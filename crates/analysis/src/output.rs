//! Files that appear whole or not at all.

use amontons::Error;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Refuses a file whose folder is not there, before the work whose results it is to hold.
///
/// # Errors
/// Returns an error that names the file and the missing folder.
pub fn check_folder(file: &Path) -> Result<(), Error> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => Err(Error::unusable_file(format!(
            "cannot write {}: there is no folder {}",
            file.display(),
            folder.display()
        ))),
        _ => Ok(()),
    }
}

/// Refuses an output that would replace a file that the same command reads.
///
/// # Errors
/// Returns an error if the output would replace such a file.
pub fn check_inputs_stay(output: &Path, inputs: &[&Path]) -> Result<(), Error> {
    let real = |path: &Path| path.canonicalize().ok();
    match inputs.iter().find(|input| real(input).is_some_and(|input| real(output) == Some(input))) {
        Some(input) => Err(Error::argument(format!(
            "-o {} would replace a file that this command reads: give another name",
            input.display()
        ))),
        None => Ok(()),
    }
}

/// Writes a file, which appears complete or not at all.
///
/// # Errors
/// Returns an error if the file cannot be written; a file that was there before is then unchanged.
pub fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(content).map_err(|error| Error::file(path, &error))?;
    file.complete()
}

/// A file that is written under another name until it is complete. A file that was at the target before is kept until
/// then; an interrupted run leaves its results in the file ending in `.partial`. A target that is not a regular file
/// (a pipe, a device) is written to directly.
pub struct AtomicFile {
    target: PathBuf,
    partial: Option<PathBuf>,
    writer: BufWriter<File>,
}

impl AtomicFile {
    /// Begins a file that is to stand at `target`.
    ///
    /// # Errors
    /// Returns an error if a folder has that path, or if its folder cannot be written to.
    pub fn create(target: &Path) -> Result<Self, Error> {
        let open = || -> io::Result<Self> {
            // A symbolic link is followed to its target.
            let real = target.canonicalize().unwrap_or_else(|_| target.to_owned());
            if real.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            if real.exists() && !real.is_file() {
                let writer = BufWriter::new(File::options().write(true).open(&real)?);
                return Ok(Self { target: real, partial: None, writer });
            }
            let mut name = real.file_name().ok_or(io::ErrorKind::InvalidFilename)?.to_owned();
            name.push(".partial");
            let partial = real.with_file_name(name);
            let writer = BufWriter::new(File::create(&partial)?);
            Ok(Self { target: real, partial: Some(partial), writer })
        };
        open().map_err(|error| Error::file(target, &error))
    }

    /// Path of the partial file that an interrupted run leaves; `None` if the file is written directly.
    #[must_use]
    pub fn partial(&self) -> Option<&Path> {
        self.partial.as_deref()
    }

    /// Puts the file at its place.
    ///
    /// # Errors
    /// Returns an error if the content could not all be written; the file that was at the target before is then
    /// unchanged.
    pub fn complete(self) -> Result<(), Error> {
        let Self { target, partial, writer } = self;
        let finish = || {
            let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
            match &partial {
                Some(partial) => file.sync_all().and_then(|()| fs::rename(partial, &target)),
                None => Ok(()),
            }
        };
        finish().map_err(|error| Error::file(&target, &error))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
