//! Monitor of the stability of the present contact state.

use super::Simulation;
use crate::Error;
use crate::contact::ContactState;
use crate::model::{Damping, LinearModel, SlidingFriction, SparseMatrix};
use crate::stability::Spectrum;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Largest number of contact states that are remembered; a long ring may visit any number.
const MOST_KNOWN: usize = 4096;

/// Stability of a contact state: the growth of a small disturbance while the contacts keep their states.
///
/// All values are zero if the contacts constrain every motion, so that a disturbance neither grows nor decays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StabilityIndicator {
    /// Largest real part of all eigenvalues, 1/s: positive if a disturbance grows.
    pub(super) growth_rate: f64,
    /// Frequency of the mode with this growth rate, Hz; 0 if it does not oscillate.
    pub(super) frequency: f64,
    /// Number of modes: oscillating pairs, and real eigenvalues. −1 if the eigenvalues do not exist, so that the
    /// stability is unknown: friction wedges the contacts, or their states contradict each other.
    pub(super) modes: i32,
}

impl StabilityIndicator {
    fn of(model: LinearModel<'_>, states: &[ContactState]) -> Self {
        let unknown = Self { modes: -1, ..Self::default() };
        let Ok(spectrum) = Spectrum::of(model, states) else { return unknown };
        let Some(fastest) = spectrum.fastest_growing() else {
            let is_held = model.reduced(states).is_some();
            return if is_held { Self::default() } else { unknown };
        };
        let modes = spectrum.oscillating.len() + spectrum.real.len();
        Self {
            growth_rate: fastest.re,
            frequency: fastest.im / TAU,
            modes: i32::try_from(modes).unwrap_or(i32::MAX),
        }
    }
}

/// Stability indicators of the contact states that were visited, each computed once. They are computed when they are
/// read, and do not affect the motion.
#[derive(Default)]
pub(super) struct StabilityMonitor {
    /// Friction of each contact: the indicators also depend on it and on the damping, which may change during a run.
    friction: Vec<SlidingFriction>,
    damping: Damping,
    dampers: Option<SparseMatrix>,
    known: HashMap<Box<[ContactState]>, StabilityIndicator>,
    /// The present contact states.
    states: Vec<ContactState>,
}

impl StabilityMonitor {
    /// Discards the indicators if friction or damping has changed.
    fn keep_up(&mut self, linear: LinearModel<'_>) {
        let model = linear.model();
        let is_same = self.friction.iter().copied().eq(linear.friction())
            && self.damping == model.damping
            && self.dampers.as_ref() == Some(&model.dampers);
        if !is_same {
            self.known.clear();
            self.friction.clear();
            self.friction.extend(linear.friction());
            self.damping = model.damping;
            self.dampers = Some(model.dampers.clone());
        }
    }

    /// The indicator of these contact states.
    fn indicator(
        &mut self,
        model: LinearModel<'_>,
        states: impl Iterator<Item = ContactState>,
    ) -> StabilityIndicator {
        self.keep_up(model);
        self.states.clear();
        self.states.extend(states);
        if let Some(&known) = self.known.get(&*self.states) {
            return known;
        }
        let found = StabilityIndicator::of(model, &self.states);
        if self.known.len() >= MOST_KNOWN {
            self.known.clear();
        }
        self.known.insert(self.states.clone().into(), found);
        found
    }
}

impl Simulation {
    /// The stability indicator of the present contact states with the present friction and damping; zero in a scene
    /// that does not request stability. It allocates memory if these states are new.
    ///
    /// # Errors
    /// Returns an error if the contact forces have no solution.
    pub(super) fn stability_indicator(&mut self) -> Result<StabilityIndicator, Error> {
        self.contact_forces()?;
        let Some(monitor) = &mut self.monitor else { return Ok(StabilityIndicator::default()) };
        let states = self.contact_forces.iter().map(|force| force.state);
        Ok(monitor.indicator(self.model.linear_about(&self.reference.equilibrium), states))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactLaw;
    use crate::contact::ContactState::{Detached, ReverseSlide, Slide, Stick};
    use crate::model::{Contact, Direction, LumpedModel};

    /// A mass of two degrees of freedom with M = [[1, a], [a, 1]], K = 4 along each, and contacts along the
    /// first with the second as their normal.
    fn mass(a: f64, contacts: usize, friction: f64) -> LumpedModel {
        let contact = Contact {
            normal: Direction::unit(1),
            tangent: Direction::unit(0),
            transverse: None,
            gap: 0.0,
            friction: friction.into(),
            surface_velocity: 1.0,
        };
        let entries = vec![(0, 0, 1.0), (0, 1, a), (1, 0, a), (1, 1, 1.0)];
        LumpedModel {
            mass: SparseMatrix::from_entries(2, entries),
            stiffness: SparseMatrix::diagonal(&[4.0, 4.0]),
            damping: Damping::default(),
            dampers: SparseMatrix::zero(2),
            load: vec![0.0; 2],
            contacts: vec![contact; contacts],
            law: ContactLaw::default(),
        }
    }

    #[test]
    fn states_without_eigenvalues_are_told_from_those_that_hold_everything() {
        let unknown = StabilityIndicator { modes: -1, ..StabilityIndicator::default() };
        let two = mass(0.0, 2, 0.5);
        let two = two.linear().unwrap();
        assert_eq!(StabilityIndicator::of(two, &[Slide, ReverseSlide]), unknown);
        assert_eq!(StabilityIndicator::of(two, &[Stick, Stick]), StabilityIndicator::default());
        assert_eq!(StabilityIndicator::of(two, &[Slide, Slide]).modes, 1);
        // M̃ = 1 ± µ a: with one sign friction wedges the mass, with the other it doubles the mass.
        let coupled = mass(0.5, 1, 2.0);
        let coupled = coupled.linear().unwrap();
        let ways = [Slide, ReverseSlide].map(|state| StabilityIndicator::of(coupled, &[state]));
        assert!(ways.contains(&unknown), "{ways:?}");
        let free = ways.into_iter().find(|way| *way != unknown).unwrap();
        assert!((TAU * free.frequency - 2.0_f64.sqrt()).abs() < 1e-12 && free.modes == 1);
        assert_eq!(StabilityIndicator::of(coupled, &[Detached]).modes, 2);
    }

    #[test]
    fn a_state_is_solved_once_until_friction_or_damping_is_another() {
        let (mut monitor, mut model) = (StabilityMonitor::default(), mass(0.0, 1, 0.5));
        let mut look = |model: &LumpedModel, state: ContactState| {
            monitor.indicator(model.linear().unwrap(), std::iter::once(state));
            monitor.known.len()
        };
        assert_eq!([Slide, Stick, Slide].map(|state| look(&model, state)), [1, 2, 2]);
        model = model.with_friction(0.6);
        assert_eq!(look(&model, Slide), 1);
        assert_eq!(look(&model, Stick), 2);
        model.damping.beta = 1e-3;
        assert_eq!(look(&model, Stick), 1);
        assert_eq!(look(&model, Slide), 2);
        model.dampers = SparseMatrix::diagonal(&[1.0, 0.0]);
        assert_eq!(look(&model, Slide), 1);
    }
}
