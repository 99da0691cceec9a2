//! Where two eigenvalues merge as one parameter changes, and how this place moves with the others.
//!
//! In M = [[Q(λ, µ), b], [cᵀ, 0]] with fixed b and c, the last number g of the solution of M (z, g) = (0, 1) vanishes
//! exactly where λ is an eigenvalue at µ, and ∂g/∂λ besides where it is a double one with one vector. Newton's method
//! for both equations finds (λ, µ) to the last digits, since M is regular there (Spence and Poulton, J. Comput. Phys. 204,
//! 2005, 65–81).

use super::bordered::{Bordered, BorderedChange, Vector};
use nalgebra::{Complex, DMatrix};

/// A place where two eigenvalues are one with one shape.
pub(super) struct DoublePoint {
    /// Their common value, 1/s.
    pub(super) eigenvalue: Complex<f64>,
    /// Change of the parameter that leads there; with an imaginary part if they only come near each other.
    pub(super) change: Complex<f64>,
    left: Vector,
    right: Vector,
}

/// Most steps of Newton's method.
const MOST_STEPS: usize = 40;
/// The method has ended at steps below this part of the eigenvalue and of the parameter.
const END: f64 = 1e-12;

/// The double eigenvalue next to `start`, which is an eigenvalue and a change of the parameter, with left and right
/// shapes near its own; `None` where the method does not end. `by` is the derivative by the parameter, in which the
/// matrices are taken to be linear, and `scale` a size of the parameter.
pub(super) fn double_point(
    matrices: &Bordered,
    by: &BorderedChange,
    scale: f64,
    start: (Complex<f64>, Complex<f64>),
    shapes: [&Vector; 2],
) -> Option<DoublePoint> {
    let [b, c] = shapes.map(|shape| shape.map(|entry| entry.conj()));
    let size = b.len();
    let (mut lambda, mut change) = start;
    for _ in 0..MOST_STEPS {
        let mut q = matrices.at(lambda);
        let length = q.iter().fold(0.0_f64, |most, entry| most.max(entry.l1_norm()));
        by.add_to(&mut q, lambda, change);
        let bordered = DMatrix::from_fn(size + 1, size + 1, |row, column| match (row, column) {
            (row, column) if row == size && column == size => Complex::ZERO,
            (row, column) if row == size => c[column] * length,
            (row, column) if column == size => b[row] * length,
            place => q[place],
        });
        let factors = bordered.clone().lu();
        let transposed = bordered.transpose().lu();
        let mut unit = Vector::zeros(size + 1);
        unit[size] = Complex::from(length);
        let (solved, solved_left) = (factors.solve(&unit)?, transposed.solve(&unit)?);
        let g = solved[size] * length;
        let [right, left] = [solved, solved_left].map(|found| found.rows(0, size).into_owned());
        // Products with the derivatives of Q at this place: `slope` by λ, `by` by the parameter.
        let slope = |z: &Vector| {
            let mut product = matrices.slope_times(lambda, z);
            by.add_slope_times(lambda, change, z, &mut product);
            product
        };
        let derivative_of = |product: &Vector| {
            let mut side = Vector::zeros(size + 1);
            side.rows_mut(0, size).copy_from(&-product);
            Some(factors.solve(&side)?.rows(0, size).into_owned())
        };
        let by_lambda = slope(&right);
        let by_change = by.times(lambda, &right);
        let right_by_lambda = derivative_of(&by_lambda)?;
        let right_by_change = derivative_of(&by_change)?;
        let mut curvature = matrices.curvature_times(&right);
        by.add_curvature_times(change, &right, &mut curvature);
        let g_lambda = -left.dot(&by_lambda);
        let g_change = -left.dot(&by_change);
        let twice = -left.dot(&curvature) - left.dot(&slope(&right_by_lambda)) * 2.0;
        let mixed = -by.slope_form(&left, lambda, &right)
            - left.dot(&slope(&right_by_change))
            - by.form(&left, lambda, &right_by_lambda);
        // g + g_λ dλ + g_µ dµ = 0 and g_λ + g_λλ dλ + g_λµ dµ = 0.
        let determinant = g_lambda * mixed - g_change * twice;
        let step_lambda = (g_change * g_lambda - mixed * g) / determinant;
        let step_change = (twice * g - g_lambda * g_lambda) / determinant;
        if !step_lambda.is_finite() || !step_change.is_finite() {
            return None;
        }
        lambda += step_lambda;
        change += step_change;
        let is_small = step_lambda.norm() <= END * lambda.norm()
            && step_change.norm() <= END * scale.max(change.norm());
        if is_small {
            return Some(DoublePoint { eigenvalue: lambda, change, left, right });
        }
    }
    None
}

impl DoublePoint {
    /// The change of the place of the double eigenvalue, per unit of a parameter with the derivative `of`; `by` is the
    /// derivative by the parameter in which the place is sought.
    pub(super) fn moves(&self, of: &BorderedChange, by: &BorderedChange) -> Complex<f64> {
        let form = |change: &BorderedChange| change.form(&self.left, self.eigenvalue, &self.right);
        -form(of) / form(by)
    }
}
