//! One mode over the rows of a stretch in which no contact changes its state.

use super::growth::STRAIGHT;
use super::linear::{FINEST, most};
use super::straight::{Fit, pieces};
use crate::study::basis::Members;
use nalgebra::{Complex, DVector};
use std::f64::consts::TAU;
use std::ops::Range;

/// A second difference that leaves less than this of a mode does not show it.
const LEAST_LEFT: f64 = 1e-2;

/// One mode over the kept rows of a stretch.
pub(super) struct Curve<'a> {
    pub(super) members: &'a Members,
    /// Of the degree of freedom that moves most, complex, its modulus the amplitude, m.
    pub(super) values: Vec<Complex<f64>>,
    pub(super) dof: usize,
    /// The amplitude of each degree of freedom, in parts of the largest.
    pub(super) shape: Vec<f64>,
    /// Of the second difference, in kept rows.
    pub(super) lag: usize,
}

impl Members {
    /// `None` where no second difference shows the mode.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn curve(
        &self,
        coefficients: &[DVector<Complex<f64>>],
        step: f64,
    ) -> Option<Curve<'_>> {
        let factor = |lag: usize| {
            let turned = self.eigenvalue * (lag as f64 * step);
            (turned.exp() - Complex::ONE).powu(2)
        };
        // The first that leaves as much as there was, or else the one that leaves most.
        let lags = 1..=(coefficients.len() / 8).max(1);
        let lag = lags
            .clone()
            .find(|&lag| factor(lag).norm() >= 1.0)
            .or_else(|| lags.max_by(|&a, &b| factor(a).norm().total_cmp(&factor(b).norm())))?;
        let factor = factor(lag);
        if factor.norm() < LEAST_LEFT || !factor.is_finite() {
            return None;
        }
        // Both of a pair make the motion, which is real.
        let pair = if self.eigenvalue.im > 0.0 { 2.0 } else { 1.0 };
        let difference = |i: usize, member: usize| {
            let [a, b, c] = [i, i + lag, i + 2 * lag].map(|i| coefficients[i][member]);
            (a - b * 2.0 + c) * pair / factor
        };
        let at = |i: usize, dof: usize| -> Complex<f64> {
            self.members.iter().map(|(place, shape)| difference(i, *place) * shape[dof]).sum()
        };
        let count = coefficients.len() - 2 * lag;
        let dofs = self.members[0].1.len();
        // Not always an end: a signal may wake a scene that rests.
        let size = |i: usize| {
            self.members.iter().fold(0.0, |sum, (place, _)| sum + difference(i, *place).norm_sqr())
        };
        let strongest = (0..count).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
        let sizes: Vec<f64> = (0..dofs).map(|dof| at(strongest, dof).norm()).collect();
        let largest = most(&sizes);
        let dof = sizes.iter().position(|size| *size >= largest * (1.0 - 1e-9))?;
        let shape =
            sizes.iter().map(|size| if largest > 0.0 { size / largest } else { 0.0 }).collect();
        let values = (0..count).map(|i| at(i, dof)).collect();
        Some(Curve { members: self, values, dof, shape, lag })
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
        // What is left of the turning when the eigenvalue's is taken away has no jumps.
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
