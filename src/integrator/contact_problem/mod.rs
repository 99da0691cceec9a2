//! The contact problem a = W λ + free, under the law of every contact: for the forces of a step, the impulses of an
//! impact, and the accelerations of an instant.
//!
//! A contact that shares no mass with others is solved in closed form. For a group that shares masses these methods are
//! tried in turn, until one gives forces that obey the law:
//!
//! 1. the states that the contacts are in, as linear equations, if no inequality of the law is at its limit: where
//!    the law has several solutions, the motion stays in its own;
//! 2. Gauss–Seidel over the contacts (paper, eqs. 19–24), from zero, for up to 200 iterations, until no force changes
//!    by more than 1e-13 of the largest one;
//! 3. the states that Gauss–Seidel has reached, as linear equations;
//! 4. Lemke's pivots on the linear complementarity problem ([`lemke`]); for contacts held in both directions, repairs
//!    of the states in 3;
//! 5. all states ([`enumeration`]): where none has forces, there are none. With more states than those of eight
//!    contacts the search may take too long, and is given up;
//! 6. Gauss–Seidel, with a large number of iterations.
//!
//! Only the last two report that contacts cannot be solved, and only the fifth proves that no forces exist: a contact
//! that jams in an iteration may be free under other forces of its neighbours. If the only forces are rounding, since
//! the equations are singular, the fifth proves nothing and reports [`StepFailure::Singular`].

mod constraint;
mod delassus;
mod enumeration;
mod factors;
mod given_states;
mod inside;
mod lemke;
mod others;
mod states;
#[cfg(test)]
mod tests;

use crate::contact::{ContactState, LocalSolution};
use crate::integrator::StepFailure;
pub(super) use constraint::{ConstraintOf, ContactConstraint, constraint_of};
pub(super) use delassus::Delassus;
use enumeration::{LinearProgram, Search};
pub(super) use given_states::{GivenStates, StateEquations};
use lemke::Pivots;
use others::OtherSolutions;
use states::{Acceleration, Strictness};

/// Convergence check (24): the largest change of a multiplier in an iteration relative to the largest one.
const TOLERANCE: f64 = 1e-13;
/// Number of iterations after which Gauss–Seidel counts as slow.
const FEW_SWEEPS: u64 = 200;
/// Largest number of iterations.
const MAX_SWEEPS: u64 = 10_000;
/// Relative tolerances of the law where forces are computed directly, in parts of the terms that cause rounding: the
/// first is tried first, the second where W is nearly singular.
const MISSES: [f64; 2] = [1e-13, 1e-11];

/// The contact problem of a structure.
///
/// λ holds (N, T) of each contact, N. W = G M⁻¹ Gᵀ is the Delassus matrix, 1/kg.
pub(super) struct ContactProblem {
    pub(super) delassus: Delassus,
    /// The accelerations that the contacts would have without their forces, m/s².
    pub(super) free: Vec<[f64; 2]>,
    /// The constraint of each contact: its law, or one of its states.
    pub(super) constraints: Vec<ContactConstraint>,
    /// The solution λ.
    pub(super) forces: Vec<[f64; 2]>,
    /// The states that belong to the solution.
    pub(super) states: Vec<ContactState>,
    /// `true` for each contact held in both directions whose equations are those of one that pulls: friction follows
    /// |N|. A solution begins with the given signs and replaces them.
    pub(super) pulls: Vec<bool>,
    /// `true` once forces that obey the law were rejected in this solution, since they are rounding only.
    has_blurred: bool,
    pub(super) given: GivenStates,
    /// Memory for accelerations, corrections of forces, the forces of the iterations, and accelerations without contact
    /// forces.
    accelerations: Vec<Acceleration>,
    corrections: Vec<[f64; 2]>,
    swept: Vec<[f64; 2]>,
    unpressed: Vec<[f64; 2]>,
    lemke: Pivots,
    enumeration: LinearProgram,
    others: OtherSolutions,
}

/// Result of Gauss–Seidel.
enum GaussSeidelResult {
    /// Converged after this number of iterations.
    Converged(u64),
    /// Not converged within the given number of iterations.
    NotYet,
    /// A contact could not be solved by itself, or its force left the range of numbers.
    Failed(StepFailure),
}

impl ContactProblem {
    pub(super) fn new(delassus: Delassus) -> Self {
        let contacts = delassus.contacts();
        let largest = delassus.largest_group();
        Self {
            has_blurred: false,
            given: GivenStates::new(&delassus),
            others: OtherSolutions::with_room(contacts, delassus.groups().len()),
            lemke: Pivots::with_room(largest),
            enumeration: LinearProgram::with_room(largest),
            delassus,
            free: vec![[0.0; 2]; contacts],
            constraints: vec![ContactConstraint::Open; contacts],
            forces: vec![[0.0; 2]; contacts],
            states: vec![ContactState::Detached; contacts],
            pulls: vec![false; contacts],
            accelerations: vec![Acceleration::default(); contacts],
            corrections: vec![[0.0; 2]; contacts],
            swept: vec![[0.0; 2]; contacts],
            unpressed: vec![[0.0; 2]; contacts],
        }
    }

    /// `true` for each contact of a group that cannot all stick for arbitrary surface motions: the contacts hold more
    /// directions than their masses have.
    pub(super) fn overheld(&mut self) -> Vec<bool> {
        let Self { given, delassus, .. } = self;
        let mut is_overheld = vec![false; delassus.contacts()];
        for (group, contacts) in delassus.groups().iter().enumerate() {
            given.set(delassus, group, |_| StateEquations::Both);
            contacts.iter().for_each(|&contact| is_overheld[contact] = !given.is_regular(group));
        }
        is_overheld
    }

    /// Solves for λ, starting from these contact states; returns the number of iterations. The result depends only on
    /// the present problem, which includes the signs of contacts that are held in both directions (`pulls`). Redundant
    /// contacts (two that stick on one mass) have many solutions; the motion is the same for all.
    ///
    /// The load of a contact depends on the contacts that slip beside it, so static friction comes first: all are
    /// solved with their ranges as the limit, then those that slip even so with µ_k against it, and all again. They may
    /// then stick, or slip the other way: the load that they release acts on others, which push them back.
    ///
    /// # Errors
    /// Returns an error if contacts have no forces under their law, or if none were found.
    #[inline]
    pub(super) fn solve(&mut self, present: &[ContactState]) -> Result<u64, StepFailure> {
        let mut sweeps = 1;
        for group in 0..self.given.groups() {
            match self.delassus.groups()[group][..] {
                [contact] => self.solve_alone(contact)?,
                _ => sweeps = sweeps.max(self.solve_group(group, present)?),
            }
        }
        Ok(sweeps)
    }

    /// Solves a contact that shares no mass with others.
    #[inline]
    fn solve_alone(&mut self, contact: usize) -> Result<(), StepFailure> {
        loop {
            self.forces[contact] = [0.0; 2];
            match self.solve_one(contact, 1) {
                Ok((force, state)) => {
                    (self.forces[contact], self.states[contact]) = (force, state);
                    self.pulls[contact] = self.is_held(contact) && force[0] < 0.0;
                    if !self.release_to_kinetic_friction(contact) {
                        return Ok(());
                    }
                }
                // Static friction that jams a contact is replaced by kinetic friction.
                Err(failure) if !self.release_both_directions(contact) => return Err(failure),
                Err(_) => {}
            }
        }
    }

    fn solve_group(&mut self, group: usize, present: &[ContactState]) -> Result<u64, StepFailure> {
        for &contact in &self.delassus.groups()[group] {
            self.states[contact] = present[contact];
            if !self.free[contact].iter().all(|free| free.is_finite()) {
                return Err(StepFailure::NotFinite { contact });
            }
        }
        let mut sweeps = 0;
        self.has_blurred = false;
        loop {
            let (solved, release): (_, fn(&mut Self, usize) -> bool) =
                match self.solve_group_once(group) {
                    Ok(taken) => (Ok(taken), Self::release_to_kinetic_friction),
                    Err(failure) => (Err(failure), Self::release_both_directions),
                };
            let mut any = false;
            for place in 0..self.delassus.groups()[group].len() {
                any |= release(self, self.delassus.groups()[group][place]);
            }
            match solved {
                Ok(taken) => sweeps += taken,
                Err(failure) if !any => return Err(failure),
                Err(_) => {}
            }
            if !any {
                self.take_signs(group);
                return Ok(sweeps);
            }
        }
    }

    /// Replaces the static limit of a contact that slips by its kinetic friction in that direction; `true` if that
    /// changes the limit. A contact has two limits, so this ends.
    fn release_to_kinetic_friction(&mut self, contact: usize) -> bool {
        let direction = self.states[contact].sliding_direction();
        direction.is_some_and(|direction| {
            self.constraints[contact].release_to_kinetic_friction(direction)
        })
    }

    /// Replaces the static limits of a contact by its kinetic friction in both directions; `true` if that changes a
    /// limit.
    fn release_both_directions(&mut self, contact: usize) -> bool {
        let constraint = &mut self.constraints[contact];
        constraint.release_to_kinetic_friction(1.0) | constraint.release_to_kinetic_friction(-1.0)
    }

    /// Solves a group once, with the present limits, from the present states.
    fn solve_group_once(&mut self, group: usize) -> Result<u64, StepFailure> {
        if self.solve_states(group, Strictness::Inside) {
            return Ok(1);
        }
        match self.sweep(group, FEW_SWEEPS) {
            GaussSeidelResult::Converged(sweeps) => Ok(sweeps),
            GaussSeidelResult::NotYet => self.solve_at_once(group),
            GaussSeidelResult::Failed(failure @ StepFailure::NotFinite { .. }) => Err(failure),
            GaussSeidelResult::Failed(_) => self.solve_at_once(group),
        }
    }

    /// Solves a group for which Gauss–Seidel does not converge: states as equations, pivots, enumeration.
    #[cold]
    fn solve_at_once(&mut self, group: usize) -> Result<u64, StepFailure> {
        let has_held = self.has_held(group);
        self.take_signs(group);
        for missed in MISSES {
            let strictness = Strictness::UpTo(missed);
            let is_solved = self.solve_states(group, strictness)
                || if has_held {
                    self.correct_states(group, strictness)
                } else {
                    self.pivot(group, strictness)
                };
            if is_solved {
                return Ok(FEW_SWEEPS);
            }
        }
        for missed in MISSES {
            match self.enumerate(group, Strictness::UpTo(missed)) {
                Search::Found => return Ok(FEW_SWEEPS),
                Search::Nothing if missed == MISSES[1] => {
                    let contact = self.most_pressed(group);
                    return Err(if self.has_blurred {
                        StepFailure::Singular { contact }
                    } else {
                        StepFailure::Wedged { contact }
                    });
                }
                Search::Nothing => {}
                Search::Unfinished => break,
            }
        }
        match self.sweep(group, MAX_SWEEPS) {
            GaussSeidelResult::Converged(sweeps) => Ok(sweeps),
            GaussSeidelResult::NotYet => Err(unproven(self.unsettled(group))),
            GaussSeidelResult::Failed(failure) => Err(unproven(failure)),
        }
    }

    /// The contact of a group that closes fastest without contact forces.
    fn most_pressed(&self, group: usize) -> usize {
        let contacts = self.delassus.groups()[group].iter().copied();
        contacts.min_by(|&a, &b| self.free[a][0].total_cmp(&self.free[b][0])).unwrap_or(0)
    }

    /// Sets the forces of a group to zero.
    fn clear(&mut self, group: usize) {
        for &contact in &self.delassus.groups()[group] {
            self.forces[contact] = [0.0; 2];
        }
    }

    /// Runs Gauss–Seidel over a group, from zero, for up to `most` iterations. A converged solution is polished.
    fn sweep(&mut self, group: usize, most: u64) -> GaussSeidelResult {
        self.clear(group);
        for sweep in 1..=most {
            match self.sweep_once(group, sweep) {
                Ok([change, largest]) if change <= TOLERANCE * largest => {
                    self.polish(group);
                    return GaussSeidelResult::Converged(sweep);
                }
                Ok(_) => {}
                Err(failure) => return GaussSeidelResult::Failed(failure),
            }
        }
        GaussSeidelResult::NotYet
    }

    /// Runs one iteration; returns the largest change of a multiplier, N, and the largest multiplier, N.
    fn sweep_once(&mut self, group: usize, sweep: u64) -> Result<[f64; 2], StepFailure> {
        let (mut change, mut largest) = (0.0_f64, f64::MIN_POSITIVE);
        for place in 0..self.delassus.groups()[group].len() {
            let contact = self.delassus.groups()[group][place];
            let (force, state) = self.solve_one(contact, sweep)?;
            self.states[contact] = state;
            for (old, new) in self.forces[contact].iter_mut().zip(force) {
                change = change.max((new - *old).abs());
                largest = largest.max(new.abs());
                *old = new;
            }
        }
        Ok([change, largest])
    }

    /// Finds the contact that has not converged by one more iteration, so that solutions that converge need not track
    /// it.
    #[cold]
    fn unsettled(&mut self, group: usize) -> StepFailure {
        let (mut unsettled, mut change, mut largest) = (0, 0.0_f64, f64::MIN_POSITIVE);
        for place in 0..self.delassus.groups()[group].len() {
            let contact = self.delassus.groups()[group][place];
            let force = match self.solve_one(contact, MAX_SWEEPS) {
                Ok((force, _)) => force,
                Err(failure) => return failure,
            };
            for (old, new) in self.forces[contact].iter_mut().zip(force) {
                largest = largest.max(new.abs());
                if (new - *old).abs() > change {
                    (unsettled, change) = (contact, (new - *old).abs());
                }
                *old = new;
            }
        }
        StepFailure::NoConvergence {
            sweeps: MAX_SWEEPS,
            contact: unsettled,
            change: change / largest,
            tolerance: TOLERANCE,
        }
    }

    /// Solves eqs. (19)–(21) for one contact in this iteration, with the forces of the others held; returns its force
    /// and its state.
    #[inline]
    fn solve_one(
        &self,
        contact: usize,
        sweep: u64,
    ) -> Result<([f64; 2], ContactState), StepFailure> {
        let local = self.delassus.local(contact);
        let [mut normal, mut tangential] = self.free[contact];
        for &(other, w) in self.delassus.others(contact) {
            let [n, t] = self.forces[other];
            normal += w[0] * n + w[1] * t;
            tangential += w[2] * n + w[3] * t;
        }
        let solution = match &self.constraints[contact] {
            ContactConstraint::Law(range) => local.solve([normal, tangential], range),
            ContactConstraint::Open => Some(LocalSolution::OPEN),
            &ContactConstraint::Slipping { direction, friction } => {
                local.slide(normal, friction, direction)
            }
            ContactConstraint::Held(range) => local.solve_held([normal, tangential], range),
            &ContactConstraint::HeldSlipping { direction, friction } => {
                local.slide_held(normal, friction, direction)
            }
            ContactConstraint::Fixed => Some(local.fix([normal, tangential])),
            &ContactConstraint::Guided { slope, state } => local.guide(normal, slope, state),
        };
        if !(normal.is_finite() && tangential.is_finite()) {
            return Err(self.out_of_range(contact, sweep));
        }
        let LocalSolution { force, state } = solution.ok_or(StepFailure::Wedged { contact })?;
        if !force.iter().all(|force| force.is_finite()) {
            return Err(self.out_of_range(contact, sweep));
        }
        Ok((force, state))
    }

    /// The reason why a force is not finite: the acceleration of the contact is not, or the iterations diverge.
    #[cold]
    fn out_of_range(&self, contact: usize, sweeps: u64) -> StepFailure {
        if !self.free[contact].iter().all(|free| free.is_finite()) {
            return StepFailure::NotFinite { contact };
        }
        let (change, tolerance) = (f64::INFINITY, TOLERANCE);
        StepFailure::NoConvergence { sweeps, contact, change, tolerance }
    }
}

/// The failure to report where iterations end without forces. A contact that jams in an iteration does not prove that
/// there are no forces.
fn unproven(failure: StepFailure) -> StepFailure {
    match failure {
        StepFailure::Wedged { contact } => StepFailure::NoneFound { contact },
        failure => failure,
    }
}
