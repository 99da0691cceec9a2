//! The energy that enters and leaves a periodic motion in one period.

use super::Orbit;
use amontons::Error;
use amontons::integrator::Energy;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// Work and dissipation of one period, by the [energy ledger](amontons::integrator::Energy), J.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitEnergy {
    /// Energy dissipated by damping, J.
    pub damping: f64,
    /// Energy dissipated by friction, J, in impacts too.
    pub friction: f64,
    /// Energy dissipated by normal impulses of impacts, J.
    pub impact: f64,
    /// Work of the sliders on the masses, J.
    pub slider: f64,
    /// Work of external forces and of changed loads, J.
    pub forces: f64,
    /// damping + friction + impact − slider − forces, J: zero but for rounding, since the motion has the same kinetic and
    /// elastic energy after a period.
    pub residual: f64,
}

impl OrbitEnergy {
    /// The energy that an orbit takes and gives in one period, by a run of the simulation, whose present time is the
    /// beginning of the orbit. `None` if the scene does not request energy. The run goes on by up to one period before
    /// the period that is measured, so that this begins and ends far from all events.
    ///
    /// # Errors
    /// Returns an error if a step fails.
    pub fn of(orbit: &Orbit, simulation: &mut Simulation) -> Result<Option<Self>, Error> {
        simulation.go_on_from(&orbit.start().motion());
        let begin = simulation.time() + between_events(orbit);
        simulation.advance_to(begin)?;
        let Some(before) = simulation.energy() else { return Ok(None) };
        simulation.advance_to(begin + orbit.period)?;
        Ok(simulation.energy().map(|after| Self::between(&before, &after)))
    }

    fn between(before: &Energy, after: &Energy) -> Self {
        let [damping, friction, impact] = [
            after.damping - before.damping,
            after.friction - before.friction,
            after.impact - before.impact,
        ];
        let [slider, forces] = [after.slider - before.slider, after.forces - before.forces];
        let residual = (damping + friction + impact) - (slider + forces);
        Self { damping, friction, impact, slider, forces, residual }
    }
}

/// The time, s after the beginning, in the middle between the two neighbouring events that are farthest apart.
fn between_events(orbit: &Orbit) -> f64 {
    let times = orbit.events.iter().map(|event| event.time).chain([orbit.period]);
    let (mut last, mut longest, mut middle) = (0.0, 0.0, 0.0);
    for time in times {
        if time - last > longest {
            (longest, middle) = (time - last, f64::midpoint(last, time));
        }
        last = time;
    }
    middle
}
