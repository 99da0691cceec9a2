//! The event-driven integrator: exact between events, and the limit that the paper's scheme goes to.

use crate::trajectory::{self, difference};
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::Simulation;

fn scene(name: &str) -> Scene {
    let mut scene = builtin(name).unwrap().scene();
    scene.method = Method::EventDriven;
    scene
}

/// Set 1, pushed by 0.01 m/s.
fn set1(friction: f64, velocity: f64) -> Scene {
    let mut scene = scene("set1");
    (scene.friction_coefficient, scene.slider.velocity) = (friction, velocity);
    scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
    scene
}

/// Set 1 thrown off the slider.
fn thrown() -> Scene {
    let mut scene = set1(1.5, 0.15);
    scene.modules_mut()[0].velocity = [0.5, 1.5, 0.0, 0.0];
    scene
}

fn ring_of_three() -> Scene {
    let mut scene = set1(1.96, 0.025);
    let module = scene.modules_mut()[1];
    scene.modules_mut().push(module);
    scene
}

/// Displacements every millisecond up to `stop` (s), and the numbers of changes of state and touch-downs.
fn run(scene: &Scene, step: f64, stop: f64) -> (Vec<f64>, u64, u64) {
    let (rows, counted) = trajectory::run(Scene { step, ..scene.clone() }, stop);
    (rows, counted.state_changes(), counted.touch_downs)
}

#[test]
fn the_step_does_not_decide_how_accurate_a_run_is() {
    for (name, scene, stop, events, touch_downs) in [
        ("set1", set1(1.96, 0.025), 1.0, 500, 0),
        ("with touch-downs", set1(1.5, 0.15), 1.0, 500, 100),
        ("three", ring_of_three(), 0.6, 100, 0),
        ("set2", scene("set2"), 1.0, 500, 0),
        ("disc_brake", scene("disc_brake"), 0.1, 100, 0),
        ("hoffmann", scene("hoffmann"), 60.0, 10, 1),
    ] {
        let (whole, changes, touches) = run(&scene, 1e-3, stop);
        let (half, again, _) = run(&scene, 5e-4, stop);
        let apart = difference(&whole, &half);
        println!("{name}: {apart:e} {changes} {touches}");
        assert!(changes > events && touches >= touch_downs, "{name}: {changes} {touches}");
        assert_eq!(changes, again, "{name}");
        assert!(apart < 1e-12, "{name}: {apart:e}");
    }
}

#[test]
fn the_papers_scheme_goes_to_it_in_first_order() {
    for (name, scene, stop) in [
        ("set1", set1(1.96, 0.025), 0.25),
        ("with touch-downs", thrown(), 0.05),
        ("three", ring_of_three(), 0.3),
    ] {
        let (exact, changes, touch_downs) = run(&scene, 1e-3, stop);
        assert!(changes > 10, "{name}: {changes}");
        assert_eq!(touch_downs > 0, name == "with touch-downs", "{touch_downs}");
        let scheme = Scene { method: Method::ForwardIncrement, ..scene };
        let steps = [4e-7, 2e-7, 1e-7];
        let errors = steps.map(|step| difference(&exact, &run(&scheme, step, stop).0));
        for two in errors.windows(2) {
            let order = (two[0] / two[1]).log2();
            assert!((0.9..1.1).contains(&order), "{name}: order {order}, errors {errors:?}");
        }
    }
}

#[test]
fn a_mass_on_a_belt_slips_and_swings_as_its_closed_form_to_the_last_digits() {
    // Stuck until the spring carries µN, at 0.4 s; then 0.01 m · sin 10 (t − 0.4) about µN/k.
    let scene = scene("belt");
    let mut simulation = Simulation::new(Scene { step: 1e-2, ..scene }, 0.0).unwrap();
    for row in 1..=300 {
        let t = 0.01 * f64::from(row);
        simulation.advance_to(t).unwrap();
        let x = simulation.displacement()[0];
        let expected = if t < 0.4 { -0.04 + 0.1 * t } else { 0.01 * (10.0 * (t - 0.4)).sin() };
        assert!((x - expected).abs() < 1e-13, "{x} {expected} at {t} s");
    }
}

/// Set 2 comes to an instant, at 1.13935 s, at which a contact lets go with its reserve of friction zero
/// up to rounding. What is nothing in the reserve has to be nothing in the slip that follows: otherwise the
/// contact sticks and slips in turn without an end.
#[test]
fn a_contact_that_lets_go_by_no_more_than_rounding_moves_on() {
    let whole = run(&scene("set2"), 1e-3, 1.15);
    let half = run(&scene("set2"), 5e-4, 1.15);
    assert_eq!(whole.1, half.1);
    assert!(difference(&whole.0, &half.0) < 1e-10);
}

#[test]
fn a_mass_that_touches_nothing_swings_on_its_spring() {
    let text = "[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
        between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[[initial]]\n\
        mass = \"a\"\nx = 0.01\nvx = 0.3\n[integrator]\nmethod = \"event-driven\"\nstep = 1e-2\n";
    let mut simulation = Simulation::new(parse("free", text).unwrap(), 0.0).unwrap();
    for row in 1..=500 {
        let t = 0.01 * f64::from(row);
        simulation.advance_to(t).unwrap();
        let (sin, cos) = (20.0 * t).sin_cos();
        let off = simulation.displacement()[0] - (0.01 * cos + 0.015 * sin);
        assert!(off.abs() < 1e-14, "{off:e} at {t} s");
    }
}

#[test]
fn a_run_is_the_same_however_it_is_split_and_after_a_restore() {
    for scene in [set1(1.5, 0.15), scene("disc_brake"), scene("corner")] {
        let scene = Scene { step: 2.5e-4, ..scene };
        let mut straight = Simulation::new(scene.clone(), 0.0).unwrap();
        let mut split = Simulation::new(scene, 0.0).unwrap();
        for count in [1, 2, 3, 50, 51, 200, 300] {
            split.advance_to(2.5e-4 * f64::from(count)).unwrap();
            split.contact_forces().unwrap();
            let saved = split.save();
            split.advance_to(2.5e-4 * f64::from(count + 9)).unwrap();
            split.restore(&saved).unwrap();
            split = Simulation::resume(saved).unwrap();
        }
        for run in [&mut straight, &mut split] {
            run.advance_to(0.1).unwrap();
        }
        assert!(straight.save() == split.save());
    }
}

#[test]
fn an_undamped_system_keeps_its_energy_between_events() {
    // Set 1 without damping and friction: nothing takes energy while all contacts stay closed.
    let mut scene = set1(0.0, 0.025);
    scene.damping.beta = 0.0;
    let model = amontons::model::LumpedModel::from(&scene);
    let mut simulation = Simulation::new(Scene { step: 1e-3, ..scene }, 0.0).unwrap();
    let energy = |simulation: &Simulation| {
        let (x, v) = (simulation.displacement(), simulation.velocity());
        let form = |matrix: &amontons::model::SparseMatrix, u: &[f64]| {
            (0..u.len()).fold(0.0, |sum, row| sum + 0.5 * u[row] * matrix.row_times(row, u))
        };
        form(&model.mass, v) + form(&model.stiffness, x)
    };
    let start = energy(&simulation);
    simulation.advance_to(20.0).unwrap();
    assert_eq!(simulation.statistics().state_changes(), 0);
    assert!((energy(&simulation) / start - 1.0).abs() < 1e-11);
}

#[test]
fn masses_in_contact_do_not_drift_apart() {
    // Block and surface of Hoffmann's model move together, far from their first place, for 10 s.
    let mut simulation = Simulation::new(scene("hoffmann"), 0.0).unwrap();
    simulation.advance_to(10.0).unwrap();
    assert_eq!(simulation.statistics().state_changes(), 0);
    let [_, block, surface] = simulation.displacement() else { panic!("it has two masses") };
    assert!(block.abs() > 1e-3);
    assert!((block - surface).abs() <= 4.0 * f64::EPSILON * block.abs(), "{block} {surface}");
}

#[test]
fn ramps_of_force_and_slider_are_followed_exactly() {
    // m ẍ = c t − k x from rest, and a mass carried by a slider that speeds up until µN is reached.
    let text = "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
        [integrator]\nmethod = \"event-driven\"\nstep = 0.01\n\
        [[mass]]\nname = \"free\"\nmass = 0.5\nlocked = [\"y\"]\n\
        [[spring]]\nname = \"k\"\nbetween = [\"free\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n\
        [[mass]]\nname = \"carried\"\nmass = 2.0\nforce = [0.0, -100.0]\n\
        [[spring]]\nname = \"hold\"\nbetween = [\"carried\", \"ground\"]\ndirection = \"x\"\nstiffness = 50.0\n\
        [[contact]]\nname = \"c\"\nmass = \"carried\"\n\
        [[signal]]\ninput = \"mass.free.fx\"\nramp = { to = 8.0, end = 4.0 }\n\
        [[signal]]\ninput = \"slider.velocity\"\nramp = { from = -1.0, to = 0.0, end = 0.5 }";
    let mut simulation = Simulation::new(parse("ramps", text).unwrap(), 0.0).unwrap();
    // 2 kg · 2 m/s² + 50 N/m · t² = 50 N.
    let slips = (46.0_f64 / 50.0).sqrt();
    assert!(slips > 0.5, "the ramp is over before");
    for row in 1..=50 {
        let t = 0.01 * f64::from(row);
        simulation.advance_to(t).unwrap();
        let [free, carried] = [simulation.displacement()[0], simulation.displacement()[1]];
        let expected = 2.0 / 200.0 * (t - (20.0 * t).sin() / 20.0);
        assert!((free - expected).abs() < 1e-14, "{free} {expected} at {t} s");
        assert!((carried - t * t).abs() < 1e-14, "{carried} at {t} s");
        let force = simulation.contact_forces().unwrap()[0];
        let inertia = if row < 50 { 4.0 } else { 0.0 };
        assert!(
            (force.friction_force - (inertia + 50.0 * t * t)).abs() < 1e-9,
            "{force:?} at {t} s"
        );
    }
}

/// Stick and slip with 1e5 events in one step of 0.1 s. The error spoke of changes of state at one instant, for which no
/// shorter step helps.
#[test]
fn a_step_with_too_many_events_says_that_a_shorter_step_helps() {
    let text = "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.4, static = 0.6 }\n\
        integrator = { method = \"event-driven\", step = 0.1 }\n\
        [[mass]]\nname = \"block\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
        [[spring]]\nname = \"hold\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e12\n\
        [[contact]]\nname = \"belt\"\nmass = \"block\"\n\
        [[initial]]\nmass = \"block\"\nvx = 0.1";
    let mut scene = parse("belt", text).unwrap();
    let error = Simulation::new(scene.clone(), 0.0).unwrap().advance_to(0.1).unwrap_err();
    assert!(error.is_step() && error.to_string().contains("lower integrator.step"), "{error}");
    scene.step = 1e-3;
    Simulation::new(scene, 0.0).unwrap().advance_to(0.1).unwrap();
}

#[test]
fn numbers_that_leave_their_range_end_the_run_with_the_reason() {
    // A force of 1e308 N on half a kilogram; the series once was shortened without an end.
    let text = "[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
        between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[integrator]\n\
        method = \"event-driven\"\nstep = 1e-3\n[[signal]]\ninput = \"mass.a.fx\"\n\
        constant = { value = 1e308 }";
    let scene = parse("far", text).unwrap();
    let error = Simulation::new(scene, 0.0).unwrap().advance_to(0.1).unwrap_err();
    assert!(
        error.is_step() && error.to_string().contains("range of floating-point numbers"),
        "{error}"
    );
}
