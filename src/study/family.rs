//! This module tells a motion that others come to from one of a family in which motions of every size go on as they are.
//!
//! A linear motion that nothing damps goes on with the size that it has, so none of its sizes is where other motions end.
//! Two linear motions are: one that signals drive while everything else decays, and the largest one of a family. A larger
//! motion than that makes a contact change its state and loses energy, until it is as small.

use super::linear::{Growth, growth};
use super::look::Look;
use super::recurrence::{begin_fast, way_of_a_step};
use crate::Error;
use crate::simulation::Simulation;

/// By this part of its velocity, at least, a motion is made larger and smaller, to see whether it is the largest of its
/// family.
const LARGER: f64 = 1e-5;

/// Is a linear motion one of a family of motions with every size near its own? Its strongest frequency is `frequency`, Hz.
///
/// # Errors
/// A step fails.
pub(super) fn is_one_of_many(
    simulation: &Simulation,
    look: &Look,
    frequency: Option<f64>,
    is_over: &dyn Fn() -> bool,
) -> Result<bool, Error> {
    if simulation.is_driven_on() && growth(simulation).is_some_and(Growth::is_decaying) {
        return Ok(false);
    }
    let Some(frequency) = frequency else { return Ok(true) };
    let mut fast = Simulation::resume(simulation.save())?;
    // The faster the motion is, the more energy the push adds, to each of its modes.
    begin_fast(&mut fast, look.interval, frequency, look.rows())?;
    // The paper's scheme sees a change of state at the end of a step only.
    let part = LARGER.max(way_of_a_step(simulation, frequency));
    for part in [part, -part] {
        if changes_states(&fast, look, part, is_over)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Does a contact change its state within a window if the motion gets larger by a part of its velocity?
fn changes_states(
    fast: &Simulation,
    look: &Look,
    part: f64,
    is_over: &dyn Fn() -> bool,
) -> Result<bool, Error> {
    let mut motion = Simulation::resume(fast.save())?;
    for (dof, velocity) in fast.velocity().iter().enumerate() {
        motion.push(dof, part * velocity);
    }
    let (start, before) = (motion.time(), motion.statistics().state_changes());
    for row in 1..=look.rows() {
        if row.is_multiple_of(256) && is_over() {
            break;
        }
        #[allow(clippy::cast_precision_loss)]
        motion.advance_to(start + row as f64 * look.interval)?;
        if motion.statistics().state_changes() > before {
            return Ok(true);
        }
    }
    Ok(false)
}
