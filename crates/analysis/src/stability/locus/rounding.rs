//! Growth that is more than rounding.
//!
//! Without single dampers a growth rate is zero exactly where σ is real and nothing damps it, so that every sign counts. With
//! them the eigenvalues of modes that the dampers hardly reach have growth rates of the size of rounding.

use super::Crossing;
use super::events::{BranchPoint, on_branch};
use super::follow::Evaluate;
use amontons::{Error, numerics};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A growth rate up to this part of |λ| is the rounding of zero.
const NEUTRAL: f64 = 1e-9;

/// `true` for the eigenvalue λ of a mode that neither grows nor decays, but for rounding. A mode that diverges is none.
#[must_use]
pub fn is_neutral(eigenvalue: Complex<f64>) -> bool {
    eigenvalue.re.abs() <= NEUTRAL * eigenvalue.norm()
}

/// `true` for the eigenvalue λ of a mode that grows by more than rounding.
#[must_use]
pub fn is_growing(eigenvalue: Complex<f64>) -> bool {
    eigenvalue.re > 0.0 && !is_neutral(eigenvalue)
}

/// A branch with its points, of which there are at least two.
pub(super) struct Branch<'a> {
    pub(super) evaluate: &'a Evaluate<'a>,
    pub(super) mode: usize,
    pub(super) trace: &'a [BranchPoint],
}

/// A part of a branch between two changes of the sign of its growth rate, or from or to an end of the branch.
struct Stretch {
    /// The points of the trace inside, and the one in the middle; ascending.
    points: Vec<BranchPoint>,
    /// The places of the first and the last point with more than rounding.
    clear: Option<[usize; 2]>,
}

impl Branch<'_> {
    /// The changes between growth by more than rounding and none, from the changes of sign in their order. A mode begins to grow, or
    /// ceases to, at the change of sign if its rate is more than rounding beside it, or one point farther; else where it becomes so.
    ///
    /// # Errors
    /// Returns an error if the state cannot be analysed at a value between.
    pub(super) fn clear(&self, signs: &[Crossing]) -> Result<Vec<Crossing>, Error> {
        let last = self.trace.len() - 1;
        let mut kept = Vec::new();
        let mut grows = false;
        // The value at which the present growth ends.
        let mut end = None;
        for place in 0..=signs.len() {
            let before = place.checked_sub(1).map(|place| signs[place]);
            let after = signs.get(place).copied();
            let from = before.map_or(self.trace[0].0, |it| it.value);
            let to = after.map_or(self.trace[last].0, |it| it.value);
            let Stretch { points, clear } = self.stretch(from, to)?;
            let is_positive = match (before, after) {
                (Some(before), _) => before.becomes_unstable,
                (None, Some(after)) => !after.becomes_unstable,
                (None, None) => self.trace[0].1.grows(),
            };
            if let Some([first, final_one]) = clear.filter(|_| is_positive) {
                if !grows {
                    kept.extend(match first {
                        0 | 1 => before,
                        _ => Some(self.edge([points[first - 1], points[first]], true)?),
                    });
                }
                end = match points.len() - final_one {
                    1 | 2 => after,
                    _ => Some(self.edge([points[final_one], points[final_one + 1]], false)?),
                };
                grows = true;
            } else if grows && (points.len() > 2 || clear.is_some()) {
                // A dip of rounding between two points is none.
                kept.extend(end.take());
                grows = false;
            }
        }
        // Growth that becomes rounding before the last value.
        kept.extend(end.filter(|_| grows));
        Ok(kept)
    }

    fn stretch(&self, from: f64, to: f64) -> Result<Stretch, Error> {
        let inside = self.trace.iter().copied().filter(|point| from <= point.0 && point.0 <= to);
        let mut points: Vec<BranchPoint> = inside.collect();
        let middle = 0.5 * (from + to);
        let after = self.trace.partition_point(|point| point.0 < middle);
        let after = after.clamp(1, self.trace.len() - 1);
        let around = [self.trace[after - 1], self.trace[after]];
        let place = points.partition_point(|point| point.0 < middle);
        points.insert(place, on_branch(self.evaluate, around, middle)?);
        let is_clear = |point: &BranchPoint| !is_neutral(point.1.lambda);
        let first = points.iter().position(is_clear);
        let clear = first.zip(points.iter().rposition(is_clear)).map(|(first, last)| [first, last]);
        Ok(Stretch { points, clear })
    }

    /// The value between two points at which the growth rate becomes more than rounding, or ceases to be.
    fn edge(&self, [mut low, mut high]: [BranchPoint; 2], begins: bool) -> Result<Crossing, Error> {
        while let Some(middle) = numerics::middle(low.0, high.0) {
            let point = on_branch(self.evaluate, [low, high], middle)?;
            let is_high = is_neutral(point.1.lambda) != begins;
            *(if is_high { &mut high } else { &mut low }) = point;
        }
        let (rests, grows) = if begins { (low, high) } else { (high, low) };
        let frequency_hz = grows.1.lambda.im / TAU;
        Ok(Crossing { value: rests.0, mode: self.mode, frequency_hz, becomes_unstable: begins })
    }
}
