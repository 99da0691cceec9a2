//! The scenes whose motions are kept.

use amontons::scene::{Method, Scene, Source, read};
use amontons_export::scene::set_integrator;
use std::path::Path;

/// A scene, and the internal steps that it is run with.
pub struct Case {
    pub name: &'static str,
    /// Its file, below the root of the repository.
    file: &'static str,
    /// s, of the paper's scheme and of exact motion.
    steps: [f64; 2],
    /// Number of observations of a motion: the more doubles it has, the fewer.
    pub looks: u32,
    /// The end of the run, s, where it is not the scene's own.
    stop: Option<f64>,
}

const fn case(name: &'static str, file: &'static str, steps: [f64; 2], looks: u32) -> Case {
    Case { name, file, steps, looks, stop: None }
}

/// Together they have every law, effect, integrator and shape of signal: rings and networks, with inclined contacts,
/// several of one mass, and some between masses. All are shipped but the last.
pub const CASES: [Case; 13] = [
    case("set2", "scenes/set2.toml", [1e-6, 2e-4], 10),
    case("ring12", "scenes/ring12.toml", [1e-6, 2e-4], 1),
    case("den_hartog", "scenes/den_hartog.toml", [1e-4, 1e-2], 10),
    case("corner", "scenes/corner.toml", [5e-5, 5e-4], 10),
    case("disc_brake", "scenes/disc_brake.toml", [1e-6, 5e-5], 10),
    case("energy", "scenes/effects/energy.toml", [1e-4, 1e-2], 10),
    case("links", "scenes/effects/links.toml", [1e-4, 1e-2], 5),
    case("damping", "scenes/effects/damping.toml", [1e-4, 1e-2], 10),
    case("detachment", "scenes/effects/detachment.toml", [1e-4, 1e-2], 10),
    case("sticking", "scenes/effects/sticking.toml", [1e-4, 1e-2], 10),
    case("stribeck", "scenes/effects/stribeck.toml", [2e-5, 1e-3], 10),
    case("stability", "scenes/effects/stability.toml", [1e-3, 5e-2], 10),
    case("driven", "crates/cli/tests/golden/driven.toml", [1e-4, 1e-2], 10),
];

/// Hard ones, which have what the others have not: another solution than the one that the motion stays in, and hops that
/// are ended.
pub const HARD: [Case; 2] = [
    Case {
        stop: Some(0.1),
        ..case("two_solutions", "tests/hard_scenes/fi_leaves_equilibrium.toml", [1e-5, 1e-3], 2)
    },
    Case { stop: Some(0.05), ..case("disc", "tests/hard_scenes/disc_20.toml", [1e-5, 1e-3], 1) },
];

/// All whose motions are kept.
pub fn all() -> impl Iterator<Item = &'static Case> {
    CASES.iter().chain(&HARD)
}

impl Case {
    /// Reads the scene from the file.
    pub fn read(&self) -> (Scene, Source) {
        read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(self.file)).unwrap()
    }

    /// With each integrator, whether it takes the scene or not.
    pub fn runs(&self) -> impl Iterator<Item = Run> {
        let (mut scene, source) = self.read();
        scene.experiment.stop_time = self.stop.unwrap_or(scene.experiment.stop_time);
        let methods = [Method::ForwardIncrement, Method::EventDriven].into_iter().zip(self.steps);
        methods.map(move |(method, step)| {
            let mut source = source.clone();
            set_integrator(&mut source, method, step).unwrap();
            Run { scene: Scene { method, step, ..scene.clone() }, source }
        })
    }
}

/// A scene with one integrator.
pub struct Run {
    pub scene: Scene,
    pub source: Source,
}

impl Run {
    pub fn name(&self) -> String {
        format!("{}, step {:e} s", self.scene.method, self.scene.step)
    }

    /// The times (s) at which the motion is read: `count` of them, equally far apart, the last one at the end.
    pub fn times(&self, count: u32) -> impl Iterator<Item = f64> + use<> {
        let stop = self.scene.experiment.stop_time;
        (1..=count).map(move |i| stop * f64::from(i) / f64::from(count))
    }
}
