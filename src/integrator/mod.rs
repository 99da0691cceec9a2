//! Time integration: an immutable integrator moves a mutable [`Motion`] under [`Inputs`].
//!
//! [`choose`] picks the integrator once, from the structure of the model; the steps then test no option.

mod contact_problem;
mod dynamics;
mod event_driven;
mod forward_increment;
mod ledger;
mod method;
mod per_mass;
mod visits;

pub(crate) use event_driven::full_places;
pub use event_driven::{Event, EventDriven, EventRecord, EventRecorder};
pub use forward_increment::{RingForwardIncrement, dense, sparse};
pub use ledger::{Energy, Ledger};
pub use method::Method;
pub use visits::{MOST_VISITED, Visit, VisitLog};

use crate::Error;
use crate::contact::{ContactForce, ContactState, Friction};
use crate::model::{Damping, LumpedModel};
use serde::{Deserialize, Serialize};

/// Position, velocity and contact states of a model at one instant, with the counts of the motion so far.
///
/// ```
/// use amontons::contact::ContactState::Stick;
/// use amontons::integrator::Motion;
///
/// let motion = Motion::new(vec![1e-3, 0.0], vec![0.0, 0.0], vec![Stick]);
/// assert_eq!(motion.statistics.state_changes(), 0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Displacement x, m, relative to the reference position; closed contacts have a gap g + G_N x of exactly zero.
    pub displacement: Vec<f64>,
    /// Velocity ẋ, m/s.
    pub velocity: Vec<f64>,
    /// The state of each contact over the last step.
    pub contacts: Vec<ContactState>,
    /// `true` for each contact that pulled in the last step, if contacts can stick and cannot open. Their friction
    /// follows |N|, so the same states may have forces of either sign.
    pub pulls: Vec<bool>,
    /// Counts since the start of the motion.
    pub statistics: Statistics,
    /// Energy ledger of the motion; `None` if the integrator writes none.
    pub ledger: Option<Ledger>,
}

impl Motion {
    /// A motion that begins at these displacements (m) and velocities (m/s) with contacts in these states. It has no
    /// ledger.
    #[must_use]
    pub fn new(displacement: Vec<f64>, velocity: Vec<f64>, contacts: Vec<ContactState>) -> Self {
        let pulls = vec![false; contacts.len()];
        let statistics = Statistics::default();
        Self { displacement, velocity, contacts, pulls, statistics, ledger: None }
    }
}

/// Counts of an integrator since the start of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Number of internal steps.
    pub steps: u64,
    /// Number of times that contacts entered each state, summed over the contacts, in the order of
    /// [`ContactState::ALL`]. The initial states are not counted.
    pub entered: [u64; 4],
    /// Number of changes from detached to any closed state; no contact force contains their impulses.
    pub touch_downs: u64,
    /// Number of hops after impacts that the event-driven method has ended before they began, since too many landings
    /// of the same contact, or of a large group that shares masses, came before them in one internal step. Their velocities were below 1.1e-5 of the fastest
    /// one.
    pub ended_hops: u64,
    /// Number of instants within steps at which the states of contacts were decided anew; zero for methods that decide
    /// them once for each step.
    pub events: u64,
    /// Number of Gauss–Seidel iterations over the contacts.
    pub sweeps: u64,
    /// Largest number of Gauss–Seidel iterations that one solution of the contacts took.
    pub most_sweeps: u64,
    /// Number of steps (series in event-driven motion), summed over the contacts, in which a mass slipped against the
    /// direction that friction keeps without sticking.
    pub reversed_slips: u64,
    /// Number of times that a contact which cannot open had to pull.
    pub pulled_contacts: u64,
    /// Number of times that the law of contact had a second solution with another motion when a run began or contacts
    /// changed their states. Only contacts that can open, and of which up to four share masses, are examined.
    pub other_solutions: u64,
}

impl Statistics {
    /// `true` if all counts are small enough for a run to go on counting.
    pub(crate) fn are_countable(&self) -> bool {
        const MOST: u64 = 1 << 60;
        let Self { steps, entered, touch_downs, ended_hops, events, sweeps, .. } = *self;
        let Self { most_sweeps, reversed_slips, pulled_contacts, other_solutions, .. } = *self;
        let of_contacts =
            [touch_downs, ended_hops, reversed_slips, pulled_contacts, other_solutions];
        let others = [steps, events, sweeps, most_sweeps].into_iter().chain(of_contacts);
        entered.into_iter().chain(others).all(|count| count <= MOST)
    }

    /// Number of changes of contact state, summed over the contacts.
    #[must_use]
    pub fn state_changes(&self) -> u64 {
        self.entered.iter().sum()
    }

    /// Counts a change of a contact into `state`.
    #[inline(always)]
    pub(crate) fn count_change(&mut self, state: ContactState) {
        self.entered[state as usize - 1] += 1;
    }

    /// Counts the Gauss–Seidel iterations of one solution of the contacts.
    pub(crate) fn count_sweeps(&mut self, sweeps: u64) {
        self.sweeps += sweeps;
        self.most_sweeps = self.most_sweeps.max(sweeps);
    }
}

/// The inputs of a motion over a step, or over several equal steps: forces, slider velocities and friction.
///
/// The forward increment scheme takes forces and friction at the beginning and velocities at the end of a step; the
/// event-driven integrator lets all change linearly, plus the waves.
///
/// ```
/// use amontons::integrator::Inputs;
///
/// // Two degrees of freedom without forces, one contact with v = 0.1 m/s and µ = 0.4.
/// let inputs = Inputs::uniform(vec![0.0; 2], 1, 0.1, 0.4);
/// assert_eq!(inputs.friction[0].kinetic, 0.4);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    /// All forces but those of springs, dampers and contacts, N, at the beginning; one value for each degree of
    /// freedom.
    pub force: Vec<f64>,
    /// Rates of these forces without the waves, N/s; one value for each degree of freedom.
    pub force_rate: Vec<f64>,
    /// Slider velocity v along the tangent, m/s, at the end; one value for each contact.
    pub slider_velocity: Vec<f64>,
    /// Mean slider acceleration v̇ over the step, m/s²; one value for each contact.
    pub slider_acceleration: Vec<f64>,
    /// Friction coefficients at the beginning; one item for each contact.
    pub friction: Vec<Friction>,
    /// Rates of µ_k and µ_s without the waves, 1/s; one item for each contact.
    pub friction_rate: Vec<[f64; 2]>,
    /// The oscillating parts of forces, slider velocities and friction coefficients. The values above include them at
    /// their instants; event-driven motion also follows them in between.
    pub waves: Vec<Wave>,
}

/// A harmonic part of the inputs of a motion: amplitude · sin(pulsation · t + phase), with t from the beginning of a
/// step.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Amplitude, half peak to peak; zero while the wave rests.
    pub amplitude: f64,
    /// Angular frequency, 2π times the frequency, rad/s.
    pub pulsation: f64,
    /// Phase at the beginning of the step, rad.
    pub phase: f64,
    /// The degrees of freedom on which the wave acts, each with the force for one unit of the wave, N.
    pub pushes: Vec<(usize, f64)>,
    /// The contacts whose slider velocities (m/s) include the wave, in ascending order.
    pub moves: Vec<usize>,
    /// The contacts whose friction coefficients include the wave, in ascending order, each with the parts of the wave in µ_k and µ_s.
    pub friction: Vec<(usize, [f64; 2])>,
}

impl Wave {
    /// The phase at time `t` (s) after the beginning of the step, rad.
    #[must_use]
    pub fn phase_after(&self, t: f64) -> f64 {
        self.phase + self.pulsation * t
    }

    /// The value at time `t` (s) after the beginning of the step.
    #[must_use]
    pub fn after(&self, t: f64) -> f64 {
        self.amplitude * libm::sin(self.phase_after(t))
    }

    /// The time derivative at time `t` (s) after the beginning of the step, per second.
    #[must_use]
    pub fn rate_after(&self, t: f64) -> f64 {
        self.amplitude * self.pulsation * libm::cos(self.phase_after(t))
    }
}

impl Inputs {
    /// A drive with these forces (N, one for each degree of freedom), and the same v (m/s) and friction for each of
    /// `contacts` contacts.
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
            friction_rate: vec![[0.0; 2]; contacts],
            waves: Vec::new(),
        }
    }
}

/// Contacts that keep their states: those that are closed do not open, those that stick do not slip, and those
/// that slide have T = slope · N.
#[derive(Clone, Copy, Debug)]
pub struct HeldStates<'a> {
    /// The state of each contact.
    pub states: &'a [ContactState],
    /// ±µ of each contact that slides; ignored in the other states.
    pub slopes: &'a [f64],
}

/// The actions on the masses, contacts apart.
#[derive(Clone, Copy, Debug)]
pub struct AppliedLoad<'a> {
    /// F − C ẋ − K x, N; one value for each degree of freedom.
    pub force: &'a [f64],
    /// Slider accelerations v̇, m/s², which stuck contacts follow; one value for each contact.
    pub slider_acceleration: &'a [f64],
}

/// Contact forces and accelerations that an [`AppliedLoad`] causes.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstrainedResponse {
    /// Forces (N, T) of each contact, N.
    pub forces: Vec<[f64; 2]>,
    /// Acceleration ẍ, m/s²; one value for each degree of freedom.
    pub acceleration: Vec<f64>,
}

impl ConstrainedResponse {
    /// A response of zeros for this number of contacts and degrees of freedom.
    #[must_use]
    pub fn new(contacts: usize, dofs: usize) -> Self {
        Self { forces: vec![[0.0; 2]; contacts], acceleration: vec![0.0; dofs] }
    }
}

/// The reason why a step could not be taken; the motion is then not to be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepFailure {
    /// Gauss–Seidel over the contacts did not converge in this number of iterations.
    NoConvergence {
        /// Number of iterations.
        sweeps: u64,
        /// The contact, from 0, whose force changed most in the last iteration.
        contact: usize,
        /// Change of that force relative to the largest force; infinite where it left the range of numbers.
        change: f64,
        /// The tolerance that the change had to reach.
        tolerance: f64,
    },
    /// The forces on this contact (from 0) are not finite.
    NotFinite {
        /// The contact, from 0.
        contact: usize,
    },
    /// The friction coefficient of a contact falls below zero.
    NegativeFriction {
        /// The contact, from 0.
        contact: usize,
        /// Time since the beginning of the step, s.
        after: f64,
    },
    /// The static friction coefficient of a contact falls below the kinetic one.
    WeakStaticFriction {
        /// The contact, from 0.
        contact: usize,
        /// Time since the beginning of the step, s.
        after: f64,
        /// Both coefficients then.
        coefficient: f64,
    },
    /// One step has more oscillations, of the structure or of its inputs, than the event-driven method follows.
    TooManySeries {
        /// Largest number of power series in a step.
        most: u64,
    },
    /// Contacts changed their states at one instant more often than the event-driven method follows; this contact
    /// (from 0) was among the last.
    TooManyEvents {
        /// The contact, from 0.
        contact: usize,
    },
    /// Contacts changed their states within one step more often than the event-driven method follows.
    TooManyChanges {
        /// Largest number of changes in a step; those of several contacts at one time count once.
        most: u64,
    },
    /// Friction wedges this contact (from 0): no force satisfies its law (Painlevé).
    Wedged {
        /// The contact, from 0.
        contact: usize,
    },
    /// The equations of the contacts that share masses with this one (from 0) are singular but for rounding, and no
    /// other states have forces: friction wedges these contacts, or nearly.
    Singular {
        /// The contact, from 0.
        contact: usize,
    },
    /// No force was found that satisfies the law of this contact (from 0). It shares masses with too many others for
    /// all their states to be tried, so there may be one.
    NoneFound {
        /// The contact, from 0.
        contact: usize,
    },
}

impl StepFailure {
    /// The failure with its time counted from an instant that is earlier by this time (s).
    #[must_use]
    pub fn later(mut self, by: f64) -> Self {
        if let Self::NegativeFriction { after, .. } | Self::WeakStaticFriction { after, .. } =
            &mut self
        {
            *after += by;
        }
        self
    }
}

/// Advances a motion in time. Implementations allocate memory when they are made, never in a step.
///
/// ```
/// use amontons::integrator::{Inputs, Method, Motion, choose};
/// use amontons::model::LumpedModel;
/// use amontons::scene::parse;
///
/// let scene = parse(
///     "oscillator",
///     "[integrator]\nmethod = \"event-driven\"\nstep = 1e-3\n\
///      [[mass]]\nname = \"m\"\nmass = 1.0\nlocked = [\"y\"]\n\
///      [[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
///      [[initial]]\nmass = \"m\"\nx = 0.01\n",
/// )?;
/// let model = LumpedModel::from(&scene);
/// let mut integrator = choose(&model, Method::EventDriven)?;
/// let mut motion = Motion::new(vec![0.01], vec![0.0], Vec::new());
/// let inputs = Inputs::uniform(vec![0.0], 0, 0.0, 0.0);
/// // A hundred steps are half a period of ω = 10 rad/s.
/// let step = std::f64::consts::PI / 1000.0;
/// integrator.advance(&mut motion, &inputs, step, 100).expect("there is no contact");
/// assert!((motion.displacement[0] + 0.01).abs() < 1e-14);
/// # Ok::<(), amontons::Error>(())
/// ```
pub trait Integrator: Send {
    /// Takes `count` steps of length `step` (s).
    ///
    /// # Errors
    /// Returns the contact that could not be solved; the motion is then incomplete.
    fn advance(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure>;

    /// The contact forces at the present instant, from position, velocity and drive alone.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure>;

    /// Computes the response of contacts that keep their states to an applied load. The response is linear: forces give contact
    /// forces and accelerations, changes of forces give their changes, and rates give their rates.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure>;

    /// (N, T) of each contact over the last step, N; `None` where the method has no such forces, or each contact
    /// lies along degrees of freedom of its own, whose momentum gives them.
    fn multipliers(&self) -> Option<&[[f64; 2]]> {
        None
    }

    /// The contact states that the motion has gone through; `None` if the integrator keeps no log of them.
    fn visits(&self) -> Option<&VisitLog> {
        None
    }

    /// The work of friction on the masses at each contact since the integrator was made, J; `None` if the integrator writes no
    /// ledger.
    fn friction_work(&self) -> Option<&[f64]> {
        None
    }

    /// Reserves memory for `_count` waves of a drive, before the first step that has them.
    fn expect_waves(&mut self, _count: usize) {}

    /// Replaces the damping.
    fn set_damping(&mut self, damping: Damping);
}

/// Name of a compiled time loop of the paper's scheme, specialised for one structure and its effects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kernel {
    /// The structure whose forces the kernel evaluates.
    pub structure: &'static str,
    /// The effects for which the kernel's arithmetic is compiled.
    pub arithmetic: String,
}

/// All kernels that [`choose`] chooses from.
#[must_use]
pub fn kernels() -> Vec<Kernel> {
    forward_increment::kernels()
}

/// Returns the fastest integrator of this method for the structure of the model.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite, or if more contacts share masses than the method
/// takes.
pub fn choose(model: &LumpedModel, method: Method) -> Result<Box<dyn Integrator>, Error> {
    if method == Method::EventDriven {
        return Ok(Box::new(EventDriven::new(model)?));
    }
    if let Some(ring) = RingForwardIncrement::new(model) {
        return Ok(Box::new(ring));
    }
    forward_increment::faster(model)
}

/// Records that an integrator keeps besides the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Records {
    /// The energy ledger of the motion, step by step; a motion without a ledger is advanced without one.
    pub ledger: bool,
    /// A log of the contact states ([`Integrator::visits`]), for which a step may allocate memory.
    pub visits: bool,
}

/// Returns the fastest integrator of this method for the structure of the model that also writes these records. They do not
/// change the motion.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite, if more contacts share masses than the method
/// takes, or if a ledger is asked for and the stiffness matrix is not symmetric: such a model has no elastic energy.
pub fn choose_recording(
    model: &LumpedModel,
    method: Method,
    records: Records,
) -> Result<Box<dyn Integrator>, Error> {
    use event_driven::Writer;
    use forward_increment::WithLedger;
    let Records { ledger, visits } = records;
    if ledger && !model.stiffness.is_symmetric() {
        return Err(Error::scene(
            "the energy ledger has no entry for the work of circulatory forces, which make the stiffness matrix unsymmetric; \
             leave out effects.energy",
        ));
    }
    if method == Method::EventDriven {
        let writer = || Writer::new(model);
        return Ok(match (ledger, visits) {
            (false, false) => Box::new(EventDriven::new(model)?),
            (true, false) => Box::new(EventDriven::with_observer(model, writer())?),
            (false, true) => Box::new(EventDriven::with_observer(model, VisitLog::default())?),
            (true, true) => {
                Box::new(EventDriven::with_observer(model, (writer(), VisitLog::default()))?)
            }
        });
    }
    let mut chosen = choose(model, method)?;
    if ledger {
        chosen = Box::new(WithLedger::new(chosen, model));
    }
    if visits {
        chosen = Box::new(visits::WithVisits::new(chosen));
    }
    Ok(chosen)
}
