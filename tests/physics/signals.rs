//! Signals: values over time that drive inputs.

use amontons::contact::{ContactForce, ContactState};
use amontons::scene::{Method, Scene, Signal, parse};
use amontons::simulation::{Parameters, Simulation, Variable, variables};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const OMEGA: f64 = 20.0;

/// A mass on a spring, ω = 20 rad/s, that touches nothing; followed by `more`.
fn oscillator(step: f64, more: &str) -> Scene {
    let text = format!(
        "{more}\n[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
         between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[integrator]\n\
         step = {step:?}"
    );
    parse("oscillator", &text).unwrap()
}

fn variable(scene: &Scene, name: &str) -> Variable {
    variables(scene).into_iter().find(|variable| variable.name == name).unwrap()
}

/// Displacements at the given times, s.
fn displacements(scene: Scene, times: &[f64]) -> Vec<f64> {
    let x = variable(&scene, "mass.a.x");
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let mut at = |&time| {
        simulation.advance_to(time).unwrap();
        simulation.read(&x).unwrap()
    };
    times.iter().map(&mut at).collect()
}

/// The response of an oscillator at rest to a force F from time 0 on, x = F/k (1 − cos ωt).
fn response(force: f64, t: f64) -> f64 {
    if t <= 0.0 { 0.0 } else { force / 200.0 * (1.0 - (OMEGA * t).cos()) }
}

#[test]
fn a_pulse_of_force_gives_the_response_of_the_oscillator() {
    let pulse =
        "[[signal]]\ninput = \"mass.a.fx\"\npulse = { value = 3.0, start = 0.1, end = 0.25 }";
    let times = [0.1, 0.15, 0.25, 0.3, 0.7];
    for step in [1e-4, 1e-5] {
        let found = displacements(oscillator(step, pulse), &times);
        for (x, t) in found.iter().zip(times) {
            let expected = response(3.0, t - 0.1) - response(3.0, t - 0.25);
            // First order: half a step's phase and half a step's impulse.
            assert!((x - expected).abs() < 0.03 * OMEGA * step, "{x} {expected} at {t} s");
        }
    }
}

#[test]
fn a_sine_of_force_at_rest_gives_beats_of_both_frequencies() {
    // ẍ + ω² x = (F/m) sin Ωt from rest: x = F / (k (1 − r²)) (sin Ωt − r sin ωt), r = Ω / ω.
    let frequency = 2.5;
    let r = TAU * frequency / OMEGA;
    let sine = "[[signal]]\ninput = \"mass.a.fx\"\nsine = { amplitude = 3.0, frequency = 2.5 }";
    let times = [0.05, 0.2, 0.55, 1.0];
    let largest = 3.0 / 200.0 / (1.0 - r * r).abs() * (1.0 + r);
    for step in [1e-4, 1e-5] {
        let found = displacements(oscillator(step, sine), &times);
        for (x, t) in found.iter().zip(times) {
            let expected =
                3.0 / 200.0 / (1.0 - r * r) * ((TAU * frequency * t).sin() - r * (OMEGA * t).sin());
            assert!((x - expected).abs() < OMEGA * step * largest, "{x} {expected} at {t} s");
        }
    }
}

/// The scene with the event-driven integrator.
fn exactly(scene: &Scene) -> Scene {
    let step = scene.step;
    scene.with_integrator(Method::EventDriven, step)
}

#[test]
fn exact_motion_follows_a_sine_whatever_its_step() {
    // Along its tangent over a step a sine once was known to second order alone.
    let frequency = 2.5;
    let r = TAU * frequency / OMEGA;
    let sine = format!(
        "[[signal]]\ninput = \"mass.a.fx\"\nsine = {{ amplitude = 4.0, frequency = {frequency} }}"
    );
    let times = [0.25, 1.0, 2.5];
    for step in [1e-3, 0.05, 0.5] {
        let found = displacements(exactly(&oscillator(step, &sine)), &times);
        for (x, t) in found.iter().zip(times) {
            let size = 4.0 / 200.0 / (1.0 - r * r);
            let expected = size * ((TAU * frequency * t).sin() - r * (OMEGA * t).sin());
            assert!((x - expected).abs() < 1e-13, "{x} {expected} at {t} s, {step}");
        }
    }
}

#[test]
fn exact_motion_stops_at_edges_wherever_they_are() {
    // An edge within a step once came at its end.
    let pulse =
        "[[signal]]\ninput = \"mass.a.fx\"\npulse = { value = 3.0, start = 0.033, end = 0.257 }";
    let ramp = "[[signal]]\ninput = \"mass.a.fx\"\nramp = { to = 3.0, start = 0.033, end = 0.257 }";
    let after = |t: f64| response(3.0, t);
    // The response to a unit of rate: F/k (t − sin ωt / ω).
    let rising = |t: f64| {
        if t <= 0.0 { 0.0 } else { 3.0 / 0.224 / 200.0 * (t - (OMEGA * t).sin() / OMEGA) }
    };
    let times = [0.1, 0.3, 0.7];
    for step in [1e-3, 0.1] {
        let found = displacements(exactly(&oscillator(step, pulse)), &times);
        for (x, t) in found.iter().zip(times) {
            let expected = after(t - 0.033) - after(t - 0.257);
            assert!((x - expected).abs() < 1e-14, "{x} {expected} at {t} s, {step}");
        }
        let found = displacements(exactly(&oscillator(step, ramp)), &times);
        for (x, t) in found.iter().zip(times) {
            let expected = rising(t - 0.033) - rising(t - 0.257);
            assert!((x - expected).abs() < 1e-14, "{x} {expected} at {t} s, {step}");
        }
    }
}

#[test]
fn a_slider_whose_velocity_jumps_carries_a_mass_along_from_there_on() {
    // In exact motion the jump once was spread over the step before it.
    let text = "[slider]\nvelocity = 0.0\nangle = 0.0\n[friction]\ncoefficient = 0.3\nstatic = 0.5\n\
        [integrator]\nmethod = \"event-driven\"\nstep = 0.05\n[[mass]]\nname = \"a\"\nmass = 1.0\n\
        force = [0.0, -10.0]\n[[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\n\
        stiffness = 100.0\n[[contact]]\nname = \"c\"\nmass = \"a\"\n[[signal]]\n\
        input = \"slider.velocity\"\npulse = { value = 0.2, start = 0.1 }";
    // x = µN/k (1 − cos ωt) until it is as fast as the slider.
    let (omega, reach) = (10.0, 3.0 / 100.0);
    let caught = f64::asin(0.2 / (reach * omega)) / omega;
    let times = [0.1, 0.15, 0.25];
    for (x, t) in displacements(parse("jump", text).unwrap(), &times).iter().zip(times) {
        let slipped = f64::min(t - 0.1, caught);
        let expected = reach * (1.0 - (omega * slipped).cos()) + 0.2 * (t - 0.1 - slipped);
        assert!((x - expected).abs() < 1e-15, "{x} {expected} at {t} s");
    }
}

#[test]
fn a_slow_ramp_of_force_carries_the_mass_along() {
    // From rest, F = c t: x = c/k (t − sin ωt / ω).
    let ramp = "[[signal]]\ninput = \"mass.a.fx\"\nramp = { to = 8.0, end = 4.0 }";
    let times = [0.3, 1.1, 3.9];
    let found = displacements(oscillator(1e-5, ramp), &times);
    for (x, t) in found.iter().zip(times) {
        let expected = 2.0 / 200.0 * (t - (OMEGA * t).sin() / OMEGA);
        assert!((x - expected).abs() < 2.0 / 200.0 * 2e-5, "{x} {expected} at {t} s");
    }
}

/// One signal of every shape, for two inputs; on Set 1 kicked hard enough to stick, slip and detach.
const ALL_SHAPES: &str = r#"
[[signal]]
input = "slider.velocity"
ramp = { from = -0.025, to = 0.03, start = 0.00301, end = 0.02 }
[[signal]]
input = "slider.velocity"
pulse = { value = 0.06, start = 0.0045, end = 0.0087 }
[[signal]]
input = "friction.coefficient"
table = { points = [[0.001, 0.1], [0.004, -0.4], [0.004, 0.2]], between = "constant" }
[[signal]]
input = "module[1].f1"
constant = { value = 0.5 }
[[signal]]
input = "module[1].f2"
pulse = { value = -300.0, start = 0.002, end = 0.0031 }
[[signal]]
input = "module[1].f2"
sine = { amplitude = 90.0, frequency = 300.0, phase = 1.0, start = 0.0023, end = 0.02 }
[[signal]]
input = "module[2].f4"
table = { points = [[0.001, 0.0], [0.006, 90.0], [0.006, 20.0], [0.02, 0.0]] }
"#;

fn driven_set1() -> Scene {
    let text = amontons::scene::builtin("set1").unwrap().text;
    let mut scene = parse("driven", &format!("{text}{ALL_SHAPES}")).unwrap();
    scene.modules_mut()[0].velocity = [0.3, 1.5, 0.0, 0.0];
    scene
}

#[test]
fn signals_give_the_doubles_of_an_importer_that_sets_the_same_inputs_before_every_step() {
    let scene = driven_set1();
    let step = scene.step;
    let by_hand = Scene { signals: [].into(), ..scene.clone() };
    let nominal = Parameters::of(scene.clone());
    let value = |input: &Variable, t: f64| {
        let own = |signal: &&Signal| signal.input == input.name;
        let added = scene.signals.iter().filter(own).map(|signal| signal.shape.at(t, 1e-6 * step));
        added.fold(nominal.get(input).unwrap(), |sum, added| sum + added)
    };
    let mut inputs = variables(&scene);
    inputs.retain(|input| scene.signals.iter().any(|signal| signal.input == input.name));
    assert_eq!(inputs.len(), 5);
    let mut start = by_hand;
    for input in &inputs {
        amontons::simulation::write_scene(&mut start, input, value(input, 0.0)).unwrap();
    }
    let mut importer = Simulation::new(start, 0.0).unwrap();
    let mut signals = Simulation::new(scene.clone(), 0.0).unwrap();
    for i in 0..25_000_u32 {
        for input in &inputs {
            // The slider's velocity is that of the step's end, where the contacts are held.
            let at = if input.name == "slider.velocity" { i + 1 } else { i };
            importer.write(input, value(input, f64::from(at) * step)).unwrap();
        }
        importer.advance_to(f64::from(i + 1) * step).unwrap();
        if i % 1000 == 999 {
            let end = f64::from(i + 1) * step;
            signals.advance_to(end).unwrap();
            for input in &inputs {
                importer.write(input, value(input, end)).unwrap();
            }
            let forces = importer.contact_forces().unwrap().to_vec();
            for (importer, signals) in forces.into_iter().zip(signals.contact_forces().unwrap()) {
                // An importer does not say how fast the slider's velocity changes, on which the force
                // of a stuck contact depends.
                let stuck = signals.state == ContactState::Stick;
                let friction_force =
                    if stuck { signals.friction_force } else { importer.friction_force };
                assert_eq!(ContactForce { friction_force, ..importer }, *signals, "at {end} s");
            }
        }
    }
    assert_eq!(importer.statistics(), signals.statistics());
    assert!(signals.statistics().touch_downs > 0 && signals.statistics().state_changes() > 20);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn a_driven_run_is_the_same_however_it_is_split_and_after_a_restore(
        mut splits in prop::collection::vec(1_u32..25_000, 1..12),
    ) {
        let scene = driven_set1();
        let mut straight = Simulation::new(scene.clone(), 0.0).unwrap();
        let mut split = Simulation::new(scene.clone(), 0.0).unwrap();
        let mut resumed = Simulation::new(scene.clone(), 0.0).unwrap();
        splits.sort_unstable();
        for count in splits {
            let time = f64::from(count) * scene.step;
            split.advance_to(time).unwrap();
            split.contact_forces().unwrap();
            resumed.advance_to(time).unwrap();
            // On and back, and by way of a simulation that has seen nothing else.
            let saved = resumed.save();
            resumed.advance_to(time + 700.0 * scene.step).unwrap();
            resumed.restore(&saved).unwrap();
            prop_assert_eq!(resumed.contact_forces().unwrap(), split.contact_forces().unwrap());
            resumed = Simulation::resume(saved).unwrap();
        }
        let end = 26_000.0 * scene.step;
        for simulation in [&mut straight, &mut split, &mut resumed] {
            simulation.advance_to(end).unwrap();
        }
        prop_assert!(straight.save() == split.save());
        prop_assert!(straight.save() == resumed.save());
    }
}

#[test]
fn a_parted_step_sees_the_signal_at_the_time_of_each_part() {
    // A communication step of 2.5 internal ones is three of 5/6; the force is there for the last two.
    let pulse =
        "[[signal]]\ninput = \"mass.a.fx\"\npulse = { value = 3.0, start = 0.8e-4, end = 1 }";
    let scene = oscillator(1e-4, pulse);
    let v = variable(&scene, "mass.a.vx");
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(2.5e-4).unwrap();
    let impulse = 3.0 * 2.0 * 2.5e-4 / 3.0;
    assert!((simulation.read(&v).unwrap() - impulse / 0.5).abs() < 1e-4 * impulse);
}

#[test]
fn a_run_that_starts_later_sees_the_signals_of_its_own_time() {
    let pulse = "[[signal]]\ninput = \"mass.a.fx\"\npulse = { value = 3.0, start = 2.1, end = 9 }";
    let scene = oscillator(1e-5, pulse);
    let x = variable(&scene, "mass.a.x");
    let mut simulation = Simulation::new(scene, 2.0).unwrap();
    simulation.advance_to(2.1).unwrap();
    assert_eq!(simulation.read(&x).unwrap(), 0.0);
    simulation.advance_to(2.1 + PI / OMEGA).unwrap();
    assert!((simulation.read(&x).unwrap() - 2.0 * 3.0 / 200.0).abs() < 1e-5);
}

#[test]
fn inputs_that_are_given_later_are_what_signals_add_to() {
    let constant = "[[signal]]\ninput = \"mass.a.fx\"\nconstant = { value = 3.0 }";
    let scene = oscillator(1e-5, constant);
    let (x, force) = (variable(&scene, "mass.a.x"), variable(&scene, "mass.a.fx"));
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.write(&force, -3.0).unwrap();
    simulation.advance_to(0.1).unwrap();
    assert_eq!(simulation.read(&x).unwrap(), 0.0);
    assert_eq!(simulation.read(&force).unwrap(), -3.0);
    simulation.write(&force, 1.0).unwrap();
    simulation.advance_to(0.1 + PI / OMEGA).unwrap();
    assert!((simulation.read(&x).unwrap() - 2.0 * 4.0 / 200.0).abs() < 1e-5);
    assert_eq!(simulation.read(&force).unwrap(), 1.0);
}

#[test]
fn a_slider_that_is_brought_up_from_rest_starts_with_stuck_contacts() {
    // v = base + ramp: the base is what the ramp ends in, and what the analyser sees.
    let up =
        "[[signal]]\ninput = \"slider.velocity\"\nramp = { from = -0.025, to = 0.0, end = 0.1 }";
    let text = amontons::scene::builtin("set2").unwrap().text;
    let mut scene = parse("up", &format!("{text}{up}")).unwrap();
    scene.modules_mut().iter_mut().for_each(|module| module.velocity = [0.0; 4]);
    scene.friction_coefficient = 0.5;
    scene.damping.beta = 1e-3;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    for force in simulation.contact_forces().unwrap() {
        assert_eq!(force.state, ContactState::Stick);
        // Friction carries m2 with the slider from the first moment on: 0.7 kg, 0.25 m/s².
        assert_eq!((force.friction_force, force.slip_velocity), (0.7 * 0.25, 0.0));
    }
    simulation.advance_to(2.0).unwrap();
    for force in simulation.contact_forces().unwrap() {
        assert_eq!(force.state, ContactState::Slide);
        assert!((force.slip_velocity - 0.025).abs() < 1e-6, "{force:?}");
    }
}

#[test]
fn a_signal_that_makes_friction_negative_is_refused_at_its_time() {
    let text = amontons::scene::builtin("set1").unwrap().text;
    let ramp = "[[signal]]\ninput = \"friction.coefficient\"\nramp = { to = -3.92, end = 0.02 }";
    let mut simulation =
        Simulation::new(parse("down", &format!("{text}{ramp}")).unwrap(), 0.0).unwrap();
    simulation.advance_to(0.00999).unwrap();
    let error = simulation.advance_to(0.02).unwrap_err();
    assert!(error.is_step(), "{error}");
    let message = error.to_string();
    assert!(message.starts_with("at 0.01000"), "{message}");
    assert!(message.contains("friction.coefficient = -0.0") && message.contains("must not be"));
}

#[test]
fn a_signal_that_takes_friction_above_what_the_step_allows_is_refused() {
    let text = amontons::scene::builtin("set1").unwrap().text.replace("1.0e-6  ", "2.5e-4  ");
    let ramp = "[[signal]]\ninput = \"friction.coefficient\"\nramp = { to = 50, end = 0.5 }";
    let mut simulation =
        Simulation::new(parse("up", &format!("{text}{ramp}")).unwrap(), 0.0).unwrap();
    assert!(simulation.advance_to(0.5).unwrap_err().is_step_too_large());
}

#[test]
fn the_names_of_the_inputs_are_those_of_the_catalogue() {
    use amontons::simulation::catalogue::Causality;
    let set1 = amontons::scene::builtin("set1").unwrap().scene();
    let text =
        include_str!("../../README.md").split("```toml\n").find(|block| block.contains("[[mass]]"));
    let network = parse("network", text.unwrap().split("```").next().unwrap()).unwrap();
    for scene in [set1, network] {
        let mut names = scene.input_names();
        let mut catalogue = variables(&scene);
        catalogue.retain(|variable| variable.causality == Causality::Input);
        let mut expected: Vec<String> = catalogue.into_iter().map(|input| input.name).collect();
        names.sort_unstable();
        expected.sort_unstable();
        assert_eq!(names, expected);
    }
}

#[test]
fn a_stuck_mass_is_carried_by_the_friction_that_its_acceleration_takes() {
    // Friction once lacked m dv/dt.
    let text = "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
        [integrator]\nstep = 1e-4\n[[mass]]\nname = \"a\"\nmass = 2.0\nforce = [0.0, -100.0]\n\
        [[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 10.0\n\
        [[contact]]\nname = \"c\"\nmass = \"a\"\n[[signal]]\ninput = \"slider.velocity\"\n\
        ramp = { from = -1.0, to = 0.0, start = 0.1, end = 0.2 }";
    let mut simulation = Simulation::new(parse("carried", text).unwrap(), 0.0).unwrap();
    for i in 0..20 {
        // At the ends of the ramp, too, where the step from rest to motion is.
        let t = 0.1 + 0.005 * f64::from(i);
        simulation.advance_to(t).unwrap();
        let force = simulation.contact_forces().unwrap()[0];
        assert_eq!((force.state, force.slip_velocity), (ContactState::Stick, 0.0), "at {t} s");
        let x = 0.5 * 10.0 * (t - 0.1).powi(2);
        let expected = 2.0 * 10.0 + 10.0 * x;
        assert!((force.friction_force - expected).abs() < 1e-2, "{force:?} {expected} at {t} s");
    }
}

#[test]
fn a_stuck_module_is_carried_by_the_friction_that_its_acceleration_takes() {
    let text =
        amontons::scene::builtin("set1").unwrap().text.replace("angle = 0.5 ", "angle = 0.0 ");
    let up =
        "[[signal]]\ninput = \"slider.velocity\"\nramp = { from = -0.025, to = 0.0, end = 0.01 }";
    let mut scene = parse("carried", &format!("{text}{up}")).unwrap();
    scene.modules_mut()[0].velocity = [0.0; 4];
    let read = |simulation: &mut Simulation, name: &str| {
        let variable = variable(simulation.scene(), name);
        simulation.read(&variable).unwrap()
    };
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    for i in 0..90 {
        simulation.advance_to(1e-4 * f64::from(i)).unwrap();
        let force = simulation.contact_forces().unwrap()[0];
        assert_eq!(force.state, ContactState::Stick, "after {i}");
        let [x1, x3, v1, v3] =
            ["x1", "x3", "v1", "v3"].map(|n| read(&mut simulation, &format!("module[1].{n}")));
        // m2 v̇ = T + k6 (x1 − x3) + β k6 (ẋ1 − ẋ3).
        let expected = 0.7 * 2.5 - 250e3 * ((x1 - x3) + 3e-5 * (v1 - v3));
        assert!((force.friction_force - expected).abs() < 1e-9, "{force:?} {expected}");
    }
}

#[test]
fn a_pulse_of_whole_steps_acts_for_just_as_many() {
    // Multiples of 1 µs are not what a decimal says, so edges on the grid once moved by a step.
    let step = 1e-6;
    for first in 0..60_u32 {
        for count in [1, 2, 10] {
            let (start, end) = (f64::from(first) * step, f64::from(first + count) * step);
            let text = format!("{:.6}, end = {:.6}", start, end);
            let pulse = format!(
                "[[signal]]\ninput = \"mass.a.fx\"\npulse = {{ value = 3.0, start = {text} }}"
            );
            let scene = oscillator(step, &pulse);
            let v = variable(&scene, "mass.a.vx");
            let mut simulation = Simulation::new(scene, 0.0).unwrap();
            simulation.advance_to(100.0 * step).unwrap();
            let impulse = 3.0 * f64::from(count) * step;
            let found = 0.5 * simulation.read(&v).unwrap();
            assert!((found / impulse - 1.0).abs() < 1e-5, "{text}: {}", found / impulse);
        }
    }
}

#[test]
fn a_driven_friction_meets_the_same_critical_step_as_a_given_one() {
    // The critical step of the brake falls steeply behind µ = 0.4175.
    let text = amontons::scene::builtin("disc_brake").unwrap().text;
    let signal =
        "[[signal]]\ninput = \"friction.coefficient\"\npulse = { value = 9e-4, start = 0.01 }";
    let mut scene = parse("brake", &format!("{text}{signal}")).unwrap();
    (scene.step, scene.friction_coefficient) = (2e-4, 0.4184);
    let given = Scene { signals: [].into(), ..scene.clone() };
    assert!(Simulation::new(given, 0.0).err().unwrap().is_step_too_large());
    scene.friction_coefficient = 0.4175;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(0.008).unwrap();
    assert!(simulation.advance_to(0.012).unwrap_err().is_step_too_large());
}

#[test]
fn a_state_from_before_its_signal_made_friction_impossible_can_be_gone_back_to() {
    let text = amontons::scene::builtin("set1").unwrap().text;
    let down =
        "[[signal]]\ninput = \"friction.coefficient\"\npulse = { value = -1.0, start = 0.01 }";
    let scene = parse("down", &format!("{text}{down}")).unwrap();
    let friction = variable(&scene, "friction.coefficient");
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.write(&friction, 0.5).unwrap();
    simulation.advance_to(0.01).unwrap();
    let (saved, mut ends) = (simulation.save(), Vec::new());
    // Looking is always possible, going on is not, until the importer makes it so.
    simulation.contact_forces().unwrap();
    assert!(simulation.advance_to(0.011).unwrap_err().is_step());
    simulation.write(&friction, 1.96).unwrap();
    simulation.advance_to(0.011).unwrap();
    // Restoring also resets parameters that no signal drives.
    let damping = variable(simulation.scene(), "damping.beta");
    simulation.write(&damping, 1e-4).unwrap();
    simulation.restore(&saved).unwrap();
    assert!(simulation.save() == saved);
    for run in [&mut simulation, &mut Simulation::resume(saved.clone()).unwrap()] {
        run.write(&friction, 1.96).unwrap();
        run.advance_to(0.02).unwrap();
        ends.push(run.save());
    }
    assert!(ends[0] == ends[1]);
    assert!(Simulation::resume(saved).unwrap().advance_to(0.011).unwrap_err().is_step());
}

/// A block that is pressed by 10 N, on a spring that is inclined, so that N follows x.
fn rubbing_block(name: &str) -> String {
    format!(
        "[[mass]]\nname = \"{name}\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[initial]]\nmass = \"{name}\"\nvx = 0.3\n\
         [[spring]]\nname = \"k{name}\"\nbetween = [\"{name}\", \"ground\"]\ndirection = 0.6435011087932844\n\
         stiffness = 150.0\n[[contact]]\nname = \"c{name}\"\nmass = \"{name}\"\n"
    )
}

/// The block on a belt that runs at 100 m/s, with a signal for µ = 0.4; followed by `more`.
fn driven_friction(signal: &str, step: f64, more: &str) -> Scene {
    let block = rubbing_block("a");
    let text = format!(
        "[slider]\nvelocity = 100.0\nangle = 0.0\n[friction]\ncoefficient = 0.4\n{block}[[signal]]\n\
         input = \"friction.coefficient\"\n{signal}\n[integrator]\nmethod = \"event-driven\"\nstep = {step:?}\n{more}"
    );
    parse("rubs", &text).unwrap()
}

/// Displacement and velocity after steps of a Runge–Kutta method between two times, s.
fn runge_kutta(
    rate: impl Fn([f64; 2], f64) -> [f64; 2],
    mut y: [f64; 2],
    [from, to]: [f64; 2],
) -> [f64; 2] {
    const STEPS: u32 = 20_000;
    let along = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    let h = (to - from) / f64::from(STEPS);
    for i in 0..STEPS {
        let t = from + h * f64::from(i);
        let k1 = rate(y, t);
        let k2 = rate(along(y, k1, 0.5 * h), t + 0.5 * h);
        let k3 = rate(along(y, k2, 0.5 * h), t + 0.5 * h);
        let k4 = rate(along(y, k3, h), t + h);
        y = [0, 1].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    y
}

/// Displacement of the block at time `t` (s): ẍ = −96 x + µ(t) (10 + 72 x) from the equilibrium at time 0, from each of the
/// edges to the next.
fn rubbed(friction: impl Fn(f64) -> f64, edges: &[f64], t: f64) -> f64 {
    let equilibrium = friction(0.0) * 10.0 / (96.0 - friction(0.0) * 72.0);
    let rate = |[x, v]: [f64; 2], t: f64| [v, -96.0 * x + friction(t) * (10.0 + 72.0 * x)];
    let (mut y, mut from) = ([equilibrium, 0.3], 0.0);
    for to in edges.iter().copied().filter(|edge| *edge < t).chain([t]) {
        y = runge_kutta(rate, y, [from, to]);
        from = to;
    }
    y[0] - equilibrium
}

const SINE: &str = "sine = { amplitude = 0.2, frequency = 4.75, phase = 0.5 }";

fn sine(t: f64) -> f64 {
    0.4 + 0.2 * (TAU * 4.75 * t + 0.5).sin()
}

#[test]
fn driven_friction_is_followed_to_the_last_digits_whatever_the_step_is() {
    // Friction was held over a step once: the error was of first order.
    let ramp = |t: f64| 0.4 + 0.3 * ((t - 0.13) / 0.61).clamp(0.0, 1.0);
    for step in [1e-3, 0.02, 0.25] {
        let displacement = |signal, t| displacements(driven_friction(signal, step, ""), &[t])[0];
        for t in [0.5, 2.0] {
            for (signal, expected) in [
                (SINE, rubbed(sine, &[], t)),
                ("ramp = { to = 0.3, start = 0.13, end = 0.74 }", rubbed(ramp, &[0.13, 0.74], t)),
            ] {
                let x = displacement(signal, t);
                assert!((x - expected).abs() < 1e-12, "{x} {expected} at {t} s, {step}, {signal}");
            }
        }
    }
}

#[test]
fn driven_friction_of_a_large_structure_is_followed_too() {
    // Thirteen blocks have too many directions for full matrices.
    let others: String = (0..12).map(|i| rubbing_block(&format!("b{i}"))).collect();
    let found = displacements(driven_friction(SINE, 0.1, &others), &[2.0])[0];
    let expected = rubbed(sine, &[], 2.0);
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

#[test]
fn a_rate_of_friction_from_an_importer_is_followed() {
    let constant = "constant = { value = 0.0 }";
    let mut simulation = Simulation::new(driven_friction(constant, 0.05, ""), 0.0).unwrap();
    let [x, friction] =
        ["mass.a.x", "friction.coefficient"].map(|name| variable(simulation.scene(), name));
    simulation.set_rate(&friction, 0.2).unwrap();
    simulation.advance_to(1.0).unwrap();
    let expected = rubbed(|t| 0.4 + 0.2 * t, &[], 1.0);
    assert!((simulation.read(&x).unwrap() - expected).abs() < 1e-12);
}

#[test]
fn a_block_lets_go_where_a_falling_sine_of_static_friction_meets_its_force() {
    // A belt at 0.2 m/s carries the block from the equilibrium in sliding, where the spring holds 3 N. It holds 40 N/s t more
    // when it reaches µ_s N = 10 N (0.6 + 0.1 sin ωt).
    let text = "[slider]\nvelocity = 0.2\nangle = 0.0\n[friction]\ncoefficient = 0.3\nstatic = 0.6\n[integrator]\n\
        method = \"event-driven\"\nstep = 0.05\n[[mass]]\nname = \"a\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
        [[initial]]\nmass = \"a\"\nvx = 0.2\n[[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\n\
        stiffness = 200.0\n[[contact]]\nname = \"c\"\nmass = \"a\"\n[[signal]]\n\
        input = \"friction.static\"\nsine = { amplitude = 0.1, frequency = 1.5 }";
    let (mut low, mut high) = (0.0, 0.3);
    for _ in 0..60 {
        let t = f64::midpoint(low, high);
        let is_before = 3.0 + 40.0 * t < 10.0 * (0.6 + 0.1 * (TAU * 1.5 * t).sin());
        if is_before { low = t } else { high = t }
    }
    // Then ẍ = −200 x about that equilibrium, from x₁ = 0.2 t₁ and ẋ = 0.2.
    let omega = 200.0_f64.sqrt();
    let expected = |t: f64| {
        let angle = omega * (t - low);
        0.2 * low * angle.cos() + 0.2 / omega * angle.sin()
    };
    let times = [low + 0.01, 0.25];
    for (x, t) in displacements(parse("lets_go", text).unwrap(), &times).iter().zip(times) {
        assert!((x - expected(t)).abs() < 1e-13, "{x} {} at {t} s", expected(t));
    }
}

#[test]
fn a_block_lets_go_where_a_product_of_two_signals_meets_its_force() {
    // The belt carries the block from the equilibrium in sliding, where the spring holds 3 N; it holds v · 200 N/m · t more
    // when it reaches µ_s N. The order of the series was that of the displacements, which have two powers only.
    let lets_go = |velocity: f64,
                   signals: [&str; 2],
                   friction: fn(f64) -> f64,
                   normal: fn(f64) -> f64| {
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..60 {
            let t = f64::midpoint(low, high);
            let is_before = 3.0 + velocity * 200.0 * t < friction(t) * normal(t);
            if is_before { low = t } else { high = t }
        }
        let rate = |[x, v]: [f64; 2], t: f64| [v, -200.0 * x - 3.0 + 0.3 * normal(t)];
        let [expected, _] = runge_kutta(rate, [velocity * low, velocity], [low, low + 0.1]);
        for step in [0.01, 0.25] {
            let text = format!(
                "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = 0.3\nstatic = 0.6\n\
                 [integrator]\nmethod = \"event-driven\"\nstep = {step:?}\n[[mass]]\nname = \"a\"\nmass = 1.0\n\
                 force = [0.0, -10.0]\n[[initial]]\nmass = \"a\"\nvx = {velocity:?}\n[[spring]]\nname = \"k\"\n\
                 between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[[contact]]\nname = \"c\"\n\
                 mass = \"a\"\n[[signal]]\ninput = \"friction.static\"\n{}\n[[signal]]\ninput = \"mass.a.fy\"\n{}",
                signals[0], signals[1]
            );
            let x = displacements(parse("lets_go", &text).unwrap(), &[low + 0.1])[0];
            assert!(
                (x - expected).abs() < 1e-12,
                "{x} {expected}, lets go at {low} s, step {step}"
            );
        }
    };
    lets_go(
        0.02,
        ["ramp = { to = -0.3, end = 1.0 }", "ramp = { to = 5.0, end = 1.0 }"],
        |t| 0.6 - 0.3 * t,
        |t| 10.0 - 5.0 * t,
    );
    lets_go(
        0.03,
        [
            "sine = { amplitude = 0.2, frequency = 1.5 }",
            "sine = { amplitude = 6.0, frequency = 1.5 }",
        ],
        |t| 0.6 + 0.2 * (TAU * 1.5 * t).sin(),
        |t| 10.0 - 6.0 * (TAU * 1.5 * t).sin(),
    );
}

#[test]
fn a_motion_that_friction_alone_begins_with_its_second_power_is_not_missed() {
    // In the equilibrium of sliding µ N = (0.4 + 0.2 t) (10 − 5 t) = 4 − t²: the first two powers of its motion are nothing.
    let text = "[slider]\nvelocity = 100.0\nangle = 0.0\n[friction]\ncoefficient = 0.4\n[integrator]\n\
        method = \"event-driven\"\nstep = 0.25\n[[mass]]\nname = \"a\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\n\
        name = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n[[contact]]\nname = \"c\"\n\
        mass = \"a\"\n[[signal]]\ninput = \"friction.coefficient\"\nramp = { to = 0.2, end = 1.0 }\n[[signal]]\n\
        input = \"mass.a.fy\"\nramp = { to = 5.0, end = 1.0 }";
    for (x, t) in displacements(parse("second", text).unwrap(), &[0.2, 0.9]).iter().zip([0.2, 0.9])
    {
        let expected: f64 = -t * t / 100.0 + 2e-4 * (1.0 - f64::cos(10.0 * t));
        assert!((x - expected).abs() < 1e-15, "{x} {expected} at {t} s");
    }
}

#[test]
fn friction_that_becomes_impossible_within_a_step_is_refused_whatever_the_step_is() {
    for (signal, is_refused) in [
        ("sine = { amplitude = 0.39, frequency = 10.0 }", false),
        ("sine = { amplitude = 0.41, frequency = 10.0 }", true),
    ] {
        // Each step of 0.1 s begins and ends where the sine is zero.
        for step in [0.1, 1e-3] {
            let mut simulation = Simulation::new(driven_friction(signal, step, ""), 0.0).unwrap();
            let result = simulation.advance_to(0.5);
            assert_eq!(result.is_err(), is_refused, "{result:?}, {signal}, step {step}");
            if let Err(error) = result {
                assert!(error.is_step() && error.to_string().contains("friction"), "{error}");
            }
        }
    }
}

/// µ = 0.4 + a sin(20π (t − 0.3 s)) falls below zero at sin = −0.4/a, and rises above µ_s = 0.6 at sin = 0.2/a.
#[test]
fn a_refusal_of_driven_friction_names_the_fault_the_signal_and_the_instant() {
    for step in [0.1, 1e-3] {
        for (amplitude, at_rest, phase, words) in [
            (
                0.41,
                None,
                PI + f64::asin(0.4 / 0.41),
                "coefficient of contact.ca falls below zero at ",
            ),
            (
                0.3,
                Some(0.6),
                f64::asin(0.2 / 0.3),
                "static friction coefficient of contact.ca falls below its kinetic one, 0.6, at ",
            ),
        ] {
            let sine =
                format!("sine = {{ amplitude = {amplitude:?}, frequency = 10.0, start = 0.3 }}");
            let mut scene = driven_friction(&sine, step, "");
            scene.static_friction = at_rest;
            let message =
                Simulation::new(scene, 0.0).unwrap().advance_to(1.0).unwrap_err().to_string();
            let added = format!(
                "signal[1] adds a sine of amplitude {amplitude:?} to friction.coefficient = 0.4"
            );
            assert!(message.contains(words) && message.contains(&added), "{message}");
            let (_, after) = message.split_once(words).unwrap();
            let time: f64 = after.split_once(" s").unwrap().0.parse().unwrap();
            let expected = 0.3 + phase / (20.0 * PI);
            assert!((time - expected).abs() < 1e-9, "{time} {expected}");
        }
    }
}

#[test]
fn under_driven_friction_no_energy_is_lost_from_the_ledger() {
    let scene = driven_friction(SINE, 0.05, "[effects]\nenergy = true\n");
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(2.0).unwrap();
    let energy = simulation.energy().unwrap();
    assert!(energy.residual.abs() < 1e-13 * energy.slider.abs(), "{energy:?}");
}
