//! The scheme on a model of any structure: any mass matrix, contacts in any directions.

use crate::Error;
use crate::contact::{ContactForce, ContactState};
use crate::integrator::dynamics::Dynamics;
use crate::integrator::multipliers::Freedom;
use crate::integrator::{Drive, Integrator, Motion, StepFailure};
use crate::model::{Damping, LumpedModel};

/// Forward increment Lagrange multipliers on sparse matrices: a step costs as much as M, K and D have
/// entries, and the contacts that share masses.
pub struct SparseForwardIncrement {
    dynamics: Dynamics,
}

impl SparseForwardIncrement {
    /// The integrator for this model.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite.
    pub fn new(model: &LumpedModel) -> Result<Self, Error> {
        Ok(Self { dynamics: Dynamics::new(model)? })
    }

    /// (N, T) of each contact over the last step, N.
    pub(super) fn last_multipliers(&self) -> &[[f64; 2]] {
        &self.dynamics.multipliers.forces
    }

    fn step(&mut self, motion: &mut Motion, drive: &Drive, h: f64) -> Result<(), StepFailure> {
        self.dynamics.free_acceleration(motion, &drive.force);
        let Dynamics { contacts, multipliers, responses, acceleration, .. } = &mut self.dynamics;
        for (i, contact) in contacts.iter().enumerate() {
            let normal = contact.normal.dot(&motion.velocity);
            let slip = contact.tangent.dot(&motion.velocity) - drive.slider_velocity[i];
            // A closed contact has no gap: a rounding error of one would be an impulse gap/h.
            let gap = match motion.contacts[i] {
                // Below zero it is what rounding leaves when a contact opens.
                ContactState::Detached => contact.normal.dot(&motion.displacement).max(0.0),
                _ => 0.0,
            };
            multipliers.freedom[i] = Freedom::Law(drive.friction[i].range(motion.contacts[i]));
            multipliers.free[i] = [
                contact.normal.dot(&*acceleration) + (normal + gap / h) / h,
                contact.tangent.dot(&*acceleration) + slip / h,
            ];
        }
        let sweeps = multipliers.solve()?;
        motion.statistics.steps += 1;
        motion.statistics.count_sweeps(sweeps);

        for (force, responses) in multipliers.forces.iter().zip(&*responses) {
            for (&force, response) in force.iter().zip(responses) {
                response.add_to(acceleration, force);
            }
        }
        for (v, a) in motion.velocity.iter_mut().zip(&*acceleration) {
            *v += h * a;
        }
        self.settle(motion, drive, h);
        Ok(())
    }

    /// Moves the masses on; where a contact lies along a degree of freedom, its gap and its slip
    /// become exact zeros, so that the tolerance of the multipliers leaves no drift.
    fn settle(&self, motion: &mut Motion, drive: &Drive, h: f64) {
        for (i, (contact, old)) in
            self.dynamics.contacts.iter().zip(&mut motion.contacts).enumerate()
        {
            let state = self.dynamics.multipliers.states[i];
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
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            if let Some(dof) = contact.normal.as_unit().filter(|_| closed(i)) {
                motion.velocity[dof] = (0.0 - motion.displacement[dof]) / h;
            }
        }
        for (x, v) in motion.displacement.iter_mut().zip(&motion.velocity) {
            *x += h * v;
        }
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
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
        self.dynamics.contact_forces(motion, drive, forces)
    }

    fn set_damping(&mut self, damping: Damping) {
        self.dynamics.damping = damping;
    }
}
