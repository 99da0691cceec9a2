//! The scheme on a model of any structure: any mass matrix, contacts in any directions.

use super::delassus::Delassus;
use super::multipliers::{Freedom, Multipliers};
use crate::Error;
use crate::contact::{ContactForce, ContactState};
use crate::integrator::{Drive, Integrator, Motion, StepFailure};
use crate::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};

/// Forward increment Lagrange multipliers on sparse matrices: a step costs as much as M, K and D have
/// entries, and the contacts that share masses.
pub struct SparseForwardIncrement {
    mass: SparseMatrix,
    stiffness: SparseMatrix,
    damping: Damping,
    dampers: SparseMatrix,
    contacts: Vec<Contact>,
    inverse_mass: SparseMatrix,
    /// M⁻¹ Gᵀ, one pair (normal, tangent) a contact.
    responses: Vec<[Direction; 2]>,
    multipliers: Multipliers,
    force: Vec<f64>,
    acceleration: Vec<f64>,
}

impl SparseForwardIncrement {
    /// The integrator for this model.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite.
    pub fn new(model: &LumpedModel) -> Result<Self, Error> {
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
        let delassus = Delassus::new(&model.contacts, &responses, dofs);
        Ok(Self {
            mass: model.mass.clone(),
            stiffness: model.stiffness.clone(),
            damping: model.damping,
            dampers: model.dampers.clone(),
            multipliers: Multipliers::new(delassus),
            contacts: model.contacts.clone(),
            inverse_mass,
            responses,
            force: vec![0.0; dofs],
            acceleration: vec![0.0; dofs],
        })
    }

    /// The acceleration without contact forces, M⁻¹ (F − C ẋ − K x).
    fn free_acceleration(&mut self, motion: &Motion, drive: &Drive) {
        let Damping { alpha, beta } = self.damping;
        let (x, v) = (&motion.displacement, &motion.velocity);
        for (row, force) in self.force.iter_mut().enumerate() {
            let springs = self
                .stiffness
                .row(row)
                .fold(0.0, |sum, (column, k)| sum + k * (x[column] + beta * v[column]));
            *force = drive.force[row] - springs - alpha * self.mass.row_times(row, v);
        }
        if !self.dampers.is_empty() {
            for (row, force) in self.force.iter_mut().enumerate() {
                *force -= self.dampers.row_times(row, v);
            }
        }
        for (row, acceleration) in self.acceleration.iter_mut().enumerate() {
            *acceleration = self.inverse_mass.row_times(row, &self.force);
        }
    }

    fn step(&mut self, motion: &mut Motion, drive: &Drive, h: f64) -> Result<(), StepFailure> {
        self.free_acceleration(motion, drive);
        for (i, contact) in self.contacts.iter().enumerate() {
            let normal = contact.normal.dot(&motion.velocity);
            let slip = contact.tangent.dot(&motion.velocity) - drive.slider_velocity[i];
            // A closed contact has no gap: a rounding error of one would be an impulse gap/h.
            let gap = match motion.contacts[i] {
                // Below zero it is what rounding leaves when a contact opens.
                ContactState::Detached => contact.normal.dot(&motion.displacement).max(0.0),
                _ => 0.0,
            };
            self.multipliers.freedom[i] = Freedom::Any;
            self.multipliers.free[i] = [
                contact.normal.dot(&self.acceleration) + (normal + gap / h) / h,
                contact.tangent.dot(&self.acceleration) + slip / h,
            ];
        }
        let sweeps = self.multipliers.solve(&drive.friction_coefficient)?;
        let statistics = &mut motion.statistics;
        statistics.steps += 1;
        statistics.sweeps += sweeps;
        statistics.most_sweeps = statistics.most_sweeps.max(sweeps);

        for (force, responses) in self.multipliers.forces.iter().zip(&self.responses) {
            for (&force, response) in force.iter().zip(responses) {
                response.add_to(&mut self.acceleration, force);
            }
        }
        for (v, a) in motion.velocity.iter_mut().zip(&self.acceleration) {
            *v += h * a;
        }
        self.settle(motion, drive, h);
        Ok(())
    }

    /// Moves the masses on; where a contact lies along a degree of freedom, its gap and its slip
    /// become exact zeros, so that the tolerance of the multipliers leaves no drift.
    fn settle(&self, motion: &mut Motion, drive: &Drive, h: f64) {
        for (i, (contact, old)) in self.contacts.iter().zip(&mut motion.contacts).enumerate() {
            let force = self.multipliers.forces[i];
            let slip = drive.slider_velocity[i] - contact.tangent.dot(&motion.velocity);
            let state = state_of(force, drive.friction_coefficient[i], slip);
            if state != *old {
                motion.statistics.state_changes += 1;
                motion.statistics.touch_downs += u64::from(*old == ContactState::Detached);
                *old = state;
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                motion.velocity[dof] = drive.slider_velocity[i];
            }
        }
        let closed = |i: usize| motion.contacts[i] != ContactState::Detached;
        for (i, contact) in self.contacts.iter().enumerate() {
            if let Some(dof) = contact.normal.as_unit().filter(|_| closed(i)) {
                motion.velocity[dof] = (0.0 - motion.displacement[dof]) / h;
            }
        }
        for (x, v) in motion.displacement.iter_mut().zip(&motion.velocity) {
            *x += h * v;
        }
        for (i, contact) in self.contacts.iter().enumerate() {
            if let Some(dof) = contact.normal.as_unit().filter(|_| closed(i)) {
                motion.displacement[dof] = 0.0;
            }
        }
    }
}

impl Integrator for SparseForwardIncrement {
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
        self.free_acceleration(motion, drive);
        for (i, contact) in self.contacts.iter().enumerate() {
            let slip = drive.slider_velocity[i] - contact.tangent.dot(&motion.velocity);
            self.multipliers.freedom[i] = match motion.contacts[i] {
                ContactState::Detached => Freedom::Open,
                ContactState::Stick => Freedom::Any,
                _ if slip == 0.0 => Freedom::Any,
                _ => Freedom::Slipping(slip.signum()),
            };
            self.multipliers.free[i] = [
                contact.normal.dot(&self.acceleration),
                contact.tangent.dot(&self.acceleration) - drive.slider_acceleration[i],
            ];
        }
        self.multipliers.solve(&drive.friction_coefficient)?;
        for (i, out) in forces.iter_mut().enumerate() {
            let force = self.multipliers.forces[i];
            let slip = match motion.contacts[i] {
                ContactState::Stick => 0.0,
                _ => drive.slider_velocity[i] - self.contacts[i].tangent.dot(&motion.velocity),
            };
            *out = ContactForce {
                state: state_of(force, drive.friction_coefficient[i], slip),
                normal_force: force[0],
                friction_force: force[1],
                slip_velocity: slip,
            };
        }
        Ok(())
    }

    fn set_damping(&mut self, damping: Damping) {
        self.damping = damping;
    }
}

/// The state that belongs to a solved pair (N, T) and a slip velocity v_r.
fn state_of([normal, tangential]: [f64; 2], friction: f64, slip: f64) -> ContactState {
    if normal <= 0.0 {
        ContactState::Detached
    } else if tangential.abs() < friction * normal
        || (slip == 0.0 && tangential.abs() <= friction * normal)
    {
        ContactState::Stick
    } else if tangential > 0.0 || (tangential == 0.0 && slip > 0.0) {
        ContactState::Slide
    } else {
        ContactState::ReverseSlide
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
