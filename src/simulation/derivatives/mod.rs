//! Derivatives of outputs: by inputs in the present contact states, and by time.
//!
//! Both are one linear map. While the contacts keep their states, changes of the motion and of its inputs change the
//! contact forces by the solution of the linear problem that also gives the forces
//! ([`Integrator::respond`](crate::integrator::Integrator::respond)). The change of the friction coefficient alone,
//! d(±µ) N, acts like an additional force along the tangent. Position and velocity result from the steps: no input
//! changes them at the instant at which it is set.
//!
//! | file | contents |
//! | --- | --- |
//! | `inputs` | effect of input changes on the quantities that drive the motion |
//! | `slope` | ±µ of a sliding contact as a function |
//! | `energy` | the changes of the parts of the energy |

mod energy;
mod inputs;
mod slope;

use super::catalogue::{Quantity, parameter_or_input};
use super::{Simulation, Variable};
use crate::Error;
use crate::contact::{ContactForce, ContactState};
use crate::integrator::{AppliedLoad, ConstrainedResponse, HeldStates};
use crate::model::{Damping, LumpedModel};
use slope::Slope;

/// Small changes of the quantities that determine the outputs, due to inputs or over time.
struct Change {
    /// dt, s; zero if inputs change at an instant.
    time: f64,
    /// dx, m, and dẋ, m/s; one value for each degree of freedom, also of `force` and `load`.
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    /// Changes of the external forces and of the forces of preloads, N.
    force: Vec<f64>,
    load: Vec<f64>,
    /// Changes of the sliders' velocities and accelerations, m/s and m/s²; one value for each contact, also of the
    /// next fields.
    slider_velocity: Vec<f64>,
    slider_acceleration: Vec<f64>,
    /// Changes of µ_k and µ_s.
    friction: Vec<[f64; 2]>,
    /// Changes of the forces (N, T) at the reference position, N, which moves only before a run starts.
    reference: Vec<[f64; 2]>,
}

/// Result of a change: d(N, T), N, and dv_r, m/s, of each contact.
struct ForceChange {
    forces: Vec<[f64; 2]>,
    slip: Vec<f64>,
}

impl Simulation {
    /// Returns the immediate change of outputs due to changes of inputs, `by` (each with its change), in the present
    /// contact states: the product of the Jacobian ∂`of`/∂`by` and these changes. If several contacts constrain a
    /// mass redundantly, their individual forces are not determined, and neither are the changes of these.
    ///
    /// # Errors
    /// Returns an error if `of` has a variable that is not an output, if `by` has one that is not an input, or if the
    /// contact forces have no solution.
    pub fn directional_derivative(
        &mut self,
        of: &[&Variable],
        by: &[(&Variable, f64)],
    ) -> Result<Vec<f64>, Error> {
        let present = self.contact_forces()?.to_vec();
        let change = self.change_by(by)?;
        self.derivatives(of, &change, &present)
    }

    /// The directional derivative before the run has started, when the reference position moves with the inputs.
    ///
    /// # Errors
    /// Returns an error if `of` has a variable that is not an output, if `by` has one that is not an input, or if the
    /// contact forces have no solution.
    pub fn directional_derivative_at_start(
        &mut self,
        of: &[&Variable],
        by: &[(&Variable, f64)],
    ) -> Result<Vec<f64>, Error> {
        let present = self.contact_forces()?.to_vec();
        let mut change = self.change_by(by)?;
        self.move_reference(&mut change)?;
        self.derivatives(of, &change, &present)
    }

    /// Rates of change of outputs now, per second, in the present contact states. Signals contribute their rate from
    /// now on; rates of inputs ([`set_rate`](Self::set_rate)) contribute the one up to now or, once set anew, from
    /// now on.
    ///
    /// # Errors
    /// Returns an error if `of` has a variable that is not an output, or if the contact forces have no solution.
    pub fn rates(&mut self, of: &[&Variable]) -> Result<Vec<f64>, Error> {
        let present = self.contact_forces()?.to_vec();
        let change = self.change_over_time(&present)?;
        self.derivatives(of, &change, &present)
    }

    /// Rates of change of the quantities that determine the outputs, per second.
    fn change_over_time(&mut self, present: &[ContactForce]) -> Result<Change, Error> {
        let now = self.clock.grid_time(self.scene.step);
        let mut change = match &self.driven {
            None => self.change_by(&[])?,
            Some(driven) => {
                let rates: Vec<(&Variable, f64)> = driven.rates(now).collect();
                let mut change = self.change_by(&rates)?;
                for (contact, jerk) in change.slider_acceleration.iter_mut().enumerate() {
                    *jerk = driven.slider_jerk(now, contact);
                }
                change
            }
        };
        change.time = 1.0;
        change.displacement.copy_from_slice(&self.motion.velocity);
        let slopes = self.slopes(present);
        let load = self.held_back(
            self.inputs.force.clone(),
            &self.motion.displacement,
            &self.motion.velocity,
        );
        let sliders = self.inputs.slider_acceleration.clone();
        change.velocity = self.respond(present, &slopes, &load, &sliders)?.acceleration;
        Ok(change)
    }

    /// Changes of the outputs.
    fn derivatives(
        &mut self,
        of: &[&Variable],
        change: &Change,
        present: &[ContactForce],
    ) -> Result<Vec<f64>, Error> {
        let outcome = self.outcome(change, present)?;
        of.iter().map(|variable| self.derivative(variable, change, &outcome, present)).collect()
    }

    /// Change of one output.
    fn derivative(
        &self,
        variable: &Variable,
        change: &Change,
        outcome: &ForceChange,
        present: &[ContactForce],
    ) -> Result<f64, Error> {
        let (i, name) = (variable.index, &variable.name);
        let dof = || super::dof(&self.scene, &self.numbering, variable);
        let reaction = |part: usize| {
            let forces = outcome.forces.iter().enumerate();
            let on_slider = forces.filter(|(contact, _)| self.scene.is_on_slider(*contact));
            -on_slider.map(|(_, force)| force[part]).sum::<f64>()
        };
        Ok(match variable.template.quantity {
            Quantity::Displacement => change.displacement[dof()],
            Quantity::Velocity => change.velocity[dof()],
            Quantity::NormalForce => outcome.forces[i][0],
            Quantity::FrictionForce => outcome.forces[i][1],
            Quantity::SlipVelocity => outcome.slip[i],
            Quantity::NormalReaction => reaction(0),
            Quantity::TangentialReaction => reaction(1),
            Quantity::Energy => self.energy_change(change, present)[variable.template.component],
            Quantity::ContactState
            | Quantity::StateChanges
            | Quantity::ReversedSlips
            | Quantity::PulledContacts
            | Quantity::GrowthRate
            | Quantity::ModeFrequency
            | Quantity::ModeCount => {
                return Err(Error::variable(format!(
                    "{name} has no derivative: it is a discrete output"
                )));
            }
            parameter_or_input!() => {
                return Err(Error::variable(format!(
                    "{name} has no derivative: it is not an output"
                )));
            }
        })
    }

    /// Changes of the contact forces and slip velocities that result from a change.
    fn outcome(&mut self, change: &Change, present: &[ContactForce]) -> Result<ForceChange, Error> {
        let slopes = self.slopes(present);
        let sum = change.force.iter().zip(&change.load).map(|(force, load)| force + load);
        let mut load = self.held_back(sum.collect(), &change.displacement, &change.velocity);
        let (mut slip, mut weakened) = (Vec::new(), Vec::new());
        for (i, (contact, now)) in self.model.contacts.iter().zip(present).enumerate() {
            let along = contact.tangent.dot(&change.velocity);
            slip.push(match now.state {
                ContactState::Stick => 0.0,
                _ => change.slider_velocity[i] - along,
            });
            // The change of the friction coefficient acts on the masses like an additional force.
            weakened.push(now.normal_force * slopes[i].change(slip[i], change.friction[i]));
            let [normal, tangential] = change.reference[i];
            contact.normal.add_to(&mut load, -normal);
            contact.tangent.add_to(&mut load, weakened[i] - tangential);
        }
        let found = self.respond(present, &slopes, &load, &change.slider_acceleration)?;
        let mut forces = found.forces;
        for (force, own) in forces.iter_mut().zip(&weakened) {
            force[1] += own;
        }
        Ok(ForceChange { forces, slip })
    }

    fn slopes(&self, present: &[ContactForce]) -> Vec<Slope> {
        let contacts = present.iter().zip(&self.inputs.friction);
        contacts.map(|(force, &friction)| Slope::of(self.model.law, friction, force)).collect()
    }

    /// Response to forces of contacts that keep their states.
    fn respond(
        &mut self,
        present: &[ContactForce],
        slopes: &[Slope],
        force: &[f64],
        slider_acceleration: &[f64],
    ) -> Result<ConstrainedResponse, Error> {
        let states: Vec<ContactState> = present.iter().map(|force| force.state).collect();
        let slopes: Vec<f64> = slopes.iter().map(|slope| slope.value).collect();
        let mut response = ConstrainedResponse::new(present.len(), force.len());
        self.integrator
            .respond(
                HeldStates { states: &states, slopes: &slopes },
                AppliedLoad { force, slider_acceleration },
                &mut response,
            )
            .map_err(|failure| self.failed(failure, self.time()))?;
        Ok(response)
    }

    /// `force` minus the forces of springs and dampers at these displacements (m) and velocities (m/s), N.
    fn held_back(&self, mut force: Vec<f64>, x: &[f64], v: &[f64]) -> Vec<f64> {
        let LumpedModel { mass, stiffness, dampers, damping, .. } = &self.model;
        let Damping { alpha, beta } = *damping;
        for (row, force) in force.iter_mut().enumerate() {
            let springs = stiffness.row_times(row, x) + beta * stiffness.row_times(row, v);
            *force -= springs + alpha * mass.row_times(row, v) + dampers.row_times(row, v);
        }
        force
    }
}
