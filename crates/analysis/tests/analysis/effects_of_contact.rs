//! The parts of the law of contact, each by itself (`scenes/effects/`): what a scene leaves out is not there,
//! and what it names does what the closed form in its comment says, with both integrators where both take it.

use amontons::contact::ContactState::{self, Slide, Stick};
use amontons::scene::{Method, Scene, parse};
use amontons::simulation::{Simulation, variables};

const NONE: &str = include_str!("../../../../scenes/effects/none.toml");
const COULOMB: &str = include_str!("../../../../scenes/effects/coulomb.toml");
const STATIC: &str = include_str!("../../../../scenes/effects/static.toml");
const STRIBECK: &str = include_str!("../../../../scenes/effects/stribeck.toml");
const STICKING: &str = include_str!("../../../../scenes/effects/sticking.toml");
const DETACHMENT: &str = include_str!("../../../../scenes/effects/detachment.toml");

/// The scene, as it is and with the paper's scheme, each with what its errors may be relative to a motion's
/// size: rounding, and h ω times some units.
fn both(text: &str, step: f64, omega: f64) -> [(Scene, f64); 2] {
    let scene = parse("effect", text).unwrap();
    assert_eq!(scene.method, Method::EventDriven);
    let scheme = scene.with_integrator(Method::ForwardIncrement, step);
    [(scene, 1e-12), (scheme, 2.0 * step * omega)]
}

/// Runs a scene and gives each of `count` times, `interval` apart (s), to `observe`.
fn follow(scene: &Scene, interval: f64, count: u32, mut observe: impl FnMut(f64, &mut Simulation)) {
    let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
    for i in 1..=count {
        let t = interval * f64::from(i);
        simulation.advance_to(t).unwrap();
        observe(t, &mut simulation);
    }
}

#[test]
fn without_friction_a_belt_carries_a_block_and_does_nothing_else() {
    for (scene, part) in both(NONE, 1e-5, 10.0) {
        follow(&scene, 0.05, 40, |t, simulation| {
            let expected = 0.02 * (10.0 * t).cos();
            assert!((simulation.displacement()[0] - expected).abs() < 0.02 * part, "{t}");
            let force = simulation.contact_forces().unwrap()[0];
            assert_eq!((force.state, force.friction_force), (Slide, 0.0));
            assert!((force.normal_force - 10.0).abs() < 1e-12);
            // It turns round twenty times, which is no change of state to what does not rub.
            assert_eq!(simulation.statistics().state_changes(), 0);
        });
    }
}

#[test]
fn coulomb_friction_shortens_each_half_swing_by_the_same_length_until_it_holds() {
    for (scene, part) in both(COULOMB, 1e-5, 10.0) {
        let half = std::f64::consts::PI / 10.0;
        let turns = [-0.055, 0.035, -0.015, -0.005];
        follow(&scene, half, 6, |t, simulation| {
            let passed = (t / half).round() as usize;
            let expected = turns[passed.min(4) - 1];
            let found = simulation.displacement()[0];
            assert!((found - expected).abs() < 0.1 * part, "{found} at {t}");
            assert!(passed <= 4 || simulation.contact_states()[0] == Stick);
        });
    }
}

#[test]
fn static_friction_holds_up_to_its_limit_and_lets_go_to_the_kinetic() {
    for (scene, part) in both(STATIC, 1e-5, 10.0) {
        follow(&scene, 0.1, 20, |t, simulation| {
            let late = (t - 1.5).max(0.0);
            let (sin, cos) = (5.0 * late).sin_cos();
            let expected = 2.0 / 25.0 * (1.0 - cos) + 4.0 / 25.0 * (late - sin / 5.0);
            assert!((simulation.displacement()[0] - expected).abs() < part, "{t}");
            let force = simulation.contact_forces().unwrap()[0];
            if t < 1.49 {
                assert!(force.state == Stick && (force.friction_force + 4.0 * t).abs() < 1e-9);
            } else if t > 1.51 {
                assert_eq!(force.state, ContactState::ReverseSlide);
                assert!((force.friction_force + 4.0).abs() < 1e-12);
            }
        });
    }
}

/// σ of the block on the belt, 1/s, from its numbers.
fn growth() -> f64 {
    (10.0 * (0.4 - 0.2) / 0.1 * (-1.0_f64).exp() - 6.0) / 2.0
}

#[test]
fn friction_that_falls_faster_than_the_damper_brakes_lets_vibration_grow_as_the_closed_form_says() {
    let mut scene = parse("effect", STRIBECK).unwrap();
    // The formula holds for small amplitudes: 1e-7 m/s at 0.1 m/s.
    let Some(network) = scene.network().cloned() else { panic!("a network") };
    let mut network = network;
    network.masses[0].velocity = [1e-7, 0.0];
    scene.structure = amontons::scene::Structure::Network(network);
    let worst_with = [2e-5, 2e-6].map(|step| {
        scene.step = step;
        let omega = (1e4 - growth().powi(2)).sqrt();
        let mut worst = 0.0_f64;
        follow(&scene, 0.05, 20, |t, simulation| {
            let expected = 1e-7 / omega * (growth() * t).exp() * (omega * t).sin();
            let size = 1e-7 / omega * (growth() * t).exp();
            worst = worst.max((simulation.displacement()[0] - expected).abs() / size);
        });
        worst
    });
    // The error is of first order: friction, as damping, lags by a step.
    let [coarse, fine] = worst_with;
    assert!(fine < 2e-2 && (8.0..12.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_stronger_damper_keeps_the_belt_quiet_and_a_weaker_one_lets_it_stick() {
    let quiet = STRIBECK.replace("damping = 6.0 ", "damping = 8.0 ");
    let scene = parse("effect", &quiet).unwrap();
    let mut last = f64::INFINITY;
    follow(&scene, 0.5, 6, |_, simulation| {
        let energy = 1e4 * simulation.displacement()[0].powi(2) + simulation.velocity()[0].powi(2);
        assert!(energy < last);
        last = energy;
    });
    let squeals = STRIBECK.replace("vx = 1.0e-2", "vx = 0.09");
    let mut sticks = 0;
    follow(&parse("effect", &squeals).unwrap(), 1e-3, 3000, |_, simulation| {
        sticks += u32::from(simulation.contact_states()[0] == Stick);
        // Never faster than the belt: friction would have to feed it there.
        assert!(simulation.velocity()[0] <= 0.1 + 1e-12);
    });
    assert!(sticks > 100, "{sticks}");
}

#[test]
fn the_analyser_knows_how_friction_falls() {
    use amontons::stability::Spectrum;
    use amontons_analysis::stability::{Linearised, modes};
    let here = Linearised::of(&parse("effect", STRIBECK).unwrap());
    let linear = here.linear().unwrap();
    let found = modes(linear, &[Slide]).unwrap();
    assert!((found.oscillating[0].growth_rate() - growth()).abs() < 1e-12);
    let omega = (1e4 - growth().powi(2)).sqrt();
    assert!((found.oscillating[0].eigenvalue.im - omega).abs() < 1e-10);
    assert!(Spectrum::of(linear, &[Slide]).unwrap().unstable());
    // A stuck contact knows nothing of it.
    assert!(!Spectrum::of(linear, &[Stick]).unwrap().unstable());
}

#[test]
fn without_sticking_friction_is_a_constant_force_and_slip_against_it_is_counted() {
    for (scene, part) in both(STICKING, 1e-5, 10.0) {
        let mut counted = 0;
        follow(&scene, 0.05, 40, |t, simulation| {
            let expected = 0.02 * (10.0 * t).cos();
            assert!((simulation.displacement()[0] - expected).abs() < 0.02 * part, "{t}");
            let force = simulation.contact_forces().unwrap()[0];
            assert!(force.state == Slide && (force.friction_force - 4.0).abs() < 1e-12);
            // The block is faster than the belt where sin(ω t) < -1/2.
            let count = simulation.statistics().reversed_slips;
            let phase = (10.0 * t) % std::f64::consts::TAU;
            if t < 0.36 {
                assert_eq!(count, 0, "{t}");
            } else if (3.8..5.6).contains(&phase) {
                assert!(count > counted, "{t}");
            }
            counted = count;
        });
    }
}

#[test]
fn a_slow_block_is_never_said_to_slip_against_its_friction() {
    let slow = STICKING.replace("x = 0.02 ", "x = 0.0099 ");
    for (scene, _) in both(&slow, 1e-5, 10.0) {
        follow(&scene, 2.0, 1, |_, simulation| {
            assert_eq!(simulation.statistics().reversed_slips, 0);
        });
    }
}

#[test]
fn a_contact_that_cannot_open_pulls_where_it_must_and_is_counted() {
    for (scene, part) in both(DETACHMENT, 1e-5, 10.0) {
        let mut counted = 0;
        follow(&scene, 0.05, 40, |t, simulation| {
            let swing = (10.0 * t).cos();
            let x = simulation.displacement().to_vec();
            assert_eq!(x[..2], [0.0; 2]);
            assert!((x[2] + 0.2 * swing).abs() < 0.2 * part, "{t}");
            let force = simulation.contact_forces().unwrap()[0];
            assert!((force.normal_force - (15.0 + 20.0 * swing)).abs() < 20.0 * part, "{t}");
            let count = simulation.statistics().pulled_contacts;
            if t < 0.24 {
                assert_eq!(count, 0);
            } else if swing < -0.8 {
                assert!(count > counted, "{t}");
            }
            counted = count;
        });
    }
}

#[test]
fn friction_of_a_contact_that_cannot_open_brakes_whichever_way_it_is_pressed() {
    // A slider in a slot, pulled up with 10 N in place of being pressed: it stops as if it were pressed.
    for weight in ["-10.0", "10.0"] {
        let slot = COULOMB
            .replace("[[mass]]", "[effects]\ndetachment = false\n\n[[mass]]")
            .replace("force = [0.0, -10.0]", &format!("force = [0.0, {weight}]"))
            .replace("method = \"event-driven\"\nstep = 1.0e-2", "step = 1.0e-5");
        let scene = parse("effect", &slot).unwrap();
        follow(&scene, 2.0, 1, |_, simulation| {
            assert!((simulation.displacement()[0] + 0.005).abs() < 1e-4);
            assert_eq!(simulation.contact_states()[0], Stick);
            assert_eq!(simulation.statistics().pulled_contacts > 0, weight == "10.0");
        });
    }
}

#[test]
fn a_frozen_direction_turns_with_the_surface_and_one_that_stands_has_none() {
    let still = STICKING.replace("x = 0.02 ", "x = 0.0 ");
    for (scene, part) in both(&still, 1e-5, 10.0) {
        for (velocity, offset) in [(0.05, 0.0), (0.0, -0.04), (-0.1, -0.08)] {
            let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
            let input = variables(&scene).into_iter().find(|v| v.name == "slider.velocity");
            simulation.write(&input.unwrap(), velocity).unwrap();
            for i in 1..=20 {
                let t = 0.05 * f64::from(i);
                simulation.advance_to(t).unwrap();
                // The spring had held 4 N of friction; what is left of that pulls the block about.
                let expected = offset * (1.0 - (10.0 * t).cos());
                assert!((simulation.displacement()[0] - expected).abs() < 0.2 * part, "{velocity}");
            }
        }
    }
}

/// The block sticks on the belt, which speeds up; all that holds it is inertia.
#[test]
fn what_sticks_is_held_by_all_of_static_friction_however_fast_its_surface_speeds_up() {
    // 1 kg at 3 m/s², 3 N of 4 N: a belt that is faster at the end of a step is no slip yet.
    let text = STRIBECK
        .replace("stribeck_velocity = 0.1 ", "stribeck_velocity = 1.0e-4 ")
        .replace("stiffness = 1.0e4 ", "stiffness = 1.0e-3 ")
        .replace("damping = 6.0 ", "damping = 0.0 ")
        .replace("velocity = 0.1  ", "velocity = 0.0  ")
        .replace("vx = 1.0e-2 ", "vx = 0.0 ");
    let signal =
        "[[signal]]\ninput = \"slider.velocity\"\nramp = { from = 0.0, to = 3.0, end = 1.0 }\n";
    let mut scene = parse("effect", &format!("{text}\n{signal}")).unwrap();
    for step in [1e-3, 1e-4, 1e-5] {
        scene.step = step;
        follow(&scene, 0.1, 3, |t, simulation| {
            assert_eq!(simulation.contact_states()[0], Stick, "{t} {step}");
            assert!((simulation.velocity()[0] - 3.0 * t).abs() < 1e-9);
        });
    }
}

#[test]
fn friction_that_follows_the_size_of_a_pull_has_no_equilibrium_of_its_own_sign() {
    // Pressed up with 10 N on a belt that moves: the linear solution would have friction that drives.
    let pulled = COULOMB
        .replace("[[mass]]", "[effects]\ndetachment = false\n\n[[mass]]")
        .replace("force = [0.0, -10.0]", "force = [0.0, 10.0]")
        .replace("velocity = 0.0 ", "velocity = 0.1 ")
        .replace("method = \"event-driven\"\nstep = 1.0e-2", "step = 1.0e-5");
    let error = Simulation::new(parse("effect", &pulled).unwrap(), 0.0).err().unwrap().to_string();
    assert!(error.contains("contact.floor"), "{error}");
}

#[test]
fn states_that_the_law_leaves_out_do_not_bound_the_step() {
    // Were the contact to open, the stiff spring would ask for 2e-5 s.
    let stiff = STICKING
        .replace("sticking = false", "sticking = false\ndetachment = false")
        .replace("method = \"event-driven\"\nstep = 1.0e-2", "step = 1.0e-3");
    let spring = "[[spring]]\nname = \"stiff\"\nbetween = [\"block\", \"ground\"]\ndirection = \"y\"\n\
        stiffness = 1.0e10\n\n[[contact]]";
    let scene = parse("effect", &stiff.replace("[[contact]]", spring)).unwrap();
    follow(&scene, 0.05, 40, |t, simulation| {
        let expected = 0.02 * (10.0 * t).cos();
        assert!((simulation.displacement()[0] - expected).abs() < 2e-4, "{t}");
    });
}

#[test]
fn a_falling_law_takes_no_velocity_of_zero_to_fall_over() {
    let mut simulation = Simulation::new(parse("effect", STRIBECK).unwrap(), 0.0).unwrap();
    let all = variables(simulation.scene());
    let v_s = all.iter().find(|v| v.name == "friction.stribeck_velocity").unwrap();
    let error = simulation.write(v_s, 0.0).unwrap_err().to_string();
    assert!(error.contains("must be above zero"), "{error}");
    simulation.write(v_s, 1e-310).unwrap();
    simulation.advance_to(0.1).unwrap();
}

#[test]
fn a_surface_that_stands_still_is_warned_of_where_friction_has_its_direction() {
    use amontons_analysis::warning::warnings;
    let standing = STICKING.replace("velocity = 0.1  ", "velocity = 0.0  ");
    for (text, warned) in [(STICKING, false), (&*standing, true)] {
        let simulation = Simulation::new(parse("effect", text).unwrap(), 0.0).unwrap();
        let found = warnings(&simulation);
        assert_eq!(found.iter().any(|warning| warning.contains("direction")), warned, "{found:?}");
    }
}
