//! Intervals that contain an eigenvalue, from residuals that are free of rounding.

use super::factor::Factors;
use crate::sparse::Sparse;
use faer::{Mat, MatRef};

/// Inflates a bound for the rounding of the norms in it.
const NORMS: f64 = 1.0 + 1e-6;
/// A solution with the mass matrix may leave this part of its right side.
const SOLVED: f64 = 1e-7;

/// An eigenvalue λ = ω² of K x = λ M x with a vector, and how far an eigenvalue of the matrices can be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// The computed λ, 1/s².
    pub value: f64,
    /// |λ − an eigenvalue of the matrices| is at most this, 1/s².
    pub distance: f64,
}

impl Bounded {
    /// The frequencies that belong to the ends of the interval, Hz, rounded outwards; 0 for a negative end.
    #[must_use]
    pub fn frequencies(&self) -> [f64; 2] {
        let low = frequency((self.value - self.distance).next_down()) * (1.0 - 2.0 * f64::EPSILON);
        let high = frequency((self.value + self.distance).next_up()) * (1.0 + 2.0 * f64::EPSILON);
        [low, high]
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
    let left = mass.times(solved.as_ref()) - &residuals;
    (0..values.len())
        .map(|mode| {
            let residual = residuals.col(mode);
            let square = residual.transpose() * solved.col(mode);
            let is_solved = left.col(mode).norm_l2() <= SOLVED * residual.norm_l2();
            // Nothing is known where a number is not finite, or rounding has spoiled the solution.
            let distance = if is_solved && square >= 0.0 {
                (square / norms[mode]).sqrt() * NORMS
            } else {
                f64::INFINITY
            };
            Bounded { value: values[mode], distance }
        })
        .collect()
}

/// Widens the intervals that overlap, so that a group of m of them contains m eigenvalues: each then has the root of the sum of
/// the squares in its group (Kahan). `bounds` are in ascending order of their values, of vectors that are orthonormal in M.
#[must_use]
pub fn grouped(bounds: &[Bounded]) -> Vec<Bounded> {
    let mut groups: Vec<Vec<Bounded>> = bounds.iter().map(|&bounded| vec![bounded]).collect();
    loop {
        let mut joined: Vec<Vec<Bounded>> = Vec::new();
        for group in groups.iter().cloned() {
            match joined.last_mut() {
                Some(last) if high(last) >= low(&group) => last.extend(group),
                _ => joined.push(group),
            }
        }
        if joined.len() == groups.len() {
            let widened = groups.iter().flat_map(|group| {
                let distance = width(group);
                group.iter().map(move |bounded| Bounded { distance, ..*bounded })
            });
            return widened.collect();
        }
        groups = joined;
    }
}

fn width(group: &[Bounded]) -> f64 {
    group.iter().map(|bounded| bounded.distance.powi(2)).sum::<f64>().sqrt()
}

fn low(group: &[Bounded]) -> f64 {
    group.iter().map(|bounded| bounded.value).fold(f64::INFINITY, f64::min) - width(group)
}

fn high(group: &[Bounded]) -> f64 {
    group.iter().map(|bounded| bounded.value).fold(f64::NEG_INFINITY, f64::max) + width(group)
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

    /// The first two overlap; widened, they reach the third.
    #[test]
    fn intervals_that_overlap_are_widened_together() {
        let bounded = |value, distance| Bounded { value, distance };
        let found =
            grouped(&[bounded(1.0, 0.3), bounded(1.5, 0.4), bounded(2.05, 0.1), bounded(4.0, 0.2)]);
        let together = (0.3_f64.powi(2) + 0.4_f64.powi(2) + 0.1_f64.powi(2)).sqrt();
        let distances: Vec<f64> = found.iter().map(|bounded| bounded.distance).collect();
        assert_eq!(distances, [together, together, together, 0.2]);
    }

    /// 2⁵³ + 1 and 2⁵³ − 1 have the product 2¹⁰⁶ − 1, which no double holds.
    #[test]
    fn sums_of_products_keep_what_a_double_loses() {
        let (a, b) = (9_007_199_254_740_993_i64 as f64 + 2.0, 9_007_199_254_740_991.0);
        let exact = product(a, b);
        let integer = (a as i128) * (b as i128);
        assert_eq!(exact.high as i128 + exact.low as i128, integer);
        // 2⁵⁴ − 1 is rounded in a product, and a half beside it.
        let (a, b) = (134_217_729.0, 134_217_727.0);
        let row = [(0, a), (1, 1.0), (2, -a)];
        assert_eq!(a * b + 0.5 - a * b, 0.0);
        assert_eq!(dot(row.into_iter(), &[b, 0.5, b]).high, 0.5);
    }
}
