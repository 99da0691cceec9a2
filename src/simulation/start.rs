//! Initial motion of a simulation.

use crate::Error;
use crate::contact::ContactState;
use crate::integrator::Motion;
use crate::model::{Direction, LumpedModel};
use crate::scene::Scene;

/// The motion at the start. A contact whose initial gap or opening speed is above zero starts in state Dt; any other
/// is closed and starts in Sl, R-Sl or St, depending on the sign of its slip velocity.
pub(super) fn initial_motion(scene: &Scene, model: &LumpedModel) -> Motion {
    let displacement: Vec<f64> = scene.initial_displacements().collect();
    let velocity: Vec<f64> = scene.initial_velocities().collect();
    let contacts = model.contacts.iter().map(|contact| {
        let surface = contact.surface_velocity;
        let slip = surface - contact.tangent.dot(&velocity);
        if is_positive(&contact.normal, &displacement) || is_positive(&contact.normal, &velocity) {
            ContactState::Detached
        } else if let Some(state) = model.law.fixed_state(surface) {
            state
        } else if slip > 0.0 {
            ContactState::Slide
        } else if slip < 0.0 {
            ContactState::ReverseSlide
        } else {
            ContactState::Stick
        }
    });
    let contacts = contacts.collect();
    Motion::new(displacement, velocity, contacts)
}

/// Refuses to start with a contact that is open, or moves along its normal, if contacts cannot open.
pub(super) fn check_closed(
    scene: &Scene,
    model: &LumpedModel,
    motion: &Motion,
) -> Result<(), Error> {
    if model.law.detachment {
        return Ok(());
    }
    for (i, contact) in model.contacts.iter().enumerate() {
        let moves = |vector: &[f64]| {
            let opposite: Vec<f64> = vector.iter().map(|value| -value).collect();
            is_positive(&contact.normal, vector) || is_positive(&contact.normal, &opposite)
        };
        if moves(&motion.displacement) || moves(&motion.velocity) {
            return Err(Error::scene(format!(
                "{} starts away from its surface, or moves along its normal, and contacts cannot open in \
                 this scene; change its initial values, or let contacts open (effects.detachment)",
                scene.contact_name(i)
            )));
        }
    }
    Ok(())
}

/// Returns `true` if the vector has a positive component along the normal, larger than rounding errors if the normal
/// has several components.
fn is_positive(normal: &Direction, vector: &[f64]) -> bool {
    let size = normal.0.iter().fold(0.0, |size, &(dof, n)| f64::max(size, (n * vector[dof]).abs()));
    normal.dot(vector) > if normal.0.len() > 1 { 1e-12 * size } else { 0.0 }
}
