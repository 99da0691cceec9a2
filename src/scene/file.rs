//! The scene file as its user writes it (TOML), turned into a [`Scene`].

use super::per_module::PerModule;
use super::{Damping, Experiment, MAX_MODULES, Module, Scene, Slider};
use crate::Error;
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    description: String,
    slider: Slider,
    friction: Friction,
    #[serde(default)]
    damping: Damping,
    ring: Ring,
    #[serde(default)]
    initial: Vec<Initial>,
    integrator: Integrator,
    #[serde(default)]
    experiment: Experiment,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Friction {
    coefficient: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Integrator {
    step: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ring {
    modules: usize,
    m1: PerModule,
    m2: PerModule,
    k1: PerModule,
    k2: PerModule,
    k3: PerModule,
    k4: PerModule,
    k5: PerModule,
    k6: PerModule,
    preload: PerModule,
}

/// An initial displacement or velocity of one module, relative to the equilibrium.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Initial {
    module: usize,
    #[serde(default)]
    x1: f64,
    #[serde(default)]
    x2: f64,
    #[serde(default)]
    x3: f64,
    #[serde(default)]
    x4: f64,
    #[serde(default)]
    v1: f64,
    #[serde(default)]
    v2: f64,
    #[serde(default)]
    v3: f64,
    #[serde(default)]
    v4: f64,
}

/// Reads and checks a scene file; its name becomes the file's stem.
///
/// # Errors
/// The file, the line where the text itself is wrong, the key, and what would be right.
pub fn read(path: &Path) -> Result<(Scene, String), Error> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        if error.kind() == std::io::ErrorKind::InvalidData {
            Error::scene(format!("{} is not a text file; give a scene file", path.display()))
        } else {
            Error::file(path, &error)
        }
    })?;
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let scene = parse(&name, &text)
        .map_err(|error| Error::scene(format!("in {}:\n{error}", path.display())))?;
    Ok((scene, text))
}

/// Makes a scene from the text of a scene file.
///
/// # Errors
/// As [`read`], without the file's name.
pub fn parse(name: &str, text: &str) -> Result<Scene, Error> {
    let file: File =
        toml::from_str(text).map_err(|error| Error::scene(error.to_string().trim_end()))?;
    let mut modules = file.ring.modules()?;
    for (i, initial) in file.initial.iter().enumerate() {
        if file.initial[..i].iter().any(|other| other.module == initial.module) {
            return Err(Error::scene(format!(
                "initial.module = {} stands twice; give all its values in one [[initial]]",
                initial.module
            )));
        }
        initial.apply(&mut modules)?;
    }
    let scene = Scene {
        name: name.to_owned(),
        description: file.description,
        slider: file.slider,
        friction_coefficient: file.friction.coefficient,
        damping: file.damping,
        modules,
        step: file.integrator.step,
        experiment: file.experiment,
    };
    scene.check()?;
    Ok(scene)
}

impl Ring {
    fn modules(&self) -> Result<Vec<Module>, Error> {
        if self.modules == 0 || self.modules > MAX_MODULES {
            return Err(Error::scene(format!(
                "ring.modules = {}: a ring has 1 to {MAX_MODULES} modules",
                self.modules
            )));
        }
        let value = |key: &str, values: &PerModule, i: usize| match values.length() {
            Some(length) if length != self.modules => Err(Error::scene(format!(
                "ring.{key} lists {length} values, but the ring has {} modules; \
                 give one number for all, or one a module",
                self.modules
            ))),
            _ => Ok(values.of(i).expect("the length was just checked")),
        };
        (0..self.modules)
            .map(|i| {
                Ok(Module {
                    mass: [value("m1", &self.m1, i)?, value("m2", &self.m2, i)?],
                    stiffness: [
                        value("k1", &self.k1, i)?,
                        value("k2", &self.k2, i)?,
                        value("k3", &self.k3, i)?,
                        value("k4", &self.k4, i)?,
                        value("k5", &self.k5, i)?,
                        value("k6", &self.k6, i)?,
                    ],
                    preload: value("preload", &self.preload, i)?,
                    force: [0.0; 4],
                    displacement: [0.0; 4],
                    velocity: [0.0; 4],
                })
            })
            .collect()
    }
}

impl Initial {
    fn apply(&self, modules: &mut [Module]) -> Result<(), Error> {
        let count = modules.len();
        let module =
            self.module.checked_sub(1).and_then(|i| modules.get_mut(i)).ok_or_else(|| {
                Error::scene(format!(
                    "initial.module = {}: the ring has modules 1 to {count}",
                    self.module
                ))
            })?;
        let displacement = [self.x1, self.x2, self.x3, self.x4];
        let velocity = [self.v1, self.v2, self.v3, self.v4];
        for j in 0..4 {
            module.displacement[j] += displacement[j];
            module.velocity[j] += velocity[j];
        }
        Ok(())
    }
}
