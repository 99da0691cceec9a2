//! Derivatives of outputs by inputs and by time, against differences and closed forms.

use amontons::contact::ContactState;
use amontons::scene::{BUILTIN, Method, Role, Scene, builtin, parse};
use amontons::simulation::catalogue::{Causality, Kind, Variability};
use amontons::simulation::{Parameters, Simulation, Variable, variables, write_scene};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Two masses that rub on each other at an angle, of which one rubs on the slider: what friction does at one contact
/// presses on the other.
fn rubbing(friction: &str, own: &str, effects: &str, push: f64) -> Scene {
    let text = format!(
        "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\n{friction}\n\
         [[mass]]\nname = \"a\"\nmass = 1.0\nforce = [2.0, -10.0]\n\
         [[mass]]\nname = \"b\"\nmass = 2.0\nforce = [0.0, -10.0]\n\
         [[spring]]\nname = \"k1\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 300.0\n\
         [[spring]]\nname = \"k2\"\nbetween = [\"a\", \"ground\"]\ndirection = 1.0\nstiffness = 400.0\n\
         preload = 0.001\n\
         [[spring]]\nname = \"k3\"\nbetween = [\"b\", \"ground\"]\ndirection = 0.7\nstiffness = 600.0\n\
         [[contact]]\nname = \"upper\"\nmass = \"a\"\non = \"b\"\nangle = 0.4\nvelocity = 0.2\n{own}\n\
         [[contact]]\nname = \"lower\"\nmass = \"b\"\n\
         [[initial]]\nmass = \"a\"\nvx = {push}\n[[initial]]\nmass = \"b\"\nvx = {push}\n[effects]\nenergy = true\nstability = true\n{effects}\n\
         [integrator]\nstep = 1e-4\n[experiment]\nstop_time = 20.0\n"
    );
    parse("rubbing", &text).unwrap()
}

/// All scenes that are shipped, and masses that rub on each other, with each method that takes them.
fn scenes() -> Vec<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/effects");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let effects = files.map(|file| {
        let name = file.file_stem().unwrap().to_str().unwrap();
        parse(name, &fs::read_to_string(&file).unwrap()).unwrap()
    });
    let stribeck = "coefficient = 0.3\nstatic = 0.5\nstribeck_velocity = 0.1";
    let rubbing = [
        rubbing("coefficient = 0.4", "", "", 0.3),
        rubbing("coefficient = 0.4\nstatic = 0.5", "", "", 0.3),
        rubbing(stribeck, "", "", 0.3),
        rubbing(stribeck, "friction = 0.2", "", 0.3),
        rubbing(stribeck, "friction = 0.2\nstatic_friction = 0.4", "", 0.3),
        // Contacts that cannot open are pulled, and friction follows |N|.
        rubbing("coefficient = 0.4", "", "detachment = false", 3.0),
    ];
    let all = BUILTIN.iter().map(|scene| scene.scene()).chain(effects).chain(rubbing);
    let with = |mut scene: Scene| {
        scene.roles.preload = Role::Input;
        [Method::ForwardIncrement, Method::EventDriven]
            .map(|method| Scene { method, ..scene.clone() })
    };
    all.flat_map(with).filter(|scene| Simulation::new(scene.clone(), 0.0).is_ok()).collect()
}

fn inputs(scene: &Scene) -> Vec<Variable> {
    let all = variables(scene).into_iter();
    all.filter(|variable| variable.causality == Causality::Input).collect()
}

/// The continuous outputs.
fn outputs(scene: &Scene) -> Vec<Variable> {
    let is_continuous = |variable: &Variable| {
        variable.causality == Causality::Output
            && variable.variability == Variability::Continuous
            && matches!(variable.template.kind, Kind::Real { .. })
    };
    variables(scene).into_iter().filter(is_continuous).collect()
}

fn read(simulation: &mut Simulation, of: &[Variable]) -> Vec<f64> {
    of.iter().map(|variable| simulation.read(variable).unwrap()).collect()
}

fn states(simulation: &mut Simulation) -> Vec<ContactState> {
    simulation.contact_forces().unwrap().iter().map(|force| force.state).collect()
}

/// `true` if a difference agrees with a derivative up to its truncation and the rounding of values of this size.
fn is_near(derivative: f64, difference: f64, size: f64, h: f64) -> bool {
    (derivative - difference).abs() <= 1e-6 * derivative.abs() + 1e-12 * (size / h + 1.0)
}

#[test]
fn derivatives_by_inputs_are_those_of_differences_in_every_contact_state() {
    let mut met = BTreeMap::<u8, usize>::new();
    let (mut compared, mut other_than_zero, mut pulled) = (0, 0, 0);
    for scene in scenes() {
        let (inputs, outputs) = (inputs(&scene), outputs(&scene));
        let of: Vec<&Variable> = outputs.iter().collect();
        let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
        for moment in 1..=24 {
            let time = 0.05 * scene.experiment.stop_time * f64::from(moment) / 24.0;
            simulation.advance_to(time).unwrap();
            let now = states(&mut simulation);
            let values = read(&mut simulation, &outputs);
            for input in &inputs {
                let value = simulation.nominal().get(input).unwrap();
                let h = 1e-4 * value.abs().max(1e-2);
                let found = simulation.directional_derivative(&of, &[(input, 1.0)]).unwrap();
                let mut ends = Vec::new();
                for value in [value - h, value + h, value] {
                    simulation.write(input, value).unwrap();
                    ends.push((states(&mut simulation), read(&mut simulation, &outputs)));
                }
                if ends.iter().any(|(states, _)| *states != now) {
                    continue;
                }
                for (i, output) in outputs.iter().enumerate() {
                    let difference = (ends[1].1[i] - ends[0].1[i]) / (2.0 * h);
                    let size = values[i].abs().max(ends[0].1[i].abs());
                    assert!(
                        is_near(found[i], difference, size, h),
                        "{} at {time} s in {now:?}: d{}/d{} = {}, by differences {difference}",
                        scene.name,
                        output.name,
                        input.name,
                        found[i],
                    );
                    compared += 1;
                    other_than_zero += usize::from(found[i] != 0.0);
                }
                now.iter().for_each(|state| *met.entry(*state as u8).or_default() += 1);
                let forces = simulation.contact_forces().unwrap();
                pulled += forces.iter().filter(|force| force.normal_force < 0.0).count();
            }
        }
    }
    println!(
        "{compared} derivatives, {other_than_zero} other than zero, in states {met:?}, {pulled} of them pulled"
    );
    assert!(pulled > 10);
    assert!(met.len() == 4 && other_than_zero > 5_000);
}

#[test]
fn before_a_run_starts_the_equilibrium_moves_with_the_inputs() {
    let (mut compared, mut other_than_zero) = (0, 0);
    for scene in scenes() {
        let (inputs, outputs) = (inputs(&scene), outputs(&scene));
        let of: Vec<&Variable> = outputs.iter().collect();
        let mut start = Simulation::new(scene.clone(), 0.0).unwrap();
        let now = states(&mut start);
        for input in &inputs {
            let value = Parameters::of(scene.clone()).get(input).unwrap();
            let h = 1e-4 * value.abs().max(1e-2);
            let found = start.directional_derivative_at_start(&of, &[(input, 1.0)]).unwrap();
            let at = |value| {
                let mut other = scene.clone();
                write_scene(&mut other, input, value).unwrap();
                let mut other = Simulation::new(other, 0.0).ok()?;
                (states(&mut other) == now).then(|| read(&mut other, &outputs))
            };
            let (Some(low), Some(high)) = (at(value - h), at(value + h)) else { continue };
            for (i, output) in outputs.iter().enumerate() {
                let difference = (high[i] - low[i]) / (2.0 * h);
                assert!(
                    is_near(found[i], difference, high[i].abs().max(low[i].abs()), h),
                    "{}: d{}/d{} = {}, by differences {difference}",
                    scene.name,
                    output.name,
                    input.name,
                    found[i],
                );
                compared += 1;
                other_than_zero += usize::from(found[i] != 0.0);
            }
        }
    }
    println!("{compared} derivatives, {other_than_zero} other than zero");
    assert!(other_than_zero > 300);
}

/// Exact motion, and inputs that signals drive, so that differences over time are those of the motion alone.
#[test]
fn derivatives_by_time_are_those_of_differences_along_exact_motion() {
    let signals = "[inputs]\npreload = \"input\"\n[[signal]]\ninput = \"slider.velocity\"\n\
        sine = { amplitude = 0.002, frequency = 20.0 }\n\
        [[signal]]\ninput = \"module[1].f1\"\nramp = { to = 2.0, end = 0.2 }\n\
        [[signal]]\ninput = \"module[2].preload\"\nramp = { to = 1e-4, end = 0.2 }\n";
    let source = builtin("set1").unwrap().text;
    let (mut compared, mut met) = (0, BTreeMap::<u8, usize>::new());
    for text in [source.to_owned(), format!("{source}\n{signals}")] {
        let mut scene = parse("set1", &text).unwrap();
        (scene.method, scene.step) = (Method::EventDriven, 1e-4);
        (scene.effects.energy, scene.friction_coefficient) = (true, 2.0);
        scene.modules_mut()[0].velocity = [0.8, -0.5, 0.0, 0.0];
        let outputs = outputs(&scene);
        let of: Vec<&Variable> = outputs.iter().collect();
        let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
        let mut pairs = vec![Vec::new(); outputs.len()];
        for moment in 1..=300 {
            let (time, h) = (5e-4 * f64::from(moment), 2e-6);
            let (mut ends, mut found) = (Vec::new(), Vec::new());
            for place in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                simulation.advance_to(time + place * h).unwrap();
                let changes = simulation.statistics().state_changes();
                ends.push((changes, states(&mut simulation), read(&mut simulation, &outputs)));
                if place == 0.0 {
                    found = simulation.rates(&of).unwrap();
                }
            }
            if ends.iter().any(|end| (&end.0, &end.1) != (&ends[0].0, &ends[0].1)) {
                continue;
            }
            ends[0].1.iter().for_each(|state| *met.entry(*state as u8).or_default() += 1);
            for (i, pairs) in pairs.iter_mut().enumerate() {
                let at = |place: usize| ends[place].2[i];
                let difference = (8.0 * (at(3) - at(1)) - (at(4) - at(0))) / (12.0 * h);
                pairs.push((time, found[i], difference));
            }
        }
        for (output, pairs) in outputs.iter().zip(&pairs) {
            if output.name == "energy.residual" {
                // Differences of what rounding leaves say nothing.
                assert!(pairs.iter().all(|(_, found, _)| found.abs() < 1e-12));
                continue;
            }
            let size = pairs.iter().fold(1e-5, |size, pair| f64::max(size, pair.2.abs()));
            for (time, found, difference) in pairs {
                // (ω h)⁴, where ω = 2π · 2 kHz is above all modes, and what rounding leaves.
                assert!(
                    (found - difference).abs() < 1e-6 * size,
                    "at {time} s: d{}/dt = {found}, by differences {difference}, at most {size}",
                    output.name,
                );
                compared += 1;
            }
        }
    }
    println!("{compared} rates, in states {met:?}");
    assert!(met.len() == 4 && compared > 10_000);
}

#[test]
fn growth_rate_and_frequency_have_no_derivatives() {
    let scene = rubbing("coefficient = 0.4", "", "", 0.3);
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    let inputs = inputs(&scene);
    let by: Vec<(&Variable, f64)> = inputs.iter().map(|input| (input, 1.0)).collect();
    for name in ["stability.growth_rate", "stability.frequency"] {
        let of = variables(&scene).into_iter().find(|variable| variable.name == name).unwrap();
        assert_eq!(of.variability, Variability::Discrete);
        let answers = [
            simulation.directional_derivative_at_start(&[&of], &by),
            simulation.directional_derivative(&[&of], &by),
            simulation.rates(&[&of]),
        ];
        for answer in answers {
            let message = answer.unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("discrete"), "{message}");
        }
    }
}
