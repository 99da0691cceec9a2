//! Points by the names that a scene file gives them: `pad` is a mass, `pad.17` is a node of a superelement.

use super::nearest::nearest;
use super::network_check::{NO_SUCH_MASS, quoted};
use super::{GROUND, ModeAt, NodeAt, Point, Problem, Superelement};
use std::collections::HashMap;

/// A point that does not exist.
pub(super) const NOWHERE: Point = Point::Mass(usize::MAX);
/// Largest number of names that a help lists.
const MAX_LISTED: usize = 12;

/// Points by name, and the problems of unknown names.
pub(super) struct Names<'a> {
    places: HashMap<&'a str, usize>,
    masses: Vec<&'a str>,
    superelements: &'a [Superelement],
    pub(super) problems: Vec<Problem>,
}

impl<'a> Names<'a> {
    pub(super) fn of(masses: Vec<&'a str>, superelements: &'a [Superelement]) -> Self {
        let mut places = HashMap::new();
        for (place, mass) in masses.iter().enumerate() {
            places.entry(*mass).or_insert(place);
        }
        Self { places, masses, superelements, problems: Vec::new() }
    }

    /// The point of this name. If there is none, a problem is added and the point with a similar name is returned.
    pub(super) fn point(&mut self, path: impl FnOnce() -> String, name: &str) -> Option<Point> {
        if let Some((superelement, node)) = name.split_once('.') {
            return self.node(path, superelement, node).map(Point::Node);
        }
        let whole = self.superelements.iter().position(|one| one.name == name);
        if let Some(whole) = whole.filter(|_| !self.places.contains_key(name)) {
            let problem = Problem::new(path(), "is a superelement; name one of its nodes");
            let help = format!("write \"{name}.NODE\": {}", self.nodes_of(whole));
            self.problems.push(problem.of(quoted(name)).help(help));
            return None;
        }
        self.mass(path, name).map(Point::Mass)
    }

    /// Index of the mass of this name. If there is none, a problem is added and the index of the mass with a similar
    /// name is returned.
    pub(super) fn mass(&mut self, path: impl FnOnce() -> String, name: &str) -> Option<usize> {
        if let Some(&place) = self.places.get(name) {
            return Some(place);
        }
        let meant = nearest(name, self.masses.iter().copied()).map(|name| self.places[name]);
        let help = match meant {
            Some(place) => format!("did you mean {}?", quoted(self.masses[place])),
            None => self.list(),
        };
        self.problems.push(Problem::new(path(), NO_SUCH_MASS).of(quoted(name)).help(help));
        meant
    }

    /// Index of the superelement of this name. If there is none, a problem is added.
    pub(super) fn superelement(
        &mut self,
        path: impl FnOnce() -> String,
        name: &str,
    ) -> Option<usize> {
        let place = self.superelements.iter().position(|one| one.name == name);
        if place.is_none() {
            let names = || self.superelements.iter().map(|one| &*one.name);
            let help = match nearest(name, names()) {
                Some(meant) => format!("did you mean {}?", quoted(meant)),
                None if self.superelements.is_empty() => {
                    "the scene has no superelements".to_owned()
                }
                None => {
                    let names: Vec<&str> = names().take(MAX_LISTED).collect();
                    format!("the superelements are {}", names.join(", "))
                }
            };
            let problem = Problem::new(path(), "there is no superelement of this name");
            self.problems.push(problem.of(quoted(name)).help(help));
        }
        place
    }

    /// The node of a superelement; a problem is added if there is none.
    pub(super) fn node(
        &mut self,
        path: impl FnOnce() -> String,
        superelement: &str,
        node: &str,
    ) -> Option<NodeAt> {
        let mut place = Some(path);
        let at = self.superelement(|| place.take().expect("it is called once")(), superelement)?;
        let path = place?;
        let found = node.parse().ok().filter(|node| self.has_node(at, *node));
        match found {
            Some(node) => Some(NodeAt { superelement: at, node }),
            None => {
                let problem = Problem::new(path(), no_such_node(&self.superelements[at]));
                let named = format!("{superelement}.{node}");
                self.problems.push(problem.of(quoted(&named)).help(self.nodes_of(at)));
                None
            }
        }
    }

    /// The node with this number; a problem is added if there is none.
    pub(super) fn node_number(
        &mut self,
        path: impl FnOnce() -> String,
        superelement: usize,
        node: u64,
    ) -> Option<NodeAt> {
        if self.has_node(superelement, node) {
            return Some(NodeAt { superelement, node });
        }
        let problem = Problem::new(path(), no_such_node(&self.superelements[superelement]));
        self.problems.push(problem.of(node).help(self.nodes_of(superelement)));
        None
    }

    /// The modal coordinate of this name, `pad.3`, counted from 1; a problem is added if there is none.
    pub(super) fn mode(&mut self, path: impl FnOnce() -> String, name: &str) -> Option<ModeAt> {
        let (superelement, mode) = name.split_once('.').unwrap_or((name, ""));
        let mut place = Some(path);
        let at = self.superelement(|| place.take().expect("it is called once")(), superelement)?;
        let path = place?;
        let freedoms = self.superelements[at].matrices.freedoms();
        let count = freedoms.iter().filter(|one| one.direction == 0).count();
        let mode = mode.parse::<usize>().ok().filter(|mode| (1..=count).contains(mode));
        if mode.is_none() {
            let message = match count {
                0 => format!("{superelement} has no modal coordinates"),
                _ => format!(
                    "{superelement} has the modal coordinates {superelement}.1 to {superelement}.{count}"
                ),
            };
            self.problems.push(Problem::new(path(), message).of(quoted(name)));
        }
        mode.map(|mode| ModeAt { superelement: at, mode: mode - 1 })
    }

    /// Points at the ends of a spring or damper; `None` for the ground.
    pub(super) fn ends(
        &mut self,
        kind: &str,
        part: usize,
        names: &[String; 2],
    ) -> [Option<Point>; 2] {
        let mut ends = [None; 2];
        for (j, name) in names.iter().enumerate().filter(|(_, name)| *name != GROUND) {
            let path = || format!("{kind}[{}].between[{}]", part + 1, j + 1);
            ends[j] = Some(self.point(path, name).unwrap_or(NOWHERE));
        }
        ends
    }

    fn has_node(&self, superelement: usize, node: u64) -> bool {
        has_node(&self.superelements[superelement], node)
    }

    /// Lists the nodes of a superelement, for a help.
    fn nodes_of(&self, superelement: usize) -> String {
        let freedoms = self.superelements[superelement].matrices.freedoms();
        let of_nodes = freedoms.iter().filter(|one| one.direction != 0);
        let mut nodes: Vec<u64> = of_nodes.map(|one| one.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let more = if nodes.len() > MAX_LISTED { ", …" } else { "" };
        let nodes: Vec<String> = nodes.iter().take(MAX_LISTED).map(u64::to_string).collect();
        if nodes.is_empty() {
            return "it has modal coordinates only; keep nodes with `amontons reduce --retain`"
                .into();
        }
        format!(
            "it has nodes {}{more}; keep others with `amontons reduce --retain`",
            nodes.join(", ")
        )
    }

    /// Lists the names of the masses, for a help.
    fn list(&self) -> String {
        let mut names: Vec<(usize, &str)> =
            self.places.iter().map(|(&name, &place)| (place, name)).collect();
        names.sort_unstable();
        let names: Vec<&str> = names.into_iter().take(MAX_LISTED).map(|(_, name)| name).collect();
        let more = if self.places.len() > MAX_LISTED { ", …" } else { "" };
        match names[..] {
            [] => "the scene has no masses; a node is named as \"SUPERELEMENT.NODE\"".to_owned(),
            [one] => format!("the only mass is {one}"),
            _ => format!("the masses are {}{more}", names.join(", ")),
        }
    }
}

fn no_such_node(superelement: &Superelement) -> String {
    format!("there is no such node in the superelement {}", superelement.name)
}

/// `true` if the superelement has a displacement or rotation of the node.
pub(super) fn has_node(superelement: &Superelement, node: u64) -> bool {
    let freedoms = superelement.matrices.freedoms();
    freedoms.iter().any(|one| one.node == node && one.direction != 0)
}
