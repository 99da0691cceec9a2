//! The smooth part of the logarithm of a determinant.

use super::count::Point;
use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, c64};

/// The highest degree.
const DEGREE: usize = 12;

/// A polynomial q(λ) whose real part fits log |g|.
///
/// exp(q) has no zeros, so g and g exp(−q) wind about 0 equally often along a closed line. Magnitudes are known without
/// multiples of 2π, and the real part of an analytic function decides its imaginary part.
pub(super) struct Drift {
    centre: c64,
    radius: f64,
    coefficients: Vec<c64>,
}

impl Drift {
    /// Fits the polynomial to points within a radius about a centre. If `real`, q is real on the real axis, and so must be
    /// the centre.
    pub(super) fn fit(points: &[Point], centre: c64, radius: f64, real: bool) -> Self {
        let kinds = if real { 1 } else { 2 };
        // Three times as many points as unknowns.
        let terms = (points.len() / (3 * kinds)).clamp(1, DEGREE + 1);
        let mut drift = Self { centre, radius, coefficients: vec![] };
        let powers: Vec<Vec<c64>> =
            points.iter().map(|point| drift.powers(point.place, terms)).collect();
        // The constant has no imaginary part.
        let columns = if real { terms } else { 2 * terms - 1 };
        let matrix = Mat::from_fn(points.len(), columns, |row, column| {
            if column < terms {
                powers[row][column].re
            } else {
                -powers[row][column - terms + 1].im
            }
        });
        let logs = Mat::from_fn(points.len(), 1, |row, _| points[row].value.re);
        let solution = matrix.col_piv_qr().solve_lstsq(&logs);
        let part = |term| if term == 0 || real { 0.0 } else { solution[(terms + term - 1, 0)] };
        drift.coefficients =
            (0..terms).map(|term| c64::new(solution[(term, 0)], part(term))).collect();
        drift
    }

    /// q at a place.
    pub(super) fn at(&self, place: c64) -> c64 {
        let powers = self.powers(place, self.coefficients.len());
        self.coefficients.iter().zip(powers).map(|(coefficient, power)| coefficient * power).sum()
    }

    /// The powers of a place relative to the circle.
    fn powers(&self, place: c64, terms: usize) -> Vec<c64> {
        let relative = (place - self.centre) / self.radius;
        std::iter::successors(Some(c64::new(1.0, 0.0)), |power| Some(power * relative))
            .take(terms)
            .collect()
    }
}
