//! The structure of a scene: masses, springs, dampers and contacts with their values.

use super::{Link, LinkKind, MassMark, SliderMark, Structure};
use crate::picture::prefixed;
use crate::scene::{self, Module, Network, Scene};
use std::f64::consts::FRAC_PI_2;

/// Masses, springs, dampers and contacts with their values; springs and dampers of zero left out.
impl From<&Scene> for Structure {
    fn from(scene: &Scene) -> Self {
        let structure = match &scene.structure {
            scene::Structure::Ring(modules) => ring(scene, modules),
            scene::Structure::Network(parts) => network(scene, parts),
        };
        let title = if scene.description.is_empty() { &scene.name } else { &scene.description };
        Self { title: title.clone(), ..structure }
    }
}

/// Of k1 … k6 of a ring.
const DIRECTIONS: [f64; 6] = [0.0, FRAC_PI_2, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0];

/// What the springs join stands with the model, in `model::ring`.
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
            let link = Link {
                name: format!("k{}{own}", j + 1),
                label: prefixed(stiffness, "N/m"),
                ends: [upper, end],
                direction: DIRECTIONS[j],
                kind: LinkKind::Spring,
            };
            // What closes the ring has no say in where its masses stand.
            if j < 2 && number == modules.len() { &mut closing } else { &mut structure.links }
                .push(link);
        }
        structure.sliders.push(SliderMark {
            name: format!("c[{number}]"),
            label: rubbing(scene.friction_coefficient, scene.static_friction, slider.velocity),
            mass: 2 * i + 1,
            on: None,
            angle: slider.angle,
            velocity: slider.velocity,
        });
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
    let link = |kind, name: &String, ends, direction, label| {
        let name = name.clone();
        Link { name, label, ends, direction, kind }
    };
    let springs = parts.springs.iter().filter(|part| part.stiffness != 0.0).map(|part| {
        let label = prefixed(part.stiffness, "N/m");
        link(LinkKind::Spring, &part.name, part.between, part.direction, label)
    });
    let dampers = parts.dampers.iter().filter(|part| part.damping != 0.0).map(|part| {
        let label = prefixed(part.damping, "N s/m");
        link(LinkKind::Damper, &part.name, part.between, part.direction, label)
    });
    let sliders = parts.contacts.iter().map(|place| {
        let velocity = place.velocity.unwrap_or(scene.slider.velocity);
        let friction = place.friction.unwrap_or(scene.friction_coefficient);
        let common = scene.static_friction.filter(|_| place.friction.is_none());
        SliderMark {
            name: place.name.clone(),
            label: rubbing(friction, place.static_friction.or(common), velocity),
            mass: place.mass,
            on: place.on,
            angle: place.angle.unwrap_or(scene.slider.angle),
            velocity,
        }
    });
    let links = springs.chain(dampers).collect();
    let (masses, sliders) = (masses.collect(), sliders.collect());
    Structure { title: String::new(), masses, links, sliders }
}

fn rubbing(friction: f64, static_friction: Option<f64>, velocity: f64) -> String {
    let sticking = static_friction.map_or_else(String::new, |value| format!(" (µs = {value})"));
    format!("µ = {friction}{sticking}, v = {velocity} m/s").replace('-', "−")
}

/// A mass, kg: in g where it is small, in t where it is large.
fn kilograms(mass: f64) -> String {
    match mass {
        0.1..1e3 => prefixed(mass, "kg"),
        1e3.. => prefixed(mass * 1e-3, "t"),
        _ => prefixed(mass * 1e3, "g"),
    }
}
