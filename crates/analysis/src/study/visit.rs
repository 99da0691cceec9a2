//! This module follows a motion that has settled, to see which states its contacts take together.

use super::observation::ObservationSettings;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::LumpedModel;
use amontons::simulation::Simulation;
use amontons::stability::Symmetry;
use std::collections::HashSet;

/// Looks from one row of a motion to the next: a state that lasts for a 200th of the fastest mode's period is seen.
const LOOKS_A_ROW: f64 = 10.0;

/// States that all contacts take at one time, each as the one that stands for all that symmetry makes equal to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Visited {
    symmetry: Symmetry,
    states: HashSet<Vec<ContactState>>,
}

impl Visited {
    /// `true` if these states are among them, or states that symmetry makes equal to these.
    #[must_use]
    pub fn has(&self, states: &[ContactState]) -> bool {
        self.states.contains(&self.symmetry.representative(states))
    }
}

/// Follows the motion from where the simulation is, over its period (s) or, where it has none, a window.
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn visited(
    simulation: &Simulation,
    observation: &ObservationSettings,
    period: Option<f64>,
) -> Result<Visited, Error> {
    let mut simulation = Simulation::resume(simulation.save())?;
    let symmetry = Symmetry::of(&LumpedModel::from(&simulation.nominal().scene()));
    let mut states = HashSet::new();
    let start = simulation.time();
    let time = period.unwrap_or(observation.window);
    let looks = (time / observation.interval).ceil() * LOOKS_A_ROW;
    let mut done = 0.0;
    while done < looks {
        done += 1.0;
        simulation.advance_to(start + done / looks * time)?;
        states.insert(symmetry.representative(simulation.contact_states()));
    }
    Ok(Visited { symmetry, states })
}
