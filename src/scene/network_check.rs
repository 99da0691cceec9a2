//! Which networks are possible.

use super::rule::{Problems, Rule};
use super::{GROUND, MAX_MASSES, Mass, Network, RubbingPlace, Slider, direction};
use std::collections::HashSet;

/// A direction whose part along the free axes is smaller than this has none.
const NO_PART: f64 = 1e-9;
/// What rounding may leave of a gap that is zero, in parts of the displacements.
const ROUNDING: f64 = 1e-12;

/// Names the impossible values of a network.
pub(super) fn check(network: &Network, slider: Slider, problems: &mut Problems) {
    let Network { masses, springs, dampers, contacts } = network;
    let most = [masses.len(), springs.len(), dampers.len(), contacts.len()].into_iter().max();
    if most > Some(MAX_MASSES) {
        problems
            .add(format!("a network has at most {MAX_MASSES} masses, springs, dampers, contacts"));
    }
    if masses.iter().all(|mass| mass.locked == [true; 2]) {
        problems.add("nothing can move: a network needs a [[mass]] that is not locked".to_owned());
    }
    check_names("mass", masses.iter().map(|mass| &*mass.name), problems);
    check_names("spring", springs.iter().map(|spring| &*spring.name), problems);
    check_names("damper", dampers.iter().map(|damper| &*damper.name), problems);
    check_names("contact", contacts.iter().map(|contact| &*contact.name), problems);
    masses.iter().for_each(|mass| check_mass(mass, problems));

    let mut is_held = vec![false; masses.len()];
    for spring in springs {
        let name = |key: &str| format!("spring.{}.{key}", spring.name);
        check_ends(&name("between"), spring.between, masses.len(), problems);
        problems.check(|| name("direction"), spring.direction, Rule::Finite);
        problems.check(|| name("stiffness"), spring.stiffness, Rule::NotNegative);
        problems.check(|| name("preload"), spring.preload, Rule::Finite);
        spring.between.iter().flatten().for_each(|&end| hold(&mut is_held, end));
    }
    for damper in dampers {
        let name = |key: &str| format!("damper.{}.{key}", damper.name);
        check_ends(&name("between"), damper.between, masses.len(), problems);
        problems.check(|| name("direction"), damper.direction, Rule::Finite);
        problems.check(|| name("damping"), damper.damping, Rule::NotNegative);
    }
    for contact in contacts {
        hold(&mut is_held, contact.mass);
        contact.on.iter().for_each(|&on| hold(&mut is_held, on));
        check_contact(contact, masses, slider, problems);
    }
    for (mass, _) in masses.iter().zip(is_held).filter(|(mass, held)| !held && !all_locked(mass)) {
        problems.add(format!(
            "mass.{} hangs on nothing: join it by a spring or a contact, or lock it",
            mass.name
        ));
    }
}

fn hold(is_held: &mut [bool], place: usize) {
    if let Some(held) = is_held.get_mut(place) {
        *held = true;
    }
}

fn all_locked(mass: &Mass) -> bool {
    mass.locked == [true; 2]
}

fn check_names<'a>(kind: &str, names: impl Iterator<Item = &'a str>, problems: &mut Problems) {
    let mut seen = HashSet::new();
    for name in names {
        let legal = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !legal || name == GROUND {
            problems.add(format!(
                "{kind} name \"{name}\": a name is a letter, then letters, digits and _, \
                 and not \"{GROUND}\""
            ));
        }
        if !seen.insert(name) {
            problems.add(format!("{kind} name \"{name}\" stands twice; give each {kind} its own"));
        }
    }
}

fn check_mass(mass: &Mass, problems: &mut Problems) {
    let name = &mass.name;
    problems.check(|| format!("mass.{name}.mass"), mass.mass, Rule::Positive);
    problems.check(|| format!("mass.{name}.angle"), mass.angle, Rule::Finite);
    for (axis, j) in [("x", 0), ("y", 1)] {
        problems.check(|| format!("mass.{name}.force[{j}]"), mass.load[j], Rule::Finite);
        problems.check(|| format!("mass.{name}.f{axis}"), mass.force[j], Rule::Finite);
        let initial = |key: &str| format!("initial.mass.{name}.{key}{axis}");
        problems.check(|| initial(""), mass.displacement[j], Rule::Finite);
        problems.check(|| initial("v"), mass.velocity[j], Rule::Finite);
        if mass.locked[j] && (mass.displacement[j] != 0.0 || mass.velocity[j] != 0.0) {
            problems.add(format!("{}: the mass is locked along {axis}", initial("")));
        }
    }
}

fn check_ends(name: &str, ends: [Option<usize>; 2], masses: usize, problems: &mut Problems) {
    if ends[0] == ends[1] {
        let what = if ends[0].is_none() { "the ground" } else { "a mass" };
        problems.add(format!("{name}: joins {what} to itself; give two different ends"));
    }
    if ends.iter().flatten().any(|&end| end >= masses) {
        problems.add(format!("{name}: names a mass that is not there"));
    }
}

fn check_contact(contact: &RubbingPlace, masses: &[Mass], slider: Slider, problems: &mut Problems) {
    let name = |key: &str| format!("contact.{}.{key}", contact.name);
    for (key, value, rule) in [
        ("angle", contact.angle, Rule::Finite),
        ("velocity", contact.velocity, Rule::Finite),
        ("friction", contact.friction, Rule::NotNegative),
    ] {
        if let Some(value) = value {
            problems.check(|| name(key), value, rule);
        }
    }
    if contact.on == Some(contact.mass) {
        problems.add(format!("{}: the mass rubs on itself; name another", name("on")));
        return;
    }
    let (Some(mass), on) = (masses.get(contact.mass), contact.on.map(|on| masses.get(on))) else {
        return problems.add(format!("{}: there is no such mass", name("mass")));
    };
    if on == Some(None) {
        return problems.add(format!("{}: there is no such mass", name("on")));
    }
    let bodies: Vec<&Mass> = std::iter::once(mass).chain(on.flatten()).collect();
    let angle = contact.angle.unwrap_or(slider.angle);
    let [cos, sin] = direction(angle);
    for (what, d) in [("tangent", [cos, sin]), ("normal", [-sin, cos])] {
        let part = |body: &&Mass| {
            body.free(along_axes(body, d)).fold(0.0, |part, value| f64::max(part, value.abs()))
        };
        if !bodies.iter().any(|body| part(body) > NO_PART) {
            problems.add(format!(
                "{}: cannot move along the {what} of its contact {}, being locked; free it, or turn \
                 the contact",
                masses_named(&bodies),
                contact.name
            ));
        }
    }
    let parts = bodies.iter().zip([1.0, -1.0]).flat_map(|(body, sign)| {
        let [x, y] = along_axes(body, [-sin, cos]);
        [sign * x * body.displacement[0], sign * y * body.displacement[1]]
    });
    let (gap, size) =
        parts.fold((0.0, 0.0), |(gap, size), part: f64| (gap + part, f64::max(size, part.abs())));
    if gap < -ROUNDING * size {
        problems.add(format!(
            "initial.mass.{}: starts inside the surface of contact {}, with a gap of {gap:e} m; it \
             must be ≥ 0",
            mass.name, contact.name
        ));
    }
}

fn masses_named(masses: &[&Mass]) -> String {
    let names: Vec<String> = masses.iter().map(|mass| format!("mass.{}", mass.name)).collect();
    names.join(" and ")
}

/// A direction in space as its parts along the axes of a mass.
fn along_axes(mass: &Mass, d: [f64; 2]) -> [f64; 2] {
    let [cos, sin] = direction(mass.angle);
    [d[0] * cos + d[1] * sin, d[1] * cos - d[0] * sin]
}
