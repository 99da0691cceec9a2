//! Initial values that leave no mass inside another, or inside a surface.

use amontons::scene::{ContactDefinition, Mass, Network, direction};

/// A mass is pushed out of a surface so often, for others may push it back.
const MOST_PUSHES: usize = 200;

/// The parts of a direction of space along the axes of a mass that it can move along.
fn along(mass: &Mass, d: [f64; 2]) -> [f64; 2] {
    let [cos, sin] = direction(mass.angle);
    let parts = [d[0] * cos + d[1] * sin, d[1] * cos - d[0] * sin];
    [0, 1].map(|axis| if mass.locked[axis] { 0.0 } else { parts[axis] })
}

fn normal(contact: &ContactDefinition, slider: f64) -> [f64; 2] {
    let [cos, sin] = direction(contact.angle.unwrap_or(slider));
    [-sin, cos]
}

/// The bodies of a contact with the signs that they have in its gap.
fn bodies(contact: &ContactDefinition) -> impl Iterator<Item = (usize, f64)> {
    [Some(contact.mass), contact.on].into_iter().zip([1.0, -1.0]).filter_map(|(body, sign)| {
        let body = body?.mass()?;
        Some((body, sign))
    })
}

/// The gap, how much a unit along the normal of each body widens it, and what rounding it may have.
fn gap(network: &Network, contact: &ContactDefinition, slider: f64) -> [f64; 3] {
    let normal = normal(contact, slider);
    bodies(contact).fold([0.0; 3], |[gap, gain, size], (body, sign)| {
        let mass = &network.masses[body];
        let [x, y] = along(mass, normal);
        let part = sign * (x * mass.displacement[0] + y * mass.displacement[1]);
        [gap + part, gain + x * x + y * y, size + part.abs()]
    })
}

/// Pushes masses out of what they are inside of, and up to `more` (m) away; where that does not come to an end,
/// all masses start where they are at rest.
pub fn push(network: &mut Network, slider: f64, more: f64) {
    let contacts = network.contacts.clone();
    for _ in 0..MOST_PUSHES {
        let mut is_done = true;
        for contact in &contacts {
            let [gap, gain, size] = gap(network, contact, slider);
            if gap >= -1e-13 * size {
                continue;
            }
            is_done = false;
            let normal = normal(contact, slider);
            for (body, sign) in bodies(contact) {
                let mass = &mut network.masses[body];
                let parts = along(mass, normal);
                for (place, part) in mass.displacement.iter_mut().zip(parts) {
                    *place += sign * part * (more - gap) / gain;
                }
            }
        }
        if is_done {
            return;
        }
    }
    network.masses.iter_mut().for_each(|mass| mass.displacement = [0.0; 2]);
}

/// Takes all motion away from masses with contacts, which cannot open, but for what is along the contact of a mass
/// whose axes are those of its only contact.
pub fn keep_closed(network: &mut Network, slider: f64) {
    let contacts = network.contacts.clone();
    let touching = |mass: usize| contacts.iter().filter(move |c| bodies(c).any(|b| b.0 == mass));
    for i in 0..network.masses.len() {
        let count = touching(i).count();
        let only = touching(i).next().filter(|contact| count == 1 && contact.on.is_none());
        let mass = &mut network.masses[i];
        let is_along = only.is_some_and(|contact| along(mass, normal(contact, slider))[0] == 0.0);
        if is_along {
            (mass.displacement[1], mass.velocity[1]) = (0.0, 0.0);
        } else if count > 0 {
            (mass.displacement, mass.velocity) = ([0.0; 2], [0.0; 2]);
        }
    }
}
