//! The growth or decay of one mode, on over the edges of signals.

use super::growth::{Phase, STRAIGHT};
use super::linear::{FINEST, Observed};
use super::straight::Fit;
use nalgebra::Complex;

/// If the logarithm of an amplitude jumps by more than this at an edge of a signal, the signal has changed the motion
/// of the mode.
const CORNER: f64 = 1e-2;

/// A mode has no part in a degree of freedom that moves by less than this part of the largest: rounding of its shape.
const UNSEEN: f64 = 1e-11;

/// The growth or decay of one mode in a stretch.
pub(super) struct Trace {
    pub(super) eigenvalue: Complex<f64>,
    /// The amplitude of each degree of freedom, in parts of the largest.
    pub(super) shape: Vec<f64>,
    pub(super) dof: usize,
    pub(super) span: [f64; 2],
    pub(super) fit: Fit,
    /// The frequency and its uncertainty, Hz.
    pub(super) frequency: [f64; 2],
    /// `true` where the mode is a fair part of the motion at some time.
    pub(super) matters: bool,
    /// `true` if its stretch begins with the run or at an edge of a signal.
    pub(super) is_woken: bool,
    /// `true` if it is followed to where a contact changes its state or the run ends, and not only to an edge of a signal.
    pub(super) lasts: bool,
}

impl Trace {
    /// Change of the logarithm of the amplitude.
    pub(super) fn change(&self) -> f64 {
        self.fit.slope * (self.span[1] - self.span[0])
    }

    /// `true` if a mode of the next stretch, which begins no more than `gap` (s) later, is this one, and its line has
    /// no corner there.
    pub(super) fn continues_in(&self, next: &Self, gap: f64) -> bool {
        let joint = 0.5 * (self.span[1] + next.span[0]);
        self.eigenvalue == next.eigenvalue
            && self.dof == next.dof
            && next.span[0] - self.span[1] <= gap
            && self.joined_fit(next).apart <= STRAIGHT
            && (self.fit.at(joint) - next.fit.at(joint)).abs() <= CORNER
    }

    /// The line through both, from the beginning of this one to the end of the next.
    fn joined_fit(&self, next: &Self) -> Fit {
        let ends = [(self, self.span[0]), (next, next.span[1])];
        let [first, last] = ends.map(|(trace, time)| [time, trace.fit.at(time)]);
        let slope = (last[1] - first[1]) / (last[0] - first[0]);
        let mut fit = Fit { slope, middle: first, apart: 0.0 };
        for trace in [self, next] {
            for time in trace.span {
                let apart = (trace.fit.at(time) - fit.at(time)).abs() + trace.fit.apart;
                fit.apart = fit.apart.max(apart);
            }
        }
        fit
    }

    /// This trace and its continuation `next` as one.
    pub(super) fn joined(self, next: &Self) -> Self {
        let fit = self.joined_fit(next);
        let lengths = [&self, next].map(|trace| trace.span[1] - trace.span[0]);
        let mean = (self.frequency[0] * lengths[0] + next.frequency[0] * lengths[1])
            / (lengths[0] + lengths[1]);
        let error = [&self, next]
            .map(|trace| (trace.frequency[0] - mean).abs() + trace.frequency[1])
            .into_iter()
            .fold(0.0, f64::max);
        let (span, matters) = ([self.span[0], next.span[1]], self.matters || next.matters);
        Self { span, fit, frequency: [mean, error], matters, lasts: next.lasts, ..self }
    }

    pub(super) fn phase(&self, observed: Option<Observed>, names: &[String]) -> Phase {
        let (factor, displacement) = match observed {
            // At an output that a mode does not reach, only rounding is seen.
            Some(Observed { dof, is_velocity }) if self.shape[dof] > UNSEEN => {
                let per_time = if is_velocity {
                    libm::hypot(self.eigenvalue.re, self.eigenvalue.im)
                } else {
                    1.0
                };
                (self.shape[dof] * per_time, None)
            }
            _ => (1.0, Some(names[self.dof].clone())),
        };
        let mut phase = Phase::of(None, self.span, &self.fit, self.frequency);
        phase.amplitude = phase.amplitude.map(|amplitude| factor * amplitude);
        phase.rate_error += FINEST * libm::hypot(self.eigenvalue.re, self.eigenvalue.im);
        phase.displacement = displacement;
        phase
    }
}
