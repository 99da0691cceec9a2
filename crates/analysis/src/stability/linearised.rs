//! A scene's model as eigenvalues need it.

use super::candidates::{resting_state, uniform_sliding};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Equilibrium, LumpedModel, equilibrium};
use amontons::scene::Scene;

/// A scene's model, linearised about its equilibrium in uniform sliding. It cannot be changed, so that it always
/// belongs to its equilibrium, its µ and its velocity. Signals of the scene are left out: evaluate the scene at an
/// instant first, where it has some.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearised {
    model: LumpedModel,
    equilibrium: Result<Equilibrium, Error>,
    friction: f64,
    velocity: f64,
}

impl Linearised {
    /// The model of a scene; its external forces, held as they are, are part of the load. Where the scene has no equilibrium, friction that depends on the slip velocity has no
    /// slope in it ([`require_slopes`](Self::require_slopes)).
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut model = LumpedModel::from(scene);
        for (load, force) in model.load.iter_mut().zip(scene.external_forces()) {
            *load += force;
        }
        let equilibrium = equilibrium(scene, &model);
        if let Ok(equilibrium) = &equilibrium {
            model.linearise(equilibrium);
        }
        let (friction, velocity) = (scene.friction_coefficient, scene.slider.velocity);
        Self { model, equilibrium, friction, velocity }
    }

    /// The linearised model.
    #[must_use]
    pub fn model(&self) -> &LumpedModel {
        &self.model
    }

    /// The linearised model by itself.
    #[must_use]
    pub fn into_model(self) -> LumpedModel {
        self.model
    }

    /// The equilibrium about which it is linearised.
    ///
    /// # Errors
    /// There is none: why.
    pub fn equilibrium(&self) -> Result<&Equilibrium, Error> {
        self.equilibrium.as_ref().map_err(Error::clone)
    }

    /// µ of the contacts that have the common one.
    #[must_use]
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// The slider's velocity, m/s.
    #[must_use]
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// The one state in which the model can be at rest ([`resting_state`]).
    #[must_use]
    pub fn resting_state(&self) -> Vec<ContactState> {
        resting_state(&self.model, self.velocity)
    }

    /// The state of uniform sliding.
    ///
    /// # Errors
    /// A surface stands still ([`uniform_sliding`]).
    pub fn uniform_sliding(&self) -> Result<Vec<ContactState>, Error> {
        uniform_sliding(&self.model, self.velocity)
    }

    /// Makes sure that the model has the slope of its law of friction, without which eigenvalues are those of another
    /// law.
    ///
    /// # Errors
    /// µ depends on the slip velocity, and there is no equilibrium to linearise about.
    pub fn require_slopes(&self) -> Result<(), Error> {
        match &self.equilibrium {
            Err(error) if !self.model.law.friction.about().is_constant() => Err(error.clone()),
            _ => Ok(()),
        }
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
        assert!((found.model().contacts[0].weakening() - expected).abs() < 1e-12);
        assert_eq!(found.require_slopes(), Ok(()));
        let mut lifted = scene;
        let amontons::scene::Structure::Network(network) = &mut lifted.structure else { panic!() };
        network.masses[0].load = [0.0, 1.0];
        assert!(Linearised::of(&lifted).require_slopes().unwrap_err().is_equilibrium());
    }

    #[test]
    fn a_constant_law_needs_no_equilibrium() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[0].preload = -0.1;
        let found = Linearised::of(&scene);
        assert!(found.equilibrium().is_err() && found.require_slopes().is_ok());
    }
}
