//! What is possible, but hardly meant.

use super::Simulation;
use crate::model::LumpedModel;
use crate::scene::Scene;
use crate::stability::critical_step;

/// A critical step this many times the given one is more than accuracy asks for.
const SUSPICIOUS: f64 = 1e3;

/// Words on a step that does not go with the scene: more than a thousand times below the critical
/// step, or above it. A stiffness or mass in other units than SI shows so.
#[must_use]
pub fn step_warning(scene: &Scene) -> Option<String> {
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

/// Contacts that nothing presses on in the equilibrium, by name: their load may have been forgotten.
#[must_use]
pub fn load_warnings(simulation: &Simulation) -> Vec<String> {
    let scene = simulation.scene();
    let forces = simulation.reference().normal_force.iter().enumerate();
    let idle = forces.filter(|(_, force)| **force == 0.0);
    let warning = |(i, _)| {
        format!(
            "{} carries no load in the equilibrium; press it on, by a preload or a force",
            scene.contact_name(i)
        )
    };
    idle.map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BUILTIN, Structure, builtin};

    #[test]
    fn stiffnesses_in_newtons_a_millimetre_stand_out_and_the_built_in_scenes_do_not() {
        for builtin in BUILTIN {
            assert_eq!(step_warning(&builtin.scene()), None, "{}", builtin.name);
            let simulation = Simulation::new(builtin.scene(), 0.0).unwrap();
            assert!(load_warnings(&simulation).is_empty(), "{}", builtin.name);
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

    #[test]
    fn a_contact_whose_load_was_forgotten_stands_out() {
        let mut scene = builtin("belt").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { panic!("it is a network") };
        network.masses[0].load = [0.0; 2];
        let warnings = load_warnings(&Simulation::new(scene, 0.0).unwrap());
        assert!(warnings.len() == 1 && warnings[0].contains("contact.belt"), "{warnings:?}");
    }
}
