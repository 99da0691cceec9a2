//! This module follows a motion that has settled, to see whether its contacts take given states together.

use super::look::Look;
use crate::Error;
use crate::contact::ContactState;
use crate::model::LumpedModel;
use crate::simulation::Simulation;
use crate::stability::Symmetry;

/// Looks from one row of a motion to the next: a state that lasts for a 200th of the fastest mode's period is seen.
const LOOKS_A_ROW: f64 = 10.0;

/// Do all contacts take these states at one time, or states that symmetry makes equal to them? The motion is followed
/// from where the simulation is, over its period (s) or, where it has none, a window.
///
/// # Errors
/// A step fails.
pub(super) fn takes(
    simulation: &Simulation,
    look: &Look,
    period: Option<f64>,
    states: &[ContactState],
) -> Result<bool, Error> {
    let mut simulation = Simulation::resume(simulation.save())?;
    let symmetry = Symmetry::of(&LumpedModel::from(simulation.scene()));
    let wanted = symmetry.representative(states);
    let start = simulation.time();
    let time = period.unwrap_or(look.window);
    let looks = (time / look.interval).ceil() * LOOKS_A_ROW;
    let mut done = 0.0;
    while done < looks {
        done += 1.0;
        simulation.advance_to(start + done / looks * time)?;
        if symmetry.representative(simulation.contact_states()) == wanted {
            return Ok(true);
        }
    }
    Ok(false)
}
