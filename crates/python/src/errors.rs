//! Exceptions, which have the texts of the crates' errors.

use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, create_exception};

create_exception!(
    amontons,
    Error,
    PyValueError,
    "Any error of Amontons; its text says what is wrong, where, and what would be right."
);
create_exception!(
    amontons,
    ArgumentError,
    Error,
    "An unknown name, or an argument that is impossible."
);
create_exception!(amontons, FileError, Error, "A file that cannot be read or written.");
create_exception!(amontons, SceneError, Error, "A scene with a wrong key or an impossible value.");
create_exception!(
    amontons,
    EquilibriumError,
    Error,
    "A scene without a static equilibrium: it jams, or a contact opens."
);
create_exception!(amontons, AnalysisError, Error, "An analysis that has no result.");
create_exception!(
    amontons,
    StepError,
    Error,
    "A step that fails, or is longer than the critical one."
);

/// The exception for an error of the crates.
pub fn raised(error: amontons::Error) -> PyErr {
    let text = error.to_string();
    match error {
        e if e.is_file() || e.is_package() || e.is_picture() => FileError::new_err(text),
        e if e.is_scene() => SceneError::new_err(text),
        e if e.is_equilibrium() => EquilibriumError::new_err(text),
        e if e.is_step() || e.is_step_too_large() => StepError::new_err(text),
        e if e.is_analysis() => AnalysisError::new_err(text),
        e if e.is_argument() || e.is_variable() => ArgumentError::new_err(text),
        _ => Error::new_err(text),
    }
}
