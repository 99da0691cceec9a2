//! Vectors that a nearly singular matrix turns to zero.

use amontons::Error;
use nalgebra::{Complex, DMatrix};

/// Number of steps of the iteration. Each divides the other directions by the distance to the next eigenvalue against
/// rounding, so two are enough but next to a merging.
const STEPS: usize = 4;
/// A vector belongs to the null space if the matrix leaves less than this part of it.
const SMALL: f64 = 1e-10;

/// An orthonormal basis, by columns, of the `count` directions that a matrix shortens most, by inverse iteration; `None`
/// where it does not turn all of them to zero, as at a defective eigenvalue.
///
/// # Errors
/// Returns an error if an entry of the matrix is not finite.
pub(super) fn null_space(
    matrix: &DMatrix<Complex<f64>>,
    count: usize,
) -> Result<Option<DMatrix<Complex<f64>>>, Error> {
    let size = matrix.nrows();
    let length = matrix.iter().fold(0.0_f64, |most, entry| most.max(entry.l1_norm()));
    let not_found = || Error::analysis("the shapes of a mode were not found");
    if !length.is_finite() {
        return Err(not_found());
    }
    let mut basis = DMatrix::from_fn(size, count, start);
    // Elimination by rows loses all digits in long chains of modules; reflections do not.
    let mut factors = matrix.clone().qr();
    for step in 0..STEPS {
        if !factors.solve_mut(&mut basis) || basis.iter().any(|entry| !entry.is_finite()) {
            if step > 0 {
                return Err(not_found());
            }
            // It is singular to the last digit; one that differs by rounding has the same null space.
            let rounding = Complex::from(4.0 * f64::EPSILON * length);
            factors = (matrix + DMatrix::from_diagonal_element(size, size, rounding)).qr();
            basis = DMatrix::from_fn(size, count, start);
            if !factors.solve_mut(&mut basis) {
                return Err(not_found());
            }
        }
        basis = basis.qr().q();
    }
    let rest = (matrix * &basis).iter().fold(0.0_f64, |most, entry| most.max(entry.l1_norm()));
    Ok((rest <= SMALL * length).then_some(basis))
}

/// Numbers without a pattern, which no shape is orthogonal to but by accident (Steele et al., Fast splittable pseudorandom
/// number generators, 2014).
#[allow(clippy::cast_precision_loss)]
fn start(row: usize, column: usize) -> Complex<f64> {
    let mut state = (row as u64) << 32 | column as u64;
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ mixed >> 31) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    Complex::new(next(), next())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_defective_eigenvalue_has_one_direction_and_a_double_one_two() {
        let matrix = |links: f64| {
            let entry = |i: usize, j: usize| match (i, j) {
                (0, 1) => links,
                (2, 2) => 3.0,
                _ => 0.0,
            };
            DMatrix::from_fn(3, 3, |i, j| Complex::from(entry(i, j)))
        };
        assert!(null_space(&matrix(1.0), 1).unwrap().is_some());
        assert!(null_space(&matrix(1.0), 2).unwrap().is_none());
        let both = null_space(&matrix(0.0), 2).unwrap().unwrap();
        assert!(both.row(2).iter().all(|entry| entry.norm() < 1e-14));
    }
}
