//! Linear equations that may be singular: elimination with complete pivots.

use crate::numerics::max_norm;

/// A pivot below this part of the largest is rounding: its row depends on others.
const DEPENDENT: f64 = 1e-12;

/// A square matrix as L U, with rows and columns in the order of their pivots. Rows that depend on others are left
/// out, and their unknowns are zero.
///
/// Rows and columns are first multiplied by powers of two, so that light masses beside heavy ones do not decide which
/// pivot counts as zero. Powers of two cause no rounding.
pub(super) struct Factors {
    size: usize,
    rank: usize,
    /// Entries by rows, as eliminated: below the diagonal L, above it U; on the diagonal one over the pivot.
    entries: Vec<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    scales: Vec<f64>,
    /// The largest magnitude that is left in each row.
    most: Vec<f64>,
    /// The sign of the product of the pivots, times that of the permutations of rows and columns.
    orientation: f64,
    /// Memory for a solution.
    values: Vec<f64>,
}

impl Factors {
    /// Allocates memory for matrices of up to `most` rows.
    pub(super) fn with_room(most: usize) -> Self {
        Self {
            size: 0,
            rank: 0,
            entries: vec![0.0; most * most],
            rows: vec![0; most],
            columns: vec![0; most],
            scales: vec![1.0; most],
            most: vec![0.0; most],
            orientation: 1.0,
            values: vec![0.0; most],
        }
    }

    /// Factors the matrix with these entries (by row and column); `diagonal` gives the non-negative scale of a row and
    /// its column.
    pub(super) fn set(
        &mut self,
        size: usize,
        entry: impl Fn(usize, usize) -> f64,
        diagonal: impl Fn(usize) -> f64,
    ) {
        self.size = size;
        for place in 0..size {
            (self.rows[place], self.columns[place]) = (place, place);
            self.scales[place] = root_scale(diagonal(place));
        }
        for row in 0..size {
            for column in 0..size {
                self.entries[row * size + column] =
                    self.scales[row] * entry(row, column) * self.scales[column];
            }
        }
        self.eliminate();
    }

    /// Takes the factors of another matrix. There is room for them.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let size = other.size;
        (self.size, self.rank, self.orientation) = (size, other.rank, other.orientation);
        self.entries[..size * size].copy_from_slice(&other.entries[..size * size]);
        self.rows[..size].copy_from_slice(&other.rows[..size]);
        self.columns[..size].copy_from_slice(&other.columns[..size]);
        self.scales[..size].copy_from_slice(&other.scales[..size]);
    }

    fn eliminate(&mut self) {
        let Self { size, entries, rows, columns, orientation, most, .. } = self;
        let size = *size;
        (self.rank, *orientation) = (0, 1.0);
        if size == 0 {
            return;
        }
        let most = &mut most[..size];
        let entries = &mut entries[..size * size];
        let largest = max_norm(entries);
        for (most, row) in most.iter_mut().zip(entries.chunks_exact(size)) {
            *most = max_norm(row);
        }
        for step in 0..size {
            // The first of the largest entries, row by row.
            let later = (step..size).rev();
            let row = later.fold(step, |best, i| if most[i] >= most[best] { i } else { best });
            let pivot = most[row];
            if pivot <= DEPENDENT * largest {
                return;
            }
            let places = &entries[row * size + step..(row + 1) * size];
            let column = step + places.iter().position(|e| e.abs() == pivot).unwrap_or(0);
            if (row == step) != (column == step) {
                *orientation = -*orientation;
            }
            rows.swap(step, row);
            most.swap(step, row);
            columns.swap(step, column);
            if row != step {
                let (upper, lower) = entries.split_at_mut(row * size);
                upper[step * size..][..size].swap_with_slice(&mut lower[..size]);
            }
            if column != step {
                entries.chunks_exact_mut(size).for_each(|row| row.swap(step, column));
            }
            let (done, rest) = entries.split_at_mut((step + 1) * size);
            let pivot_row = &mut done[step * size..];
            *orientation *= pivot_row[step].signum();
            pivot_row[step] = 1.0 / pivot_row[step];
            for (row, most) in rest.chunks_exact_mut(size).zip(&mut most[step + 1..]) {
                if row[step] != 0.0 {
                    let factor = row[step] * pivot_row[step];
                    row[step] = factor;
                    *most = subtract(&mut row[step + 1..], factor, &pivot_row[step + 1..]);
                }
            }
            self.rank = step + 1;
        }
    }

    /// The sign of the determinant: 1, −1, or 0 where a row has been left out.
    pub(super) fn orientation(&self) -> f64 {
        if self.is_regular() { self.orientation } else { 0.0 }
    }

    /// `true` if no row has been left out.
    pub(super) fn is_regular(&self) -> bool {
        self.rank == self.size
    }

    /// Replaces the right-hand side by the solution.
    #[inline]
    pub(super) fn solve(&mut self, right: &mut [f64]) {
        if self.size == 1 && self.rank == 1 {
            // Scaled back by the same power of two: only the pivot matters.
            right[0] *= self.entries[0] * self.scales[0] * self.scales[0];
            return;
        }
        let Self { size, rank, entries, rows, columns, scales, values, .. } = self;
        let (size, rank) = (*size, *rank);
        let values = &mut values[..rank];
        for place in 0..rank {
            let row = &entries[place * size..][..place];
            let known = dot(row, &values[..place]);
            values[place] = scales[rows[place]] * right[rows[place]] - known;
        }
        for place in (0..rank).rev() {
            let row = &entries[place * size..][place..rank];
            let known = dot(&row[1..], &values[place + 1..]);
            values[place] = (values[place] - known) * row[0];
        }
        right.fill(0.0);
        for (&column, value) in columns.iter().zip(&*values) {
            right[column] = scales[column] * value;
        }
    }
}

/// Subtracts a multiple of a row from another one; returns the largest magnitude that is left.
fn subtract(row: &mut [f64], factor: f64, above: &[f64]) -> f64 {
    const SIDE: usize = 8;
    let above = &above[..row.len()];
    let ((parts, rest), (above, above_rest)) =
        (row.as_chunks_mut::<SIDE>(), above.as_chunks::<SIDE>());
    let mut most = [0.0; SIDE];
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    for (part, above) in parts.iter_mut().zip(above) {
        for i in 0..SIDE {
            part[i] -= factor * above[i];
            most[i] = larger(part[i].abs(), most[i]);
        }
    }
    for (entry, above) in rest.iter_mut().zip(above_rest) {
        *entry -= factor * above;
        most[0] = larger(entry.abs(), most[0]);
    }
    most.into_iter().fold(0.0, larger)
}

/// Σ a b from the left; of more than 64 terms in eight sums that do not wait for each other, which rounds otherwise.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SIDE: usize = 8;
    const LONG: usize = 8 * SIDE;
    if a.len() <= LONG {
        return a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    }
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<SIDE>(), b.as_chunks::<SIDE>());
    let mut sums = [0.0; SIDE];
    for (a, b) in a.iter().zip(b) {
        for i in 0..SIDE {
            sums[i] += a[i] * b[i];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(0.0, |sum, (a, b)| sum + a * b);
    sums.into_iter().fold(rest, |sum, part| sum + part)
}

/// Returns a power of two near 1/√value, from the bits of its exponent, equal on every machine; 1 for zero.
pub(super) fn root_scale(value: f64) -> f64 {
    const BIAS: u64 = 1023;
    let exponent = (value.to_bits() >> 52) & 0x7ff;
    if value > 0.0 && value.is_normal() {
        f64::from_bits((BIAS + BIAS / 2 - exponent / 2) << 52)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factored(matrix: &[f64], size: usize) -> Factors {
        let mut factors = Factors::with_room(size);
        let entry = |row: usize, column: usize| matrix[row * size + column];
        factors.set(size, entry, |place| matrix[place * size + place].abs());
        factors
    }

    #[test]
    fn the_solution_satisfies_the_equations() {
        let matrix = [0.0, 2.0, 1.0, 3.0, -1.0, 0.5, 1.0, 1.0, 4e6];
        let right = [1.0, -2.0, 0.5];
        let mut solution = right;
        let mut factors = factored(&matrix, 3);
        factors.solve(&mut solution);
        assert!(factors.is_regular());
        for (row, right) in matrix.chunks(3).zip(right) {
            let sum = row.iter().zip(solution).fold(0.0, |sum, (a, x)| sum + a * x);
            assert!((sum - right).abs() < 1e-14, "{sum} {right}");
        }
    }

    #[test]
    fn rows_that_depend_on_others_carry_nothing() {
        // Two contacts that hold one mass: whatever is consistent is met.
        let mut factors = factored(&[1.0, 1.0, 1.0, 1.0], 2);
        let mut solution = [3.0, 3.0];
        factors.solve(&mut solution);
        assert!(!factors.is_regular());
        assert_eq!(solution[0] + solution[1], 3.0);
    }

    #[test]
    fn scales_bring_a_value_near_to_one() {
        for value in [1e-300, 1e-9, 0.3, 1.0, 7.0, 1e9, 1e300] {
            let scaled = root_scale(value) * value * root_scale(value);
            assert!((0.25..8.0).contains(&scaled), "{value} {scaled}");
        }
        assert_eq!(root_scale(0.0), 1.0);
    }

    #[test]
    fn a_light_mass_beside_a_heavy_one_is_not_taken_for_rounding() {
        let mut factors = factored(&[1024.0, 0.0, 0.0, 1.0 / 1024.0_f64.powi(4)], 2);
        let mut solution = [1024.0, 1.0 / 1024.0_f64.powi(4)];
        factors.solve(&mut solution);
        assert_eq!(solution, [1.0, 1.0]);
    }
}
