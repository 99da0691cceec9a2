//! Time integration: an immutable integrator moves a mutable [`Motion`] under a [`Drive`].
//!
//! [`choose`] picks the integrator once, from the structure of the model; from then on a step
//! tests no option.

mod contact_problem;
mod dynamics;
mod event_driven;
mod forward_increment;
mod ledger;
mod method;

pub use event_driven::EventDriven;
pub(crate) use event_driven::full_places;
pub use forward_increment::{RingForwardIncrement, dense, sparse};
pub use ledger::{Energy, Ledger};
pub use method::Method;

use crate::Error;
use crate::contact::{ContactForce, ContactState, Friction};
use crate::model::{Damping, LumpedModel};
use serde::{Deserialize, Serialize};

/// Position, velocity and contact states at one instant, with what has been counted on the way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// x, m, relative to the reference position; closed contacts stand at an exact gap of zero.
    pub displacement: Vec<f64>,
    /// ẋ, m/s.
    pub velocity: Vec<f64>,
    /// The state of each contact over the last step.
    pub contacts: Vec<ContactState>,
    /// Which contacts pulled in the last step, where contacts can stick and cannot open. Their friction follows |N|, so that the
    /// same states may have forces of either sign.
    pub pulls: Vec<bool>,
    /// What has been counted since the start.
    pub statistics: Statistics,
    /// Where energy has gone; for an integrator with a ledger.
    pub ledger: Option<Ledger>,
}

impl Motion {
    /// A motion that begins at these displacements (m) and velocities (m/s) with contacts in these states. It has no ledger.
    #[must_use]
    pub fn new(displacement: Vec<f64>, velocity: Vec<f64>, contacts: Vec<ContactState>) -> Self {
        let pulls = vec![false; contacts.len()];
        let statistics = Statistics::default();
        Self { displacement, velocity, contacts, pulls, statistics, ledger: None }
    }
}

/// What an integrator counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Internal steps.
    pub steps: u64,
    /// How often contacts took each state, all contacts together, in the order of [`ContactState::ALL`]. What
    /// they start in is not counted.
    pub entered: [u64; 4],
    /// Changes from detached to any closed state; their impulses show in no contact force.
    pub touch_downs: u64,
    /// Hops after impacts that exact motion has ended before they began, since too many of the same contact came before
    /// them in one internal step. Their velocities were below 1.1e-5 of the fastest one.
    pub ended_hops: u64,
    /// Instants within steps at which the states of contacts were decided anew; none by methods that do so
    /// once a step.
    pub events: u64,
    /// Gauss–Seidel sweeps over the contacts.
    pub sweeps: u64,
    /// The most sweeps that one solution of the contacts took.
    pub most_sweeps: u64,
    /// How often, counted by steps (by series of exact motion) and contacts, a mass slipped against the
    /// direction that friction keeps without sticking.
    pub reversed_slips: u64,
    /// How often a contact had to pull that cannot open.
    pub pulled_contacts: u64,
    /// How often, when a run began or contacts changed their states, the law of contact had another solution than the one
    /// that was taken, with another motion. Only contacts are looked at of which up to four share masses.
    pub other_solutions: u64,
}

impl Statistics {
    /// Are all counts such as a run may come to, with room to go on?
    pub(crate) fn are_countable(&self) -> bool {
        const MOST: u64 = 1 << 60;
        let Self { steps, entered, touch_downs, ended_hops, events, sweeps, .. } = *self;
        let Self { most_sweeps, reversed_slips, pulled_contacts, other_solutions, .. } = *self;
        let of_contacts =
            [touch_downs, ended_hops, reversed_slips, pulled_contacts, other_solutions];
        let others = [steps, events, sweeps, most_sweeps].into_iter().chain(of_contacts);
        entered.into_iter().chain(others).all(|count| count <= MOST)
    }

    /// Changes of state, summed over the contacts.
    #[must_use]
    pub fn state_changes(&self) -> u64 {
        self.entered.iter().sum()
    }

    /// Counts a contact that goes from one state into another.
    #[inline(always)]
    pub(crate) fn count_change(&mut self, state: ContactState) {
        self.entered[state as usize - 1] += 1;
    }

    /// Counts the sweeps of one solution of the contacts.
    pub(crate) fn count_sweeps(&mut self, sweeps: u64) {
        self.sweeps += sweeps;
        self.most_sweeps = self.most_sweeps.max(sweeps);
    }
}

/// What drives a motion over a step, or over several that are alike.
///
/// The forward increment scheme takes the forces at the beginning and the velocities at the end of a
/// step; the event-driven integrator lets both change linearly, and as waves do.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// All forces but those of springs, dampers and contacts, N, at the beginning; one value a degree of
    /// freedom.
    pub force: Vec<f64>,
    /// How fast they change, waves apart, N/s.
    pub force_rate: Vec<f64>,
    /// Slider velocity v along the tangent, m/s, at the end; one value a contact.
    pub slider_velocity: Vec<f64>,
    /// v̇ of the straight line over the step, m/s²; one value a contact.
    pub slider_acceleration: Vec<f64>,
    /// Friction coefficients; one pair a contact.
    pub friction: Vec<Friction>,
    /// What of forces and slider velocities oscillates, and how: in exact motion they follow it between the values
    /// above, which count it.
    pub waves: Vec<Wave>,
}

/// amplitude · sin(pulsation · t + phase), t from the beginning of a step on: a part of what drives a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Half peak to peak; zero while it rests.
    pub amplitude: f64,
    /// 2π times the frequency, rad/s.
    pub pulsation: f64,
    /// At the beginning of the step, rad.
    pub phase: f64,
    /// The degrees of freedom that it pushes, each with the force that it is for each unit of the wave, N.
    pub pushes: Vec<(usize, f64)>,
    /// The contacts whose sliders move with it (m/s), in ascending order.
    pub moves: Vec<usize>,
}

impl Wave {
    /// The phase at time `t` (s) after the beginning of the step, rad.
    #[must_use]
    pub fn phase_after(&self, t: f64) -> f64 {
        self.phase + self.pulsation * t
    }

    /// The value at that time.
    #[must_use]
    pub fn after(&self, t: f64) -> f64 {
        self.amplitude * libm::sin(self.phase_after(t))
    }

    /// How fast it changes at that time, per second.
    #[must_use]
    pub fn rate_after(&self, t: f64) -> f64 {
        self.amplitude * self.pulsation * libm::cos(self.phase_after(t))
    }
}

impl Drive {
    /// A drive with these forces (N, one a degree of freedom) and the same v (m/s) and friction for as
    /// many contacts.
    #[must_use]
    pub fn uniform(
        force: Vec<f64>,
        contacts: usize,
        slider_velocity: f64,
        friction: impl Into<Friction>,
    ) -> Self {
        Self {
            force_rate: vec![0.0; force.len()],
            force,
            slider_velocity: vec![slider_velocity; contacts],
            slider_acceleration: vec![0.0; contacts],
            friction: vec![friction.into(); contacts],
            waves: Vec::new(),
        }
    }
}

/// Contacts that keep their states: those that are closed do not open, those that stick do not slip, and those
/// that slide have T = slope · N.
#[derive(Clone, Copy, Debug)]
pub struct Kept<'a> {
    /// The state of each contact.
    pub states: &'a [ContactState],
    /// ±µ of each contact that slides; of no meaning in the other states.
    pub slopes: &'a [f64],
}

/// What acts on the masses, contacts apart.
#[derive(Clone, Copy, Debug)]
pub struct Push<'a> {
    /// F − C ẋ − K x, N; one value a degree of freedom.
    pub force: &'a [f64],
    /// v̇ of the sliders, m/s², which stuck contacts follow; one value a contact.
    pub slider_acceleration: &'a [f64],
}

/// What comes of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// (N, T) of each contact, N.
    pub forces: Vec<[f64; 2]>,
    /// ẍ, m/s²; one value a degree of freedom.
    pub acceleration: Vec<f64>,
}

impl Response {
    /// Room for the response of as many contacts and degrees of freedom.
    #[must_use]
    pub fn new(contacts: usize, dofs: usize) -> Self {
        Self { forces: vec![[0.0; 2]; contacts], acceleration: vec![0.0; dofs] }
    }
}

/// A step that could not be taken; the motion is then not to be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepFailure {
    /// Gauss–Seidel over the contacts did not converge in this many sweeps.
    NoConvergence {
        /// Sweeps taken.
        sweeps: u64,
        /// The contact, from 0, whose force changed most in the last of them.
        contact: usize,
        /// By how much, in parts of the largest force; infinite where it left the range of numbers.
        change: f64,
        /// What would have been enough.
        tolerance: f64,
    },
    /// What acts on this contact (from 0) is no finite number.
    NotFinite {
        /// The contact, from 0.
        contact: usize,
    },
    /// One step has more oscillations, of the structure or of what drives it, than exact motion follows.
    TooManySeries {
        /// The most power series that a step may take.
        most: u64,
    },
    /// This contact (from 0) changed its state again and again at one instant.
    TooManyEvents {
        /// The contact, from 0.
        contact: usize,
    },
    /// Friction wedges this contact (from 0): no force satisfies its law (Painlevé).
    Wedged {
        /// The contact, from 0.
        contact: usize,
    },
    /// The equations of the contacts that share masses with this one (from 0) are singular but for rounding, and no other states
    /// have forces: friction wedges these contacts, or nearly.
    Singular {
        /// The contact, from 0.
        contact: usize,
    },
    /// No force was found that satisfies the law of this contact (from 0). It shares masses with so many others that not all
    /// their states are tried, so there may be one.
    NoneFound {
        /// The contact, from 0.
        contact: usize,
    },
}

/// Moves a motion forward. Implementations allocate when they are made, never in a step.
pub trait Integrator: Send {
    /// Takes `count` steps of length `step` (s).
    ///
    /// # Errors
    /// Says which contact could not be solved; the motion is then half-way.
    fn advance(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure>;

    /// The contact forces at the present instant, from position, velocity and drive alone.
    ///
    /// # Errors
    /// The contact whose forces were not found.
    fn contact_forces(
        &mut self,
        motion: &Motion,
        drive: &Drive,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure>;

    /// What a push does to contacts that keep their states. It is linear: forces give contact forces and
    /// accelerations, changes of forces give their changes, and rates their rates.
    ///
    /// # Errors
    /// The contact whose forces were not found.
    fn respond(
        &mut self,
        kept: Kept<'_>,
        push: Push<'_>,
        response: &mut Response,
    ) -> Result<(), StepFailure>;

    /// (N, T) of each contact over the last step, N; `None` where the method has no such forces, or each contact
    /// lies along degrees of freedom of its own, whose momentum gives them.
    fn multipliers(&self) -> Option<&[[f64; 2]]> {
        None
    }

    /// Makes room for as many waves of a drive, before the first step that has them.
    fn expect_waves(&mut self, _count: usize) {}

    /// Takes over another damping.
    fn set_damping(&mut self, damping: Damping);
}

/// The loop over steps of the paper's scheme, compiled for one structure and what acts on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kernel {
    /// The structure whose forces it evaluates.
    pub structure: &'static str,
    /// What its arithmetic is made for.
    pub arithmetic: String,
}

/// All kernels that [`choose`] chooses from.
#[must_use]
pub fn kernels() -> Vec<Kernel> {
    forward_increment::kernels()
}

/// The fastest integrator of this method that fits the structure of the model.
///
/// # Errors
/// A mass matrix that is not positive definite; more contacts that share masses than the method takes.
pub fn choose(model: &LumpedModel, method: Method) -> Result<Box<dyn Integrator>, Error> {
    if method == Method::EventDriven {
        return Ok(Box::new(EventDriven::new(model)?));
    }
    if let Some(ring) = RingForwardIncrement::new(model) {
        return Ok(Box::new(ring));
    }
    forward_increment::faster(model)
}

/// The fastest integrator of this method that fits the structure of the model and writes the energy ledger of its motion, step
/// by step. A motion without a ledger is moved alone.
///
/// # Errors
/// A mass matrix that is not positive definite; more contacts that share masses than the method takes.
pub fn choose_with_ledger(
    model: &LumpedModel,
    method: Method,
) -> Result<Box<dyn Integrator>, Error> {
    use forward_increment::WithLedger;
    if method == Method::EventDriven {
        return Ok(Box::new(EventDriven::with_witness(model, event_driven::Writer::new(model))?));
    }
    Ok(Box::new(WithLedger::new(choose(model, method)?, model)))
}
