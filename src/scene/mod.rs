//! A scene: what the user wants simulated, as validated data.
//!
//! [`read`] and [`builtin`] give a [`Scene`]; [`Scene::check`] says which values are possible. No physics here.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `file`, `initial_file` | the file as a whole; its initial values |
//! | `friction_file` | the law of friction in a file |
//! | `effects`, `effects_file`, `effects_check` | what is simulated besides masses and springs; that part of a file |
//! | `selection`, `integrator_file` | method and step given, or a tolerance in their place; that part of a file |
//! | `roles`, `lack` | which values are inputs, which parameters; what a scene goes without |
//! | `ring`, `ring_file` | the paper's ring of modules; its part of a file |
//! | `network`, `network_check`, `network_file` | masses, springs, dampers and contacts by name |
//! | `signal`, `signal_file`, `time_table` | values over time that drive inputs |
//! | `source` | the files a scene is made from |
//! | `check`, `rule` | which scenes are possible, what a value must be |
//! | `problem` | what is wrong with a scene |
//! | `nearest`, `text` | a word that is nearly another; a file's text |
//! | `builtin` | the scenes that the program carries |

mod builtin;
mod check;
mod effects;
mod effects_check;
mod effects_file;
mod file;
mod friction_file;
mod initial_file;
mod integrator_file;
mod keys;
mod lack;
mod nearest;
mod network;
mod network_check;
mod network_file;
mod per_module;
mod problem;
mod ring;
mod ring_file;
mod roles;
mod rule;
mod selection;
mod signal;
mod signal_file;
mod source;
mod text;
mod time_table;

pub use builtin::{BUILTIN, Builtin, builtin, builtin_names, named};
pub use check::meant_input;
pub(crate) use check::{MAX_STEPS, count, least};
pub use effects::Effects;
pub use file::{SceneFile, SceneTables, parse, read};
pub use lack::Lack;
pub use nearest::{did_you_mean, nearest};
pub use network::{Damper, GROUND, MAX_PARTS, Mass, Network, RubbingPlace, Spring, direction};
pub use problem::{MAX_PROBLEMS, Problem, and_more};
pub use ring::{MAX_MODULES, Module};
pub(crate) use roles::Group;
pub use roles::{ForceRole, Role, Roles};
pub use rule::Rule;
pub use selection::{Preset, Selection};
pub use signal::{Between, Constant, Pulse, Ramp, Shape, Signal, Sine, Table};
pub use source::{Folder, Source};
pub use time_table::TimeTable;

pub use crate::integrator::Method;
pub use crate::model::Damping;

use crate::Error;
use crate::contact::{ContactLaw, Friction, Law};
use serde::Deserialize;
use std::sync::Arc;

/// A structure in frictional contact, what drives it, and how it is run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Its name: the stem of its file, or the built-in's name.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// The rigid slider, common to all contacts that give no own value.
    pub slider: Slider,
    /// The law of friction; Coulomb's with static friction is that of static and kinetic friction
    /// ([`contact_law`](Self::contact_law)).
    pub friction_law: Law,
    /// Friction coefficient µ of every contact that has no own, ≥ 0.
    pub friction_coefficient: f64,
    /// Static friction coefficient µ_s ≥ µ, of every contact that does not slip and has neither
    /// coefficient of its own; as µ where there is none.
    pub static_friction: Option<f64>,
    /// v_s > 0, m/s: the slip velocity over which µ falls from µ_s towards µ, of a law that has one.
    pub stribeck_velocity: Option<f64>,
    /// Rayleigh damping, C = α M + β K.
    pub damping: Damping,
    /// What is simulated besides masses and springs.
    pub effects: Effects,
    /// Which values are inputs, which are parameters.
    pub roles: Roles,
    /// Masses, springs and contacts.
    pub structure: Structure,
    /// What changes inputs over time.
    pub signals: Arc<[Signal]>,
    /// Where method and step come from.
    pub selection: Selection,
    /// How time goes on. Where it is to be chosen, it says nothing before a simulation is made.
    pub method: Method,
    /// Internal time step h, s; as the method.
    pub step: f64,
    /// What a run does unless told otherwise.
    pub experiment: Experiment,
}

/// Masses, springs and contacts.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// The paper's ring of modules (section 3 and Fig. 1), each with one contact.
    Ring(Vec<Module>),
    /// Masses in a plane, joined in any way.
    Network(Network),
}

/// The rigid slider.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Velocity along the tangent t = (cos θ, sin θ), m/s; of either sign.
    pub velocity: f64,
    /// Inclination θ against the horizontal, rad; under a ring from −π/2 to π/2.
    pub angle: f64,
}

/// What a run does unless told otherwise; FMI's DefaultExperiment.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Experiment {
    /// End of the run, s; it starts at 0.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::TIME.bounds()))]
    pub stop_time: f64,
    /// Time between two rows of results, s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::TIME.bounds()))]
    pub output_interval: f64,
}

impl Experiment {
    /// When a run has rows after that of its start, s: after each output interval, and at the end; with
    /// whether the row ends a whole interval.
    #[allow(clippy::cast_precision_loss)]
    pub fn row_times(self) -> impl Iterator<Item = (f64, bool)> {
        let Self { stop_time: stop, output_interval: interval } = self;
        let mut intervals = 0_u64;
        let mut is_over = stop <= 0.0;
        std::iter::from_fn(move || {
            if is_over {
                return None;
            }
            intervals += 1;
            let next = intervals as f64 * interval;
            // The stop time may be a whole number of intervals but for rounding.
            is_over = next >= stop - 1e-9 * interval;
            Some((if is_over { stop } else { next }, next <= stop + 1e-9 * interval))
        })
    }
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, output_interval: 1e-3 }
    }
}

impl Scene {
    /// The scene with this method and step (s).
    #[must_use]
    pub fn with_integrator(&self, method: Method, step: f64) -> Self {
        Self { selection: Selection::Given, method, step, ..self.clone() }
    }

    /// Gives the scene another method, another step (s), or both, in place of what chooses them.
    ///
    /// # Errors
    /// Only one of them is given to a scene that has neither.
    pub fn set_integrator(
        &mut self,
        method: Option<Method>,
        step: Option<f64>,
    ) -> Result<(), Error> {
        let lacking = match (method, step) {
            (None, None) => return Ok(()),
            (Some(_), None) => Some("--step"),
            (None, Some(_)) => Some("--integrator"),
            (Some(_), Some(_)) => None,
        };
        if let Some(lacking) = lacking.filter(|_| self.selection != Selection::Given) {
            return Err(Error::argument(format!(
                "integrator.{} chooses both method and step; give {lacking} too",
                self.selection
            )));
        }
        self.selection = Selection::Given;
        self.method = method.unwrap_or(self.method);
        self.step = step.unwrap_or(self.step);
        Ok(())
    }

    /// Takes all initial displacements and velocities away: it starts at rest in its equilibrium.
    pub fn rest(&mut self) {
        match &mut self.structure {
            Structure::Ring(modules) => {
                for module in modules {
                    (module.displacement, module.velocity) = Default::default();
                }
            }
            Structure::Network(network) => {
                for mass in &mut network.masses {
                    (mass.displacement, mass.velocity) = Default::default();
                }
            }
        }
    }

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

    /// What there is of the law of contact.
    #[must_use]
    pub fn contact_law(&self) -> ContactLaw {
        let Effects { sticking, detachment, .. } = self.effects;
        let contacts = self.network().map_or(&[][..], |network| &network.contacts);
        let drops = self.static_friction.is_some()
            || contacts.iter().any(|place| place.static_friction.is_some());
        let friction = match self.friction_law {
            Law::Coulomb if drops => Law::StaticKinetic,
            law => law,
        };
        ContactLaw { friction, sticking, detachment }
    }

    /// The numbers of friction of every contact that has none of its own.
    #[must_use]
    pub fn friction(&self) -> Friction {
        let kinetic = self.friction_coefficient;
        Friction {
            kinetic,
            static_: self.static_friction.unwrap_or(kinetic),
            stribeck_velocity: self.stribeck_velocity.unwrap_or(f64::INFINITY),
        }
    }

    /// The numbers of friction of a contact. The common static coefficient belongs to the common kinetic one: a contact
    /// with a µ of its own has that for both, unless it has a µ_s of its own as well.
    #[must_use]
    pub fn friction_of(&self, contact: usize) -> Friction {
        let common = self.friction();
        let Some(place) = self.place(contact) else { return common };
        Friction {
            kinetic: place.friction.unwrap_or(common.kinetic),
            static_: place.static_friction.or(place.friction).unwrap_or(common.static_),
            ..common
        }
    }

    /// v, the velocity of the surface that a contact rubs on, along the tangent, m/s.
    #[must_use]
    pub fn surface_velocity(&self, contact: usize) -> f64 {
        self.place(contact).and_then(|place| place.velocity).unwrap_or(self.slider.velocity)
    }

    /// A contact of a network.
    #[must_use]
    pub(crate) fn place(&self, contact: usize) -> Option<&RubbingPlace> {
        self.network().map(|network| &network.contacts[contact])
    }

    /// The greatest common µ that the scene's static friction leaves possible: that of a contact that stands is at least
    /// that of one that slips. `None` where there is no such bound.
    #[must_use]
    pub fn greatest_friction(&self) -> Option<f64> {
        let contacts = self.network().map_or(&[][..], |network| &network.contacts);
        let own = contacts.iter().filter(|place| place.friction.is_none());
        let all = own.filter_map(|place| place.static_friction).chain(self.static_friction);
        all.reduce(f64::min)
    }

    /// `true` where some contact has less static than kinetic friction, which cannot be.
    #[must_use]
    pub fn has_static_below_kinetic_friction(&self) -> bool {
        let kinetic = self.friction_coefficient;
        let is_below = |static_: Option<f64>, kinetic: f64| static_.is_some_and(|s| s < kinetic);
        let contacts = self.network().map_or(&[][..], |network| &network.contacts);
        is_below(self.static_friction, kinetic)
            || contacts
                .iter()
                .any(|place| is_below(place.static_friction, place.friction.unwrap_or(kinetic)))
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

    /// The FMU's names of the inputs, which signals may drive; in no order that means anything.
    #[must_use]
    pub fn input_names(&self) -> Vec<String> {
        let is_input = |(group, _): &(Group, String)| self.roles.of(*group) == Some(Role::Input);
        self.may_be_driven().filter(is_input).map(|(_, name)| name).collect()
    }

    /// Does any contact do without a value of its own?
    fn shares(&self, has_own: impl Fn(&RubbingPlace) -> bool) -> bool {
        self.network().is_none_or(|network| !network.contacts.iter().all(has_own))
    }

    /// Does any contact have the slider's velocity?
    #[must_use]
    pub fn has_common_velocity(&self) -> bool {
        self.shares(|place| place.velocity.is_some())
    }

    /// Does what a contact (from 0) rubs on move with the slider's velocity?
    #[must_use]
    pub fn is_on_slider(&self, contact: usize) -> bool {
        self.network().is_none_or(|network| network.contacts[contact].velocity.is_none())
    }

    /// Does a drive that moves the slider feel what rubs on it? Without friction a network's has no reaction.
    #[must_use]
    pub fn has_slider_reaction(&self) -> bool {
        self.network().is_none() || (self.has_common_velocity() && self.friction_law.info().sticks)
    }

    /// Do all contacts on the slider press along its normal, with no mass between that carries the surface?
    #[must_use]
    pub fn has_common_plane(&self) -> bool {
        let is_beside = |place: &RubbingPlace| place.velocity.is_some();
        let is_plain = |place: &RubbingPlace| place.angle.is_none() && place.on.is_none();
        self.network().is_none_or(|network| {
            network.contacts.iter().all(|place| is_beside(place) || is_plain(place))
        })
    }

    /// Does any contact have the slider's inclination?
    #[must_use]
    pub fn has_common_angle(&self) -> bool {
        self.shares(|place| place.angle.is_some())
    }

    /// Does any contact have the common µ?
    #[must_use]
    pub fn has_common_friction(&self) -> bool {
        self.friction_law.info().sticks && self.shares(|place| place.friction.is_some())
    }

    /// Does any contact have the common µ_s?
    #[must_use]
    pub fn has_common_static_friction(&self) -> bool {
        self.static_friction.is_some()
            && self.shares(|place| place.friction.or(place.static_friction).is_some())
    }

    /// The FMU's names of all that signals may drive where it is an input, each with its group.
    fn may_be_driven(&self) -> impl Iterator<Item = (Group, String)> + '_ {
        let common = [
            (self.has_common_velocity(), Group::SliderVelocity, "slider.velocity"),
            (self.has_common_friction(), Group::Friction, "friction.coefficient"),
            (self.has_common_static_friction(), Group::Friction, "friction.static"),
        ];
        let has_preload = self.effects.preload;
        let modules = (1..=self.modules().len()).flat_map(move |i| {
            let forces = (1..=4).map(move |j| (Group::Forces, format!("module[{i}].f{j}")));
            let preload = has_preload.then(|| (Group::Preload, format!("module[{i}].preload")));
            forces.chain(preload)
        });
        let masses = self.masses().iter().flat_map(|mass| {
            let name = |axis: &str| (Group::Forces, format!("mass.{}.f{axis}", mass.name));
            mass.free([name("x"), name("y")])
        });
        let (springs, contacts) = self
            .network()
            .map_or((&[][..], &[][..]), |network| (&network.springs[..], &network.contacts[..]));
        let springs = springs.iter().filter_map(|spring| {
            spring.preload.map(|_| (Group::Preload, format!("spring.{}.preload", spring.name)))
        });
        let contacts = contacts.iter().flat_map(|place| {
            let own = |value: Option<f64>, group, key| {
                value.map(|_| (group, format!("contact.{}.{key}", place.name)))
            };
            let own = [
                own(place.velocity, Group::SliderVelocity, "velocity"),
                own(place.friction, Group::Friction, "friction"),
                own(place.static_friction, Group::Friction, "static_friction"),
            ];
            own.into_iter().flatten()
        });
        let common = common.into_iter().filter(|(is_there, ..)| *is_there);
        let common = common.map(|(_, group, name)| (group, name.to_owned()));
        common.chain(modules).chain(masses).chain(springs).chain(contacts)
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
}
