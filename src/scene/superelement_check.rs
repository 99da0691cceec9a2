//! Checks that the superelements of a network, and what acts on their nodes, are possible.

use super::check::{Checks, Owner};
use super::load_file::lacks;
use super::names::has_node;
use super::network::{dot, unit};
use super::network_check::quoted;
use super::{ContactDefinition, Network, NodeAt, Point, Problem, Slider};
use std::collections::HashMap;

/// Smallest part of a unit vector that counts.
const NO_PART: f64 = 1e-9;
/// Directions are perpendicular, or one, up to this.
pub(super) const ASKEW: f64 = 1e-6;

/// Reports impossible values of superelements.
pub(super) fn check(network: &Network, has_beta: bool, checks: &mut Checks<'_>) {
    for (i, one) in network.superelements.iter().enumerate() {
        if has_beta && !one.matrices.is_conservative() {
            let message = format!(
                "would damp with the circulatory part of {}: its stiffness matrix is unsymmetric",
                one.name
            );
            let problem = Problem::new("damping.beta", message);
            checks.problems.push(problem.help("give `beta` in the [[superelement]] in its place"));
        }
        let n = one.matrices.dofs();
        let vectors = [
            ("load", &one.load, Owner::Superelement(i)),
            ("force", &one.force, Owner::Superelement(i)),
            ("", &one.displacement, Owner::InitialOfSuperelement(i)),
            ("", &one.velocity, Owner::InitialOfSuperelement(i)),
        ];
        for (key, values, owner) in vectors {
            if values.len() != n {
                let message = format!("has {} values, but {n} degrees of freedom", values.len());
                checks.problems.push(checks.problem(owner, key, message));
            } else if let Some(row) = values.iter().position(|value| !value.is_finite()) {
                let message = format!("must be a finite number in row {}", row + 1);
                checks.problems.push(checks.problem(owner, key, message).of(values[row]));
            }
        }
    }
}

/// `true` if the point is there.
pub(super) fn exists(network: &Network, point: Point) -> bool {
    match point {
        Point::Mass(mass) => mass < network.masses.len(),
        Point::Node(NodeAt { superelement, node }) => {
            network.superelements.get(superelement).is_some_and(|one| has_node(one, node))
        }
    }
}

impl Network {
    /// `true` if a point of a contact has a degree of freedom across the sliding. Masses move in the plane of x and y.
    pub(super) fn moves_across(
        &self,
        point: Point,
        contact: &ContactDefinition,
        slider: Slider,
    ) -> bool {
        let [n, t] = contact.directions(slider.angle);
        let next = |i: usize| ((i + 1) % 3, (i + 2) % 3);
        (1_u8..).zip((0..3).map(next)).any(|(direction, (j, k))| {
            (n[j] * t[k] - n[k] * t[j]).abs() > NO_PART
                && match point {
                    Point::Mass(_) => direction < 3,
                    Point::Node(at) => self.node_row(at, direction).is_some(),
                }
        })
    }
}

/// Reports a point that cannot move along a direction (a unit vector) because it has no such degree of freedom: a mass
/// along z, or a node of which a direction was not kept.
pub(super) fn check_reach(
    network: &Network,
    (part, key): (Owner, &str),
    point: Point,
    d: [f64; 3],
    checks: &mut Checks<'_>,
) {
    let path = checks.path(part, key);
    let name = quoted(&network.point_name(point));
    let lacking = |direction: &u8| {
        d[usize::from(*direction) - 1].abs() > NO_PART
            && match point {
                Point::Mass(_) => *direction == 3,
                Point::Node(at) => network.node_row(at, *direction).is_none(),
            }
    };
    let Some(direction) = (1..=3).find(lacking) else { return };
    let problem = match point {
        Point::Mass(_) => Problem::new(
            path,
            "is a mass, which moves in the plane of x and y, but this acts along z",
        )
        .help("choose a direction whose third component is 0"),
        Point::Node(at) => lacks(network, at, direction, path),
    };
    checks.problems.push(problem.of(name));
}

/// Reports a direction given by components that has no length, or is not finite. `true` if it can be used.
pub(super) fn is_direction(
    vector: [f64; 3],
    (part, key): (Owner, &str),
    checks: &mut Checks<'_>,
) -> bool {
    let Some(message) = no_direction(vector) else { return true };
    let problem = checks.problem(part, key, message).of(format!("{vector:?}"));
    checks.problems.push(problem.help("give a vector such as [0.0, 0.0, 1.0], of any length"));
    false
}

/// The reason why a vector has no direction; `None` if it has one.
fn no_direction(vector: [f64; 3]) -> Option<&'static str> {
    if !vector.iter().all(|value| value.is_finite()) {
        Some("must have three finite components")
    } else if vector == [0.0; 3] {
        Some("has no length, so it has no direction")
    } else {
        None
    }
}

/// The angle between two directions, in degrees; `None` if they are perpendicular.
fn askew(n: [f64; 3], t: [f64; 3]) -> Option<f64> {
    let along = dot(n, t);
    (along.abs() > ASKEW).then(|| libm::acos(along.clamp(-1.0, 1.0)).to_degrees())
}

/// The reason why these cannot be normal and tangent of a contact, with the remedy; `None` if they can.
pub(super) fn wrong_axes([normal, tangent]: [[f64; 3]; 2]) -> Option<(String, &'static str)> {
    for (name, vector) in [("normal", normal), ("tangent", tangent)] {
        if let Some(fault) = no_direction(vector) {
            return Some((format!("the {name} {fault}"), "give three components of any length"));
        }
    }
    let degrees = askew(unit(normal), unit(tangent))?;
    let message =
        format!("normal and tangent must be perpendicular, but have an angle of {degrees:.4}°");
    Some((message, "take the tangent within the surface"))
}

/// Reports normal and tangent that are no directions or not perpendicular. `true` if they can be used.
pub(super) fn check_axes(
    part: Owner,
    contact: &ContactDefinition,
    slider: Slider,
    checks: &mut Checks<'_>,
) -> bool {
    let Some([normal, tangent]) = contact.axes else { return true };
    let is_normal = is_direction(normal, (part, "normal"), checks);
    if !is_direction(tangent, (part, "tangent"), checks) || !is_normal {
        return false;
    }
    let [n, t] = contact.directions(slider.angle);
    let Some(degrees) = askew(n, t) else { return true };
    let message = format!(
        "normal and tangent of contact {} must be perpendicular, but have an angle of {degrees:.4}°",
        contact.name
    );
    let problem = checks.problem(part, "tangent", message).of(format!("{tangent:?}"));
    checks.problems.push(problem.help("take the tangent within the surface"));
    false
}

/// Reports pairs of points, at least one of them a node, that two contacts join along one normal.
pub(super) fn check_overlaps(network: &Network, slider: Slider, checks: &mut Checks<'_>) {
    let mut known: HashMap<(Point, Option<Point>), Vec<usize>> = HashMap::new();
    let normal = |contact: usize| network.contacts[contact].directions(slider.angle)[0];
    for (i, contact) in network.contacts.iter().enumerate() {
        let is_node = |point: Point| matches!(point, Point::Node(_));
        if !is_node(contact.mass) && !contact.on.is_some_and(is_node) {
            continue;
        }
        let along = |other: &usize| dot(normal(i), normal(*other));
        let alike = known.get(&(contact.mass, contact.on)).into_iter().flatten();
        let alike = alike.copied().find(|other| along(other) > 1.0 - ASKEW);
        // The same two points may be named the other way round, with the opposite normal.
        let swapped = contact.on.and_then(|on| known.get(&(on, Some(contact.mass))));
        let mut swapped = swapped.into_iter().flatten().copied();
        let first = alike.or_else(|| swapped.find(|other| along(other) < ASKEW - 1.0));
        match first {
            None => known.entry((contact.mass, contact.on)).or_default().push(i),
            Some(first) => {
                let message = format!(
                    "contacts {} and {} join the same points along the same normal",
                    network.contacts[first].name, contact.name
                );
                let point = quoted(&network.point_name(contact.mass));
                let problem = checks.problem(Owner::Contact(i), "mass", message).of(point);
                checks.problems.push(problem.help("leave one of them out"));
            }
        }
    }
}
