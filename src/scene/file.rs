//! The scene file as its user writes it (TOML), turned into a [`Scene`].

#[cfg(feature = "schema")]
use super::Rule;
use super::contact_set_file::ContactSetTable;
use super::effects_file::EffectsTable;
use super::friction_file::FrictionTable;
use super::homes::{Homes, contact_path, needs};
use super::initial_file::{self, Initial};
use super::integrator_file::IntegratorTable;
use super::load_file::LoadTable;
use super::names::Names;
use super::network_file::{ContactTable, DamperTable, MassTable, SpringTable, Tables};
use super::outputs_file::OutputsTable;
use super::problem;
use super::signal_file::{self, SignalTable};
use super::source::{Folder, Source};
use super::superelement_file::{SuperelementTable, superelements};
use super::{
    Damping, Effects, Experiment, Problem, Roles, Scene, Slider, Structure, Superelement,
    ring_file, text,
};
use crate::Error;
use crate::contact::Law;
use serde::Deserialize;
use std::collections::HashMap;
use std::fmt;
use std::path::Path;

/// A scene of Amontons: a ring of modules, or a network of masses and superelements, in frictional contact with a moving
/// slider; SI units.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "File"))]
#[cfg_attr(feature = "schema", schemars(extend(
    "oneOf" = [
        { "required": ["ring"] },
        { "required": ["mass"], "not": { "required": ["superelement"] } },
        { "required": ["mass", "superelement"] },
        { "required": ["superelement"], "not": { "required": ["mass"] } },
    ],
    "dependencies" = {
        "ring": ["slider", "friction"],
    },
)))]
#[serde(deny_unknown_fields)]
pub struct SceneTables {
    /// Description of the scene in one line.
    #[serde(default)]
    description: String,
    /// The rigid slider.
    ///
    /// The table may be left out if every contact has its own angle and velocity.
    slider: Option<Slider>,
    /// The law of friction and its coefficients.
    ///
    /// The table may be left out if every contact has its own friction coefficient.
    friction: Option<FrictionTable>,
    #[serde(default)]
    damping: DampingTable,
    #[serde(default)]
    effects: EffectsTable,
    #[serde(default)]
    inputs: Roles,
    /// The ring of modules; each value is one number for all modules, or a list with one number for each module.
    ring: Option<ring_file::Ring>,
    /// The masses of a network.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(default)]
    mass: Vec<MassTable>,
    /// The superelements of a network: structures as matrices.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(default)]
    superelement: Vec<SuperelementTable>,
    /// The springs of a network.
    #[serde(default)]
    spring: Vec<SpringTable>,
    /// The discrete dampers of a network.
    #[serde(default)]
    damper: Vec<DamperTable>,
    /// The contacts of a network.
    #[serde(default)]
    contact: Vec<ContactTable>,
    /// Sets of contacts of the nodes of superelements.
    #[serde(default)]
    contact_set: Vec<ContactSetTable>,
    /// Constant forces on nodes of superelements.
    #[serde(default)]
    load: Vec<LoadTable>,
    /// Parts of superelements and contacts that the FMU shows.
    #[serde(default)]
    outputs: OutputsTable,
    /// Initial displacements and velocities relative to the equilibrium, one table for each module, mass, node or mode.
    #[serde(default)]
    initial: Vec<Initial>,
    /// Signals: values over time that are added to inputs.
    #[serde(default)]
    signal: Vec<SignalTable>,
    integrator: IntegratorTable,
    #[serde(default)]
    experiment: Experiment,
}

/// Rayleigh damping, C = α M + β K.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct DampingTable {
    /// Mass-proportional damping coefficient α, 1/s; none by default.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    alpha: Option<f64>,
    /// Stiffness-proportional damping coefficient β, s; none by default.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::DAMPING.bounds()))]
    beta: Option<f64>,
}

/// A scene file whose text has been read but not parsed.
pub struct SceneFile<'a> {
    /// Name of the scene: the file's stem.
    pub name: String,
    /// Path of the file, as shown in messages.
    pub place: String,
    /// Text of the file.
    pub text: String,
    /// Folder of the files that the scene names.
    pub folder: Folder<'a>,
}

impl<'a> SceneFile<'a> {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, is not a text, or is larger than the limit of scene files.
    pub fn open(path: &'a Path) -> Result<Self, Error> {
        let place = path.display().to_string();
        let bytes = text::read(path, text::MAX_SCENE).map_err(|error| Error::file(path, &error))?;
        let bytes = bytes.ok_or_else(|| {
            Error::scene(format!(
                "{place} is larger than {}, the limit for scene files; put values over time into a CSV file beside it",
                text::megabytes(text::MAX_SCENE)
            ))
        })?;
        let text = text::decode(&place, "a scene file (TOML)", bytes)?;
        text::check_amount(&place, &text)?;
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        Ok(Self { name, place, text, folder: Folder::new(path.parent()) })
    }

    /// A scene text that names no other files; messages show the scene's name as the file.
    #[must_use]
    pub fn of(name: &str, text: &str) -> Self {
        let [name, place, text] = [name, name, text].map(str::to_owned);
        Self { name, place, text, folder: Folder::new(None) }
    }

    /// Parses and checks the scene.
    ///
    /// # Errors
    /// Returns an error if the text is not TOML, has an unknown key or lacks one (the first such place), or if values
    /// are impossible (all of them). To report all of these with line numbers, a reader deserializes [`SceneTables`]
    /// itself.
    pub fn scene(&mut self) -> Result<Scene, Error> {
        let in_file =
            |error: &dyn fmt::Display| Error::scene(format!("in {}:\n{error}", self.place));
        let tables: SceneTables =
            toml::from_str(&self.text).map_err(|error| in_file(&error.to_string().trim_end()))?;
        let mut problems = tables.unlike_schema();
        match tables.scene(&self.name, &mut self.folder) {
            Ok(scene) if problems.is_empty() => return Ok(scene),
            Ok(_) => {}
            Err(found) => problems.extend(found),
        }
        Err(in_file(&problem::error(&problems)))
    }

    /// Returns the text of the file, those of the CSV files that its scene named, and its packed superelements.
    #[must_use]
    pub fn into_source(self) -> Source {
        Source { text: self.text, tables: self.folder.texts, binaries: self.folder.binaries }
    }
}

/// Reads and checks a scene file; the scene's name is the file's stem.
///
/// # Errors
/// Returns an error if the file cannot be read ([`SceneFile::open`]), or does not describe a scene ([`SceneFile::scene`]).
pub fn read(path: &Path) -> Result<(Scene, Source), Error> {
    let mut file = SceneFile::open(path)?;
    let scene = file.scene()?;
    Ok((scene, file.into_source()))
}

/// Makes a scene from the text of a scene file that names no other files.
///
/// # Errors
/// Returns the errors of [`SceneFile::scene`]; messages show the scene's name as the file's.
pub fn parse(name: &str, text: &str) -> Result<Scene, Error> {
    SceneFile::of(name, text).scene()
}

impl SceneTables {
    /// Reports scenes that the JSON Schema of scene files rejects although the types of the tables accept them.
    #[must_use]
    pub fn unlike_schema(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        match (&self.ring, self.is_network()) {
            (Some(_), true) => {
                let key = if self.mass.is_empty() { "superelement" } else { "mass" };
                let message = format!("a scene has either a [ring] or [[{key}]], not both");
                problems.push(Problem::new(key, message));
            }
            (None, false) => {
                let message = "a scene needs a [ring], or [[mass]] or [[superelement]]";
                problems.push(Problem::new("mass", message));
            }
            (Some(ring), false) => problems.extend(ring.lone_link()),
            (None, true) => {}
        }
        problems.extend(self.friction.as_ref().and_then(FrictionTable::unknown_law));
        problems.extend(signal_file::without_one_shape(&self.signal));
        let all = self.superelement.iter().enumerate();
        problems.extend(all.filter_map(|(i, table)| table.unlike_schema(i)));
        let all = self.contact_set.iter().enumerate();
        problems.extend(all.filter_map(|(i, table)| table.unlike_schema(i)));
        let all = self.load.iter().enumerate();
        problems.extend(all.filter_map(|(i, table)| table.unlike_schema(i)));
        problems
    }

    fn is_network(&self) -> bool {
        !(self.mass.is_empty() && self.superelement.is_empty())
    }

    /// Makes the scene from tables that satisfy the schema ([`unlike_schema`](Self::unlike_schema) reports no
    /// problem); CSV files that they name are read from `folder`.
    ///
    /// # Errors
    /// Returns all other problems, each with its path through the file.
    pub fn scene(self, name: &str, folder: &mut Folder<'_>) -> Result<Scene, Vec<Problem>> {
        let effects = self.effects();
        let (superelements, unread) = match superelements(&self.superelement, folder) {
            Ok(superelements) => (superelements, None),
            Err(problems) => (Vec::new(), Some(problems)),
        };
        let masses = self.mass.iter().map(|mass| &*mass.name).collect();
        let mut names = Names::of(masses, &superelements);
        let made = unread.map_or_else(|| self.structure(&mut names, &superelements, folder), Err);
        let (mut structure, broken) = match made {
            Ok(structure) => (structure, None),
            Err(problems) => (Structure::Ring(Vec::new()), Some(problems)),
        };
        let homes = match broken {
            None => initial_file::apply(&self.initial, &mut structure, &mut names),
            Some(_) => HashMap::new(),
        };
        let homes = Homes::of(&structure, homes);
        let mut problems = names.problems;
        problems.extend(self.missing_tables(&structure));
        problems.extend(self.strangers());
        let friction_law =
            self.friction.as_ref().map_or(Law::Coulomb, |table| table.law(&mut problems));
        let signals = signal_file::signals(self.signal, folder, &mut problems);
        let (selection, method, step) = self.integrator.read(&mut problems);
        let friction = self.friction.unwrap_or_default();
        let scene = Scene {
            name: name.to_owned(),
            slider: self.slider.unwrap_or(Slider { velocity: 0.0, angle: 0.0 }),
            friction_law,
            friction_coefficient: friction.coefficient.unwrap_or(0.0),
            static_friction: friction.static_,
            stribeck_velocity: friction.stribeck_velocity,
            transverse_damping: friction.transverse_damping,
            damping: Damping {
                alpha: self.damping.alpha.unwrap_or(0.0),
                beta: self.damping.beta.unwrap_or(0.0),
            },
            effects,
            roles: self.inputs,
            structure,
            signals: signals.into(),
            selection,
            method: method.unwrap_or_default(),
            // Placeholder until the step is chosen; a step that is missing has been reported as a problem.
            step: step.unwrap_or(self.experiment.output_interval),
            experiment: self.experiment,
            description: self.description,
        };
        self.effects.check(scene.contact_count(), scene.friction_law, &mut problems);
        match broken {
            None => problems.extend(scene.problems_named(&|part, key| homes.key_of(part, key))),
            Some(broken) => problems.extend(broken.into_iter().chain(scene.common_problems())),
        }
        if problems.is_empty() { Ok(scene) } else { Err(problems) }
    }

    /// The effects that the file requests, in its own table or by giving values.
    fn effects(&self) -> Effects {
        Effects {
            mass_damping: self.damping.alpha.is_some(),
            stiffness_damping: self.damping.beta.is_some(),
            links: self.ring.as_ref().is_some_and(ring_file::Ring::has_links),
            preload: self.ring.as_ref().is_some_and(ring_file::Ring::has_preload),
            ..self.effects.effects()
        }
    }

    fn structure(
        &self,
        names: &mut Names<'_>,
        superelements: &[Superelement],
        folder: &mut Folder<'_>,
    ) -> Result<Structure, Vec<Problem>> {
        match &self.ring {
            // `unlike_schema` reports it.
            ring if ring.is_some() == self.is_network() => Err(Vec::new()),
            Some(ring) => Ok(Structure::Ring(ring.modules()?)),
            None => {
                let tables = Tables {
                    masses: &self.mass,
                    springs: &self.spring,
                    dampers: &self.damper,
                    contacts: &self.contact,
                };
                let mut network = tables.network(names);
                network.superelements = superelements.to_vec();
                let before = names.problems.len();
                for (i, set) in self.contact_set.iter().enumerate() {
                    set.add_to(i, &mut network, names, folder);
                }
                let lacks_contacts = names.problems.len() > before;
                for (i, load) in self.load.iter().enumerate() {
                    load.add_to(i, &mut network, names, folder);
                }
                // Contacts that are not there for another reason would be reported again wherever they are named.
                if lacks_contacts {
                    return Err(Vec::new());
                }
                self.outputs.apply(&mut network, names);
                Ok(Structure::Network(network))
            }
        }
    }

    /// Reports missing tables that a ring needs, or a contact of a network that has no values of its own.
    fn missing_tables(&self, structure: &Structure) -> Vec<Problem> {
        let tables = [
            ("slider", "`angle`, `velocity`", self.slider.is_none()),
            ("friction", "`friction`", self.friction.is_none()),
        ];
        let mut missing: Vec<_> =
            tables.into_iter().filter(|(.., is_missing)| *is_missing).collect();
        if self.ring.is_some() {
            return missing
                .iter()
                .map(|(table, ..)| Problem::new(*table, "the table is missing"))
                .collect();
        }
        let mut problems = Vec::new();
        let contacts = match structure {
            Structure::Ring(_) => &[][..],
            Structure::Network(network) => &network.contacts,
        };
        for (i, place) in contacts.iter().enumerate() {
            let (needed, rest): (Vec<_>, _) =
                missing.into_iter().partition(|(table, ..)| needs(place, table));
            missing = rest;
            if !needed.is_empty() {
                let names: Vec<String> =
                    needed.iter().map(|(name, ..)| format!("[{name}]")).collect();
                let keys: Vec<&str> = needed.iter().map(|(_, keys, _)| *keys).collect();
                let (names, keys) = (names.join(" and "), keys.join(", "));
                let message = format!("needs {names}, which the file does not contain");
                let help = format!("add {names}, or give every contact its own {keys}");
                let path = contact_path(i, place.set);
                problems.push(Problem::new(path, message).help(help));
            }
        }
        problems
    }

    /// Reports the first spring, damper and contact of a network in a scene that has a ring.
    fn strangers(&self) -> impl Iterator<Item = Problem> {
        let counts = [
            ("spring", self.spring.len()),
            ("damper", self.damper.len()),
            ("contact", self.contact.len()),
            ("contact_set", self.contact_set.len()),
            ("load", self.load.len()),
        ];
        let is_ring = self.ring.is_some() && !self.is_network();
        counts.into_iter().filter(move |(_, count)| is_ring && *count > 0).map(|(kind, _)| {
            Problem::new(format!("{kind}[1]"), "belongs to a network, but this scene has a [ring]")
                .help("leave it out, or write the whole scene as a network of [[mass]]")
        })
    }
}
