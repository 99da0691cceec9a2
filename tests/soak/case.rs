//! A case: a random scene, and how long it is run with which step.

use crate::drive;
use crate::random::Random;
use crate::{network, ring};
use amontons::assembly;
use amontons::contact::Law;
use amontons::model::LumpedModel;
use amontons::scene::{Damping, Effects, Method, Scene, builtin};
use amontons::stability::critical_step;

/// Settings of the integrator for a run of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    pub method: Method,
    /// Step, s.
    pub step: f64,
    pub steps: u32,
}

impl Plan {
    /// The plan that a scene file itself contains.
    pub fn of(scene: &Scene) -> Self {
        let steps = (scene.experiment.stop_time / scene.step).round() as u32;
        Self { method: scene.method, step: scene.step, steps }
    }
}

/// A scene and its runs.
#[derive(Clone, Debug)]
pub struct Case {
    pub scene: Scene,
    pub plans: [Plan; 2],
}

/// So many scenes are drawn until one has an equilibrium; the last is taken as it is.
const DRAWS: u32 = 12;

/// The way in which a scene begins to slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// It is in uniform sliding.
    Sliding,
    /// Signals set its surfaces, which are at rest, in motion.
    FromRest,
}

impl Case {
    /// The scene of this number under this seed.
    pub fn drawn(seed: u64, number: u64) -> Self {
        let random = &mut Random::of(seed, number);
        let contacts = contact_count(random);
        let mut scene = drawn_scene(random, contacts);
        for _ in 1..DRAWS {
            if has_equilibrium(&scene) {
                break;
            }
            scene = drawn_scene(random, contacts);
        }
        let fastest = fastest(&scene);
        let plans = plans(random, &scene, fastest);
        let length = f64::from(plans[0].steps) * plans[0].step;
        scene.signals = drive::added(random, &scene, length, fastest).into();
        Self { scene, plans }
    }

    /// The scene as one of its runs takes it.
    pub fn planned(&self, plan: Plan) -> Scene {
        let mut scene = self.scene.with_integrator(plan.method, plan.step);
        scene.experiment.output_interval = plan.step;
        scene.experiment.stop_time = f64::from(plan.steps) * plan.step;
        scene
    }
}

/// Few contacts more often than many, up to 40.
fn contact_count(random: &mut Random) -> usize {
    match random.unit() {
        part if part < 0.6 => random.whole(1, 4),
        part if part < 0.87 => random.whole(5, 10),
        part if part < 0.96 => random.whole(11, 20),
        _ => random.whole(21, 40),
    }
}

fn drawn_scene(random: &mut Random, contacts: usize) -> Scene {
    let mut scene = builtin("set1").expect("a scene that the program carries").scene();
    (scene.name, scene.description) = ("case".to_owned(), String::new());
    scene.signals = [].into();
    scene.effects = Effects::default();
    scene.slider.velocity = if random.chance(0.05) { 0.0 } else { random.signed(1e-3, 3.0) };
    set_law(random, &mut scene);
    set_damping(random, &mut scene);
    drive::set_roles(random, &mut scene);
    let start = if random.chance(0.5) { Start::Sliding } else { Start::FromRest };
    if random.chance(0.35) {
        ring::fill(random, &mut scene, contacts);
    } else {
        network::fill(random, &mut scene, contacts);
    }
    if start == Start::FromRest {
        drive::hold_surfaces(random, &mut scene);
    }
    scene
}

/// The law of friction, its numbers, and which parts of the law of contact there are.
fn set_law(random: &mut Random, scene: &mut Scene) {
    let most = [0.3, 1.0, 3.0][random.whole(0, 2)];
    let coefficient = random.between(0.0, most);
    scene.friction_coefficient = coefficient;
    scene.static_friction = None;
    scene.stribeck_velocity = None;
    let static_friction = coefficient * random.between(1.0, 3.0);
    let kind = random.unit();
    scene.friction_law = if kind < 0.05 {
        scene.friction_coefficient = 0.0;
        Law::Frictionless
    } else if kind < 0.45 {
        Law::Coulomb
    } else {
        scene.static_friction = Some(static_friction);
        if kind < 0.85 { Law::StaticKinetic } else { Law::Stribeck }
    };
    if scene.friction_law == Law::Stribeck {
        scene.stribeck_velocity = Some(random.wide(1e-3, 1.0));
    }
    let (sticks, opens) = (!random.chance(0.1), !random.chance(0.1));
    scene.effects.sticking = sticks || scene.friction_law == Law::Frictionless;
    scene.effects.detachment = opens;
    if !scene.effects.sticking && scene.friction_law == Law::StaticKinetic {
        (scene.friction_law, scene.static_friction) = (Law::Coulomb, None);
    }
    scene.effects.energy = random.chance(0.5);
}

fn set_damping(random: &mut Random, scene: &mut Scene) {
    let alpha = random.sometimes(0.3, |random| random.between(0.0, 50.0));
    let beta = random.sometimes(0.4, |random| random.wide(1e-8, 1e-3));
    scene.effects.mass_damping = alpha.is_some();
    scene.effects.stiffness_damping = beta.is_some();
    scene.damping = Damping { alpha: alpha.unwrap_or(0.0), beta: beta.unwrap_or(0.0) };
}

/// `true` if the values of a scene are valid and it has an equilibrium.
fn has_equilibrium(scene: &Scene) -> bool {
    let acting = drive::at_start(scene);
    acting.check().is_ok() && assembly::equilibrium(&acting, &LumpedModel::from(&acting)).is_ok()
}

/// A frequency that no mode without friction exceeds, 1/s: Gershgorin's circles of M⁻¹ K.
pub fn fastest(scene: &Scene) -> f64 {
    let model = LumpedModel::from(scene);
    let circle = |dof: usize| {
        let row = model.stiffness.row(dof).fold(0.0, |sum, (_, value)| sum + value.abs());
        row / model.mass.get(dof, dof)
    };
    let square = (0..model.dofs()).map(circle).fold(0.0, f64::max);
    if square > 0.0 { square.sqrt() } else { 1.0 }
}

/// The steps of both integrators, which cover times of the same order.
fn plans(random: &mut Random, scene: &Scene, fastest: f64) -> [Plan; 2] {
    let friction_coefficient = drive::FRICTION_RISES * scene.friction_coefficient;
    let model = LumpedModel::from(&Scene { friction_coefficient, ..scene.clone() });
    let critical = critical_step(&model).map_or(0.5 / fastest, |critical| critical.step);
    let critical = if critical.is_finite() { critical } else { 0.5 / fastest };
    let many = scene.contact_count() > 10;
    let steps = random.whole(50, if many { 100 } else { 250 }) as u32;
    let scheme = Plan {
        method: Method::ForwardIncrement,
        step: random.wide(0.02, 0.95) * critical.min(1.0 / fastest),
        steps,
    };
    let exact_steps = random.whole(10, if many { 20 } else { 50 }) as u32;
    let length = f64::from(steps) * scheme.step * random.wide(0.5, 4.0);
    let step = length / f64::from(exact_steps);
    let exact = Plan { method: Method::EventDriven, step, steps: exact_steps };
    [scheme, exact]
}
