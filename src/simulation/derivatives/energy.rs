//! The changes of the parts of the energy.

use super::Change;
use crate::contact::ContactForce;
use crate::model::SparseMatrix;
use crate::simulation::Simulation;

impl Simulation {
    /// Changes of the parts of the energy, J, in the order of [`Energy::parts`](crate::integrator::Energy::parts);
    /// for a change over time, the power of each. All zero in a scene without an energy ledger.
    pub(super) fn energy_change(&self, change: &Change, present: &[ContactForce]) -> [f64; 8] {
        let Some(ledger) = &self.motion.ledger else { return [0.0; 8] };
        let (x, v) = (&*self.motion.displacement, &*self.motion.velocity);
        let (dx, dv) = (&*change.displacement, &*change.velocity);
        let balance = ledger.balance();
        let kinetic = form(dv, &self.model.mass, v);
        let elastic = form(dx, &self.model.stiffness, x) + dot(dx, balance);
        let zeros = || vec![0.0; x.len()];
        let damping = -dot(dx, &self.held_back(zeros(), &zeros(), v));
        let (mut friction, mut slider, mut moved) = (0.0, 0.0, 0.0);
        for (i, (contact, now)) in self.model.contacts.iter().zip(present).enumerate() {
            let passed = change.time * self.inputs.slider_velocity[i];
            slider += now.friction_force * passed;
            friction += now.friction_force * (passed - contact.tangent.dot(dx));
            // The elastic energy is measured from the reference position.
            let [normal, tangential] = change.reference[i];
            moved += normal * contact.normal.dot(x) + tangential * contact.tangent.dot(x);
        }
        let forces = dot(dx, &self.inputs.force) + dot(dx, balance);
        let residual = (kinetic + elastic) - (slider + forces - damping - friction);
        [kinetic, elastic + moved, damping, friction, 0.0, slider, forces, residual]
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// The bilinear form aᵀ A b.
fn form(a: &[f64], matrix: &SparseMatrix, b: &[f64]) -> f64 {
    a.iter().enumerate().fold(0.0, |sum, (row, a)| sum + a * matrix.row_times(row, b))
}
