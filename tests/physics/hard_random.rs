//! Scenes drawn at random, and those that are shipped: the law of contact is judged after every step.
//!
//! Half of the random ones have static friction, up to three times the kinetic one.

use crate::judge::{LetOff, METHODS, Run, off};
use amontons::model::LumpedModel;
use amontons::scene::{
    BUILTIN, ContactDefinition, Damper, Line, Mass, Method, Module, Network, Point, Ramp, Scene,
    Shape, Signal, Spring, Structure, builtin,
};
use amontons::simulation::Simulation;
use amontons::stability::critical_step;
use proptest::prelude::*;
use std::cell::Cell;
use std::sync::Arc;

#[test]
fn every_shipped_scene_obeys_the_law_after_every_step() {
    for builtin in BUILTIN {
        for method in METHODS {
            let mut scene = builtin.scene();
            // Exact motion has no need of small steps.
            let longer = if scene.network().is_none() { off(method, 1.0, 20.0) } else { 1.0 };
            scene.step *= longer;
            let late = 0.6 * scene.experiment.stop_time / scene.step;
            let mut run = Run::new(scene, method);
            // The run is judged at its start and at the time of the behaviour that it is to show.
            run.judged_until(5_000.0 / longer * run.h());
            run.jump(late as u64);
            run.judged_until(run.time() + 15_000.0 / longer * run.h());
        }
    }
}

/// Values over some orders of magnitude, each order as often.
fn wide(from: f64, to: f64) -> impl Strategy<Value = f64> + Clone {
    (from.ln()..to.ln()).prop_map(f64::exp)
}

/// 0, or a value of either sign.
fn signed(from: f64, to: f64) -> impl Strategy<Value = f64> + Clone {
    (-3_i32..=3, wide(from, to)).prop_map(|(sign, value)| f64::from(sign.signum()) * value)
}

fn any_module() -> impl Strategy<Value = Module> {
    (
        prop::array::uniform2(wide(1e-2, 10.0)),
        prop::array::uniform6(wide(1e3, 1e7)),
        wide(1e-4, 1e-2),
        prop::array::uniform4(signed(1e-4, 3.0)),
        wide(1e-6, 1e-3),
        any::<bool>(),
    )
        .prop_map(|(mass, stiffness, preload, velocity, gap, open)| Module {
            mass,
            stiffness,
            preload,
            force: [0.0; 4],
            displacement: [0.0, 0.0, 0.0, if open { gap } else { 0.0 }],
            velocity,
        })
}

/// Outcomes of the random runs of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    runs: u64,
    /// Cases that are none: the load lifts a contact, or there is no critical step.
    impossible: u64,
    /// Friction jams contacts: no forces obey the law.
    wedged: u64,
    judged: LetOff,
}

impl Tally {
    /// Asserts that enough happened in these runs, and that no more was let off than told: contacts on
    /// masses that they share, and steps in which hops were ended, as parts of all that there were.
    #[track_caller]
    fn assert_judged(self, [coupled, ended]: [f64; 2]) {
        println!("{self:?}");
        let LetOff { steps, releases, .. } = self.judged;
        assert!(self.runs >= 300 && releases >= 100, "nothing happened: {self:?}");
        assert!(self.wedged as f64 <= 0.01 * self.runs as f64, "{self:?}");
        let let_off = LetOff { coupled: 0, ended: 0, ..self.judged }.total();
        assert_eq!(let_off, 0, "{self:?}");
        assert!(self.judged.coupled as f64 <= coupled * releases as f64, "{self:?}");
        assert!(self.judged.ended as f64 <= ended * steps as f64, "{self:?}");
    }
}

/// That many cases.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        max_global_rejects: 1_000_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Runs a scene from rest under a slider that starts at once, which needs no equilibrium in sliding, with
/// these integrators, and judges every step.
fn judged_from_rest(
    scene: &Scene,
    part: f64,
    methods: &[Method],
    tally: &Cell<Tally>,
) -> Result<(), TestCaseError> {
    let count = |add: &dyn Fn(&mut Tally)| {
        let mut sum = tally.get();
        add(&mut sum);
        tally.set(sum);
    };
    let reject = |reason: &str| {
        count(&|tally| tally.impossible += 1);
        Err(TestCaseError::reject(reason.to_owned()))
    };
    let model = LumpedModel::from(scene);
    let Ok(critical) = critical_step(&model) else {
        return reject("no critical step");
    };
    'methods: for &method in methods {
        // Exact motion has no need of small steps: the same time in fewer.
        let longer = off(method, 1.0, 10.0);
        let step = part * critical.step * longer;
        let mut scene = Scene { method, step, ..scene.clone() };
        let [from, to, start, end] = [-scene.slider.velocity, 0.0, step, 2.0 * step];
        let input = "slider.velocity".to_owned();
        let shape = Shape::Ramp(Ramp { from, to, start, end });
        scene.signals = Arc::new([Signal { input, shape }]);
        let Ok(simulation) = Simulation::new(scene, 0.0) else {
            return reject("it does not lie on the slider");
        };
        let mut run = Run::of(simulation);
        for _ in 0..(200.0 / longer) as u32 {
            match run.try_jump(1) {
                Err(error) if error.to_string().contains("friction wedges") => {
                    count(&|tally| tally.wedged += 1);
                    run.let_off = LetOff::default();
                    continue 'methods;
                }
                result => result.unwrap(),
            }
            run.judge_step();
            run.judge_report();
        }
        let judged = std::mem::take(&mut run.let_off);
        count(&|tally| {
            tally.runs += 1;
            tally.judged += judged;
        });
    }
    Ok(())
}

/// µ_s over µ: half of the cases have one coefficient.
fn static_part() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(1.0..3.0)
}

#[test]
fn any_ring_obeys_the_law_at_any_friction() {
    let tally = Cell::new(Tally::default());
    proptest!(config(2000), |(
        modules in prop::collection::vec(any_module(), 1..=2),
        mu in 0.0..10.0,
        holds in static_part(),
        velocity in signed(1e-4, 3.0),
        angle in -1.4..1.4,
        (alpha, beta) in (0.0..50.0, signed(1e-7, 1e-3)),
        part in wide(1e-3, 0.95),
    )| {
        let mut scene = builtin("set1").unwrap().scene();
        *scene.modules_mut() = modules;
        (scene.friction_coefficient, scene.static_friction) = (mu, holds.map(|part| part * mu));
        (scene.slider.velocity, scene.slider.angle) = (velocity, angle);
        (scene.damping.alpha, scene.damping.beta) = (alpha, f64::max(beta, 0.0));
        judged_from_rest(&scene, part, &METHODS, &tally)?;
    });
    tally.get().assert_judged([0.0; 2]);
}

// Up to a hundred times heavier than the disc that they share: see the hard cases of contact for more.
#[test]
fn any_pads_on_a_disc_obey_the_law_at_any_friction() {
    let tally = Cell::new(Tally::default());
    proptest!(config(300), |(
        mass in prop::array::uniform3(wide(0.1, 10.0)),
        stiffness in prop::array::uniform6(wide(1e3, 1e7)),
        load in prop::array::uniform2(wide(1.0, 1e3)),
        start in prop::array::uniform4(signed(1e-4, 3.0)),
        oblique in -1.5..1.5,
        mu in 0.0..10.0,
        holds in static_part(),
        velocity in signed(1e-4, 3.0),
        part in wide(1e-3, 0.95),
    )| {
        let mut scene = builtin("disc_brake").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { unreachable!() };
        for (i, spring) in network.springs.iter_mut().enumerate() {
            spring.stiffness = stiffness[i % 6];
            if spring.name.ends_with("strut") {
                spring.direction = Line::Angle(oblique);
            }
        }
        for (i, part) in network.masses.iter_mut().enumerate() {
            part.mass = mass[i];
            if part.name != "disc" {
                part.load[1] = load[i].copysign(part.load[1]);
                part.velocity = [start[2 * i], start[2 * i + 1]];
            }
        }
        network.contacts.iter_mut().for_each(|contact| contact.velocity = None);
        (scene.friction_coefficient, scene.static_friction) = (mu, holds.map(|part| part * mu));
        scene.slider.velocity = velocity;
        judged_from_rest(&scene, part, &METHODS, &tally)?;
    });
    tally.get().assert_judged([0.0; 2]);
}

/// A mass of a network, what holds it and what it rubs on.
#[derive(Clone, Debug)]
struct Part {
    mass: f64,
    /// Against the ground: stiffness and direction of each spring.
    held: [(f64, f64); 2],
    /// Against the mass before.
    linked: (f64, f64),
    damped: f64,
    /// The tangent of its contact, and whether it rubs on the mass before, or on the slider.
    tangent: f64,
    on_mass: bool,
    pressed: f64,
    velocity: [f64; 2],
}

fn any_part() -> impl Strategy<Value = Part> {
    let spring = || (wide(1e3, 1e7), -1.5..1.5);
    (
        (wide(0.1, 10.0), spring(), spring(), spring(), signed(0.1, 100.0)),
        (-1.5..1.5, any::<bool>(), wide(10.0, 1e3), prop::array::uniform2(signed(1e-4, 1.0))),
    )
        .prop_map(|((mass, a, b, linked, damped), (tangent, on_mass, pressed, velocity))| {
            Part {
                mass,
                held: [a, b],
                linked,
                damped: f64::max(damped, 0.0),
                tangent,
                on_mass,
                pressed,
                velocity,
            }
        })
}

/// Two masses or three, now and then four, which have four times as many contact states to look at.
fn any_parts() -> impl Strategy<Value = Vec<Part>> {
    let parts = |count: std::ops::RangeInclusive<usize>| prop::collection::vec(any_part(), count);
    prop_oneof![9 => parts(2..=3), 1 => parts(4..=4)]
}

fn network(parts: &[Part]) -> Network {
    let mut network = Network::default();
    for (i, part) in parts.iter().enumerate() {
        let before = i.checked_sub(1);
        network.masses.push(Mass {
            name: format!("m{i}"),
            mass: part.mass,
            angle: part.tangent,
            locked: [false; 2],
            load: [0.0, -part.pressed],
            force: [0.0; 2],
            displacement: [0.0; 2],
            // Along the tangent, or off: nothing is thrown into what it rests on.
            velocity: [part.velocity[0], part.velocity[1].max(0.0)],
        });
        let held = part.held.iter().map(|&held| (None, held));
        let links = before.map(|before| (Some(before), part.linked));
        for (place, (other, (stiffness, angle))) in held.chain(links).enumerate() {
            network.springs.push(Spring {
                name: format!("s{i}_{place}"),
                between: [Some(i), other].map(|end| end.map(Point::Mass)),
                // Two that are not along one line hold a mass.
                direction: Line::Angle(angle + if place == 1 { 1.6 } else { 0.0 }),
                stiffness,
                preload: None,
            });
        }
        if part.damped > 0.0 {
            network.dampers.push(Damper {
                name: format!("d{i}"),
                between: [Some(i), before].map(|end| end.map(Point::Mass)),
                direction: Line::Angle(part.tangent),
                damping: part.damped,
            });
        }
        network.contacts.push(ContactDefinition {
            name: format!("c{i}"),
            set: None,
            mass: Point::Mass(i),
            on: before.filter(|_| part.on_mass).map(Point::Mass),
            angle: Some(part.tangent),
            axes: None,
            gap: 0.0,
            velocity: None,
            friction: None,
            static_friction: None,
            is_shown: true,
        });
    }
    network
}

fn rubbing(parts: &[Part], mu: f64, holds: Option<f64>, velocity: f64) -> Scene {
    let mut scene = builtin("disc_brake").unwrap().scene();
    scene.structure = Structure::Network(network(parts));
    (scene.friction_coefficient, scene.static_friction) = (mu, holds.map(|part| part * mu));
    scene.slider.velocity = velocity;
    scene.damping.beta = 0.0;
    scene
}

#[test]
fn any_network_of_masses_on_a_slider_obeys_the_law() {
    let tally = Cell::new(Tally::default());
    proptest!(config(300), |(
        parts in any_parts(),
        mu in 0.0..3.0,
        holds in static_part(),
        velocity in signed(1e-4, 3.0),
        part in wide(1e-3, 0.95),
    )| {
        let on_slider = |part| Part { on_mass: false, ..part };
        let parts: Vec<Part> = parts.into_iter().map(on_slider).collect();
        judged_from_rest(&rubbing(&parts, mu, holds, velocity), part, &METHODS, &tally)?;
    });
    tally.get().assert_judged([0.0; 2]);
}

#[test]
fn any_network_of_masses_that_rub_on_each_other_obeys_the_law() {
    let tally = Cell::new(Tally::default());
    proptest!(config(300), |(
        parts in any_parts(),
        mu in 0.0..0.9,
        holds in static_part(),
        velocity in signed(1e-4, 3.0),
        part in wide(1e-3, 0.95),
    )| {
        judged_from_rest(&rubbing(&parts, mu, holds, velocity), part, &METHODS, &tally)?;
    });
    // Masses that throw each other off come to rest in ever shorter bounces.
    tally.get().assert_judged([0.02, 2e-4]);
}
