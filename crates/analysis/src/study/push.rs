//! A small push out of an equilibrium, or off a cycle.

use crate::stability::Linearised;
use amontons::contact::ContactState;
use amontons::model::{Contact, Direction, LumpedModel};
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::Serialize;

/// Size of a push in parts of the fastest surface's velocity, and of a motion's own: far below a velocity that makes
/// a contact stick, far above rounding.
const SMALL: f64 = 1e-3;
/// The velocity of the push where all surfaces stand still, m/s.
const STANDING: f64 = 1e-6;

/// Another velocity of one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Push {
    /// The degree of freedom, from 0.
    pub dof: usize,
    /// The velocity that is added to that of the degree of freedom, m/s.
    pub velocity: f64,
}

/// The normals of the contacts that are closed at rest: a push into their surfaces is none.
pub(crate) fn closed_normals(here: &Linearised) -> Vec<&Direction> {
    let contacts = here.model().contacts.iter().zip(here.resting_state());
    let closed = contacts.filter(|(_, at_rest)| *at_rest != ContactState::Detached);
    closed.map(|(contact, _)| &contact.normal).collect()
}

/// `true` if a degree of freedom is part of the normal of a contact: its motion opens or closes the contact.
fn lifts(model: &LumpedModel, dof: usize) -> bool {
    lies_along(model, dof, |contact| &contact.normal.0)
}

/// `true` if a degree of freedom is part of such a direction of some contact.
fn lies_along(
    model: &LumpedModel,
    dof: usize,
    directions: fn(&Contact) -> &[(usize, f64)],
) -> bool {
    let mut parts = model.contacts.iter().flat_map(directions);
    parts.any(|(touched, part)| *touched == dof && *part != 0.0)
}

impl Push {
    /// The usual push of a scene: to the first degree of freedom that no contact lies along, else to the first along
    /// which no contact opens; by a thousandth of the fastest surface's velocity, or 1e-6 m/s where all stand still.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let model = LumpedModel::from(scene);
        let rubs = |dof: usize| lies_along(&model, dof, |contact| &contact.tangent.0);
        let mut free = (0..model.dofs()).filter(|dof| !lifts(&model, *dof));
        let first = free.clone().next();
        let dof = free.find(|dof| !rubs(*dof)).or(first).unwrap_or(0);
        let speed = |contact: &Contact| contact.surface_velocity.abs();
        let fastest = model.contacts.iter().map(speed).fold(0.0, f64::max);
        Self { dof, velocity: if fastest > 0.0 { SMALL * fastest } else { STANDING } }
    }

    /// The usual push of a scene that rests in its equilibrium, where friction may hold it for ever: without initial
    /// displacements, initial velocities and signals. `None` of any other.
    #[must_use]
    pub fn of_resting(scene: &Scene) -> Option<Self> {
        let mut initial = scene.initial_displacements().chain(scene.initial_velocities());
        let rests = initial.all(|value| value == 0.0) && scene.signals.is_empty();
        rests.then(|| Self::of(scene))
    }

    /// Gives the push; to a faster motion the same part of its largest velocity, so that growth beside a large cycle is
    /// seen at once.
    pub(crate) fn give(&self, simulation: &mut Simulation) {
        self.give_part(simulation, 1.0);
    }

    /// Gives this part of the push.
    pub(crate) fn give_part(&self, simulation: &mut Simulation, part: f64) {
        let fastest = max_norm(simulation.velocity());
        simulation.push(self.dof, part * self.velocity.max(SMALL * fastest));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn what_rests_is_pushed_where_no_contact_holds_it() {
        let mut set1 = builtin("set1").unwrap().scene();
        assert_eq!(Push::of_resting(&set1), None);
        set1.rest();
        assert_eq!(Push::of_resting(&set1), Some(Push { dof: 0, velocity: 2.5e-5 }));
        set1.slider.velocity = -0.025;
        assert_eq!(Push::of(&set1).velocity, 2.5e-5);
        set1.slider.velocity = 0.0;
        assert_eq!(Push::of(&set1).velocity, 1e-6);
        // Its one mass moves along the belt and away from it; a signal drives the other one.
        let mut block = builtin("stick_slip").unwrap().scene();
        block.rest();
        assert_eq!(Push::of_resting(&block), Some(Push { dof: 0, velocity: 1e-4 }));
        assert_eq!(Push::of_resting(&builtin("den_hartog").unwrap().scene()), None);
    }
}
