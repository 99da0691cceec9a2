//! Of a scene, what an importer or a tolerance may have given another value.

use super::{Variable, read_scene, write_scene};
use crate::Error;
use crate::scene::{Method, Scene, Selection};
use serde::{Deserialize, Serialize};

/// The values that make a scene of an FMU's own again what it was; what a scene goes without has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Given {
    /// Those of the parameters and inputs, in the order of the variables.
    values: Vec<f64>,
    /// Where a tolerance chooses method and step.
    chosen: Option<Chosen>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Chosen {
    tolerance: f64,
    method: Method,
    step: f64,
}

impl Given {
    /// The values of a scene that has these variables.
    pub(crate) fn of(scene: &Scene, variables: &[Variable]) -> Self {
        let values = variables.iter().filter_map(|variable| read_scene(scene, variable)).collect();
        let &Scene { method, step, selection, .. } = scene;
        let chosen = selection.tolerance();
        let chosen = chosen.map(|tolerance| Chosen { tolerance, method, step });
        Self { values, chosen }
    }

    /// The scene with these values, `original` being the one that has these variables.
    ///
    /// # Errors
    /// The values are of another scene, which only forged ones are.
    pub(crate) fn put_into(
        &self,
        original: &Scene,
        variables: &[Variable],
    ) -> Result<Scene, Error> {
        let settable = || variables.iter().filter(|variable| variable.is_settable());
        let is_chosen = original.selection != Selection::Given;
        if self.values.len() != settable().count() || self.chosen.is_some() != is_chosen {
            return Err(Error::saved_state("the saved state is of another structure"));
        }
        let mut scene = original.clone();
        for (variable, &value) in settable().zip(&self.values) {
            write_scene(&mut scene, variable, value)?;
        }
        if let Some(chosen) = self.chosen {
            (scene.method, scene.step) = (chosen.method, chosen.step);
            if let Selection::Auto { tolerance } = &mut scene.selection {
                *tolerance = chosen.tolerance;
            }
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::super::variables;
    use super::*;
    use crate::scene::{BUILTIN, Preset};

    /// Every value another one, and where a tolerance chooses, a choice.
    fn changed(original: &Scene, variables: &[Variable]) -> Scene {
        let mut scene = original.clone();
        for (variable, value) in variables.iter().filter(|one| one.is_settable()).zip(1_u16..) {
            write_scene(&mut scene, variable, f64::from(value)).unwrap();
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
            let variables = variables(&original);
            let changed = changed(&original, &variables);
            let given = Given::of(&changed, &variables);
            assert_eq!(given.put_into(&original, &variables).unwrap(), changed);
        }
    }

    #[test]
    fn the_values_of_another_scene_are_refused() {
        let original = BUILTIN[0].scene();
        let known = variables(&original);
        let given = Given::of(&original, &known);
        let mut damped = original.clone();
        damped.effects.mass_damping = !original.effects.mass_damping;
        let chosen = Scene { selection: Selection::Preset(Preset::Preview), ..original };
        for other in [damped, chosen] {
            let error = given.put_into(&other, &variables(&other)).unwrap_err();
            assert!(error.is_saved_state(), "{error}");
        }
    }
}
