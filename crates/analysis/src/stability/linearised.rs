//! A scene's model as eigenvalues need it.

use super::candidates::closed_at_rest;
use amontons::Error;
use amontons::assembly::equilibrium;
use amontons::contact::{ContactState, JoinedStates};
use amontons::model::{Equilibrium, LinearModel, LumpedModel};
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use std::sync::OnceLock;

/// A model with the equilibrium in uniform sliding about which it is linearised. It cannot be changed, so the
/// equilibrium always belongs to the model. The equilibrium is sought when it is first asked for: models with the same
/// µ at all slip velocities have eigenvalues without one.
///
/// ```
/// use amontons_analysis::stability::{Linearised, modes};
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let here = Linearised::of(&scene);
/// let found = modes(here.linear()?, &here.uniform_sliding()?)?;
/// assert!(found.all().any(|mode| mode.growth_rate() > 0.0));
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Linearised {
    model: LumpedModel,
    /// The scene, which names the contacts.
    scene: Option<Scene>,
    equilibrium: OnceLock<Result<Equilibrium, Error>>,
}

/// A model whose contacts have no names.
impl From<LumpedModel> for Linearised {
    fn from(model: LumpedModel) -> Self {
        Self { model, scene: None, equilibrium: OnceLock::new() }
    }
}

impl Linearised {
    /// The model of a scene; its external forces, held as they are, are part of the load. Signals of the scene are left
    /// out: evaluate the scene at an instant first, where it has some.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut model = LumpedModel::from(scene);
        for (load, force) in model.load.iter_mut().zip(scene.external_forces()) {
            *load += force;
        }
        Self { model, scene: Some(scene.clone()), equilibrium: OnceLock::new() }
    }

    /// The model of a scene about an equilibrium that is known already.
    #[must_use]
    pub fn about(scene: &Scene, equilibrium: &Equilibrium) -> Self {
        Self { equilibrium: OnceLock::from(Ok(equilibrium.clone())), ..Self::of(scene) }
    }

    /// The model of a simulation with the values that act now, about the simulation's reference position.
    #[must_use]
    pub fn now(simulation: &Simulation) -> Self {
        Self::about(simulation.scene(), simulation.reference())
    }

    /// The model that is linearised.
    #[must_use]
    pub fn model(&self) -> &LumpedModel {
        &self.model
    }

    /// The scene of the model, which names its parameters; `None` for a model alone.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// The linearised model: what eigenvalues are taken of.
    ///
    /// # Errors
    /// Returns an error if the equations need an equilibrium ([`LumpedModel::needs_equilibrium`]) and there is none.
    pub fn linear(&self) -> Result<LinearModel<'_>, Error> {
        if self.model.needs_equilibrium() {
            Ok(self.model.linear_about(self.equilibrium()?))
        } else {
            self.model.linear()
        }
    }

    /// The equilibrium in uniform sliding.
    ///
    /// # Errors
    /// Returns an error with the reason if there is none.
    pub fn equilibrium(&self) -> Result<&Equilibrium, Error> {
        let found = self.equilibrium.get_or_init(|| match &self.scene {
            Some(scene) => equilibrium(scene, &self.model),
            None => self.model.equilibrium(&|contact| format!("contact[{}]", contact + 1)),
        });
        found.as_ref().map_err(Error::clone)
    }

    /// The states of the contacts in the equilibrium: as at rest, and open where the equilibrium leaves a gap.
    ///
    /// # Errors
    /// Returns an error with the reason if there is no equilibrium.
    pub fn equilibrium_states(&self) -> Result<Vec<ContactState>, Error> {
        Ok(self.equilibrium()?.states(&self.model))
    }

    /// The equilibrium, if its contacts are in these states: others may be closed at another µ.
    ///
    /// # Errors
    /// Returns an error with the reason if there is none, or if its contacts are in other states.
    pub fn equilibrium_in(&self, states: &[ContactState]) -> Result<&Equilibrium, Error> {
        let found = self.equilibrium()?;
        let here = found.states(&self.model);
        if here == states {
            return Ok(found);
        }
        Err(Error::equilibrium(format!(
            "the equilibrium is in state {}, and not in {}",
            JoinedStates(&here),
            JoinedStates(states)
        )))
    }

    /// The one state in which the model can be at rest: that of the equilibrium, or with all contacts closed where there is
    /// none ([`closed_at_rest`]).
    #[must_use]
    pub fn resting_state(&self) -> Vec<ContactState> {
        match self.equilibrium() {
            Ok(found) => found.states(&self.model),
            Err(_) => closed_at_rest(&self.model),
        }
    }

    /// The state of uniform sliding: the resting state, where that has every contact sliding or open.
    ///
    /// # Errors
    /// Returns an error if the surface under a closed contact stands still.
    pub fn uniform_sliding(&self) -> Result<Vec<ContactState>, Error> {
        let states = self.resting_state();
        let Some(stuck) = states.iter().position(|state| *state == ContactState::Stick) else {
            return Ok(states);
        };
        let all_stand = self.model.contacts.iter().all(|contact| contact.surface_velocity == 0.0);
        let problem = if all_stand {
            "no surface moves, so no contact slides: give slider.velocity, or the velocity of a contact, a value other than zero"
                .to_owned()
        } else {
            format!(
                "the surface under contact {} stands still, so the contact does not slide: give the surface a velocity other \
                 than zero",
                stuck + 1
            )
        };
        Err(Error::analysis(format!(
            "{problem}, or name a contact state with --state if the command has this option"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::contact::ContactState::{Detached, Slide};
    use amontons::scene::builtin;

    #[test]
    fn the_slope_of_the_law_is_that_at_the_equilibrium() {
        let text = include_str!("../../../../scenes/effects/stribeck.toml");
        let scene = amontons::scene::parse("stribeck", text).unwrap();
        // N = 10 N, dµ/dv = −(µ_s − µ) / v_s exp(−v / v_s) with v = v_s = 0.1 m/s.
        let expected = -10.0 * (0.4 - 0.2) / 0.1 * f64::exp(-1.0);
        let found = Linearised::of(&scene);
        assert!((found.linear().unwrap().friction_of(0).damping - expected).abs() < 1e-12);
        let mut lifted = scene;
        let amontons::scene::Structure::Network(network) = &mut lifted.structure else { panic!() };
        network.masses[0].load = [0.0, 1.0];
        assert!(Linearised::of(&lifted).linear().unwrap_err().is_equilibrium());
    }

    #[test]
    fn uniform_sliding_leaves_contacts_open_that_the_load_opens() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[1].preload = -5e-3;
        let found = Linearised::of(&scene);
        assert_eq!(found.uniform_sliding().unwrap(), [Slide, Detached]);
        assert!(found.equilibrium_in(&[Slide, Detached]).is_ok());
        let error = found.equilibrium_in(&[Slide, Slide]).unwrap_err().to_string();
        assert!(error.contains("in state Sl-Dt, and not in Sl-Sl"), "{error}");
        // Where it jams there is none, and all contacts are taken to be closed.
        scene.slider.angle = -0.5;
        scene.friction_coefficient = 6.0;
        scene.modules_mut()[1].preload = 5e-3;
        let jammed = Linearised::of(&scene);
        assert!(jammed.equilibrium().is_err());
        assert_eq!(jammed.resting_state(), [Slide, Slide]);
    }

    #[test]
    fn a_constant_law_needs_no_equilibrium() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.slider.angle = -0.5;
        scene.friction_coefficient = 6.0;
        let found = Linearised::of(&scene);
        assert!(found.equilibrium().is_err() && found.linear().is_ok());
    }
}
