//! Intervals that contain an eigenvalue, from residuals that are free of rounding.

use super::factor::Factors;
use crate::sparse::Sparse;
use faer::{Mat, MatRef};

/// Inflates a bound for the rounding of the norms in it; that of the residual itself is far below.
const NORMS: f64 = 1.0 + 1e-6;

/// An eigenvalue λ = ω² of K x = λ M x with a vector, and how far an eigenvalue of the matrices can be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// The computed λ, 1/s².
    pub value: f64,
    /// |λ − an eigenvalue of the matrices| is at most this, 1/s².
    pub distance: f64,
}

impl Bounded {
    /// The frequencies that belong to the ends of the interval, Hz; 0 for a negative end.
    #[must_use]
    pub fn frequencies(&self) -> [f64; 2] {
        [self.value - self.distance, self.value + self.distance].map(frequency)
    }
}

/// The frequency of an eigenvalue λ = (2 π f)², Hz; 0 if it is negative.
#[must_use]
pub fn frequency(value: f64) -> f64 {
    value.max(0.0).sqrt() / std::f64::consts::TAU
}

/// Bounds each of the eigenvalues by its vector, a column of `vectors` (Krylov and Weinstein): for M positive definite, an
/// eigenvalue is within ‖K x − λ M x‖ of λ, in the norm of M⁻¹, if x has the norm 1 in that of M.
///
/// The residual is summed with twice the digits of a double, since it cancels: in a mode far below the stiffest one, K x is
/// far smaller than the terms that make it up.
#[must_use]
pub fn bound(
    stiffness: &Sparse,
    mass: &Sparse,
    mass_factors: &Factors<'_>,
    values: &[f64],
    vectors: MatRef<'_, f64>,
) -> Vec<Bounded> {
    let mut residuals = Mat::zeros(stiffness.rows(), values.len());
    let mut norms = Vec::with_capacity(values.len());
    for (mode, &value) in values.iter().enumerate() {
        let vector: Vec<f64> = vectors.col(mode).iter().copied().collect();
        let mut norm = 0.0;
        for row in 0..stiffness.rows() {
            // The matrices are symmetric: a column is a row.
            let inertia = dot(mass.column(row), &vector);
            let elastic = dot(stiffness.column(row), &vector);
            norm += vector[row] * inertia.high;
            residuals[(row, mode)] = elastic.minus(inertia.times(value));
        }
        norms.push(norm);
    }
    let mut solved = residuals.clone();
    mass_factors.solve(solved.as_mut());
    (0..values.len())
        .map(|mode| {
            let square: f64 =
                (0..stiffness.rows()).map(|row| residuals[(row, mode)] * solved[(row, mode)]).sum();
            let distance = (square.max(0.0) / norms[mode]).sqrt() * NORMS;
            Bounded { value: values[mode], distance }
        })
        .collect()
}

/// The unevaluated sum of two doubles, of which the second holds what the first has lost.
#[derive(Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// The product with a double.
    fn times(self, factor: f64) -> Self {
        let product = product(self.high, factor);
        Self { high: product.high, low: product.low + self.low * factor }
    }

    /// The difference, rounded to one double.
    fn minus(self, other: Self) -> f64 {
        let difference = sum(self.high, -other.high);
        difference.high + (difference.low + self.low - other.low)
    }
}

/// The sum of a matrix row's products with a vector, with twice the digits of a double (Ogita, Rump and Oishi).
fn dot(row: impl Iterator<Item = (usize, f64)>, vector: &[f64]) -> Double {
    let mut total = Double { high: 0.0, low: 0.0 };
    for (column, value) in row {
        let product = product(value, vector[column]);
        let partial = sum(total.high, product.high);
        total = Double { high: partial.high, low: total.low + (partial.low + product.low) };
    }
    sum(total.high, total.low)
}

/// a + b exactly (Knuth).
fn sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let other = high - a;
    Double { high, low: (a - (high - other)) + (b - other) }
}

/// a b exactly (Dekker), while no half overflows.
fn product(a: f64, b: f64) -> Double {
    let halves = |x: f64| {
        let scaled = 134_217_729.0 * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let high = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let low = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
    Double { high, low }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2⁵³ + 1 and 2⁵³ − 1 have the product 2¹⁰⁶ − 1, which no double holds.
    #[test]
    fn sums_of_products_keep_what_a_double_loses() {
        let (a, b) = (9_007_199_254_740_993_i64 as f64 + 2.0, 9_007_199_254_740_991.0);
        let exact = product(a, b);
        let integer = (a as i128) * (b as i128);
        assert_eq!(exact.high as i128 + exact.low as i128, integer);
        let row = [(0, a), (1, 1.0), (2, -a)];
        let total = dot(row.into_iter(), &[b, 0.5, b]);
        assert_eq!(total.high, 0.5);
    }
}
