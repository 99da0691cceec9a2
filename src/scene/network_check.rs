//! Checks that a network is possible.

use super::check::{Checks, Owner};
use super::superelement_check::{self, check_axes, check_reach, exists, is_direction};
use super::{
    ContactDefinition, GROUND, Line, MAX_PARTS, Mass, Network, Point, Problem, Rule, Slider,
    direction,
};
use std::collections::HashMap;

/// Smallest part of a direction along the free axes; a smaller one counts as zero.
const NO_PART: f64 = 1e-9;
/// Largest rounding error of a gap that is zero, relative to the displacements.
const ROUNDING: f64 = 1e-12;

/// Reports impossible values and structures of a network.
pub(super) fn check(network: &Network, slider: Slider, has_beta: bool, checks: &mut Checks<'_>) {
    let Network { masses, springs, dampers, contacts, superelements, .. } = network;
    for (kind, count) in [
        ("mass", masses.len()),
        ("spring", springs.len()),
        ("damper", dampers.len()),
        ("contact", contacts.len()),
    ] {
        if count > MAX_PARTS {
            let message =
                format!("{count} are too many: a network has at most {MAX_PARTS} of each kind");
            checks.problems.push(Problem::new(kind, message));
        }
    }
    if !superelements.is_empty() {
        // They can move.
    } else if masses.is_empty() {
        checks.problems.push(Problem::new("mass", "a network needs at least one mass"));
    } else if masses.iter().all(is_locked) {
        let message = "nothing can move: every mass is locked along both of its axes";
        let problem = checks.problem(Owner::Mass(0), "locked", message);
        checks.problems.push(problem.help("leave an axis of a mass out of its `locked`"));
    }
    check_names(Owner::Mass, masses.iter().map(|mass| &*mass.name), checks);
    check_names(Owner::Superelement, superelements.iter().map(|one| &*one.name), checks);
    for (i, one) in superelements.iter().enumerate() {
        if masses.iter().any(|mass| mass.name == one.name) {
            let problem =
                checks.problem(Owner::Superelement(i), "name", "is the name of a mass too");
            let help = "give each its own: a contact takes either";
            checks.problems.push(problem.of(quoted(&one.name)).help(help));
        }
    }
    check_names(Owner::ContactSet, network.contact_sets.iter().map(|set| &**set), checks);
    check_names(Owner::Spring, springs.iter().map(|spring| &*spring.name), checks);
    check_names(Owner::Damper, dampers.iter().map(|damper| &*damper.name), checks);
    check_names(Owner::Contact, contacts.iter().map(|contact| &*contact.name), checks);
    for (i, mass) in masses.iter().enumerate() {
        check_mass(i, mass, checks);
    }
    for (i, spring) in springs.iter().enumerate() {
        let part = Owner::Spring(i);
        check_ends(part, spring.between, spring.direction, network, checks);
        checks.value(part, "stiffness", spring.stiffness, Rule::STIFFNESS);
        checks.value(part, "preload", spring.preload.unwrap_or(0.0), Rule::Finite);
    }
    for (i, damper) in dampers.iter().enumerate() {
        let part = Owner::Damper(i);
        check_ends(part, damper.between, damper.direction, network, checks);
        checks.value(part, "damping", damper.damping, Rule::DAMPING);
    }
    for (i, contact) in contacts.iter().enumerate() {
        check_contact(Owner::Contact(i), contact, network, slider, checks);
    }
    check_holds(network, checks);
    superelement_check::check(network, has_beta, checks);
    superelement_check::check_overlaps(network, slider, checks);
}

fn is_locked(mass: &Mass) -> bool {
    mass.locked == [true; 2]
}

/// Reports masses that can move and have neither a spring nor a contact.
fn check_holds(network: &Network, checks: &mut Checks<'_>) {
    let ends = network.springs.iter().flat_map(|spring| spring.between.into_iter().flatten());
    let rubbing = network.contacts.iter().flat_map(|contact| [Some(contact.mass), contact.on]);
    let mut is_held = vec![false; network.masses.len()];
    for place in ends.chain(rubbing.flatten()).filter_map(Point::mass) {
        match is_held.get_mut(place) {
            Some(held) => *held = true,
            // An unknown name may stand for any mass that seems to be unconnected.
            None => return,
        }
    }
    for (i, mass) in network.masses.iter().enumerate() {
        if !is_held[i] && !is_locked(mass) {
            let message = "is not connected to any spring or contact";
            let problem = checks.problem(Owner::Mass(i), "name", message).of(quoted(&mass.name));
            let help = "name it in the `between` of a [[spring]] or in a [[contact]], or write \
                        `locked = [\"x\", \"y\"]`";
            checks.problems.push(problem.help(help));
        }
    }
}

fn check_names<'a>(
    part: fn(usize) -> Owner,
    names: impl Iterator<Item = &'a str>,
    checks: &mut Checks<'_>,
) {
    let is_mass = matches!(part(0), Owner::Mass(_));
    let mut firsts = HashMap::new();
    for (i, name) in names.enumerate() {
        let is_legal = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let first = *firsts.entry(name).or_insert(i);
        let (message, help) = if !is_legal {
            ("must be a letter, then letters (a to z), digits and _", String::new())
        } else if is_mass && name == GROUND {
            ("is reserved for the fixed ground", "give the mass another name".to_owned())
        } else if first < i {
            let other = checks.path(part(first), "");
            ("is used twice", format!("{other} has the same name: give each its own"))
        } else {
            continue;
        };
        let problem = checks.problem(part(i), "name", message).of(quoted(name)).help(help);
        checks.problems.push(problem);
    }
}

fn check_mass(i: usize, mass: &Mass, checks: &mut Checks<'_>) {
    let (own, initial) = (Owner::Mass(i), Owner::InitialOfMass(i));
    checks.value(own, "mass", mass.mass, Rule::MASS);
    checks.value(own, "angle", mass.angle, Rule::Finite);
    for (j, axis) in ["x", "y"].into_iter().enumerate() {
        checks.value(own, &format!("force[{}]", j + 1), mass.load[j], Rule::Finite);
        checks.value(own, &format!("f{axis}"), mass.force[j], Rule::Finite);
        for (key, value) in
            [(axis.to_owned(), mass.displacement[j]), (format!("v{axis}"), mass.velocity[j])]
        {
            checks.value(initial, &key, value, Rule::Finite);
            if mass.locked[j] && value != 0.0 {
                let message = format!("the mass is locked along {axis}");
                let problem = checks.problem(initial, &key, message).of(value);
                checks.problems.push(problem.help("leave it out, or unlock the mass"));
            }
        }
    }
}

fn check_ends(
    part: Owner,
    ends: [Option<Point>; 2],
    line: Line,
    network: &Network,
    checks: &mut Checks<'_>,
) {
    let is_usable = match line {
        Line::Angle(angle) => {
            checks.value(part, "direction", angle, Rule::Finite);
            angle.is_finite()
        }
        Line::Vector(vector) => is_direction(vector, (part, "direction"), checks),
    };
    for (j, end) in ends.iter().enumerate() {
        let Some(point) = *end else { continue };
        let key = format!("between[{}]", j + 1);
        if !exists(network, point) {
            checks.problems.push(checks.problem(part, &key, NO_SUCH_MASS));
        } else if is_usable {
            check_reach(network, (part, &key), point, line.vector(), checks);
        }
    }
    if ends[0] == ends[1] && ends[0].is_none_or(|point| exists(network, point)) {
        let name = ends[0].map_or_else(|| GROUND.to_owned(), |point| network.point_name(point));
        let message = format!("joins {name} to itself");
        let problem = checks.problem(part, "between", message);
        checks.problems.push(problem.help("give two different ends"));
    }
}

/// Message for a reference to an unknown mass.
pub(super) const NO_SUCH_MASS: &str = "there is no mass of this name";

fn check_contact(
    part: Owner,
    contact: &ContactDefinition,
    network: &Network,
    slider: Slider,
    checks: &mut Checks<'_>,
) {
    for (key, value, rule) in [
        ("angle", contact.angle, Rule::Finite),
        ("velocity", contact.velocity, Rule::Finite),
        ("friction", contact.friction, Rule::FRICTION),
    ] {
        if let Some(value) = value {
            checks.value(part, key, value, rule);
        }
    }
    checks.value(part, "gap", contact.gap, Rule::OPENING);
    let mut bodies = Vec::new();
    for (key, place) in [("mass", Some(contact.mass)), ("on", contact.on)] {
        match place {
            Some(point) if exists(network, point) => bodies.push((key, point)),
            Some(_) => checks.problems.push(checks.problem(part, key, NO_SUCH_MASS)),
            None => {}
        }
    }
    if bodies.len() != 1 + usize::from(contact.on.is_some()) {
        return;
    }
    if contact.on == Some(contact.mass) {
        let itself = match contact.mass {
            Point::Mass(_) => "the mass rubs on itself",
            Point::Node(_) => "the node rubs on itself",
        };
        let problem = checks.problem(part, "on", itself);
        let help = match contact.mass {
            Point::Mass(_) => "name another mass, or leave `on` out: it then rubs on the slider",
            Point::Node(_) => "name another node, or leave `on` out: it then rubs on the slider",
        };
        checks.problems.push(problem.of(quoted(&network.point_name(contact.mass))).help(help));
        return;
    }
    if !check_axes(part, contact, slider, checks) {
        return;
    }
    let [normal, tangent] = contact.directions(slider.angle);
    let before = checks.problems.len();
    for d in [normal, tangent] {
        for &(key, point) in &bodies {
            // Of missing directions the first is reported alone.
            if checks.problems.len() == before {
                check_reach(network, (part, key), point, d, checks);
            }
        }
    }
    if checks.problems.len() > before {
        return;
    }
    for (what, d) in [("tangent", tangent), ("normal", normal)] {
        let can_move = |&(_, point): &(&str, Point)| match point {
            Point::Mass(mass) => {
                let mass = &network.masses[mass];
                mass.free(along_axes(mass, d)).any(|v| v.abs() > NO_PART)
            }
            Point::Node(_) => true,
        };
        if !bodies.iter().any(can_move) {
            let name = |point| network.point_name(point);
            let message = match bodies[..] {
                [(_, mass), (_, on)] => format!("both {} and {} are locked", name(mass), name(on)),
                _ => "is locked".to_owned(),
            };
            let message = format!("{message} along the {what} of this contact");
            let problem = checks.problem(part, "mass", message).of(quoted(&name(bodies[0].1)));
            checks
                .problems
                .push(problem.help("unlock an axis of a mass, or turn the contact by its `angle`"));
        }
    }
    let gaps: Vec<Vec<f64>> = bodies
        .iter()
        .zip([1.0, -1.0])
        .map(|(&(_, point), sign)| {
            moves(network, point, normal).into_iter().map(|moved| sign * moved).collect()
        })
        .collect();
    let (gap, size) = gaps
        .iter()
        .flatten()
        .fold((0.0, 0.0), |(gap, size), part| (gap + part, f64::max(size, part.abs())));
    // Of a gap in the unloaded position, the equilibrium leaves a part that is not known here.
    if contact.gap == 0.0 && gap < -ROUNDING * size {
        // The problem names the mass that penetrates the other more.
        let is_other = gaps.len() > 1 && gaps[1].iter().sum::<f64>() < gaps[0].iter().sum();
        let place = match contact.on.filter(|_| is_other).unwrap_or(contact.mass) {
            Point::Mass(mass) => Owner::InitialOfMass(mass),
            Point::Node(at) => Owner::InitialOfNode(at),
        };
        let message = format!(
            "starts inside the surface of contact {}, with a gap of {gap:e} m",
            contact.name
        );
        let problem = checks.problem(place, "", message);
        checks.problems.push(problem.help("the gap along the contact's normal must be ≥ 0"));
    }
}

/// A name in quotation marks, as in a scene file.
pub(super) fn quoted(name: &str) -> String {
    format!("{name:?}")
}

/// The parts of a point's initial displacement along a direction, m, one for each of its axes.
fn moves(network: &Network, point: Point, d: [f64; 3]) -> Vec<f64> {
    match point {
        Point::Mass(mass) => {
            let mass = &network.masses[mass];
            let [x, y] = along_axes(mass, d);
            vec![x * mass.displacement[0], y * mass.displacement[1]]
        }
        Point::Node(at) => {
            let displacement = &network.superelements[at.superelement].displacement;
            let along = |(axis, part): (u8, f64)| {
                let row = network.node_row(at, axis)?;
                Some(part * displacement.get(row)?)
            };
            (1..).zip(d).filter_map(along).collect()
        }
    }
}

/// Components of a direction in space along the axes of a mass.
fn along_axes(mass: &Mass, d: [f64; 3]) -> [f64; 2] {
    let [cos, sin] = direction(mass.angle);
    [d[0] * cos + d[1] * sin, d[1] * cos - d[0] * sin]
}
