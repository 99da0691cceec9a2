//! Random rings of modules.

use crate::random::Random;
use amontons::scene::{Module, Scene, Structure};

/// Values between which masses and stiffnesses of one scene lie: a ratio of up to this size.
pub const MASS_RATIO: f64 = 1e4;
pub const STIFFNESS_RATIO: f64 = 1e6;

/// Sizes of the values of one scene.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// kg, the lightest and the heaviest mass.
    pub mass: [f64; 2],
    /// N/m, the softest and the stiffest spring.
    pub stiffness: [f64; 2],
    /// N.
    pub load: f64,
    /// m/s and m, of what masses start with.
    pub velocity: f64,
    pub displacement: f64,
}

impl Sizes {
    pub fn drawn(random: &mut Random) -> Self {
        let lightest = random.wide(1e-3, 1.0);
        let softest = random.wide(1e2, 1e4);
        let ratio = |random: &mut Random, most: f64| {
            if random.chance(0.3) { 1.0 } else { random.wide(1.0, most) }
        };
        let stiffest = softest * ratio(random, STIFFNESS_RATIO);
        let load = random.wide(1.0, 1e3);
        let middle = (softest * stiffest).sqrt();
        Self {
            mass: [lightest, lightest * ratio(random, MASS_RATIO)],
            stiffness: [softest, stiffest],
            load,
            velocity: random.wide(1e-4, 3.0),
            displacement: load / middle * random.wide(1e-3, 10.0),
        }
    }

    pub fn mass(&self, random: &mut Random) -> f64 {
        random.wide(self.mass[0], self.mass[1])
    }

    pub fn stiffness(&self, random: &mut Random) -> f64 {
        random.wide(self.stiffness[0], self.stiffness[1])
    }
}

/// Initial motion of the masses of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// At rest in the equilibrium.
    Rest,
    /// Anywhere outside the surfaces, with any velocity.
    Anywhere,
    /// With a velocity alone, into the surface or off it.
    Kick,
}

impl Initial {
    pub fn drawn(random: &mut Random) -> Self {
        [Self::Rest, Self::Anywhere, Self::Kick][random.whole(0, 2)]
    }

    /// A displacement and a velocity of a mass that may move freely.
    pub fn values(self, random: &mut Random, sizes: &Sizes) -> [f64; 2] {
        let velocity = |random: &mut Random| {
            let value = sizes.velocity * random.between(-1.0, 1.0);
            if random.chance(0.7) { value } else { 0.0 }
        };
        match self {
            Self::Rest => [0.0; 2],
            Self::Anywhere => {
                let displacement = sizes.displacement * random.between(-1.0, 1.0);
                let is_moved = random.chance(0.7);
                [if is_moved { displacement } else { 0.0 }, velocity(random)]
            }
            Self::Kick => [0.0, velocity(random)],
        }
    }
}

/// Makes the scene a ring of that many modules.
pub fn fill(random: &mut Random, scene: &mut Scene, modules: usize) {
    scene.slider.angle = if random.chance(0.3) { 0.0 } else { random.between(-1.2, 1.2) };
    scene.effects.links = random.chance(0.8);
    scene.effects.preload = true;
    let sizes = Sizes::drawn(random);
    let initial = Initial::drawn(random);
    let are_equal = random.chance(0.3);
    let first = module(random, scene, &sizes);
    let all = (0..modules).map(|_| {
        let module = if are_equal { first } else { module(random, scene, &sizes) };
        started(random, scene, module, initial, &sizes)
    });
    scene.structure = Structure::Ring(all.collect());
}

fn module(random: &mut Random, scene: &Scene, sizes: &Sizes) -> Module {
    let mut stiffness = [0.0; 6];
    for (place, value) in stiffness.iter_mut().enumerate() {
        if place > 1 || scene.effects.links {
            *value = sizes.stiffness(random);
        }
    }
    Module {
        mass: [sizes.mass(random), sizes.mass(random)],
        stiffness,
        // It presses with about the load of the scene.
        preload: sizes.load / stiffness[2] * random.between(0.2, 2.0),
        force: [0.0; 4],
        displacement: [0.0; 4],
        velocity: [0.0; 4],
    }
}

fn started(
    random: &mut Random,
    scene: &Scene,
    mut module: Module,
    initial: Initial,
    sizes: &Sizes,
) -> Module {
    for place in 0..4 {
        let [displacement, velocity] = initial.values(random, sizes);
        (module.displacement[place], module.velocity[place]) = (displacement, velocity);
    }
    module.displacement[3] = module.displacement[3].max(0.0);
    if !scene.effects.detachment {
        (module.displacement[3], module.velocity[3]) = (0.0, 0.0);
    }
    module
}
