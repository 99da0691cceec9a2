//! NumPy arrays of results.

use nalgebra::Complex;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyByteArray;

/// The array of these numbers.
pub fn reals(
    py: Python<'_>,
    values: impl ExactSizeIterator<Item = f64>,
) -> PyResult<Bound<'_, PyAny>> {
    array(py, "float64", values.len(), values)
}

/// The array of these complex numbers.
pub fn complexes<'py>(py: Python<'py>, values: &[Complex<f64>]) -> PyResult<Bound<'py, PyAny>> {
    array(py, "complex128", 2 * values.len(), values.iter().flat_map(|value| [value.re, value.im]))
}

/// The array over memory that has these `count` doubles.
fn array<'py>(
    py: Python<'py>,
    kind: &str,
    count: usize,
    values: impl Iterator<Item = f64>,
) -> PyResult<Bound<'py, PyAny>> {
    // NumPy is imported with the first array, so that the module itself is imported quickly.
    static FROM_BUFFER: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let from_buffer = FROM_BUFFER.import(py, "numpy", "frombuffer")?;
    let memory = PyByteArray::new_with(py, count * size_of::<f64>(), |memory| {
        for (place, value) in memory.chunks_exact_mut(size_of::<f64>()).zip(values) {
            place.copy_from_slice(&value.to_ne_bytes());
        }
        Ok(())
    })?;
    from_buffer.call1((memory, kind))
}
