//! What is possible, but hardly meant.

use crate::model::LumpedModel;
use crate::scene::{Method, Scene};
use crate::stability::critical_step;

/// A critical step this many times the given one is more than accuracy asks for.
const SUSPICIOUS: f64 = 1e3;

/// Words on a step that does not go with the scene: more than a thousand times below the critical
/// step, or above it. A stiffness or mass in other units than SI shows so.
#[must_use]
pub fn step_warning(scene: &Scene) -> Option<String> {
    if scene.method != Method::ForwardIncrement {
        return None;
    }
    let critical = critical_step(&LumpedModel::from(scene), scene.friction_coefficient).ok()?;
    let (step, relation) = match scene.step {
        step if step > critical.step => (step, "above the critical step"),
        step if SUSPICIOUS * step < critical.step => {
            (step, "more than a thousand times below the critical step")
        }
        _ => return None,
    };
    Some(format!(
        "integrator.step = {step:e} s is {relation}, {critical}; is a stiffness given in N/m and a \
         mass in kg?"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BUILTIN, builtin};

    #[test]
    fn stiffnesses_in_newtons_a_millimetre_stand_out_and_the_built_in_scenes_do_not() {
        for builtin in BUILTIN {
            assert_eq!(step_warning(&builtin.scene()), None, "{}", builtin.name);
        }
        let mut scene = builtin("set1").unwrap().scene();
        for module in scene.modules_mut() {
            module.stiffness = module.stiffness.map(|stiffness| 1e-3 * stiffness);
        }
        let warning = step_warning(&scene).unwrap();
        assert!(warning.contains("a thousand times below") && warning.contains("N/m"), "{warning}");
        for module in scene.modules_mut() {
            module.stiffness = module.stiffness.map(|stiffness| 1e9 * stiffness);
        }
        let warning = step_warning(&scene).unwrap();
        assert!(warning.contains("is above the critical step"), "{warning}");
    }
}
