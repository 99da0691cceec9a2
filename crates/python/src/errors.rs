//! Exceptions, which have the texts of the crates' errors. Python defines them.

use pyo3::PyErr;

pyo3::import_exception!(amontons, Error);
pyo3::import_exception!(amontons, ArgumentError);
pyo3::import_exception!(amontons, FileError);
pyo3::import_exception!(amontons, SceneError);
pyo3::import_exception!(amontons, EquilibriumError);
pyo3::import_exception!(amontons, AnalysisError);
pyo3::import_exception!(amontons, StepError);

/// The exception for an error of the crates.
#[allow(clippy::needless_pass_by_value)]
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
