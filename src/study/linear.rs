//! This module tells what is known of a simulation's motion before one looks at it: whether it is linear, whether it then
//! grows or decays, as its eigenvalues have it, and whether what drives it repeats itself.

use crate::contact::ContactState;
use crate::model::{Contact, LumpedModel};
use crate::scene::{Scene, Shape, Sine};
use crate::simulation::Simulation;
use crate::stability::Spectrum;
use crate::stability::candidates::resting_state;

/// Rounding may feign a growth of this part of the fastest mode's angular frequency.
const MORE_THAN_ROUNDING: f64 = 1e-9;

/// The growth rate of the fastest growing mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Growth {
    /// 1/s.
    pub rate: f64,
    /// In parts of the fastest mode's angular frequency.
    pub relative: f64,
}

impl Growth {
    /// Does a mode grow, by more than rounding?
    pub(super) fn is_growing(self) -> bool {
        self.relative > MORE_THAN_ROUNDING
    }

    /// Do all modes decay, by more than rounding?
    pub(super) fn is_decaying(self) -> bool {
        self.relative < -MORE_THAN_ROUNDING
    }
}

/// The growth rate in the contact states that the motion is in. `None` where motion in these states is not linear, or
/// cannot be analysed.
pub(super) fn growth(simulation: &Simulation) -> Option<Growth> {
    let scene = simulation.acting();
    if !has_linear_friction(scene) {
        return None;
    }
    let mut model = LumpedModel::from(scene);
    model.linearise(simulation.reference());
    let states = simulation.contact_states();
    let spectrum = Spectrum::of(&model, states, scene.friction_coefficient).ok()?;
    let fastest = spectrum.oscillating.last().map_or(0.0, |value| value.im);
    let rate = spectrum.growth_rate();
    Some(Growth { rate, relative: rate / fastest.max(rate.abs()) })
}

/// Do all signals that still change have one period, and is it no longer than a window (s)?
pub(super) fn is_repeated(simulation: &Simulation, window: f64) -> bool {
    let time = simulation.time();
    let mut one = None;
    simulation.scene().signals.iter().all(|signal| match &signal.shape {
        Shape::Sine(Sine { frequency, start, end: None, .. }) if *start <= time => {
            frequency * window >= 1.0 && *one.get_or_insert(*frequency) == *frequency
        }
        shape => shape.constant_until(time, 0.0) == f64::INFINITY,
    })
}

/// Can friction take no other size than in proportion to the normal force?
pub(super) fn has_linear_friction(scene: &Scene) -> bool {
    scene.friction_law.about().is_constant()
}

/// Can a contact pull while its friction follows the size of the normal force?
pub(super) fn may_pull(scene: &Scene) -> bool {
    scene.effects.sticking && !scene.effects.detachment && scene.contact_count() > 0
}

/// Is every contact closed in a state of rest, or open? One that sticks to a moving surface is carried on by it.
pub(super) fn has_states_of_rest(simulation: &Simulation) -> bool {
    let scene = simulation.acting();
    let at_rest = resting_state(&LumpedModel::from(scene), scene.slider.velocity);
    let states = simulation.contact_states().iter().zip(&at_rest);
    states.into_iter().all(|(state, at_rest)| state == at_rest || *state == ContactState::Detached)
}

/// Is a motion so large that what loads and moves the surfaces no longer matters? Its equations are then homogeneous: what
/// they do with a motion they do with one that is larger by any factor.
pub(super) fn is_far(simulation: &Simulation) -> bool {
    const FAR: f64 = 1e6;
    let scene = simulation.acting();
    let largest = |x: &[f64]| x.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
    let at_rest = largest(&simulation.reference().displacement);
    if at_rest == 0.0 || largest(simulation.displacement()) <= FAR * at_rest {
        return false;
    }
    let contacts = LumpedModel::from(scene).contacts;
    let speed = |contact: &Contact| contact.velocity(scene.slider.velocity).abs();
    // Without sticking only the direction of a surface's velocity matters.
    let speeds = contacts.iter().filter(|_| scene.effects.sticking).map(speed);
    largest(simulation.velocity()) > FAR * speeds.fold(0.0, f64::max)
}

/// `true` where no contact can stick, open or slip the other way, so that motions are linear at any size.
pub(super) fn stays_linear(simulation: &Simulation) -> bool {
    let scene = simulation.scene();
    has_linear_friction(scene)
        && (scene.contact_count() == 0 || !scene.effects.sticking && !scene.effects.detachment)
}
