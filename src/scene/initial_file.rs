//! `[[initial]]` of a scene file.

use super::names::Names;
use super::network_check::quoted;
use super::network_file;
use super::superelement::AXES;
use super::{ModeAt, Network, NodeAt, Problem, Structure, ring_file};
use serde::Deserialize;
use std::collections::HashMap;

/// Initial displacement and velocity of a module, mass, node or mode, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub(super) enum Initial {
    Module(ring_file::ModuleInitial),
    Mass(network_file::MassInitial),
    Node(NodeInitial),
    Mode(ModeInitial),
}

/// Initial displacement and velocity of a node of a superelement, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct NodeInitial {
    /// The node, as "pad.17".
    node: String,
    /// Displacement along x, m.
    #[serde(default)]
    x: f64,
    /// Displacement along y, m.
    #[serde(default)]
    y: f64,
    /// Displacement along z, m.
    #[serde(default)]
    z: f64,
    /// Rotation about x, rad.
    #[serde(default)]
    rx: f64,
    /// Rotation about y, rad.
    #[serde(default)]
    ry: f64,
    /// Rotation about z, rad.
    #[serde(default)]
    rz: f64,
    /// Velocity along x, m/s.
    #[serde(default)]
    vx: f64,
    /// Velocity along y, m/s.
    #[serde(default)]
    vy: f64,
    /// Velocity along z, m/s.
    #[serde(default)]
    vz: f64,
    /// Angular velocity about x, rad/s.
    #[serde(default)]
    vrx: f64,
    /// Angular velocity about y, rad/s.
    #[serde(default)]
    vry: f64,
    /// Angular velocity about z, rad/s.
    #[serde(default)]
    vrz: f64,
}

impl NodeInitial {
    /// Gives the node its initial displacement and velocity; a problem is added for a direction that it does not have.
    fn apply(&self, at: NodeAt, network: &mut Network, path: &str, problems: &mut Vec<Problem>) {
        network.started.nodes.push(at);
        let displacement = [self.x, self.y, self.z, self.rx, self.ry, self.rz];
        let velocity = [self.vx, self.vy, self.vz, self.vrx, self.vry, self.vrz];
        for (i, direction) in (1..=6).enumerate() {
            let Some(row) = network.node_row(at, direction) else {
                for (prefix, value) in [("", displacement[i]), ("v", velocity[i])] {
                    if value != 0.0 {
                        let message = "the node does not have this degree of freedom";
                        let key = format!("{path}.{prefix}{}", AXES[i]);
                        problems.push(Problem::new(key, message).of(value).help("leave it out"));
                    }
                }
                continue;
            };
            let one = &mut network.superelements[at.superelement];
            (one.displacement[row], one.velocity[row]) = (displacement[i], velocity[i]);
        }
    }
}

/// Initial value and rate of a modal coordinate of a superelement, relative to the equilibrium.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ModeInitial {
    /// The modal coordinate, as "pad.1", counted from 1.
    mode: String,
    /// Value of the coordinate.
    #[serde(default)]
    q: f64,
    /// Rate of the coordinate, 1/s.
    #[serde(default)]
    v: f64,
}

impl ModeInitial {
    fn apply(&self, at: ModeAt, network: &mut Network) {
        network.started.modes.push(at);
        if let Some(row) = network.mode_row(at) {
            let one = &mut network.superelements[at.superelement];
            (one.displacement[row], one.velocity[row]) = (self.q, self.v);
        }
    }
}

/// A part with initial values: a module or mass by its index, a node or a mode.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Subject {
    Part(usize),
    Node(NodeAt),
    Mode(ModeAt),
}

/// Gives the parts their initial values. Returns the index of the `[[initial]]` of each part.
pub(super) fn apply(
    all: &[Initial],
    structure: &mut Structure,
    names: &mut Names<'_>,
) -> HashMap<Subject, usize> {
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
                ("module", values.module.to_string(), owner.map(Subject::Part))
            }
            (Initial::Mass(values), Structure::Network(_)) => {
                let owner = names.mass(|| path("mass"), &values.mass);
                ("mass", quoted(&values.mass), owner.map(Subject::Part))
            }
            (Initial::Node(values), Structure::Network(_)) => {
                let (name, node) = values.node.split_once('.').unwrap_or((&values.node, ""));
                let owner = names.node(|| path("node"), name, node);
                ("node", quoted(&values.node), owner.map(Subject::Node))
            }
            (Initial::Mode(values), Structure::Network(_)) => {
                let owner = names.mode(|| path("mode"), &values.mode);
                ("mode", quoted(&values.mode), owner.map(Subject::Mode))
            }
            (Initial::Node(_) | Initial::Mode(_), Structure::Ring(_)) => {
                let key = if matches!(initial, Initial::Node(_)) { "node" } else { "mode" };
                let problem = Problem::new(path(key), "a ring has no superelements");
                let help = "give the number of a module, as `module = 1`, and x1 … x4 or v1 … v4";
                names.problems.push(problem.help(help));
                continue;
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
        match (initial, owner, &mut *structure) {
            (Initial::Module(values), Subject::Part(owner), Structure::Ring(modules)) => {
                values.apply(&mut modules[owner]);
            }
            (Initial::Mass(values), Subject::Part(owner), Structure::Network(network)) => {
                values.apply(&mut network.masses[owner]);
            }
            (Initial::Node(values), Subject::Node(at), Structure::Network(network)) => {
                let path = format!("initial[{}]", i + 1);
                values.apply(at, network, &path, &mut names.problems);
            }
            (Initial::Mode(values), Subject::Mode(at), Structure::Network(network)) => {
                values.apply(at, network);
            }
            _ => {}
        }
    }
    homes
}
