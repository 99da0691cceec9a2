//! From the name of a file to its matrices.

use crate::{Error, Fault, Matrix};
use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A matrix in a file: a path, and after `#` the name of one matrix where the file holds several (`brake.mat#K1`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub path: PathBuf,
    /// The name of the matrix in the file.
    pub name: Option<String>,
}

impl FromStr for Location {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.rsplit_once('#') {
            Some((path, name)) => Self { path: path.into(), name: Some(name.to_owned()) },
            None => Self { path: text.into(), name: None },
        })
    }
}

/// Reads the matrix at a location. The extension of the file says its format.
///
/// # Errors
/// Returns an error if the file cannot be read, has no known extension, is wrong, has no matrix of this name, or holds
/// several and the location names none.
pub fn open(location: &Location) -> Result<Matrix, Error> {
    let path = &location.path;
    let fault = |fault| Error::new(path, fault);
    let content = fs::read(path)
        .map_err(|error| fault(Fault::whole(format!("cannot read the file: {error}"))))?;
    let matrices = read(path, &content).map_err(fault)?;
    choose(matrices, location.name.as_deref()).map_err(fault)
}

/// Reads all matrices of a file with the reader of its extension.
fn read(path: &Path, content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let _ = content;
    match &*extension {
        _ => Err(Fault::whole(format!("the extension .{extension} belongs to no known format"))),
    }
}

/// The matrix of this name, or the only one.
fn choose(mut matrices: Vec<Matrix>, name: Option<&str>) -> Result<Matrix, Fault> {
    let names = || -> String {
        let names = matrices.iter().map(|matrix| matrix.name.as_deref().unwrap_or("(no name)"));
        names.collect::<Vec<_>>().join(", ")
    };
    let found = match name {
        Some(name) => {
            matrices.iter().position(|matrix| matrix.name.as_deref() == Some(name)).ok_or_else(
                || Fault::whole(format!("there is no matrix {name}; there are: {}", names())),
            )?
        }
        None if matrices.len() == 1 => 0,
        None if matrices.is_empty() => return Err(Fault::whole("there is no matrix in the file")),
        None => {
            return Err(Fault::whole(format!(
                "there are several matrices: {}; choose one by its name after #, such as FILE#NAME",
                names()
            )));
        }
    };
    Ok(matrices.swap_remove(found))
}
