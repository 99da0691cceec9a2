//! Writes matrices that other tools read.

use crate::{Matrix, Symmetry};
use std::fmt::Write;

/// The matrix as a Matrix Market file (coordinate, real), of a symmetric matrix the lower triangle. Each number is the
/// shortest that reads back as the same double.
#[must_use]
pub fn write_matrix_market(matrix: &Matrix) -> String {
    let kind = match matrix.symmetry {
        Symmetry::General => "general",
        Symmetry::Symmetric => "symmetric",
        Symmetry::SkewSymmetric => "skew-symmetric",
    };
    let written = || {
        matrix.entries.iter().filter(|entry| match matrix.symmetry {
            Symmetry::General => true,
            Symmetry::Symmetric => entry.row >= entry.column,
            Symmetry::SkewSymmetric => entry.row > entry.column,
        })
    };
    let mut text = format!(
        "%%MatrixMarket matrix coordinate real {kind}\n{} {} {}\n",
        matrix.rows,
        matrix.columns,
        written().count()
    );
    for entry in written() {
        let (row, column) = (entry.row + 1, entry.column + 1);
        writeln!(text, "{row} {column} {:e}", entry.value).expect("a string takes all");
    }
    text
}

/// A dense matrix as a file of NumPy's (`.npy`, version 1.0), in doubles by columns.
///
/// `values` are those of the matrix by columns.
#[must_use]
pub fn write_npy(rows: usize, columns: usize, values: impl Iterator<Item = f64>) -> Vec<u8> {
    let shape =
        format!("{{'descr': '<f8', 'fortran_order': True, 'shape': ({rows}, {columns}), }}");
    // Magic, version and length take 10 bytes; the header ends with a line feed at a multiple of 64.
    let length = (10 + shape.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(u16::try_from(length).expect("two numbers are short").to_le_bytes());
    file.extend(format!("{shape:<0$}\n", length - 1).bytes());
    values.for_each(|value| file.extend(value.to_le_bytes()));
    file
}
