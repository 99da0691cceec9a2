//! The contact forces of the states that the motion is in.

use super::{EventDriven, NOISE};
use crate::contact::{ContactForce, ContactState};
use crate::integrator::{Drive, Motion};

impl EventDriven {
    /// Writes the forces that hold the motion in its present states; `false` if those break the law of
    /// contact, as they may when an input was changed since the last step.
    ///
    /// With friction the law may allow several solutions at once: the motion is in one of them, which is
    /// not for a report to choose.
    pub(super) fn present_forces(
        &mut self,
        motion: &Motion,
        drive: &Drive,
        forces: &mut [ContactForce],
    ) -> bool {
        let Self { dynamics, series, .. } = self;
        dynamics.free_acceleration(motion, &drive.force);
        let law = &mut series.law;
        law.set(dynamics, &motion.contacts, &drive.friction);
        let found = law.forces(dynamics, &drive.slider_acceleration);
        for (i, (out, &[normal_force, friction_force])) in forces.iter_mut().zip(found).enumerate()
        {
            let state = motion.contacts[i];
            let tangent = &dynamics.contacts[i].tangent;
            let (along, surface) = (tangent.dot(&motion.velocity), drive.slider_velocity[i]);
            let slip = surface - along;
            let terms = tangent.0.iter().map(|&(dof, t)| (t * motion.velocity[dof]).abs());
            let size = terms.fold(surface.abs(), f64::max);
            let is_lawful = match state {
                ContactState::Detached => true,
                ContactState::Stick => {
                    let limit = drive.friction[i].static_ * normal_force;
                    slip.abs() <= NOISE * size
                        && friction_force.abs() <= limit * (1.0 + NOISE)
                        && normal_force >= 0.0
                }
                _ => {
                    let direction = state.sliding_direction().unwrap_or(1.0);
                    direction * slip >= -NOISE * size && normal_force >= 0.0
                }
            };
            if !is_lawful {
                return false;
            }
            let slip_velocity = if state == ContactState::Stick { 0.0 } else { slip };
            *out = ContactForce { state, normal_force, friction_force, slip_velocity };
        }
        true
    }
}
