//! The forward increment scheme with an energy ledger, written after each step.
//!
//! Over a step of length h every force f is held, so that its work is h v̄·f with v̄ = (ẋ_n + ẋ_{n+1})/2, and
//! damping takes h v̄ᵀ C ẋ_n. The impulses of contacts are h λ. A slider counts with its mean velocity.
//!
//! With these the residual is ½ h ẋ·(K x + Gᵀ λ₀), less its value at the start: the elastic energy of a step is that of
//! x_{n+1} = x_n + h ẋ_{n+1}, while work is done with v̄, and all other terms cancel. So the residual is of first
//! order, measures the distance of the step from the motion, and does not grow with time. Where the step changes, a new
//! such term begins.

use crate::contact::{ContactForce, ContactState};
use crate::integrator::{
    AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Integrator, Motion, StepFailure,
};
use crate::model::{Damping, LumpedModel};

/// An integrator of the scheme that writes the ledger of its motion.
pub(in crate::integrator) struct WithLedger {
    integrator: Box<dyn Integrator>,
    model: LumpedModel,
    /// Displacements x and velocities ẋ before the step.
    x: Vec<f64>,
    v: Vec<f64>,
    /// Mean velocity v̄, m/s.
    mean: Vec<f64>,
    /// Impulses of the contacts M (ẋ_{n+1} − ẋ_n) − h (F − C ẋ_n − K x_n) = h Gᵀ λ, N s.
    impulse: Vec<f64>,
    /// Work of friction on the masses at each contact since the integrator was made, J.
    work: Vec<f64>,
}

impl WithLedger {
    pub(in crate::integrator) fn new(integrator: Box<dyn Integrator>, model: &LumpedModel) -> Self {
        let zeros = || vec![0.0; model.dofs()];
        Self {
            integrator,
            model: model.clone(),
            x: zeros(),
            v: zeros(),
            mean: zeros(),
            impulse: zeros(),
            work: vec![0.0; model.contacts.len()],
        }
    }

    /// Adds the step that led to this motion to the ledger.
    fn write(&mut self, motion: &mut Motion, inputs: &Inputs, h: f64) {
        let Some(ledger) = &mut motion.ledger else { return };
        let LumpedModel { mass, stiffness, dampers, damping, contacts, .. } = &self.model;
        let (x, old, new) = (&*self.x, &*self.v, &*motion.velocity);
        for (mean, (old, new)) in self.mean.iter_mut().zip(old.iter().zip(new)) {
            *mean = 0.5 * (old + new);
        }
        for (row, mean) in self.mean.iter().enumerate() {
            let damper = damping.alpha * mass.row_times(row, old)
                + damping.beta * stiffness.row_times(row, old)
                + dampers.row_times(row, old);
            let spring = stiffness.row_times(row, x);
            let gained =
                mass.row(row).fold(0.0, |sum, (column, m)| sum + m * (new[column] - old[column]));
            self.impulse[row] = gained - h * (inputs.force[row] - damper - spring);
            ledger.damping += h * mean * damper;
            ledger.forces += h * mean * (inputs.force[row] + ledger.balance[row]);
        }
        let multipliers = self.integrator.multipliers();
        for (i, contact) in contacts.iter().enumerate() {
            if motion.contacts[i] == ContactState::Detached {
                continue;
            }
            let directions = [&contact.normal, &contact.tangent];
            let impulses = match multipliers {
                Some(forces) => forces[i].map(|force| h * force),
                None => directions.map(|direction| direction.dot(&self.impulse)),
            };
            let surface = inputs.slider_velocity[i] - 0.5 * h * inputs.slider_acceleration[i];
            let velocities = directions.map(|direction| direction.dot(&self.mean));
            ledger.add_impulses(impulses, velocities, surface);
            self.work[i] += impulses[1] * velocities[1];
        }
    }
}

impl Integrator for WithLedger {
    fn advance(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        for _ in 0..count {
            self.x.copy_from_slice(&motion.displacement);
            self.v.copy_from_slice(&motion.velocity);
            self.integrator.advance(motion, inputs, step, 1)?;
            self.write(motion, inputs, step);
        }
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.integrator.contact_forces(motion, inputs, forces)
    }

    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        self.integrator.respond(held, load, response)
    }

    fn friction_work(&self) -> Option<&[f64]> {
        Some(&self.work)
    }

    fn set_damping(&mut self, damping: Damping) {
        self.model.damping = damping;
        self.integrator.set_damping(damping);
    }
}
