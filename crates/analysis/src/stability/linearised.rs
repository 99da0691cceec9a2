//! A scene's model as eigenvalues need it.

use super::candidates::{resting_state, uniform_sliding};
use amontons::Error;
use amontons::assembly::equilibrium;
use amontons::contact::ContactState;
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

    /// The linearised model: what eigenvalues are taken of.
    ///
    /// # Errors
    /// Returns an error if µ depends on the slip velocity and there is no equilibrium to linearise about.
    pub fn linear(&self) -> Result<LinearModel<'_>, Error> {
        if self.model.law.friction.info().is_constant() {
            self.model.linear()
        } else {
            Ok(self.model.linear_about(self.equilibrium()?))
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

    /// The one state in which the model can be at rest ([`resting_state`]).
    #[must_use]
    pub fn resting_state(&self) -> Vec<ContactState> {
        resting_state(&self.model)
    }

    /// The states of the contacts in the equilibrium: as at rest, and open where the equilibrium leaves a gap.
    ///
    /// # Errors
    /// Returns an error with the reason if there is no equilibrium.
    pub fn equilibrium_states(&self) -> Result<Vec<ContactState>, Error> {
        Ok(self.equilibrium()?.states(&self.model))
    }

    /// The state of uniform sliding.
    ///
    /// # Errors
    /// Returns an error if a surface stands still ([`uniform_sliding`]).
    pub fn uniform_sliding(&self) -> Result<Vec<ContactState>, Error> {
        uniform_sliding(&self.model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn a_constant_law_needs_no_equilibrium() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[0].preload = -0.1;
        let found = Linearised::of(&scene);
        assert!(found.equilibrium().is_err() && found.linear().is_ok());
    }
}
