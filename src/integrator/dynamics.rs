//! Equation of motion with contacts on sparse matrices, shared by the integrators for any structure.

use super::contact_problem::{
    ConstraintOf, ContactConstraint, ContactProblem, Delassus, constraint_of,
};
use super::per_mass::{PerMass, Strain};
use super::{AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Motion, StepFailure};
use crate::Error;
use crate::contact::{ContactForce, ContactLaw, ContactState};
use crate::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};

/// A slip velocity below this part of the slider's is rounding.
const ROUNDING: f64 = 1e-14;

/// M ẍ = F − C ẋ − K x + Gᵀ λ, with the contact problem that gives λ.
pub(super) struct Dynamics {
    pub(super) mass: SparseMatrix,
    pub(super) stiffness: SparseMatrix,
    pub(super) damping: Damping,
    pub(super) dampers: SparseMatrix,
    pub(super) contacts: Vec<Contact>,
    pub(super) law: ContactLaw,
    pub(super) constraint_of: ConstraintOf,
    pub(super) inverse_mass: SparseMatrix,
    /// M⁻¹ K and M⁻¹ D of a structure whose matrices are full.
    pub(super) per_mass: Option<PerMass>,
    /// M⁻¹ Gᵀ, one pair (normal, tangent) for each contact.
    pub(super) responses: Vec<[Direction; 2]>,
    /// The responses as the columns of one matrix, normal and tangent of each contact in turn, where there are many.
    pub(super) response_columns: Option<SparseMatrix>,
    pub(super) problem: ContactProblem,
    force: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
}

impl Dynamics {
    /// The equation of motion of this model.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is not positive definite.
    pub(super) fn new(model: &LumpedModel) -> Result<Self, Error> {
        let dofs = model.dofs();
        let inverse_mass = inverse(&model.mass).ok_or_else(|| {
            Error::scene("the mass matrix must be symmetric and positive definite")
        })?;
        // M⁻¹ is symmetric: its rows are its columns.
        let response = |direction: &Direction| {
            let parts = direction.0.iter().flat_map(|&(dof, value)| {
                inverse_mass.row(dof).map(move |(row, inverse)| (row, 0, inverse * value))
            });
            let column = SparseMatrix::from_entries(dofs, parts.collect());
            Direction(column.entries().map(|(row, _, value)| (row, value)).collect())
        };
        let responses: Vec<[Direction; 2]> = model
            .contacts
            .iter()
            .map(|contact| [response(&contact.normal), response(&contact.tangent)])
            .collect();
        let columns = || {
            let parts = responses.as_flattened().iter().enumerate();
            let entries = parts.flat_map(|(column, response)| {
                response.0.iter().map(move |&(row, value)| (row, column, value))
            });
            SparseMatrix::from_entries(dofs, entries.collect())
        };
        let has_many = inverse_mass.is_full() && model.contacts.len() > 1;
        let response_columns = has_many.then(columns);
        let delassus = Delassus::new(&model.contacts, &responses, dofs);
        Ok(Self {
            mass: model.mass.clone(),
            stiffness: model.stiffness.clone(),
            damping: model.damping,
            dampers: model.dampers.clone(),
            problem: ContactProblem::new(delassus),
            contacts: model.contacts.clone(),
            law: model.law,
            constraint_of: constraint_of(model.law),
            per_mass: PerMass::of(model, &inverse_mass),
            inverse_mass,
            responses,
            response_columns,
            force: vec![0.0; dofs],
            acceleration: vec![0.0; dofs],
        })
    }

    /// The largest magnitude of acceleration, m/s², that these forces (N) alone give a degree of freedom.
    pub(super) fn fastest_driven(&self, force: &[f64]) -> f64 {
        let mut fastest = 0.0;
        self.inverse_mass
            .each_product(force, |_, driven| fastest = f64::max(fastest, driven.abs()));
        fastest
    }

    /// The acceleration without contact forces, M⁻¹ (F − C ẋ − K x), under the outer forces F.
    pub(super) fn free_acceleration(&mut self, motion: &Motion, outer: &[f64]) {
        let Damping { alpha, beta } = self.damping;
        let (x, v) = (&motion.displacement, &motion.velocity);
        let Self { force, acceleration, .. } = self;
        // Until it is known, the acceleration is memory for what the springs act on.
        for ((stretch, x), v) in acceleration.iter_mut().zip(x).zip(v) {
            *stretch = x + beta * v;
        }
        if let Some(per_mass) = &self.per_mass {
            force.copy_from_slice(acceleration);
            self.inverse_mass.each_product(outer, |row, driven| acceleration[row] = driven);
            per_mass.subtract(Strain { stretch: force, velocity: v, alpha }, acceleration);
            return;
        }
        self.stiffness.each_product(acceleration, |row, springs| force[row] = outer[row] - springs);
        self.mass.each_product(v, |row, momentum| force[row] -= alpha * momentum);
        if !self.dampers.is_empty() {
            self.dampers.each_product(v, |row, damped| force[row] -= damped);
        }
        self.inverse_mass.each_product(force, |row, driven| acceleration[row] = driven);
    }

    /// Counts, if the law of contact is reduced, the contacts that would have needed the omitted parts with the
    /// velocities and multipliers at the end of a step.
    pub(super) fn count_broken(&self, motion: &mut Motion, velocity: &[f64], inputs: &Inputs) {
        let (has_direction, detachment) = (self.law.has_fixed_direction(), self.law.detachment);
        for (i, contact) in self.contacts.iter().enumerate() {
            let surface = inputs.slider_velocity[i];
            let slip = surface - contact.tangent.dot(velocity);
            let is_closed = motion.contacts[i] != ContactState::Detached;
            let is_reversed = has_direction && is_closed && slip * surface < 0.0;
            let is_pulled = !detachment && self.problem.forces[i][0] < 0.0;
            motion.statistics.reversed_slips += u64::from(is_reversed);
            motion.statistics.pulled_contacts += u64::from(is_pulled);
        }
    }

    /// Computes the response to forces on the masses of contacts that keep their states.
    ///
    /// # Errors
    /// Returns the contact that could not be solved.
    pub(super) fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        self.accelerate_freely(load, response);
        for (i, contact) in self.contacts.iter().enumerate() {
            self.problem.constraints[i] = match held.states[i] {
                ContactState::Detached => ContactConstraint::Open,
                ContactState::Stick => ContactConstraint::Fixed,
                state => ContactConstraint::Guided { slope: held.slopes[i], state },
            };
            self.problem.free[i] = [
                contact.normal.dot(&response.acceleration),
                contact.tangent.dot(&response.acceleration) - load.slider_acceleration[i],
            ];
        }
        self.problem.solve(held.states)?;
        response.forces.copy_from_slice(&self.problem.forces);
        self.add_contact_accelerations(response);
        Ok(())
    }

    /// Writes the accelerations without contact forces.
    pub(super) fn accelerate_freely(
        &self,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) {
        let acceleration = &mut response.acceleration;
        self.inverse_mass.each_product(load.force, |row, driven| acceleration[row] = driven);
    }

    /// Adds M⁻¹ Gᵀ λ to `vector`; zero multipliers are skipped.
    pub(super) fn add_responses(&self, multipliers: &[[f64; 2]], vector: &mut [f64]) {
        if let Some(columns) = &self.response_columns {
            return columns.add_product(multipliers.as_flattened(), vector);
        }
        for (forces, responses) in multipliers.iter().zip(&self.responses) {
            for (&force, response) in forces.iter().zip(responses) {
                if force != 0.0 {
                    response.add_to(vector, force);
                }
            }
        }
    }

    /// Adds to the accelerations those that the contact forces cause.
    pub(super) fn add_contact_accelerations(&self, response: &mut ConstrainedResponse) {
        for (forces, responses) in response.forces.iter().zip(&self.responses) {
            for (&force, direction) in forces.iter().zip(responses) {
                direction.add_to(&mut response.acceleration, force);
            }
        }
    }

    /// The contact forces at the present instant.
    ///
    /// # Errors
    /// Returns the contact that could not be solved.
    pub(super) fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.contact_forces_from(&motion.contacts, motion, inputs, forces)
    }

    /// The contact forces at the present instant, starting from these contact states; see
    /// [`contact_forces`](Self::contact_forces).
    ///
    /// # Errors
    /// Returns the contact that could not be solved.
    pub(super) fn contact_forces_from(
        &mut self,
        states: &[ContactState],
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.free_acceleration(motion, &inputs.force);
        for (i, contact) in self.contacts.iter().enumerate() {
            let slip = inputs.slider_velocity[i] - contact.tangent.dot(&motion.velocity);
            let before = if slip == 0.0 { ContactState::Stick } else { states[i] };
            let held =
                (self.constraint_of)(inputs.friction[i], slip, inputs.slider_velocity[i], before);
            let slipping = |direction| held.slipping(direction);
            self.problem.constraints[i] = match (states[i], states[i].sliding_direction()) {
                (ContactState::Detached, _) => ContactConstraint::Open,
                (ContactState::Stick, _) => held,
                _ if slip == 0.0 => held,
                // A slip of rounding does not reverse the state; a slider whose velocity was changed does.
                (_, Some(direction))
                    if slip.abs() <= ROUNDING * inputs.slider_velocity[i].abs() =>
                {
                    slipping(direction)
                }
                _ => slipping(slip.signum()),
            };
            self.problem.free[i] = [
                contact.normal.dot(&self.acceleration),
                contact.tangent.dot(&self.acceleration) - inputs.slider_acceleration[i],
            ];
        }
        if self.law.follows_size() {
            self.problem.pulls.copy_from_slice(&motion.pulls);
        }
        self.problem.solve(states)?;
        for (i, out) in forces.iter_mut().enumerate() {
            let [normal_force, friction_force] = self.problem.forces[i];
            let slip = match states[i] {
                ContactState::Stick => 0.0,
                _ => inputs.slider_velocity[i] - self.contacts[i].tangent.dot(&motion.velocity),
            };
            *out = ContactForce {
                state: self.problem.states[i],
                normal_force,
                // A force of zero has no negative sign.
                friction_force: friction_force + 0.0,
                slip_velocity: slip,
            };
        }
        Ok(())
    }
}

/// The inverse of a mass matrix; `None` if it is not positive definite.
fn inverse(matrix: &SparseMatrix) -> Option<SparseMatrix> {
    match matrix.as_diagonal() {
        Some(masses) => masses.iter().all(|&mass| mass > 0.0).then(|| {
            SparseMatrix::diagonal(&masses.iter().map(|mass| 1.0 / mass).collect::<Vec<_>>())
        }),
        None => full_inverse(matrix),
    }
}

/// The inverse through Cholesky's factors, for small matrices; `None` if not positive definite.
fn full_inverse(matrix: &SparseMatrix) -> Option<SparseMatrix> {
    let n = matrix.rows();
    let mut lower = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known = (0..j).fold(0.0, |sum, k| sum + lower[i * n + k] * lower[j * n + k]);
            let rest = matrix.get(i, j) - known;
            lower[i * n + j] = if i != j {
                rest / lower[j * n + j]
            } else if rest > 0.0 {
                rest.sqrt()
            } else {
                return None;
            };
        }
    }
    let mut inverse = Vec::with_capacity(n * n);
    for column in 0..n {
        let mut x = vec![0.0; n];
        x[column] = 1.0;
        for i in 0..n {
            let known = (0..i).fold(0.0, |sum, k| sum + lower[i * n + k] * x[k]);
            x[i] = (x[i] - known) / lower[i * n + i];
        }
        for i in (0..n).rev() {
            let known = (i + 1..n).fold(0.0, |sum, k| sum + lower[k * n + i] * x[k]);
            x[i] = (x[i] - known) / lower[i * n + i];
        }
        inverse.extend(x.into_iter().enumerate().map(|(row, value)| (row, column, value)));
    }
    Some(SparseMatrix::from_entries(n, inverse))
}
