//! Assembly of the lumped model of a scene.

mod elements;
mod network;
mod ring;

pub use network::Numbering;

use crate::Error;
use crate::model::ring::MODULE_DOFS;
use crate::model::{Equilibrium, LumpedModel};
use crate::scene::{Scene, Structure};

impl From<&Scene> for LumpedModel {
    fn from(scene: &Scene) -> Self {
        match &scene.structure {
            Structure::Ring(modules) => ring::model(scene, modules),
            Structure::Network(network) => network::model(scene, network),
        }
    }
}

/// Writes the present loads of the scene, N, into `load`, one value for each degree of freedom; `numbering` is the
/// scene's.
pub fn load(scene: &Scene, numbering: &Numbering, load: &mut [f64]) {
    match &scene.structure {
        Structure::Ring(modules) => ring::load(modules, load),
        Structure::Network(network) => network::load(network, numbering, load),
    }
}

/// Adds the forces, N, of a preload (m) to `load`, one value for each degree of freedom. `index` is the place of the
/// module or spring that has it, `numbering` the scene's.
pub fn add_preload(
    scene: &Scene,
    numbering: &Numbering,
    index: usize,
    preload: f64,
    load: &mut [f64],
) {
    match &scene.structure {
        Structure::Ring(modules) => {
            load[MODULE_DOFS * index + ring::PRELOADED] +=
                ring::preload_force(&modules[index], preload);
        }
        Structure::Network(network) => {
            network::add_preload(network, numbering, &network.springs[index], preload, load);
        }
    }
}

/// Copies the friction and the surface velocities of the contacts from the present scene.
pub fn update_contacts(model: &mut LumpedModel, scene: &Scene) {
    for (i, contact) in model.contacts.iter_mut().enumerate() {
        contact.friction = scene.friction_of(i);
        contact.surface_velocity = scene.surface_velocity(i);
    }
}

/// The equilibrium of a scene in uniform sliding ([`LumpedModel::equilibrium`]); `model` is the scene's.
///
/// # Errors
/// Returns an error that says why there is no equilibrium, with the scene's names of contacts.
pub fn equilibrium(scene: &Scene, model: &LumpedModel) -> Result<Equilibrium, Error> {
    model.equilibrium(&|contact| scene.contact_name(contact))
}
