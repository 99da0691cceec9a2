//! Picture files: told apart by their endings, whole or not there.

use crate::Error;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// What a picture's name asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Svg,
    Png,
}

impl Format {
    pub(super) fn of(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match &*ending {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            _ => Err(Error::picture(format!(
                "cannot write {}: the name of a picture ends in .svg or .png",
                path.display()
            ))),
        }
    }
}

/// Refuses the name of a picture that cannot be one, before the work that it would show.
///
/// # Errors
/// An ending other than `.svg` and `.png`.
pub fn check_name(path: &Path) -> Result<(), Error> {
    Format::of(path).map(|_| ())
}

/// Writes beside the file and then renames, so that what stood there stays until all is well.
pub(super) fn save(path: &Path, content: &[u8]) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let partial = path.with_file_name(name);
    let write = || {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let mut file = File::create(&partial)?;
        let written = file.write_all(content).and_then(|()| file.sync_all());
        let renamed = written.and_then(|()| fs::rename(&partial, path));
        if renamed.is_err() {
            // The first error is the one to tell.
            let _ = fs::remove_file(&partial);
        }
        renamed
    };
    write().map_err(|error| Error::picture(format!("cannot write {}: {error}", path.display())))
}
