//! `[outputs]` of a scene file: the parts of superelements and the contacts that the FMU shows.

use super::names::Names;
use super::network_check::quoted;
use super::{Network, Point, Problem, nearest};
use serde::Deserialize;

/// Most contacts that are shown unless the scene chooses.
const MOST_CONTACTS: usize = 20;
/// Most outputs of superelements and contacts.
const MOST_OUTPUTS: usize = 200;

/// Parts of a scene with superelements that the FMU shows.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub(super) struct OutputsTable {
    /// Nodes, such as "pad.17", whose displacements and velocities are outputs and which external forces may push; none by
    /// default.
    nodes: Vec<String>,
    /// Modal coordinates, such as "pad.1", counted from 1; none by default.
    modes: Vec<String>,
    /// Contacts and sets of contacts by name; by default all, or none if there are more than 20.
    contacts: Option<Vec<String>>,
}

impl OutputsTable {
    /// Marks what the FMU shows.
    pub(super) fn apply(&self, network: &mut Network, names: &mut Names<'_>) {
        let is_plain = network.superelements.is_empty();
        let path = |key: &str, i: usize| format!("outputs.{key}[{}]", i + 1);
        for (i, name) in self.nodes.iter().enumerate() {
            match names.point(|| path("nodes", i), name) {
                Some(Point::Node(at)) if !network.shown.nodes.contains(&at) => {
                    network.shown.nodes.push(at);
                }
                Some(Point::Mass(_)) => {
                    let message = "is a mass, which the FMU shows in any case";
                    names.problems.push(Problem::new(path("nodes", i), message).of(quoted(name)));
                }
                Some(Point::Node(_)) | None => {}
            }
        }
        for (i, name) in self.modes.iter().enumerate() {
            let mode = names.mode(|| path("modes", i), name);
            let is_new = |mode: &super::ModeAt| !network.shown.modes.contains(mode);
            let mode = mode.filter(is_new);
            network.shown.modes.extend(mode);
        }
        match &self.contacts {
            None if is_plain || network.contacts.len() <= MOST_CONTACTS => {}
            None => network.contacts.iter_mut().for_each(|contact| contact.is_shown = false),
            Some(chosen) => {
                network.contacts.iter_mut().for_each(|contact| contact.is_shown = false);
                for (i, name) in chosen.iter().enumerate() {
                    show(name, network, || path("contacts", i), &mut names.problems);
                }
            }
        }
        let count = outputs(network);
        if !is_plain && count > MOST_OUTPUTS {
            let message = format!(
                "the FMU would have {count} outputs of nodes, modes and contacts, but may have {MOST_OUTPUTS}"
            );
            let help = "choose fewer: [outputs] takes `nodes`, `modes` and `contacts` by name";
            names.problems.push(Problem::new("outputs", message).help(help));
        }
    }
}

/// Shows a contact, or the contacts of a set.
fn show(
    name: &str,
    network: &mut Network,
    path: impl FnOnce() -> String,
    problems: &mut Vec<Problem>,
) {
    let set = network.contact_sets.iter().position(|set| set == name);
    let mut is_known = false;
    for contact in &mut network.contacts {
        if contact.name == name || (set.is_some() && contact.set == set) {
            (contact.is_shown, is_known) = (true, true);
        }
    }
    if !is_known {
        let all = network.contacts.iter().map(|contact| &*contact.name);
        let all = all.chain(network.contact_sets.iter().map(|set| &**set));
        let problem = Problem::new(path(), "there is no contact or set of contacts of this name");
        let help = nearest(name, all).map(|meant| format!("did you mean {}?", quoted(meant)));
        problems.push(problem.of(quoted(name)).help(help.unwrap_or_default()));
    }
}

/// Number of outputs of nodes, modes and contacts.
fn outputs(network: &Network) -> usize {
    let rows = |at: &super::NodeAt| {
        (1..=6).filter(|direction| network.node_row(*at, *direction).is_some()).count()
    };
    let nodes: usize = network.shown.nodes.iter().map(rows).sum();
    let contacts = network.contacts.iter().filter(|contact| contact.is_shown).count();
    2 * (nodes + network.shown.modes.len()) + 4 * contacts
}
