//! The catalogue of FMI variables (`modelDescription/`), and the variables of one scene.

use crate::scene::{Group, ModeAt, Network, NodeAt, Role, Scene, Selection, Structure};

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));

/// Patterns for a `match` on a [`Quantity`]: all outputs, and all parameters and inputs.
pub(super) use {output, parameter_or_input};

/// Text of the catalogue, for fingerprints.
pub const CATALOGUE_TEXT: [&str; 2] = [
    include_str!("../../modelDescription/variables.toml"),
    include_str!("../../modelDescription/units.toml"),
];

/// Entry of the catalogue: one variable, or one for each part of the structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Template {
    /// Name of the variable; `{i}` stands for the part: `[1]` in a ring, `.pad` in a network.
    pub name: &'static str,
    /// Quantity of the model that the variable reads or writes.
    pub quantity: Quantity,
    /// Component of the quantity (x1 … x4), from 0.
    pub component: usize,
    /// Part of the structure for which the entry is repeated.
    pub per: Per,
    /// Causality, unless the scene sets another.
    pub causality: Causality,
    /// Variability, unless the scene sets another.
    pub variability: Variability,
    /// Type of the variable.
    pub kind: Kind,
    /// Description of the variable in one line.
    pub description: &'static str,
}

/// Part of the structure for which a template is repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Once for the scene.
    Scene,
    /// Once for each module.
    Module,
    /// Once for each contact.
    Contact,
    /// Once for each mass of a network.
    Mass,
    /// Once for each node of a superelement that the scene shows.
    Node,
    /// Once for each modal coordinate of a superelement that the scene shows.
    Mode,
    /// Once for each node of a superelement with initial values of its own.
    InitialNode,
    /// Once for each modal coordinate of a superelement with initial values of its own.
    InitialMode,
    /// Once for each spring of a network.
    Spring,
    /// Once for each damper of a network.
    Damper,
    /// Once for the FMU; runs of the program do not have the variable.
    Fmu,
}

/// Causality of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set by the importer throughout the run.
    Input,
    /// Computed by the simulation.
    Output,
    /// Set before the run, or between steps if tunable.
    Parameter,
}

/// Variability of a variable: the times at which it may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// The variable does not change after initialization.
    Fixed,
    /// The variable may change between steps.
    Tunable,
    /// The variable changes at events.
    Discrete,
    /// The variable may change at all times.
    Continuous,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A double-precision number.
    Real {
        /// Unit of the variable.
        unit: &'static str,
        /// Smallest meaningful value.
        min: Option<f64>,
    },
    /// A 32-bit integer.
    Integer,
    /// True or false.
    Boolean,
    /// An item of an enumeration, counted from 1.
    Enumeration {
        /// Name of the enumeration.
        name: &'static str,
    },
}

/// A unit and its exponents with respect to the SI base units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Name of the unit.
    pub name: &'static str,
    /// Base units and their exponents; zero exponents are omitted.
    pub exponents: &'static [(&'static str, i32)],
}

/// An enumeration of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enumeration {
    /// Name of the enumeration.
    pub name: &'static str,
    /// Description of the enumeration in one line.
    pub description: &'static str,
    /// Names and descriptions of the items, counted from 1.
    pub items: &'static [(&'static str, &'static str)],
}

/// A variable of one scene.
///
/// ```
/// use amontons::scene::builtin;
/// use amontons::simulation::variables;
///
/// let scene = builtin("set1").expect("a built-in scene").scene();
/// let is_force = |name: &str| name == "contact[2].normal_force";
/// assert!(variables(&scene).iter().any(|variable| is_force(&variable.name)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name of the variable, as importers and scripts see it.
    pub name: String,
    /// Entry of the variable in the catalogue.
    pub template: &'static Template,
    /// Index of the part of the structure to which the variable belongs, from 0.
    pub index: usize,
    /// Causality of the variable in this scene.
    pub causality: Causality,
    /// Variability of the variable in this scene.
    pub variability: Variability,
}

impl Variable {
    /// Its unit; empty for a variable without one.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.template.kind {
            Kind::Real { unit, .. } if unit != "1" => unit,
            _ => "",
        }
    }

    /// `true` if both variables have the same entry of the catalogue and the same part of the structure.
    pub(super) fn is(&self, other: &Self) -> bool {
        std::ptr::eq(self.template, other.template) && self.index == other.index
    }

    /// `true` if the variable can be set before the run.
    #[must_use]
    pub fn is_settable(&self) -> bool {
        self.causality != Causality::Output
    }

    /// `true` if the variable can be set during the run.
    #[must_use]
    pub fn is_tunable(&self) -> bool {
        self.causality == Causality::Input || self.variability == Variability::Tunable
    }

    /// `true` if the variable, changed during the run, can make a step impossible: by the critical step, or by static
    /// friction below kinetic friction.
    pub(super) fn sets_limit(&self) -> bool {
        match self.template.quantity {
            Quantity::FrictionCoefficient
            | Quantity::StaticFriction
            | Quantity::StribeckVelocity
            | Quantity::OwnFriction
            | Quantity::OwnStaticFriction
            | Quantity::DampingAlpha
            | Quantity::DampingBeta => true,
            // Those that are fixed do not change during the run.
            Quantity::SliderVelocity
            | Quantity::SliderAngle
            | Quantity::DamperDamping
            | Quantity::IntegratorStep
            | Quantity::Mass
            | Quantity::Stiffness
            | Quantity::Preload
            | Quantity::ExternalForce
            | Quantity::InitialDisplacement
            | Quantity::InitialVelocity
            | Quantity::OwnVelocity
            | Quantity::Strict
            | output!() => false,
        }
    }
}

/// All variables of a scene, in the catalogue's order, part by part.
#[must_use]
pub fn variables(scene: &Scene) -> Vec<Variable> {
    let mut variables = Vec::new();
    for group in TEMPLATES.chunk_by(|a, b| a.per == b.per) {
        for index in 0..count(scene, group[0].per) {
            let part = part(scene, group[0].per, index);
            let present = group.iter().filter(|template| is_present(scene, template, index));
            variables.extend(present.map(|template| of_part(scene, template, index, &part)));
        }
    }
    variables
}

fn of_part(scene: &Scene, template: &'static Template, index: usize, part: &str) -> Variable {
    let (causality, variability) = role(scene, template);
    let name = template.name.replace("{i}", part);
    Variable { name, template, index, causality, variability }
}

/// The variables of a scene's FMU: those of the scene, then the FMU's own. The index of a variable is its value reference.
#[must_use]
pub fn fmu_variables(scene: &Scene) -> Vec<Variable> {
    let own = TEMPLATES.iter().filter(|template| template.per == Per::Fmu);
    let own = own.map(|template| of_part(scene, template, 0, ""));
    variables(scene).into_iter().chain(own).collect()
}

/// Causality and variability of a template's variables in a scene.
fn role(scene: &Scene, template: &Template) -> (Causality, Variability) {
    match group(template.quantity).and_then(|group| scene.roles.of(group)) {
        Some(Role::Input) => (Causality::Input, Variability::Continuous),
        Some(Role::Parameter) => (Causality::Parameter, Variability::Tunable),
        None => (template.causality, template.variability),
    }
}

/// Group of values with a common role to which a quantity belongs; `None` if its role is fixed.
fn group(quantity: Quantity) -> Option<Group> {
    match quantity {
        Quantity::SliderVelocity | Quantity::OwnVelocity => Some(Group::SliderVelocity),
        Quantity::FrictionCoefficient
        | Quantity::StaticFriction
        | Quantity::OwnFriction
        | Quantity::OwnStaticFriction => Some(Group::Friction),
        Quantity::Preload => Some(Group::Preload),
        Quantity::ExternalForce => Some(Group::Forces),
        _ => None,
    }
}

/// Number of parts of a scene for which a template is repeated.
fn count(scene: &Scene, per: Per) -> usize {
    match (per, &scene.structure) {
        (Per::Scene, _) => 1,
        (Per::Module, Structure::Ring(modules)) => modules.len(),
        (Per::Contact, _) => scene.contact_count(),
        (Per::Mass, Structure::Network(network)) => network.masses.len(),
        (Per::Spring, Structure::Network(network)) => network.springs.len(),
        (Per::Damper, Structure::Network(network)) => network.dampers.len(),
        (Per::Node, Structure::Network(network)) => network.shown.nodes.len(),
        (Per::Mode, Structure::Network(network)) => network.shown.modes.len(),
        (Per::InitialNode, Structure::Network(network)) => network.started.nodes.len(),
        (Per::InitialMode, Structure::Network(network)) => network.started.modes.len(),
        (_, Structure::Ring(_)) | (Per::Module, Structure::Network(_)) | (Per::Fmu, _) => 0,
    }
}

/// Text in place of `{i}` in the names of a part's variables.
fn part(scene: &Scene, per: Per, index: usize) -> String {
    let node = |network: &Network, NodeAt { superelement, node }: NodeAt| {
        format!(".{}.node[{node}]", network.superelements[superelement].name)
    };
    let mode = |network: &Network, ModeAt { superelement, mode }: ModeAt| {
        format!(".{}.mode[{}]", network.superelements[superelement].name, mode + 1)
    };
    let name = match (per, scene.network()) {
        (Per::Node, Some(network)) => return node(network, network.shown.nodes[index]),
        (Per::Mode, Some(network)) => return mode(network, network.shown.modes[index]),
        (Per::InitialNode, Some(network)) => return node(network, network.started.nodes[index]),
        (Per::InitialMode, Some(network)) => return mode(network, network.started.modes[index]),
        (Per::Contact, Some(network)) => &network.contacts[index].name,
        (Per::Mass, Some(network)) => &network.masses[index].name,
        (Per::Spring, Some(network)) => &network.springs[index].name,
        (Per::Damper, Some(network)) => &network.dampers[index].name,
        _ => return format!("[{}]", index + 1),
    };
    format!(".{name}")
}

/// The superelement and the row in it to which a variable of a node or mode belongs; `None` if there is no such degree of
/// freedom, and for variables of other parts.
pub(super) fn superelement_row(
    network: &Network,
    template: &Template,
    index: usize,
) -> Option<(usize, usize)> {
    let direction = u8::try_from(template.component + 1).ok()?;
    let node = |at: NodeAt| Some((at.superelement, network.node_row(at, direction)?));
    let mode = |at: ModeAt| Some((at.superelement, network.mode_row(at)?));
    match template.per {
        Per::Node => node(network.shown.nodes[index]),
        Per::Mode => mode(network.shown.modes[index]),
        Per::InitialNode => node(network.started.nodes[index]),
        Per::InitialMode => mode(network.started.modes[index]),
        _ => None,
    }
}

/// The components of a module's stiffness that link it to the next module: k1 and k2.
const LINKS: [usize; 2] = [0, 1];

/// Returns `true` if the scene has the variable. Features that the scene does not use have no variables: damping,
/// links, preload, external forces, locked degrees of freedom, contacts that the scene does not choose, v and µ of a
/// contact without its own, static friction,
/// effects, a step that a tolerance chooses, and reactions of a slider without contacts.
fn is_present(scene: &Scene, template: &Template, index: usize) -> bool {
    match template.quantity {
        Quantity::Energy => return scene.effects.energy,
        Quantity::SliderVelocity => return scene.has_common_velocity(),
        Quantity::SliderAngle => return scene.has_common_angle(),
        Quantity::TangentialReaction => return scene.has_slider_reaction(),
        Quantity::NormalReaction => {
            return scene.has_slider_reaction() && scene.has_common_plane();
        }
        Quantity::FrictionCoefficient => return scene.has_common_friction(),
        Quantity::StaticFriction => return scene.has_common_static_friction(),
        Quantity::StribeckVelocity => return scene.stribeck_velocity.is_some(),
        Quantity::ReversedSlips => return scene.effects.has_fixed_direction(scene.friction_law),
        Quantity::PulledContacts => return !scene.effects.detachment,
        // An importer cannot set a step that a tolerance chooses.
        Quantity::IntegratorStep => return scene.selection == Selection::Given,
        Quantity::DampingAlpha => return scene.effects.mass_damping,
        Quantity::DampingBeta => return scene.effects.stiffness_damping,
        Quantity::ExternalForce if scene.roles.of(Group::Forces).is_none() => return false,
        Quantity::GrowthRate | Quantity::ModeFrequency | Quantity::ModeCount => {
            return scene.effects.stability;
        }
        // These depend on the structure, below, or are in every scene.
        Quantity::ExternalForce
        | Quantity::Mass
        | Quantity::Stiffness
        | Quantity::Preload
        | Quantity::DamperDamping
        | Quantity::OwnVelocity
        | Quantity::OwnFriction
        | Quantity::OwnStaticFriction
        | Quantity::InitialDisplacement
        | Quantity::InitialVelocity
        | Quantity::Displacement
        | Quantity::Velocity
        | Quantity::ContactState
        | Quantity::NormalForce
        | Quantity::FrictionForce
        | Quantity::SlipVelocity
        | Quantity::StateChanges
        | Quantity::Strict => {}
    }
    let Some(network) = scene.network() else {
        return match template.quantity {
            Quantity::OwnVelocity | Quantity::OwnFriction | Quantity::OwnStaticFriction => false,
            Quantity::Stiffness => scene.effects.links || !LINKS.contains(&template.component),
            Quantity::Preload => scene.effects.preload,
            _ => true,
        };
    };
    match (template.per, template.quantity) {
        (Per::Node | Per::Mode | Per::InitialNode | Per::InitialMode, _) => {
            superelement_row(network, template, index).is_some()
        }
        // An FMU with all values of hundreds of contacts helps nobody.
        (Per::Contact, _) if !network.contacts[index].is_shown => false,
        (Per::Mass, Quantity::Mass) => true,
        (Per::Mass, _) => !network.masses[index].locked[template.component],
        (_, Quantity::Preload) => network.springs[index].preload.is_some(),
        (_, Quantity::OwnVelocity) => network.contacts[index].velocity.is_some(),
        (_, Quantity::OwnFriction) => network.contacts[index].friction.is_some(),
        (_, Quantity::OwnStaticFriction) => network.contacts[index].static_friction.is_some(),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use std::collections::HashSet;

    #[test]
    fn names_are_unique_and_those_that_scripts_rely_on_exist() {
        let variables = variables(&builtin("set1").unwrap().scene());
        let names: HashSet<&str> = variables.iter().map(|variable| &*variable.name).collect();
        assert_eq!(names.len(), variables.len());
        for name in [
            "friction.coefficient",
            "slider.velocity",
            "slider.angle",
            "damping.beta",
            "module[1].k2",
            "module[2].m1",
            "module[2].preload",
            "initial.module[1].v1",
            "initial.module[2].x4",
            "integrator.step",
            "module[1].x1",
            "module[2].v4",
            "contact[1].state",
            "contact[1].normal_force",
            "contact[2].friction_force",
            "contact[2].slip_velocity",
        ] {
            assert!(names.contains(name), "{name}");
        }
    }

    /// The first of numbered names, as x1 … x4, stands for all.
    #[test]
    fn the_book_names_every_variable() {
        let page = include_str!("../../docs/fmu/variables.md");
        let is_end = |c: char| !c.is_alphanumeric() && c != '_';
        let named: HashSet<&str> =
            page.split('`').skip(1).step_by(2).flat_map(|name| name.split(is_end)).collect();
        for Template { name, .. } in TEMPLATES {
            let last = name.rsplit('.').next().unwrap();
            let first = match last.trim_end_matches(|c: char| c.is_ascii_digit()) {
                word if word.len() < last.len() => format!("{word}1"),
                word => word.to_owned(),
            };
            assert!(named.contains(&*first), "docs/fmu/variables.md lacks {name}");
        }
    }

    #[test]
    fn each_scope_has_only_legal_pairs_of_causality_and_variability() {
        for template in TEMPLATES {
            let legal: &[Variability] = match template.causality {
                Causality::Parameter => &[Variability::Fixed, Variability::Tunable],
                Causality::Input | Causality::Output => {
                    &[Variability::Discrete, Variability::Continuous]
                }
            };
            assert!(legal.contains(&template.variability), "{}", template.name);
            if !matches!(template.kind, Kind::Real { .. }) {
                assert_ne!(template.variability, Variability::Continuous, "{}", template.name);
            }
        }
    }
}
