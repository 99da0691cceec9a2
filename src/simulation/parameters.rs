//! The values of a scene's parameters and inputs, as one vector over the catalogue.
//!
//! A run has such a vector of nominal values: those that the scene, an importer or a rate has given each variable.
//! Signals and rates add to some of them; the effective values are those of
//! [`Simulation::scene`](super::Simulation::scene). A saved state holds the nominal values.

use super::catalogue::Quantity;
use super::values::{impossible, place_in, rule};
use super::{Variable, variables};
use crate::Error;
use crate::scene::{Method, Rule, Scene, Selection};
use serde::{Deserialize, Serialize};
use std::mem::{replace, take};
use std::sync::Arc;

/// A scene's parameters and inputs, each with a value.
///
/// ```
/// use amontons::scene::builtin;
/// use amontons::simulation::{Parameters, variables};
///
/// let scene = builtin("set2").expect("a built-in scene").scene();
/// let all = variables(&scene);
/// let friction = all.iter().find(|variable| variable.name == "friction.coefficient");
/// let friction = friction.expect("the scene has friction");
/// let mut parameters = Parameters::of(scene);
/// parameters.set(friction, 1.96)?;
/// assert_eq!(parameters.get(friction), Some(1.96));
/// assert_eq!(parameters.scene().friction().kinetic, 1.96);
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    layout: Arc<Layout>,
    values: ParameterValues,
}

/// A scene, and the variable to which each value belongs.
#[derive(Debug, PartialEq)]
struct Layout {
    /// The scene without its values, in place of which it has zeros.
    scene: Scene,
    /// The variables that can be set, in the order of [`variables`].
    variables: Vec<Variable>,
}

/// The values alone, as stored in a saved state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ParameterValues {
    /// One value for each variable that can be set, in the order of [`variables`].
    numbers: Vec<f64>,
    /// Choice of method and step, if a tolerance makes it.
    chosen: Option<SavedChoice>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SavedChoice {
    tolerance: f64,
    method: Method,
    /// Internal time step, s.
    step: f64,
}

impl Parameters {
    /// The parameters and inputs of a scene, with its values.
    #[must_use]
    pub fn of(mut scene: Scene) -> Self {
        let mut variables = variables(&scene);
        variables.retain(Variable::is_settable);
        let mut taken =
            |variable: &Variable| take(place_in(&mut scene, variable).expect("the scene has it"));
        let numbers = variables.iter().map(&mut taken).collect();
        let chosen = match &mut scene.selection {
            Selection::Given => None,
            Selection::Preset(preset) => Some(preset.tolerance()),
            Selection::Auto { tolerance } => Some(take(tolerance)),
        };
        let chosen = chosen.map(|tolerance| {
            let method = replace(&mut scene.method, Method::ForwardIncrement);
            SavedChoice { tolerance, method, step: take(&mut scene.step) }
        });
        let layout = Arc::new(Layout { scene, variables });
        Self { layout, values: ParameterValues { numbers, chosen } }
    }

    /// The scene with these values.
    #[must_use]
    pub fn scene(&self) -> Scene {
        let mut scene = self.layout.scene.clone();
        self.write_to(&mut scene);
        scene
    }

    /// Writes these values into a scene that has the same parts.
    pub(super) fn write_to(&self, scene: &mut Scene) {
        for (variable, number) in self.iter() {
            *place_in(scene, variable).expect("the scene has the variable") = number;
        }
        if let Some(SavedChoice { tolerance: chosen, method, step }) = self.values.chosen {
            (scene.method, scene.step) = (method, step);
            if let Selection::Auto { tolerance } = &mut scene.selection {
                *tolerance = chosen;
            }
        }
    }

    /// The variables that can be set, each with its value, in the order of [`variables`].
    pub fn iter(&self) -> impl Iterator<Item = (&Variable, f64)> {
        self.layout.variables.iter().zip(self.values.numbers.iter().copied())
    }

    /// The value of a variable; `None` if it cannot be set in this scene.
    #[must_use]
    pub fn get(&self, variable: &Variable) -> Option<f64> {
        self.place(variable).map(|place| self.number(place))
    }

    /// Sets the value of a variable, which is not checked.
    ///
    /// # Errors
    /// Returns an error if the variable cannot be set.
    pub fn set(&mut self, variable: &Variable, value: f64) -> Result<(), Error> {
        let place = self.place(variable).ok_or_else(|| not_settable(variable))?;
        *self.number_mut(place) = value;
        Ok(())
    }

    /// Index of a variable's value in the vector.
    pub(super) fn place(&self, variable: &Variable) -> Option<usize> {
        self.layout.variables.iter().position(|other| other.is(variable))
    }

    /// The variable whose value has this index in the vector.
    pub(super) fn variable(&self, place: usize) -> Option<&Variable> {
        self.layout.variables.get(place)
    }

    /// The value with this index in the vector.
    pub(super) fn number(&self, place: usize) -> f64 {
        self.values.numbers[place]
    }

    /// The value with this index in the vector, as a mutable reference.
    pub(super) fn number_mut(&mut self, place: usize) -> &mut f64 {
        &mut self.values.numbers[place]
    }

    /// The tolerance that chooses method and step; `None` unless the scene lets an importer choose it.
    pub(crate) fn tolerance(&self) -> Option<f64> {
        let chosen = self
            .values
            .chosen
            .filter(|_| !matches!(self.layout.scene.selection, Selection::Preset(_)));
        chosen.map(|chosen| chosen.tolerance)
    }

    /// Sets the tolerance that chooses method and step, if one does.
    pub(crate) fn set_tolerance(&mut self, value: f64) {
        if let Some(chosen) = &mut self.values.chosen {
            chosen.tolerance = value;
        }
    }

    /// Records the method and step (s) that a tolerance has chosen.
    pub(super) fn set_choice(&mut self, method: Method, step: f64) {
        if let Some(chosen) = &mut self.values.chosen {
            (chosen.method, chosen.step) = (method, step);
        }
    }

    /// The values alone.
    pub(crate) fn values(&self) -> &ParameterValues {
        &self.values
    }

    /// Returns these parameters and inputs with other values.
    ///
    /// # Errors
    /// Returns an error if the values are those of another scene, or impossible in every run.
    pub(crate) fn with_values(&self, values: ParameterValues) -> Result<Self, Error> {
        let is_like = values.numbers.len() == self.values.numbers.len()
            && values.chosen.is_some() == self.values.chosen.is_some();
        if !is_like {
            return Err(Error::saved_state(
                "the saved state belongs to a scene of another structure",
            ));
        }
        Ok(Self { layout: Arc::clone(&self.layout), values })
    }

    /// Refuses values that are impossible in every run. Their combination is checked for the scene as a whole, and at
    /// each step.
    ///
    /// # Errors
    /// Returns an error with the first such variable, its value, and what would be right.
    pub(super) fn check(&self) -> Result<(), Error> {
        for (variable, value) in self.iter() {
            if let Some(wish) = rule(variable).broken_by(value) {
                return Err(Error::saved_state(format!(
                    "the saved state has {}",
                    impossible(variable, value, wish)
                )));
            }
        }
        if let Some(SavedChoice { step, .. }) = self.values.chosen
            && let Some(wish) = Rule::TIME.broken_by(step)
        {
            return Err(Error::saved_state(format!(
                "the saved state has a step of {step}: {wish}"
            )));
        }
        Ok(())
    }

    /// `true` if a simulation with these values can take the others without being made anew: they differ at most in
    /// values that may change during a run, or that matter only at its start.
    pub(super) fn differ_in_motion_alone(&self, others: &Self) -> bool {
        let is_fixed = |variable: &Variable| {
            !variable.is_tunable()
                && !matches!(
                    variable.template.quantity,
                    Quantity::InitialDisplacement | Quantity::InitialVelocity
                )
        };
        (Arc::ptr_eq(&self.layout, &others.layout) || self.layout == others.layout)
            && self.values.chosen == others.values.chosen
            && self
                .iter()
                .zip(&others.values.numbers)
                .all(|((variable, a), b)| a == *b || !is_fixed(variable))
    }
}

/// Error for setting a variable that has no value of its own.
pub(super) fn not_settable(variable: &Variable) -> Error {
    Error::variable(format!("{} cannot be set: it is an output", variable.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BUILTIN, Preset};

    /// The scene with all values changed and, if a tolerance chooses method and step, another choice.
    fn changed(original: &Scene) -> Scene {
        let mut scene = original.clone();
        let known = variables(original);
        for (variable, value) in known.iter().filter(|one| one.is_settable()).zip(1_u16..) {
            *place_in(&mut scene, variable).unwrap() = f64::from(value);
        }
        if original.selection != Selection::Given {
            (scene.method, scene.step) = (Method::EventDriven, 0.5);
        }
        if let Selection::Auto { tolerance } = &mut scene.selection {
            *tolerance = 0.25;
        }
        scene
    }

    #[test]
    fn the_values_make_the_scene_again_what_it_was() {
        let selections = [
            Selection::Given,
            Selection::Preset(Preset::Preview),
            Selection::Auto { tolerance: 1e-3 },
        ];
        for (builtin, selection) in BUILTIN.iter().zip(selections.into_iter().cycle()) {
            let original = Scene { selection, ..builtin.scene() };
            let changed = changed(&original);
            let values = Parameters::of(changed.clone()).values;
            let again = Parameters::of(original).with_values(values).unwrap();
            assert_eq!(again.scene(), changed);
        }
    }

    #[test]
    fn a_value_that_is_set_is_read_again_and_is_in_the_scene() {
        let scene = BUILTIN[0].scene();
        let mut parameters = Parameters::of(scene.clone());
        let mut values = 1_u16..;
        for variable in &variables(&scene) {
            if variable.is_settable() {
                let value = values.next().map(f64::from).unwrap();
                parameters.set(variable, value).unwrap();
                assert_eq!(parameters.get(variable), Some(value));
            } else {
                parameters.set(variable, 1.0).unwrap_err();
                assert_eq!(parameters.get(variable), None);
            }
        }
        assert_eq!(parameters.scene(), changed(&scene));
    }

    #[test]
    fn the_values_of_another_scene_are_refused() {
        let original = BUILTIN[0].scene();
        let values = Parameters::of(original.clone()).values;
        let mut damped = original.clone();
        damped.effects.mass_damping = !original.effects.mass_damping;
        let chosen = Scene { selection: Selection::Preset(Preset::Preview), ..original };
        for other in [damped, chosen] {
            let error = Parameters::of(other).with_values(values.clone()).unwrap_err();
            assert!(error.is_saved_state(), "{error}");
        }
    }
}
