//! Warnings about values that are possible, but hardly meant.

use crate::doubts::doubts;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::model::{Equilibrium, LumpedModel, Uniqueness};
use amontons::scene::{Method, Pulse, Scene, Selection, Shape, Signal, Sine};
use amontons::simulation::Simulation;
use amontons::simulation::catalogue::{Quantity, variables};
use amontons::stability::{Origin, critical_step};

/// A critical step this many times the given one is more than accuracy asks for.
const SUSPICIOUS: f64 = 1e3;

/// The most open contacts that a warning names.
const NAMED: usize = 3;
/// Digits of a gap in a warning.
const DIGITS: usize = 4;

/// Words on a step that does not go with the scene: more than a thousand times below the critical
/// step, or above it. A stiffness or mass in other units than SI shows so.
#[must_use]
pub fn step_warning(scene: &Scene) -> Option<String> {
    // A step that a tolerance has chosen is as short as the tolerance requires.
    if scene.method != Method::ForwardIncrement || scene.selection != Selection::Given {
        return None;
    }
    let critical = critical_step(&LumpedModel::from(scene)).ok()?;
    let (step, relation) = match scene.step {
        step if step > critical.step
            && matches!(critical.origin, Origin::Bound | Origin::Alike) =>
        {
            (step, "possibly above the critical step")
        }
        step if step > critical.step => (step, "above the critical step"),
        step if SUSPICIOUS * step < critical.step => {
            (step, "more than a thousand times below the critical step")
        }
        _ => return None,
    };
    Some(format!(
        "integrator.step = {step:e} s is {relation}, {critical}; check that stiffnesses are in \
         N/m and masses in kg"
    ))
}

/// All warnings: the step, contacts without load or that the load opens, other equilibria, signals that the step cannot follow, values that look like those of
/// another unit.
#[must_use]
pub fn warnings(simulation: &Simulation) -> Vec<String> {
    let step = step_warning(simulation.scene()).into_iter();
    let tolerance = simulation.selected().and_then(|selected| selected.shortfall());
    let scene = simulation.scene();
    // A step that a tolerance has chosen follows the signals as well as the tolerance requires, and event-driven motion
    // follows them within its steps.
    let is_held = scene.method == Method::ForwardIncrement && scene.selection == Selection::Given;
    let signals = signal_warnings(scene).filter(|_| is_held);
    let direction = direction_warning(simulation.scene());
    let steps = step_at_start_warnings(scene);
    step.chain(tolerance)
        .chain(load_warnings(simulation))
        .chain(equilibrium_warnings(simulation))
        .chain(doubts(simulation))
        .chain(direction)
        .chain(signals)
        .chain(steps)
        .collect()
}

/// Contacts whose friction has the direction of a surface that stands still.
fn direction_warning(scene: &Scene) -> Option<String> {
    if !scene.effects.has_fixed_direction(scene.contact_law().friction) {
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
        "without sticking, friction has the direction of the surface's velocity, so a contact on a surface that stands \
         still has no friction"
            .to_owned()
    })
}

/// Signals that change faster than the step of the paper's scheme can follow.
fn signal_warnings(scene: &Scene) -> impl Iterator<Item = String> + '_ {
    const STEPS_A_PERIOD: f64 = 10.0;
    let of = |(i, signal): (usize, &Signal)| {
        let step = scene.step;
        let fault = match signal.shape {
            Shape::Sine(Sine { frequency, .. }) if frequency * step * STEPS_A_PERIOD > 1.0 => {
                "has fewer than ten steps per period"
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

/// Signals that are not zero at t = 0, where that is a step: a force is not part of the equilibrium in which a run
/// begins; what else is switched on at t = 0 is, so that nothing of its step is seen.
fn step_at_start_warnings(scene: &Scene) -> Vec<String> {
    let forces: Vec<String> = variables(scene)
        .into_iter()
        .filter(|variable| variable.template.quantity == Quantity::ExternalForce)
        .map(|variable| variable.name)
        .collect();
    let of = |(i, signal): (usize, &Signal)| {
        let (value, input) = (signal.shape.at(0.0, 0.0), &signal.input);
        let is_switched_on = matches!(
            &signal.shape,
            Shape::Pulse(Pulse { start, .. }) | Shape::Sine(Sine { start, .. }) if *start == 0.0
        );
        let consequence = if forces.contains(input) {
            "a run begins at rest in the equilibrium without this force; write a load that always acts into the scene, or \
             let the signal begin at zero"
        } else if is_switched_on {
            "a run begins in the equilibrium with this value, so the step has no effect; let the signal begin later"
        } else {
            return None;
        };
        (value != 0.0).then(|| {
            let value = Short(value);
            format!("signal[{}] on {input} is a step to {value} at t = 0: {consequence}", i + 1)
        })
    };
    scene.signals.iter().enumerate().filter_map(of).collect()
}

/// Contacts that the load opens, and other equilibria.
fn equilibrium_warnings(simulation: &Simulation) -> Vec<String> {
    let (scene, here) = (simulation.scene(), simulation.reference());
    let unloaded = LumpedModel::from(scene);
    let mut warnings: Vec<String> = opened(scene, here, &unloaded).into_iter().collect();
    match unloaded.uniqueness(here) {
        Uniqueness::One => {}
        Uniqueness::Unknown => {
            if here.gap.iter().any(|gap| *gap > 0.0) {
                warnings.push(
                    "whether the equilibrium is the only one is unknown: friction may let other contacts close or open"
                        .to_owned(),
                );
            }
        }
        Uniqueness::Several(other) => {
            let differ: Vec<String> = (0..here.gap.len())
                .filter(|i| here.is_closed(*i) != other.is_closed(*i))
                .map(|i| {
                    let is = if here.is_closed(i) { "open" } else { "closed" };
                    format!("{} {is}", scene.contact_name(i))
                })
                .collect();
            warnings.push(if differ.is_empty() {
                "the forces of the contacts in the equilibrium are not the only ones: contacts that hold the same motion can share \
                 a load in several ways; leave out contacts that others make needless"
                    .to_owned()
            } else {
                format!(
                    "friction allows a second equilibrium, with {}; a run begins in the first, and lower friction leaves one",
                    differ.join(", ")
                )
            });
        }
    }
    warnings
}

/// Contacts that the load opens, in one sentence.
fn opened(scene: &Scene, here: &Equilibrium, unloaded: &LumpedModel) -> Option<String> {
    let all = here.gap.len();
    let is_opened = |i: &usize| here.gap[*i] > 0.0 && unloaded.contacts[*i].gap == 0.0;
    let opened: Vec<usize> = (0..all).filter(is_opened).collect();
    let most = opened.iter().fold(0.0_f64, |most, i| most.max(here.gap[*i]));
    let most = Short(to_significant(most, DIGITS));
    match opened[..] {
        [] => None,
        [one] => Some(format!(
            "the load opens {} in the equilibrium, by {most} m; press it on by a preload or a force, unless this is meant",
            scene.contact_name(one)
        )),
        _ if opened.len() == all => Some(format!(
            "all {all} contacts are open in the equilibrium, by up to {most} m: is the normal reversed, or does no load press them on?"
        )),
        _ => {
            let mut names: Vec<String> =
                opened.iter().take(NAMED).map(|i| scene.contact_name(*i)).collect();
            if opened.len() > NAMED {
                names.push("...".to_owned());
            }
            Some(format!(
                "the load opens {} of {all} contacts in the equilibrium, {}, by up to {most} m; press them on by a preload or a force, \
                 unless this is meant",
                opened.len(),
                names.join(", ")
            ))
        }
    }
}

/// Closed contacts that nothing presses on in the equilibrium, by name: their load may have been forgotten.
fn load_warnings(simulation: &Simulation) -> Vec<String> {
    let scene = simulation.scene();
    if scene.network().is_none() && !scene.effects.preload {
        return vec![
            "the ring has no preload, so no contact carries load in the equilibrium; \
             write `preload` into its [ring]"
                .to_owned(),
        ];
    }
    let here = simulation.reference();
    let forces = here.normal_force.iter().enumerate();
    let idle = forces.filter(|(i, force)| **force == 0.0 && here.is_closed(*i));
    let warning = |(i, _)| {
        format!(
            "{} carries no load in the equilibrium; load it by a preload or a force",
            scene.contact_name(i)
        )
    };
    idle.map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{BUILTIN, Line, Point, Spring, Structure, builtin, parse};

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
    fn a_contact_that_the_load_opens_stands_out_and_a_stop_with_a_gap_does_not() {
        let mut scene = builtin("belt").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { panic!("it is a network") };
        network.masses[0].load = [0.0, 3.0];
        network.springs.push(Spring {
            name: "across".into(),
            between: [Some(Point::Mass(0)), None],
            direction: Line::Angle(std::f64::consts::FRAC_PI_2),
            stiffness: 1e4,
            preload: None,
        });
        let here = warnings(&Simulation::new(scene.clone(), 0.0).unwrap());
        let said = "the load opens contact.belt in the equilibrium, by 0.0003 m";
        assert!(here.len() == 1 && here[0].starts_with(said), "{here:?}");
        let Structure::Network(network) = &mut scene.structure else { panic!("it is a network") };
        network.contacts[0].gap = 1e-3;
        assert!(warnings(&Simulation::new(scene, 0.0).unwrap()).is_empty());
    }

    /// Blocks of their own on a belt, each lifted by a load against a spring: a force of 3 N against 10 kN/m opens 0.3 mm.
    fn blocks(loads: &[f64]) -> Vec<String> {
        let mut text = String::from(
            "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 0.1\n[integrator]\nmethod = \"event-driven\"\nstep = 1e-4\n",
        );
        for (i, load) in loads.iter().enumerate() {
            text += &format!(
                "[[mass]]\nname = \"m{i}\"\nmass = 1.0\nforce = [0.0, {load:?}]\n\
                 [[spring]]\nname = \"x{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e4\n\
                 [[spring]]\nname = \"y{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = \"y\"\nstiffness = 1e4\n\
                 [[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\n"
            );
        }
        warnings(&Simulation::new(parse("blocks", &text).unwrap(), 0.0).unwrap())
    }

    #[test]
    fn many_contacts_that_the_load_opens_are_told_in_one_sentence() {
        let here = blocks(&[1.0, -5.0, 2.0, 3.0, 1.0 / 3.0]);
        let said = "the load opens 4 of 5 contacts in the equilibrium, contact.c0, contact.c2, contact.c3, ..., by up to 0.0003 m; press";
        assert!(here.len() == 1 && here[0].starts_with(said), "{here:?}");
        let here = blocks(&[-5.0, 2.0, 1.0 / 3.0]);
        let said = "the load opens 2 of 3 contacts in the equilibrium, contact.c1, contact.c2, by up to 0.0002 m";
        assert!(here.len() == 1 && here[0].starts_with(said), "{here:?}");
        let here = blocks(&[-5.0, 1.0 / 3.0]);
        assert!(here.len() == 1 && here[0].contains("by 3.333e-5 m"), "{here:?}");
    }

    #[test]
    fn a_scene_in_which_all_contacts_are_open_asks_for_the_normal_and_the_load() {
        let here = blocks(&[1.0, 2.0, 3.0]);
        let said = "all 3 contacts are open in the equilibrium, by up to 0.0003 m: is the normal reversed, or does no load";
        assert!(here.len() == 1 && here[0].starts_with(said), "{here:?}");
    }

    /// Beyond µ = 4 a wedge holds itself against a load that lifts it, and may also be open.
    #[test]
    fn a_second_equilibrium_stands_out() {
        let text = "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 9.0\n\
                    [integrator]\nmethod = \"event-driven\"\nstep = 1e-4\n\
                    [[mass]]\nname = \"m\"\nmass = 1.0\nforce = [0.0, 3.0]\n\
                    [[spring]]\nname = \"a\"\nbetween = [\"m\", \"ground\"]\ndirection = 0.7853981633974483\n\
                    stiffness = 2e3\n\
                    [[spring]]\nname = \"x\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 3e3\n\
                    [[contact]]\nname = \"c\"\nmass = \"m\"\n";
        // K = [[4, 1], [1, 1]] kN/m: N (4 − µ) = −12 N.
        let simulation = Simulation::new(parse("wedge", text).unwrap(), 0.0).unwrap();
        assert!((simulation.reference().normal_force[0] - 2.4).abs() < 1e-9);
        let here = warnings(&simulation);
        let said = "friction allows a second equilibrium, with contact.c open";
        assert!(here.iter().any(|warning| warning.starts_with(said)), "{here:?}");
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
            // Steps of a force at t = 0.
            ("pulse = { value = 1.0 }", 1),
            ("constant = { value = 1.0 }", 1),
            ("ramp = { from = 1.0, to = 2.0, end = 1.0 }", 1),
            ("sine = { amplitude = 1.0, frequency = 1.0, phase = 1.0 }", 1),
            ("sine = { amplitude = 1.0, frequency = 1.0, phase = 1.0, start = 0.1 }", 0),
        ] {
            assert_eq!(signal(shape).len(), count, "{shape}");
        }
    }

    /// Event-driven motion follows a sine within its steps, and stops at both edges of a pulse.
    #[test]
    fn signals_within_a_step_of_event_driven_motion_do_not_stand_out() {
        let text = builtin("belt").unwrap().text;
        for shape in [
            "sine = { amplitude = 1.0, frequency = 401.0 }",
            "pulse = { value = 1.0, start = 0.1, end = 0.1002 }",
        ] {
            let signal = format!("[[signal]]\ninput = \"mass.block.fx\"\n{shape}");
            let mut scene = parse("mine", &format!("{text}{signal}")).unwrap();
            scene.method = Method::EventDriven;
            let warnings = warnings(&Simulation::new(scene, 0.0).unwrap());
            assert!(warnings.is_empty(), "{warnings:?}");
        }
    }

    /// A force at t = 0 moves the block; a belt that has its speed from t = 0 on is part of the equilibrium.
    #[test]
    fn a_step_at_the_start_is_warned_of_as_what_a_run_makes_of_it() {
        let text = builtin("belt").unwrap().text;
        for (input, shape, words, moves) in [
            ("mass.block.fx", "constant = { value = 1.0 }", "without this force", true),
            ("slider.velocity", "pulse = { value = 1.0 }", "the step has no effect", false),
        ] {
            let signal = format!("[[signal]]\ninput = \"{input}\"\n{shape}\n");
            let mut scene = parse("mine", &format!("{text}{signal}")).unwrap();
            scene.rest();
            let mut run = Simulation::new(scene, 0.0).unwrap();
            let found = warnings(&run);
            assert!(found.len() == 1 && found[0].contains(words), "{found:?}");
            run.advance_to(0.05).unwrap();
            assert_eq!(run.displacement().iter().any(|x| x.abs() > 1e-9), moves);
        }
    }
}
