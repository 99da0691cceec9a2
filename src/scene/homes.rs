//! Places in a scene file of the values of a scene.

use super::check::{Owner, with_key};
use super::initial_file::Subject;
use super::{ContactDefinition, Structure};
use std::collections::HashMap;

/// The places of parts in the file.
pub(super) struct Homes {
    /// The index of the `[[initial]]` of each part.
    initial: HashMap<Subject, usize>,
    /// The set of each contact; `None` for a `[[contact]]`.
    sets: Vec<Option<usize>>,
}

impl Homes {
    /// The places in a file whose `[[initial]]` belong to these parts, by their indices.
    pub(super) fn of(structure: &Structure, initial: HashMap<Subject, usize>) -> Self {
        let sets = match structure {
            Structure::Ring(_) => Vec::new(),
            Structure::Network(network) => network.contacts.iter().map(|place| place.set).collect(),
        };
        Self { initial, sets }
    }

    /// The key of a part's value in the file.
    pub(super) fn key_of(&self, part: Owner, key: &str) -> String {
        let initial =
            |subject| format!("initial[{}]", self.initial.get(&subject).map_or(0, |home| home + 1));
        let part = match part {
            Owner::Module(i) => return format!("ring.{key}[{}]", i + 1),
            Owner::InitialOfModule(owner) | Owner::InitialOfMass(owner) => {
                initial(Subject::Part(owner))
            }
            Owner::InitialOfNode(at) => initial(Subject::Node(at)),
            Owner::InitialOfSuperelement(_) => "initial".to_owned(),
            Owner::Superelement(i) => format!("superelement[{}]", i + 1),
            Owner::ContactSet(i) => format!("contact_set[{}]", i + 1),
            Owner::Mass(i) => format!("mass[{}]", i + 1),
            Owner::Spring(i) => format!("spring[{}]", i + 1),
            Owner::Damper(i) => format!("damper[{}]", i + 1),
            Owner::Contact(i) => contact_path(i, self.sets.get(i).copied().flatten()),
        };
        with_key(part, key)
    }
}

/// The table of a contact: its own, or that of its set.
pub(super) fn contact_path(contact: usize, set: Option<usize>) -> String {
    match set {
        Some(set) => format!("contact_set[{}]", set + 1),
        None => format!("contact[{}]", contact + 1),
    }
}

/// `true` if the contact takes a value from the table: `[slider]`, or else `[friction]`.
pub(super) fn needs(place: &ContactDefinition, table: &str) -> bool {
    match table {
        "slider" => (place.angle.is_none() && place.axes.is_none()) || place.velocity.is_none(),
        _ => place.friction.is_none(),
    }
}
