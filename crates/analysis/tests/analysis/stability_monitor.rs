//! The stability of the present contact state, as a run reports it, against the whole quadratic problem
//! (paper, eqs. 4–6), the paper's Table 2, and closed forms.

use crate::quadratic;
use amontons::contact::{ContactState, JoinedStates};
use amontons::model::LumpedModel;
use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::{Simulation, variables};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Set 1 with its stability watched, pushed by v1 (m/s).
fn set1(push: f64) -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    scene.effects.stability = true;
    scene.friction_coefficient = 1.96;
    scene.modules_mut()[0].velocity = [push, 0.0, 0.0, 0.0];
    scene
}

fn value(simulation: &mut Simulation, name: &str) -> f64 {
    let variables = variables(simulation.scene());
    simulation.read(variables.iter().find(|variable| variable.name == name).unwrap()).unwrap()
}

fn set(simulation: &mut Simulation, name: &str, value: f64) {
    let variables = variables(simulation.scene());
    simulation.write(variables.iter().find(|v| v.name == name).unwrap(), value).unwrap();
}

/// Growth rate (1/s), frequency (Hz) and number of modes.
fn indicator(simulation: &mut Simulation) -> (f64, f64, f64) {
    let mut read = |name: &str| value(simulation, &format!("stability.{name}"));
    (read("growth_rate"), read("frequency"), read("modes"))
}

fn states(simulation: &mut Simulation) -> Vec<ContactState> {
    let forces = simulation.contact_forces().unwrap();
    forces.iter().map(|force| force.state).collect()
}

/// Expected growth rate, frequency and number of modes, by the whole quadratic problem. Its real eigenvalues are real
/// up to rounding.
fn expected(scene: &Scene, states: &[ContactState]) -> (f64, f64, f64) {
    let model = LumpedModel::from(scene);
    let all = quadratic::eigenvalues(&model, states, scene.friction_coefficient);
    let upper = all.iter().filter(|value| value.im >= -1e-7 * value.norm());
    let fastest = upper.reduce(|a, b| if b.re > a.re { b } else { a }).unwrap();
    let is_real = |value: f64, size: f64| value.abs() <= 1e-7 * size;
    let real = all.iter().filter(|value| is_real(value.im, value.norm())).count();
    let frequency = if is_real(fastest.im, fastest.norm()) { 0.0 } else { fastest.im / TAU };
    (fastest.re, frequency, (real + (all.len() - real) / 2) as f64)
}

/// Half of the digits are lost where two modes nearly coincide, as those of equal modules may; sizes are of
/// hundreds of 1/s.
fn assert_near(found: (f64, f64, f64), expected: (f64, f64, f64)) {
    assert!((found.0 - expected.0).abs() < 1e-6, "growth rates {found:?} {expected:?}");
    assert!((found.1 - expected.1).abs() < 1e-6, "frequencies {found:?} {expected:?}");
    assert_eq!(found.2, expected.2, "modes");
}

#[test]
fn sliding_at_first_it_has_the_paper_s_growth_rate_and_frequency() {
    let scene = set1(0.01);
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    let found = indicator(&mut simulation);
    assert_near(found, expected(&scene, &[ContactState::Slide; 2]));
    let table: serde_json::Value =
        serde_json::from_str(include_str!("../../../../tests/data/table2.json")).unwrap();
    let printed = table["states"]["Sl-Sl"].as_array().unwrap().iter();
    let pairs = printed.map(|pair| [pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap()]);
    let [growth, frequency] = pairs.reduce(|a, b| if b[0] > a[0] { b } else { a }).unwrap();
    // The tolerance is that of tests/physics/tables.rs; the values are printed in Hz.
    assert!((found.0 / TAU - growth).abs() < 0.006 && (found.1 - frequency).abs() < 0.006);
    assert!(found.0 > 0.0);
}

#[test]
fn it_is_what_the_analyser_finds() {
    let scene = set1(0.01);
    let found = indicator(&mut Simulation::new(scene.clone(), 0.0).unwrap());
    let model = LumpedModel::from(&scene);
    let modes =
        amontons_analysis::stability::modes(model.linear().unwrap(), &[ContactState::Slide; 2])
            .unwrap();
    let fastest = modes.all().max_by(|a, b| a.growth_rate().total_cmp(&b.growth_rate())).unwrap();
    assert_near(found, (fastest.growth_rate(), fastest.frequency_hz(), modes.all().count() as f64));
}

#[test]
fn each_state_of_the_limit_cycle_has_its_own_again_whenever_it_is_met() {
    let scene = set1(0.01);
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    simulation.advance_to(4.0).unwrap();
    let mut met = HashMap::new();
    for row in 1..=1000_u32 {
        simulation.advance_to(4.0 + f64::from(row) * 2e-5).unwrap();
        let states = states(&mut simulation);
        let found = indicator(&mut simulation);
        let expected = *met.entry(states.clone()).or_insert_with(|| expected(&scene, &states));
        assert_near(found, expected);
    }
    let names: Vec<String> = met.keys().map(|states| JoinedStates(states).to_string()).collect();
    assert!(met.len() >= 3, "{names:?}");
    assert!(met.values().any(|indicator| indicator.0 < 0.0));
}

/// One mass on one spring, N/m, and one damper, N s/m.
fn oscillator(mass: f64, stiffness: f64, damping: f64) -> Scene {
    let text = format!(
        "[effects]\nstability = true\n[integrator]\nstep = 1e-4\n[[mass]]\nname = \"m\"\nmass = {mass:?}\n\
         locked = [\"y\"]\n[[spring]]\nname = \"k\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\n\
         stiffness = {stiffness:?}\n[[damper]]\nname = \"c\"\nbetween = [\"m\", \"ground\"]\n\
         direction = \"x\"\ndamping = {damping:?}\n"
    );
    parse("oscillator", &text).unwrap()
}

#[test]
fn a_mass_on_a_spring_has_its_closed_form() {
    let (m, k) = (2.0_f64, 800.0_f64);
    for c in [0.0, 3.0, 79.0, 100.0] {
        let mut simulation = Simulation::new(oscillator(m, k, c), 0.0).unwrap();
        let (decay, natural) = (0.5 * c / m, (k / m).sqrt());
        let square = natural * natural - decay * decay;
        let expected = if square > 0.0 {
            (-decay, square.sqrt() / (2.0 * PI), 1.0)
        } else {
            (-decay + (-square).sqrt(), 0.0, 2.0)
        };
        let found = indicator(&mut simulation);
        assert!((found.0 - expected.0).abs() < 1e-12 * natural, "{c}: {found:?} {expected:?}");
        assert!((found.1 - expected.1).abs() < 1e-12 * natural, "{c}: {found:?} {expected:?}");
        assert_eq!(found.2, expected.2);
        assert!(c > 0.0 || found.0 == 0.0);
    }
}

/// About uniform sliding, m ẍ + (d − N |dµ/dv|) ẋ + k x = 0.
#[test]
fn friction_that_falls_with_the_slip_velocity_grows_as_its_closed_form_and_as_the_run_does() {
    let (m, k, n, d) = (1.0, 1e4, 10.0, 6.0);
    let (mu, mu_s, v_s) = (0.2, 0.4, 0.1);
    let text = include_str!("../../../../scenes/effects/stribeck.toml");
    // Vibration of 1e-3 of the belt's velocity.
    let small = text.replacen("vx = 1.0e-2", "vx = 1.0e-4", 1);
    let watched = small.replacen("[friction]", "[effects]\nstability = true\n[friction]", 1);
    let scene = parse("stribeck", &watched).unwrap();
    let growth = |v: f64| (n * (mu_s - mu) / v_s * f64::exp(-v / v_s) - d) / (2.0 * m);
    for v in [0.1, 0.11, 0.13, 0.4] {
        let mut scene = scene.clone();
        scene.slider.velocity = v;
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        let sigma = growth(v);
        let frequency = f64::sqrt(k / m - sigma * sigma) / TAU;
        let found = indicator(&mut simulation);
        assert!((found.0 - sigma).abs() < 1e-10, "{v}: {found:?} {sigma}");
        assert!((found.1 - frequency).abs() < 1e-10 && found.2 == 1.0, "{v}: {found:?}");
    }
    // Small vibration grows so from one period to a later one.
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let (sigma, period) = (growth(0.1), TAU / f64::sqrt(k / m - growth(0.1).powi(2)));
    let mut most_in = |period_number: f64| {
        let rows = (1..=300).map(|row| {
            let time = period * (period_number + f64::from(row) / 300.0);
            simulation.advance_to(time).unwrap();
            simulation.displacement()[0].abs()
        });
        rows.fold(0.0, f64::max)
    };
    let (first, last) = (most_in(0.0), most_in(16.0));
    let found = (last / first).ln() / (16.0 * period);
    // The scheme reduces the growth rate σ by h σ², 1e-5 of σ; at an amplitude of 1e-3 of v the slope differs by the
    // square of that from the slope at v.
    assert!((found / sigma - 1.0).abs() < 1e-4, "{found} {sigma}");
}

#[test]
fn another_friction_or_damping_is_another_outlook() {
    let mut scene = set1(0.0);
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    let sliding = [ContactState::Slide; 2];
    let before = indicator(&mut simulation);
    simulation.advance_to(1e-3).unwrap();
    for (friction, beta) in [(1.0, scene.damping.beta), (1.0, 1e-6), (1.96, scene.damping.beta)] {
        set(&mut simulation, "friction.coefficient", friction);
        set(&mut simulation, "damping.beta", beta);
        // At once, and after a step.
        (scene.friction_coefficient, scene.damping.beta) = (friction, beta);
        assert_near(indicator(&mut simulation), expected(&scene, &sliding));
        let next = simulation.time() + 1e-6;
        simulation.advance_to(next).unwrap();
        assert_eq!(states(&mut simulation), sliding);
        assert_near(indicator(&mut simulation), expected(&scene, &sliding));
    }
    assert_eq!(indicator(&mut simulation), before);
}

#[test]
fn a_signal_that_drives_friction_drives_it() {
    let signal = "[[signal]]\ninput = \"friction.coefficient\"\n\
                  ramp = { to = -0.96, start = 0.0, end = 0.01 }\n";
    let text = format!("{}\n[effects]\nstability = true\n{signal}", builtin("set1").unwrap().text);
    let scene = parse("driven", &text).unwrap();
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    for (time, part) in [(0.001, 0.1), (0.002, 0.2), (0.004, 0.4), (0.02, 1.0)] {
        simulation.advance_to(time).unwrap();
        let mut acting = scene.clone();
        acting.friction_coefficient -= 0.96 * part;
        let states = states(&mut simulation);
        assert_near(indicator(&mut simulation), expected(&acting, &states));
    }
}

#[test]
fn a_state_that_holds_every_motion_has_no_modes() {
    let mut scene = builtin("stick_slip").unwrap().scene();
    scene.effects.stability = true;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    assert_eq!(states(&mut simulation), [ContactState::Stick]);
    assert_eq!(indicator(&mut simulation), (0.0, 0.0, 0.0));
    // It slips in the end: a mass on a spring, k = 100 N/m, m = 1 kg.
    while states(&mut simulation) == [ContactState::Stick] {
        let next = simulation.time() + 1e-3;
        simulation.advance_to(next).unwrap();
    }
    let (growth, frequency, modes) = indicator(&mut simulation);
    assert!(growth.abs() < 1e-12 && (frequency - 10.0 / TAU).abs() < 1e-12 && modes == 1.0);
}

#[test]
fn the_shipped_scene_has_the_closed_form_of_its_comment() {
    let scene =
        parse("stability", include_str!("../../../../scenes/effects/stability.toml")).unwrap();
    let (m, surface, k1, k2, k3, mu, alpha) = (1.0, 0.01, 11.0, 20.0, 20.0, 0.4, 0.02);
    let (sin, cos) = (PI / 6.0).sin_cos();
    let [xx, xy, yy] = [(k1 + k2) * cos * cos, (k1 - k2) * cos * sin, (k1 + k2) * sin * sin + k3];
    // a σ² + b σ + c = 0, with complex roots.
    let a = m * (m + surface);
    let b: f64 = -(xx * (m + surface) + yy * m - xy * mu * surface);
    let c = xx * yy - xy * (xy + mu * k3);
    let half = (4.0 * a * c - b * b).sqrt() / (2.0 * a);
    let shifted = nalgebra::Complex::new(0.25 * alpha * alpha + 0.5 * b / a, half);
    let lambda = shifted.sqrt() - 0.5 * alpha;
    let found = indicator(&mut Simulation::new(scene, 0.0).unwrap());
    assert!((found.0 - lambda.re).abs() < 1e-10, "{found:?} {lambda}");
    assert!((found.1 - lambda.im / TAU).abs() < 1e-10 && found.2 == 2.0, "{found:?} {lambda}");
    assert!((found.0 - 0.3182).abs() < 5e-5 && (found.1 - 0.8033).abs() < 5e-5);
}

#[test]
fn a_restored_run_has_the_outlook_of_the_state_that_was_saved() {
    let mut simulation = Simulation::new(set1(0.01), 0.0).unwrap();
    simulation.advance_to(4.0).unwrap();
    let saved = simulation.save();
    let then = indicator(&mut simulation);
    while indicator(&mut simulation) == then {
        let next = simulation.time() + 1e-5;
        assert!(next < 4.1, "its indicator never changes");
        simulation.advance_to(next).unwrap();
    }
    set(&mut simulation, "friction.coefficient", 1.0);
    assert_ne!(indicator(&mut simulation), then);
    simulation.restore(&saved).unwrap();
    assert_eq!(indicator(&mut simulation), then);
    assert_eq!(simulation.save(), saved, "a read left a trace in the saved state");
    assert_eq!(indicator(&mut Simulation::resume(saved).unwrap()), then);
}

#[test]
fn only_a_scene_that_asks_for_it_has_it_and_it_moves_alike() {
    let watched = set1(0.01);
    let mut plain = watched.clone();
    plain.effects.stability = false;
    let names = |scene: &Scene| {
        let names = variables(scene).into_iter().map(|variable| variable.name);
        names.filter(|name| name.starts_with("stability.")).collect::<Vec<_>>()
    };
    assert!(names(&plain).is_empty());
    let three = ["stability.growth_rate", "stability.frequency", "stability.modes"];
    assert_eq!(names(&watched), three);
    let [mut watched, mut plain] = [watched, plain].map(|s| Simulation::new(s, 0.0).unwrap());
    for row in 1..=100_u32 {
        for run in [&mut watched, &mut plain] {
            run.advance_to(f64::from(row) * 1e-3).unwrap();
        }
        indicator(&mut watched);
        assert_eq!(watched.displacement(), plain.displacement());
        assert_eq!(watched.velocity(), plain.velocity());
    }
}

#[test]
fn a_velocity_at_which_friction_is_the_same_but_falls_otherwise_is_another_outlook() {
    // µ(v) is the same where v and v_s change alike; its slope is not.
    let text = include_str!("../../../../scenes/effects/stribeck.toml");
    let watched = text.replacen("[friction]", "[effects]\nstability = true\n[friction]", 1);
    let mut simulation = Simulation::new(parse("stribeck", &watched).unwrap(), 0.0).unwrap();
    let growth = |v_s: f64| (10.0 * 0.2 / v_s * f64::exp(-1.0) - 6.0) / 2.0;
    for v_s in [0.1, 0.2, 0.05] {
        for name in ["slider.velocity", "friction.stribeck_velocity"] {
            let all = variables(simulation.scene());
            let variable = all.iter().find(|variable| variable.name == name).unwrap();
            simulation.write(variable, v_s).unwrap();
        }
        let found = indicator(&mut simulation).0;
        assert!((found - growth(v_s)).abs() < 1e-10, "{found} for {}", growth(v_s));
    }
}
