//! What is possible, but hardly meant.

use super::Simulation;
use super::doubts::doubts;
use crate::model::LumpedModel;
use crate::scene::{Method, Pulse, Scene, Selection, Shape, Signal, Sine};
use crate::stability::critical_step;

/// A critical step this many times the given one is more than accuracy asks for.
const SUSPICIOUS: f64 = 1e3;

/// Words on a step that does not go with the scene: more than a thousand times below the critical
/// step, or above it. A stiffness or mass in other units than SI shows so.
#[must_use]
pub fn step_warning(scene: &Scene) -> Option<String> {
    // What a tolerance has chosen is as short as that asks for.
    if scene.method != Method::ForwardIncrement || scene.selection != Selection::Given {
        return None;
    }
    let mut model = LumpedModel::from(scene);
    model.raise_friction(scene);
    let critical = critical_step(&model, scene.friction_coefficient).ok()?;
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

/// All of it: the step, contacts without load, signals that the step cannot follow, values that look like those of
/// another unit.
#[must_use]
pub fn warnings(simulation: &Simulation) -> Vec<String> {
    let step = step_warning(simulation.acting()).into_iter();
    let tolerance = simulation.selected().and_then(|selected| selected.shortfall());
    let scene = simulation.scene();
    // What a tolerance has chosen follows the signals as well as it asks for.
    let signals = signal_warnings(scene).filter(|_| scene.selection == Selection::Given);
    let direction = direction_warning(simulation.acting());
    let words = step.chain(tolerance).chain(load_warnings(simulation));
    words.chain(doubts(simulation)).chain(direction).chain(signals).collect()
}

/// Contacts whose friction has the direction of a surface that stands still.
fn direction_warning(scene: &Scene) -> Option<String> {
    if !scene.effects.has_frozen_slip(scene.contact_law().friction) {
        return None;
    }
    let common = scene.slider.velocity;
    let places = scene.network().map_or(&[][..], |network| &network.contacts);
    let stands = if scene.network().is_none() {
        common == 0.0
    } else {
        places.iter().any(|place| place.velocity.unwrap_or(common) == 0.0)
    };
    stands.then(|| {
        "friction without sticking has the direction of the surface's velocity: where that is zero \
         there is none"
            .to_owned()
    })
}

/// Signals that change faster than the step can follow.
fn signal_warnings(scene: &Scene) -> impl Iterator<Item = String> + '_ {
    const STEPS_A_PERIOD: f64 = 10.0;
    let of = |(i, signal): (usize, &Signal)| {
        let step = scene.step;
        let fault = match signal.shape {
            Shape::Sine(Sine { frequency, .. }) if frequency * step * STEPS_A_PERIOD > 1.0 => {
                "has fewer than ten steps a period"
            }
            Shape::Pulse(Pulse { start, end: Some(end), .. }) if end - start < step => {
                "is shorter than a step"
            }
            _ => return None,
        };
        let name = &signal.input;
        Some(format!("signal[{}] on {name} {fault}; integrator.step = {step:e} s", i + 1))
    };
    scene.signals.iter().enumerate().filter_map(of)
}

/// Contacts that nothing presses on in the equilibrium, by name: their load may have been forgotten.
fn load_warnings(simulation: &Simulation) -> Vec<String> {
    let scene = simulation.scene();
    if scene.network().is_none() && !scene.effects.preload {
        return vec![
            "the ring has no preload, so no contact carries load in the equilibrium; \
             write `preload` into its [ring]"
                .to_owned(),
        ];
    }
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
    use crate::scene::{BUILTIN, Structure, builtin, parse};

    #[test]
    fn stiffnesses_in_newtons_a_millimetre_stand_out_and_the_built_in_scenes_do_not() {
        for builtin in BUILTIN {
            let warnings = warnings(&Simulation::new(builtin.scene(), 0.0).unwrap());
            assert!(warnings.is_empty(), "{}: {warnings:?}", builtin.name);
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
        let warnings = warnings(&Simulation::new(scene, 0.0).unwrap());
        assert!(warnings.len() == 1 && warnings[0].contains("contact.belt"), "{warnings:?}");
    }

    #[test]
    fn signals_that_fall_between_the_steps_stand_out() {
        let text = builtin("belt").unwrap().text;
        let signal = |shape: &str| {
            let signal = format!("[[signal]]\ninput = \"mass.block.fx\"\n{shape}");
            let scene = parse("mine", &format!("{text}{signal}")).unwrap();
            warnings(&Simulation::new(scene, 0.0).unwrap())
        };
        for (shape, count) in [
            ("sine = { amplitude = 1.0, frequency = 399.0 }", 0),
            ("sine = { amplitude = 1.0, frequency = 401.0 }", 1),
            ("pulse = { value = 1.0, start = 0.1, end = 0.1003 }", 0),
            ("pulse = { value = 1.0, start = 0.1, end = 0.1002 }", 1),
            ("pulse = { value = 1.0, start = 0.1 }", 0),
        ] {
            assert_eq!(signal(shape).len(), count, "{shape}");
        }
    }
}
