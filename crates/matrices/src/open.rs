//! From the name of a file to its matrices.

use crate::text::quote;
use crate::{
    Error, Fault, Freedom, Matrix, abaqus, calculix, dmig, harwell_boeing, mapping, mat, mat73,
    matrix_market, npy, npz, output4,
};
use std::convert::Infallible;
use std::fmt;
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
            // A `#` in the name of a folder.
            Some((path, name)) if !name.contains(['/', '\\']) => {
                Self { path: path.into(), name: Some(name.to_owned()) }
            }
            _ => Self { path: text.into(), name: None },
        })
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        self.name.as_ref().map_or(Ok(()), |name| write!(f, "#{name}"))
    }
}

/// Reads the matrix at a location. The extension of the file says its format.
///
/// # Errors
/// Returns an error if the file cannot be read, has no known extension, is wrong, has no matrix of this name, or holds
/// several and the location names none.
pub fn open(location: &Location) -> Result<Matrix, Error> {
    let path = &location.path;
    let name = location.name.as_deref();
    let content = bytes(path)?;
    let content = &*content;
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let read = match &*extension {
        "mtx" if matrix_market::is_matrix_market(content) => matrix_market::read(content),
        // Abaqus uses this extension too.
        "mtx" => abaqus::read(content).and_then(|matrices| pick(matrices, name)),
        "hb" | "rb" | "rua" | "rsa" | "rra" | "rza" | "matrix" | "stiff" | "mass" | "damp" => {
            let freedoms = companion(path, ["mapping", "MAPPING"], mapping::read)?;
            harwell_boeing::read(content).and_then(|matrix| match freedoms {
                Some(freedoms) => matrix.with_freedoms(freedoms),
                None => Ok(matrix),
            })
        }
        "npy" => npy::read(content),
        "npz" => npz::Archive::new(content).and_then(|mut archive| {
            let name = choose(archive.names(), name)?.to_owned();
            archive.read(&name)
        }),
        "mat" if mat73::is_hdf5(content) => {
            mat73::File::new(content).and_then(|file| file.read(choose(file.names(), name)?))
        }
        "mat" => mat::File::new(content).and_then(|file| file.read(choose(file.names(), name)?)),
        "sti" | "mas" => {
            let Some(freedoms) = companion(path, ["dof", "DOF"], calculix::freedoms)? else {
                let message = "the file with the nodes and directions of the rows is not there: the same name with .dof; copy it beside";
                return Err(Error::new(path, Fault::whole(message)));
            };
            calculix::read(content).and_then(|matrix| matrix.with_freedoms(freedoms))
        }
        "pch" | "dmig" | "bdf" => dmig::read(content).and_then(|matrices| pick(matrices, name)),
        "op4" => output4::read(content).and_then(|matrices| pick(matrices, name)),
        _ => Err(Fault::whole(format!(
            "the extension .{extension} belongs to no known format; known are {KNOWN}"
        ))),
    };
    let matrix = read.map_err(|fault| Error::new(path, fault))?;
    match name {
        Some(name) if matrix.name.is_none() => {
            let message =
                format!("the file holds one matrix, which has no name; leave out #{name}");
            Err(Error::new(path, Fault::whole(message)))
        }
        _ => Ok(matrix),
    }
}

/// The extensions of the formats, for messages.
const KNOWN: &str = ".mtx (Matrix Market, Abaqus), .hb, .rb, .rua, .rsa, .rra, .rza, .matrix, .stiff, .mass and .damp \
                     (Harwell–Boeing, as HBMAT of Ansys writes it), .npy and .npz (NumPy, SciPy), .mat (MATLAB), .sti and .mas \
                     (CalculiX), .pch, .dmig and .bdf (DMIG of Nastran), .op4 (OUTPUT4 of Nastran)";

fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    let fault = |error| Fault::whole(format!("cannot read the file: {error}"));
    fs::read(path).map_err(|error| Error::new(path, fault(error)))
}

/// The degrees of freedom in the file of the same name with one of these extensions, if there is one.
fn companion(
    path: &Path,
    extensions: [&str; 2],
    read: impl Fn(&[u8]) -> Result<Vec<Freedom>, Fault>,
) -> Result<Option<Vec<Freedom>>, Error> {
    let mut paths = extensions.iter().map(|extension| path.with_extension(extension));
    let Some(path) = paths.find(|path| path.exists()) else {
        return Ok(None);
    };
    read(&bytes(&path)?).map(Some).map_err(|fault| Error::new(&path, fault))
}

/// Chooses the name of a matrix of a file that can hold several: this one, or the only one.
fn choose<'a>(names: &'a [String], name: Option<&str>) -> Result<&'a str, Fault> {
    let list = || -> String {
        let shown: Vec<_> = names.iter().take(20).map(|name| quote(name)).collect();
        let more = if names.len() > shown.len() { " and more" } else { "" };
        shown.join(", ") + more
    };
    match (name, names) {
        (_, []) => Err(Fault::whole(
            "there is no real matrix in the file; write one with two dimensions into it",
        )),
        (Some(name), _) => {
            let found = names.iter().find(|known| *known == name);
            found.map(|name| &**name).ok_or_else(|| {
                Fault::whole(format!("there is no matrix {}; there are {}", quote(name), list()))
            })
        }
        (None, [only]) => Ok(only),
        (None, _) => Err(Fault::whole(format!(
            "there are several matrices: {}; choose one by its name after #, as in FILE#NAME",
            list()
        ))),
    }
}

/// The matrix of this name, or the only one, of those that a file holds.
fn pick(matrices: Vec<Matrix>, name: Option<&str>) -> Result<Matrix, Fault> {
    let names: Vec<String> =
        matrices.iter().map(|matrix| matrix.name.clone().unwrap_or_default()).collect();
    let chosen = match &*names {
        // The caller tells that the only matrix has no name.
        [only] if only.is_empty() => only,
        _ => choose(&names, name)?,
    };
    let mut found = matrices.into_iter().zip(&names).filter(|(_, name)| *name == chosen);
    match (found.next(), found.next()) {
        (Some((matrix, _)), None) => Ok(matrix),
        _ => Err(Fault::whole(format!(
            "there are several matrices of the name {}; leave one of them in the file",
            quote(chosen)
        ))),
    }
}
