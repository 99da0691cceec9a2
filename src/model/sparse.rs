//! A sparse matrix by rows, independent of the order of assembly.

use super::panels::Panels;

/// A sparse matrix by rows.
///
/// ```
/// use amontons::model::SparseMatrix;
///
/// let entries = vec![(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)];
/// let matrix = SparseMatrix::from_entries(2, entries);
/// assert_eq!(matrix.row_times(0, &[3.0, 1.0]), 5.0);
/// assert_eq!(matrix.as_diagonal(), None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix {
    offsets: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    /// The entries once more where the matrix is large and has few zeros.
    panels: Option<Panels>,
}

/// One entry: row, column, value.
pub type Entry = (usize, usize, f64);

impl SparseMatrix {
    /// A matrix with `rows` rows from its entries; entries at one place add up.
    ///
    /// They are added in the order of their values, not of the list, so that equal modules have
    /// equal rows to the last bit wherever they stand, and whatever wrote the list. Zeros are not
    /// stored.
    #[must_use]
    pub fn from_entries(rows: usize, mut entries: Vec<Entry>) -> Self {
        entries.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        let mut matrix = Self {
            offsets: vec![0; rows + 1],
            columns: Vec::new(),
            values: Vec::new(),
            panels: None,
        };
        let mut last = None;
        for (row, column, value) in entries.into_iter().filter(|entry| entry.2 != 0.0) {
            if last == Some((row, column)) {
                *matrix.values.last_mut().expect("it has a last entry") += value;
            } else {
                matrix.columns.push(column);
                matrix.values.push(value);
                matrix.offsets[row + 1] += 1;
                last = Some((row, column));
            }
        }
        for row in 0..rows {
            matrix.offsets[row + 1] += matrix.offsets[row];
        }
        matrix.panels = Panels::of(&matrix);
        matrix
    }

    /// A matrix of zeros.
    #[must_use]
    pub fn zero(rows: usize) -> Self {
        Self::from_entries(rows, Vec::new())
    }

    /// A diagonal matrix.
    #[must_use]
    pub fn diagonal(values: &[f64]) -> Self {
        let entries = values.iter().enumerate().map(|(i, &value)| (i, i, value)).collect();
        Self::from_entries(values.len(), entries)
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// `true` if no entry is stored.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Columns and values of a row, columns ascending.
    #[inline]
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.offsets[row]..self.offsets[row + 1];
        self.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// All entries, by rows.
    pub fn entries(&self) -> impl Iterator<Item = Entry> + '_ {
        (0..self.rows())
            .flat_map(|row| self.row(row).map(move |(column, value)| (row, column, value)))
    }

    /// One entry; zero where none is stored.
    #[must_use]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let range = self.offsets[row]..self.offsets[row + 1];
        let place = self.columns[range.clone()].binary_search(&column);
        place.map_or(0.0, |place| self.values[range.start + place])
    }

    /// The product of a row with a vector, summed from the left.
    #[must_use]
    #[inline]
    pub fn row_times(&self, row: usize, vector: &[f64]) -> f64 {
        self.row(row).fold(0.0, |sum, (column, value)| sum + value * vector[column])
    }

    /// `true` if each entry equals the one across the diagonal, but for rounding: 1e-12 of the largest.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        let most = self.values.iter().fold(0.0, |most, value| f64::max(most, value.abs()));
        let is_alike =
            |(row, column, value): Entry| (value - self.get(column, row)).abs() <= 1e-12 * most;
        self.entries().all(is_alike)
    }

    /// The symmetric matrix with `of` the magnitudes of both entries across the diagonal.
    pub(crate) fn symmetric(&self, of: impl Fn(f64, f64) -> f64) -> Self {
        let both = self.entries().flat_map(|(row, column, value)| {
            let found = of(value.abs(), self.get(column, row).abs());
            let is_first = row <= column || self.get(column, row) == 0.0;
            let mirrored = (is_first && row != column).then_some((column, row, found));
            is_first.then_some((row, column, found)).into_iter().chain(mirrored)
        });
        Self::from_entries(self.rows(), both.collect())
    }

    /// ½ (A + Aᵀ), the part of a matrix that its quadratic form has.
    pub(crate) fn symmetric_part(&self) -> Self {
        let both = self.entries().flat_map(|(row, column, value)| {
            [(row, column, 0.5 * value), (column, row, 0.5 * value)]
        });
        Self::from_entries(self.rows(), both.collect())
    }

    /// `true` if the matrix is large and has few zeros, so that it is laid out for products.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.panels.is_some()
    }

    /// Calls `found` with each row, ascending, and its product with a vector: the doubles of [`row_times`](Self::row_times),
    /// faster where the matrix is large and has few zeros.
    #[inline]
    pub fn each_product(&self, vector: &[f64], mut found: impl FnMut(usize, f64)) {
        match &self.panels {
            Some(panels) => panels.each_product(vector, found),
            None => (0..self.rows()).for_each(|row| found(row, self.row_times(row, vector))),
        }
    }

    /// Adds the product with a vector to `sums`, term by term from the left.
    #[inline]
    pub fn add_product(&self, vector: &[f64], sums: &mut [f64]) {
        match &self.panels {
            Some(panels) => panels.add_product(vector, sums),
            None => {
                for (row, sum) in sums.iter_mut().enumerate() {
                    *sum = self
                        .row(row)
                        .fold(*sum, |sum, (column, value)| sum + value * vector[column]);
                }
            }
        }
    }

    /// The diagonal; `None` if an entry is stored off it.
    #[must_use]
    pub fn as_diagonal(&self) -> Option<Vec<f64>> {
        self.entries()
            .all(|(row, column, value)| row == column || value == 0.0)
            .then(|| (0..self.rows()).map(|i| self.get(i, i)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_assembly_leaves_no_trace() {
        // 0.1 + 0.2 + 0.3 differs from 0.3 + 0.2 + 0.1 in its last bit.
        let forward = vec![(0, 0, 0.1), (0, 0, 0.2), (0, 0, 0.3)];
        let backward = forward.iter().rev().copied().collect();
        assert_eq!(SparseMatrix::from_entries(1, forward), SparseMatrix::from_entries(1, backward));
    }

    #[test]
    fn rows_multiply_and_empty_rows_stay_empty() {
        let matrix = SparseMatrix::from_entries(3, vec![(2, 1, 4.0), (0, 0, 1.0), (2, 0, 2.0)]);
        assert_eq!(matrix.row_times(2, &[10.0, 1.0, 7.0]), 24.0);
        assert_eq!(matrix.row(1).count(), 0);
        assert_eq!(matrix.as_diagonal(), None);
    }
}
