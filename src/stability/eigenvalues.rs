//! Eigenvalues of a real matrix.
//!
//! Libraries are made for large matrices and are slow on those of some dozens of rows, of which there are many here:
//! one for each contact state. So the standard algorithms are written here: Householder reflections bring the matrix to
//! Hessenberg form; Francis's implicit double-shift QR iteration splits that into blocks of one row or two (Golub and
//! Van Loan, Matrix Computations, 4th ed., algorithms 7.4.2 and 7.5.1; exceptional shifts as in LAPACK's `dlahqr`).
//! Both are orthogonal, so the eigenvalues are those of a matrix that differs from the given one by rounding.

use nalgebra::{Complex, DMatrix, Schur};
use std::array::from_fn;
use std::ops::Range;

/// Number of iterations without success after which the shift is exceptional; ordinary shifts may cycle.
const PATIENCE: u32 = 10;
/// Largest number of iterations for one eigenvalue; three are usual, and a hundred or two occur beside defective pairs
/// that are nearly equal.
const MAX_SWEEPS: u32 = 600;
/// Number of iterations for one eigenvalue after which coupling below the rounding of the whole matrix is neglected.
/// Ten equal eigenvalues that are small beside others may need it: rounding couples them more than their size allows.
const LOOSE_SWEEPS: u32 = 300;

/// Returns the eigenvalues of a square matrix, in the matrix's unit; those of a pair follow each other. They are the
/// same doubles on each machine. `None` where an entry is not finite, or the iteration does not converge.
#[must_use]
pub fn eigenvalues(mut matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let scale = scale(&mut matrix)?;
    let mut found = split(&mut matrix, &mut |_, _, _| {})?;
    found.iter_mut().for_each(|value| *value *= scale);
    Some(found)
}

/// Divides a matrix by a factor such that squares of entries neither overflow nor vanish, and returns the factor.
/// `None` where an entry is not finite.
pub(super) fn scale(matrix: &mut DMatrix<f64>) -> Option<f64> {
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    let largest = matrix.amax();
    let scale = if largest == 0.0 || (1e-100..1e100).contains(&largest) { 1.0 } else { largest };
    *matrix /= scale;
    Some(scale)
}

/// Splits a matrix into diagonal blocks of one row or two and returns their eigenvalues, from the last row to the first.
/// An entry below the diagonal is zero between two blocks and not zero within one; entries outside of blocks are of no
/// use. Each reflection I − factor v vᵀ is passed on as the first row of v, v and factor; their product Z, in this order,
/// gives Zᵀ A Z these blocks on its diagonal and rounding errors below them. `None` where the iteration does not converge.
pub(super) fn split(
    matrix: &mut DMatrix<f64>,
    reflected: &mut impl FnMut(usize, &[f64], f64),
) -> Option<Vec<Complex<f64>>> {
    let size = matrix.nrows();
    let mut h = Columns { values: matrix.as_mut_slice(), size };
    h.reduce_to_hessenberg(reflected);
    let mut found = Vec::with_capacity(size);
    let (mut end, mut sweeps) = (size, 0);
    while end > 0 {
        let negligible = if sweeps < LOOSE_SWEEPS {
            f64::MIN_POSITIVE
        } else {
            f64::EPSILON * dot(h.values, h.values).sqrt()
        };
        let start = h.active_block(end, negligible);
        if start > 0 {
            // Rows above are not transformed from here on, so a later sweep must not take them in again.
            h.set(start, start - 1, 0.0);
        }
        if end - start <= 2 {
            found.extend_from_slice(&h.block_eigenvalues(start, end)[..end - start]);
            (end, sweeps) = (start, 0);
        } else if sweeps < MAX_SWEEPS {
            sweeps += 1;
            h.sweep(start, end, sweeps % PATIENCE == 0, reflected);
        } else {
            return None;
        }
    }
    Some(found)
}

/// Returns the eigenvalues by nalgebra's Schur decomposition, which takes twice as long. The printed critical step is
/// based on them: where contact states have equal limits, rounding picks the state that is named.
pub(super) fn by_schur(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    // The iteration has no exceptional shifts: for about one in ten thousand matrices it cycles. The transpose, which
    // has the same eigenvalues, and a looser criterion end the cycle.
    let both = [matrix.transpose(), matrix];
    let precisions = [1.0, 64.0, 4096.0].map(|looser| looser * f64::EPSILON).into_iter();
    let mut attempts =
        precisions.flat_map(|precision| [&both[1], &both[0]].map(|matrix| (matrix, precision)));
    let schur = attempts.find_map(|(matrix, precision)| {
        Schur::try_new(matrix.clone(), precision, 100 * matrix.nrows())
    });
    // Two equal gyroscopic pairs end in a cycle even so.
    schur.map_or_else(
        || eigenvalues(both[1].clone()),
        |schur| Some(schur.complex_eigenvalues().iter().copied().collect()),
    )
}

/// A function that finds all eigenvalues.
pub(super) type Solver = fn(DMatrix<f64>) -> Option<Vec<Complex<f64>>>;

/// A square matrix, column after column.
struct Columns<'a> {
    values: &'a mut [f64],
    size: usize,
}

impl Columns<'_> {
    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.size + row]
    }

    fn set(&mut self, row: usize, column: usize, value: f64) {
        self.values[column * self.size + row] = value;
    }

    fn reduce_to_hessenberg(&mut self, reflected: &mut impl FnMut(usize, &[f64], f64)) {
        let size = self.size;
        let mut product = vec![0.0; size];
        for done in 0..size.saturating_sub(2) {
            let (left, right) = self.values.split_at_mut((done + 1) * size);
            let vector = &mut left[done * size + done + 1..];
            let Some((factor, first)) = reflector(vector) else { continue };
            for column in right.chunks_exact_mut(size) {
                let below = &mut column[done + 1..];
                add_multiple(below, -factor * dot(vector, below), vector);
            }
            reflect_many_columns(right, vector, factor, &mut product);
            reflected(done + 1, vector, factor);
            vector.fill(0.0);
            vector[0] = first;
        }
    }

    /// The first row of the lowest block that entries above rounding, and above `negligible`, couple.
    fn active_block(&self, end: usize, negligible: f64) -> usize {
        let is_split = |row: usize| {
            let diagonal = self.at(row - 1, row - 1).abs() + self.at(row, row).abs();
            self.at(row, row - 1).abs() <= (f64::EPSILON * diagonal).max(negligible)
        };
        (1..end).rev().find(|&row| is_split(row)).unwrap_or(0)
    }

    /// The eigenvalues of a diagonal block of one row (twice) or two; the second is the one nearer to
    /// the last entry.
    fn block_eigenvalues(&self, start: usize, end: usize) -> [Complex<f64>; 2] {
        let last = end - 1;
        let (a, d) = (self.at(start, start), self.at(last, last));
        if start == last {
            return [Complex::new(a, 0.0); 2];
        }
        let product = self.at(start, last) * self.at(last, start);
        let half = 0.5 * (a - d);
        let square = half * half + product;
        if square < 0.0 {
            let value = Complex::new(0.5 * (a + d), (-square).sqrt());
            return [value, value.conj()];
        }
        // The larger distance from d, then the other from their product, without cancellation.
        let far = half + square.sqrt().copysign(half);
        let near = if far == 0.0 { 0.0 } else { -product / far };
        [far, near].map(|distance| Complex::new(d + distance, 0.0))
    }

    /// One double-shift QR step of the block start..end, of at least three rows.
    fn sweep(
        &mut self,
        start: usize,
        end: usize,
        exceptional: bool,
        reflected: &mut impl FnMut(usize, &[f64], f64),
    ) {
        let last = end - 1;
        let shift = if exceptional {
            let size = self.at(last, last - 1).abs() + self.at(last - 1, last - 2).abs();
            Complex::new(self.at(last, last) + 0.75 * size, 0.4375_f64.sqrt() * size)
        } else {
            self.block_eigenvalues(end - 2, end)[1]
        };
        let (first, mut vector) = self.first_column(start, end, shift);
        if let Some((factor, _)) = reflector(&mut vector) {
            if first > start {
                // The entry below becomes negligible, by the choice of the row.
                let before = self.at(first, first - 1) * (1.0 - factor * vector[0] * vector[0]);
                self.set(first, first - 1, before);
            }
            self.reflect(vector, factor, first, start..end);
            reflected(first, &vector, factor);
        }
        for row in first + 1..last - 1 {
            self.chase::<3>(row, start..end, reflected);
        }
        self.chase::<2>(last - 1, start..end, reflected);
    }

    /// Clears the column before `row` below its row, by a reflection of N rows.
    fn chase<const N: usize>(
        &mut self,
        row: usize,
        block: Range<usize>,
        reflected: &mut impl FnMut(usize, &[f64], f64),
    ) {
        let mut vector: [f64; N] = from_fn(|i| self.at(row + i, row - 1));
        if let Some((factor, first)) = reflector(&mut vector) {
            for i in 0..N {
                self.set(row + i, row - 1, if i == 0 { first } else { 0.0 });
            }
            self.reflect(vector, factor, row, block);
            reflected(row, &vector, factor);
        }
    }

    /// The row at which an iteration starts, as low as two small entries in sequence allow, and from there
    /// the first column of (H − shift)(H − its conjugate) or, of a real shift, of (H − shift)².
    fn first_column(&self, start: usize, end: usize, shift: Complex<f64>) -> (usize, [f64; 3]) {
        let (trace, determinant) = (2.0 * shift.re, shift.norm_sqr());
        let mut row = end - 3;
        loop {
            let [a, b] = [self.at(row, row), self.at(row, row + 1)];
            let [c, d] = [self.at(row + 1, row), self.at(row + 1, row + 1)];
            let [x, y] = [(a * (a - trace) + determinant) / c + b, a + d - trace];
            let z = self.at(row + 2, row + 1);
            let may_start = row == start || {
                let around = self.at(row - 1, row - 1).abs() + a.abs() + d.abs();
                let spilt = self.at(row, row - 1).abs() * (y.abs() + z.abs());
                spilt <= f64::EPSILON * x.abs() * around
            };
            if may_start {
                return (row, [x, y, z]);
            }
            row -= 1;
        }
    }

    /// I − factor v vᵀ from both sides, within a block; v begins at `row`.
    fn reflect<const N: usize>(
        &mut self,
        vector: [f64; N],
        factor: f64,
        row: usize,
        block: Range<usize>,
    ) {
        let size = self.size;
        let scaled = vector.map(|v| factor * v);
        for column in self.values[row * size..block.end * size].chunks_exact_mut(size) {
            let part: &mut [f64; N] = (&mut column[row..row + N]).try_into().expect("N rows");
            let sum = (0..N).fold(0.0, |sum, i| sum + vector[i] * part[i]);
            (0..N).for_each(|i| part[i] -= sum * scaled[i]);
        }
        let above = block.start..block.end.min(row + 4);
        reflect_columns(&mut self.values[row * size..], size, above, vector, factor);
    }
}

/// I − factor v vᵀ from the right, on as many first columns as v has rows; `product` is overwritten and as long as a column.
pub(super) fn reflect_many_columns(
    values: &mut [f64],
    vector: &[f64],
    factor: f64,
    product: &mut [f64],
) {
    let size = product.len();
    product.fill(0.0);
    for (column, &v) in values.chunks_exact(size).zip(vector) {
        add_multiple(product, v, column);
    }
    for (column, &v) in values.chunks_exact_mut(size).zip(vector) {
        add_multiple(column, -factor * v, product);
    }
}

/// I − factor v vᵀ from the right, on these rows of the first N columns.
pub(super) fn reflect_columns<const N: usize>(
    values: &mut [f64],
    size: usize,
    rows: Range<usize>,
    vector: [f64; N],
    factor: f64,
) {
    let scaled = vector.map(|v| factor * v);
    let mut columns = values.chunks_exact_mut(size);
    let parts: [&mut [f64]; N] = from_fn(|_| &mut columns.next().expect("N columns")[rows.clone()]);
    (0..rows.len()).for_each(|i| {
        let sum = (0..N).fold(0.0, |sum, j| sum + vector[j] * parts[j][i]);
        (0..N).for_each(|j| parts[j][i] -= sum * scaled[j]);
    });
}

/// Turns x into the vector v for which (I − factor v vᵀ) x has only a first entry; returns the factor and that entry.
/// `None` where x has only a first entry already.
fn reflector(x: &mut [f64]) -> Option<(f64, f64)> {
    let rest = x[1..].iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if rest < f64::MIN_POSITIVE {
        return None;
    }
    let scale = rest.max(x[0].abs());
    let inverse = 1.0 / scale;
    x.iter_mut().for_each(|value| *value *= inverse);
    let norm = dot(x, x).sqrt().copysign(x[0]);
    x[0] += norm;
    Some((1.0 / (norm * x[0]), -norm * scale))
}

/// Four sums at a time, which a processor adds side by side.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_chunks, b_chunks) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in a_chunks.zip(b_chunks) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

pub(super) fn add_multiple(to: &mut [f64], factor: f64, vector: &[f64]) {
    for (to, value) in to.iter_mut().zip(vector) {
        *to += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each expected value has one of its own among the found ones, as near as `tolerance`.
    fn assert_same(mut found: Vec<Complex<f64>>, expected: &[Complex<f64>], tolerance: f64) {
        assert_eq!(found.len(), expected.len());
        for value in expected {
            let distance = |other: &Complex<f64>| (other - value).norm();
            let nearest = (0..found.len())
                .min_by(|&a, &b| distance(&found[a]).total_cmp(&distance(&found[b])));
            let nearest = found.swap_remove(nearest.unwrap());
            assert!(distance(&nearest) <= tolerance, "{value} {nearest}");
        }
    }

    fn real(values: impl Iterator<Item = f64>) -> Vec<Complex<f64>> {
        values.map(|value| Complex::new(value, 0.0)).collect()
    }

    #[test]
    fn a_chain_has_its_closed_form_at_every_size_and_scale() {
        // Fixed ends and unequal units of length: 2 − 2 cos(π k / (n + 1)), unsymmetric.
        for (size, scale) in [1, 2, 3, 4, 24, 100, 255, 300]
            .map(|size| (size, 1e6))
            .into_iter()
            .chain([1e-250, 1e250].map(|scale| (20, scale)))
        {
            let unit = |i: usize| 2.0 + (i as f64).sin();
            let matrix = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
                0 => 2.0 * scale,
                1 => -scale * unit(i) / unit(j),
                _ => 0.0,
            });
            let turn = |k: usize| std::f64::consts::PI * k as f64 / (size + 1) as f64;
            let expected = real((1..=size).map(|k| scale * (2.0 - 2.0 * turn(k).cos())));
            assert_same(eigenvalues(matrix).unwrap(), &expected, 1e-12 * scale);
        }
    }

    #[test]
    fn pairs_come_out_of_a_full_matrix() {
        // Blocks [a b; −b a] on the diagonal and something above it, seen in a mirror I − 2 v vᵀ.
        for size in [2, 6, 7, 40] {
            let value = |i: usize| Complex::new((i / 2) as f64, 1.0 + (i % 4) as f64);
            let pairs = size / 2 * 2;
            let mut triangle = DMatrix::from_fn(size, size, |i, j| {
                if i < j { 0.1 * ((3 * i + 7 * j) as f64).sin() } else { 0.0 }
            });
            let mut expected = Vec::new();
            for i in (0..pairs).step_by(2) {
                let Complex { re, im } = value(i);
                expected.extend([value(i), value(i).conj()]);
                triangle.view_mut((i, i), (2, 2)).copy_from_slice(&[re, -im, im, re]);
            }
            if pairs < size {
                triangle[(pairs, pairs)] = -3.0;
                expected.push(Complex::new(-3.0, 0.0));
            }
            let v = nalgebra::DVector::from_fn(size, |i, _| 1.0 + (i as f64).cos()).normalize();
            let mirror = DMatrix::identity(size, size) - &v * v.transpose() * 2.0;
            let matrix = &mirror * triangle * &mirror;
            assert_same(eigenvalues(matrix).unwrap(), &expected, 1e-9);
        }
    }

    #[test]
    fn permutations_on_which_ordinary_shifts_circle_converge() {
        for size in [3, 4, 8, 25] {
            let cycle = DMatrix::from_fn(size, size, |i, j| f64::from(i == (j + 1) % size));
            let turn = |k: usize| std::f64::consts::TAU * k as f64 / size as f64;
            let expected: Vec<_> = (0..size).map(|k| Complex::from_polar(1.0, turn(k))).collect();
            assert_same(eigenvalues(cycle).unwrap(), &expected, 1e-13);
        }
    }

    #[test]
    fn defective_eigenvalues_that_come_twice_converge_and_keep_their_mean() {
        // Two blocks [1 30; 0 1] among others, as equal modules have where their modes merge.
        let size = 12;
        for turn in 0..2000 {
            let blocks = DMatrix::from_fn(size, size, |i, j| match (i, j) {
                (0, 1) | (2, 3) => 30.0,
                _ if i == j && i > 3 => 1.0 - 0.1 * i as f64,
                _ => f64::from(i == j),
            });
            let v = nalgebra::DVector::from_fn(size, |i, _| (1.0 + (7 * i + turn) as f64).sin());
            let v = v.normalize();
            let mirror = DMatrix::identity(size, size) - &v * v.transpose() * 2.0;
            let found = eigenvalues(&mirror * blocks * &mirror).unwrap();
            let (cluster, others): (Vec<_>, Vec<_>) =
                found.into_iter().partition(|value| value.re > 0.9);
            let mean = cluster.iter().sum::<Complex<f64>>() / 4.0;
            assert!(cluster.len() == 4 && (mean - 1.0).norm() < 1e-11, "{cluster:?}");
            assert_same(others, &real((4..size).map(|i| 1.0 - 0.1 * i as f64)), 1e-12);
        }
    }

    #[test]
    fn nearly_equal_complex_pairs_that_are_nearly_defective_converge() {
        // Two nearly equal oscillators whose pairs are coupled one way, as modules have that differ
        // by a part in a thousand and flutter: [a −b; b a] twice, and a large coupling.
        for turn in 0..500 {
            let apart = 10_f64.powf(-3.0 - 0.02 * f64::from(turn));
            let blocks = DMatrix::from_fn(8, 8, |i, j| match (i, j) {
                (0, 0) | (1, 1) => 2.0,
                (2, 2) | (3, 3) => 2.0 + apart,
                (0, 1) | (2, 3) => -1e-4,
                (1, 0) | (3, 2) => 1e-4,
                (0, 2) | (1, 3) => 30.0,
                _ if i == j => 10.0 + i as f64,
                _ => 0.0,
            });
            let v = nalgebra::DVector::from_fn(8, |i, _| {
                (1.0 + (7 * i) as f64 + f64::from(turn)).sin()
            });
            let v = v.normalize();
            let mirror = DMatrix::identity(8, 8) - &v * v.transpose() * 2.0;
            let found = eigenvalues(&mirror * blocks * &mirror).unwrap();
            let cluster: Vec<_> = found.iter().filter(|value| value.re < 5.0).collect();
            let mean = cluster.iter().copied().sum::<Complex<f64>>() / 4.0;
            assert!(cluster.len() == 4 && (mean - (2.0 + 0.5 * apart)).norm() < 1e-11, "{apart:e}");
        }
    }

    #[test]
    fn equal_parts_that_are_not_coupled_have_the_eigenvalues_of_one() {
        // With rows by turns. Rounding couples blocks that are split, and more than their small sums of diagonals allow.
        let block = DMatrix::from_row_slice(
            3,
            3,
            &[
                [0.0, -0.6494346540781634, 0.10955746085425562],
                [0.4211007074762409, 0.35452544405807446, 0.8272969007711221],
                [-0.11805657149104198, -0.1867609056845851, -0.8959837085031215],
            ]
            .concat(),
        );
        let alone = eigenvalues(block.clone()).unwrap();
        for copies in 1..20 {
            let matrix = DMatrix::from_fn(3 * copies, 3 * copies, |i, j| {
                if i % copies == j % copies { block[(i / copies, j / copies)] } else { 0.0 }
            });
            assert_same(eigenvalues(matrix).unwrap(), &alone.repeat(copies), 1e-13);
        }
    }

    #[test]
    fn small_eigenvalues_that_come_many_times_converge() {
        for turn in 0..20 {
            let size = 60;
            let value = |i: usize| [1.0, -0.8, 0.6, 0.009][i % 4];
            let v = nalgebra::DVector::from_fn(size, |i, _| (1.0 + (7 * i + turn) as f64).sin());
            let v = v.normalize();
            let mirror = DMatrix::identity(size, size) - &v * v.transpose() * 2.0;
            let blocks = DMatrix::from_fn(size, size, |i, j| match i / 4 == j / 4 {
                true if i == j => value(i),
                true if i < j => 0.3 * ((i % 4 + 3 * (j % 4)) as f64).sin(),
                _ => 0.0,
            });
            let found = eigenvalues(&mirror * blocks * &mirror).unwrap();
            assert_same(found, &real((0..size).map(value)), 1e-12);
        }
    }

    #[test]
    fn triangles_and_zeros_need_no_iteration() {
        assert_eq!(eigenvalues(DMatrix::zeros(0, 0)).unwrap(), []);
        assert_eq!(eigenvalues(DMatrix::zeros(5, 5)).unwrap(), real([0.0; 5].into_iter()));
        let jordan = DMatrix::from_fn(4, 4, |i, j| f64::from(i == j || i + 1 == j));
        assert_eq!(eigenvalues(jordan).unwrap(), real([1.0; 4].into_iter()));
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        for size in [3, 256] {
            let mut matrix = DMatrix::identity(size, size);
            matrix[(2, 0)] = f64::NAN;
            assert_eq!(eigenvalues(matrix), None);
        }
    }
}
