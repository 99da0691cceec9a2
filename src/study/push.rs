//! A small push out of an equilibrium, or off a cycle.

use crate::model::{Contact, LumpedModel};
use crate::scene::Scene;
use crate::simulation::Simulation;
use serde::Serialize;

/// In parts of the fastest surface's velocity: far below what makes a contact stick, far above rounding.
const SMALL: f64 = 1e-3;
/// Where all surfaces stand still, m/s.
const STANDING: f64 = 1e-6;

/// Another velocity of one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Push {
    /// The degree of freedom, from 0.
    pub dof: usize,
    /// What is added to its velocity, m/s.
    pub velocity: f64,
}

impl Push {
    /// The usual one of a scene: to the first degree of freedom that no contact lies along, else to the first.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let model = LumpedModel::from(scene);
        let touches = |dof: usize| {
            let directions =
                model.contacts.iter().flat_map(|contact| [&contact.normal, &contact.tangent]);
            directions.flat_map(|direction| &direction.0).any(|(touched, _)| *touched == dof)
        };
        let dof = (0..model.dofs()).find(|dof| !touches(*dof)).unwrap_or(0);
        let speed = |contact: &Contact| contact.velocity(scene.slider.velocity).abs();
        let fastest = model.contacts.iter().map(speed).fold(0.0, f64::max);
        Self { dof, velocity: if fastest > 0.0 { SMALL * fastest } else { STANDING } }
    }

    /// Gives it.
    pub(crate) fn give(&self, simulation: &mut Simulation) {
        simulation.push(self.dof, self.velocity);
    }
}
