//! Several simulations that move together, each as it would by itself.

use super::clock::Leg;
use super::{Simulation, Steps};
use crate::Error;
use crate::integrator::{RingBatch, Width};
use crate::scene::Method;

/// Simulations of scenes that differ in values alone. Where the paper's scheme meets rings they take their
/// steps in the lanes of the processor's vectors, else (as with an energy ledger) one after the other; the doubles
/// are the same.
pub struct Batch {
    simulations: Vec<Result<Simulation, Error>>,
    lanes: Option<RingBatch>,
}

impl Batch {
    /// How many simulations like this one are worth a batch.
    #[must_use]
    pub fn size(simulation: &Simulation, width: Option<Width>) -> usize {
        let lanes = width.filter(|width| rings([simulation], *width).is_some());
        lanes.map_or(1, Width::lanes)
    }

    /// A batch in vectors of this width, or one after the other.
    #[must_use]
    pub fn new(simulations: Vec<Simulation>, width: Option<Width>) -> Self {
        let alike = simulations
            .windows(2)
            .all(|two| (two[0].scene.step, two[0].clock) == (two[1].scene.step, two[1].clock));
        let lanes = width.filter(|_| alike).and_then(|width| rings(&simulations, width));
        Self { simulations: simulations.into_iter().map(Ok).collect(), lanes }
    }

    /// The simulations, in their order; one that has failed says why.
    pub fn simulations(&mut self) -> &mut [Result<Simulation, Error>] {
        &mut self.simulations
    }

    /// The simulations as they are now.
    #[must_use]
    pub fn into_simulations(self) -> Vec<Result<Simulation, Error>> {
        self.simulations
    }

    /// Moves all that have not failed on to time `target` (s), as [`Simulation::advance_to`].
    pub fn advance_to(&mut self, target: f64) {
        match &mut self.lanes {
            Some(lanes) => advance_in(lanes, &mut self.simulations, target),
            None => {
                for simulation in &mut self.simulations {
                    attempt(simulation, |simulation| simulation.advance_to(target));
                }
            }
        }
    }
}

fn rings<'a>(
    simulations: impl IntoIterator<Item = &'a Simulation>,
    width: Width,
) -> Option<RingBatch> {
    let mut models = Vec::new();
    for Simulation { scene, model, .. } in simulations {
        if scene.method != Method::ForwardIncrement || scene.effects.energy {
            return None;
        }
        models.push(model);
    }
    RingBatch::new(models, width)
}

/// Does something with a simulation that has not failed; it has if this does.
pub(crate) fn attempt<T>(
    simulation: &mut Result<Simulation, Error>,
    work: impl FnOnce(&mut Simulation) -> Result<T, Error>,
) -> Option<T> {
    match work(simulation.as_mut().ok()?) {
        Ok(result) => Some(result),
        Err(error) => {
            *simulation = Err(error);
            None
        }
    }
}

/// As [`Simulation::advance_to`], but that all take their steps together.
fn advance_in(lanes: &mut RingBatch, simulations: &mut [Result<Simulation, Error>], target: f64) {
    // All have the same clock and step, so that they go the same way.
    let mut leg: Option<Leg> = None;
    for simulation in &mut *simulations {
        leg = attempt(simulation, |simulation| simulation.leg_to(target)).or(leg);
    }
    let Some(mut leg) = leg else { return };
    loop {
        let mut fewest = None;
        for (lane, simulation) in simulations.iter_mut().enumerate() {
            let steps = attempt(simulation, |simulation| simulation.prepare(&leg)).flatten();
            if let (Some(Steps { count, .. }), Ok(simulation)) = (steps, simulation) {
                let Simulation { motion, drive, model, .. } = simulation;
                lanes.load(lane, motion, drive, model.damping);
                fewest = Some(fewest.map_or(count, |fewest: u64| fewest.min(count)));
            }
        }
        let Some(count) = fewest else { break };
        lanes.advance(leg.step, count);
        leg.take(count);
        for (lane, simulation) in simulations.iter_mut().enumerate() {
            attempt(simulation, |simulation| {
                lanes.store(lane, &mut simulation.motion);
                simulation.check_taken(&leg)
            });
        }
    }
    for simulation in simulations.iter_mut().flatten() {
        simulation.arrive(&leg);
    }
}
