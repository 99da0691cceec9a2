//! This module gives the properties of a simulation's motion that are known before it is observed: linearity and,
//! from eigenvalues, growth or decay.

use crate::stability::Linearised;
use crate::stability::candidates::closed_at_rest;
use amontons::contact::ContactState;
use amontons::model::{Contact, LumpedModel};
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use amontons::stability::Spectrum;

/// Rounding may feign a growth of this part of the fastest mode's angular frequency.
pub(super) const MORE_THAN_ROUNDING: f64 = 1e-9;

/// The growth rate of the fastest growing mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GrowthRate {
    /// 1/s.
    pub rate: f64,
    /// The growth rate in parts of the fastest mode's angular frequency.
    pub relative: f64,
}

impl GrowthRate {
    /// `true` if a mode grows, by more than rounding.
    pub(super) fn is_growing(self) -> bool {
        self.relative > MORE_THAN_ROUNDING
    }

    /// `true` if all modes decay, by more than rounding.
    pub(super) fn is_decaying(self) -> bool {
        self.relative < -MORE_THAN_ROUNDING
    }
}

/// The growth rate in the contact states that the motion is in. `None` where motion in these states is not linear, or
/// cannot be analysed.
pub(super) fn growth(simulation: &Simulation) -> Option<GrowthRate> {
    has_linear_friction(simulation.scene()).then(|| growth_of_small(simulation))?
}

/// The growth rate of motions beside the equilibrium that are small enough for any law of friction, in the contact
/// states that the motion is in. `None` where these cannot be analysed.
pub(super) fn growth_of_small(simulation: &Simulation) -> Option<GrowthRate> {
    let here = Linearised::now(simulation);
    let spectrum = Spectrum::of(here.linear().ok()?, simulation.contact_states()).ok()?;
    let fastest = spectrum.oscillating.last().map_or(0.0, |value| value.im);
    let rate = spectrum.growth_rate();
    Some(GrowthRate { rate, relative: rate / fastest.max(rate.abs()) })
}

/// `true` if friction is always proportional to the normal force.
pub(super) fn has_linear_friction(scene: &Scene) -> bool {
    scene.friction_law.info().is_constant()
}

/// `true` if a contact can pull while its friction follows the size of the normal force.
pub(super) fn may_pull(scene: &Scene) -> bool {
    scene.effects.sticking && !scene.effects.detachment && scene.contact_count() > 0
}

/// Without sticking, friction has the direction of the surface's velocity, and so a surface that stands still does
/// not rub.
fn rubs(scene: &Scene, contact: &Contact) -> bool {
    scene.effects.sticking || contact.surface_velocity != 0.0
}

/// `true` if every contact is closed in a state of rest, or open. A contact that sticks to a moving surface is
/// carried on by it.
pub(super) fn has_states_of_rest(simulation: &Simulation) -> bool {
    let scene = simulation.scene();
    let model = LumpedModel::from(scene);
    let at_rest = closed_at_rest(&model);
    let contacts = model.contacts.iter().zip(&at_rest);
    simulation.contact_states().iter().zip(contacts).all(|(state, (contact, at_rest))| {
        state == at_rest || *state == ContactState::Detached || !rubs(scene, contact)
    })
}

/// Deflections, m, that its load and the contact forces at rest, along the normal or the tangent, would cause in each
/// degree of freedom, held by its own stiffness alone; 0 in one without stiffness.
pub(super) fn deflections(simulation: &Simulation) -> Vec<f64> {
    let model = LumpedModel::from(&simulation.nominal().scene());
    let mut forces: Vec<f64> = model.load.iter().map(|load| load.abs()).collect();
    for (contact, normal_force) in model.contacts.iter().zip(&simulation.reference().normal_force) {
        for (dof, part) in contact.normal.0.iter().chain(&contact.tangent.0) {
            forces[*dof] += (part * normal_force).abs();
        }
    }
    let bend = |(dof, force): (usize, &f64)| {
        let stiffness = model.stiffness.get(dof, dof);
        if stiffness > 0.0 { force / stiffness } else { 0.0 }
    };
    forces.iter().enumerate().map(bend).collect()
}

/// `true` if a motion is so large that loads and the motion of surfaces no longer matter: a million times the
/// equilibrium's displacements and, with sticking, the surfaces' velocities. Its equations are then homogeneous:
/// their effect on a motion is the same on one that is larger by any factor.
pub(super) fn is_far(simulation: &Simulation) -> bool {
    // Loads then change the motion by a millionth, less than sizes of windows may differ.
    const FAR: f64 = 1e6;
    let scene = simulation.scene();
    let at_rest = max_norm(&simulation.reference().displacement);
    if at_rest == 0.0 || max_norm(simulation.displacement()) <= FAR * at_rest {
        return false;
    }
    let contacts = LumpedModel::from(scene).contacts;
    let speed = |contact: &Contact| contact.surface_velocity.abs();
    // Without sticking only the direction of a surface's velocity matters.
    let speeds = contacts.iter().filter(|_| scene.effects.sticking).map(speed);
    max_norm(simulation.velocity()) > FAR * speeds.fold(0.0, f64::max)
}

/// `true` where no contact can stick, open or slip the other way, so that motions are linear at any size.
pub(super) fn stays_linear(simulation: &Simulation) -> bool {
    let scene = simulation.scene();
    has_linear_friction(scene)
        && (scene.contact_count() == 0 || !scene.effects.sticking && !scene.effects.detachment)
}
