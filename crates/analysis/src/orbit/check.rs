//! A chain held against the event-driven integrator, which misses no event.

use super::chain::{Chain, Segment};
use super::flow::{Flow, Instant};
use amontons::integrator::{Event, StepFailure};
use nalgebra::DVector;

/// The integrator's events may be this far from the chain's, in parts of the period.
pub(super) const NEAR: f64 = 1e-9;

/// A chain whose segments end farther from each other by the integrator, in parts of the motion's size, is no motion. Near a
/// tangential event rounding alone sets them apart by its inverse rate.
pub(super) const SAME: f64 = 1e-6;

/// How the integrator's motion differs from a chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// It agrees; the largest difference between the end of a segment and the beginning of the next, and the difference
    /// after a whole period, in parts of the motion's size.
    None { defect: f64, closure: f64 },
    /// Another event comes first in this segment, or other states follow: the contact and the event that the integrator
    /// found there, `None` if it found none.
    Elsewhere { segment: usize, found: Option<(usize, Event)> },
}

/// Runs each segment from its beginning, and all of them in one.
///
/// # Errors
/// Returns why a step failed.
pub fn compare(chain: &Chain, flow: &mut Flow) -> Result<Difference, StepFailure> {
    let (count, period) = (chain.segments.len(), chain.period());
    let near = NEAR * period;
    let mut defect = 0.0_f64;
    for ((k, segment), time) in chain.segments.iter().enumerate().zip(chain.times(flow)) {
        let next = &chain.segments[(k + 1) % count];
        match end_of(segment, next, chain, flow, time, near)? {
            Ok(off) if off <= SAME => defect = defect.max(off),
            Ok(_) => return Ok(Difference::Elsewhere { segment: k, found: None }),
            Err(found) => return Ok(Difference::Elsewhere { segment: k, found }),
        }
    }
    let begin = flow.time_of(chain.turn);
    let first = &chain.segments[0];
    let motion = flow.motion(&first.start, &first.states);
    let past = if ends_by_phase(chain) { 0.0 } else { near };
    let (end, instants) = flow.run(&motion, begin, period + past, |_| true)?;
    let reached = match instants.last() {
        Some(last) if past > 0.0 && (last.time - period).abs() <= 2.0 * near => {
            flow.state(&last.after, begin)
        }
        _ => flow.state(&end, begin),
    };
    let closure = chain.size(flow.dofs(), &(reached - &first.start));
    Ok(Difference::None { defect, closure })
}

fn ends_by_phase(chain: &Chain) -> bool {
    chain.segments.last().is_some_and(|segment| segment.stages.is_empty())
}

/// The difference between the end of a segment by the integrator and the beginning of the next; the event that was found
/// if the segment ends otherwise.
fn end_of(
    segment: &Segment,
    next: &Segment,
    chain: &Chain,
    flow: &mut Flow,
    time: f64,
    near: f64,
) -> Result<Result<f64, Option<(usize, Event)>>, StepFailure> {
    let motion = flow.motion(&segment.start, &segment.states);
    let dofs = flow.dofs();
    let off = |flow: &Flow, reached: &amontons::integrator::Motion| -> f64 {
        let reached: DVector<f64> = flow.state(reached, 0.0);
        chain.size(dofs, &(reached - &next.start))
    };
    if segment.stages.is_empty() {
        let (end, instants) = flow.run(&motion, time, segment.duration, |_| true)?;
        let other = instants.iter().find(|instant| !is_nothing(instant, near));
        return Ok(match other {
            None if end.contacts == next.states => Ok(off(flow, &end)),
            other => Err(other.and_then(Instant::first_event)),
        });
    }
    let (_, instants) = flow.run(&motion, time, segment.duration + near, |records| {
        records
            .iter()
            .all(|record| record.time <= near && record.before.contacts == record.after.contacts)
    })?;
    let mut instants = instants.iter().filter(|instant| !is_nothing(instant, near));
    let Some(instant) = instants.next() else { return Ok(Err(None)) };
    let is_same =
        (instant.time - segment.duration).abs() <= near && instant.after.contacts == next.states;
    Ok(if is_same { Ok(off(flow, &instant.after)) } else { Err(instant.first_event()) })
}

/// `true` of an instant at the very beginning that leaves all states as they are.
fn is_nothing(instant: &Instant, near: f64) -> bool {
    instant.time <= near && instant.after.contacts == instant.before.contacts
}
