//! Where eigenvalues merge as one parameter changes, and how this place moves with the others.
//!
//! In [[Q(λ, µ), B], [Cᵀ, 0]] (Z, G) = (0, 1) with fixed B and C of m columns, G is singular exactly where λ is an eigenvalue
//! at µ. For a simple eigenvalue m is 1. An eigenvalue that symmetry makes m-fold has G = g R with one matrix R. Where two such
//! eigenvalues merge, g and ∂g/∂λ vanish. Newton's method for both equations finds (λ, µ) to the last digits, since the bordered
//! matrix is regular there (Spence and Poulton, J. Comput. Phys. 204, 2005, 65–81).

use super::bordered::{Bordered, BorderedChange, Matrix};
use nalgebra::Complex;

/// A place where two eigenvalues, each m-fold, are one with m shapes.
pub(super) struct DoublePoint {
    /// Their common value, 1/s.
    pub(super) eigenvalue: Complex<f64>,
    /// Change of the parameter that leads there; with an imaginary part if they only come near each other.
    pub(super) change: Complex<f64>,
    /// ∂g/∂µ and ∂²g/∂λ∂µ against half of ∂²g/∂λ².
    slopes: [Complex<f64>; 2],
    /// Left and right shapes, as columns.
    pub(super) left: Matrix,
    pub(super) right: Matrix,
}

/// An eigenvalue problem that depends on a parameter, next to a place where eigenvalues may merge.
pub(super) struct Search<'a> {
    pub(super) matrices: &'a Bordered,
    /// The derivative by the parameter, in which the matrices are taken to be linear.
    pub(super) by: &'a BorderedChange,
    /// Sizes of an eigenvalue, 1/s, and of the parameter: steps much smaller than these are the end.
    pub(super) sizes: [f64; 2],
}

/// Most steps of Newton's method.
const MOST_STEPS: usize = 40;
/// The method has ended at steps below this part of the sizes.
const END: f64 = 1e-12;
/// G is a multiple of one matrix if the rest of it is below this part.
const ALIKE: f64 = 1e-6;

impl Search<'_> {
    /// The double eigenvalue next to `start`, which is an eigenvalue and a change of the parameter, with left and right shapes
    /// near its own as columns; `None` where the method does not end, or where the m eigenvalues do not stay together.
    pub(super) fn double_point(
        &self,
        start: (Complex<f64>, Complex<f64>),
        [left_start, right_start]: [&Matrix; 2],
    ) -> Option<DoublePoint> {
        let Self { matrices, by, sizes } = self;
        let [b, c] = [left_start, right_start].map(|shape| shape.map(|entry| entry.conj()));
        let (size, count) = b.shape();
        let (mut lambda, mut change) = start;
        // R⁻¹, once the first step has shown R.
        let mut inverse: Option<Matrix> = None;
        for _ in 0..MOST_STEPS {
            let mut q = matrices.at(lambda);
            by.add_to(&mut q, lambda, change);
            let length = q.iter().fold(0.0_f64, |most, entry| most.max(entry.l1_norm()));
            let mut bordered = Matrix::zeros(size + count, size + count);
            bordered.view_mut((0, 0), (size, size)).copy_from(&q);
            bordered.view_mut((0, size), (size, count)).copy_from(&(&b * Complex::from(length)));
            bordered
                .view_mut((size, 0), (count, size))
                .copy_from(&(c.transpose() * Complex::from(length)));
            let transposed = bordered.transpose().qr();
            let factors = bordered.qr();
            let mut unit = Matrix::zeros(size + count, count);
            unit.rows_mut(size, count).fill_with_identity();
            unit *= Complex::from(length);
            let (solved, solved_left) = (factors.solve(&unit)?, transposed.solve(&unit)?);
            let rest = solved.rows(size, count) * Complex::from(length);
            let [right, left] = [solved, solved_left].map(|found| found.rows(0, size).into_owned());
            // Products with the derivatives of Q at this place.
            let slope =
                |z: &Matrix| matrices.slope_times(lambda, z) + by.slope_times(lambda, z) * change;
            let derivative_of = |product: &Matrix| {
                let mut side = Matrix::zeros(size + count, count);
                side.rows_mut(0, size).copy_from(&-product);
                Some(factors.solve(&side)?.rows(0, size).into_owned())
            };
            let by_lambda = slope(&right);
            let by_change = by.times(lambda, &right);
            let right_by_lambda = derivative_of(&by_lambda)?;
            let right_by_change = derivative_of(&by_change)?;
            let curvature = matrices.curvature_times(&right) + by.curvature_times(&right) * change;
            let of_left = |product: &Matrix| -left.tr_mul(product);
            let first = of_left(&by_lambda);
            let moved = of_left(&by_change);
            let second =
                of_left(&curvature) + of_left(&slope(&right_by_lambda)) * Complex::from(2.0);
            let mixed = of_left(&by.slope_times(lambda, &right))
                + of_left(&slope(&right_by_change))
                + of_left(&by.times(lambda, &right_by_lambda));
            if inverse.is_none() {
                inverse = Some(moved.clone().try_inverse()?);
            }
            let inverse = inverse.as_ref()?;
            #[allow(clippy::cast_precision_loss)]
            let part = |matrix: &Matrix| (inverse * matrix).trace() / count as f64;
            let [g, g_lambda, g_change, twice, mixed_part] =
                [&rest, &first, &moved, &second, &mixed].map(part);
            // g + g_λ dλ + g_µ dµ = 0 and g_λ + g_λλ dλ + g_λµ dµ = 0.
            let determinant = g_lambda * mixed_part - g_change * twice;
            let step_lambda = (g_change * g_lambda - mixed_part * g) / determinant;
            let step_change = (twice * g - g_lambda * g_lambda) / determinant;
            if !step_lambda.is_finite() || !step_change.is_finite() {
                return None;
            }
            lambda += step_lambda;
            change += step_change;
            if step_lambda.norm() <= END * sizes[0] && step_change.norm() <= END * sizes[1] {
                let is_multiple = |matrix: &Matrix, value: Complex<f64>| {
                    let rest =
                        inverse * matrix - Matrix::from_diagonal_element(count, count, value);
                    rest.norm() <= ALIKE * (value.norm() + g_change.norm() * sizes[1])
                };
                let stay_together = is_multiple(&moved, g_change) && is_multiple(&rest, g);
                let slopes = [g_change, mixed_part].map(|slope| slope / (0.5 * twice));
                return stay_together.then_some(DoublePoint {
                    eigenvalue: lambda,
                    change,
                    slopes,
                    left,
                    right,
                });
            }
        }
        None
    }
}

impl DoublePoint {
    /// The two eigenvalues next to the place after a change of the parameter away from it, to the first order of g: the roots
    /// of d² + g_λµ/(½ g_λλ) δ d + g_µ/(½ g_λλ) δ = 0.
    pub(super) fn pair(&self, away: Complex<f64>) -> [Complex<f64>; 2] {
        let half = -0.5 * self.slopes[1] * away;
        let root = (half * half - self.slopes[0] * away).sqrt();
        [self.eigenvalue + half + root, self.eigenvalue + half - root]
    }

    /// The changes of the place of the double eigenvalue, per unit of a parameter with the derivative `of`, the largest first;
    /// `by` is the derivative by the parameter in which the place is sought. `None` if they are not finite.
    pub(super) fn moves(&self, of: &BorderedChange, by: &BorderedChange) -> Option<Vec<f64>> {
        let form =
            |change: &BorderedChange| self.left.tr_mul(&change.times(self.eigenvalue, &self.right));
        let found = super::eigenvalues(-form(by).lu().solve(&form(of))?);
        let mut found: Vec<f64> = found.iter().map(|value| value.re).collect();
        found.sort_by(|a, b| b.total_cmp(a));
        found.iter().all(|value| value.is_finite()).then_some(found)
    }
}
