//! Picture files: told apart by their endings, whole or not there.

use amontons::Error;
use amontons_analysis::output::{AtomicFile, check_folder};
use std::io::Write;
use std::path::Path;

/// The format that a picture's name asks for.
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
                "cannot write {}: the name of a picture must end in .svg or .png",
                path.display()
            ))),
        }
    }
}

/// Refuses the name of a picture that cannot be one, before the work that it would show.
///
/// # Errors
/// Returns an error if the ending is not `.svg` or `.png`, or if the folder does not exist.
pub fn check_name(path: &Path) -> Result<(), Error> {
    Format::of(path)?;
    check_folder(path)
}

/// Writes a picture that replaces what stood there when it is complete.
pub(super) fn save(path: &Path, content: &[u8]) -> Result<(), Error> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(content).map_err(|error| Error::file(path, &error))?;
    file.complete()
}
