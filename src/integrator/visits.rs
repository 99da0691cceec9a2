//! A log of the contact states that a motion goes through: how long it stays in each pattern, and how often it enters it.

use super::{
    AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Integrator, Motion, StepFailure,
};
use crate::contact::{ContactForce, ContactState};
use crate::model::Damping;
use std::collections::HashMap;

/// Largest number of patterns of a log. Contacts that share many masses can go through more than fit into memory.
pub const MOST_VISITED: usize = 10_000;

/// A pattern of contact states, one for each contact, and a motion's stays in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Visit {
    /// The state of each contact.
    pub states: Vec<ContactState>,
    /// Total time in this pattern, s.
    pub time: f64,
    /// Number of stays.
    pub entered: u64,
    /// Time from the start of the log to the first stay, s.
    pub first: f64,
}

/// The patterns of contact states that a motion has gone through since the log began.
///
/// Patterns that last no time, such as those between two events at one instant, are not visited.
#[derive(Clone, Debug, Default)]
pub struct VisitLog {
    visits: Vec<Visit>,
    /// Places of the patterns in `visits`.
    places: HashMap<Vec<ContactState>, usize>,
    /// Place of the present pattern; `None` before the first stay and in a pattern that has no place.
    present: Option<usize>,
    time: f64,
    left_out: f64,
}

impl VisitLog {
    /// The patterns in the order of their first stays.
    #[must_use]
    pub fn visits(&self) -> &[Visit] {
        &self.visits
    }

    /// Time that the log covers, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Time, s, in patterns that the log does not hold, since it held [`MOST_VISITED`] others when they were first entered.
    #[must_use]
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// Adds a time (s) in which contacts have these states.
    pub(in crate::integrator) fn stay(&mut self, states: &[ContactState], time: f64) {
        let stays = self.present.is_some_and(|place| self.visits[place].states == states);
        if !stays {
            self.present = self.places.get(states).copied();
            if self.present.is_none() && self.visits.len() < MOST_VISITED {
                self.present = Some(self.visits.len());
                self.places.insert(states.to_vec(), self.visits.len());
                let states = states.to_vec();
                self.visits.push(Visit { states, time: 0.0, entered: 0, first: self.time });
            }
        }
        match self.present {
            Some(place) => {
                let visit = &mut self.visits[place];
                visit.time += time;
                visit.entered += u64::from(!stays);
            }
            None => self.left_out += time,
        }
        self.time += time;
    }
}

/// An integrator in steps of one pattern each that logs the patterns.
pub(super) struct WithVisits {
    integrator: Box<dyn Integrator>,
    log: VisitLog,
}

impl WithVisits {
    pub(super) fn new(integrator: Box<dyn Integrator>) -> Self {
        Self { integrator, log: VisitLog::default() }
    }
}

impl Integrator for WithVisits {
    fn advance(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        for _ in 0..count {
            self.integrator.advance(motion, inputs, step, 1)?;
            self.log.stay(&motion.contacts, step);
        }
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.integrator.contact_forces(motion, inputs, forces)
    }

    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        self.integrator.respond(held, load, response)
    }

    fn multipliers(&self) -> Option<&[[f64; 2]]> {
        self.integrator.multipliers()
    }

    fn visits(&self) -> Option<&VisitLog> {
        Some(&self.log)
    }

    fn friction_work(&self) -> Option<&[f64]> {
        self.integrator.friction_work()
    }

    fn expect_waves(&mut self, count: usize) {
        self.integrator.expect_waves(count);
    }

    fn set_damping(&mut self, damping: Damping) {
        self.integrator.set_damping(damping);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactState::{Detached, Slide, Stick};
    use crate::simulation::Simulation;

    #[test]
    fn stays_in_one_pattern_are_one_visit_until_another_comes_between() {
        let mut log = VisitLog::default();
        for (states, time) in [
            ([Slide, Slide], 0.25),
            ([Slide, Slide], 0.5),
            ([Stick, Slide], 1.0),
            ([Slide; 2], 2.0),
        ] {
            log.stay(&states, time);
        }
        let [sliding, stuck] = log.visits() else { panic!("{:?}", log.visits()) };
        assert_eq!((sliding.time, sliding.entered, sliding.first), (2.75, 2, 0.0));
        assert_eq!((stuck.time, stuck.entered, stuck.first), (1.0, 1, 0.75));
        assert_eq!((log.time(), log.left_out()), (3.75, 0.0));
    }

    #[test]
    fn what_a_full_log_does_not_hold_is_counted_by_its_time() {
        let mut log = VisitLog::default();
        let pattern = |number: usize| -> Vec<ContactState> {
            (0..14).map(|bit| if number >> bit & 1 == 1 { Stick } else { Slide }).collect()
        };
        (0..MOST_VISITED + 3).for_each(|number| log.stay(&pattern(number), 1.0));
        log.stay(&[Detached; 14], 0.5);
        log.stay(&pattern(7), 1.0);
        assert_eq!(log.visits().len(), MOST_VISITED);
        assert_eq!(log.left_out(), 3.5);
        assert_eq!((log.visits()[7].time, log.visits()[7].entered), (2.0, 2));
    }

    /// On a belt with v = 0.1 m/s a mass of 1 kg on a spring of 100 N/m begins without a spring force. It sticks until the spring
    /// has the force µN = 4 N, for 0.4 s, and then slips.
    #[test]
    fn a_mass_on_a_belt_sticks_as_long_as_the_belt_needs_to_stretch_its_spring() {
        for (method, step) in [("event-driven", 1e-2), ("forward-increment", 1e-5)] {
            for energy in [true, false] {
                let text = format!(
                    "integrator = {{ method = \"{method}\", step = {step} }}\n\
                     slider = {{ velocity = 0.1, angle = 0.0 }}\nfriction = {{ coefficient = 0.4 }}\n\
                     mass = [{{ name = \"m\", mass = 1.0, force = [0.0, -10.0] }}]\n\
                     spring = [{{ name = \"k\", between = [\"m\", \"ground\"], direction = \"x\", stiffness = 100.0 }}]\n\
                     contact = [{{ name = \"belt\", mass = \"m\" }}]\n\
                     initial = [{{ mass = \"m\", x = -0.04, vx = 0.1 }}]\neffects = {{ energy = {energy} }}\n"
                );
                let scene = crate::scene::parse("belt", &text).unwrap();
                let mut plain = Simulation::new(scene.clone(), 0.0).unwrap();
                let mut simulation = Simulation::new(scene, 0.0).unwrap();
                assert!(simulation.visits().is_none());
                simulation.record_visits().unwrap();
                for time in [0.1, 0.37, 0.9] {
                    plain.advance_to(time).unwrap();
                    simulation.advance_to(time).unwrap();
                }
                assert_eq!(plain.motion(), simulation.motion());
                let log = simulation.visits().unwrap();
                let [stuck, slipping] = log.visits() else { panic!("{:?}", log.visits()) };
                assert_eq!((&stuck.states[..], &slipping.states[..]), (&[Stick][..], &[Slide][..]));
                let budget = if method == "event-driven" { 1e-12 } else { 2.0 * step };
                assert!((stuck.time - 0.4).abs() < budget, "{method}: {stuck:?}");
                assert!((slipping.time - 0.5).abs() < budget, "{method}: {slipping:?}");
                assert!((slipping.first - 0.4).abs() < budget, "{method}: {slipping:?}");
                assert_eq!((stuck.entered, slipping.entered), (1, 1));
            }
        }
    }
}
