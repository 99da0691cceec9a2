//! MATLAB files (`.mat`) of version 7.3, which are HDF5 files.
//!
//! Layout: MathWorks, MAT-File Versions, and the files themselves. Before the HDF5 part is a block of 512 bytes. A full matrix
//! is a dataset with an attribute `MATLAB_class`, and its transpose, as HDF5 counts rows first. A sparse matrix is a group with
//! an attribute `MATLAB_sparse`, the number of rows, and datasets `jc`, `ir` and `data`, the compressed columns.

use crate::compressed::Compressed;
use crate::matrix::position;
use crate::numbers::{decompressed_limit, dense, too_large};
use crate::text::quote;
use crate::{Fault, Matrix, Place, Symmetry};
use hdf5_pure::{AttrValue, DType, Dataset, Error, Group};

/// The first bytes of the HDF5 part.
const MARK: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Classes of the numbers of real matrices.
const CLASSES: [&str; 11] = [
    "double", "single", "logical", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
    "uint64",
];

/// `true` if the content has an HDF5 part.
#[must_use]
pub fn is_hdf5(content: &[u8]) -> bool {
    [0, 512]
        .into_iter()
        .any(|start| content.get(start..).is_some_and(|part| part.starts_with(MARK)))
}

/// The variables of a file that are real matrices.
pub struct File {
    limit: u64,
    names: Vec<String>,
    variables: Vec<Variable>,
}

/// A matrix.
enum Variable {
    Full(Dataset),
    /// The number of rows, and the group.
    Sparse(u64, Group),
}

impl File {
    /// Finds the matrices.
    ///
    /// # Errors
    /// Returns a fault if the content is no such file.
    pub fn new(content: &[u8]) -> Result<Self, Fault> {
        let limit = decompressed_limit(content.len());
        let mut file = Self { limit, names: Vec::new(), variables: Vec::new() };
        let root = hdf5_pure::File::from_bytes(content.to_vec()).map_err(wrong)?.root();
        for (name, dataset) in root.iter_datasets().map_err(wrong)? {
            let class = match dataset.attrs().map_err(wrong)?.remove("MATLAB_class") {
                Some(AttrValue::String(class) | AttrValue::AsciiString(class)) => class,
                _ => continue,
            };
            if CLASSES.contains(&&*class) && is_real(&dataset.dtype().map_err(wrong)?) {
                file.names.push(name);
                file.variables.push(Variable::Full(dataset));
            }
        }
        for (name, group) in root.iter_groups().map_err(wrong)? {
            let rows = match group.attrs().map_err(wrong)?.remove("MATLAB_sparse") {
                Some(AttrValue::U64(rows)) => rows,
                _ => continue,
            };
            file.names.push(name);
            file.variables.push(Variable::Sparse(rows, group));
        }
        Ok(file)
    }

    /// The names of the matrices.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Reads the matrix of this name.
    ///
    /// # Errors
    /// Returns a fault if there is none, or it is wrong.
    pub fn read(&self, name: &str) -> Result<Matrix, Fault> {
        let found = position(&self.names, name)?;
        let matrix = match &self.variables[found] {
            Variable::Full(dataset) => self.full(dataset),
            Variable::Sparse(rows, group) => self.sparse(*rows, group),
        };
        let mut matrix = matrix.map_err(|fault| Fault {
            place: fault.place,
            message: format!("in the matrix {}: {}", quote(name), fault.message),
        })?;
        matrix.name = Some(name.to_owned());
        Ok(matrix)
    }

    fn full(&self, dataset: &Dataset) -> Result<Matrix, Fault> {
        if dataset.attrs().map_err(wrong)?.contains_key("MATLAB_empty") {
            return Err(Fault::whole("the matrix is empty"));
        }
        let &[columns, rows] = &*dataset.shape().map_err(wrong)? else {
            return Err(Fault::whole("the array has not two dimensions, as a matrix has"));
        };
        self.check(dataset)?;
        let values = dataset.read_f64().map_err(wrong)?;
        dense(size(rows)?, size(columns)?, values.len(), values.into_iter(), false)
    }

    fn sparse(&self, rows: u64, group: &Group) -> Result<Matrix, Fault> {
        let part = |name| {
            let dataset = group.dataset(name).map_err(wrong)?;
            if !is_real(&dataset.dtype().map_err(wrong)?) {
                return Err(Fault::whole(format!(
                    "the values of `{name}` are complex or no numbers; a real matrix is needed: write real(K)"
                )));
            }
            self.check(&dataset)?;
            Ok(dataset)
        };
        let pointers = part("jc")?.read_i64().map_err(wrong)?;
        // Without entries there are no datasets of them.
        let (indices, values) = if pointers.last() == Some(&0) {
            (Vec::new(), Vec::new())
        } else {
            (part("ir")?.read_i64().map_err(wrong)?, part("data")?.read_f64().map_err(wrong)?)
        };
        let parts = Compressed {
            rows: size(rows)?,
            columns: pointers.len().saturating_sub(1),
            symmetry: Symmetry::General,
            by_rows: false,
            base: 0,
            pointers: &pointers,
            indices: &indices,
            values: &values,
        };
        parts.matrix(|_| Place::Whole)
    }

    /// Finds datasets that state more than the limit before memory is reserved for them.
    fn check(&self, dataset: &Dataset) -> Result<(), Fault> {
        let shape = dataset.shape().map_err(wrong)?;
        let chunk = dataset.chunk_shape().map_err(wrong)?.unwrap_or_default();
        for shape in [shape, chunk] {
            let bytes = shape.iter().try_fold(8_u64, |bytes, &length| bytes.checked_mul(length));
            if bytes.is_none_or(|bytes| bytes > self.limit) {
                return Err(too_large(self.limit));
            }
        }
        Ok(())
    }
}

/// The fault for an error of the HDF5 part.
#[expect(clippy::needless_pass_by_value, reason = "it is passed to map_err")]
fn wrong(error: Error) -> Fault {
    Fault::whole(format!(
        "the HDF5 part of the file cannot be read: {error}; write it again with `save -v7`"
    ))
}

fn is_real(kind: &DType) -> bool {
    use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    matches!(kind, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
}

fn size(length: u64) -> Result<usize, Fault> {
    usize::try_from(length).map_err(|_| {
        Fault::whole(format!("the matrix has {length} rows or columns, which are too many"))
    })
}
