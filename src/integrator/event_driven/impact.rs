//! Instants at which velocities end or jump: slips that stop, and impacts.
//!
//! # Law of impact
//!
//! With the relative velocities u = (G_N ẋ, G_T ẋ − v) of the contacts that take part, before (−) and after (+),
//! impulses Λ (N s) are sought such that
//!
//! ```text
//! u⁺ = u⁻ + W Λ,   ẋ⁺ = ẋ⁻ + M⁻¹ Gᵀ Λ,
//! 0 ≤ u_N⁺ ⊥ Λ_N ≥ 0,
//! |Λ_T| ≤ µ Λ_N where u_T⁺ = 0,   Λ_T = −sign(u_T⁺) µ_k Λ_N elsewhere.
//! ```
//!
//! This is Newton's law without restitution, and Coulomb's law with the slip after the impact. The limit µ of a
//! contact that does not slip afterwards depends on its state before: µ_s where it stuck, µ_k where it was open;
//! where it slipped, µ_k in the direction that friction had and µ_s in the other one. The kinetic energy changes by
//! Λᵀ (u⁺ + u⁻)/2 = Λᵀ u⁺ − Λᵀ W Λ/2 ≤ 0 if surfaces are at rest; a surface that moves adds v Λ_T. Under a law
//! without sticking Λ_T = σ µ_k Λ_N in the fixed direction σ, whatever the slip is, and this does not hold.
//!
//! # Contacts that take part
//!
//! All that were closed at some time of this instant, those that land, and those that share masses with one that
//! lands and whose gap is rounding: up to 1e-13 of Σ |n_j x_j| + V / ω, with the terms n_j x_j of the gap, the
//! fastest velocity V and the time scale 1/ω of [`shortest`](super::rounding::shortest). If no forces are found with
//! the last ones, they are left out. If none of the contacts approaches by more than 1e-13 of the fastest velocity,
//! there are no impulses.
//!
//! Afterwards a contact that takes part is open if u_N⁺ is above the budget of [`least_hop`], else its u_N becomes
//! zero.

use super::ledger::{Impact, MotionObserver};
use super::rounding::{NOISE, THROWN, landings_together, least_hop};
use super::watch::Event;
use super::{EventDriven, Motion, StepFailure};
use crate::contact::ContactState;
use crate::integrator::contact_problem::ContactConstraint;
use crate::integrator::dynamics::Dynamics;
use crate::numerics::max_norm;

impl<W: MotionObserver> EventDriven<W> {
    /// Sets the slip velocities that stop to zero: a remainder of rounding would have a direction.
    pub(super) fn stop(&mut self, motion: &mut Motion) {
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
            law.project_velocities(&self.dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, event) in self.events.iter().enumerate() {
            if let (true, Some(dof)) = (stops(event), self.dynamics.contacts[i].tangent.as_unit()) {
                motion.velocity[dof] = self.surface[i];
            }
        }
    }

    /// Solves the impact of touch-downs ([module](self)). A contact that has opened at the same instant takes part:
    /// otherwise two contacts could throw each other off without an end. `speed` (m/s) is the fastest velocity before.
    ///
    /// A contact whose gap is rounding and that takes an impulse counts as a landing. Where the solver finds no
    /// impulses with such contacts, it solves without them; they then have an impact of their own.
    pub(super) fn impact(&mut self, motion: &mut Motion, speed: f64) -> Result<(), StepFailure> {
        for (closed, event) in self.closed.iter_mut().zip(&self.events) {
            if *event == Some(Event::Touch) {
                *closed = frictionless(true);
            }
        }
        self.kept.clone_from(&self.closed);
        self.close_what_touches(motion, speed);
        let sweeps = match self.solve_impact(motion, speed) {
            Err(_) if self.closed != self.kept => {
                self.closed.clone_from(&self.kept);
                self.solve_impact(motion, speed)
            }
            solved => solved,
        }?;
        let Dynamics { problem, responses, .. } = &mut self.dynamics;
        motion.statistics.count_sweeps(sweeps);
        motion.statistics.other_solutions += u64::from(problem.has_another_solution());
        for (i, [normal, tangential]) in problem.forces.iter().enumerate() {
            let own = problem.delassus.own(i);
            let is_something = own[0] * normal + own[1].abs() * tangential.abs() > NOISE * speed;
            let was_open = motion.contacts[i] == ContactState::Detached;
            let is_closed = self.closed[i] != ContactState::Detached;
            if self.events[i].is_none() && was_open && is_closed && is_something {
                self.events[i] = Some(Event::Touch);
                self.repeats[i] += 1;
            }
            if self.events[i] == Some(Event::Touch) {
                motion.statistics.touch_downs += u64::from(was_open);
                self.landings[i] += 1;
            } else {
                // A contact that only touches and takes no impulse has no part in the impact.
                self.closed[i] = self.kept[i];
            }
        }
        for (impulse, responses) in problem.forces.iter().zip(&*responses) {
            for (&impulse, response) in impulse.iter().zip(responses) {
                response.add_to(&mut motion.velocity, impulse);
            }
        }
        let Self { observer, dynamics, surface, .. } = self;
        observer.is_struck(Impact { dynamics, surface }, motion);
        self.stabilise_after_impact(motion, speed);
        Ok(())
    }

    /// Adds to the closed contacts those that share masses with one that lands, and whose gaps are rounding only.
    fn close_what_touches(&mut self, motion: &Motion, speed: f64) {
        let Dynamics { contacts, problem, .. } = &self.dynamics;
        for group in problem.delassus.groups() {
            if !group.iter().any(|&i| self.events[i] == Some(Event::Touch)) {
                continue;
            }
            for &i in group {
                let contact = &contacts[i];
                let terms = contact.normal.0.iter();
                let terms = terms.map(|&(dof, n)| (n * motion.displacement[dof]).abs());
                let length =
                    terms.fold(contact.gap + speed * self.shortest, |sum, term| sum + term);
                if contact.gap_at(&motion.displacement).abs() <= NOISE * length {
                    self.closed[i] = frictionless(true);
                }
            }
        }
    }

    /// Solves for the impulses of the closed contacts; returns the number of iterations. There are no impulses where
    /// contacts approach by rounding only: beside a surface that moves, a solver finds impulses of any size for it.
    fn solve_impact(&mut self, motion: &Motion, speed: f64) -> Result<u64, StepFailure> {
        let Dynamics { contacts, problem, constraint_of, law, .. } = &mut self.dynamics;
        let surfaces = if law.has_fixed_state() { &self.heading } else { &self.surface };
        for (i, contact) in contacts.iter().enumerate() {
            let tangential = contact.tangent.dot(&motion.velocity) - self.surface[i];
            problem.constraints[i] = match self.closed[i] {
                ContactState::Detached => ContactConstraint::Open,
                _ => constraint_of(self.friction[i], -tangential, surfaces[i], motion.contacts[i]),
            };
            problem.free[i] = [contact.normal.dot(&motion.velocity), tangential];
        }
        let nothing = NOISE * speed.max(max_norm(&self.surface));
        let closed = |i: &usize| self.closed[*i] != ContactState::Detached;
        if (0..contacts.len()).filter(closed).all(|i| problem.free[i][0] >= -nothing) {
            problem.forces.fill([0.0; 2]);
            problem.states.clone_from(&motion.contacts);
            return Ok(0);
        }
        problem.solve(&motion.contacts)
    }

    /// Removes the gaps that rounding has left at contacts in an impact, and the normal velocities of those that it
    /// does not throw off: a hop of theirs would be rounding, or one of many ([`least_hop`]).
    pub(super) fn stabilise_after_impact(&mut self, motion: &mut Motion, speed: f64) {
        let mut ended = 0;
        let Dynamics { contacts, problem, .. } = &self.dynamics;
        for group in problem.delassus.groups() {
            let together = landings_together(group.iter().map(|&i| self.landings[i]));
            for &i in group {
                let is_closed = self.closed[i] != ContactState::Detached;
                let opening = contacts[i].normal.dot(&motion.velocity);
                let least = least_hop(self.landings[i].max(together));
                let is_kept = is_closed && opening <= least * speed;
                ended += u64::from(is_kept && opening > THROWN * speed);
                // Contacts that the impact has stopped have no slip either, not even that of rounding.
                self.kept[i] = match problem.states[i] {
                    ContactState::Stick if is_kept => ContactState::Stick,
                    _ => frictionless(is_kept),
                };
            }
        }
        motion.statistics.ended_hops += ended;
        if ended > 0 {
            self.observer.sees_hops_end(motion, 1.0);
        }
        if self.is_inclined {
            // All contacts at once: a correction of one contact changes its neighbours.
            let (law, dynamics) = (&mut self.series.law, &self.dynamics);
            law.set(dynamics, &self.closed, &self.frictionless);
            law.project_positions(dynamics, &mut motion.displacement);
            law.set(dynamics, &self.kept, &self.frictionless);
            law.project_velocities(dynamics, &self.surface, &mut motion.velocity);
        }
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            if let Some(dof) = contact.normal.as_unit() {
                if self.closed[i] != ContactState::Detached {
                    motion.displacement[dof] = contact.closed_place();
                }
                if self.kept[i] != ContactState::Detached {
                    motion.velocity[dof] = 0.0;
                }
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), self.kept[i]) {
                motion.velocity[dof] = self.surface[i];
            }
        }
        if ended > 0 {
            self.observer.sees_hops_end(motion, -1.0);
        }
    }
}

/// State of a contact that is held along its normal only, or open.
pub(super) fn frictionless(is_closed: bool) -> ContactState {
    if is_closed { ContactState::Slide } else { ContactState::Detached }
}
