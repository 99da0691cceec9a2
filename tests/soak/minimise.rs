//! Makes a case that fails smaller, as long as it fails in the same way.

use crate::case::{Case, Plan};
use crate::outcome::{Outcome, run};
use amontons::contact::Law;
use amontons::scene::{Effects, Point, Scene, Structure};
use std::time::{Duration, Instant};

/// Making a case smaller ends after this time.
const LONGEST: Duration = Duration::from_secs(60);

/// A case that fails in the same way by this plan, and the plan: the smallest that was found.
pub fn smallest(case: &Case, plan: Plan, outcome: &Outcome) -> (Case, Plan) {
    let start = Instant::now();
    let (mut best, mut plan) = (case.clone(), plan);
    let still_fails = |case: &Case, plan: Plan| run(case, plan).outcome.is_like(outcome);
    loop {
        let mut found = false;
        let shorter = Plan { steps: run(&best, plan).steps + 1, ..plan };
        if shorter.steps < plan.steps && still_fails(&best, shorter) {
            (plan, found) = (shorter, true);
        }
        // Later parts first: what comes after them keeps its place.
        for change in (0..change_count(&best.scene)).rev() {
            if start.elapsed() > LONGEST {
                return (best, plan);
            }
            let Some(scene) = changed(&best.scene, change) else { continue };
            let smaller = Case { scene, ..best.clone() };
            if still_fails(&smaller, plan) {
                (best, found) = (smaller, true);
            }
        }
        if !found {
            return (best, plan);
        }
    }
}

/// Changes that do not belong to one part.
const COMMON: usize = 8;
/// Values of a module or mass that may be zero: displacements and velocities.
const VALUES: usize = 8;

/// Number of changes that can make a scene smaller.
fn change_count(scene: &Scene) -> usize {
    COMMON + scene.signals.len() + parts(scene).into_iter().sum::<usize>()
}

/// Parts that may be left out, and values that may be zero.
fn parts(scene: &Scene) -> [usize; 5] {
    match &scene.structure {
        Structure::Ring(modules) => [modules.len(), 0, 0, 0, VALUES * modules.len()],
        Structure::Network(network) => [
            network.masses.len(),
            network.springs.len(),
            network.dampers.len(),
            network.contacts.len(),
            VALUES * network.masses.len(),
        ],
    }
}

/// The scene after one change; `None` where it changes nothing.
fn changed(scene: &Scene, change: usize) -> Option<Scene> {
    let mut smaller = scene.clone();
    let Some(place) = change.checked_sub(COMMON) else {
        change_common(&mut smaller, change);
        return (smaller != *scene).then_some(smaller);
    };
    let Some(mut place) = place.checked_sub(scene.signals.len()) else {
        let mut signals = scene.signals.to_vec();
        signals.remove(place);
        smaller.signals = signals.into();
        return Some(smaller);
    };
    for (kind, count) in parts(scene).into_iter().enumerate() {
        if place < count {
            change_part(&mut smaller, kind, place);
            drop_strange_signals(&mut smaller);
            return (smaller != *scene).then_some(smaller);
        }
        place -= count;
    }
    None
}

fn change_common(scene: &mut Scene, change: usize) {
    match change {
        0 => scene.effects.energy = false,
        1 => (scene.effects.mass_damping, scene.damping.alpha) = (false, 0.0),
        2 => (scene.effects.stiffness_damping, scene.damping.beta) = (false, 0.0),
        3 => {
            let Effects { sticking, detachment, .. } = Effects::default();
            (scene.effects.sticking, scene.effects.detachment) = (sticking, detachment);
        }
        4 if scene.friction_law != Law::Frictionless => {
            scene.friction_law = Law::Coulomb;
            (scene.static_friction, scene.stribeck_velocity) = (None, None);
            drop_strange_signals(scene);
        }
        5 => {
            let Structure::Network(network) = &mut scene.structure else { return };
            network.contacts.iter_mut().for_each(|place| place.velocity = None);
            drop_strange_signals(scene);
        }
        6 => {
            let Structure::Network(network) = &mut scene.structure else { return };
            for place in &mut network.contacts {
                (place.friction, place.static_friction) = (None, None);
            }
            drop_strange_signals(scene);
        }
        7 => {
            let Structure::Network(network) = &mut scene.structure else { return };
            network.springs.iter_mut().for_each(|spring| spring.preload = None);
            drop_strange_signals(scene);
        }
        _ => {}
    }
}

fn change_part(scene: &mut Scene, kind: usize, place: usize) {
    match &mut scene.structure {
        Structure::Ring(modules) if kind == 0 => {
            if modules.len() > 1 {
                modules.remove(place);
            }
        }
        Structure::Ring(modules) => {
            let module = &mut modules[place / VALUES];
            let values = module.displacement.iter_mut().chain(&mut module.velocity);
            values.skip(place % VALUES).take(1).for_each(|value| *value = 0.0);
        }
        Structure::Network(network) => match kind {
            0 => remove_mass(network, place),
            1 => drop(network.springs.remove(place)),
            2 => drop(network.dampers.remove(place)),
            3 => drop(network.contacts.remove(place)),
            _ => {
                let mass = &mut network.masses[place / VALUES];
                let moved = mass.displacement.iter_mut().chain(&mut mass.velocity);
                let values = moved.chain(&mut mass.load);
                values.skip(place % VALUES).take(1).for_each(|value| *value = 0.0);
            }
        },
    }
}

/// Takes a mass away with all that is joined to it.
fn remove_mass(network: &mut amontons::scene::Network, place: usize) {
    if network.masses.len() < 2 {
        return;
    }
    network.masses.remove(place);
    let keeps = |ends: &[Option<Point>]| !ends.contains(&Some(Point::Mass(place)));
    network.springs.retain(|spring| keeps(&spring.between));
    network.dampers.retain(|damper| keeps(&damper.between));
    network.contacts.retain(|contact| keeps(&[Some(contact.mass), contact.on]));
    let moved = |end: &mut Point| {
        if let Point::Mass(mass) = end {
            *mass -= usize::from(*mass > place);
        }
    };
    network.springs.iter_mut().flat_map(|s| s.between.iter_mut().flatten()).for_each(moved);
    network.dampers.iter_mut().flat_map(|d| d.between.iter_mut().flatten()).for_each(moved);
    for contact in &mut network.contacts {
        moved(&mut contact.mass);
        contact.on.iter_mut().for_each(moved);
    }
}

/// Takes signals away whose inputs are not there any more.
fn drop_strange_signals(scene: &mut Scene) {
    let inputs = scene.input_names();
    let known = scene.signals.iter().filter(|signal| inputs.contains(&signal.input));
    scene.signals = known.cloned().collect::<Vec<_>>().into();
}
