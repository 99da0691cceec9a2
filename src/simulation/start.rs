//! Initial motion of a simulation.

use crate::Error;
use crate::contact::ContactState;
use crate::error::Short;
use crate::integrator::Motion;
use crate::model::{Contact, Direction, LumpedModel};
use crate::scene::Scene;

/// The motion at the start. A contact whose initial gap or opening speed is above zero starts in state Dt; any other
/// is closed and starts in Sl, R-Sl or St, depending on the sign of its slip velocity.
pub(super) fn initial_motion(scene: &Scene, model: &LumpedModel) -> Motion {
    let displacement: Vec<f64> = scene.initial_displacements().collect();
    let velocity: Vec<f64> = scene.initial_velocities().collect();
    let contacts = model.contacts.iter().map(|contact| {
        let surface = contact.surface_velocity;
        let slip = surface - contact.tangent.dot(&velocity);
        if gap(contact, &displacement) > 0.0 || is_positive(&contact.normal, &velocity) {
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

/// Refuses to start with a mass inside a surface. A scene is refused before, if the equilibrium has no part in it.
pub(super) fn check_outside(
    scene: &Scene,
    model: &LumpedModel,
    motion: &Motion,
) -> Result<(), Error> {
    let inside = |contact: &Contact| gap(contact, &motion.displacement) < 0.0;
    let Some(i) = model.contacts.iter().position(inside) else { return Ok(()) };
    let contact = &model.contacts[i];
    Err(Error::scene(format!(
        "{} starts inside its surface: the equilibrium has a gap of {} m, and the initial displacement adds {} m; the sum \
         must be ≥ 0",
        scene.contact_name(i),
        Short(contact.gap),
        Short(contact.normal.dot(&motion.displacement))
    )))
}

/// The gap of a contact at these displacements, m; zero if it is a rounding error of its terms.
fn gap(contact: &Contact, displacement: &[f64]) -> f64 {
    let terms = contact.normal.0.iter().map(|&(dof, n)| (n * displacement[dof]).abs());
    let size = terms.fold(contact.gap, f64::max);
    let is_difference = contact.normal.0.len() > 1 || contact.gap > 0.0;
    let gap = contact.gap_at(displacement);
    if is_difference && gap.abs() <= 1e-12 * size { 0.0 } else { gap }
}

/// Returns `true` if the vector has a positive component along the normal, larger than rounding errors if the normal
/// has several components.
fn is_positive(normal: &Direction, vector: &[f64]) -> bool {
    let size = normal.0.iter().fold(0.0, |size, &(dof, n)| f64::max(size, (n * vector[dof]).abs()));
    normal.dot(vector) > if normal.0.len() > 1 { 1e-12 * size } else { 0.0 }
}
