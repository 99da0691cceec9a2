//! The problems that all solve, taken from our own model.

use amontons::assembly;
use amontons::model::{self, LumpedModel};
use amontons::scene::{Scene, builtin};
use serde::Serialize;
use std::array::from_fn;

/// Degrees of freedom and contacts of every scene here.
pub const DOFS: usize = 8;
pub const CONTACTS: usize = 2;
/// Rows of displacements, one a millisecond, up to one second.
pub const ROWS: usize = 1000;

/// A scene, and what else is known of its first second: how often a contact changes its state, and
/// how many of these changes are touch-downs.
pub struct Case {
    pub name: &'static str,
    pub about: &'static str,
    pub events: u64,
    pub touch_downs: u64,
    pub scene: Scene,
}

/// The scenes by name.
pub fn all() -> Vec<Case> {
    vec![
        Case {
            name: "flutter",
            about: "Set 1, µ = 1.96, v = 0.025 m/s, from v1 = 0.01 m/s of module 1",
            events: 703,
            touch_downs: 0,
            scene: set1(1.96, 0.025),
        },
        Case {
            name: "impacts",
            about: "Set 1, µ = 1.5, v = 0.15 m/s, from v1 = 0.01 m/s of module 1",
            events: 619,
            touch_downs: 162,
            scene: set1(1.5, 0.15),
        },
        Case {
            name: "kick",
            about: "Set 2, µ = 1.96, v = 0.025 m/s, after a kick of 0.3 m/s on x2 of module 1",
            events: 670,
            touch_downs: 0,
            scene: scene("set2"),
        },
    ]
}

fn scene(name: &str) -> Scene {
    builtin(name).expect("it is built in").scene()
}

fn set1(friction: f64, velocity: f64) -> Scene {
    let mut scene = scene("set1");
    (scene.friction_coefficient, scene.slider.velocity) = (friction, velocity);
    scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
    scene
}

/// M ẍ + C ẋ + K x = F + contact forces, with M diagonal and C = α M + β K, as it is handed to every
/// peer. Displacements count from the equilibrium, so F is what is left there of the load: the contact
/// forces that balance it, reversed. Gaps are then the displacements of the degrees of freedom `normal`.
#[derive(Clone, Debug, Serialize)]
pub struct Problem {
    /// kg
    pub mass: [f64; DOFS],
    /// N/m
    pub stiffness: [[f64; DOFS]; DOFS],
    /// 1/s
    pub alpha: f64,
    /// s
    pub beta: f64,
    /// N
    pub force: [f64; DOFS],
    /// Degree of freedom of each contact's gap, positive where it is open.
    pub normal: [usize; CONTACTS],
    /// Degree of freedom of each contact's tangential displacement.
    pub tangent: [usize; CONTACTS],
    /// v, m/s
    pub slider_velocity: f64,
    /// µ
    pub friction: f64,
    /// m, at the start
    pub displacement: [f64; DOFS],
    /// m/s, at the start
    pub velocity: [f64; DOFS],
}

impl From<&Scene> for Problem {
    fn from(scene: &Scene) -> Self {
        let model = LumpedModel::from(scene);
        let equilibrium = assembly::equilibrium(scene, &model).expect("it has an equilibrium");
        let mut force = [0.0; DOFS];
        for (i, contact) in model.contacts.iter().enumerate() {
            contact.normal.add_to(&mut force, -equilibrium.normal_force[i]);
            contact.tangent.add_to(&mut force, -equilibrium.friction_force[i]);
        }
        let unit = |direction: &model::Direction| direction.as_unit().expect("it is a ring's");
        let start = |values: Vec<f64>| values.try_into().expect("two modules");
        Self {
            mass: from_fn(|i| model.mass.get(i, i)),
            stiffness: from_fn(|i| from_fn(|j| model.stiffness.get(i, j))),
            alpha: model.damping.alpha,
            beta: model.damping.beta,
            force,
            normal: from_fn(|i| unit(&model.contacts[i].normal)),
            tangent: from_fn(|i| unit(&model.contacts[i].tangent)),
            slider_velocity: scene.slider.velocity,
            friction: scene.friction_coefficient,
            displacement: start(scene.initial_displacements().collect()),
            velocity: start(scene.initial_velocities().collect()),
        }
    }
}
