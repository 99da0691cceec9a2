//! Random signals.

use crate::judge::assign;
use crate::random::Random;
use amontons::scene::{
    Between, Constant, ContactDefinition, Pulse, Ramp, Role, Scene, Shape, Signal, Sine, Structure,
    Table,
};
use amontons::simulation::Parameters;
use std::f64::consts::TAU;

/// The most that a signal makes of a friction coefficient.
pub const FRICTION_RISES: f64 = 1.5;

/// The scene with what its signals add at the start.
pub fn at_start(scene: &Scene) -> Scene {
    let mut acting = scene.clone();
    for signal in scene.signals.iter() {
        let sum = given(scene, &signal.input) + signal.shape.at(0.0, 0.0);
        assign(&mut acting, &signal.input, sum);
    }
    acting
}

/// The value of an input without signals.
fn given(scene: &Scene, input: &str) -> f64 {
    let parameters = Parameters::of(scene.clone());
    let mut values = parameters.iter();
    values.find(|(variable, _)| variable.name == input).expect("an input").1
}

/// Surfaces that are at rest first, and have their velocities later.
pub fn hold_surfaces(random: &mut Random, scene: &mut Scene) {
    let fastest = crate::case::fastest(scene);
    let common = scene.slider.velocity;
    let own = scene.network().map_or(&[][..], |network| &network.contacts);
    let own = own
        .iter()
        .filter_map(|place| Some((format!("contact.{}.velocity", place.name), place.velocity?)));
    let all = scene.has_common_velocity().then(|| ("slider.velocity".to_owned(), common));
    let all: Vec<(String, f64)> = all.into_iter().chain(own).collect();
    let start = random.between(0.0, 5.0) / fastest;
    let jumps = random.chance(0.3);
    let end = start + random.wide(0.1, 30.0) / fastest;
    let signal = |(input, velocity): (String, f64)| {
        let shape = if jumps {
            Shape::Pulse(Pulse { value: -velocity, start: 0.0, end: Some(end) })
        } else {
            Shape::Ramp(Ramp { from: -velocity, to: 0.0, start, end })
        };
        Signal { input, shape }
    };
    scene.signals = all.into_iter().map(signal).collect();
}

/// The scene's signals and up to four more, of a run of this length (s), where 1/`fastest` (s) is the shortest
/// time of the masses.
pub fn added(random: &mut Random, scene: &Scene, length: f64, fastest: f64) -> Vec<Signal> {
    let mut signals = scene.signals.to_vec();
    if random.chance(0.4) {
        return signals;
    }
    let inputs: Vec<String> = scene.input_names();
    let count = random.whole(1, 4);
    for _ in 0..count {
        let input = inputs[random.whole(0, inputs.len() - 1)].clone();
        if signals.iter().all(|signal| signal.input != input) {
            let size = size(random, scene, &input);
            signals.push(Signal { input, shape: shape(random, size, length, fastest) });
        }
    }
    signals
}

/// Makes preloads inputs in some scenes, so that signals can drive them.
pub fn set_roles(random: &mut Random, scene: &mut Scene) {
    if random.chance(0.2) {
        scene.roles.preload = Role::Input;
    }
}

/// The most that a signal adds to an input, up or down.
fn size(random: &mut Random, scene: &Scene, input: &str) -> f64 {
    let value = given(scene, input);
    let last = input.rsplit('.').next().unwrap_or_default();
    match last {
        "velocity" => value.abs().max(1e-3) * random.wide(0.01, 3.0),
        "coefficient" | "friction" => {
            let most = (FRICTION_RISES - 1.0) * value;
            most.min(0.49 * room(scene, input)) * random.unit()
        }
        "static" | "static_friction" => 0.49 * room(scene, input) * random.unit(),
        "preload" => value.abs() * random.unit(),
        _ => load(scene) * random.wide(1e-3, 1.0),
    }
}

/// Difference between static and kinetic friction of the contacts to which an input of friction belongs.
fn room(scene: &Scene, input: &str) -> f64 {
    let common = scene.friction_coefficient;
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    let named = |place: &&ContactDefinition| input.starts_with(&format!("contact.{}.", place.name));
    let room = match contacts.iter().find(named) {
        Some(place) => {
            let kinetic = place.friction.unwrap_or(common);
            place.static_friction.map(|static_friction| static_friction - kinetic)
        }
        None if input == "friction.static" => scene.static_friction.map(|most| most - common),
        None => scene.greatest_friction().map(|most| most - common),
    };
    room.unwrap_or(f64::INFINITY).max(0.0)
}

/// The largest load, N.
fn load(scene: &Scene) -> f64 {
    match &scene.structure {
        Structure::Ring(modules) => {
            let forces = modules.iter().map(|module| module.stiffness[2] * module.preload);
            forces.fold(0.0, f64::max)
        }
        Structure::Network(network) => {
            let loads = network.masses.iter().flat_map(|mass| mass.load);
            loads.fold(0.0, |most, load| most.max(load.abs()))
        }
    }
}

fn shape(random: &mut Random, size: f64, length: f64, fastest: f64) -> Shape {
    let value = size * random.between(-1.0, 1.0);
    let start = if random.chance(0.2) { 0.0 } else { length * random.between(0.0, 0.9) };
    let end = start + length * random.wide(1e-3, 1.0);
    match random.whole(0, 4) {
        0 => Shape::Constant(Constant { value }),
        1 => Shape::Ramp(Ramp { from: size * random.between(-1.0, 1.0), to: value, start, end }),
        2 => Shape::Pulse(Pulse { value, start, end: random.sometimes(0.7, |_| end) }),
        3 => Shape::Sine(Sine {
            amplitude: value,
            frequency: random.wide(0.1 / length, (1.0 / length).max(2.0 * fastest / TAU)),
            phase: random.sometimes(0.5, |random| random.between(0.0, TAU)).unwrap_or(0.0),
            start,
            end: random.sometimes(0.5, |_| end),
        }),
        _ => Shape::Table(table(random, size, length)),
    }
}

fn table(random: &mut Random, size: f64, length: f64) -> Table {
    let mut time = 0.0;
    let count = random.whole(2, 6);
    let points = (0..count).map(|_| {
        // Two points at one time are a jump.
        if random.chance(0.8) {
            time += length * random.wide(1e-2, 0.5);
        }
        [time, size * random.between(-1.0, 1.0)]
    });
    let points = points.collect();
    let between = if random.chance(0.5) { Between::Linear } else { Between::Constant };
    Table { points, between }
}
