//! The largest and the smallest displacement over a periodic motion, at its exact turning points.

use super::chain::{Chain, Segment};
use super::flow::Flow;
use super::matrix::times;
use amontons::integrator::StepFailure;
use amontons::numerics::bisect;
use nalgebra::DVector;

/// Powers of the motion over a part of a segment. Over such a part A t has at most norm 1: 1/19! = 8e-18.
const POWERS: usize = 19;

/// The smallest and the largest displacement of each degree of freedom over a chain, m.
///
/// # Errors
/// Returns the contact whose forces were not found.
pub fn extremes(chain: &Chain, flow: &mut Flow) -> Result<Vec<[f64; 2]>, StepFailure> {
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; flow.dofs()];
    for segment in &chain.segments {
        for (powers, part) in parts(segment, flow)? {
            for (dof, range) in ranges.iter_mut().enumerate() {
                let place = |s: f64| powers.iter().rev().fold(0.0, |sum, c| sum * s + c[dof]);
                let speed = |s: f64| {
                    let terms = powers.iter().enumerate().skip(1).rev();
                    #[allow(clippy::cast_precision_loss)]
                    terms.fold(0.0, |sum, (k, c)| sum * s + k as f64 * c[dof])
                };
                let mut note = |x: f64| *range = [range[0].min(x), range[1].max(x)];
                note(place(0.0));
                note(place(part));
                if speed(0.0) * speed(part) < 0.0 {
                    let rises = speed(0.0) > 0.0;
                    let [turn, _] = bisect(0.0, part, |s| (speed(s) > 0.0) == rises);
                    note(place(turn));
                }
            }
        }
    }
    Ok(ranges)
}

/// A segment as power series in the time since the beginning of each of its parts, with the parts' lengths (s).
#[allow(clippy::type_complexity, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn parts(
    segment: &Segment,
    flow: &mut Flow,
) -> Result<Vec<(Vec<DVector<f64>>, f64)>, StepFailure> {
    let field = flow.field(&segment.states)?;
    let units = flow.units();
    let of_column = |j: usize| {
        let column = field.matrix.column(j);
        column.iter().zip(units).map(|(a, unit)| (a / unit).abs()).sum::<f64>() * units[j]
    };
    let norm = (0..units.len()).map(of_column).fold(0.0, f64::max);
    let count = (norm * segment.duration).ceil().max(1.0);
    let part = segment.duration / count;
    let mut start = segment.start.clone();
    let mut all = Vec::with_capacity(count as usize);
    for _ in 0..count as usize {
        let mut powers = vec![start];
        for k in 1..=POWERS {
            #[allow(clippy::cast_precision_loss)]
            let next = times(&field.matrix, &powers[k - 1]) / k as f64;
            powers.push(next);
        }
        start = powers.iter().rev().fold(DVector::zeros(units.len()), |sum, c| sum * part + c);
        all.push((powers, part));
    }
    Ok(all)
}
