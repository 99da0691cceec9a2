//! Eigenvalues of a real matrix with their vectors.
//!
//! The product Z of the reflections that give the eigenvalues turns the matrix A into its real Schur form T = Zᵀ A Z,
//! triangular but for diagonal blocks of two rows. (T − λ) x = 0 is solved upwards from the block of λ, and v = Z x (Golub
//! and Van Loan, Matrix Computations, 4th ed., sections 7.4.1 and 7.6.4; small divisors as in EISPACK's `hqr2`).

use super::eigenvalues::{add_multiple, dot, reflect_columns, reflect_many_columns, scale, split};
use nalgebra::{Complex, DMatrix};
use std::ops::Range;

/// A solution with an entry larger than this is scaled down, so that divisions by rounding errors do not let it overflow.
const LARGE: f64 = 1e20;

/// An eigenvalue λ and a vector v with A v = λ v.
pub type Eigenpair = (Complex<f64>, Vec<Complex<f64>>);

/// Returns the eigenvalues of a square matrix, in the matrix's unit and the same doubles in the same order as from
/// [`eigenvalues`](super::eigenvalues()), each with a vector of length one. Conjugate eigenvalues have conjugate vectors. A
/// repeated eigenvalue has independent vectors if the matrix has them; otherwise they are nearly parallel. `None` where
/// an entry is not finite, or the iteration does not converge.
#[must_use]
pub fn eigenpairs(matrix: &DMatrix<f64>) -> Option<Vec<Eigenpair>> {
    let (size, mut a) = (matrix.nrows(), matrix.clone());
    let scale = scale(&mut a)?;
    let mut blocks = a.clone();
    let mut z = DMatrix::identity(size, size);
    let mut product = vec![0.0; size];
    let values = split(&mut blocks, &mut |row, vector, factor| {
        let columns = &mut z.as_mut_slice()[row * size..];
        match *vector {
            [a, b] => reflect_columns(columns, size, 0..size, [a, b], factor),
            [a, b, c] => reflect_columns(columns, size, 0..size, [a, b, c], factor),
            _ => reflect_many_columns(columns, vector, factor, &mut product),
        }
    })?;
    let triangle = Triangle::new(z.transpose() * (a * &z), &blocks);
    // A complex vector takes two columns, of the real and the imaginary part, and its conjugate none.
    let mut x = DMatrix::zeros(size, size);
    for (column, &value) in values.iter().enumerate().filter(|(_, value)| value.im >= 0.0) {
        let parts = triangle.solution(value, size - 1 - column);
        for (part, column) in parts.iter().zip(column..).take(1 + usize::from(value.im > 0.0)) {
            x.column_mut(column).rows_mut(0, part.len()).copy_from_slice(part);
        }
    }
    let v = z * x;
    let pairs = values.iter().enumerate().map(|(column, &value)| {
        let first = column - usize::from(value.im < 0.0);
        let entry = |row| match value.im {
            0.0 => Complex::new(v[(row, first)], 0.0),
            im => Complex::new(v[(row, first)], im.signum() * v[(row, first + 1)]),
        };
        (value * scale, (0..size).map(entry).collect())
    });
    Some(pairs.collect())
}

/// A real Schur form: what is below the diagonal is not zero within a block of two rows only.
struct Triangle {
    t: DMatrix<f64>,
    /// Smaller divisors are rounding errors.
    floor: f64,
}

impl Triangle {
    /// The diagonal blocks are taken from `blocks`, so that equal eigenvalues are equal to the last bit.
    fn new(mut t: DMatrix<f64>, blocks: &DMatrix<f64>) -> Self {
        for row in 0..t.nrows() {
            t[(row, row)] = blocks[(row, row)];
            if row > 0 {
                t[(row, row - 1)] = blocks[(row, row - 1)];
                if t[(row, row - 1)] != 0.0 {
                    t[(row - 1, row)] = blocks[(row - 1, row)];
                }
            }
        }
        // The square of the floor must not vanish.
        Self { floor: (f64::EPSILON * t.norm()).max(1e-150), t }
    }

    /// The rows of the diagonal block that a row belongs to.
    fn block_of(&self, row: usize) -> Range<usize> {
        let coupled = |row: usize| row > 0 && row < self.t.nrows() && self.t[(row, row - 1)] != 0.0;
        row - usize::from(coupled(row))..row + 1 + usize::from(coupled(row + 1))
    }

    /// The rows of T − λ within a block of two rows.
    fn block(&self, rows: &Range<usize>, value: Complex<f64>) -> [[Complex<f64>; 2]; 2] {
        let entry = |i, j| Complex::from(self.t[(rows.start + i, rows.start + j)]);
        [[entry(0, 0) - value, entry(0, 1)], [entry(1, 0), entry(1, 1) - value]]
    }

    /// x of length one with (T − λ) x = 0 as real and imaginary part, without the zeros below the block of λ, to which
    /// `row` belongs; another one for each row of the block.
    fn solution(&self, value: Complex<f64>, row: usize) -> [Vec<f64>; 2] {
        let mut rows = self.block_of(row);
        let mut x = [vec![0.0; rows.end], vec![0.0; rows.end]];
        let mut found = self.start(value, row, &rows);
        loop {
            let largest = found[0].l1_norm().max(found[1].l1_norm());
            if largest > LARGE {
                found = found.map(|entry| entry / largest);
                x.iter_mut().flatten().for_each(|entry| *entry /= largest);
            }
            for (row, entry) in rows.clone().zip(found) {
                for (part, entry) in x.iter_mut().zip([entry.re, entry.im]) {
                    part[row] = entry;
                    if entry != 0.0 {
                        let above = &mut part[..rows.start];
                        add_multiple(above, -entry, self.t.column(row).as_slice());
                    }
                }
            }
            let Some(last) = rows.start.checked_sub(1) else { break };
            rows = self.block_of(last);
            let right = [rows.start, last].map(|row| Complex::new(x[0][row], x[1][row]));
            found = self.quotient(&rows, value, right);
        }
        let length = x.iter().map(|part| dot(part, part)).sum::<f64>().sqrt();
        x.iter_mut().flatten().for_each(|entry| *entry /= length);
        x
    }

    /// The solution's entries in the block of λ itself.
    fn start(&self, value: Complex<f64>, row: usize, rows: &Range<usize>) -> [Complex<f64>; 2] {
        if rows.len() == 1 {
            return [Complex::ONE, Complex::ZERO];
        }
        // But for rounding, each row is a multiple of the other; rounding matters least in the longer one.
        let [upper, lower] = self.block(rows, value);
        let length = |[p, q]: [Complex<f64>; 2]| p.l1_norm() + q.l1_norm();
        let [p, q] = if length(upper) > length(lower) { upper } else { lower };
        if length([p, q]) > self.floor {
            return [q / length([p, q]), -p / length([p, q])];
        }
        // Any vector is a solution: one that is independent of that of the other eigenvalue.
        let other = if value.im > 0.0 { Complex::I } else { Complex::ZERO };
        if row == rows.start { [Complex::ONE, other] } else { [other, Complex::ONE] }
    }

    /// (T − λ)⁻¹ of a right side within a block; of a block of one row the first entry counts.
    fn quotient(
        &self,
        rows: &Range<usize>,
        value: Complex<f64>,
        [upper, lower]: [Complex<f64>; 2],
    ) -> [Complex<f64>; 2] {
        let divisor =
            |z: Complex<f64>| if z.l1_norm() < self.floor { self.floor.into() } else { z };
        if rows.len() == 1 {
            return [upper / divisor(self.t[(rows.start, rows.start)] - value), Complex::ZERO];
        }
        // With the largest entry first, the second divisor shows how near λ is to an eigenvalue of the block.
        let [[a, b], [c, d]] = self.block(rows, value);
        let [left, right] = [a.l1_norm().max(c.l1_norm()), b.l1_norm().max(d.l1_norm())];
        let (p, q) = if left < right {
            ([b, a, upper], [d, c, lower])
        } else {
            ([a, b, upper], [c, d, lower])
        };
        let (p, q) = if p[0].l1_norm() < q[0].l1_norm() { (q, p) } else { (p, q) };
        let pivot = divisor(p[0]);
        let factor = q[0] / pivot;
        let second = (q[2] - factor * p[2]) / divisor(q[1] - factor * p[1]);
        let first = (p[2] - p[1] * second) / pivot;
        if left < right { [second, first] } else { [first, second] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::eigenvalues;
    use proptest::prelude::*;

    /// Checks residuals, lengths, conjugates and the eigenvalues; returns the vectors as columns.
    fn checked(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
        let size = matrix.nrows();
        let pairs = eigenpairs(matrix).unwrap();
        let values: Vec<_> = pairs.iter().map(|pair| pair.0).collect();
        assert_eq!(values, eigenvalues(matrix.clone()).unwrap());
        let largest = matrix.amax();
        let unit = if largest == 0.0 { 1.0 } else { largest };
        let scaled = (matrix / unit).map(Complex::from);
        let vectors = DMatrix::from_fn(size, size, |i, j| pairs[j].1[i]);
        for (column, value) in values.iter().enumerate() {
            let v = vectors.column(column);
            assert!((v.norm() - 1.0).abs() < 1e-14 * size as f64, "{v}");
            let residual = (&scaled * v - v * (value / unit)).norm();
            let bound = 4.0 * f64::EPSILON * size as f64 * scaled.norm();
            assert!(residual <= bound, "{residual:e} of {bound:e}: {value} of {matrix}");
            if value.im < 0.0 {
                assert_eq!(vectors.column(column - 1).map(|entry| entry.conj()), v);
            }
            assert!(value.im != 0.0 || v.iter().all(|entry| entry.im == 0.0));
        }
        vectors
    }

    /// The smallest singular value of the vectors: 0 where they are dependent.
    fn independence(matrix: &DMatrix<f64>) -> f64 {
        checked(matrix).singular_values().min()
    }

    fn mirror(size: usize, turn: f64) -> DMatrix<f64> {
        let v = nalgebra::DVector::from_fn(size, |i, _| (1.0 + turn + (7 * i) as f64).sin());
        let v = v.normalize();
        DMatrix::identity(size, size) - &v * v.transpose() * 2.0
    }

    fn entries(size: usize) -> impl Strategy<Value = DMatrix<f64>> {
        let values = prop::collection::vec(-1.0..1.0, size * size);
        values.prop_map(move |values| DMatrix::from_vec(size, size, values))
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

        #[test]
        fn vectors_of_any_matrix_fulfil_their_equation(
            matrix in (0_usize..30).prop_flat_map(entries),
            width in 1_usize..30,
            power in -200_i32..200,
            spread in 0_i32..6,
        ) {
            let banded = matrix.map_with_location(|i, j, value| {
                // As springs do on masses of different sizes.
                let size = 10_f64.powi(spread).powf((i % 3) as f64);
                if i.abs_diff(j) <= width { size * value } else { 0.0 }
            });
            checked(&(banded * 10_f64.powi(power)));
        }

        #[test]
        fn vectors_of_a_symmetric_matrix_are_orthogonal(matrix in (1_usize..20).prop_flat_map(entries)) {
            prop_assert!(independence(&(&matrix + matrix.transpose())) > 1.0 - 1e-9);
        }

        #[test]
        fn equal_parts_that_are_not_coupled_have_independent_vectors(
            block in (1_usize..5).prop_flat_map(entries),
            copies in 1_usize..5,
            turn in 0.0..9.0,
        ) {
            let (rows, alone) = (block.nrows(), independence(&block));
            prop_assume!(alone > 1e-3);
            let size = rows * copies;
            // One after another, with rows by turns, and mixed by a mirror, whose rounding couples them.
            let one_by_one = DMatrix::from_fn(size, size, |i, j| {
                if i / rows == j / rows { block[(i % rows, j % rows)] } else { 0.0 }
            });
            prop_assert!((independence(&one_by_one) / alone - 1.0).abs() < 1e-6);
            let by_turns = DMatrix::from_fn(size, size, |i, j| {
                if i % copies == j % copies { block[(i / copies, j / copies)] } else { 0.0 }
            });
            prop_assert!(independence(&by_turns) > 1e-7 * alone);
            let mirror = mirror(size, turn);
            prop_assert!(independence(&(&mirror * by_turns * &mirror)) > 1e-7 * alone);
        }
    }

    #[test]
    fn multiples_of_one_and_zero_have_a_vector_for_each_row() {
        for (size, value) in [(0, 1.0), (1, -3.0), (1, 0.0), (2, 1e9), (3, 0.0), (8, 1e-250)] {
            let vectors = checked(&(DMatrix::identity(size, size) * value));
            assert_eq!(vectors.map(|entry| entry.re.abs()).sum(), size as f64);
            assert!(vectors.determinant().norm() == 1.0);
        }
    }

    #[test]
    fn a_zero_that_comes_several_times_has_independent_vectors() {
        // Chains without a support, uncoupled but numbered by turns and mirrored: each flies.
        for (chains, turn) in
            [2, 3, 5].into_iter().flat_map(|n| (0..500).map(move |turn| (n, turn)))
        {
            let size = 4 * chains;
            let chain = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
                0 if i < chains || i + chains >= size => 1e6,
                0 => 2e6,
                apart if apart == chains => -1e6,
                _ => 0.0,
            });
            assert!(independence(&chain) > 1e-6);
            let mirror = mirror(size, f64::from(turn));
            let found = independence(&(&mirror * chain * &mirror));
            assert!(found > 1e-4, "{chains} {turn} {found:e}");
        }
    }

    #[test]
    fn a_defective_eigenvalue_has_a_finite_vector() {
        for (size, scale) in [(2, 1.0), (3, 1e5), (12, 1.0), (60, 1e150)] {
            let jordan = DMatrix::from_fn(size, size, |i, j| match (i, j) {
                _ if i == j => 2.0 * scale,
                _ if i + 1 == j => scale,
                _ => 0.0,
            });
            let vectors = checked(&jordan);
            assert!(vectors.row(0).iter().all(|entry| (entry.norm() - 1.0).abs() < 1e-14));
            checked(&jordan.transpose());
            let mirror = mirror(size, 0.0);
            checked(&(&mirror * jordan * &mirror));
        }
    }

    #[test]
    fn a_block_of_two_rows_with_real_eigenvalues_has_accurate_vectors() {
        // 2 and 1 but for a part in 10²⁰, below rounding; 10⁻¹⁰ is not.
        for (b, c) in [(1e-10, 1e-10), (1e-10, 1.0), (1e3, 1e-12)] {
            for diagonal in [[2.0, 1.0], [1.0, 2.0]] {
                let [a, d] = diagonal;
                let vectors = checked(&DMatrix::from_row_slice(2, 2, &[a, b, c, d]));
                let half: f64 = 0.5 * (a - d);
                let far = half + (half * half + b * c).sqrt().copysign(half);
                let slopes = [c / far, -far / b].map(of_slope);
                for (found, slope) in vectors.column_iter().zip(slopes) {
                    assert!((found[0].re.abs() - slope[0]).abs() < 1e-14, "{found} {slope:?}");
                    assert!((found[1].re.abs() - slope[1]).abs() < 1e-14, "{found} {slope:?}");
                }
            }
        }
    }

    /// The entries, without signs, of a vector of length one with this slope.
    fn of_slope(slope: f64) -> [f64; 2] {
        let length = 1.0_f64.hypot(slope);
        [1.0 / length, slope.abs() / length]
    }

    #[test]
    fn oscillators_with_dampers_have_the_vectors_of_their_companion() {
        // [0 1; −K −D]: v = (u, λ u), equal oscillators twice.
        let size = 6;
        let matrix = DMatrix::from_fn(2 * size, 2 * size, |i, j| match (i < size, j < size) {
            (true, true) => 0.0,
            (true, false) => f64::from(i + size == j),
            (false, true) => match (i - size).abs_diff(j) {
                0 => -2e6,
                2 => 1e6,
                _ => 0.0,
            },
            (false, false) => {
                if i == j {
                    -3.0
                } else {
                    0.0
                }
            }
        });
        let pairs = eigenpairs(&matrix).unwrap();
        for (value, vector) in &pairs {
            for row in 0..size {
                let apart = (vector[size + row] - value * vector[row]).norm();
                assert!(apart < 1e-9, "{apart:e}");
            }
        }
        assert!(independence(&matrix) > 1e-5);
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        let mut matrix = DMatrix::identity(3, 3);
        matrix[(2, 0)] = f64::INFINITY;
        assert_eq!(eigenpairs(&matrix), None);
    }
}
