//! The scenes whose FMUs are called, and what a host knows of them from the model description.

use amontons::scene::{builtin, parse};
use amontons::simulation::catalogue::{Causality, Kind, Variability, fmu_variables};
use amontons::simulation::{Parameters, Variable, fingerprint};
use std::ffi::CString;
use tempfile::TempDir;

/// An FMU's resources, and its variables by what may be done with them.
pub struct Scene {
    _folder: TempDir,
    pub location: CString,
    pub guid: CString,
    /// The start values by value reference; 0 for an output.
    pub start: Vec<f64>,
    pub reals: Vec<u32>,
    pub integers: Vec<u32>,
    pub boolean: u32,
    pub inputs: Vec<u32>,
    pub tunable: Vec<u32>,
    pub fixed: Vec<u32>,
    pub outputs: Vec<u32>,
    /// Reals that may not be below zero.
    pub bounded: Vec<u32>,
    /// The internal step, a parameter.
    pub step: u32,
    /// Index of the scene whose states this one must refuse.
    pub other: usize,
}

impl Scene {
    fn new(text: &str, other: usize) -> Self {
        let scene = parse("scene", text).expect("it is a scene");
        let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("there is room");
        std::fs::write(folder.path().join("scene.toml"), text).expect("there is room");
        let location = format!("file://{}", folder.path().display());
        let variables = fmu_variables(&scene);
        let references = |wanted: &dyn Fn(&&Variable) -> bool| -> Vec<u32> {
            (0_u32..).zip(&variables).filter(|(_, one)| wanted(one)).map(|(i, _)| i).collect()
        };
        let is_real = |kind: Kind| matches!(kind, Kind::Real { .. });
        let parameter = |variability: Variability| {
            references(&|one: &&Variable| {
                is_real(one.template.kind)
                    && (one.causality, one.variability) == (Causality::Parameter, variability)
            })
        };
        let real = |causality: Causality| {
            references(&|one: &&Variable| is_real(one.template.kind) && one.causality == causality)
        };
        let start = Parameters::of(scene);
        Self {
            location: CString::new(location).expect("it has no zeros"),
            guid: CString::new(fingerprint(&text.into())).expect("it has no zeros"),
            start: variables.iter().map(|one| start.get(one).unwrap_or(0.0)).collect(),
            reals: references(&|one| is_real(one.template.kind)),
            integers: references(&|one| {
                matches!(one.template.kind, Kind::Integer | Kind::Enumeration { .. })
            }),
            boolean: references(&|one| one.name == "strict")[0],
            inputs: real(Causality::Input),
            tunable: parameter(Variability::Tunable),
            fixed: parameter(Variability::Fixed),
            outputs: real(Causality::Output),
            bounded: references(&|one| {
                one.causality != Causality::Output
                    && matches!(one.template.kind, Kind::Real { min: Some(_), .. })
            }),
            step: references(&|one| one.name == "integrator.step")[0],
            other,
            _folder: folder,
        }
    }
}

/// Relative frequencies with which the scenes are drawn: initialization checks the step of the first one at length.
pub const WEIGHTS: [u32; 6] = [1, 6, 6, 6, 6, 6];

/// Set 1, a stick-slip belt, and a block that is dropped, with static friction, a signal and an energy ledger; of each
/// both integrators.
pub fn all() -> Vec<Scene> {
    let with = |text: &str, method: &str, step: &str| {
        let rest = text.split("[integrator]").collect::<Vec<_>>();
        let after = rest[1].split_once("\n\n").expect("more follows").1;
        format!("{}[integrator]\nmethod = \"{method}\"\nstep = {step}\n\n{after}", rest[0])
    };
    let [set1, belt] = ["set1", "belt"].map(|name| builtin(name).expect("it is built in").text);
    let energy = include_str!("../../../../scenes/effects/energy.toml");
    // With a damper the paper's scheme looks for its critical step at such length that little else would be tried.
    let (before, rest) = energy.split_once("[[damper]]").expect("it has one");
    let (_, after) = rest.split_once("\n\n").expect("more follows");
    let undamped = format!("{before}{after}");
    vec![
        Scene::new(&with(set1, "forward-increment", "1e-6"), 2),
        Scene::new(&with(set1, "event-driven", "1e-5"), 5),
        Scene::new(&with(belt, "forward-increment", "2.5e-4"), 4),
        Scene::new(&with(belt, "event-driven", "1e-2"), 4),
        Scene::new(&with(&undamped, "forward-increment", "1e-4"), 3),
        Scene::new(&with(energy, "event-driven", "1e-2"), 1),
    ]
}
