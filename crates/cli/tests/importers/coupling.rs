//! Two scenes that exchange values at communication points, as `examples/coupled.rs` does it, against one scene that has
//! the masses of both.

use crate::coupled::{self, Coupled};
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::{Simulation, variables};
use amontons_analysis::assign::assign;
use std::fmt::Write;

const STOP_TIME: f64 = 0.02;

/// Set 1 without damping, exact between events, with a start velocity of one mass (m/s).
fn set1(push: f64) -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    assign(&mut scene, "damping.beta", 0.0).unwrap();
    assign(&mut scene, "initial.module[1].v1", 0.0).unwrap();
    assign(&mut scene, "initial.module[1].v2", push).unwrap();
    scene.with_integrator(Method::EventDriven, 1e-5)
}

/// The drive.
fn drive() -> Scene {
    builtin("drive").unwrap().scene()
}

/// Both in one network: what rubs on the slider rubs on the table, whose surface moves against the table as the nut does
/// against the ground. The table starts where it is without a reaction.
fn whole(push: f64) -> Scene {
    let ring = set1(push);
    let (angle, friction) = (ring.slider.angle, ring.friction_coefficient);
    let drive = drive();
    let network = drive.network().unwrap();
    let (nut, mass) = (drive.slider.velocity, network.masses[0].mass);
    let (stiffness, damping) = (network.springs[0].stiffness, network.dampers[0].damping);
    let mut alone = Simulation::new(ring.clone(), 0.0).unwrap();
    let reaction = variables(&ring).into_iter().find(|v| v.name == coupled::REACTION[0]).unwrap();
    let start = -alone.read(&reaction).unwrap() / stiffness;
    let mut text = format!(
        "[friction]\ncoefficient = {friction:?}\n[integrator]\nmethod = \"event-driven\"\nstep = 1e-5\n\
         [[mass]]\nname = \"table\"\nmass = {mass:?}\nangle = {angle:?}\nlocked = [\"y\"]\n\
         [[spring]]\nname = \"screw\"\nbetween = [\"table\", \"ground\"]\ndirection = {angle:?}\n\
         stiffness = {stiffness:?}\n\
         [[damper]]\nname = \"screw\"\nbetween = [\"table\", \"ground\"]\ndirection = {angle:?}\n\
         damping = {damping:?}\n[[initial]]\nmass = \"table\"\nx = {start:?}\n"
    );
    let modules = ring.modules();
    for (i, module) in modules.iter().enumerate() {
        let ([m1, m2], [k1, k2, k3, k4, k5, k6]) = (module.mass, module.stiffness);
        let next = (i + 1) % modules.len();
        let (preload, [v1, v2, v3, v4]) = (-module.preload, module.velocity);
        let _ = write!(
            text,
            "[[mass]]\nname = \"upper{i}\"\nmass = {m1:?}\n\
             [[mass]]\nname = \"lower{i}\"\nmass = {m2:?}\nangle = {angle:?}\n\
             [[contact]]\nname = \"c{i}\"\nmass = \"lower{i}\"\non = \"table\"\nangle = {angle:?}\n\
             velocity = {nut:?}\n\
             [[initial]]\nmass = \"upper{i}\"\nvx = {v1:?}\nvy = {v2:?}\n\
             [[initial]]\nmass = \"lower{i}\"\nvx = {v3:?}\nvy = {v4:?}\n"
        );
        for (name, other, direction, stiffness, preload) in [
            ("k1", format!("upper{next}"), "x", k1, 0.0),
            ("k2", format!("upper{next}"), "y", k2, 0.0),
            ("k3", "ground".into(), "y", k3, preload),
            ("k4", "ground".into(), "x", k4, 0.0),
            ("k5", format!("lower{i}"), "y", k5, 0.0),
            ("k6", format!("lower{i}"), "x", k6, 0.0),
        ] {
            let _ = write!(
                text,
                "[[spring]]\nname = \"{name}_{i}\"\nbetween = [\"upper{i}\", \"{other}\"]\n\
                 direction = \"{direction}\"\nstiffness = {stiffness:?}\npreload = {preload:?}\n"
            );
        }
    }
    parse("whole", &text).unwrap()
}

/// Velocity of the table and of the mass that is pushed, m/s, at the end of the run.
type End = [f64; 2];

fn value(simulation: &mut Simulation, name: &str) -> f64 {
    let variable = variables(simulation.scene()).into_iter().find(|v| v.name == name).unwrap();
    simulation.read(&variable).unwrap()
}

/// The end of the run of one scene, and how often contacts changed their states.
fn truth(push: f64) -> (End, f64) {
    let mut simulation = Simulation::new(whole(push), 0.0).unwrap();
    simulation.advance_to(STOP_TIME).unwrap();
    let end = ["mass.table.vx", "mass.upper0.vy"].map(|name| value(&mut simulation, name));
    (end, value(&mut simulation, "statistics.state_changes"))
}

/// The end of the coupled run with so many communication steps.
fn end(push: f64, steps: u32, rates: bool) -> End {
    let mut coupled = Coupled::new(set1(push), drive()).unwrap();
    for step in 1..=steps {
        coupled.exchange(rates).unwrap();
        coupled.advance_to(f64::from(step) * STOP_TIME / f64::from(steps)).unwrap();
    }
    let (names, values) = (coupled.names(), coupled.values().unwrap());
    ["drive.mass.table.vx", "scene.module[1].v2"]
        .map(|name| values[names.iter().position(|(known, _)| known == name).unwrap()])
}

/// Errors of the table's velocity with `steps` steps, and with twice, four and eight times as many.
fn errors(push: f64, steps: u32, rates: bool) -> [f64; 4] {
    let ([table, _], _) = truth(push);
    [1, 2, 4, 8].map(|times| (end(push, times * steps, rates)[0] - table).abs())
}

#[test]
fn held_values_are_of_first_order_and_rates_of_second_while_contacts_slide() {
    let (truth, changes) = truth(0.01);
    assert!(changes == 0.0 && truth[0].abs() > 0.01);
    for (rates, order) in [(false, 1.0), (true, 2.0)] {
        let errors = errors(0.01, 400, rates);
        for pair in errors.windows(2) {
            let found = (pair[0] / pair[1]).log2();
            assert!((found - order).abs() < 0.15, "rates {rates}: order {found} of {errors:?}");
        }
        assert!(errors[3] < 2e-5, "{errors:?}");
        // Friction that slides does not feel how fast.
        assert!((end(0.01, 400, rates)[1] - truth[1]).abs() < 1e-14);
    }
}

/// A mass that sticks follows the slider: where its velocity jumps at communication points, the forces in between do not
/// have what speeds the mass up, and the table does not feel its inertia.
#[test]
fn while_contacts_stick_rates_lead_to_the_truth_and_held_values_beside_it() {
    let (truth, changes) = truth(0.3);
    assert!(changes > 10.0);
    let with_rates = errors(0.3, 80, true);
    let held = errors(0.3, 80, false);
    println!("{truth:?}\n{with_rates:?}\n{held:?}");
    assert!(with_rates[3] < 0.2 * with_rates[0] && with_rates[3] < 0.01 * truth[0].abs());
    assert!(held[2] > 0.1 * truth[0].abs() && held[3] > 0.9 * held[2]);
}

/// A block on the slider, one on the carriage of another block that rolls on ground, and one on a surface with a velocity
/// of its own; all swing, and the slider's velocity does too.
const THREE: &str = r#"
[slider]
velocity = 0.4
angle = 0.3
[friction]
coefficient = 0.3
[effects]
energy = true
[[mass]]
name = "plain"
mass = 1.0
angle = 0.3
force = [0.0, -20.0]
[[mass]]
name = "rider"
mass = 0.5
force = [0.0, -10.0]
[[mass]]
name = "carriage"
mass = 2.0
locked = ["y"]
[[mass]]
name = "other"
mass = 0.7
force = [0.0, -15.0]
[[spring]]
name = "a"
between = ["plain", "ground"]
direction = 0.9
stiffness = 900.0
[[spring]]
name = "b"
between = ["rider", "ground"]
direction = 0.5
stiffness = 400.0
[[spring]]
name = "c"
between = ["carriage", "ground"]
direction = "x"
stiffness = 700.0
[[spring]]
name = "d"
between = ["other", "ground"]
direction = 0.4
stiffness = 300.0
[[contact]]
name = "plain"
mass = "plain"
[[contact]]
name = "rider"
mass = "rider"
on = "carriage"
angle = 0.0
[[contact]]
name = "other"
mass = "other"
angle = 0.0
velocity = -0.6
[[initial]]
mass = "plain"
vx = 0.05
[[initial]]
mass = "rider"
vx = 0.04
[[initial]]
mass = "other"
vx = 0.03
[[signal]]
input = "slider.velocity"
sine = { amplitude = 0.1, frequency = 2.0 }
[integrator]
method = "event-driven"
step = 1e-3
"#;

/// The work of whoever moves the surfaces is in the ledger; that of the slider is −∫ reaction · v dt, and that of a
/// surface with a velocity w of its own ∫ T w dt.
#[test]
fn the_reaction_of_a_network_belongs_to_the_velocity_of_its_slider() {
    let mut simulation = Simulation::new(parse("three", THREE).unwrap(), 0.0).unwrap();
    let interval = 1e-4;
    let mut power = |t: f64| {
        simulation.advance_to(t).unwrap();
        let mut read = |name: &str| value(&mut simulation, name);
        let velocity = 0.4 + 0.1 * (4.0 * std::f64::consts::PI * t).sin();
        let powers = [
            -read("slider.tangential_reaction") * velocity,
            -0.6 * read("contact.other.friction_force"),
        ];
        (powers, read("energy.slider"))
    };
    let (mut last, _) = power(0.0);
    let mut work = [0.0; 2];
    for row in 1..=10_000_u32 {
        let (now, ledger) = power(f64::from(row) * interval);
        for (work, ends) in work.iter_mut().zip(last.iter().zip(now)) {
            *work += 0.5 * interval * (ends.0 + ends.1);
        }
        last = now;
        // A trapezium is off by a jump of the power, of 10 W, where a contact changes its state.
        let sum: f64 = work.iter().sum();
        assert!((sum - ledger).abs() < 5e-3, "at row {row}: {work:?} for {ledger}");
    }
    assert!(work[0] > 1.0 && work[1] > 1.0, "{work:?}");
}

#[test]
fn a_network_has_reactions_of_what_rubs_on_its_slider_with_friction_alone() {
    let reactions = |text: &str| {
        let all = variables(&parse("mine", text).unwrap()).into_iter().map(|v| v.name);
        all.filter(|name| name.ends_with("_reaction")).collect::<Vec<_>>()
    };
    let [tangential, normal] = ["slider.tangential_reaction", "slider.normal_reaction"];
    // The rider's surface is carried by the carriage: the slider does not feel how it is pressed.
    assert_eq!(reactions(THREE), [tangential]);
    let aside = THREE.replace("on = \"carriage\"\nangle = 0.0\n", "velocity = 0.1\nangle = 0.0\n");
    assert_eq!(reactions(&aside), [tangential, normal]);
    let text = |name: &str| builtin(name).unwrap().text;
    assert_eq!(reactions(text("belt")), [tangential, normal]);
    assert_eq!(reactions(text("corner")), [tangential]);
    assert_eq!(reactions(text("disc_brake")), <[&str; 0]>::default());
    assert_eq!(reactions(text("drive")), <[&str; 0]>::default());
    // In uniform sliding a block that weighs 10 N has N = 10 N and T = µN.
    let mut scene = builtin("belt").unwrap().scene();
    scene.rest();
    let friction = scene.friction_coefficient;
    let mut belt = Simulation::new(scene, 0.0).unwrap();
    assert_eq!(value(&mut belt, normal), -10.0);
    assert!((value(&mut belt, tangential) + friction * 10.0).abs() < 1e-12);
}
