//! A large matrix with few zeros, laid out for products: rows by the [`HEIGHT`], column after column.
//!
//! A product reads the values in the order in which they lie, and adds the terms of each row from the left. So its sums are the
//! doubles of a product row by row; [`HEIGHT`] of them that do not wait for each other take a processor's whole width.

use super::SparseMatrix;

/// Number of rows of a panel.
const HEIGHT: usize = 16;
/// Rows from which on panels are worth their memory.
const FEWEST_ROWS: usize = 2 * HEIGHT;
/// Largest number of values of the panels, zeros included, for one entry of the matrix.
const MOST_VALUES: usize = 3;

/// Panels from the first row to the last. The last one is filled with zeros.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Panels {
    rows: usize,
    /// Place behind the last column of each panel.
    ends: Vec<usize>,
    /// The columns of each panel that have an entry in it, ascending.
    columns: Vec<usize>,
    values: Vec<[f64; HEIGHT]>,
}

impl Panels {
    /// The panels of a matrix; `None` where a product by entries is faster.
    pub(super) fn of(matrix: &SparseMatrix) -> Option<Self> {
        let (rows, count) = (matrix.rows(), matrix.entries().count());
        if rows < FEWEST_ROWS || count < rows * rows / (HEIGHT * MOST_VALUES) {
            return None;
        }
        let mut panels = Self { rows, ends: Vec::new(), columns: Vec::new(), values: Vec::new() };
        let mut entries = matrix.entries().peekable();
        for first in (0..rows).step_by(HEIGHT) {
            let mut panel = Vec::new();
            while let Some(entry) = entries.next_if(|entry| entry.0 < first + HEIGHT) {
                panel.push(entry);
            }
            panel.sort_unstable_by_key(|&(row, column, _)| (column, row));
            let start = panels.columns.len();
            for (row, column, value) in panel {
                if panels.columns[start..].last() != Some(&column) {
                    panels.columns.push(column);
                    panels.values.push([0.0; HEIGHT]);
                }
                let last = panels.values.len() - 1;
                panels.values[last][row - first] = value;
            }
            panels.ends.push(panels.columns.len());
        }
        (HEIGHT * panels.values.len() <= MOST_VALUES * count).then_some(panels)
    }

    /// Calls `found` with each row and its product with the vector.
    #[inline]
    pub(super) fn each_product(&self, vector: &[f64], mut found: impl FnMut(usize, f64)) {
        let mut begin = 0;
        for (panel, &end) in self.ends.iter().enumerate() {
            let (first, range) = (panel * HEIGHT, begin..end);
            let sums = add_columns(
                &[0.0; HEIGHT],
                &self.columns[range.clone()],
                &self.values[range],
                vector,
            );
            for (row, sum) in (first..self.rows).zip(sums) {
                found(row, sum);
            }
            begin = end;
        }
    }

    /// Adds the product with the vector to `sums`, one value for each row.
    #[inline]
    pub(super) fn add_product(&self, vector: &[f64], sums: &mut [f64]) {
        let mut begin = 0;
        for (sums, &end) in sums.chunks_mut(HEIGHT).zip(&self.ends) {
            let range = begin..end;
            let mut padded = [0.0; HEIGHT];
            padded[..sums.len()].copy_from_slice(sums);
            let columns = &self.columns[range.clone()];
            let padded = add_columns(&padded, columns, &self.values[range], vector);
            sums.copy_from_slice(&padded[..sums.len()]);
            begin = end;
        }
    }
}

/// Adds these columns of a panel, each times its value of the vector, from the left.
#[inline(never)]
fn add_columns(
    start: &[f64; HEIGHT],
    columns: &[usize],
    values: &[[f64; HEIGHT]],
    vector: &[f64],
) -> [f64; HEIGHT] {
    // A copy, so that the sums need not be in memory while they grow.
    let mut sums = *start;
    for (&column, values) in columns.iter().zip(values) {
        let factor = vector[column];
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value * factor;
        }
    }
    sums
}
