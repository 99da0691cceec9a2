//! Contacts with gaps: what falls through them, stops at them, and closes what a load has opened.

use amontons::contact::ContactState::{Detached, Slide};
use amontons::integrator::Method;
use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::Simulation;

const METHODS: [Method; 2] = [Method::EventDriven, Method::ForwardIncrement];
const OMEGA: f64 = 10.0;
const GAP: f64 = 0.01;
const FRICTION: f64 = 0.5;

/// A mass of 1 kg on springs of 100 N/m along and across a slider that is turned by `angle`, above it by [`GAP`], with a
/// velocity of 1 m/s into it. `axes` is the angle of the mass's own axes.
fn falling(angle: f64, axes: f64, method: Method) -> Scene {
    let way = -std::f64::consts::FRAC_PI_2 + angle - axes;
    let (vx, vy) = (way.cos(), way.sin());
    let text = format!(
        "[slider]\nvelocity = 2.0\nangle = {angle:?}\n[friction]\ncoefficient = {FRICTION:?}\n\
         [integrator]\nstep = 1e-6\n\
         [[mass]]\nname = \"m\"\nmass = 1.0\nangle = {axes:?}\n\
         [[spring]]\nname = \"x\"\nbetween = [\"m\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
         [[spring]]\nname = \"y\"\nbetween = [\"m\", \"ground\"]\ndirection = \"y\"\nstiffness = 100.0\n\
         [[contact]]\nname = \"stop\"\nmass = \"m\"\ngap = {GAP:?}\n\
         [[initial]]\nmass = \"m\"\nvx = {vx:?}\nvy = {vy:?}\n"
    );
    let mut scene = parse("falling", &text).unwrap();
    scene.effects.energy = true;
    scene.method = method;
    scene
}

/// y = −v/ω sin ω t until the gap is gone; the impact then stops y and gives x the velocity µ v_n. The spring lifts the
/// mass off again: y = −g cos ω t and x = µ v_n/ω sin ω t.
#[test]
fn a_mass_that_falls_through_a_gap_lands_and_lifts_off() {
    let lands = (OMEGA * GAP).asin() / OMEGA;
    let speed = (1.0 - (OMEGA * GAP).powi(2)).sqrt();
    for method in METHODS {
        // Time steps of h miss the landing by up to h.
        let near = if method == Method::EventDriven { 1e-12 } else { 2e-6 };
        for (angle, axes) in [(0.0, 0.0), (0.3, 0.3), (0.3, 0.0), (-0.7, 0.2)] {
            let mut simulation = Simulation::new(falling(angle, axes, method), 0.0).unwrap();
            assert_eq!(simulation.reference().gap, [GAP]);
            assert_eq!(simulation.contact_states(), [Detached]);
            let place = |simulation: &Simulation| {
                let turn = axes - angle;
                let [x, y] = simulation.displacement() else { panic!() };
                [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()]
            };
            simulation.advance_to(0.9 * lands).unwrap();
            let [x, y] = place(&simulation);
            let falls = -(0.9 * OMEGA * lands).sin() / OMEGA;
            assert!(x.abs() < near && (y - falls).abs() < near, "{x} {y} {falls}");
            for turn in [0.5_f64, 2.0, 4.0] {
                simulation.advance_to(lands + turn / OMEGA).unwrap();
                let [x, y] = place(&simulation);
                let [along, across] = [FRICTION * speed / OMEGA * turn.sin(), -GAP * turn.cos()];
                assert!(
                    (x - along).abs() < near && (y - across).abs() < near,
                    "{method:?} {angle}"
                );
            }
            assert_eq!(simulation.statistics().touch_downs, 1);
            let energy = simulation.energy().unwrap();
            // The slider at 2 m/s works, friction and the impact take.
            let taken = 0.5 * speed * speed;
            assert!((energy.impact - taken).abs() < 1e-3 * taken, "{energy:?}");
            assert!(energy.residual.abs() < 1e-4, "{energy:?}");
        }
    }
}

/// Two masses in a row along a slope, with a stop between them and one on the slider.
fn stops(method: Method) -> Scene {
    let text = "[slider]\nvelocity = 0.3\nangle = 0.1\n[friction]\ncoefficient = 0.4\n[integrator]\nstep = 2e-7\n\
         [[mass]]\nname = \"pad\"\nmass = 0.8\nforce = [0.0, -5.0]\n\
         [[mass]]\nname = \"shim\"\nmass = 0.3\n\
         [[spring]]\nname = \"px\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"x\"\nstiffness = 900.0\n\
         [[spring]]\nname = \"py\"\nbetween = [\"pad\", \"ground\"]\ndirection = \"y\"\nstiffness = 300.0\n\
         [[spring]]\nname = \"sx\"\nbetween = [\"shim\", \"pad\"]\ndirection = 0.4\nstiffness = 500.0\n\
         [[spring]]\nname = \"sy\"\nbetween = [\"shim\", \"ground\"]\ndirection = \"y\"\nstiffness = 200.0\n\
         [[spring]]\nname = \"sz\"\nbetween = [\"shim\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
         [[contact]]\nname = \"disc\"\nmass = \"pad\"\ngap = 1e-3\n\
         [[contact]]\nname = \"stop\"\nmass = \"shim\"\non = \"pad\"\nangle = 0.2\nvelocity = 0.05\ngap = 2e-2\n\
         [[initial]]\nmass = \"shim\"\nvx = 0.3\nvy = -1.0\n";
    let mut scene = parse("stops", text).unwrap();
    scene.effects.energy = true;
    scene.method = method;
    scene
}

#[test]
fn both_methods_agree_on_masses_that_meet_across_gaps() {
    let mut runs = METHODS.map(|method| Simulation::new(stops(method), 0.0).unwrap());
    let start = runs[0].reference().clone();
    assert!(start.gap[0] == 0.0 && start.normal_force[0] > 1.0, "{start:?}");
    assert!(start.gap[1] > 1e-3 && start.normal_force[1] == 0.0, "{start:?}");
    for time in [0.02, 0.06, 0.1] {
        runs.iter_mut().for_each(|run| run.advance_to(time).unwrap());
        let [exact, stepped] = &runs;
        for (a, b) in exact.displacement().iter().zip(stepped.displacement()) {
            assert!((a - b).abs() < 2e-6, "{time}: {a} {b}");
        }
    }
    assert!(runs[0].statistics().touch_downs > 0);
    assert!(runs[0].energy().unwrap().residual.abs() < 1e-12);
    assert!(runs[1].energy().unwrap().residual.abs() < 1e-4);
}

#[test]
fn a_run_with_gaps_may_be_split_and_saved() {
    for method in METHODS {
        let mut whole = Simulation::new(stops(method), 0.0).unwrap();
        whole.advance_to(0.06).unwrap();
        let mut parts = Simulation::new(stops(method), 0.0).unwrap();
        parts.advance_to(0.01).unwrap();
        let mut parts = Simulation::resume(parts.save()).unwrap();
        for time in [0.02, 0.05, 0.06] {
            parts.advance_to(time).unwrap();
        }
        assert_eq!(whole.save(), parts.save());
        let back = whole.save();
        let mut other = Simulation::new(stops(method), 0.0).unwrap();
        other.restore(&back).unwrap();
        assert_eq!(other.save(), back);
    }
}

#[test]
fn a_contact_that_the_load_opens_closes_in_motion() {
    let scene = |method| {
        let mut scene = builtin("set1").unwrap().scene();
        scene.friction_coefficient = 0.3;
        scene.modules_mut()[1].preload = -2e-3;
        scene.modules_mut()[1].velocity = [0.0, -2.0, 0.0, -2.0];
        scene.method = method;
        scene.step = 1e-7;
        scene
    };
    let mut runs = METHODS.map(|method| Simulation::new(scene(method), 0.0).unwrap());
    assert_eq!(runs[0].contact_states(), [Slide, Detached]);
    let gap = runs[0].reference().gap[1];
    for run in &mut runs {
        assert!(gap > 1e-5 && run.reference().gap[1] == gap);
        run.advance_to(0.004).unwrap();
        assert!(run.statistics().touch_downs > 0, "{:?}", run.statistics());
        assert!(run.displacement()[7] >= -gap * (1.0 + 1e-12));
    }
    for (a, b) in runs[0].displacement().iter().zip(runs[1].displacement()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn a_mass_does_not_start_inside_its_surface() {
    let start = |y: f64| {
        let mut scene = falling(0.0, 0.0, Method::EventDriven);
        let amontons::scene::Structure::Network(network) = &mut scene.structure else { panic!() };
        network.masses[0].displacement = [0.0, y];
        Simulation::new(scene, 0.0)
    };
    assert!(start(-GAP).is_ok() && start(-0.5 * GAP).is_ok());
    let message = start(-1.5 * GAP).err().unwrap().to_string();
    assert!(message.contains("contact.stop starts inside its surface"), "{message}");
    assert!(
        message.contains("a gap of 0.01 m, and the initial displacement adds -0.015 m"),
        "{message}"
    );
}
