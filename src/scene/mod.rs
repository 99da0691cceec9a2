//! A scene: what the user wants simulated, as validated data.
//!
//! [`read`] and [`builtin`] give a [`Scene`]; [`Scene::check`] is the one place that says which
//! values are possible. No physics here.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `file` | the file as a whole |
//! | `ring`, `ring_file` | the paper's ring of modules; its part of a file |
//! | `network`, `network_check`, `network_file` | masses, springs, dampers and contacts by name |
//! | `rule` | what a value must be; the list of problems |
//! | `builtin` | the scenes that the program carries |

mod builtin;
mod file;
mod network;
mod network_check;
mod network_file;
mod per_module;
mod ring;
mod ring_file;
mod rule;

pub use builtin::{BUILTIN, Builtin, builtin, builtin_names, find};
pub use file::{parse, read};
pub use network::{Damper, GROUND, MAX_MASSES, Mass, Network, RubbingPlace, Spring, direction};
pub use ring::{MAX_MODULES, Module};

use crate::Error;
use rule::{Problems, Rule};
use serde::{Deserialize, Serialize};

/// The most rows of results that a run may have.
const MAX_ROWS: f64 = 1e9;

/// A structure in frictional contact, what drives it, and how it is run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its name: the stem of its file, or the built-in's name.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// The rigid slider, common to all contacts that give no own value.
    pub slider: Slider,
    /// Friction coefficient µ of every contact that has no own, ≥ 0.
    pub friction_coefficient: f64,
    /// Rayleigh damping, C = α M + β K.
    pub damping: Damping,
    /// Masses, springs and contacts.
    pub structure: Structure,
    /// Internal time step h, s.
    pub step: f64,
    /// What a run does unless told otherwise.
    pub experiment: Experiment,
}

/// Masses, springs and contacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Structure {
    /// The paper's ring of modules (section 3 and Fig. 1), each with one contact.
    Ring(Vec<Module>),
    /// Masses in a plane, joined in any way.
    Network(Network),
}

/// The rigid slider.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Velocity along the tangent t = (cos θ, sin θ), m/s; of either sign.
    pub velocity: f64,
    /// Inclination θ against the horizontal, rad.
    pub angle: f64,
}

/// Rayleigh damping, C = α M + β K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Damping {
    /// Mass-proportional part α, 1/s.
    pub alpha: f64,
    /// Stiffness-proportional part β, s.
    pub beta: f64,
}

/// What a run does unless told otherwise; FMI's DefaultExperiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Experiment {
    /// End of the run, s; it starts at 0.
    pub stop_time: f64,
    /// Time between two rows of results, s.
    pub output_interval: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, output_interval: 1e-3 }
    }
}

impl Scene {
    /// The modules of a ring; none in a network.
    #[must_use]
    pub fn modules(&self) -> &[Module] {
        match &self.structure {
            Structure::Ring(modules) => modules,
            Structure::Network(_) => &[],
        }
    }

    /// The modules of a ring, for code that knows that it has one.
    ///
    /// # Panics
    /// Where the scene is a network.
    pub fn modules_mut(&mut self) -> &mut Vec<Module> {
        match &mut self.structure {
            Structure::Ring(modules) => modules,
            Structure::Network(_) => panic!("{} is a network, it has no modules", self.name),
        }
    }

    /// The modules of a ring, for what knows rings only.
    ///
    /// # Errors
    /// The scene is a network; `what` is not to be had for it.
    pub fn require_ring(&self, what: &str) -> Result<&[Module], Error> {
        match &self.structure {
            Structure::Ring(modules) => Ok(modules),
            Structure::Network(_) => Err(Error::scene(format!(
                "{} is a network, and {what} so far for a [ring] only",
                self.name
            ))),
        }
    }

    /// The network, if it is one.
    #[must_use]
    pub fn network(&self) -> Option<&Network> {
        match &self.structure {
            Structure::Ring(_) => None,
            Structure::Network(network) => Some(network),
        }
    }

    /// Number of contacts.
    #[must_use]
    pub fn contact_count(&self) -> usize {
        match &self.structure {
            // Every module has one.
            Structure::Ring(modules) => modules.len(),
            Structure::Network(network) => network.contacts.len(),
        }
    }

    /// Has another scene the same parts, and so the same variables?
    #[must_use]
    pub fn has_parts_of(&self, other: &Self) -> bool {
        match (&self.structure, &other.structure) {
            (Structure::Ring(a), Structure::Ring(b)) => a.len() == b.len(),
            (Structure::Network(a), Structure::Network(b)) => a.has_parts_of(b),
            _ => false,
        }
    }

    /// The name of a contact (from 0): `contact[1]` in a ring, `contact.pad` in a network.
    #[must_use]
    pub fn contact_name(&self, contact: usize) -> String {
        match self.network().and_then(|network| network.contacts.get(contact)) {
            Some(place) => format!("contact.{}", place.name),
            None => format!("contact[{}]", contact + 1),
        }
    }

    /// The names of the degrees of freedom, in their order: `module[1].x1`, `mass.pad.x`.
    #[must_use]
    pub fn dof_names(&self) -> Vec<String> {
        let modules = (1..=self.modules().len())
            .flat_map(|i| (1..=4).map(move |j| format!("module[{i}].x{j}")));
        let masses = self.masses().iter().flat_map(|mass| {
            let name = |axis: &str| format!("mass.{}.{axis}", mass.name);
            mass.free([name("x"), name("y")])
        });
        modules.chain(masses).collect()
    }

    /// External forces, N, one a degree of freedom, in their order.
    pub fn external_forces(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.force));
        self.modules().iter().flat_map(|module| module.force).chain(masses)
    }

    /// Initial displacements from the equilibrium, m, one a degree of freedom, in their order.
    pub fn initial_displacements(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.displacement));
        self.modules().iter().flat_map(|module| module.displacement).chain(masses)
    }

    /// Initial velocities, m/s, one a degree of freedom, in their order.
    pub fn initial_velocities(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.velocity));
        self.modules().iter().flat_map(|module| module.velocity).chain(masses)
    }

    /// The masses of a network; none in a ring.
    fn masses(&self) -> &[Mass] {
        self.network().map_or(&[], |network| &network.masses)
    }

    /// Refuses impossible values, naming every one of them.
    ///
    /// # Errors
    /// One line a problem, up to twenty: the variable, its value, what would be right.
    pub fn check(&self) -> Result<(), Error> {
        let mut problems = Problems::default();
        let angle = match self.structure {
            Structure::Ring(_) => Rule::QuarterTurn,
            Structure::Network(_) => Rule::Finite,
        };
        let Experiment { stop_time, output_interval } = self.experiment;
        for (name, value, rule) in [
            ("slider.velocity", self.slider.velocity, Rule::Finite),
            ("slider.angle", self.slider.angle, angle),
            ("friction.coefficient", self.friction_coefficient, Rule::NotNegative),
            ("damping.alpha", self.damping.alpha, Rule::NotNegative),
            ("damping.beta", self.damping.beta, Rule::NotNegative),
            ("integrator.step", self.step, Rule::Positive),
            ("experiment.stop_time", stop_time, Rule::Positive),
            ("experiment.output_interval", output_interval, Rule::Positive),
        ] {
            problems.check(|| name.to_owned(), value, rule);
        }
        if stop_time / output_interval > MAX_ROWS {
            problems.add(format!(
                "experiment.output_interval = {output_interval}: gives more than {MAX_ROWS:e} rows \
                 up to experiment.stop_time = {stop_time}; choose a longer one"
            ));
        }
        match &self.structure {
            Structure::Ring(modules) => ring::check(modules, &mut problems),
            Structure::Network(network) => {
                network_check::check(network, self.slider, &mut problems);
            }
        }
        problems.into_result()
    }
}
