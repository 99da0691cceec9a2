//! `[[initial]]` of a scene file.

use super::network_check::quoted;
use super::network_file::{self, Names};
use super::{Problem, Structure, ring_file};
use serde::Deserialize;
use std::collections::HashMap;

/// Initial displacement and velocity of a module or mass, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub(super) enum Initial {
    Module(ring_file::ModuleInitial),
    Mass(network_file::MassInitial),
}

/// Gives modules or masses their initial values. Returns the index of the `[[initial]]` of each module or mass, by
/// the index of the module or mass.
pub(super) fn apply(
    all: &[Initial],
    structure: &mut Structure,
    names: &mut Names<'_>,
) -> HashMap<usize, usize> {
    let mut homes = HashMap::new();
    for (i, initial) in all.iter().enumerate() {
        let path = |key: &str| format!("initial[{}].{key}", i + 1);
        let (key, value, owner) = match (initial, &*structure) {
            (Initial::Module(values), Structure::Ring(modules)) => {
                let count = modules.len();
                let owner = values.module.checked_sub(1).filter(|&owner| owner < count);
                if owner.is_none() {
                    let message = format!("the ring has modules 1 to {count}");
                    let problem = Problem::new(path("module"), message).of(values.module);
                    names.problems.push(problem);
                }
                ("module", values.module.to_string(), owner)
            }
            (Initial::Mass(values), Structure::Network(_)) => {
                let owner = names.place(|| path("mass"), &values.mass);
                ("mass", quoted(&values.mass), owner)
            }
            (Initial::Module(values), Structure::Network(_)) => {
                let problem = Problem::new(path("module"), "a network has no modules");
                let help = "give the name of a mass, as `mass = \"…\"`, and x, y, vx or vy";
                names.problems.push(problem.of(values.module).help(help));
                continue;
            }
            (Initial::Mass(values), Structure::Ring(_)) => {
                let problem = Problem::new(path("mass"), "the masses of a ring have no names");
                let help = "give the number of a module, as `module = 1`, and x1 … x4 or v1 … v4";
                names.problems.push(problem.of(quoted(&values.mass)).help(help));
                continue;
            }
        };
        let Some(owner) = owner else { continue };
        if homes.contains_key(&owner) {
            let problem = Problem::new(path(key), "has more than one [[initial]]").of(value);
            names.problems.push(problem.help("give all its values in one [[initial]]"));
            continue;
        }
        homes.insert(owner, i);
        match (initial, &mut *structure) {
            (Initial::Module(values), Structure::Ring(modules)) => {
                values.apply(&mut modules[owner]);
            }
            (Initial::Mass(values), Structure::Network(network)) => {
                values.apply(&mut network.masses[owner]);
            }
            _ => {}
        }
    }
    homes
}
