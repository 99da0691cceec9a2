//! A scene as validated data: the structure to simulate, its inputs and the settings of a run.
//!
//! [`read`] and [`builtin`] give a [`Scene`]; [`Scene::check`] checks its values. This module contains no physics.
//!
//! | file | contents |
//! | --- | --- |
//! | `file`, `homes`, `initial_file` | the file as a whole; places in it; its initial values |
//! | `friction_file` | the law of friction in a file |
//! | `effects`, `effects_file`, `effects_check` | effects that are simulated besides masses and springs; that part of
//! a file |
//! | `selection`, `integrator_file` | method and step given, or a tolerance in their place; that part of a file |
//! | `roles`, `missing` | role of a value: input or parameter; explanations of features that a scene does not use |
//! | `ring`, `ring_file` | the paper's ring of modules; its part of a file |
//! | `network`, `network_check`, `network_file`, `names` | masses, springs, dampers and contacts by name |
//! | `superelement`, `superelement_check`, `superelement_file`, `packed` | structures as matrices, and their packed form |
//! | `contact_set_file`, `load_file`, `outputs_file`, `node_table` | contacts, loads and outputs by node; CSV files of nodes |
//! | `signal`, `signal_file`, `time_table` | values over time that drive inputs |
//! | `source` | the files a scene is made from |
//! | `check`, `rule` | checks of a scene; rules for its values |
//! | `problem` | a problem found in a scene |
//! | `nearest`, `text` | suggestions for misspelt words; a file's text |
//! | `builtin` | the scenes built into the program |

mod builtin;
mod check;
mod contact_set_file;
mod effects;
mod effects_check;
mod effects_file;
mod file;
mod friction_file;
mod homes;
mod initial_file;
mod integrator_file;
mod keys;
mod load_file;
mod missing;
mod names;
mod nearest;
mod network;
mod network_check;
mod network_file;
mod node_table;
mod outputs_file;
mod packed;
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
mod superelement;
mod superelement_check;
mod superelement_file;
mod text;
mod time_table;

pub use builtin::{BUILTIN, Builtin, builtin, builtin_names, named};
pub use check::meant_input;
pub(crate) use check::{MAX_STEPS, count, least};
pub use effects::Effects;
pub use file::{SceneFile, SceneTables, parse, read};
pub use missing::MissingFeature;
pub use nearest::{did_you_mean, nearest};
pub use network::{
    ContactDefinition, Coordinates, Damper, GROUND, Line, MAX_PARTS, Mass, ModeAt, Network, NodeAt,
    Point, Spring, direction,
};
pub use problem::{MAX_PROBLEMS, Problem, and_more};
pub use ring::{MAX_MODULES, Module};
pub(crate) use roles::Group;
pub use roles::{ForceRole, Role, Roles};
pub use rule::Rule;
pub use selection::{IntegratorChoice, Preset, Selection};
pub use signal::{Between, Constant, Pulse, Ramp, Shape, Signal, Sine, Table};
pub use source::{Folder, Source};
pub use superelement::{
    Freedom, MAX_FREEDOMS, MatrixFiles, PACKED, Superelement, SuperelementFiles,
    SuperelementMatrices, UnitFactors,
};
pub use time_table::TimeTable;

pub use crate::integrator::Method;
pub use crate::model::Damping;

use crate::Error;
use crate::contact::{ContactLaw, Friction, Law};
use serde::Deserialize;
use std::sync::Arc;

/// A structure in frictional contact, its inputs, and the settings of its run.
///
/// ```
/// use amontons::scene::parse;
///
/// let scene = parse(
///     "block",
///     r#"
///     integrator = { step = 1e-4 }                 # s
///     slider = { velocity = 0.1, angle = 0.0 }     # m/s, rad
///     friction = { coefficient = 0.4 }
///     mass = [{ name = "block", mass = 1.0, force = [0.0, -10.0] }]
///     spring = [{ name = "hold", between = ["block", "ground"], direction = "x", stiffness = 100.0 }]
///     contact = [{ name = "belt", mass = "block" }]
///     "#,
/// )?;
/// assert_eq!(scene.contact_count(), 1);
/// assert_eq!(scene.dof_names(), ["mass.block.x", "mass.block.y"]);
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name of the scene: the stem of its file, or the name of the built-in scene.
    pub name: String,
    /// Description of the scene in one line.
    pub description: String,
    /// The rigid slider: velocity and angle of every contact that gives none of its own.
    pub slider: Slider,
    /// The law of friction. [`Law::Coulomb`] stands for [`Law::StaticKinetic`] if the scene has a static friction
    /// coefficient ([`contact_law`](Self::contact_law)).
    pub friction_law: Law,
    /// Friction coefficient µ of every contact that has none of its own, ≥ 0.
    pub friction_coefficient: f64,
    /// Static friction coefficient µ_s ≥ µ of every contact that has neither coefficient of its own, while it does
    /// not slip; equal to µ if `None`.
    pub static_friction: Option<f64>,
    /// Decay velocity v_s > 0 of the slip velocity over which µ falls from µ_s towards µ, m/s; for a law that has one.
    pub stribeck_velocity: Option<f64>,
    /// `true` if the eigenvalues have the damping µN/v of friction across the sliding; it has no part in the motion.
    pub transverse_damping: bool,
    /// Rayleigh damping, C = α M + β K.
    pub damping: Damping,
    /// Effects that are simulated besides masses and springs.
    pub effects: Effects,
    /// Roles of the values that may change during a run: inputs or parameters.
    pub roles: Roles,
    /// Masses, springs and contacts.
    pub structure: Structure,
    /// Signals, which are added to inputs over time.
    pub signals: Arc<[Signal]>,
    /// Source of method and step: given values or a tolerance.
    pub selection: Selection,
    /// Method of time integration. It has no meaning before a simulation is made if a tolerance chooses it.
    pub method: Method,
    /// Internal time step h, s. It has no meaning before a simulation is made if a tolerance chooses it.
    pub step: f64,
    /// Default end time and output interval of a run.
    pub experiment: Experiment,
}

/// Masses, superelements, springs and contacts.
// A scene has one structure.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// The paper's ring of modules (section 3 and Fig. 1), each with one contact.
    Ring(Vec<Module>),
    /// Masses in a plane and superelements, joined in any way.
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

/// Default end time and output interval of a run (FMI's DefaultExperiment).
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
    /// Times of the rows of results after the start, s: the end of each output interval, and the stop time. The flag
    /// is `true` if the row ends a whole interval.
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
            // The stop time may be a whole number of intervals up to rounding.
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
    /// Returns the scene with this method and step (s).
    #[must_use]
    pub fn with_integrator(&self, method: Method, step: f64) -> Self {
        Self { selection: Selection::Given, method, step, ..self.clone() }
    }

    /// Sets another method, another step (s), or both, in place of a preset or tolerance that chooses them.
    ///
    /// # Errors
    /// Returns an error if only one of them is given to a scene whose method and step are chosen by a tolerance.
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

    /// Sets all initial displacements and velocities to zero, so that a run starts at rest in the equilibrium.
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
                for one in &mut network.superelements {
                    one.displacement.fill(0.0);
                    one.velocity.fill(0.0);
                }
            }
        }
    }

    /// The modules of a ring; empty for a network.
    #[must_use]
    pub fn modules(&self) -> &[Module] {
        match &self.structure {
            Structure::Ring(modules) => modules,
            Structure::Network(_) => &[],
        }
    }

    /// The modules of a scene that is known to be a ring.
    ///
    /// # Panics
    /// Panics if the scene is a network.
    pub fn modules_mut(&mut self) -> &mut Vec<Module> {
        match &mut self.structure {
            Structure::Ring(modules) => modules,
            Structure::Network(_) => panic!("{} is a network and has no modules", self.name),
        }
    }

    /// The modules of a ring, for functions that support rings only.
    ///
    /// # Errors
    /// Returns an error if the scene is a network; `what` names the function that does not support it.
    pub fn require_ring(&self, what: &str) -> Result<&[Module], Error> {
        match &self.structure {
            Structure::Ring(modules) => Ok(modules),
            Structure::Network(_) => Err(Error::scene(format!(
                "{} is a network, but {what} for a [ring] only",
                self.name
            ))),
        }
    }

    /// The network; `None` for a ring.
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
            // Every module has one contact.
            Structure::Ring(modules) => modules.len(),
            Structure::Network(network) => network.contacts.len(),
        }
    }

    /// Law of contact of the scene: the law of friction, and whether contacts may stick and open.
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

    /// Friction coefficients and decay velocity of every contact that has none of its own.
    #[must_use]
    pub fn friction(&self) -> Friction {
        let kinetic = self.friction_coefficient;
        Friction {
            kinetic,
            static_: self.static_friction.unwrap_or(kinetic),
            stribeck_velocity: self.stribeck_velocity.unwrap_or(f64::INFINITY),
        }
    }

    /// Friction coefficients and decay velocity of a contact (from 0). The common static coefficient belongs to the
    /// common kinetic one: a contact with its own µ uses it for both coefficients unless it also has its own µ_s.
    #[must_use]
    pub fn friction_of(&self, contact: usize) -> Friction {
        let common = self.friction();
        let Some(own) = self.contact_definition(contact) else { return common };
        Friction {
            kinetic: own.friction.unwrap_or(common.kinetic),
            static_: own.static_friction.or(own.friction).unwrap_or(common.static_),
            ..common
        }
    }

    /// Velocity v of the sliding surface of a contact (from 0) along its tangent, m/s.
    #[must_use]
    pub fn surface_velocity(&self, contact: usize) -> f64 {
        self.contact_definition(contact)
            .and_then(|place| place.velocity)
            .unwrap_or(self.slider.velocity)
    }

    /// A contact (from 0) of a network; `None` for a ring.
    #[must_use]
    pub(crate) fn contact_definition(&self, contact: usize) -> Option<&ContactDefinition> {
        self.network().map(|network| &network.contacts[contact])
    }

    /// Upper limit of the common µ: the smallest of the common µ_s and the µ_s of contacts that use the
    /// common µ, since µ_s ≥ µ. `None` if there is no such limit.
    #[must_use]
    pub fn greatest_friction(&self) -> Option<f64> {
        let contacts = self.network().map_or(&[][..], |network| &network.contacts);
        let own = contacts.iter().filter(|place| place.friction.is_none());
        let all = own.filter_map(|place| place.static_friction).chain(self.static_friction);
        all.reduce(f64::min)
    }

    /// `true` if the static friction coefficient of some contact is below its kinetic one, which is impossible.
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

    /// The names of the degrees of freedom, in order: `module[1].x1`, `mass.pad.x`, `superelement.pad.node[17].x`,
    /// `superelement.pad.mode[1]`.
    #[must_use]
    pub fn dof_names(&self) -> Vec<String> {
        let modules = (1..=self.modules().len())
            .flat_map(|i| (1..=4).map(move |j| format!("module[{i}].x{j}")));
        let masses = self.masses().iter().flat_map(|mass| {
            let name = |axis: &str| format!("mass.{}.{axis}", mass.name);
            mass.free([name("x"), name("y")])
        });
        let superelements = self.superelements().iter().flat_map(Superelement::row_names);
        modules.chain(masses).chain(superelements).collect()
    }

    /// The FMU's names of the inputs, which signals may drive, in no particular order.
    #[must_use]
    pub fn input_names(&self) -> Vec<String> {
        let is_input = |(group, _): &(Group, String)| self.roles.of(*group) == Some(Role::Input);
        self.may_be_driven().filter(is_input).map(|(_, name)| name).collect()
    }

    /// `true` if the scene is a ring, or some contact of the network has no value of its own.
    fn shares(&self, has_own: impl Fn(&ContactDefinition) -> bool) -> bool {
        self.network().is_none_or(|network| !network.contacts.iter().all(has_own))
    }

    /// `true` if the scene is a ring, or some contact of the network uses the slider's velocity.
    #[must_use]
    pub fn has_common_velocity(&self) -> bool {
        self.shares(|place| place.velocity.is_some())
    }

    /// `true` if the sliding surface of a contact (from 0) moves with the slider's velocity.
    #[must_use]
    pub fn is_on_slider(&self, contact: usize) -> bool {
        self.network().is_none_or(|network| network.contacts[contact].velocity.is_none())
    }

    /// `true` if the slider has a reaction to its contacts: in a ring, and in a network with friction in which some
    /// contact uses the slider's velocity.
    #[must_use]
    pub fn has_slider_reaction(&self) -> bool {
        self.network().is_none() || (self.has_common_velocity() && self.friction_law.info().sticks)
    }

    /// `true` if all contacts on the slider have its inclination, and none of them lies on another mass.
    #[must_use]
    pub fn has_common_plane(&self) -> bool {
        let is_beside = |place: &ContactDefinition| place.velocity.is_some();
        let is_plain = |place: &ContactDefinition| {
            place.angle.is_none() && place.axes.is_none() && place.on.is_none()
        };
        self.network().is_none_or(|network| {
            network.contacts.iter().all(|place| is_beside(place) || is_plain(place))
        })
    }

    /// `true` if the scene is a ring, or some contact of the network uses the slider's inclination.
    #[must_use]
    pub fn has_common_angle(&self) -> bool {
        self.shares(|place| place.angle.is_some() || place.axes.is_some())
    }

    /// `true` if the law has friction, and some contact uses the common µ.
    #[must_use]
    pub fn has_common_friction(&self) -> bool {
        self.friction_law.info().sticks && self.shares(|place| place.friction.is_some())
    }

    /// `true` if the scene has a common µ_s, and some contact uses it.
    #[must_use]
    pub fn has_common_static_friction(&self) -> bool {
        self.static_friction.is_some()
            && self.shares(|place| place.friction.or(place.static_friction).is_some())
    }

    /// The FMU's names of all values that signals can drive if they are inputs, each with its group.
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
        let nodes = self.network().into_iter().flat_map(|network| {
            network.shown.nodes.iter().flat_map(|at| {
                let axes = (1..=3).zip(["fx", "fy", "fz"]);
                let axes = axes.filter(|(axis, _)| network.node_row(*at, *axis).is_some());
                let part = network.superelements[at.superelement].node_name(at.node);
                axes.map(move |(_, key)| (Group::Forces, format!("{part}.{key}")))
            })
        });
        let (springs, contacts) = self
            .network()
            .map_or((&[][..], &[][..]), |network| (&network.springs[..], &network.contacts[..]));
        let springs = springs.iter().filter_map(|spring| {
            spring.preload.map(|_| (Group::Preload, format!("spring.{}.preload", spring.name)))
        });
        let contacts = contacts.iter().filter(|place| place.is_shown).flat_map(|place| {
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
        common.chain(modules).chain(masses).chain(nodes).chain(springs).chain(contacts)
    }

    /// External forces, N, one for each degree of freedom, in order.
    pub fn external_forces(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.force));
        let nodes = self.superelements().iter().flat_map(|one| one.force.iter().copied());
        self.modules().iter().flat_map(|module| module.force).chain(masses).chain(nodes)
    }

    /// Initial displacements from the equilibrium, m, one for each degree of freedom, in order.
    pub fn initial_displacements(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.displacement));
        let nodes = self.superelements().iter().flat_map(|one| one.displacement.iter().copied());
        self.modules().iter().flat_map(|module| module.displacement).chain(masses).chain(nodes)
    }

    /// Initial velocities, m/s, one for each degree of freedom, in order.
    pub fn initial_velocities(&self) -> impl Iterator<Item = f64> + '_ {
        let masses = self.masses().iter().flat_map(|mass| mass.free(mass.velocity));
        let nodes = self.superelements().iter().flat_map(|one| one.velocity.iter().copied());
        self.modules().iter().flat_map(|module| module.velocity).chain(masses).chain(nodes)
    }

    /// The superelements of a network; empty for a ring.
    fn superelements(&self) -> &[Superelement] {
        self.network().map_or(&[], |network| &network.superelements)
    }

    /// The masses of a network; empty for a ring.
    fn masses(&self) -> &[Mass] {
        self.network().map_or(&[], |network| &network.masses)
    }
}
