//! Effect of input changes on the quantities that drive the motion.

use super::Change;
use super::slope::Slope;
use crate::Error;
use crate::assembly;
use crate::scene::ContactDefinition;
use crate::simulation::catalogue::{Causality, Quantity};
use crate::simulation::{Simulation, Variable, dof};

impl Simulation {
    /// The change of the quantities that drive the motion, due to these changes of inputs.
    ///
    /// # Errors
    /// Returns an error if a variable is not an input.
    pub(super) fn change_by(&self, by: &[(&Variable, f64)]) -> Result<Change, Error> {
        let (dofs, contacts) = (self.model.dofs(), self.model.contacts.len());
        let mut change = Change {
            time: 0.0,
            displacement: vec![0.0; dofs],
            velocity: vec![0.0; dofs],
            force: vec![0.0; dofs],
            load: vec![0.0; dofs],
            slider_velocity: vec![0.0; contacts],
            slider_acceleration: vec![0.0; contacts],
            friction: vec![[0.0; 2]; contacts],
            reference: vec![[0.0; 2]; contacts],
        };
        by.iter().try_for_each(|(input, value)| self.add(&mut change, input, *value))?;
        Ok(change)
    }

    fn add(&self, change: &mut Change, input: &Variable, by: f64) -> Result<(), Error> {
        let i = input.index;
        // Contacts without their own value use the common one.
        let common = |own: fn(&ContactDefinition) -> Option<f64>| {
            let lacks = move |contact: &usize| {
                self.scene.contact_definition(*contact).and_then(own).is_none()
            };
            (0..self.model.contacts.len()).filter(lacks)
        };
        match (input.causality, input.template.quantity) {
            (Causality::Input, Quantity::SliderVelocity) => {
                common(|place| place.velocity).for_each(|i| change.slider_velocity[i] += by);
            }
            (Causality::Input, Quantity::OwnVelocity) => change.slider_velocity[i] += by,
            (Causality::Input, Quantity::FrictionCoefficient) => {
                common(|place| place.friction).for_each(|i| change.friction[i][0] += by);
            }
            (Causality::Input, Quantity::StaticFriction) => {
                common(|place| place.static_friction.or(place.friction))
                    .for_each(|i| change.friction[i][1] += by);
            }
            // A contact without its own static friction uses this coefficient for both.
            (Causality::Input, Quantity::OwnFriction) => {
                change.friction[i][0] += by;
                if self
                    .scene
                    .contact_definition(i)
                    .is_some_and(|place| place.static_friction.is_none())
                {
                    change.friction[i][1] += by;
                }
            }
            (Causality::Input, Quantity::OwnStaticFriction) => change.friction[i][1] += by,
            (Causality::Input, Quantity::ExternalForce) => {
                change.force[dof(&self.scene, &self.numbering, input)] += by;
            }
            (Causality::Input, Quantity::Preload) => {
                assembly::add_preload(&self.scene, &self.numbering, i, by, &mut change.load);
            }
            _ => {
                return Err(Error::variable(format!(
                    "there is no derivative with respect to {}: it is not an input",
                    input.name
                )));
            }
        }
        Ok(())
    }

    /// Moves the reference position, the equilibrium in uniform sliding, with the inputs. Displacements are relative
    /// to it, so that loads then act through its contact forces alone.
    ///
    /// # Errors
    /// Returns an error if there is no equilibrium.
    pub(super) fn move_reference(&self, change: &mut Change) -> Result<(), Error> {
        let (mut slopes, mut by) = (Vec::new(), Vec::new());
        for (i, contact) in self.model.contacts.iter().enumerate() {
            let (surface, sign) = (contact.surface_velocity, contact.sliding_sign());
            let slope = Slope::with_sign(self.model.law, contact.friction, surface, sign);
            slopes.push(slope.value);
            by.push(slope.change(change.slider_velocity[i], change.friction[i]));
        }
        let load = std::mem::replace(&mut change.load, vec![0.0; self.model.dofs()]);
        let here = &self.reference.equilibrium;
        change.reference =
            self.model.equilibrium_change(load, &slopes, &by, &vec![0.0; by.len()], here)?;
        Ok(())
    }
}
