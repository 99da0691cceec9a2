//! Periodic motions of a scene, solved for themselves: stable or not, with their Floquet multipliers.
//!
//! | file | contents |
//! | --- | --- |
//! | `matrix` | products and exponentials of small dense matrices |
//! | `flow` | the flow of a scene: states, inputs, runs with their events |
//! | `equations` | the linear equation of each set of contact states, the functions and maps of events |
//! | `field` | that equation linearised at a state, its motions as power series, and their fundamental matrices |
//! | `chain` | a periodic motion as a chain of segments; Newton's method on it |
//! | `check` | the chain held against the event-driven integrator, segment by segment |
//! | `multipliers` | monodromy matrix, rank, multipliers |
//! | `extremes` | turning points |
//! | `energy` | work and dissipation of one period |
//! | `branch` | a branch of periodic motions over a parameter, its special points and ends |
//! | `corrector` | one point of a branch from another, by pseudo-arclength |
//! | `follow` | a branch from point to point: special points, changes of the sequence of events |
//! | `signals` | the signals under which motions are periodic |
//! | `search` | from a motion that nearly comes back to a periodic one |
//!
//! An orbit begins as a run of the event-driven integrator over one period, which finds the sequence of events. Newton's
//! method closes the chain of its segments. The integrator then runs each segment again from its beginning: only a chain
//! whose events it confirms, all and no others, is an orbit; any other sequence that it finds is solved in its place.

mod branch;
mod chain;
mod check;
mod corrector;
mod energy;
mod equations;
mod extremes;
mod field;
mod flow;
mod follow;
mod matrix;
mod multipliers;
mod search;
mod signals;

pub use branch::{Branch, BranchEnd, BranchPoint, Continued, FlowAt, SpecialKind, SpecialPoint};
pub use chain::{Chain, Linear, Segment, Unsolved};
pub use energy::OrbitEnergy;
pub use field::Field;
pub use flow::{Flow, Instant, Stage, check_method};
pub use follow::branch;
pub use multipliers::{Multipliers, multipliers};
pub use search::{NoOrbit, Start, search};
pub use signals::check_signals;

use amontons::Error;
use amontons::contact::ContactState;
use amontons::integrator::{Event, Motion};
use amontons::scene::{Method, Scene, Selection, Structure};
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Multipliers are known to about this part.
const KNOWN: f64 = 1e-9;
/// Internal steps of a run over one period.
const RETURN_STEPS: u32 = 100;

/// A periodic motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// The period, s.
    pub period: f64,
    /// Displacements (m) at its beginning, one for each degree of freedom.
    pub displacement: Vec<f64>,
    /// Velocities (m/s) at its beginning.
    pub velocity: Vec<f64>,
    /// The states of the contacts at its beginning.
    pub states: Vec<ContactState>,
    /// The instants at which contacts change their states, by time.
    pub events: Vec<OrbitEvent>,
    /// Half of the difference between the largest and the smallest displacement of each degree of freedom, m, at the
    /// exact turning points.
    pub extents: Vec<f64>,
    /// Floquet multipliers (real and imaginary part) that are not zero by rank, the largest first. The multiplier 1 of
    /// the direction along a motion without a drive is left out.
    pub multipliers: Vec<[f64; 2]>,
    /// The multiplier of the direction along the motion, exactly 1 but for rounding; `None` under a drive.
    pub along: Option<f64>,
    /// Number of further multipliers, which are exactly zero: directions that contacts hold at one instant.
    pub zeros: usize,
    /// `true` if several events at one instant have no derivative together, since their order matters: the multipliers are
    /// those of motions in which they stay together.
    pub ambiguous: bool,
    /// The largest difference between the end of a segment by the event-driven integrator and the beginning of the
    /// next, in parts of the motion's size.
    pub defect: f64,
    /// The difference of the state after a whole period by the event-driven integrator, in the same parts. Rounding
    /// grows by the largest multiplier on the way.
    pub closure: f64,
    /// `true` if sines drive the motion.
    pub driven: bool,
    /// Work and dissipation of one period; `None` if the scene does not request energy, and on branches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<OrbitEnergy>,
}

/// A motion that comes back after a period, or nearly: what a search or a run begins with. The file of an [`Orbit`] can be
/// read as one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitStart {
    /// The period, s.
    pub period: f64,
    /// Displacements (m) at its beginning, one for each degree of freedom.
    pub displacement: Vec<f64>,
    /// Velocities (m/s) at its beginning.
    pub velocity: Vec<f64>,
    /// The states of the contacts at its beginning.
    pub states: Vec<ContactState>,
}

impl OrbitStart {
    /// Refuses a motion that cannot be one of the scene.
    ///
    /// # Errors
    /// Returns an error if it has another number of displacements, velocities or contacts, or impossible numbers.
    pub fn check(&self, scene: &Scene) -> Result<(), Error> {
        let counts = [
            ("displacements", self.displacement.len(), scene.dof_names().len()),
            ("velocities", self.velocity.len(), scene.dof_names().len()),
            ("contacts", self.states.len(), scene.contact_count()),
        ];
        for (what, has, needs) in counts {
            if has != needs {
                return Err(Error::argument(format!(
                    "the orbit has {has} {what}, but {} has {needs}: it belongs to another scene",
                    scene.name
                )));
            }
        }
        let mut numbers = self.displacement.iter().chain(&self.velocity);
        let is_possible = self.period > 0.0
            && self.period.is_finite()
            && numbers.all(|number| number.is_finite());
        is_possible
            .then_some(())
            .ok_or_else(|| Error::argument("the orbit has numbers that no orbit has"))
    }
}

/// A change of contact states in a periodic motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrbitEvent {
    /// Time since the beginning of the orbit, s.
    pub time: f64,
    /// The contacts (from 0) with an event.
    pub events: Vec<(usize, Event)>,
    /// The states that follow.
    pub states: Vec<ContactState>,
}

impl Orbit {
    /// `true` if small disturbances die out, `false` if one grows; `None` where a multiplier has magnitude 1 but for
    /// rounding, or events at one instant have no derivative together.
    #[must_use]
    pub fn is_stable(&self) -> Option<bool> {
        // The multiplier along the motion shows how well the others are known.
        let is_known = self.along.is_none_or(|along| (along - 1.0).abs() < 1e-6);
        if !is_known || self.multipliers.iter().flatten().any(|part| !part.is_finite()) {
            return None;
        }
        let largest = self.largest_multiplier();
        if largest > 1.0 + KNOWN {
            Some(false)
        } else if largest < 1.0 - KNOWN && !self.ambiguous {
            Some(true)
        } else {
            None
        }
    }

    /// Its beginning and its period.
    #[must_use]
    pub fn start(&self) -> OrbitStart {
        let Self { period, displacement, velocity, states, .. } = self.clone();
        OrbitStart { period, displacement, velocity, states }
    }

    /// The largest magnitude of a multiplier, 0 where all are zero.
    #[must_use]
    pub fn largest_multiplier(&self) -> f64 {
        self.multipliers.iter().map(|[re, im]| libm::hypot(*re, *im)).fold(0.0, f64::max)
    }
}

impl OrbitStart {
    /// The motion at its beginning.
    #[must_use]
    pub fn motion(&self) -> Motion {
        let Self { displacement, velocity, states, .. } = self.clone();
        Motion::new(displacement, velocity, states)
    }

    /// Gives the scene the initial values with which its run begins there; the scene has the values with which the motion
    /// was found. Contact states follow from them, as at the start of every run.
    ///
    /// # Errors
    /// Returns an error if the scene cannot have these initial values.
    pub fn give_start(&self, scene: &mut Scene) -> Result<(), Error> {
        let mut values = self.displacement.iter().copied().zip(self.velocity.iter().copied());
        let mut start = |displacement: &mut f64, velocity: &mut f64| {
            if let Some(value) = values.next() {
                (*displacement, *velocity) = value;
            }
        };
        match &mut scene.structure {
            Structure::Ring(modules) => {
                for module in modules {
                    let places = module.displacement.iter_mut().zip(&mut module.velocity);
                    places.for_each(|(x, v)| start(x, v));
                }
            }
            Structure::Network(network) => {
                for mass in &mut network.masses {
                    let places = mass.displacement.iter_mut().zip(&mut mass.velocity);
                    let free = places.zip(mass.locked).filter(|(_, locked)| !locked);
                    free.for_each(|((x, v), _)| start(x, v));
                }
                for one in &mut network.superelements {
                    let places = one.displacement.iter_mut().zip(&mut one.velocity);
                    places.for_each(|(x, v)| start(x, v));
                }
            }
        }
        scene.check()
    }

    /// Runs the scene from its initial values over one period, event-driven, from time 0 on. Returns the difference from
    /// the beginning after it, in parts of the motion's size, and whether it is as small as for an orbit.
    ///
    /// # Errors
    /// Returns an error if the run fails.
    pub fn comes_back(&self, scene: &Scene) -> Result<(f64, bool), Error> {
        // Just behind the events that may end a period.
        let end = self.period * (1.0 + check::NEAR);
        let (method, selection) = (Method::EventDriven, Selection::Given);
        let step = end / f64::from(RETURN_STEPS);
        let scene = Scene { method, step, selection, ..scene.clone() };
        let mut simulation = Simulation::new(scene, 0.0)?;
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.displacement.len()];
        for i in 1..=RETURN_STEPS {
            simulation.advance_to(end * (f64::from(i) / f64::from(RETURN_STEPS)))?;
            for (range, x) in ranges.iter_mut().zip(simulation.displacement()) {
                *range = [range[0].min(*x), range[1].max(*x)];
            }
        }
        let size =
            ranges.iter().fold(0.0, |size: f64, [least, most]| size.max(0.5 * (most - least)));
        let off = self.distance(simulation.motion(), size);
        Ok((off, off <= check::SAME))
    }

    /// The difference of a motion from its beginning, in parts of the motion's size: the largest half range of a
    /// displacement, m.
    #[must_use]
    pub fn distance(&self, motion: &Motion, size: f64) -> f64 {
        let difference = |a: &[f64], b: &[f64], unit: f64| {
            a.iter().zip(b).map(|(a, b)| (a - b).abs() / unit).fold(0.0, f64::max)
        };
        let place = difference(&motion.displacement, &self.displacement, size);
        place.max(difference(&motion.velocity, &self.velocity, size * TAU / self.period))
    }
}
