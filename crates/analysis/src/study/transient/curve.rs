//! One mode over the rows of a stretch in which no contact changes its state.

use super::growth::STRAIGHT;
use super::linear::FINEST;
use super::straight::{Fit, pieces};
use crate::study::basis::Members;
use amontons::numerics::max_norm;
use nalgebra::{Complex, DVector};
use std::f64::consts::TAU;
use std::ops::Range;

/// A [`Difference`] that leaves less than this of a mode does not show it.
const LEAST_LEFT: f64 = 1e-2;

/// One mode over the kept rows of a stretch.
pub(super) struct Curve<'a> {
    pub(super) members: &'a Members,
    /// Values of the degree of freedom that moves most, complex, with the amplitude as modulus, m.
    pub(super) values: Vec<Complex<f64>>,
    pub(super) dof: usize,
    /// The amplitude of each degree of freedom, in parts of the largest.
    pub(super) shape: Vec<f64>,
    /// Number of kept rows after a value that are in it.
    pub(super) reach: usize,
    /// Amplification of rounding compared with the second difference that leaves all of the mode.
    pub(super) noise: f64,
}

/// A sum over rows that leaves neither straight lines nor oscillations of some frequencies, and of an exponential a
/// multiple of itself.
struct Difference {
    /// The weight of each row.
    weights: Vec<f64>,
    /// Distance between two rows of the sum, in kept rows.
    lag: usize,
    /// Factor by which the difference multiplies the values of the mode.
    left: Complex<f64>,
}

impl Difference {
    /// With rows `step` (s) apart, without the frequencies (Hz) of `drives`, of a mode with this eigenvalue (1/s).
    #[allow(clippy::cast_precision_loss)]
    fn of(drives: &[f64], lag: usize, step: f64, eigenvalue: Complex<f64>) -> Self {
        let apart = lag as f64 * step;
        // (E − 1)² for lines, and E² − 2 cos(ωΔ) E + 1 for each oscillation, E being the next row.
        let mut weights = vec![1.0, -2.0, 1.0];
        for frequency in drives {
            let turned = 2.0 * libm::cos(TAU * (frequency * apart).fract());
            let mut next = vec![0.0; weights.len() + 2];
            for (place, weight) in weights.iter().enumerate() {
                next[place] += weight;
                next[place + 1] -= turned * weight;
                next[place + 2] += weight;
            }
            weights = next;
        }
        let turned = (eigenvalue * apart).exp();
        let left = weights.iter().rev().fold(Complex::ZERO, |sum, weight| sum * turned + *weight);
        Self { weights, lag, left }
    }

    /// Number of rows after the first that are in it.
    const fn reach(&self) -> usize {
        self.lag * (self.weights.len() - 1)
    }

    fn noise(&self) -> f64 {
        let sum: f64 = self.weights.iter().map(|weight| weight.abs()).sum();
        (0.25 * sum / self.left.norm()).max(1.0)
    }

    /// The difference of one of the values of each row, from a row on, in parts of what is left of the mode.
    fn at(&self, values: impl Fn(usize) -> Complex<f64>, row: usize) -> Complex<f64> {
        let rows = self.weights.iter().enumerate();
        rows.map(|(i, weight)| values(row + i * self.lag) * *weight).sum::<Complex<f64>>()
            / self.left
    }
}

impl Members {
    /// The curve of these modes from rows `step` (s) apart of a scene that is driven with the frequencies (Hz) of
    /// `drives`. `None` where no difference shows the mode.
    pub(super) fn curve(
        &self,
        coefficients: &[DVector<Complex<f64>>],
        drives: &[f64],
        step: f64,
    ) -> Option<Curve<'_>> {
        let of = |lag: usize| Difference::of(drives, lag, step, self.eigenvalue);
        let left = |lag: usize| of(lag).left.norm();
        // The first that leaves as much as there was, or else the one that leaves most.
        let lags = 1..=(coefficients.len() / (8 * (1 + drives.len()))).max(1);
        let lag = lags
            .clone()
            .find(|&lag| left(lag) >= 1.0)
            .or_else(|| lags.max_by(|&a, &b| left(a).total_cmp(&left(b))))?;
        let difference = of(lag);
        let is_shown = difference.left.norm() >= LEAST_LEFT && difference.left.is_finite();
        if !is_shown || difference.reach() >= coefficients.len() {
            return None;
        }
        // Both of a pair make the motion, which is real.
        let pair = if self.eigenvalue.im > 0.0 { 2.0 } else { 1.0 };
        let of_member =
            |i: usize, member: usize| difference.at(|row| coefficients[row][member] * pair, i);
        let at = |i: usize, dof: usize| -> Complex<f64> {
            self.members.iter().map(|(place, shape)| of_member(i, *place) * shape[dof]).sum()
        };
        let (reach, noise) = (difference.reach(), difference.noise());
        let count = coefficients.len() - reach;
        let dofs = self.members[0].1.len();
        // Not always an end: a signal may wake a scene that rests.
        let size = |i: usize| {
            self.members.iter().fold(0.0, |sum, (place, _)| sum + of_member(i, *place).norm_sqr())
        };
        let strongest = (0..count).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
        let sizes: Vec<f64> = (0..dofs).map(|dof| at(strongest, dof).norm()).collect();
        let largest = max_norm(&sizes);
        let dof = sizes.iter().position(|size| *size >= largest * (1.0 - 1e-9))?;
        let shape =
            sizes.iter().map(|size| if largest > 0.0 { size / largest } else { 0.0 }).collect();
        let values = (0..count).map(|i| at(i, dof)).collect();
        Some(Curve { members: self, values, dof, shape, reach, noise })
    }
}

impl Curve<'_> {
    /// The straight pieces of the amplitude's logarithm.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn straight(
        &self,
        range: Range<usize>,
        begin: f64,
        step: f64,
    ) -> Vec<(Range<usize>, Fit)> {
        let point = |i: usize| [begin + i as f64 * step, libm::log(self.values[i].norm())];
        let points: Vec<[f64; 2]> = range.clone().map(point).collect();
        if points.len() < 2 {
            return Vec::new();
        }
        let whole = Fit::of(&points);
        if whole.apart <= STRAIGHT {
            return vec![(range, whole)];
        }
        let pieces = pieces(&points, STRAIGHT).into_iter().filter(|piece| piece.len() > 1);
        pieces
            .map(|piece| {
                let fit = Fit::of(&points[piece.clone()]);
                (range.start + piece.start..range.start + piece.end, fit)
            })
            .collect()
    }

    /// The frequency, and how far it may be off, Hz.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn frequency(&self, range: Range<usize>, begin: f64, step: f64) -> [f64; 2] {
        let lambda = self.members.eigenvalue;
        if lambda.im == 0.0 {
            return [0.0, 0.0];
        }
        // The rest of the phase, after that of the eigenvalue is taken away, has no jumps.
        let mut phase = 0.0;
        let points: Vec<[f64; 2]> = range
            .map(|i| {
                let time = i as f64 * step;
                let left = self.values[i].arg() - (lambda.im * time).rem_euclid(TAU);
                phase += libm::remainder(left - phase, TAU);
                [begin + time, phase]
            })
            .collect();
        let fit = Fit::of(&points);
        let length = points[points.len() - 1][0] - points[0][0];
        let error = fit.slope_error(length) + FINEST * lambda.norm();
        [(lambda.im + fit.slope) / TAU, error / TAU]
    }
}
