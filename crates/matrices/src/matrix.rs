//! A sparse matrix as a file gives it.

use crate::Fault;
use crate::text::quote;

/// An entry of a matrix. Rows and columns are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The row.
    pub row: usize,
    /// The column.
    pub column: usize,
    /// The value, in the units of the program that wrote the file; finite.
    pub value: f64,
}

/// A degree of freedom of a structure: a direction of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// The number of the node in the program that wrote the file.
    pub node: u64,
    /// 1, 2 and 3 are displacements along x, y and z; 4, 5 and 6 rotations about them; 0 is a scalar point, which has no
    /// direction.
    pub direction: u8,
}

/// The symmetry of a matrix as its file states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Nothing.
    General,
    /// The matrix equals its transpose.
    Symmetric,
    /// The matrix equals its negative transpose.
    SkewSymmetric,
}

/// A sparse real matrix.
///
/// Its memory is bounded by its entries, not by its numbers of rows and columns, since a short file can state large ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// The name in a file that can hold several matrices.
    pub name: Option<String>,
    /// The number of rows.
    pub rows: usize,
    /// The number of columns.
    pub columns: usize,
    /// The entries of both triangles, by column and then by row; no place has two. Zeros that the file states are kept, unless it states all
    /// values.
    pub entries: Vec<Entry>,
    /// The symmetry that the file states.
    pub symmetry: Symmetry,
    /// The degree of freedom of each row, if the file or its companion tells; then the matrix is square.
    pub freedoms: Option<Vec<Freedom>>,
}

impl Matrix {
    /// The matrix with the degree of freedom of each row.
    ///
    /// # Errors
    /// Returns a fault if their number is not that of rows and columns, or two are the
    /// same.
    pub(crate) fn with_freedoms(mut self, freedoms: Vec<Freedom>) -> Result<Self, Fault> {
        let count = freedoms.len();
        if self.rows != count || self.columns != count {
            return Err(Fault::whole(format!(
                "the file of degrees of freedom beside has {count} of them, but the matrix has {} rows and {} columns; write both files again \
                 from one model",
                self.rows, self.columns
            )));
        }
        let mut sorted = freedoms.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let Freedom { node, direction } = pair[0];
            return Err(Fault::whole(format!(
                "node {node} has the direction {direction} twice; each row needs a degree of freedom of its own"
            )));
        }
        self.freedoms = Some(freedoms);
        Ok(self)
    }
}

/// The place of a name in a list of matrices.
pub(crate) fn position(names: &[String], name: &str) -> Result<usize, Fault> {
    let found = names.iter().position(|known| known == name);
    found.ok_or_else(|| Fault::whole(format!("there is no matrix {}", quote(name))))
}
