//! The scene file as its user writes it (TOML), turned into a [`Scene`].

use super::per_module::PerModule;
#[cfg(not(feature = "tools"))]
use super::problem;
use super::{Damping, Experiment, MAX_MODULES, Module, Problem, Scene, Slider, text};
#[cfg(feature = "tools")]
use super::{Rule, located};
use crate::Error;
use serde::Deserialize;
use std::path::Path;

/// A scene of Amontons: a ring of modules in frictional contact with a moving slider. SI units.
#[derive(Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct File {
    /// One line for people.
    #[serde(default)]
    description: String,
    slider: Slider,
    friction: Friction,
    #[serde(default)]
    damping: Damping,
    ring: Ring,
    /// Perturbations of the equilibrium, one a module.
    #[serde(default)]
    initial: Vec<Initial>,
    integrator: Integrator,
    #[serde(default)]
    experiment: Experiment,
}

/// Coulomb friction between the slider and every mass m2.
#[derive(Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Friction {
    /// Friction coefficient µ of every contact.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::FRICTION.bounds()))]
    coefficient: f64,
}

/// How time goes on.
#[derive(Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Integrator {
    /// Internal time step h, s.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::TIME.bounds()))]
    step: f64,
}

/// The ring of modules; each value once for all modules, or a list with one a module.
#[derive(Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Ring {
    /// How many modules.
    #[cfg_attr(feature = "tools", schemars(range(min = 1, max = MAX_MODULES)))]
    modules: usize,
    /// Mass m1, kg.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::MASS.bounds()))]
    m1: PerModule,
    /// Mass m2, which rubs on the slider, kg.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::MASS.bounds()))]
    m2: PerModule,
    /// Stiffness from m1 to the next m1, horizontal, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k1: PerModule,
    /// Stiffness from m1 to the next m1, vertical, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k2: PerModule,
    /// Stiffness from m1 to ground, vertical, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k3: PerModule,
    /// Stiffness from m1 to ground, horizontal, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k4: PerModule,
    /// Stiffness from m1 to m2, vertical, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k5: PerModule,
    /// Stiffness from m1 to m2, horizontal, N/m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::STIFFNESS.bounds()))]
    k6: PerModule,
    /// Preload: how far the ground end of k3 is moved down, m.
    preload: PerModule,
}

/// An initial displacement or velocity of one module, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Initial {
    /// The module, counted from 1.
    #[cfg_attr(feature = "tools", schemars(range(min = 1, max = MAX_MODULES)))]
    module: usize,
    /// Displacement of m1, horizontal, m.
    #[serde(default)]
    x1: f64,
    /// Displacement of m1, vertical, m.
    #[serde(default)]
    x2: f64,
    /// Displacement of m2 along the slider, m.
    #[serde(default)]
    x3: f64,
    /// Displacement of m2 away from the slider, m.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::GAP.bounds()))]
    #[serde(default)]
    x4: f64,
    /// Velocity of x1, m/s.
    #[serde(default)]
    v1: f64,
    /// Velocity of x2, m/s.
    #[serde(default)]
    v2: f64,
    /// Velocity of x3, m/s.
    #[serde(default)]
    v3: f64,
    /// Velocity of x4, m/s.
    #[serde(default)]
    v4: f64,
}

/// Reads and checks a scene file; its name becomes the file's stem.
///
/// # Errors
/// Everything that is wrong with the file, each with its line and column (with the feature
/// `tools`), key, and what would be right.
pub fn read(path: &Path) -> Result<(Scene, String), Error> {
    let place = path.display().to_string();
    let text = text::decode(&place, std::fs::read(path).map_err(|e| Error::file(path, &e))?)?;
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let scene = parse_at(&name, &place, &text)?;
    Ok((scene, text))
}

/// Makes a scene from the text of a scene file.
///
/// # Errors
/// As [`read`], with the scene's name for the file's.
pub fn parse(name: &str, text: &str) -> Result<Scene, Error> {
    parse_at(name, name, text)
}

#[cfg(feature = "tools")]
fn parse_at(name: &str, place: &str, text: &str) -> Result<Scene, Error> {
    located::read(place, text, |file: File| file.scene(name))
}

#[cfg(not(feature = "tools"))]
fn parse_at(name: &str, place: &str, text: &str) -> Result<Scene, Error> {
    let in_file = |error: &dyn std::fmt::Display| Error::scene(format!("in {place}:\n{error}"));
    let file: File =
        toml::from_str(text).map_err(|error| in_file(&error.to_string().trim_end()))?;
    file.scene(name).map_err(|problems| in_file(&problem::error(&problems)))
}

/// The JSON Schema of scene files, for editors; [`read`] holds files to the same.
#[cfg(feature = "tools")]
#[must_use]
pub fn schema() -> String {
    format!("{:#}\n", located::schema::<File>())
}

/// What is wrong with a ring of so many modules.
pub(super) fn not_a_ring(modules: usize) -> Problem {
    Problem::new("ring.modules", format!("a ring has 1 to {MAX_MODULES} modules")).of(modules)
}

impl File {
    /// The scene, or everything that is wrong with it.
    fn scene(self, name: &str) -> Result<Scene, Vec<Problem>> {
        let mut modules = self.ring.modules()?;
        let mut problems = Vec::new();
        for (i, initial) in self.initial.iter().enumerate() {
            let mut refuse = |message: String, help: &str| {
                let path = format!("initial[{}].module", i + 1);
                problems.push(Problem::new(path, message).of(initial.module).help(help));
            };
            let count = modules.len();
            if self.initial[..i].iter().any(|other| other.module == initial.module) {
                refuse("stands twice".to_owned(), "give all its values in one [[initial]]");
            } else if let Some(module) = modules.get_mut(initial.module.wrapping_sub(1)) {
                initial.apply(module);
            } else {
                refuse(format!("the ring has modules 1 to {count}"), "");
            }
        }
        let scene = Scene {
            name: name.to_owned(),
            description: self.description,
            slider: self.slider,
            friction_coefficient: self.friction.coefficient,
            damping: self.damping,
            modules,
            step: self.integrator.step,
            experiment: self.experiment,
        };
        problems.extend(scene.problems().into_iter().map(|problem| {
            let path = key_of(&problem.path, &self.initial).unwrap_or(problem.path);
            Problem { path, ..problem }
        }));
        if problems.is_empty() { Ok(scene) } else { Err(problems) }
    }
}

/// The key of the file that a variable of a module comes from, if it has another name there:
/// `module[2].m1` comes from `ring.m1[2]`, `initial.module[2].x4` from the `[[initial]]` of module 2.
fn key_of(variable: &str, initial: &[Initial]) -> Option<String> {
    let (table, rest) = variable.split_once("module[")?;
    let (module, key) = rest.split_once("].")?;
    if table.is_empty() {
        return Some(format!("ring.{key}[{module}]"));
    }
    let module: usize = module.parse().ok()?;
    let index = initial.iter().position(|initial| initial.module == module)?;
    Some(format!("initial[{}].{key}", index + 1))
}

impl Ring {
    fn modules(&self) -> Result<Vec<Module>, Vec<Problem>> {
        if self.modules == 0 || self.modules > MAX_MODULES {
            return Err(vec![not_a_ring(self.modules)]);
        }
        let keys = [
            ("m1", &self.m1),
            ("m2", &self.m2),
            ("k1", &self.k1),
            ("k2", &self.k2),
            ("k3", &self.k3),
            ("k4", &self.k4),
            ("k5", &self.k5),
            ("k6", &self.k6),
            ("preload", &self.preload),
        ];
        let wrong_length = |(key, values): (&str, &PerModule)| {
            let length = values.length().filter(|&length| length != self.modules)?;
            let values = if length == 1 { "value" } else { "values" };
            let message =
                format!("lists {length} {values}, but the ring has {} modules", self.modules);
            let help = "give one number for all, or one a module";
            Some(Problem::new(format!("ring.{key}"), message).help(help))
        };
        let problems: Vec<Problem> = keys.into_iter().filter_map(wrong_length).collect();
        if !problems.is_empty() {
            return Err(problems);
        }
        let module = |i: usize| {
            let [m1, m2, k1, k2, k3, k4, k5, k6, preload] =
                keys.map(|(_, values)| values.of(i).expect("the lengths were just checked"));
            Module {
                mass: [m1, m2],
                stiffness: [k1, k2, k3, k4, k5, k6],
                preload,
                force: [0.0; 4],
                displacement: [0.0; 4],
                velocity: [0.0; 4],
            }
        };
        Ok((0..self.modules).map(module).collect())
    }
}

impl Initial {
    fn apply(&self, module: &mut Module) {
        module.displacement = [self.x1, self.x2, self.x3, self.x4];
        module.velocity = [self.v1, self.v2, self.v3, self.v4];
    }
}
