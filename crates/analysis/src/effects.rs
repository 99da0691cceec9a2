//! All effects of the model for one scene: each is on or off, with the scene that has the effect the other way round.

use amontons::contact::Law;
use amontons::scene::{Damper, ForceRole, Line, Point, Scene, Structure};
use amontons::simulation::variables;
use std::collections::BTreeSet;

/// A value that turns an effect on and does next to nothing to the motion.
const NEXT_TO_NOTHING: f64 = 1e-30;

/// An effect of a scene.
pub struct Effect {
    /// Name of the effect: friction, sticking, …
    pub name: &'static str,
    /// The term that the effect adds to the equation of motion, or the quantity that it adds to the results.
    pub equation: &'static str,
    /// `true` if the scene uses the effect.
    pub is_on: bool,
    /// The scene with it.
    pub with: Scene,
    /// The scene without it.
    pub without: Scene,
}

impl Effect {
    /// The variables that come with it, by name.
    #[must_use]
    pub fn variables(&self) -> Vec<String> {
        let names = |scene: &Scene| -> BTreeSet<String> {
            variables(scene).into_iter().map(|variable| variable.name).collect()
        };
        let without = names(&self.without);
        let added = variables(&self.with).into_iter().map(|variable| variable.name);
        added.filter(|name| !without.contains(name)).collect()
    }
}

/// The effects that there are for a scene, each against the scene without it. What the scene does not call for is
/// put to values that move nothing.
#[must_use]
pub fn effects(scene: &Scene) -> Vec<Effect> {
    let mut all = Vec::new();
    let mut add = |name, equation, is_on: bool, change: &dyn Fn(&mut Scene, bool)| {
        let turned = |on| {
            let mut scene = scene.clone();
            if on != is_on {
                change(&mut scene, on);
            }
            scene
        };
        all.push(Effect { name, equation, is_on, with: turned(true), without: turned(false) });
    };
    let law = scene.contact_law().friction;
    if scene.contact_count() > 0 {
        for &other in Law::ALL.iter().filter(|law| **law != Law::Frictionless) {
            let about = other.info();
            add(about.name, about.equation, law == other, &|scene, on| {
                set_law(scene, if on { other } else { Law::Frictionless });
            });
        }
        if law.info().sticks {
            add(
                "sticking",
                "ẋ_T = v while friction holds",
                scene.effects.sticking,
                &|scene, on| {
                    scene.effects.sticking = on;
                    if !on && scene.contact_law().friction == Law::StaticKinetic {
                        set_law(scene, Law::Coulomb);
                    }
                },
            );
        }
        let opens = "x_N ≥ 0 ⊥ N ≥ 0, in place of x_N = 0";
        add("detachment", opens, scene.effects.detachment, &|scene, on| {
            scene.effects.detachment = on;
        });
    }
    add("damping by mass", "C += α M", scene.effects.mass_damping, &|scene, on| {
        scene.effects.mass_damping = on;
        scene.damping.alpha = if on { NEXT_TO_NOTHING } else { 0.0 };
    });
    add("damping by stiffness", "C += β K", scene.effects.stiffness_damping, &|scene, on| {
        scene.effects.stiffness_damping = on;
        scene.damping.beta = if on { NEXT_TO_NOTHING } else { 0.0 };
    });
    match &scene.structure {
        Structure::Ring(_) => {
            let links = "K += k1, k2 between modules";
            add("links", links, scene.effects.links, &|scene, on| {
                scene.effects.links = on;
                let stiffness = if on { NEXT_TO_NOTHING } else { 0.0 };
                for module in scene.modules_mut() {
                    module.stiffness[..2].fill(stiffness);
                }
            });
            let preload = "F -= k3 δ along x2";
            add("preload", preload, scene.effects.preload, &|scene, on| {
                scene.effects.preload = on;
                scene.modules_mut().iter_mut().for_each(|module| module.preload = 0.0);
            });
        }
        Structure::Network(network) => {
            let has_dampers = !network.dampers.is_empty();
            add("single dampers", "C += D", has_dampers, &|scene, on| set_dampers(scene, on));
        }
    }
    let forces = "F += external forces";
    add("forces", forces, scene.roles.forces != ForceRole::None, &|scene, on| {
        scene.roles.forces = if on { ForceRole::Input } else { ForceRole::None };
    });
    let energy = "T + U, the work of all forces, and the residual of their balance";
    add("energy", energy, scene.effects.energy, &|scene, on| scene.effects.energy = on);
    let stability = "largest growth rate in the present contact state";
    add("stability", stability, scene.effects.stability, &|scene, on| {
        scene.effects.stability = on;
    });
    all
}

/// Gives the scene another law of friction, with the numbers that it needs: of those that it lacks, such as make
/// no difference.
fn set_law(scene: &mut Scene, law: Law) {
    let has = |key| law.info().keys.contains(&key);
    scene.friction_law = if law == Law::StaticKinetic { Law::Coulomb } else { law };
    if !has("coefficient") {
        scene.friction_coefficient = 0.0;
    }
    let coefficient = scene.friction_coefficient;
    scene.static_friction = has("static").then(|| scene.static_friction.unwrap_or(coefficient));
    scene.stribeck_velocity =
        has("stribeck_velocity").then(|| scene.stribeck_velocity.unwrap_or(1.0));
    if let Structure::Network(network) = &mut scene.structure {
        for contact in &mut network.contacts {
            contact.static_friction = contact.static_friction.filter(|_| has("static"));
            contact.friction = contact.friction.filter(|_| has("coefficient"));
        }
    }
}

/// Takes away the single dampers, or puts one at the first mass.
fn set_dampers(scene: &mut Scene, on: bool) {
    let Structure::Network(network) = &mut scene.structure else { return };
    network.dampers.clear();
    if on && !network.masses.is_empty() {
        let between = [Some(Point::Mass(0)), None];
        let name = "one".to_owned();
        network.dampers.push(Damper {
            name,
            between,
            direction: Line::Angle(0.0),
            damping: NEXT_TO_NOTHING,
        });
    }
}
