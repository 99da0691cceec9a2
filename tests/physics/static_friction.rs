//! Static friction above the kinetic one, with both integrators.

use crate::trajectory::{self, difference};
use amontons::contact::ContactState::{Slide, Stick};
use amontons::contact::residual::{Instant, Scales, residual};
use amontons::contact::{ContactState, Friction};
use amontons::scene::{Method, Scene, Structure, builtin, parse};
use amontons::simulation::{Simulation, variables};
use std::f64::consts::TAU;

const METHODS: [Method; 2] = [Method::ForwardIncrement, Method::EventDriven];

// ---- stick_slip: m = 1, k = 100, N = 10, µ = 0.4, µ_s = 0.6, v = 0.1 ----

const OMEGA: f64 = 10.0;
const BELT: f64 = 0.1;
/// d = (µ_s − µ_k) N / k: how far the belt carries the block beyond µ_k N / k.
const CARRIED: f64 = 0.02;

fn stick_time() -> f64 {
    2.0 * CARRIED / BELT
}

fn slip_time() -> f64 {
    2.0 / OMEGA * (std::f64::consts::PI - (CARRIED * OMEGA / BELT).atan())
}

/// x of the block from µ_k N / k, m, and its contact's state; stuck at 0 when t = 0.
fn cycle(t: f64) -> (f64, ContactState) {
    let in_period = (t + CARRIED / BELT) % (stick_time() + slip_time());
    if in_period < stick_time() {
        return (-CARRIED + BELT * in_period, Stick);
    }
    let (sin, cos) = (OMEGA * (in_period - stick_time())).sin_cos();
    (CARRIED * cos + BELT / OMEGA * sin, Slide)
}

fn stick_slip(method: Method, step: f64) -> Scene {
    Scene { method, step, ..builtin("stick_slip").unwrap().scene() }
}

#[test]
fn a_block_on_a_belt_sticks_and_slips_by_its_closed_form_to_the_last_digits() {
    let mut simulation = Simulation::new(stick_slip(Method::EventDriven, 1e-2), 0.0).unwrap();
    for row in 1..=1000 {
        let t = 0.01 * f64::from(row);
        simulation.advance_to(t).unwrap();
        let (x, state) = cycle(t);
        assert!((simulation.displacement()[0] - x).abs() < 1e-12, "at {t} s");
        assert_eq!(simulation.contact_forces().unwrap()[0].state, state, "at {t} s");
    }
    // 10.2 s from being caught are 12.6 periods of 0.807 s: thirteen times let go, twelve times caught.
    assert_eq!(simulation.statistics().state_changes(), 25);
}

#[test]
fn the_papers_scheme_goes_to_that_closed_form_with_its_step() {
    for step in [1e-4, 1e-5, 1e-6] {
        let mut simulation =
            Simulation::new(stick_slip(Method::ForwardIncrement, step), 0.0).unwrap();
        for row in 1..=300 {
            let t = 0.01 * f64::from(row);
            simulation.advance_to(t).unwrap();
            // Let go or caught up to a step late each time, a step's phase ahead while it slips.
            let changes =
                f64::from(u32::try_from(simulation.statistics().state_changes()).unwrap());
            let amplitude = CARRIED.hypot(BELT / OMEGA);
            let off = simulation.displacement()[0] - cycle(t).0;
            let allowed = (1.0 + changes) * step * OMEGA * amplitude;
            assert!(off.abs() < allowed, "{off:e} of {allowed:e} at {t} s with h = {step}");
        }
        assert_eq!(simulation.statistics().state_changes(), 7);
    }
}

// ---- Set 1 on its cycle ----

/// Set 1, pushed by 0.01 m/s.
fn set1(method: Method, step: f64) -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    (scene.friction_coefficient, scene.static_friction) = (1.96, Some(2.4));
    scene.modules_mut()[0].velocity[0] = 0.01;
    Scene { method, step, ..scene }
}

#[test]
fn contacts_hold_up_to_static_friction_slip_under_kinetic_and_keep_the_law_throughout() {
    let friction = Friction::with_static(1.96, 2.4);
    for method in METHODS {
        let scene = set1(method, if method == Method::EventDriven { 1e-4 } else { 1e-5 });
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        let load = simulation.reference().normal_force[0];
        let scales = Scales { length: load / 3e4, velocity: 0.025, force: load };
        let (mut most_held, mut slipped) = (0.0, 0);
        for row in 1..=5000 {
            simulation.advance_to(1e-4 * f64::from(row)).unwrap();
            let gaps = [3, 7].map(|dof| simulation.displacement()[dof]);
            let openings = [3, 7].map(|dof| simulation.velocity()[dof]);
            for (i, force) in simulation.contact_forces().unwrap().iter().enumerate() {
                let instant = Instant {
                    gap: gaps[i],
                    gap_velocity: openings[i],
                    slip_velocity: force.slip_velocity,
                    normal_force: force.normal_force,
                    friction_force: force.friction_force,
                };
                let found = residual(&instant, friction, &scales);
                assert!(found.size < 1e-12, "{method:?} {row}: {found}");
                let ratio = force.friction_force.abs() / force.normal_force;
                match force.state {
                    Stick => most_held = f64::max(most_held, ratio),
                    Slide => slipped += 1,
                    _ => {}
                }
            }
        }
        // Without a static coefficient no contact holds beyond µ.
        assert!((2.2..=2.4).contains(&most_held) && slipped > 1000, "{most_held} {slipped}");
    }
}

/// Displacements every millisecond up to `stop` (s), and the number of changes of state.
fn run(scene: Scene, stop: f64) -> (Vec<f64>, f64) {
    let (rows, counted) = trajectory::run(scene, stop);
    (rows, f64::from(u32::try_from(counted.state_changes()).unwrap()))
}

/// Two pads on a disc, with more static friction than kinetic, one of them knocked to the speed of the
/// disc.
fn disc_brake(method: Method, step: f64) -> Scene {
    let mut scene = builtin("disc_brake").unwrap().scene();
    scene.static_friction = Some(1.3 * scene.friction_coefficient);
    if let Structure::Network(network) = &mut scene.structure {
        network.masses[0].velocity[0] = 0.05;
    }
    Scene { method, step, ..scene }
}

#[test]
fn both_integrators_agree_on_a_cycle_with_static_friction() {
    let (exact, _) = run(set1(Method::EventDriven, 1e-3), 0.3);
    let half = difference(&exact, &run(set1(Method::EventDriven, 5e-4), 0.3).0);
    assert!(half < 1e-12, "{half:e}");
    let errors = [4e-7, 2e-7, 1e-7]
        .map(|step| difference(&exact, &run(set1(Method::ForwardIncrement, step), 0.3).0));
    for two in errors.windows(2) {
        let order = (two[0] / two[1]).log2();
        assert!((0.9..1.1).contains(&order), "order {order}, errors {errors:?}");
    }
}

#[test]
fn both_integrators_agree_where_contacts_share_masses() {
    const HIGHEST_FREQUENCY: f64 = 1300.0;
    let (exact, changes) = run(disc_brake(Method::EventDriven, 1e-3), 0.01);
    let half = difference(&exact, &run(disc_brake(Method::EventDriven, 5e-4), 0.01).0);
    assert!(changes > 10.0 && half < 1e-11, "{changes} {half:e}");
    for step in [1e-6, 1e-7, 1e-8] {
        // Up to a step late at each change, at ω times the amplitude.
        let allowed = changes * TAU * HIGHEST_FREQUENCY * step;
        let off = difference(&exact, &run(disc_brake(Method::ForwardIncrement, step), 0.01).0);
        assert!(off < allowed, "{off:e} of {allowed:e} with h = {step}");
    }
}

/// Two pads of 1 kg that 10 N press on a disc of 1 kg, pulled along by c t; each hangs on a spring of its own.
const PADS: &str = r#"
[slider]
velocity = 0.0
angle = 0.0
[friction]
coefficient = 0.4
static = 0.6
[integrator]
step = 1e-3
[[mass]]
name = "disc"
mass = 1.0
locked = ["y"]
[[mass]]
name = "upper"
mass = 1.0
force = [0.0, -10.0]
[[mass]]
name = "lower"
mass = 1.0
force = [0.0, 10.0]
[[spring]]
name = "upper_guide"
between = ["upper", "ground"]
direction = "x"
stiffness = 1e3
[[spring]]
name = "lower_guide"
between = ["lower", "ground"]
direction = "x"
stiffness = 1e3
[[contact]]
name = "above"
mass = "upper"
on = "disc"
angle = 0.0
[[contact]]
name = "below"
mass = "lower"
on = "disc"
angle = 3.141592653589793
[[spring]]
name = "bearing"
between = ["disc", "ground"]
direction = "x"
stiffness = 1e-3
[[signal]]
input = "mass.disc.fx"
ramp = { to = 20.0, end = 20.0 }
"#;

#[test]
fn contacts_on_one_mass_hold_together_what_each_holds_alone() {
    for method in METHODS {
        let scene = Scene { method, ..parse("pads", PADS).unwrap() };
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        let mut time = 0.0;
        while simulation.statistics().state_changes() == 0 {
            time += 0.01;
            assert!(time < 15.0, "{method:?} does not let go");
            simulation.advance_to(time).unwrap();
        }
        // Each carries half of the pull, and c/2ω of the swing with which the ramp begins.
        let swing = 0.5 / (2e3_f64 / 3.0).sqrt();
        assert!((time - 12.0).abs() < 2.0 * swing + 0.02, "{method:?} lets go at {time} N");
    }
}

#[test]
fn a_static_coefficient_like_the_kinetic_one_changes_no_bit() {
    for name in ["set1", "disc_brake", "corner", "belt"] {
        for method in METHODS {
            let scene = builtin(name).unwrap().scene();
            let same = Some(scene.friction_coefficient);
            let [a, b] = [None, same].map(|static_friction| {
                let scene = Scene { static_friction, method, ..scene.clone() };
                let mut simulation = Simulation::new(scene, 0.0).unwrap();
                simulation.advance_to(0.02).unwrap();
                let forces = simulation.contact_forces().unwrap().to_vec();
                (simulation.displacement().to_vec(), simulation.velocity().to_vec(), forces)
            });
            assert_eq!(a, b, "{name} {method:?}");
        }
    }
}

// ---- Scenes, inputs and signals ----

const PAD: &str = "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.4\nstatic = 0.6\n\
    [integrator]\nstep = 1e-4\n[[mass]]\nname = \"a\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\n\
    name = \"k\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n";

/// The pad with this contact.
fn pad(contact: &str) -> Scene {
    parse("pad", &format!("{PAD}[[contact]]\nname = \"c\"\nmass = \"a\"\n{contact}")).unwrap()
}

#[test]
fn the_common_static_coefficient_belongs_to_the_common_kinetic_one() {
    for (contact, expected) in [
        ("", [0.4, 0.6]),
        ("friction = 0.7", [0.7, 0.7]),
        ("static_friction = 0.5", [0.4, 0.5]),
        ("friction = 0.7\nstatic_friction = 0.9", [0.7, 0.9]),
    ] {
        let model = amontons::model::LumpedModel::from(&pad(contact));
        let Friction { kinetic, static_, .. } = model.contacts[0].friction;
        assert_eq!([kinetic, static_], expected, "{contact}");
    }
}

#[test]
fn static_friction_has_a_variable_only_where_a_scene_has_it() {
    let names = |scene: &Scene| -> Vec<String> {
        let all = variables(scene).into_iter().map(|variable| variable.name);
        all.filter(|name| name.contains("static")).collect()
    };
    assert!(names(&builtin("set1").unwrap().scene()).is_empty());
    assert_eq!(names(&pad("")), ["friction.static"]);
    let own = pad("static_friction = 0.5");
    // The common one, which no contact has then, is not there either.
    assert_eq!(names(&own), ["contact.c.static_friction"]);
}

#[test]
fn static_friction_below_the_kinetic_one_is_refused_whoever_brings_it_there() {
    let mut scene = pad("");
    scene.static_friction = Some(0.3);
    let error = scene.check().unwrap_err().to_string();
    assert!(
        error.contains("friction.static = 0.3: must be at least the kinetic friction"),
        "{error}"
    );

    let mut simulation = Simulation::new(pad(""), 0.0).unwrap();
    let all = variables(simulation.scene());
    let [kinetic, static_] = ["friction.coefficient", "friction.static"]
        .map(|name| all.iter().find(|variable| variable.name == name).unwrap());
    simulation.write(kinetic, 0.7).unwrap();
    for _ in 0..2 {
        // Not forgotten at the second try.
        let error = simulation.advance_to(0.01).unwrap_err().to_string();
        assert!(
            error.contains("static friction coefficient of contact.c is 0.6, below"),
            "{error}"
        );
    }
    // In either order, so both can be raised.
    simulation.write(static_, 0.8).unwrap();
    simulation.advance_to(0.01).unwrap();

    let ramp = "[[signal]]\ninput = \"friction.coefficient\"\nramp = { to = 0.4, end = 1.0 }";
    let mut driven = Simulation::new(pad(ramp), 0.0).unwrap();
    let error = driven.advance_to(1.0).unwrap_err().to_string();
    assert!(error.contains("static friction coefficient of contact.c is 0.6, below"), "{error}");
}

#[test]
fn a_signal_of_static_friction_lets_a_stuck_block_go() {
    // Carried halfway to where it would slip, it is held by no more than a quarter of the difference.
    let pulse = "\n[[signal]]\ninput = \"friction.static\"\npulse = { value = -0.15, start = 0.1 }";
    for method in METHODS {
        let text = format!("{}{pulse}", builtin("stick_slip").unwrap().text);
        let scene = Scene { method, ..parse("driven", &text).unwrap() };
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        simulation.advance_to(0.1).unwrap();
        let held = simulation.contact_forces().unwrap()[0];
        assert_eq!(held.state, Slide, "{method:?}");
        simulation.advance_to(0.2).unwrap();
        let x = BELT / OMEGA * (2.0_f64.sqrt()) * (1.0 + std::f64::consts::FRAC_PI_4).sin();
        let off = (simulation.displacement()[0] - x).abs();
        let allowed = if method == Method::EventDriven { 1e-14 } else { 2e-4 * BELT };
        assert!(off < allowed, "{method:?} {off:e}");
    }
}
