//! A sparse matrix as a file gives it.

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

/// What a file says of the symmetry of a matrix.
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
    /// The entries of both triangles, by column and then by row; no place has two. Zeros that the file states are kept.
    pub entries: Vec<Entry>,
    /// What the file says of its symmetry.
    pub symmetry: Symmetry,
    /// The degree of freedom of each row, if the file or its companion tells; then the matrix is square.
    pub freedoms: Option<Vec<Freedom>>,
}
