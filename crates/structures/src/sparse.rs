//! Real sparse matrices for computing.

use amontons::Error;
use amontons_matrices::Matrix;
use faer::{Mat, MatRef};
use std::ops::{AddAssign, Mul};

/// A larger entry is no stiffness: Abaqus writes 1e36 on the diagonal of a degree of freedom that is held.
const LARGEST: f64 = 1e30;
/// The largest number of rows or columns: it bounds the memory that a short file can ask for.
const MOST: usize = 10_000_000;

/// A real sparse matrix by columns.
///
/// The entries of a column have ascending rows, and no place has two.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse {
    rows: usize,
    /// Where the entries of each column begin, and where the last column ends.
    starts: Vec<usize>,
    /// The row of each entry.
    indices: Vec<usize>,
    /// The value of each entry.
    values: Vec<f64>,
}

impl Sparse {
    /// Takes over the entries of a matrix of a file; zeros are dropped.
    ///
    /// # Errors
    /// Returns an error if the matrix has more than 10⁷ rows or columns or an entry above 10³⁰, or if its entries are outside it,
    /// not finite, or not in the order that [`Matrix::entries`] states.
    pub fn new(matrix: &Matrix) -> Result<Self, Error> {
        if let Some(entry) = matrix.entries.iter().find(|entry| entry.value.abs() > LARGEST) {
            return Err(Error::argument(format!(
                "row {} and column {} hold {:e}, which stands for a held degree of freedom; write the matrices without boundary \
                 conditions, and hold degrees of freedom by leaving their rows out",
                entry.row + 1,
                entry.column + 1,
                entry.value
            )));
        }
        let entries = matrix.entries.iter().map(|entry| (entry.row, entry.column, entry.value));
        Self::from_entries(matrix.rows, matrix.columns, entries)
    }

    /// Builds a matrix from entries (row, column, value), by column and then by row; zeros are dropped.
    ///
    /// # Errors
    /// Returns an error if there are more than 10⁷ rows or columns, or if an entry is outside the matrix, is not finite, or
    /// does not follow the one before it.
    pub fn from_entries(
        rows: usize,
        columns: usize,
        entries: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Result<Self, Error> {
        if rows.max(columns) > MOST {
            return Err(Error::argument(format!(
                "a matrix of {rows} rows and {columns} columns is too large: the most is {MOST}"
            )));
        }
        let mut sparse =
            Self { rows, starts: Vec::with_capacity(columns + 1), indices: vec![], values: vec![] };
        sparse.starts.push(0);
        let mut last = None;
        for (row, column, value) in entries {
            let place = format_args!("row {}, column {}", row + 1, column + 1);
            if row >= rows || column >= columns {
                return Err(Error::argument(format!(
                    "the entry at {place} is outside the matrix of {rows} rows and {columns} columns"
                )));
            }
            if !value.is_finite() {
                return Err(Error::argument(format!(
                    "the entry at {place} is {value}, not a finite number"
                )));
            }
            if last.is_some_and(|last| last >= (column, row)) {
                return Err(Error::argument(format!(
                    "the entry at {place} is not behind the one before it; entries go by column and then by row, each once"
                )));
            }
            last = Some((column, row));
            if value != 0.0 {
                sparse.starts.resize(column + 1, sparse.indices.len());
                sparse.indices.push(row);
                sparse.values.push(value);
            }
        }
        sparse.starts.resize(columns + 1, sparse.indices.len());
        Ok(sparse)
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of entries.
    #[must_use]
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// The place in [`Self::indices`] and [`Self::values`] at which each column begins, and last their length.
    #[must_use]
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// The row of each entry.
    #[must_use]
    pub fn indices(&self) -> &[usize] {
        &self.indices
    }

    /// The value of each entry.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entries (row, value) of a column.
    ///
    /// # Panics
    /// Panics if there is no such column.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[column]..self.starts[column + 1];
        self.indices[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// Adds `factor` times the product of the matrix and the vector `x` to `y`. Scalars are real or complex.
    ///
    /// # Panics
    /// Panics if `x` has not one value for each column, or `y` not one for each row.
    pub fn multiply<T>(&self, factor: T, x: &[T], y: &mut [T])
    where
        T: Copy + AddAssign + Mul<T, Output = T> + Mul<f64, Output = T>,
    {
        assert!(x.len() == self.columns() && y.len() == self.rows);
        for (column, &x) in x.iter().enumerate() {
            let x = factor * x;
            for (row, value) in self.column(column) {
                y[row] += x * value;
            }
        }
    }

    /// Adds `factor` times the product of the transposed matrix and the vector `x` to `y`. Scalars are real or complex.
    ///
    /// # Panics
    /// Panics if `x` has not one value for each row, or `y` not one for each column.
    pub fn multiply_transposed<T>(&self, factor: T, x: &[T], y: &mut [T])
    where
        T: Copy + AddAssign + Mul<T, Output = T> + Mul<f64, Output = T> + Default,
    {
        assert!(x.len() == self.rows && y.len() == self.columns());
        for (column, y) in y.iter_mut().enumerate() {
            let mut sum = T::default();
            for (row, value) in self.column(column) {
                sum += x[row] * value;
            }
            *y += factor * sum;
        }
    }

    /// The largest sum of magnitudes in a column.
    #[must_use]
    pub fn norm_1(&self) -> f64 {
        let sum = |column| self.column(column).map(|(_, value)| value.abs()).sum::<f64>();
        (0..self.columns()).map(sum).fold(0.0, f64::max)
    }

    /// The largest sum of magnitudes in a row.
    #[must_use]
    pub fn norm_infinity(&self) -> f64 {
        let mut sums = vec![0.0; self.rows];
        for (&row, value) in self.indices.iter().zip(&self.values) {
            sums[row] += value.abs();
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// The root of the sum of squares of the entries.
    #[must_use]
    pub fn norm_frobenius(&self) -> f64 {
        let largest = self.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if largest == 0.0 {
            return 0.0;
        }
        largest * self.values.iter().map(|value| (value / largest).powi(2)).sum::<f64>().sqrt()
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut starts = vec![0; self.rows + 1];
        for &row in &self.indices {
            starts[row + 1] += 1;
        }
        for row in 0..self.rows {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let (mut indices, mut values) = (vec![0; self.count()], vec![0.0; self.count()]);
        for column in 0..self.columns() {
            for (row, value) in self.column(column) {
                indices[next[row]] = column;
                values[next[row]] = value;
                next[row] += 1;
            }
        }
        Self { rows: self.columns(), starts, indices, values }
    }

    /// The entry of a row and a column; 0 if the matrix has none there.
    ///
    /// # Panics
    /// Panics if there is no such column.
    #[must_use]
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let range = self.starts[column]..self.starts[column + 1];
        let found = self.indices[range.clone()].binary_search(&row);
        found.map_or(0.0, |at| self.values[range.start + at])
    }

    /// a A.
    #[must_use]
    pub fn scaled(mut self, a: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= a);
        self
    }

    /// a A + b B, with an entry wherever A or B has one, even where the sum is zero: all sums of two matrices have the same
    /// places.
    ///
    /// # Panics
    /// Panics if the shapes differ.
    #[must_use]
    pub fn sum(&self, a: f64, other: &Self, b: f64) -> Self {
        assert!(self.rows == other.rows && self.columns() == other.columns());
        let most = self.count().max(other.count());
        let (mut indices, mut values) = (Vec::with_capacity(most), Vec::with_capacity(most));
        let mut starts = vec![0];
        for column in 0..self.columns() {
            let mut left = self.column(column).peekable();
            let mut right = other.column(column).peekable();
            loop {
                let next = [left.peek(), right.peek()].map(|entry| entry.map(|&(row, _)| row));
                let Some(row) = next.into_iter().flatten().min() else { break };
                let x = left.next_if(|entry| entry.0 == row).map_or(0.0, |entry| entry.1);
                let y = right.next_if(|entry| entry.0 == row).map_or(0.0, |entry| entry.1);
                indices.push(row);
                values.push(a * x + b * y);
            }
            starts.push(indices.len());
        }
        Self { rows: self.rows, starts, indices, values }
    }

    /// The rows and columns that are listed, each list in ascending order.
    ///
    /// # Panics
    /// Panics if one is outside of the matrix.
    #[must_use]
    pub fn part(&self, rows: &[usize], columns: &[usize]) -> Self {
        let mut place = vec![None; self.rows];
        for (new, &old) in rows.iter().enumerate() {
            place[old] = Some(new);
        }
        let (mut indices, mut values, mut starts) = (Vec::new(), Vec::new(), vec![0]);
        for &column in columns {
            for (row, value) in self.column(column) {
                if let Some(row) = place[row] {
                    indices.push(row);
                    values.push(value);
                }
            }
            starts.push(indices.len());
        }
        Self { rows: rows.len(), starts, indices, values }
    }

    /// A X for several vectors, the columns of X.
    ///
    /// # Panics
    /// Panics if X has not one row for each column of the matrix.
    #[must_use]
    pub fn times(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        assert!(x.nrows() == self.columns());
        let mut product = Mat::zeros(self.rows, x.ncols());
        for vector in 0..x.ncols() {
            let into = product.col_as_slice_mut(vector);
            for column in 0..self.columns() {
                let factor = x[(column, vector)];
                for (row, value) in self.column(column) {
                    into[row] += value * factor;
                }
            }
        }
        product
    }

    /// The matrix with all its zeros.
    #[must_use]
    pub fn dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.rows, self.columns());
        for column in 0..self.columns() {
            for (row, value) in self.column(column) {
                dense[(row, column)] = value;
            }
        }
        dense
    }

    /// The place (row, column) of a pair aᵢⱼ and aⱼᵢ whose difference is more than a part of √|aᵢᵢ aⱼⱼ|; `None` if there is none,
    /// so that the matrix is symmetric but for rounding.
    #[must_use]
    pub fn asymmetry(&self, part: f64) -> Option<(usize, usize)> {
        let diagonal = |at| self.entry(at, at).abs();
        (0..self.columns()).find_map(|column| {
            let worst = self.column(column).find(|&(row, value)| {
                let difference = (value - self.entry(column, row)).abs();
                difference > part * (diagonal(row).sqrt() * diagonal(column).sqrt())
            });
            worst.map(|(row, _)| (row, column))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [1 0 −2; 0 3 4], whose products are known by hand.
    fn sample() -> Sparse {
        Sparse::from_entries(
            2,
            3,
            [(0, 0, 1.0), (0, 1, 0.0), (1, 1, 3.0), (0, 2, -2.0), (1, 2, 4.0)],
        )
        .unwrap()
    }

    #[test]
    fn products_and_norms_are_those_of_the_dense_matrix() {
        let mut y = [1.0, 0.0];
        sample().multiply(2.0, &[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [1.0 - 398.0, 860.0]);
        let mut y = [0.0; 3];
        sample().multiply_transposed(1.0, &[1.0, 10.0], &mut y);
        assert_eq!(y, [1.0, 30.0, 38.0]);
        let mut z = [0.0; 3];
        sample().transposed().multiply(1.0, &[1.0, 10.0], &mut z);
        assert_eq!(y, z);
        assert_eq!(sample().count(), 4);
        assert_eq!(sample().transposed().transposed(), sample());
        let norms = (sample().norm_1(), sample().norm_infinity(), sample().norm_frobenius());
        assert_eq!(norms, (6.0, 7.0, 30f64.sqrt()));
    }

    #[test]
    fn entries_that_break_the_rules_are_refused() {
        let message = |entries: &[(usize, usize, f64)]| {
            Sparse::from_entries(2, 2, entries.iter().copied()).unwrap_err().to_string()
        };
        assert!(message(&[(2, 0, 1.0)]).contains("row 3, column 1"));
        assert!(message(&[(0, 1, 1.0), (1, 0, 1.0)]).contains("row 2, column 1"));
        assert!(message(&[(0, 1, 0.0), (0, 1, 1.0)]).contains("row 1, column 2"));
        assert!(message(&[(0, 0, f64::NAN)]).contains("finite"));
        assert!(Sparse::from_entries(usize::MAX, 2, []).is_err());
    }
}
