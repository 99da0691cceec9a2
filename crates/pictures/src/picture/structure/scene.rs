//! The structure of a scene: masses, springs, dampers and contacts with their values.

use super::{ForceMark, Link, LinkKind, MassMark, SliderMark, Structure};
use crate::picture::prefixed;
use amontons::decimal::to_significant;
use amontons::scene::{self, ContactDefinition, Line, Module, Network, Point, Scene, Shape};
use std::f64::consts::FRAC_PI_2;

/// Masses, springs, dampers, contacts and forces with their values, and what signals drive; springs, dampers and forces
/// of zero are left out.
impl From<&Scene> for Structure {
    fn from(scene: &Scene) -> Self {
        let structure = match &scene.structure {
            scene::Structure::Ring(modules) => ring(scene, modules),
            scene::Structure::Network(parts) => network(scene, parts),
        };
        let title = if scene.description.is_empty() { &scene.name } else { &scene.description };
        Self { title: title.clone(), signals: !scene.signals.is_empty(), ..structure }
    }
}

/// Directions of k1 … k6 of a ring, rad.
const DIRECTIONS: [f64; 6] = [0.0, FRAC_PI_2, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0];

/// `assembly::ring` of the package `amontons` says which masses each spring joins.
fn ring(scene: &Scene, modules: &[Module]) -> Structure {
    let (mut structure, mut closing) = (Structure::default(), Vec::new());
    let slider = &scene.slider;
    // Links of one name and value need not all be named in a crowded picture.
    let agree = |j: usize| modules.windows(2).all(|two| two[0].stiffness[j] == two[1].stiffness[j]);
    let agree = [0, 1, 2, 3, 4, 5].map(agree);
    for (i, module) in modules.iter().enumerate() {
        let number = i + 1;
        for (j, angle) in [0.0, slider.angle].into_iter().enumerate() {
            let (name, label) = (format!("m{}[{number}]", j + 1), kilograms(module.mass[j]));
            structure.masses.push(MassMark { name, label, angle, locked: [false; 2] });
        }
        let (upper, lower) = (Some(2 * i), Some(2 * i + 1));
        let next = Some(2 * (number % modules.len()));
        for (j, end) in [next, next, None, None, lower, lower].into_iter().enumerate() {
            let stiffness = module.stiffness[j];
            if end == upper || stiffness == 0.0 {
                continue;
            }
            let own = if agree[j] { String::new() } else { format!("[{number}]") };
            let (preload, label) = match j {
                2 => preloaded(
                    scene,
                    stiffness,
                    -module.preload,
                    &format!("module[{number}].preload"),
                ),
                _ => (0.0, prefixed(stiffness, "N/m")),
            };
            let link = Link {
                name: format!("k{}{own}", j + 1),
                label,
                preload,
                ends: [upper, end],
                direction: DIRECTIONS[j],
                kind: LinkKind::Spring,
            };
            // Springs that close the ring do not determine where its masses stand.
            if j < 2 && number == modules.len() { &mut closing } else { &mut structure.links }
                .push(link);
        }
        structure.sliders.push(SliderMark {
            name: format!("c[{number}]"),
            label: rubbing(
                scene,
                (scene.friction_coefficient, "friction.coefficient"),
                scene.static_friction.map(|value| (value, "friction.static")),
                (slider.velocity, "slider.velocity"),
            ),
            mass: 2 * i + 1,
            on: None,
            angle: slider.angle,
            velocity: slider.velocity,
        });
        for mass in [0, 1] {
            let axis = [0.0, slider.angle][mass];
            let of = |j: usize| {
                (module.force[2 * mass + j], format!("module[{number}].f{}", 2 * mass + j + 1))
            };
            let name = format!("F{}[{number}]", mass + 1);
            structure.forces.extend(forces(scene, 2 * i + mass, &name, axis, [of(0), of(1)]));
        }
    }
    structure.links.append(&mut closing);
    structure
}

fn network(scene: &Scene, parts: &Network) -> Structure {
    let masses = parts.masses.iter().map(|mass| MassMark {
        name: mass.name.clone(),
        label: kilograms(mass.mass),
        angle: mass.angle,
        locked: mass.locked,
    });
    let superelements = parts.superelements.iter().map(|one| MassMark {
        name: one.name.clone(),
        label: format!("{} degrees of freedom", one.matrices.dofs()),
        angle: 0.0,
        locked: [false; 2],
    });
    let masses = masses.chain(superelements);
    // A superelement is drawn as one mass.
    let mark = |point| match point {
        Point::Mass(mass) => mass,
        Point::Node(at) => parts.masses.len() + at.superelement,
    };
    let joined = |between: [Option<Point>; 2]| {
        let ends = between.map(|end| end.map(mark));
        (ends[0] != ends[1]).then_some(ends)
    };
    let link = |kind, name: &String, ends, direction, (preload, label)| {
        let name = name.clone();
        Link { name, label, ends, direction, kind, preload }
    };
    let springs = parts.springs.iter().filter(|part| part.stiffness != 0.0).filter_map(|part| {
        let ends = joined(part.between)?;
        let driven = format!("spring.{}.preload", part.name);
        let values = preloaded(scene, part.stiffness, part.preload.unwrap_or(0.0), &driven);
        Some(link(LinkKind::Spring, &part.name, ends, part.direction.angle_in_plane(), values))
    });
    let dampers = parts.dampers.iter().filter(|part| part.damping != 0.0).filter_map(|part| {
        let ends = joined(part.between)?;
        let label = prefixed(part.damping, "N s/m");
        let angle = part.direction.angle_in_plane();
        Some(link(LinkKind::Damper, &part.name, ends, angle, (0.0, label)))
    });
    // Of the contacts of a set the first one is drawn, and none within a superelement.
    let is_first = |(i, place): &(usize, &ContactDefinition)| {
        place.set.is_none() || !parts.contacts[..*i].iter().any(|other| other.set == place.set)
    };
    let drawn = parts.contacts.iter().enumerate().filter(is_first).map(|(_, place)| place);
    let drawn = drawn.filter(|place| Some(mark(place.mass)) != place.on.map(mark));
    let sliders = drawn.map(|place| {
        // Its own value, or the common one, each with the name of what drives it.
        let own = |key: &str| format!("contact.{}.{key}", place.name);
        let (friction, driver) = match place.friction {
            Some(value) => (value, own("friction")),
            None => (scene.friction_coefficient, "friction.coefficient".into()),
        };
        let (velocity, motion) = match place.velocity {
            Some(value) => (value, own("velocity")),
            None => (scene.slider.velocity, "slider.velocity".into()),
        };
        let common = scene.static_friction.filter(|_| place.friction.is_none());
        let sticking = place.static_friction.map(|value| (value, own("static_friction")));
        let sticking = sticking.or(common.map(|value| (value, "friction.static".into())));
        let sticking = sticking.as_ref().map(|(value, driver)| (*value, &**driver));
        SliderMark {
            name: match place.set {
                Some(set) => parts.contact_sets[set].clone(),
                None => place.name.clone(),
            },
            label: rubbing(scene, (friction, &driver), sticking, (velocity, &motion)),
            mass: mark(place.mass),
            on: place.on.map(mark),
            angle: match place.axes {
                Some([_, tangent]) => Line::Vector(tangent).angle_in_plane(),
                None => place.angle.unwrap_or(scene.slider.angle),
            },
            velocity,
        }
    });
    let links = springs.chain(dampers).collect();
    let (masses, sliders) = (masses.collect(), sliders.collect());
    let pushed = parts.masses.iter().enumerate().flat_map(|(place, mass)| {
        let of = |axis: usize| {
            let value = if mass.locked[axis] { 0.0 } else { mass.load[axis] + mass.force[axis] };
            (value, format!("mass.{}.f{}", mass.name, ["x", "y"][axis]))
        };
        forces(scene, place, &format!("F {}", mass.name), mass.angle, [of(0), of(1)])
    });
    let forces = pushed.collect();
    Structure { masses, links, sliders, forces, ..Structure::default() }
}

/// Label of a contact: µ, µ_s if there is one, and v, each with the name of the input that drives it.
fn rubbing(
    scene: &Scene,
    friction: (f64, &str),
    static_friction: Option<(f64, &str)>,
    velocity: (f64, &str),
) -> String {
    let friction = marked(format!("µ = {}", friction.0), scene, friction.1);
    let sticking = static_friction.map_or_else(String::new, |(value, input)| {
        format!(" ({})", marked(format!("µs = {value}"), scene, input))
    });
    let velocity = marked(format!("v = {} m/s", velocity.0), scene, velocity.1);
    format!("{friction}{sticking}, {velocity}").replace('-', "−")
}

/// A text with the mark of the signals that drive what it speaks of, as "v = 0 m/s ~ ramp".
fn marked(text: String, scene: &Scene, input: &str) -> String {
    let driving = scene.signals.iter().filter(|signal| signal.input == input);
    driving.fold(text, |text, signal| format!("{text} ~ {}", kind(&signal.shape)))
}

fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Constant(_) => "constant",
        Shape::Ramp(_) => "ramp",
        Shape::Pulse(_) => "pulse",
        Shape::Sine(_) => "sine",
        Shape::Table(_) => "table",
    }
}

/// The preload of a spring, m, as a [`Link`] has it, and the spring's label.
fn preloaded(scene: &Scene, stiffness: f64, preload: f64, driven: &str) -> (f64, String) {
    let stiffness = prefixed(stiffness, "N/m");
    let is_driven = scene.signals.iter().any(|signal| signal.input == driven);
    if preload == 0.0 && !is_driven {
        return (0.0, stiffness);
    }
    let value = marked(format!("preload {}", prefixed(preload.abs(), "m")), scene, driven);
    (preload, format!("{stiffness}, {value}"))
}

/// The arrows at a mass: one for its constant force, and one along each axis that signals drive. `angle` is that of the
/// mass's first axis; of each axis there are the constant force, N, and the name of the input.
fn forces(
    scene: &Scene,
    mass: usize,
    name: &str,
    angle: f64,
    axes: [(f64, String); 2],
) -> Vec<ForceMark> {
    let [x, y] = [axes[0].0, axes[1].0];
    let mut found = Vec::new();
    if x != 0.0 || y != 0.0 {
        let (size, way) = (to_significant((x * x + y * y).sqrt(), 4), libm::atan2(y, x));
        let name = name.to_owned();
        found.push(ForceMark { name, label: prefixed(size, "N"), mass, angle: angle + way });
    }
    for ((_, input), turn) in axes.into_iter().zip([0.0, FRAC_PI_2]) {
        let label = marked(String::new(), scene, &input);
        if !label.is_empty() {
            let label = label.trim_start().to_owned();
            found.push(ForceMark { name: input, label, mass, angle: angle + turn });
        }
    }
    found
}

/// A mass, kg: in g where it is small, in t where it is large.
fn kilograms(mass: f64) -> String {
    match mass {
        0.1..1e3 => prefixed(mass, "kg"),
        1e3.. => prefixed(mass * 1e-3, "t"),
        _ => prefixed(mass * 1e3, "g"),
    }
}
