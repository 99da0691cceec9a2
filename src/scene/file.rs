//! The scene file as its user writes it (TOML), turned into a [`Scene`].

use super::network_file::{self, ContactTable, DamperTable, MassTable, SpringTable};
use super::{Damping, Experiment, Scene, Slider, Structure, ring_file};
use crate::Error;
use serde::Deserialize;
use std::collections::HashSet;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    description: String,
    slider: Option<Slider>,
    friction: Option<Friction>,
    #[serde(default)]
    damping: Damping,
    ring: Option<ring_file::Ring>,
    #[serde(default)]
    mass: Vec<MassTable>,
    #[serde(default)]
    spring: Vec<SpringTable>,
    #[serde(default)]
    damper: Vec<DamperTable>,
    #[serde(default)]
    contact: Vec<ContactTable>,
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

/// An initial displacement or velocity, relative to the equilibrium: of a module of a ring (x1 … v4)
/// or of a mass of a network (x … vy).
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Initial {
    pub(super) module: Option<usize>,
    pub(super) mass: Option<String>,
    x1: Option<f64>,
    x2: Option<f64>,
    x3: Option<f64>,
    x4: Option<f64>,
    v1: Option<f64>,
    v2: Option<f64>,
    v3: Option<f64>,
    v4: Option<f64>,
    x: Option<f64>,
    y: Option<f64>,
    vx: Option<f64>,
    vy: Option<f64>,
}

impl Initial {
    /// Displacements and velocities of a module.
    pub(super) fn of_module(&self) -> [[Option<f64>; 4]; 2] {
        [[self.x1, self.x2, self.x3, self.x4], [self.v1, self.v2, self.v3, self.v4]]
    }

    /// Displacements, then velocities, of a mass along its axes.
    pub(super) fn along_axes(&self) -> [Option<f64>; 4] {
        [self.x, self.y, self.vx, self.vy]
    }

    /// Whose it is.
    fn owner(&self) -> String {
        match (&self.module, &self.mass) {
            (Some(module), _) => format!("module = {module}"),
            (None, Some(mass)) => format!("mass = \"{mass}\""),
            (None, None) => String::new(),
        }
    }
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
    let mut owners = HashSet::new();
    for owner in file.initial.iter().map(Initial::owner) {
        if owners.contains(&owner) {
            return Err(Error::scene(format!(
                "initial.{owner} stands twice; give all its values in one [[initial]]"
            )));
        }
        owners.insert(owner);
    }
    let structure = file.structure()?;
    let slider = file.slider.or_else(|| structure_needs_no_slider(&structure));
    let friction = file.friction.as_ref().map(|friction| friction.coefficient);
    let friction = friction.or_else(|| structure_needs_no_friction(&structure));
    let missing = |table: &str, keys: &str| {
        Error::scene(format!(
            "[{table}] is missing; it gives {keys} of the contacts without own ones"
        ))
    };
    let scene = Scene {
        name: name.to_owned(),
        slider: slider.ok_or_else(|| missing("slider", "velocity and angle"))?,
        friction_coefficient: friction.ok_or_else(|| missing("friction", "the coefficient"))?,
        damping: file.damping,
        structure,
        step: file.integrator.step,
        experiment: file.experiment,
        description: file.description,
    };
    scene.check()?;
    Ok(scene)
}

impl File {
    fn structure(&self) -> Result<Structure, Error> {
        let network = [self.mass.len(), self.spring.len(), self.damper.len(), self.contact.len()];
        match &self.ring {
            Some(_) if network != [0; 4] => Err(Error::scene(
                "a scene is either a [ring] or a network of [[mass]], [[spring]], [[damper]] and \
                 [[contact]], not both",
            )),
            Some(ring) => {
                let mut modules = ring.modules()?;
                self.initial
                    .iter()
                    .try_for_each(|values| ring_file::apply(values, &mut modules))?;
                Ok(Structure::Ring(modules))
            }
            None if self.mass.is_empty() => Err(Error::scene(
                "a scene needs a structure: a [ring], or the [[mass]]es of a network",
            )),
            None => {
                let tables =
                    (&self.mass[..], &self.spring[..], &self.damper[..], &self.contact[..]);
                Ok(Structure::Network(network_file::network(tables, &self.initial)?))
            }
        }
    }
}

/// A slider that nothing rubs on, where all contacts have own values.
fn structure_needs_no_slider(structure: &Structure) -> Option<Slider> {
    let Structure::Network(network) = structure else { return None };
    let independent = |c: &super::RubbingPlace| c.angle.is_some() && c.velocity.is_some();
    network.contacts.iter().all(independent).then_some(Slider { velocity: 0.0, angle: 0.0 })
}

/// A friction coefficient that no contact has, where all have own ones.
fn structure_needs_no_friction(structure: &Structure) -> Option<f64> {
    let Structure::Network(network) = structure else { return None };
    network.contacts.iter().all(|contact| contact.friction.is_some()).then_some(0.0)
}
