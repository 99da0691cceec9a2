//! The file that says of which matrices a structure is made.

use crate::quadratic::Quadratic;
use crate::sparse::Sparse;
use amontons::Error;
use amontons_matrices::{Location, Matrix, align, name_rows, open, read_freedoms};
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// A structure M q̈ + C q̇ + K q = 0 whose matrices are sums of parts, each of which a file holds.
#[derive(Clone, Debug)]
pub struct Family {
    parameter: Option<Parameter>,
    /// A table that names the rows of files that do not name their own.
    freedoms: Option<PathBuf>,
    parts: Vec<Part>,
}

/// The parameter on which the matrices depend.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Its name, for tables and pictures.
    pub name: String,
    /// Its unit.
    #[serde(default)]
    pub unit: String,
    /// The value at which parts with a power stand as their files hold them.
    #[serde(default = "one")]
    pub reference: f64,
    /// Its values, in the order in which modes are followed.
    pub values: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    freedoms: Option<PathBuf>,
    #[serde(default)]
    parameter: Option<Parameter>,
    #[serde(default)]
    part: Vec<PartOfFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PartOfFile {
    matrix: Kind,
    file: Option<String>,
    files: Option<Vec<String>>,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    power: f64,
}

const fn one() -> f64 {
    1.0
}

/// The matrix of which a file is a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Mass,
    /// What multiplies velocities: dampers and gyroscopic forces.
    #[serde(alias = "gyroscopic")]
    Damping,
    /// What multiplies displacements: springs, circulatory and geometric forces.
    #[serde(alias = "circulatory")]
    Stiffness,
}

#[derive(Clone, Debug)]
struct Part {
    kind: Kind,
    /// One for all values of the parameter, or one for each.
    files: Vec<Location>,
    factor: f64,
    power: f64,
}

impl Family {
    /// The structure of one mass matrix, one stiffness matrix and one damping matrix, or of several of each, which are added.
    /// `freedoms` is a table that names the rows of files that do not name their own.
    #[must_use]
    pub fn of_files(
        mass: &[Location],
        damping: &[Location],
        stiffness: &[Location],
        freedoms: Option<PathBuf>,
    ) -> Self {
        let kinds = [(Kind::Mass, mass), (Kind::Damping, damping), (Kind::Stiffness, stiffness)];
        let parts = kinds.into_iter().flat_map(|(kind, files)| {
            files.iter().map(move |file| Part {
                kind,
                files: vec![file.clone()],
                factor: 1.0,
                power: 0.0,
            })
        });
        Self { parameter: None, freedoms, parts: parts.collect() }
    }

    /// Reads a description; files in it are sought from its folder.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or says something that cannot be.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = fs::read_to_string(path).map_err(|error| Error::file(path, &error))?;
        let wrong = |what: String| Error::scene(format!("{}: {what}", path.display()));
        let description: Description =
            toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        Self::new(description, &folder).map_err(wrong)
    }

    fn new(description: Description, folder: &Path) -> Result<Self, String> {
        let Description { freedoms, parameter, part } = description;
        let count = parameter.as_ref().map_or(1, |parameter| parameter.values.len());
        if let Some(Parameter { name, reference, values, .. }) = &parameter {
            if values.is_empty() || !values.iter().all(|value| value.is_finite()) {
                return Err(format!("parameter.values of {name} must be a list of finite numbers"));
            }
            if !reference.is_normal() {
                return Err(format!(
                    "parameter.reference = {reference} must be a number that is not 0"
                ));
            }
        }
        let mut parts = Vec::new();
        for (number, part) in (1..).zip(part) {
            let files = match (part.file, part.files) {
                (Some(file), None) => vec![file],
                (None, Some(files)) if files.len() == count && parameter.is_some() => files,
                (None, Some(files)) => {
                    return Err(format!(
                        "part {number} has {} files and the parameter has {count} values; give one file for each value",
                        files.len()
                    ));
                }
                _ => return Err(format!("part {number} must have either file or files")),
            };
            if !part.factor.is_finite() || !part.power.is_finite() {
                return Err(format!("factor and power of part {number} must be finite"));
            }
            if part.power != 0.0 && parameter.is_none() {
                return Err(format!(
                    "part {number} has a power, but there is no [parameter] of which it could be one"
                ));
            }
            let files = files.iter().map(|file| {
                let Ok(mut location) = file.parse::<Location>();
                location.path = folder.join(location.path);
                location
            });
            let files = files.collect();
            parts.push(Part { kind: part.matrix, files, factor: part.factor, power: part.power });
        }
        for (kind, name) in [(Kind::Mass, "mass"), (Kind::Stiffness, "stiffness")] {
            if !parts.iter().any(|part| part.kind == kind) {
                return Err(format!("no part has matrix = \"{name}\"; a structure needs one"));
            }
        }
        Ok(Self { parameter, freedoms: freedoms.map(|path| folder.join(path)), parts })
    }

    /// The parameter on which the matrices depend; `None` if they are fixed.
    #[must_use]
    pub const fn parameter(&self) -> Option<&Parameter> {
        self.parameter.as_ref()
    }

    /// Takes other values of the parameter.
    ///
    /// # Errors
    /// Returns an error if there is no parameter of this name, or if a part has a file for each of the old values.
    pub fn set_values(&mut self, name: &str, values: Vec<f64>) -> Result<(), Error> {
        let Some(parameter) = self.parameter.as_mut().filter(|parameter| parameter.name == name)
        else {
            return Err(Error::argument(match &self.parameter {
                Some(parameter) => {
                    format!("the matrices depend on {}, not on {name}", parameter.name)
                }
                None => format!("the matrices do not depend on {name}: there is no [parameter]"),
            }));
        };
        if self.parts.iter().any(|part| part.files.len() > 1) {
            return Err(Error::argument(format!(
                "{name} has one file for each of its values, so no others can be given"
            )));
        }
        parameter.values = values;
        Ok(())
    }

    /// The number of members: one for each value of the parameter, or one.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parameter.as_ref().map_or(1, |parameter| parameter.values.len())
    }

    /// The factor of a part at the value of this place in the list.
    fn factor(&self, part: &Part, place: usize) -> Result<f64, Error> {
        let Some(parameter) = self.parameter.as_ref().filter(|_| part.power != 0.0) else {
            return Ok(part.factor);
        };
        let value = parameter.values[place];
        let factor = part.factor * libm::pow(value / parameter.reference, part.power);
        if factor.is_finite() {
            return Ok(factor);
        }
        Err(Error::argument(format!(
            "a part with power = {} has no finite factor at {} = {value}; leave out this value",
            part.power, parameter.name
        )))
    }

    /// Reads the files that all values of the parameter share.
    ///
    /// # Errors
    /// Returns an error if one cannot be read.
    pub fn load(&self) -> Result<Loaded<'_>, Box<dyn std::error::Error>> {
        let shared = self.parts.iter().map(|part| match &*part.files {
            [file] => open(file).map(Some),
            _ => Ok(None),
        });
        Ok(Loaded { family: self, shared: shared.collect::<Result<_, _>>()? })
    }
}

/// A family with the files that all its members share.
pub struct Loaded<'a> {
    family: &'a Family,
    /// For each part, its matrix if it has one file.
    shared: Vec<Option<Matrix>>,
}

impl Loaded<'_> {
    /// The structure at the value of this place in the list.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read, or if the matrices are not square and of one size.
    pub fn member(&self, place: usize) -> Result<Quadratic, Box<dyn std::error::Error>> {
        let parts = &self.family.parts;
        let matrices = parts.iter().zip(&self.shared).map(|(part, shared)| match shared {
            Some(matrix) => Ok(matrix.clone()),
            None => open(&part.files[place]),
        });
        let mut matrices = matrices.collect::<Result<Vec<Matrix>, _>>()?;
        if let Some(path) = &self.family.freedoms {
            let freedoms = read_freedoms(path)?;
            for matrix in matrices.iter_mut().filter(|matrix| matrix.freedoms.is_none()) {
                name_rows(matrix, &freedoms, path)?;
            }
        }
        let file = |part: &Part| part.files[place.min(part.files.len() - 1)].to_string();
        let files: Vec<String> = parts.iter().map(file).collect();
        align(&mut matrices.iter_mut().collect::<Vec<_>>(), &files).map_err(Error::argument)?;
        let size = [matrices[0].rows, matrices[0].columns];
        let mut sums = [const { None::<Sparse> }; 3];
        for ((part, file), matrix) in parts.iter().zip(&files).zip(&matrices) {
            if [matrix.rows, matrix.columns] != size || size[0] != size[1] {
                return Err(Box::new(Error::argument(format!(
                    "{file} has {} rows and {} columns, and the first part {}; all must be square and of one size",
                    matrix.rows, matrix.columns, size[0],
                ))));
            }
            let matrix = Sparse::new(matrix)?;
            let factor = self.family.factor(part, place)?;
            let sum = &mut sums[part.kind as usize];
            *sum = Some(match sum.take() {
                Some(before) => before.sum(1.0, &matrix, factor),
                None => matrix.scaled(factor),
            });
        }
        let [mass, damping, stiffness] = sums.map(|sum| match sum {
            Some(sum) => Ok(sum),
            None => Sparse::from_entries(size[0], size[1], []),
        });
        Ok(Quadratic::new(mass?, damping?, stiffness?)?)
    }
}
