//! The largest and the smallest displacement over a periodic motion, at its exact turning points.

use super::chain::Chain;
use super::field::Part;
use super::flow::Flow;
use amontons::integrator::StepFailure;
use amontons::numerics::bisect;

/// The smallest and the largest displacement of each degree of freedom over a chain, m.
///
/// # Errors
/// Returns the contact whose forces were not found.
pub fn extremes(chain: &Chain, flow: &mut Flow) -> Result<Vec<[f64; 2]>, StepFailure> {
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; flow.dofs()];
    for segment in &chain.segments {
        flow.each_part(&segment.states, &segment.start, segment.duration, |part| {
            let Part { powers, duration, .. } = part;
            for (dof, range) in ranges.iter_mut().enumerate() {
                let place = |s: f64| powers.iter().rev().fold(0.0, |sum, c| sum * s + c[dof]);
                let speed = |s: f64| {
                    let terms = powers.iter().enumerate().skip(1).rev();
                    #[allow(clippy::cast_precision_loss)]
                    terms.fold(0.0, |sum, (k, c)| sum * s + k as f64 * c[dof])
                };
                let mut note = |x: f64| *range = [range[0].min(x), range[1].max(x)];
                note(place(0.0));
                note(place(*duration));
                if speed(0.0) * speed(*duration) < 0.0 {
                    let rises = speed(0.0) > 0.0;
                    let [turn, _] = bisect(0.0, *duration, |s| (speed(s) > 0.0) == rises);
                    note(place(turn));
                }
            }
        })?;
    }
    Ok(ranges)
}
