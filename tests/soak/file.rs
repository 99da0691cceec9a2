//! A scene as the text of a scene file.

use amontons::scene::{
    Between, Line, Network, Point, Pulse, Ramp, Role, Scene, Shape, Signal, Sine, Structure, Table,
};
use std::fmt::Write;

/// The file, with one value a line. A network's external forces have no keys; they are zero here.
pub fn text(scene: &Scene) -> String {
    let mut lines = Vec::new();
    let mut line = |text: String| lines.push(text);
    line(format!("description = {:?}", scene.description));
    line("[slider]".to_owned());
    line(number("velocity", scene.slider.velocity));
    line(number("angle", scene.slider.angle));
    friction(scene).into_iter().for_each(&mut line);
    effects(scene).into_iter().for_each(&mut line);
    if scene.roles.preload == Role::Input {
        line("[inputs]\npreload = \"input\"".to_owned());
    }
    match &scene.structure {
        Structure::Ring(_) => ring(scene).into_iter().for_each(&mut line),
        Structure::Network(parts) => network(parts).into_iter().for_each(&mut line),
    }
    scene.signals.iter().map(signal).for_each(&mut line);
    line("[integrator]".to_owned());
    line(format!("method = \"{}\"", scene.method));
    line(number("step", scene.step));
    line("[experiment]".to_owned());
    line(number("stop_time", scene.experiment.stop_time));
    line(number("output_interval", scene.experiment.output_interval));
    lines.join("\n") + "\n"
}

fn number(key: &str, value: f64) -> String {
    format!("{key} = {value:?}")
}

fn some(key: &str, value: Option<f64>) -> Option<String> {
    value.map(|value| number(key, value))
}

fn friction(scene: &Scene) -> Vec<String> {
    let about = scene.friction_law.info();
    let keys = [
        ("coefficient", Some(scene.friction_coefficient)),
        ("static", scene.static_friction),
        ("stribeck_velocity", scene.stribeck_velocity),
    ];
    let needed = keys.into_iter().filter(|(key, _)| about.keys.contains(key));
    let mut lines = vec!["[friction]".to_owned(), format!("law = {:?}", about.name)];
    lines.extend(needed.filter_map(|(key, value)| some(key, value)));
    lines
}

fn effects(scene: &Scene) -> Vec<String> {
    let effects = &scene.effects;
    let alpha = effects.mass_damping.then_some(scene.damping.alpha);
    let beta = effects.stiffness_damping.then_some(scene.damping.beta);
    let mut lines = vec!["[damping]".to_owned()];
    lines.extend(some("alpha", alpha).into_iter().chain(some("beta", beta)));
    lines.push(format!("[effects]\nenergy = {}", effects.energy));
    // Effects that are on need no switch, and a scene without friction or contacts would be refused with one.
    lines.extend((!effects.sticking).then(|| "sticking = false".to_owned()));
    lines.extend((!effects.detachment).then(|| "detachment = false".to_owned()));
    lines
}

fn ring(scene: &Scene) -> Vec<String> {
    let modules = scene.modules();
    let mut lines = vec!["[ring]".to_owned(), format!("modules = {}", modules.len())];
    let mut list = |key: &str, values: Vec<f64>| lines.push(format!("{key} = {values:?}"));
    for (place, key) in ["m1", "m2"].into_iter().enumerate() {
        list(key, modules.iter().map(|module| module.mass[place]).collect());
    }
    let keys = ["k1", "k2", "k3", "k4", "k5", "k6"].into_iter().enumerate();
    for (place, key) in keys.skip(if scene.effects.links { 0 } else { 2 }) {
        list(key, modules.iter().map(|module| module.stiffness[place]).collect());
    }
    if scene.effects.preload {
        list("preload", modules.iter().map(|module| module.preload).collect());
    }
    for (i, module) in modules.iter().enumerate() {
        let places = 1..=4;
        let moved = places.clone().zip(module.displacement).map(|(j, x)| (format!("x{j}"), x));
        let pushed = places.zip(module.velocity).map(|(j, v)| (format!("v{j}"), v));
        let values = moved.chain(pushed);
        lines.extend(initial(&format!("module = {}", i + 1), values));
    }
    lines
}

/// `[[initial]]`, where some value is not zero.
fn initial(owner: &str, values: impl Iterator<Item = (String, f64)>) -> Option<String> {
    let mut text = format!("[[initial]]\n{owner}");
    let mut is_there = false;
    for (key, value) in values.filter(|(_, value)| *value != 0.0) {
        is_there = true;
        write!(text, "\n{}", number(&key, value)).expect("a string takes all");
    }
    is_there.then_some(text)
}

/// The angle of a direction, all of which have one here.
fn angle(line: Line) -> f64 {
    line.angle().expect("directions are angles here")
}

fn network(network: &Network) -> Vec<String> {
    let name = |point: Point| network.point_name(point);
    let ends = |ends: [Option<Point>; 2]| {
        let [a, b] = ends.map(|end| end.map_or("ground".to_owned(), name));
        format!("between = [{a:?}, {b:?}]")
    };
    let mut lines = Vec::new();
    for mass in &network.masses {
        lines.push(format!("[[mass]]\nname = {:?}", mass.name));
        lines.push(number("mass", mass.mass));
        lines.push(number("angle", mass.angle));
        let axes = ["x", "y"].into_iter().zip(mass.locked);
        let locked: Vec<&str> = axes.filter_map(|(axis, is)| is.then_some(axis)).collect();
        lines.push(format!("locked = {locked:?}"));
        lines.push(format!("force = {:?}", mass.load));
    }
    for spring in &network.springs {
        lines.push(format!("[[spring]]\nname = {:?}", spring.name));
        lines.push(ends(spring.between));
        lines.push(number("direction", angle(spring.direction)));
        lines.push(number("stiffness", spring.stiffness));
        lines.extend(some("preload", spring.preload));
    }
    for damper in &network.dampers {
        lines.push(format!("[[damper]]\nname = {:?}", damper.name));
        lines.push(ends(damper.between));
        lines.push(number("direction", angle(damper.direction)));
        lines.push(number("damping", damper.damping));
    }
    for place in &network.contacts {
        lines.push(format!("[[contact]]\nname = {:?}\nmass = {:?}", place.name, name(place.mass)));
        lines.extend(place.on.map(|on| format!("on = {:?}", name(on))));
        lines.extend(some("angle", place.angle));
        lines.extend(some("velocity", place.velocity));
        lines.extend(some("friction", place.friction));
        lines.extend(some("static_friction", place.static_friction));
    }
    for mass in &network.masses {
        let [x, y] = mass.displacement;
        let [vx, vy] = mass.velocity;
        let values = [("x", x), ("y", y), ("vx", vx), ("vy", vy)].into_iter();
        let values = values.map(|(key, value)| (key.to_owned(), value));
        lines.extend(initial(&format!("mass = {:?}", mass.name), values));
    }
    lines
}

fn signal(signal: &Signal) -> String {
    let (shape, values) = match &signal.shape {
        Shape::Constant(constant) => ("constant", vec![number("value", constant.value)]),
        Shape::Ramp(Ramp { from, to, start, end }) => {
            let values = [("from", from), ("to", to), ("start", start), ("end", end)];
            ("ramp", values.map(|(key, value)| number(key, *value)).to_vec())
        }
        Shape::Pulse(Pulse { value, start, end }) => {
            let mut values = vec![number("value", *value), number("start", *start)];
            values.extend(some("end", *end));
            ("pulse", values)
        }
        Shape::Sine(Sine { amplitude, frequency, phase, start, end }) => {
            let values = [
                ("amplitude", amplitude),
                ("frequency", frequency),
                ("phase", phase),
                ("start", start),
            ];
            let mut values = values.map(|(key, value)| number(key, *value)).to_vec();
            values.extend(some("end", *end));
            ("sine", values)
        }
        Shape::Table(Table { points, between }) => {
            let between = if *between == Between::Linear { "linear" } else { "constant" };
            ("table", vec![format!("points = {points:?}"), format!("between = {between:?}")])
        }
    };
    format!("[[signal]]\ninput = {:?}\n{shape} = {{ {} }}", signal.input, values.join(", "))
}
