//! Singular values and vectors of small complex matrices, by one-sided Jacobi rotations.
//!
//! Columns are rotated in pairs until all are orthogonal: A V = W. The norms of W's columns are the singular values,
//! and V's columns the right singular vectors (Hestenes 1958, J. SIAM 6, 51). The method takes several times as long as
//! the reduction to a bidiagonal matrix, but is simple and reliable: nalgebra 0.35 returns wrong left vectors for about
//! one singular complex matrix in a hundred.

use super::complex::modulus;
use nalgebra::DVector;
use nalgebra::{Complex, DMatrix};

type Matrix = DMatrix<Complex<f64>>;

/// Largest number of sweeps over all pairs; five to ten are enough.
const SWEEPS: usize = 60;

/// The singular values and right vectors of a complex matrix A, from A V = W.
pub struct SingularValues {
    /// W, with orthogonal columns.
    turned: Matrix,
    /// The unitary matrix V.
    turn: Matrix,
}

impl SingularValues {
    /// Computes the singular values; `None` if an entry is not finite.
    pub fn of(matrix: Matrix) -> Option<Self> {
        let mut turn = Matrix::identity(matrix.ncols(), matrix.ncols());
        let mut turned = matrix;
        // A column below this norm is rounding, and its direction has no meaning.
        let rounding = turned.norm() * f64::EPSILON;
        if !rounding.is_finite() {
            return None;
        }
        for _ in 0..SWEEPS {
            let mut is_done = true;
            for second in 1..turned.ncols() {
                for first in 0..second {
                    if let Some(rotation) = Rotation::of(&turned, first, second, rounding) {
                        rotation.turn(&mut turned, first, second);
                        rotation.turn(&mut turn, first, second);
                        is_done = false;
                    }
                }
            }
            if is_done {
                return Some(Self { turned, turn });
            }
        }
        None
    }

    /// The norms of W's columns, in its order.
    pub fn values(&self) -> Vec<f64> {
        self.turned.column_iter().map(|column| column.norm()).collect()
    }

    /// The largest singular value; zero of a matrix without columns.
    pub fn most(&self) -> f64 {
        self.values().into_iter().fold(0.0, f64::max)
    }

    /// The right singular vectors of the `count` smallest values, as columns.
    pub fn least_vectors(&self, count: usize) -> Matrix {
        let values = self.values();
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&one, &other| values[one].total_cmp(&values[other]));
        self.turn.select_columns(&order[..count])
    }

    /// The shortest x with the least |A x − b|; singular values up to `nothing` count as zero.
    pub fn least_squares(&self, b: &DVector<Complex<f64>>, nothing: f64) -> DVector<Complex<f64>> {
        let parts = self.turned.ad_mul(b);
        let values = self.values();
        let scaled = DVector::from_fn(values.len(), |column, _| {
            let value = values[column];
            if value > nothing { parts[column] / value / value } else { Complex::ZERO }
        });
        &self.turn * scaled
    }
}

/// Turns two columns, p and q, by p ← c p − s ē q and q ← s p + c ē q.
struct Rotation {
    cosine: f64,
    sine: f64,
    /// ē, the phase by which q is multiplied first, so that pᴴ q is real.
    phase: Complex<f64>,
}

impl Rotation {
    /// The rotation that makes two columns orthogonal; `None` if they are orthogonal, or if one of them is rounding.
    fn of(matrix: &Matrix, first: usize, second: usize, rounding: f64) -> Option<Self> {
        let (p, q) = (matrix.column(first), matrix.column(second));
        let product = p.dotc(&q);
        let (size_p, size_q, size) = (p.norm(), q.norm(), modulus(product));
        let is_right = size <= 4.0 * f64::EPSILON * size_p * size_q;
        if is_right || size_p.min(size_q) <= rounding {
            return None;
        }
        let zeta = (size_q - size_p) * (size_q + size_p) / (2.0 * size);
        let tangent = zeta.signum() / (zeta.abs() + (zeta * zeta + 1.0).sqrt());
        let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
        Some(Self { cosine, sine: tangent * cosine, phase: product.conj() / size })
    }

    fn turn(&self, matrix: &mut Matrix, first: usize, second: usize) {
        for row in 0..matrix.nrows() {
            let (p, q) = (matrix[(row, first)], matrix[(row, second)] * self.phase);
            matrix[(row, first)] = p * self.cosine - q * self.sine;
            matrix[(row, second)] = p * self.sine + q * self.cosine;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = Matrix> {
        let entry = (-1.0..1.0, prop_oneof![Just(0.0), -1.0..1.0]);
        proptest::collection::vec(entry, rows * columns).prop_map(move |parts| {
            let mut parts = parts.into_iter();
            Matrix::from_fn(rows, columns, |_, _| {
                let (re, im) = parts.next().expect("one for each place");
                Complex::new(re, im)
            })
        })
    }

    /// A product of a tall and a wide matrix: of a known rank, and known to be singular.
    fn singular() -> impl Strategy<Value = (Matrix, usize)> {
        (2..14_usize).prop_flat_map(|size| {
            (1..size).prop_flat_map(move |rank| {
                (matrix(size, rank), matrix(rank, size)).prop_map(move |(a, b)| (a * b, rank))
            })
        })
    }

    proptest! {
        #[test]
        fn columns_are_turned_to_right_angles(
            matrix in (1..9_usize, 1..9_usize).prop_flat_map(|(m, n)| matrix(m, n)),
        ) {
            let found = SingularValues::of(matrix.clone()).unwrap();
            let size = 1e-13 * matrix.norm().max(1.0);
            let one = Matrix::identity(matrix.ncols(), matrix.ncols());
            prop_assert!((found.turn.ad_mul(&found.turn) - one).norm() < 1e-13);
            prop_assert!((&matrix * &found.turn - &found.turned).norm() < size);
            let mut products = found.turned.ad_mul(&found.turned);
            products.fill_diagonal(Complex::ZERO);
            prop_assert!(products.norm() < size, "{products}");
        }

        #[test]
        fn a_singular_matrix_takes_as_many_vectors_to_nothing_as_it_lacks_rank(
            (matrix, rank) in singular(),
        ) {
            let count = matrix.ncols() - rank;
            for matrix in [matrix.clone(), matrix.adjoint()] {
                let found = SingularValues::of(matrix.clone()).unwrap();
                let vectors = found.least_vectors(count);
                prop_assert!((&matrix * &vectors).norm() < 1e-13 * matrix.norm());
                prop_assert!(
                    (vectors.ad_mul(&vectors) - Matrix::identity(count, count)).norm() < 1e-13
                );
            }
        }

        /// The normal equations hold, and of the solutions it is the one at right angles to those of zero.
        #[test]
        fn least_squares_leave_what_the_columns_cannot_reach((matrix, rank) in singular()) {
            let found = SingularValues::of(matrix.clone()).unwrap();
            let b = DVector::from_fn(matrix.nrows(), |row, _| Complex::new(1.0, row as f64));
            let nothing = 1e-12 * found.most();
            // A random factor can be as good as singular itself.
            prop_assume!(found.values().iter().filter(|&&value| value > 1e-4).count() == rank);
            let x = found.least_squares(&b, nothing);
            let rest = &matrix * &x - &b;
            prop_assert!(matrix.ad_mul(&rest).norm() < 1e-9 * b.norm());
            let idle = found.least_vectors(matrix.ncols() - rank);
            prop_assert!(idle.ad_mul(&x).norm() < 1e-9 * x.norm());
        }
    }

    /// det A = Π σ and |A|² = Σ σ² of a matrix worked by hand: A = [3, 4i; 0, 5] has σ² = 25 ± 20.
    #[test]
    fn values_are_those_of_a_matrix_worked_by_hand() {
        let four_i = Complex::new(0.0, 4.0);
        let matrix = Matrix::from_row_slice(2, 2, &[3.0.into(), four_i, 0.0.into(), 5.0.into()]);
        let mut values = SingularValues::of(matrix).unwrap().values();
        values.sort_by(f64::total_cmp);
        assert!((values[0] - 5.0_f64.sqrt()).abs() < 1e-14);
        assert!((values[1] - 45.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn what_is_not_finite_has_none_and_what_is_empty_has_no_values() {
        assert!(SingularValues::of(Matrix::from_element(2, 2, Complex::from(f64::NAN))).is_none());
        assert!(SingularValues::of(Matrix::zeros(3, 0)).unwrap().values().is_empty());
        let zero = SingularValues::of(Matrix::zeros(3, 3)).unwrap();
        assert_eq!(zero.values(), [0.0; 3]);
    }
}
