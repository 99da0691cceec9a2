//! Event-driven motion, exact up to rounding between changes of contact state.
//!
//! Between two changes of contact state the equation of motion is linear, so its solution is a power series in time
//! that is summed to the last digit. What the contact states require is a polynomial in time, whose first root is the
//! next event. At an event the law of contact decides the states that follow. The internal step determines how often
//! inputs are read. It does not determine the accuracy.
//!
//! Symbols: M ẍ = F − C ẋ − K x + Gᵀ λ with C = α M + β K and discrete dampers; G_N and G_T are the rows of G of one
//! contact, λ its forces (N, T), v the velocity of its surface, v_r = v − G_T ẋ its slip velocity, σ = ±1 the sign of
//! v_r in slip, µ_s and µ_k its static and kinetic coefficients; W = G M⁻¹ Gᵀ; ε = 2⁻⁵².
//!
//! # The algorithm
//!
//! One internal step of length h (s) has seven stages ([`Integrator::advance`]). Over the step F, v, µ_s and µ_k change
//! linearly, v to its value at the end, the others from theirs at the beginning, plus waves ([`waves`]).
//!
//! 1. **Start.** The remaining time of the step is `left` = h. A closed contact with |v_r| above rounding takes the
//!    sliding state of the sign of v_r: the velocity of its surface may have jumped since the last step. In the first
//!    step of a motion, closed contacts that approach have an impact as at a `Touch`.
//! 2. **Expand** ([`series`]). With the time s τ, 0 ≤ s ≤ 1, from now and x(s) = Σ c_k s^k,
//!
//!    ```text
//!    c_0 = x,   c_1 = τ ẋ,   (k + 1)(k + 2) c_{k+2} = τ² a_k,
//!    a_k = M⁻¹ (F_k − C (k + 1) c_{k+1} / τ − K c_k + Gᵀ λ_k),
//!    ```
//!
//!    where F_k and v̇_k are the powers of the outer forces and of the accelerations of the surfaces. The forces λ_k
//!    follow from linear equations: λ_k = 0 of an open contact; G_N a_k = 0 of a closed one, with G_T a_k = v̇_k
//!    where it sticks, or T_k = σ Σ_j µ_j N_{k−j} where it slips, with the powers µ_j of its coefficient. [`series`]
//!    says how many powers are used, and how long τ is.
//! 3. **Watch** ([`watch`]). Each state requires that these functions of s do not become negative:
//!
//!    | state | function | event |
//!    | --- | --- | --- |
//!    | open | gap g + G_N x | `Touch` |
//!    | stick | normal force N | `Lift` |
//!    | stick | µ_s N − T and µ_s N + T | `Slip` with σ = 1, σ = −1 |
//!    | slip | normal force N | `Lift` |
//!    | slip | σ v_r | `Stop` |
//!
//!    If the masses of a contact that sticks have one direction of motion only (W of the contact is singular), N
//!    alone is watched. Contacts that hold more directions than their masses have are watched for two more events:
//!    the surface of a contact that sticks moves on along the tangent (`Leave`), or the gap of a closed contact opens
//!    or closes (`Part`).
//! 4. **Find the first root** ([`roots`]) of each function. The earliest event ends the series. Events within 4 ε of
//!    each other, in parts of τ, are one event of several contacts. A contact has one event at a time: where two of its
//!    functions fall together, that of the lower row of the table.
//! 5. **Advance** to the event, or to the end of the series. Positions and velocities that contacts hold are put back
//!    to their places, so that rounding does not add up to a drift: a degree of freedom that is a contact's own by
//!    assignment, others by M⁻¹ Gᵀ λ with the λ that the equations of stage 2 give for the drift in place of a_k.
//! 6. **Change the states** ([`EventDriven::change`]):
//!
//!    1. At a `Stop` the slip velocity becomes zero.
//!    2. At a `Touch` the velocities jump by a perfectly inelastic impact with friction ([`impact`]).
//!    3. Each contact gets the states that its event leaves to it:
//!
//!       | contact | admissible states |
//!       | --- | --- |
//!       | event `Lift`; open without an event; thrown off by an impact | open |
//!       | event `Slip` or `Leave` | slip in that direction with µ_k, or open |
//!       | event `Stop`; sticks; closed after an impact with v_r = 0 | stick with \|T\| ≤ µ_s N, slip either way with µ_k, or open |
//!       | slips with v_r = 0 at a `Part`, or beside a contact with more than [`MOST_TURNS`] events at the instant | the same |
//!       | closed after an impact with v_r ≠ 0 | slip in the direction of v_r with µ_k, or open |
//!       | any other that slips | slip in its direction with µ_k, or open |
//!
//!       A law without sticking leaves a closed contact slip in its fixed direction only.
//!
//!    4. The contact problem in accelerations decides among them: 0 ≤ G_N ẍ ⊥ N ≥ 0, and T of a contact that begins
//!       to slip has the sign of v̇ − G_T ẍ. A contact that could stick has µ_s as its limit first; if it slips even
//!       so, µ_k replaces µ_s in that direction, and the problem is solved again. So T falls from µ_s N to µ_k N at a
//!       `Slip`.
//!
//!    [`ContactProblem`] solves the impact and the accelerations. It tries the present states first, so contacts stay in
//!    them as long as the law lets them; the statistics count where the law had another solution.
//! 7. Repeat from 2 until the step is complete.
//!
//! # Several events at one instant
//!
//! Events count as events at one instant if less than 1e-13 h passes from each to the next. Where rounding decides a
//! sign there, states may lead to each other without an end. These rules end such turns, by the number n of events
//! that a contact has had at the instant. Slip that stops at the second change of an instant or later sticks, if the
//! solution continues it and no contact opens or closes.
//!
//! | n | rule |
//! | --- | --- |
//! | above 2 | the rounding budgets of the contact double with each event ([`rounding`]) |
//! | above [`MOST_TURNS`] | a contact that stops may not stick within [`AT_LIMIT`] of its limit; it slips or opens, if either is lawful |
//! | above [`MOST_SHARES`] | the same for contacts that hold more directions than their masses have; before, they share their load otherwise |
//! | [`MOST_OPENINGS`] + 1 to [`MOST_TOUCHES`] | a contact that would open stays closed, but at a `Lift` |
//! | above [`MOST_TOUCHES`], `Touch` | the gap is given an approach of [`APPROACH`], and forces that carry it are looked for |
//!
//! # What is guaranteed, and what is not
//!
//! - No event is passed over, except one whose function becomes negative by less than the budgets of its first powers
//!   together ([`roots`]).
//! - The error of one series is rounding, relative to the largest displacements and not to each of them. An unstable
//!   motion amplifies it, and so does an event that is decided by rounding: a gap that just touches, a force that just
//!   reaches its limit.
//! - The motion is the same to the last bit on every machine with IEEE 754 doubles, and however a run is divided into
//!   multiples of the step.
//! - A step ends: with the motion; with a [`StepFailure`] that says why; or with NaN in a displacement whose numbers
//!   have left the range of doubles. Failures are: no forces or impulses obey the law, or none are found (Painlevé;
//!   an impact without a `Touch` is not tried); the forces are rounding only; more than [`MAX_STANDSTILL`] changes of
//!   state for each contact at one instant, or [`MAX_EVENTS`] in a step; more than [`MAX_SERIES`] series. A mode that
//!   decays much faster than the step takes series as one that oscillates does.
//! - Where surfaces are at rest and contacts can stick, an impact never adds energy ([`impact`]). Velocities that are
//!   put to zero as rounding may change it by their budgets.
//! - Infinitely many impacts within a finite time are cut off: the last hops are ended by a budget
//!   ([`rounding::least_hop`]), and counted.
//! - Where the law of contact allows several motions, one is followed. Another one is as lawful.
//! - Impacts have no restitution. Friction that depends on the slip velocity makes the equation of motion nonlinear,
//!   and so do contacts that stick and cannot open; the method refuses both.
//!
//! # References
//!
//! Power series of this order as an integrator: Jorba and Zou, Experimental Mathematics 14 (2005) 99. Event-driven
//! integration of systems with unilateral contacts and friction, and inelastic impacts in them: Pfeiffer and Glocker,
//! Multibody Dynamics with Unilateral Contacts (Wiley, 1996); Acary and Brogliato, Numerical Methods for Nonsmooth
//! Dynamical Systems (Springer, 2008).

mod impact;
mod law;
mod ledger;
mod record;
mod reduced;
mod report;
mod roots;
mod rounding;
mod series;
mod watch;
mod waves;

use super::contact_problem::{ContactConstraint, ContactProblem};
use super::dynamics::Dynamics;
use super::{
    AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Integrator, Motion, StepFailure, VisitLog,
};
use crate::Error;
use crate::contact::{ContactForce, ContactState, Friction};
use crate::model::{Contact, Damping, Direction, LumpedModel};
use impact::frictionless;
pub(super) use ledger::Writer;
use ledger::{MotionObserver, Segment};
pub use record::{EventRecord, EventRecorder};
use reduced::MOST_PLACES;
use rounding::{DIFFERENCE, NOISE, pulls, shortest};
use series::{ORDER, Polynomial, Series, SeriesStart};
pub use watch::Event;
use waves::Waves;

/// Largest number of contacts that share masses: their equations take the cube of that number.
const MAX_GROUP: usize = 256;
/// Largest number of changes of state (several events at one time count once) in one internal step, times the number of
/// contacts; more are a loop without an end.
const MAX_EVENTS: u64 = 10_000;
/// Largest number of changes of state at one instant, times the number of contacts. Changes are at one instant if
/// less than [`NOISE`] of a step passes from each to the next.
const MAX_STANDSTILL: u64 = 16;
/// A contact with more events than this at one instant, up to [`MOST_TOUCHES`], opens there at a `Lift` only.
const MOST_OPENINGS: u32 = 5;
/// A contact with more events than this at one instant changes between sticking and slipping in turn: friction that
/// sticks passes its limit, and the slip that follows stops at once.
const MOST_TURNS: u32 = 3;
/// The limit in place of [`MOST_TURNS`] for a contact that shares its load with others that hold the same masses.
const MOST_SHARES: u32 = 7;
/// Relative distance from the limit of friction at which a contact that sticks and slips in turn counts as at its
/// limit.
const AT_LIMIT: f64 = 1e-9;
/// A contact that touches after more events than this at one instant can stay neither open nor closed.
const MOST_TOUCHES: u32 = 15;
/// Acceleration of approach that is prescribed for a contact that can stay neither open nor closed
/// ([`prescribe_approach`](EventDriven::prescribe_approach)), relative to the largest one that a contact of its group has
/// without contact forces.
const APPROACH: f64 = 1e-6;
/// Largest number of series in one internal step. A series covers about three radians of the fastest oscillation, or
/// three time constants of the fastest decay ([`series`]).
const MAX_SERIES: u32 = 100_000;
/// A series that covers no more than this part of the remaining step has numbers that have left the range of doubles. A
/// displacement then becomes NaN, and the step ends.
const SHORTEST: f64 = 1e-12;

/// Event-driven integrator: exact motion, up to rounding, from one event to the next.
///
/// Structures with up to 16 degrees of freedom (two more for each contact between two masses or at an
/// angle to them) get a full matrix for each contact state that they meet, of which up to 64 are kept, in
/// at most 300 kB. That memory is allocated when the integrator is made. Larger structures use sparse matrices, or the products
/// of `PerMass` where their matrices are full.
pub struct EventDriven<W = ()> {
    observer: W,
    dynamics: Dynamics,
    series: Series,
    /// `true` if any contact holds more than one degree of freedom at a time, or has a gap in the reference position:
    /// gaps and slips are then differences of larger values.
    is_inclined: bool,
    /// `true` for each contact that sticks only as long as the surfaces do not part the contacts
    /// ([`ContactProblem::overheld`]).
    ///
    /// [`ContactProblem::overheld`]: super::contact_problem::ContactProblem::overheld
    overheld: Vec<bool>,
    /// |G M⁻¹ K| along normal and tangent of each contact, 1/s²: the factors from displacements to the accelerations
    /// that springs cause, term by term, without contact forces.
    pulls: Vec<[Direction; 2]>,
    /// A time scale of the fastest oscillation of the masses on their springs, s; zero without springs.
    shortest: f64,
    /// Memory for the polynomial under examination.
    polynomial: Polynomial,
    /// Outer forces, N, velocities (m/s) and accelerations (m/s²) of the sliders at the present instant.
    force: Vec<f64>,
    surface: Vec<f64>,
    surface_acceleration: Vec<f64>,
    /// Friction coefficients at the present instant.
    friction: Vec<Friction>,
    /// The velocities of each surface at the beginning and at the end of the step, added, m/s. Friction of a fixed
    /// direction has its sign.
    heading: Vec<f64>,
    /// Bound of the speed of each surface in the step, m/s: the larger one of its ends, plus the amplitudes of waves.
    /// The velocity within the step is a difference of such numbers, so a velocity far below it is rounding.
    surface_speed: Vec<f64>,
    /// The event of each contact at the present instant; `None` if it has none.
    events: Vec<Option<Event>>,
    /// Number of events that each contact has had at the present instant.
    repeats: Vec<u32>,
    /// The fastest velocity since the present instant began, m/s. An impact may have removed it and left its rounding.
    fastest_here: f64,
    /// Number of landings of each contact in the present internal step.
    landings: Vec<u32>,
    before: Vec<ContactState>,
    /// Contacts that were closed at some time of the present instant, by their states; they take part in its impacts.
    closed: Vec<ContactState>,
    /// States to hold at the present instant: those of slips that stop, or of contacts that an impact does not throw
    /// off.
    kept: Vec<ContactState>,
    /// The states that are tried first after events.
    likely: Vec<ContactState>,
    frictionless: Vec<Friction>,
    /// The largest acceleration that the constant load alone gives a mass, m/s².
    loaded: f64,
    /// The velocity, m/s, that outer forces give a mass in a step: h times the larger of the accelerations by all
    /// forces at the beginning of the step and by the constant load alone, plus those by the amplitudes of waves.
    /// These parts may balance each other, so that a velocity far below it is rounding.
    gained: f64,
    /// The acceleration, m/s², that scales the rounding of outer forces in parts of [`NOISE`] · [`DIFFERENCE`]:
    /// `gained` by h, plus ε times the phase of each wave in those parts, since a phase of many radians is rounded
    /// coarsely.
    driven: f64,
}

/// Number of places of the full matrices of a structure; `None` for a large one, which has none.
pub(crate) fn full_places(contacts: &[Contact], dofs: usize) -> Option<usize> {
    let (_, width) = law::places(contacts, dofs);
    (width <= MOST_PLACES).then(|| width.next_multiple_of(4).max(4))
}

impl EventDriven {
    /// The event-driven integrator for this model.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is not positive definite, or if too many contacts share masses.
    pub fn new(model: &LumpedModel) -> Result<Self, Error> {
        Self::with_observer(model, ())
    }
}

impl<W: MotionObserver> EventDriven<W> {
    pub(super) fn with_observer(model: &LumpedModel, observer: W) -> Result<Self, Error> {
        let about = model.law.friction.info();
        if !about.is_constant() {
            return Err(Error::scene(format!(
                "the event-driven method does not support the law \"{}\": the motion between events would not be linear",
                about.name
            )));
        }
        if model.law.follows_size() {
            return Err(Error::scene(
                "the event-driven method does not support contacts that can stick but cannot open: their friction is \
                 proportional to |N|, which is nonlinear where N changes sign",
            ));
        }
        let mut dynamics = Dynamics::new(model)?;
        let contacts = model.contacts.len();
        let series = Series::new(&dynamics);
        let together = dynamics.problem.delassus.largest_group();
        if together > MAX_GROUP {
            return Err(Error::scene(format!(
                "{together} contacts share masses, but the event-driven method supports at most {MAX_GROUP}"
            )));
        }
        Ok(Self {
            observer,
            series,
            is_inclined: model.contacts.iter().any(|contact| {
                contact.normal.as_unit().is_none()
                    || contact.tangent.as_unit().is_none()
                    || contact.gap != 0.0
            }),
            overheld: dynamics.problem.overheld(),
            shortest: shortest(&dynamics),
            pulls: pulls(&dynamics),
            polynomial: [0.0; ORDER + 1],
            force: vec![0.0; model.dofs()],
            surface: vec![0.0; contacts],
            surface_acceleration: vec![0.0; contacts],
            friction: vec![Friction::from(0.0); contacts],
            heading: vec![0.0; contacts],
            surface_speed: vec![0.0; contacts],
            events: vec![None; contacts],
            repeats: vec![0; contacts],
            fastest_here: 0.0,
            landings: vec![0; contacts],
            before: vec![ContactState::Detached; contacts],
            closed: vec![ContactState::Detached; contacts],
            kept: vec![ContactState::Detached; contacts],
            likely: vec![ContactState::Detached; contacts],
            frictionless: vec![Friction::from(0.0); contacts],
            loaded: dynamics.fastest_driven(&model.load),
            driven: 0.0,
            gained: 0.0,
            dynamics,
        })
    }

    fn step(&mut self, motion: &mut Motion, inputs: &Inputs, h: f64) -> Result<(), StepFailure> {
        motion.statistics.steps += 1;
        let (mut left, mut events, mut standstill, mut expanded) = (h, 0, 0, 0);
        self.repeats.fill(0);
        self.fastest_here = 0.0;
        self.landings.fill(0);
        if f64::from(MAX_SERIES) * Waves::reach(&inputs.waves, h) < h {
            return Err(StepFailure::TooManySeries { most: MAX_SERIES.into() });
        }
        self.reach(inputs, h, left);
        self.follow_slider(motion, inputs, h);
        self.note_closed(motion);
        if motion.statistics.steps == 1 {
            self.stop_approach(motion)?;
            self.count_others_at_start(motion);
        }
        while left > 0.0 {
            let Self { series, dynamics, force, surface_acceleration, friction, .. } = self;
            let start = (&*motion.displacement, &*motion.velocity);
            let (outer, slider, passed) = (force, surface_acceleration, h - left);
            let now = SeriesStart { outer, slider, friction, passed };
            let most = Waves::reach(&inputs.waves, left);
            series.expand(dynamics, &motion.contacts, inputs, now, start, most);
            let reach = series.span();
            if reach <= SHORTEST * left {
                // No series covers numbers that have left their range: the motion is to show that to its reader, and
                // where it happens.
                let dof = series.first_out_of_range();
                motion.displacement[dof] = f64::NAN;
                return Ok(());
            }
            expanded += 1;
            if expanded > MAX_SERIES {
                return Err(StepFailure::TooManySeries { most: MAX_SERIES.into() });
            }
            let event = self.next_event(motion, inputs);
            let part = event.unwrap_or(1.0);
            if let Some(failure) = self.series.impossible_friction(part) {
                return Err(failure.later(h - left));
            }
            if self.dynamics.law.is_reduced() {
                self.count_broken(motion, inputs, part);
            }
            let passed = part * reach;
            if passed > NOISE * h {
                standstill = 0;
                self.repeats.fill(0);
                self.fastest_here = 0.0;
            }
            if passed > 0.0 {
                let Self { observer, dynamics, series, force, surface, friction, .. } = self;
                let acceleration = &self.surface_acceleration;
                let segment = Segment {
                    dynamics,
                    series,
                    force,
                    surface,
                    acceleration,
                    friction,
                    inputs,
                    part,
                };
                observer.passes(segment, motion);
                self.series.evaluate(part, &mut motion.displacement, &mut motion.velocity);
                // The remaining time ends in an exact zero, and never in a remainder of rounding.
                left = if passed == left { 0.0 } else { left - passed };
                self.reach(inputs, h, left);
                self.project_onto_constraints(motion);
                self.note_closed(motion);
            }
            if event.is_some() {
                for (repeats, event) in self.repeats.iter_mut().zip(&self.events) {
                    *repeats += u32::from(event.is_some());
                }
                self.change(motion, standstill > 0)?;
                events += 1;
                standstill += 1;
                let contacts = self.events.len() as u64;
                if standstill > MAX_STANDSTILL * contacts {
                    let contact = self.events.iter().position(Option::is_some).unwrap_or(0);
                    return Err(StepFailure::TooManyEvents { contact });
                }
                if events > MAX_EVENTS * contacts {
                    return Err(StepFailure::TooManyChanges { most: MAX_EVENTS * contacts });
                }
            }
        }
        // Each step determines anew how loads are shared, so that it depends on nothing but the motion.
        self.series.law.forget_shared();
        Ok(())
    }

    /// Evaluates the inputs of the motion with `left` (s) of a step of length `h` remaining.
    fn reach(&mut self, inputs: &Inputs, h: f64, left: f64) {
        for (force, (start, rate)) in
            self.force.iter_mut().zip(inputs.force.iter().zip(&inputs.force_rate))
        {
            *force = start + rate * (h - left);
        }
        for (surface, (end, acceleration)) in self
            .surface
            .iter_mut()
            .zip(inputs.slider_velocity.iter().zip(&inputs.slider_acceleration))
        {
            let gained = acceleration * left;
            *surface = end - gained;
            // A surface that begins to move is at rest: a remainder of rounding in the difference would have a
            // direction.
            if surface.abs() <= f64::EPSILON * gained.abs() {
                *surface = 0.0;
            }
        }
        self.surface_acceleration.copy_from_slice(&inputs.slider_acceleration);
        self.friction.copy_from_slice(&inputs.friction);
        for (friction, [kinetic, static_]) in self.friction.iter_mut().zip(&inputs.friction_rate) {
            friction.kinetic += kinetic * (h - left);
            friction.static_ += static_ * (h - left);
        }
        for wave in inputs.waves.iter().filter(|wave| wave.amplitude != 0.0) {
            let passed = h - left;
            let [start, now, end] = [0.0, passed, h].map(|t| wave.after(t));
            for &(dof, force) in &wave.pushes {
                self.force[dof] += force * (now - start);
            }
            // The drive has its chord, which meets those of the neighbouring steps to the last digit: a phase that
            // is rounded would let a contact slip that sticks to what nearly stands.
            let chord = end - start;
            let (above, rate) =
                ((now - start) - chord * (passed / h), wave.rate_after(passed) - chord / h);
            for &contact in &wave.moves {
                self.surface[contact] += above;
                self.surface_acceleration[contact] += rate;
            }
            for &(contact, [kinetic, static_]) in &wave.friction {
                self.friction[contact].kinetic += kinetic * (now - start);
                self.friction[contact].static_ += static_ * (now - start);
            }
        }
    }

    /// Notes the closed contacts at the beginning of an instant.
    fn note_closed(&mut self, motion: &Motion) {
        for (closed, state) in self.closed.iter_mut().zip(&motion.contacts) {
            *closed = frictionless(*state != ContactState::Detached);
        }
    }

    /// Changes contact states after a jump of a slider velocity since the last step: stuck masses begin to slip, and
    /// sliding masses may reverse their slip.
    fn follow_slider(&mut self, motion: &mut Motion, inputs: &Inputs, h: f64) {
        for (speed, (start, end)) in
            self.surface_speed.iter_mut().zip(self.surface.iter().zip(&inputs.slider_velocity))
        {
            *speed = start.abs().max(end.abs());
        }
        let inverse_mass = &self.dynamics.inverse_mass;
        let (mut swung, mut blurred) = (0.0, 0.0);
        for wave in &inputs.waves {
            let pushed = |&(dof, force): &(usize, f64)| (inverse_mass.get(dof, dof) * force).abs();
            let most = wave.amplitude.abs() * wave.pushes.iter().map(pushed).fold(0.0, f64::max);
            swung += most;
            blurred += most * wave.phase.abs();
            for &contact in &wave.moves {
                self.surface_speed[contact] += wave.amplitude.abs();
            }
        }
        let driven = self.load_acceleration(&self.force) + swung;
        self.gained = h * driven;
        self.driven = driven + blurred * f64::EPSILON / (NOISE * DIFFERENCE);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            // When a surface begins to move, the sign of its first velocity is rounding.
            let mean = self.surface[i] + inputs.slider_velocity[i];
            self.heading[i] = mean;
            let old = motion.contacts[i];
            if old == ContactState::Detached {
                continue;
            }
            let along = contact.tangent.dot(&motion.velocity);
            // Between masses the slip is a difference, whose rounding is a part of its terms.
            let terms = contact.tangent.0.iter().map(|&(dof, t)| (t * motion.velocity[dof]).abs());
            let terms = terms.fold(0.0, |sum, term| sum + term);
            let slip = self.surface[i] - along;
            if let Some(new) = self.dynamics.law.fixed_state(mean) {
                if new != old {
                    motion.contacts[i] = new;
                    motion.statistics.count_change(new);
                }
                continue;
            }
            // For a slider at rest only the forces determine the magnitude of rounding.
            let size = self.surface_speed[i].max(terms).max(self.gained);
            let new = if slip.abs() <= NOISE * size {
                continue;
            } else if slip > 0.0 {
                ContactState::Slide
            } else {
                ContactState::ReverseSlide
            };
            if new != old {
                motion.contacts[i] = new;
                motion.statistics.count_change(new);
            }
        }
    }

    /// Solves the impact of closed contacts that approach when a motion is started.
    fn stop_approach(&mut self, motion: &mut Motion) -> Result<(), StepFailure> {
        let speed = self.speed(motion);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let approaches = motion.contacts[i] != ContactState::Detached
                && contact.normal.dot(&motion.velocity) < -NOISE * speed;
            self.events[i] = approaches.then_some(Event::Touch);
        }
        if self.events.iter().any(Option::is_some) { self.change(motion, false) } else { Ok(()) }
    }

    /// Sets the gaps and velocities that contacts hold to their exact values.
    fn project_onto_constraints(&mut self, motion: &mut Motion) {
        if self.is_inclined {
            let law = &mut self.series.law;
            law.set(&self.dynamics, &motion.contacts, &self.friction);
            law.project_positions(&self.dynamics, &mut motion.displacement);
            law.project_velocities(&self.dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let state = motion.contacts[i];
            if state == ContactState::Detached {
                continue;
            }
            if let Some(dof) = contact.normal.as_unit() {
                motion.displacement[dof] = contact.closed_place();
                motion.velocity[dof] = 0.0;
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                motion.velocity[dof] = self.surface[i];
            }
        }
    }

    /// Counts at the start of a motion whether the law of contact allows another motion than the present one.
    fn count_others_at_start(&mut self, motion: &mut Motion) {
        self.events.fill(None);
        let speed = self.speed(motion);
        self.set_up_contact_problem(motion, false, speed);
        let problem = &mut self.dynamics.problem;
        // A contact problem without a solution is reported as soon as a state ends.
        let has_others = problem.solve(&motion.contacts).is_ok() && problem.has_another_solution();
        motion.statistics.other_solutions += u64::from(has_others);
    }

    /// Sets up the contact problem in accelerations at this instant, with the constraints that the events leave to
    /// contacts. `landed`: an impact has been solved, before which the motion had this `speed` (m/s).
    fn set_up_contact_problem(&mut self, motion: &Motion, landed: bool, speed: f64) {
        self.dynamics.free_acceleration(motion, &self.force);
        let any_in_turn = self.is_in_turn(0..self.repeats.len());
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let slip = self.surface[i] - contact.tangent.dot(&motion.velocity);
            let group = || self.dynamics.problem.delassus.group_of(i).iter().copied();
            let in_turn = any_in_turn && self.is_in_turn(group());
            let problem = &mut self.dynamics.problem;
            // A mass that lands while its surface begins to move has the direction that the surface takes.
            let has_fixed_state = self.dynamics.law.has_fixed_state();
            let surface = if has_fixed_state { self.heading[i] } else { self.surface[i] };
            let held =
                (self.dynamics.constraint_of)(self.friction[i], slip, surface, ContactState::Stick);
            let still = NOISE * speed.max(self.surface_speed[i]);
            let slipping = |direction| held.slipping(direction);
            let sliding = |state: ContactState| slipping(state.sliding_direction().unwrap_or(1.0));
            problem.constraints[i] = match (self.events[i], motion.contacts[i]) {
                (Some(Event::Lift), _) | (None, ContactState::Detached) => ContactConstraint::Open,
                // An impact may throw other contacts off, and changes the slip of all.
                _ if landed && self.kept[i] == ContactState::Detached => ContactConstraint::Open,
                _ if landed && slip.abs() > still => slipping(slip.signum()),
                _ if landed => held,
                (Some(Event::Slip(direction) | Event::Leave(direction)), _) => sliding(direction),
                (Some(Event::Stop), _) | (_, ContactState::Stick) => held,
                // A contact that does not slip yet may slip either way, or hold. The same holds for one that was to slip by
                // an earlier event of this instant, where one event leads to the other in turn.
                (event, _) if slip.abs() <= still && (event == Some(Event::Part) || in_turn) => {
                    held
                }
                (_, state) => sliding(state),
            };
            problem.free[i] = [
                contact.normal.dot(&self.dynamics.acceleration),
                contact.tangent.dot(&self.dynamics.acceleration) - self.surface_acceleration[i],
            ];
        }
    }

    /// `true` if any of these contacts changes its state in turn with others at the present instant.
    fn is_in_turn(&self, contacts: impl IntoIterator<Item = usize>) -> bool {
        contacts.into_iter().any(|contact| self.repeats[contact] > MOST_TURNS)
    }

    /// Prescribes an approach for contacts that touch and lift in turn at one instant; `true` if there are any. They
    /// carry nothing there: closed they would pull next, open they would close. So the present forces cannot continue,
    /// and the contact problem is asked for forces that can.
    fn prescribe_approach(&mut self) -> bool {
        let mut is_pressed = false;
        for (i, event) in self.events.iter().enumerate() {
            if *event == Some(Event::Touch) && self.repeats[i] > MOST_TOUCHES {
                let ContactProblem { delassus, free, .. } = &mut self.dynamics.problem;
                let sizes = delassus.group_of(i).iter().flat_map(|&other| free[other]);
                let size = sizes.fold(0.0, |most: f64, free| most.max(free.abs()));
                free[i][0] = free[i][0].min(0.0) - APPROACH * size;
                is_pressed = true;
            }
        }
        is_pressed
    }

    /// Ends turns of contacts that stick and slip in turn at one instant: friction that sticks passes its limit, and
    /// the slip that follows goes the other way. Such a contact does not stick at its limit: another contact changes
    /// its state, or it opens itself, if it then stays open.
    fn end_turns(&mut self, motion: &mut Motion) -> Result<(), StepFailure> {
        for i in 0..self.events.len() {
            // If contacts that stick hold more directions than the masses have, another share of the load may be
            // admissible.
            let most = if self.overheld[i] { MOST_SHARES } else { MOST_TURNS };
            let problem = &mut self.dynamics.problem;
            let turns = self.repeats[i] > most
                && self.events[i] == Some(Event::Stop)
                && problem.states[i] == ContactState::Stick;
            if !turns {
                continue;
            }
            let held = problem.constraints[i];
            let slips = |problem: &ContactProblem| problem.states[i] != ContactState::Stick;
            problem.constraints[i] = held.below_limits(AT_LIMIT);
            if problem.solve(&self.likely).is_ok() && slips(problem) {
                continue;
            }
            problem.constraints[i] = ContactConstraint::Open;
            if problem.solve(&self.likely).is_ok() && problem.stays_open(i) {
                continue;
            }
            problem.constraints[i] = held;
            motion.statistics.count_sweeps(problem.solve(&self.likely)?);
        }
        Ok(())
    }

    /// Shares the loads of contacts that stick and slip in turn at one instant and hold more directions than the masses
    /// have: the equations do not determine how these contacts share their load. They share it inside the limits of the
    /// law, or else as the contact problem has found it, until one of their states changes.
    fn share_loads(&mut self, motion: &Motion) {
        let Self { dynamics, series, surface, surface_acceleration, friction, .. } = self;
        let new = |i: usize| motion.contacts[i];
        for group in 0..dynamics.problem.delassus.groups().len() {
            let problem = &mut dynamics.problem;
            let contacts = &problem.delassus.groups()[group];
            if contacts.iter().all(|&i| self.events[i].is_none() && self.before[i] == new(i)) {
                continue;
            }
            let turns = |&i: &usize| {
                self.overheld[i] && self.repeats[i] > MOST_TURNS && new(i) == ContactState::Stick
            };
            let is_found = |&i: &usize| are_open_alike(problem.states[i], new(i));
            let (turn, is_found) = (contacts.iter().any(turns), contacts.iter().all(is_found));
            let constraint_of = dynamics.constraint_of;
            let constraint = |i: usize| match (new(i), new(i).sliding_direction()) {
                (ContactState::Detached, _) => ContactConstraint::Open,
                (_, direction) => {
                    let held = constraint_of(friction[i], 0.0, surface[i], ContactState::Stick);
                    direction.map_or(held, |direction| held.slipping(direction))
                }
            };
            // A balance of friction holds as long as the coefficients do.
            let changes = contacts.iter().any(|&i| series.changes_friction(i));
            if turn
                && !changes
                && (problem.solve_inside(group, &motion.contacts, constraint) || is_found)
            {
                let law = &mut series.law;
                law.set(dynamics, &motion.contacts, friction);
                law.share(dynamics, surface_acceleration, group);
            } else {
                series.law.share_no_more(dynamics, group);
            }
        }
    }

    /// Changes the contact states by the events, as the law of contact decides; `again`: at the instant of the last
    /// events.
    fn change(&mut self, motion: &mut Motion, again: bool) -> Result<(), StepFailure> {
        self.before.clone_from(&motion.contacts);
        let touched = |event: &Option<Event>| matches!(event, Some(Event::Touch));
        let landed = self.events.iter().any(touched);
        let speed = self.speed(motion).max(self.fastest_here);
        self.fastest_here = speed;
        self.observer.sees_events(&self.events, motion);
        self.stop(motion);
        if landed {
            self.impact(motion, speed)?;
        }
        self.set_up_contact_problem(motion, landed, speed);
        self.likely.clone_from(&motion.contacts);
        for (likely, event) in self.likely.iter_mut().zip(&self.events) {
            if matches!(event, Some(Event::Stop)) {
                *likely = ContactState::Stick;
            }
        }
        let is_pressed = self.prescribe_approach();
        let problem = &mut self.dynamics.problem;
        motion.statistics.count_sweeps(problem.solve(&self.likely)?);
        self.end_turns(motion)?;
        let problem = &mut self.dynamics.problem;
        motion.statistics.other_solutions += u64::from(problem.has_another_solution());
        motion.statistics.events += 1;
        let mut states = self.dynamics.problem.states.iter().zip(&motion.contacts);
        let none_opens = states.all(|(new, old)| are_open_alike(*new, *old));
        for i in 0..self.events.len() {
            let (state, new) = (motion.contacts[i], self.dynamics.problem.states[i]);
            let event = self.events[i];
            let is_closed = event == Some(Event::Touch)
                || state != ContactState::Detached && event != Some(Event::Lift);
            let opens = is_closed && new == ContactState::Detached;
            motion.contacts[i] = match event {
                // Rounding may hide the direction of the slip: a contact whose slip stops again at the instant at which it
                // continued sticks, if no contact opens or closes.
                Some(Event::Stop) if again && none_opens && new == state => ContactState::Stick,
                // Rounding may also hide an opening: a contact that closes repeatedly where it opened stays closed.
                _ if opens && (MOST_OPENINGS + 1..=MOST_TOUCHES).contains(&self.repeats[i]) => {
                    self.dynamics.problem.constraints[i].closed_state()
                }
                _ => new,
            };
        }
        let statistics = &mut motion.statistics;
        for (old, new) in self.before.iter().zip(&motion.contacts) {
            if old != new {
                statistics.count_change(*new);
            }
        }
        if is_pressed {
            self.set_up_contact_problem(motion, landed, speed);
        }
        self.share_loads(motion);
        self.project_onto_constraints(motion);
        self.observer.sees_states(motion);
        Ok(())
    }
}

/// `true` if a contact is open in both states or closed in both.
fn are_open_alike(a: ContactState, b: ContactState) -> bool {
    (a == ContactState::Detached) == (b == ContactState::Detached)
}

impl<W: MotionObserver> Integrator for EventDriven<W> {
    fn advance(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        for _ in 0..count {
            self.step(motion, inputs, step)?;
        }
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        if self.present_forces(motion, inputs, forces) {
            return Ok(());
        }
        self.pose_report(motion, inputs);
        self.dynamics.contact_forces_from(&self.likely, motion, inputs, forces)
    }

    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        self.series.law.respond(&self.dynamics, held, load, response);
        Ok(())
    }

    fn visits(&self) -> Option<&VisitLog> {
        self.observer.visits()
    }

    fn friction_work(&self) -> Option<&[f64]> {
        self.observer.friction_work()
    }

    fn expect_waves(&mut self, count: usize) {
        self.series.expect_waves(count);
    }

    fn set_damping(&mut self, damping: Damping) {
        if self.dynamics.damping != damping {
            self.dynamics.damping = damping;
            self.series.forget();
        }
    }
}
