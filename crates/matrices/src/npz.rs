//! Archives of NumPy arrays (`.npz`): a sparse matrix as `scipy.sparse.save_npz` writes it, or several dense matrices as
//! `numpy.savez` does.

use crate::builder::Builder;
use crate::compressed::Compressed;
use crate::npy::Array;
use crate::numbers::{decompressed_limit, too_large, within};
use crate::text::quote;
use crate::{Fault, Matrix, Place, Symmetry};
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// The matrices of an archive.
pub struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    limit: u64,
    sparse: bool,
    names: Vec<String>,
}

impl<'a> Archive<'a> {
    /// Reads the names of the matrices.
    ///
    /// # Errors
    /// Returns a fault if the content is no archive.
    pub fn new(content: &'a [u8]) -> Result<Self, Fault> {
        let zip = ZipArchive::new(Cursor::new(content)).map_err(|error| {
            Fault::whole(format!("the file is no archive: {error}; write it with scipy.sparse.save_npz or numpy.savez"))
        })?;
        let members = zip.file_names().filter_map(Result::ok);
        let mut names: Vec<_> =
            members.filter_map(|name| Some(name.strip_suffix(".npy")?.to_owned())).collect();
        let sparse =
            ["format", "data"].into_iter().all(|part| names.iter().any(|name| name == part));
        if sparse {
            names = vec!["data".to_owned()];
        }
        Ok(Self { zip, limit: decompressed_limit(content.len()), sparse, names })
    }

    /// The names of the matrices; that of a sparse matrix is `data`.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Reads the matrix of this name.
    ///
    /// # Errors
    /// Returns a fault if there is none, or it is wrong.
    pub fn read(&mut self, name: &str) -> Result<Matrix, Fault> {
        let mut matrix = if self.sparse {
            self.read_sparse()?
        } else {
            let content = self.member(name)?;
            let array = Array::parse(&content)?;
            within(self.limit, array.numbers()?)?;
            array.matrix()?
        };
        matrix.name = Some(name.to_owned());
        Ok(matrix)
    }

    /// The content of a member.
    fn member(&mut self, name: &str) -> Result<Vec<u8>, Fault> {
        let fault = |error: &dyn std::fmt::Display| {
            Fault::whole(format!(
                "the member {} cannot be read: {error}; write the file again",
                quote(name)
            ))
        };
        let file = self.zip.by_name(&format!("{name}.npy")).map_err(|error| fault(&error))?;
        let mut content = Vec::new();
        file.take(self.limit + 1).read_to_end(&mut content).map_err(|error| fault(&error))?;
        if content.len() as u64 > self.limit { Err(too_large(self.limit)) } else { Ok(content) }
    }

    /// The integers of a member.
    fn integers(&mut self, name: &str) -> Result<Vec<i64>, Fault> {
        let content = self.member(name)?;
        within(self.limit, Array::parse(&content)?.numbers()?)?
            .integers()
            .ok_or_else(|| Fault::whole(format!("the member {name}.npy must hold whole numbers")))
    }

    /// The sparse matrix.
    fn read_sparse(&mut self) -> Result<Matrix, Fault> {
        let format = self.member("format")?;
        let format = Array::parse(&format)?;
        let format = format.text().unwrap_or_default();
        let shape = self.integers("shape")?;
        let sizes: Option<Vec<_>> =
            shape.iter().map(|&length| usize::try_from(length).ok()).collect();
        let Some(&[rows, columns]) = sizes.as_deref() else {
            return Err(Fault::whole(
                "the member shape.npy must hold two numbers, those of rows and columns",
            ));
        };
        let values = self.member("data")?;
        let values: Vec<_> =
            within(self.limit, Array::parse(&values)?.numbers()?)?.reals().collect();
        match format {
            "csc" | "csr" => {
                let pointers = self.integers("indptr")?;
                let indices = self.integers("indices")?;
                let parts = Compressed {
                    rows,
                    columns,
                    symmetry: Symmetry::General,
                    by_rows: format == "csr",
                    base: 0,
                    pointers: &pointers,
                    indices: &indices,
                    values: &values,
                };
                parts.matrix(|_| Place::Whole)
            }
            "coo" => {
                coordinates(rows, columns, &self.integers("row")?, &self.integers("col")?, &values)
            }
            _ => Err(Fault::whole(format!(
                "the sparse layout {} is unknown; known are csc, csr and coo: convert the matrix with tocsc()",
                quote(format)
            ))),
        }
    }
}

/// A matrix from the row, the column and the value of each entry.
fn coordinates(
    rows: usize,
    columns: usize,
    row: &[i64],
    column: &[i64],
    values: &[f64],
) -> Result<Matrix, Fault> {
    if row.len() != values.len() || column.len() != values.len() {
        return Err(Fault::whole(format!(
            "there are {} rows, {} columns and {} values of entries; each entry needs one of all three",
            row.len(),
            column.len(),
            values.len()
        )));
    }
    let mut builder = Builder::new(rows, columns, Symmetry::General);
    for ((&row, &column), &value) in row.iter().zip(column).zip(values) {
        let (Ok(row), Ok(column)) = (row.try_into(), column.try_into()) else {
            return Err(Fault::whole(format!(
                "an entry is in row {row} and column {column}; both are counted from 0"
            )));
        };
        builder.push(row, column, value, Place::Whole)?;
    }
    builder.finish()
}
