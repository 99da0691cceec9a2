//! The catalogue of FMI variables (`modelDescription/`), and the variables of one scene.

use crate::scene::{Scene, Selection, Structure};

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));

/// The catalogue's own text, for fingerprints.
pub const CATALOGUE_TEXT: [&str; 2] = [
    include_str!("../../modelDescription/variables.toml"),
    include_str!("../../modelDescription/units.toml"),
];

/// An entry of the catalogue: one variable, or one a part of the structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Template {
    /// The name; `{i}` stands for the part: `[1]` in a ring, `.pad` in a network.
    pub name: &'static str,
    /// What it is to the program.
    pub quantity: Quantity,
    /// Which of several (x1 … x4), from 0.
    pub component: usize,
    /// What it is repeated for.
    pub per: Per,
    /// Its role.
    pub causality: Causality,
    /// When it changes.
    pub variability: Variability,
    /// Its type.
    pub kind: Kind,
    /// One line for people.
    pub description: &'static str,
}

/// What a template is repeated for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Once.
    Scene,
    /// Once, in a ring.
    Ring,
    /// Once a module.
    Module,
    /// Once a contact.
    Contact,
    /// Once a mass of a network.
    Mass,
    /// Once a spring of a network.
    Spring,
    /// Once a damper of a network.
    Damper,
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Given by the importer throughout.
    Input,
    /// Computed.
    Output,
    /// Given before the run, or between steps where tunable.
    Parameter,
}

/// When a variable may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// Never after initialization.
    Fixed,
    /// Between steps.
    Tunable,
    /// At events.
    Discrete,
    /// Always.
    Continuous,
}

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A double.
    Real {
        /// Its unit.
        unit: &'static str,
        /// The least value that makes sense.
        min: Option<f64>,
    },
    /// A 32-bit integer.
    Integer,
    /// An item of an enumeration, counting from 1.
    Enumeration {
        /// The enumeration's name.
        name: &'static str,
    },
}

/// A unit and its exponents of the SI base units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Its name.
    pub name: &'static str,
    /// Base unit and exponent; those that are zero are left out.
    pub exponents: &'static [(&'static str, i32)],
}

/// An enumeration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enumeration {
    /// Its name.
    pub name: &'static str,
    /// One line for people.
    pub description: &'static str,
    /// Names and descriptions, counting from 1.
    pub items: &'static [(&'static str, &'static str)],
}

/// A variable of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name, as importers and scripts see it.
    pub name: String,
    /// Its entry in the catalogue.
    pub template: &'static Template,
    /// The part of the structure that it belongs to, from 0.
    pub index: usize,
}

impl Variable {
    /// May it be given a value before the run?
    #[must_use]
    pub fn is_settable(&self) -> bool {
        self.template.causality != Causality::Output
    }

    /// May it be given another value during the run?
    #[must_use]
    pub fn is_tunable(&self) -> bool {
        self.template.causality == Causality::Input
            || self.template.variability == Variability::Tunable
    }

    /// Does it decide, of what may change during the run, whether a step is possible: by the critical
    /// step, or by static friction below kinetic?
    pub(super) fn sets_limit(&self) -> bool {
        matches!(
            self.template.quantity,
            Quantity::FrictionCoefficient
                | Quantity::StaticFriction
                | Quantity::OwnFriction
                | Quantity::OwnStaticFriction
                | Quantity::DampingBeta
        )
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
            variables.extend(present.map(|template| Variable {
                name: template.name.replace("{i}", &part),
                template,
                index,
            }));
        }
    }
    variables
}

/// How often a scene has what a template is repeated for.
fn count(scene: &Scene, per: Per) -> usize {
    match (per, &scene.structure) {
        (Per::Scene, _) | (Per::Ring, Structure::Ring(_)) => 1,
        (Per::Module, Structure::Ring(modules)) => modules.len(),
        (Per::Contact, _) => scene.contact_count(),
        (Per::Mass, Structure::Network(network)) => network.masses.len(),
        (Per::Spring, Structure::Network(network)) => network.springs.len(),
        (Per::Damper, Structure::Network(network)) => network.dampers.len(),
        (Per::Mass | Per::Spring | Per::Damper, Structure::Ring(_))
        | (Per::Ring | Per::Module, Structure::Network(_)) => 0,
    }
}

/// What stands for `{i}` in the names of a part's variables.
fn part(scene: &Scene, per: Per, index: usize) -> String {
    let name = match (per, scene.network()) {
        (Per::Contact, Some(network)) => &network.contacts[index].name,
        (Per::Mass, Some(network)) => &network.masses[index].name,
        (Per::Spring, Some(network)) => &network.springs[index].name,
        (Per::Damper, Some(network)) => &network.dampers[index].name,
        _ => return format!("[{}]", index + 1),
    };
    format!(".{name}")
}

/// Locked degrees of freedom have no variables, v and µ of a contact have one only where the contact
/// has its own, static friction where there is some, the step where it is given, effects where the scene asks
/// for them.
fn is_present(scene: &Scene, template: &Template, index: usize) -> bool {
    match template.quantity {
        Quantity::StaticFriction => return scene.static_friction.is_some(),
        // Where a tolerance chooses it, it is not for an importer to give.
        Quantity::IntegratorStep => return scene.selection == Selection::Given,
        Quantity::GrowthRate | Quantity::ModeFrequency | Quantity::ModeCount => {
            return scene.effects.stability;
        }
        _ => {}
    }
    let Some(network) = scene.network() else {
        let own = [Quantity::OwnVelocity, Quantity::OwnFriction, Quantity::OwnStaticFriction];
        return !own.contains(&template.quantity);
    };
    match (template.per, template.quantity) {
        (Per::Mass, Quantity::Mass) => true,
        (Per::Mass, _) => !network.masses[index].locked[template.component],
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
