//! The critical step of one contact state with single dampers, C̃ ≠ α M̃ + β K̃.
//!
//! A mode z, u of the scheme solves ((z − 1)² M̃ + h (z − 1) C̃ + h² z K̃) u = 0. With z = 1 + h s that is
//! (s² M̃ + s (C̃ + h K̃) + K̃) u = 0: the physics with its damping C̃ raised to C̃ + h K̃, stepped by
//! explicit Euler.
//!
//! Where M̃, C̃, K̃ are symmetric and not negative (no contact slides with friction), every mode solves
//! a scalar equation with real c = uᴴ C u, k = uᴴ K u, which lies in the unit circle while
//! h² k + 2 h c ≤ 4 (Jury): the limit is where 4 M̃ − 2 h C̃ − h² K̃ becomes singular and a mode leaves
//! through −1. This is 1/η for the largest real η of the quadratic problem 4 η² M̃ − 2 η C̃ − K̃.
//!
//! Where friction makes them unsymmetric, modes may grow because the physics does. Then every z is
//! compared with the eigenvalue λ of the physics that is nearest to ln z / h, as for Rayleigh damping.

use super::complex::{logarithm, modulus};
use super::critical_step::{INVENTED_GROWTH, largest};
use crate::Error;
use crate::model::ReducedMatrices;
use nalgebra::{Complex, DMatrix, Schur};

/// The largest step (s) of a state, and whether a mode sets it that does not leave through −1.
pub(super) fn limit(reduced: &ReducedMatrices) -> Result<(f64, bool), Error> {
    let failed = || Error::step_too_large("the eigenvalues of a contact state were not found");
    let size = reduced.mass.nrows();
    if size == 0 {
        return Ok((f64::INFINITY, false));
    }
    let inverse = reduced.mass.clone().try_inverse().ok_or_else(failed)?;
    let (k, c) = (&inverse * &reduced.stiffness, &inverse * &reduced.damping);
    let rates = eigenvalues(&companion(&(&k * 0.25), &(&c * 0.5))).ok_or_else(failed)?;
    let real = |rate: &Complex<f64>| rate.im.abs() <= 1e-7 * modulus(*rate);
    let fastest = rates.iter().filter(|rate| real(rate)).fold(0.0, |most, r| f64::max(most, r.re));
    let through_minus_one = 1.0 / fastest;
    if is_symmetric(&reduced.stiffness) && is_symmetric(&reduced.damping) {
        return Ok((through_minus_one, false));
    }
    let physical = eigenvalues(&companion(&-&k, &-&c)).ok_or_else(failed)?;
    let size_of = physical.iter().fold(0.0, |size, lambda| f64::max(size, modulus(*lambda)));
    let end = through_minus_one.min(2.0 / size_of);
    let step = largest(end, |h| {
        // z = 1 + h s.
        eigenvalues(&companion(&-&k, &-(&c + &k * h)))
            .is_some_and(|rates| rates.iter().all(|s| is_admissible(s * h + 1.0, h, &physical)))
    });
    Ok((step, step < through_minus_one))
}

/// Does the scheme's mode z grow no faster than the physics?
fn is_admissible(z: Complex<f64>, h: f64, physical: &[Complex<f64>]) -> bool {
    // Inside the circle nothing grows; divergence is the physics' own.
    if modulus(z) <= 1.0 || (z.re > 0.0 && z.im.abs() <= 1e-9 * modulus(z)) {
        return true;
    }
    let rate = logarithm(z) / h;
    let distance = |lambda: &Complex<f64>| modulus(lambda - rate);
    let nearest = physical.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.is_some_and(|lambda| rate.re <= lambda.re.max(0.0) + INVENTED_GROWTH * modulus(*lambda))
}

/// The matrix [[0, 1], [a, b]], whose eigenvalues λ solve λ² u = (a + λ b) u.
fn companion(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let n = a.nrows();
    let mut matrix = DMatrix::zeros(2 * n, 2 * n);
    matrix.view_mut((0, n), (n, n)).fill_with_identity();
    matrix.view_mut((n, 0), (n, n)).copy_from(a);
    matrix.view_mut((n, n), (n, n)).copy_from(b);
    matrix
}

fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    // In its own unit of time, so that both rows are of one size.
    let n = matrix.nrows() / 2;
    let unit = matrix.view((n, 0), (n, n)).amax().sqrt().max(matrix.view((n, n), (n, n)).amax());
    if unit == 0.0 {
        return Some(vec![Complex::new(0.0, 0.0); 2 * n]);
    }
    let mut scaled = matrix.clone();
    scaled.view_mut((n, 0), (n, n)).scale_mut(1.0 / (unit * unit));
    scaled.view_mut((n, n), (n, n)).scale_mut(1.0 / unit);
    let transposed = scaled.transpose();
    let attempts = [1.0, 64.0, 4096.0].map(|looser| looser * f64::EPSILON).into_iter();
    let schur = attempts
        .flat_map(|precision| [(&scaled, precision), (&transposed, precision)])
        .find_map(|(matrix, precision)| Schur::try_new(matrix.clone(), precision, 200 * n))?;
    Some(schur.complex_eigenvalues().iter().map(|value| value * unit).collect())
}

fn is_symmetric(matrix: &DMatrix<f64>) -> bool {
    (matrix - matrix.transpose()).amax() <= 1e-12 * matrix.amax()
}
