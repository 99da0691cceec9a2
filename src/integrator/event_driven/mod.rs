//! The exact motion between the instants at which a contact changes its state.
//!
//! In one contact state the motion is linear: its power series is summed to the last digits
//! ([`series`]). What must not become negative there (gap, normal force, slip, what is left of
//! friction's limit) is a polynomial, whose first root is the next event ([`roots`]). There the law of
//! contact says which state follows ([`EventDriven::change`]); a touch-down is a perfectly inelastic
//! impact with friction, as the forward increment scheme has it.
//!
//! Over an internal step forces and slider velocities change linearly, friction coefficients not at all.
//! Errors are those of rounding, so the step decides how often inputs are looked at, not how accurate
//! the motion is.

mod held;
mod law;
mod reduced;
mod report;
mod roots;
mod series;
mod watch;

use super::dynamics::Dynamics;
use super::multipliers::Freedom;
use super::{Drive, Integrator, Motion, StepFailure};
use crate::Error;
use crate::contact::{ContactForce, ContactState, Friction};
use crate::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};
use held::MAX_GROUP;
use reduced::MOST_PLACES;
use series::{ORDER, Polynomial, Series};
use watch::Event;

/// More events than this for each contact in one internal step are a loop that leads nowhere.
const MAX_EVENTS: u64 = 10_000;
/// And this many at one instant, or as near to it as [`NOISE`] of a step.
const MAX_STANDSTILL: u64 = 16;
/// How often [`NOISE`] is doubled at one instant before that.
const MOST_DOUBLINGS: u64 = 16;
/// A series that covers no more than this part of what is left of a step will not end it.
const SHORTEST: f64 = 1e-12;
/// What counts as nothing, in parts of the sizes at hand: rounding, some dozens of operations long.
const NOISE: f64 = 1e-13;
/// A contact is thrown off by an impact that gives it this part of the fastest velocity; less is rounding.
const THROWN: f64 = 1e-11;

/// Exact motion, event by event.
///
/// Structures with up to 16 degrees of freedom (two more for each contact between two masses or at an
/// angle to them) get a full matrix for each contact state that they meet, of which up to 64 are kept, in
/// at most 300 kB. That room is taken when the integrator is made. Larger structures use sparse matrices.
pub struct EventDriven {
    dynamics: Dynamics,
    series: Series,
    /// Does any contact hold more than one degree of freedom at a time?
    is_inclined: bool,
    /// |G M⁻¹ K| along normal and tangent of each contact, 1/s²: what springs make of displacements where
    /// nothing holds it, term by term.
    pulls: Vec<[Direction; 2]>,
    /// The polynomial at hand.
    polynomial: Polynomial,
    /// The outer forces, N, and the velocities of the sliders, m/s, at the instant that was reached.
    force: Vec<f64>,
    surface: Vec<f64>,
    /// The events at one instant.
    events: Vec<Option<Event>>,
    before: Vec<ContactState>,
    /// Which contacts were closed at some time of one instant: those take part in its impacts.
    closed: Vec<ContactState>,
    /// What is held at one instant: what slips that stop become, or those that an impact does not throw off.
    kept: Vec<ContactState>,
    frictionless: Vec<Friction>,
    /// What the outer forces would do in a step, m/s: beside it a velocity may be nothing.
    gained: f64,
}

/// The places of the full matrices that a structure gets; `None` for a large one, which gets none.
pub(super) fn full_places(contacts: &[Contact], dofs: usize) -> Option<usize> {
    let (_, width) = law::places(contacts, dofs);
    (width <= MOST_PLACES).then(|| width.next_multiple_of(4).max(4))
}

impl EventDriven {
    /// The integrator for this model.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite; more contacts that share masses than it can hold.
    pub fn new(model: &LumpedModel) -> Result<Self, Error> {
        let dynamics = Dynamics::new(model)?;
        let contacts = model.contacts.len();
        let series = Series::new(&dynamics);
        let together = series.law.largest_group();
        if together > MAX_GROUP {
            return Err(Error::scene(format!(
                "{together} contacts share masses; the event-driven integrator takes up to {MAX_GROUP}"
            )));
        }
        Ok(Self {
            series,
            is_inclined: model.contacts.iter().any(|contact| {
                contact.normal.as_unit().is_none() || contact.tangent.as_unit().is_none()
            }),
            pulls: pulls(&dynamics),
            polynomial: [0.0; ORDER + 1],
            force: vec![0.0; model.dofs()],
            surface: vec![0.0; contacts],
            events: vec![None; contacts],
            before: vec![ContactState::Detached; contacts],
            closed: vec![ContactState::Detached; contacts],
            kept: vec![ContactState::Detached; contacts],
            frictionless: vec![Friction::from(0.0); contacts],
            gained: 0.0,
            dynamics,
        })
    }

    fn step(&mut self, motion: &mut Motion, drive: &Drive, h: f64) -> Result<(), StepFailure> {
        motion.statistics.steps += 1;
        let (mut left, mut events, mut standstill) = (h, 0, 0);
        self.reach(drive, h, left);
        self.follow_slider(motion, h);
        self.note_closed(motion);
        if motion.statistics.steps == 1 {
            self.stop_approach(motion, drive)?;
        }
        while left > 0.0 {
            let Self { series, dynamics, force, .. } = self;
            let start = (&*motion.displacement, &*motion.velocity);
            series.expand(dynamics, &motion.contacts, drive, force, start, left);
            let reach = series.span();
            if reach <= SHORTEST * left {
                // No series covers numbers that have left their range: whoever looks at the motion is to
                // see that.
                motion.displacement.fill(f64::NAN);
                return Ok(());
            }
            let event = self.next_event(motion, drive, self.doubt(standstill));
            let part = event.unwrap_or(1.0);
            let passed = part * reach;
            if passed > NOISE * h {
                standstill = 0;
            }
            if passed > 0.0 {
                self.series.evaluate(part, &mut motion.displacement, &mut motion.velocity);
                // What is left ends in an exact zero, and never in a remainder of rounding.
                left = if passed == left { 0.0 } else { left - passed };
                self.reach(drive, h, left);
                self.settle(motion, drive);
                self.note_closed(motion);
            }
            if event.is_some() {
                self.change(motion, drive, standstill > 0)?;
                events += 1;
                standstill += 1;
                let contacts = self.events.len() as u64;
                if events > MAX_EVENTS * contacts || standstill > MAX_STANDSTILL * contacts {
                    let contact = self.events.iter().position(Option::is_some).unwrap_or(0);
                    return Err(StepFailure::TooManyEvents { contact });
                }
            }
        }
        Ok(())
    }

    /// How much more than usual counts as rounding, after so many events at one instant. Where the sign of
    /// a difference is decided by rounding, two states may each lead to the other: the doubt is doubled
    /// until the changes that the difference goes through decide.
    fn doubt(&self, standstill: u64) -> f64 {
        let often = standstill.saturating_sub(2 * self.events.len() as u64);
        f64::from(1_u32 << often.min(MOST_DOUBLINGS))
    }

    /// Takes note of what drives the motion with `left` (s) of a step of length `h` to go.
    fn reach(&mut self, drive: &Drive, h: f64, left: f64) {
        for (force, (start, rate)) in
            self.force.iter_mut().zip(drive.force.iter().zip(&drive.force_rate))
        {
            *force = start + rate * (h - left);
        }
        for (surface, (end, acceleration)) in self
            .surface
            .iter_mut()
            .zip(drive.slider_velocity.iter().zip(&drive.slider_acceleration))
        {
            *surface = end - acceleration * left;
        }
    }

    /// Takes note of the closed contacts, at the beginning of an instant.
    fn note_closed(&mut self, motion: &Motion) {
        for (closed, state) in self.closed.iter_mut().zip(&motion.contacts) {
            *closed = frictionless(*state != ContactState::Detached);
        }
    }

    /// A slider whose velocity was changed since the last step leaves its stuck masses behind, and
    /// those that slide may now do so the other way.
    fn follow_slider(&mut self, motion: &mut Motion, h: f64) {
        let rows = 0..self.force.len();
        let driven = rows.map(|row| self.dynamics.inverse_mass.row_times(row, &self.force).abs());
        self.gained = h * driven.fold(0.0, f64::max);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let old = motion.contacts[i];
            if old == ContactState::Detached {
                continue;
            }
            let along = contact.tangent.dot(&motion.velocity);
            // Between masses it is a difference, of which rounding is a part of the terms.
            let terms = contact.tangent.0.iter().map(|&(dof, t)| (t * motion.velocity[dof]).abs());
            let terms = terms.fold(0.0, |sum, term| sum + term);
            let slip = self.surface[i] - along;
            // Of a slider that stands only the forces say what rounding is.
            let size = self.surface[i].abs().max(terms).max(self.gained);
            let new = if slip.abs() <= NOISE * size {
                continue;
            } else if slip > 0.0 {
                ContactState::Slide
            } else {
                ContactState::ReverseSlide
            };
            if new != old {
                motion.contacts[i] = new;
                motion.statistics.state_changes += 1;
            }
        }
    }

    /// The fastest velocity, m/s, which others are nothing beside.
    fn speed(&self, motion: &Motion) -> f64 {
        largest(&motion.velocity).max(self.slowest())
    }

    /// Where all stand, m/s: what is thrown off with [`THROWN`] of it is back within the last digit of a step.
    fn slowest(&self) -> f64 {
        f64::EPSILON / THROWN * self.gained
    }

    /// A motion may be started with closed contacts that approach: an impact too.
    fn stop_approach(&mut self, motion: &mut Motion, drive: &Drive) -> Result<(), StepFailure> {
        let speed = self.speed(motion);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let approaches = motion.contacts[i] != ContactState::Detached
                && contact.normal.dot(&motion.velocity) < -NOISE * speed;
            self.events[i] = approaches.then_some(Event::Touch);
        }
        if self.events.iter().any(Option::is_some) {
            self.change(motion, drive, false)
        } else {
            Ok(())
        }
    }

    /// Puts what is held exactly where it is held.
    fn settle(&mut self, motion: &mut Motion, drive: &Drive) {
        if self.is_inclined {
            let law = &mut self.series.law;
            law.set(&self.dynamics, &motion.contacts, &drive.friction);
            law.mend_gaps(&self.dynamics, &mut motion.displacement);
            law.mend_velocities(&self.dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let state = motion.contacts[i];
            if state == ContactState::Detached {
                continue;
            }
            if let Some(dof) = contact.normal.as_unit() {
                motion.displacement[dof] = 0.0;
                motion.velocity[dof] = 0.0;
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                motion.velocity[dof] = self.surface[i];
            }
        }
    }

    /// The states that follow on the events, by the law of contact; `again`: at the instant of the last ones.
    fn change(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        again: bool,
    ) -> Result<(), StepFailure> {
        self.before.clone_from(&motion.contacts);
        let touched = |event: &Option<Event>| matches!(event, Some(Event::Touch));
        let landed = self.events.iter().any(touched);
        let speed = self.speed(motion);
        self.stop(motion);
        if landed {
            self.impact(motion, drive)?;
        }
        self.dynamics.free_acceleration(motion, &self.force);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let slip = self.surface[i] - contact.tangent.dot(&motion.velocity);
            let multipliers = &mut self.dynamics.multipliers;
            let friction = drive.friction[i];
            let held = Freedom::Law(friction.range(ContactState::Stick));
            let slipping = |direction| Freedom::Slipping { direction, friction: friction.kinetic };
            let sliding = |state: ContactState| slipping(state.sliding_direction().unwrap_or(1.0));
            multipliers.freedom[i] = match (self.events[i], motion.contacts[i]) {
                (Some(Event::Lift), _) | (None, ContactState::Detached) => Freedom::Open,
                // An impact may throw other contacts off, and changes the slip of all.
                _ if landed && contact.normal.dot(&motion.velocity) > THROWN * speed => {
                    Freedom::Open
                }
                _ if landed && slip.abs() > NOISE * speed.max(self.surface[i].abs()) => {
                    slipping(slip.signum())
                }
                _ if landed => held,
                (Some(Event::Slip(direction)), _) => sliding(direction),
                (Some(Event::Stop), _) | (_, ContactState::Stick) => held,
                (_, state) => sliding(state),
            };
            multipliers.free[i] = [
                contact.normal.dot(&self.dynamics.acceleration),
                contact.tangent.dot(&self.dynamics.acceleration) - drive.slider_acceleration[i],
            ];
        }
        motion.statistics.count_sweeps(self.dynamics.multipliers.solve()?);
        motion.statistics.events += 1;
        for (i, (state, new)) in
            motion.contacts.iter_mut().zip(&self.dynamics.multipliers.states).enumerate()
        {
            // Rounding may hide which way it goes: a slip that stops again where it went on sticks.
            let slides_on = again && self.events[i] == Some(Event::Stop) && new == state;
            *state = if slides_on { ContactState::Stick } else { *new };
        }
        let statistics = &mut motion.statistics;
        for (old, new) in self.before.iter().zip(&motion.contacts) {
            statistics.state_changes += u64::from(old != new);
        }
        self.settle(motion, drive);
        Ok(())
    }

    /// Puts the slips that stop to zero: what rounding leaves of one would have a direction.
    fn stop(&mut self, motion: &mut Motion) {
        let stops = |event: &Option<Event>| *event == Some(Event::Stop);
        if self.is_inclined && self.events.iter().any(stops) {
            self.kept.clone_from(&motion.contacts);
            for (state, event) in self.kept.iter_mut().zip(&self.events) {
                if stops(event) {
                    *state = ContactState::Stick;
                }
            }
            let law = &mut self.series.law;
            law.set(&self.dynamics, &self.kept, &self.frictionless);
            law.mend_velocities(&self.dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, event) in self.events.iter().enumerate() {
            if let (true, Some(dof)) = (stops(event), self.dynamics.contacts[i].tangent.as_unit()) {
                motion.velocity[dof] = self.surface[i];
            }
        }
    }

    /// Touch-downs: the normal velocities of all closed contacts that would close become zero, and
    /// friction acts up to µ times the normal impulse. One that has opened at the same instant is still
    /// there: else two that throw each other off would go on to do so.
    fn impact(&mut self, motion: &mut Motion, drive: &Drive) -> Result<(), StepFailure> {
        let Dynamics { contacts, multipliers, responses, .. } = &mut self.dynamics;
        for (i, contact) in contacts.iter().enumerate() {
            let state = motion.contacts[i];
            if self.events[i] == Some(Event::Touch) {
                self.closed[i] = frictionless(true);
                motion.statistics.touch_downs += u64::from(state == ContactState::Detached);
            }
            multipliers.freedom[i] = match self.closed[i] {
                ContactState::Detached => Freedom::Open,
                _ => Freedom::Law(drive.friction[i].range(state)),
            };
            let tangential = contact.tangent.dot(&motion.velocity) - self.surface[i];
            multipliers.free[i] = [contact.normal.dot(&motion.velocity), tangential];
        }
        motion.statistics.count_sweeps(multipliers.solve()?);
        for (impulse, responses) in multipliers.forces.iter().zip(&*responses) {
            for (&impulse, response) in impulse.iter().zip(responses) {
                response.add_to(&mut motion.velocity, impulse);
            }
        }
        self.stand(motion);
        Ok(())
    }

    /// Takes away what rounding has left of the gaps of contacts in an impact, and of the normal
    /// velocities of those that it does not throw off: it would be another touch-down where they open.
    fn stand(&mut self, motion: &mut Motion) {
        let least = THROWN * self.speed(motion);
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            let is_closed = self.closed[i] != ContactState::Detached;
            let is_kept = is_closed && contact.normal.dot(&motion.velocity) <= least;
            // Those that the impact has stopped have no slip either, not even that of rounding.
            self.kept[i] = match self.dynamics.multipliers.states[i] {
                ContactState::Stick if is_kept => ContactState::Stick,
                _ => frictionless(is_kept),
            };
        }
        if self.is_inclined {
            // All at once: what is taken from one is given to its neighbours.
            let (law, dynamics) = (&mut self.series.law, &self.dynamics);
            law.set(dynamics, &self.closed, &self.frictionless);
            law.mend_gaps(dynamics, &mut motion.displacement);
            law.set(dynamics, &self.kept, &self.frictionless);
            law.mend_velocities(dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            if let Some(dof) = contact.normal.as_unit() {
                if self.closed[i] != ContactState::Detached {
                    motion.displacement[dof] = 0.0;
                }
                if self.kept[i] != ContactState::Detached {
                    motion.velocity[dof] = 0.0;
                }
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), self.kept[i]) {
                motion.velocity[dof] = self.surface[i];
            }
        }
    }
}

/// A contact that nothing holds but its normal, or that is open.
fn frictionless(is_closed: bool) -> ContactState {
    if is_closed { ContactState::Slide } else { ContactState::Detached }
}

/// |G M⁻¹ K| along normal and tangent of each contact.
fn pulls(dynamics: &Dynamics) -> Vec<[Direction; 2]> {
    let dofs = dynamics.acceleration.len();
    let along = |response: &Direction| {
        let terms = response.0.iter().flat_map(|&(dof, response)| {
            dynamics.stiffness.row(dof).map(move |(other, k)| (other, 0, (response * k).abs()))
        });
        let column = SparseMatrix::from_entries(dofs, terms.collect());
        Direction(column.entries().map(|(dof, _, value)| (dof, value)).collect())
    };
    dynamics.responses.iter().map(|two| two.each_ref().map(along)).collect()
}

/// The largest of some values, by size: of velocities, the fastest.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
}

impl Integrator for EventDriven {
    fn advance(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        for _ in 0..count {
            self.step(motion, drive, step)?;
        }
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        drive: &Drive,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        if self.present_forces(motion, drive, forces) {
            return Ok(());
        }
        self.dynamics.contact_forces(motion, drive, forces)
    }

    fn set_damping(&mut self, damping: Damping) {
        if self.dynamics.damping != damping {
            self.dynamics.damping = damping;
            self.series.forget();
        }
    }
}
