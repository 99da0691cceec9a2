//! `[[contact_set]]` of a scene file: contacts of many nodes, from a list or a CSV file of pairs.

#[cfg(feature = "schema")]
use super::Rule as SchemaRule;
use super::names::Names;
use super::network::{dot, unit};
use super::network_check::quoted;
use super::network_file::axes;
use super::node_table::{NodeRow, NodeTable};
use super::source::Folder;
use super::superelement_check::{ASKEW, wrong_axes};
use super::{ContactDefinition, Network, NodeAt, Point, Problem, Rule};
use serde::Deserialize;
use std::collections::HashMap;

/// Contacts of nodes of a superelement, with the slider or with other points. The contact of node 17 in the set `lining` is
/// `lining_17`.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend(
    "oneOf" = [{ "required": ["nodes"] }, { "required": ["pairs"] }],
)))]
#[serde(deny_unknown_fields)]
pub(super) struct ContactSetTable {
    /// Name of the set: a letter, then letters, digits and _.
    name: String,
    /// Name of the superelement whose nodes slide.
    superelement: String,
    /// The point that carries the sliding surfaces, or the superelement whose nodes `pairs` gives; the slider by default.
    on: Option<String>,
    /// Numbers of the nodes.
    nodes: Option<Vec<u64>>,
    /// CSV file beside the scene with one line for each contact: columns node, and some of on, nx, ny, nz, tx, ty, tz, gap,
    /// friction, static_friction and velocity. Values of a line go before those of the table.
    pairs: Option<String>,
    /// Angle of the contacts' tangent against the horizontal, rad; the slider's by default.
    angle: Option<f64>,
    /// Outward normal of the surface that the nodes slide on, of any length; with `tangent` in place of `angle`.
    normal: Option<[f64; 3]>,
    /// Tangent: direction in which the surface slides, of any length; with `normal` in place of `angle`.
    tangent: Option<[f64; 3]>,
    /// Gap in the unloaded position, m; 0 by default.
    #[cfg_attr(feature = "schema", schemars(transform = SchemaRule::OPENING.bounds()))]
    #[serde(default)]
    gap: f64,
    /// Velocity of the sliding surface along the tangent, m/s; the slider's by default.
    velocity: Option<f64>,
    /// Friction coefficient µ; the common one by default.
    #[cfg_attr(feature = "schema", schemars(transform = SchemaRule::FRICTION.bounds()))]
    friction: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ of contacts that do not slide; by default their own µ, or else the common µ_s.
    #[cfg_attr(feature = "schema", schemars(transform = SchemaRule::FRICTION.bounds()))]
    static_friction: Option<f64>,
}

/// Columns of the CSV file besides `node` and `on`.
const COLUMNS: [&str; 10] =
    ["nx", "ny", "nz", "tx", "ty", "tz", "gap", "friction", "static_friction", "velocity"];

/// Surface that the nodes of a set slide on.
enum Surface {
    Slider,
    /// One point for all.
    Point(Point),
    /// A superelement, of which each line names a node.
    Superelement(usize),
}

impl ContactSetTable {
    /// Reports a set without exactly one of `nodes` and `pairs`.
    pub(super) fn unlike_schema(&self, place: usize) -> Option<Problem> {
        let path = format!("contact_set[{}]", place + 1);
        (self.nodes.is_some() == self.pairs.is_some())
            .then(|| Problem::new(path, "needs either `nodes` or `pairs`"))
    }

    /// Adds the contacts of the set to the network.
    pub(super) fn add_to(
        &self,
        place: usize,
        network: &mut Network,
        names: &mut Names<'_>,
        folder: &mut Folder<'_>,
    ) {
        let path = |key: &str| format!("contact_set[{}].{key}", place + 1);
        network.contact_sets.push(self.name.clone());
        let given = (self.normal, self.tangent, self.angle);
        let common = axes(given, || format!("contact_set[{}]", place + 1), &mut names.problems);
        let superelement = names.superelement(|| path("superelement"), &self.superelement);
        let surface = match &self.on {
            None => Some(Surface::Slider),
            Some(on) => match network.superelements.iter().position(|one| one.name == *on) {
                Some(one) => Some(Surface::Superelement(one)),
                None => names.point(|| path("on"), on).map(Surface::Point),
            },
        };
        let (Some(superelement), Some(surface)) = (superelement, surface) else { return };
        let others = network.superelements.iter().enumerate();
        let others = others.filter(|(i, _)| *i != superelement).map(|(_, one)| one.name.clone());
        let mut set = Set {
            table: self,
            place,
            superelement,
            surface,
            common,
            known: HashMap::new(),
            pairs: HashMap::new(),
            others: others.collect(),
        };
        if let Some(nodes) = &self.nodes {
            if let Surface::Superelement(_) = set.surface {
                let message = "is a superelement, of which each contact needs a node of its own";
                let help = "give a CSV file with the columns node and on as `pairs`";
                let on = self.on.as_deref().unwrap_or_default();
                names.problems.push(Problem::new(path("on"), message).of(quoted(on)).help(help));
                return;
            }
            if nodes.is_empty() {
                let help = "name the nodes that slide";
                names.problems.push(Problem::new(path("nodes"), "names no nodes").help(help));
            }
            for (i, node) in nodes.iter().enumerate() {
                let path = || format!("{}[{}]", path("nodes"), i + 1);
                let Some(at) = names.node_number(path, superelement, *node) else { continue };
                let on = set.point();
                network.contacts.push(set.contact(at, on, None, self.gap));
            }
            return;
        }
        let Some(file) = &self.pairs else { return };
        let table = folder.csv(file).and_then(|text| NodeTable::parse(text, true, &COLUMNS));
        let found = table.and_then(|table| {
            table.rows.iter().map(|row| set.of_row(row, names)).collect::<Result<Vec<_>, _>>()
        });
        match found {
            Ok(contacts) => network.contacts.extend(contacts.into_iter().flatten()),
            Err(message) => {
                names.problems.push(Problem::new(path("pairs"), message).of(quoted(file)));
            }
        }
    }
}

/// A set that is being read.
struct Set<'a> {
    table: &'a ContactSetTable,
    place: usize,
    superelement: usize,
    surface: Surface,
    /// Normal and tangent of lines without their own.
    common: Option<[[f64; 3]; 2]>,
    /// Number of contacts of each node so far.
    known: HashMap<u64, usize>,
    /// The contacts of each pair of points so far.
    pairs: HashMap<(NodeAt, Option<Point>), Vec<Joined>>,
    /// Names of the superelements whose nodes do not slide in this set.
    others: Vec<String>,
}

/// A contact of a pair of points.
struct Joined {
    /// Line of the CSV file, from 1.
    line: u64,
    /// Unit normal; `None` for a contact at an angle.
    normal: Option<[f64; 3]>,
}

impl Set<'_> {
    /// The point that all nodes slide on; `None` for the slider.
    fn point(&self) -> Option<Point> {
        match self.surface {
            Surface::Point(point) => Some(point),
            Surface::Slider | Surface::Superelement(_) => None,
        }
    }

    fn contact(
        &mut self,
        at: NodeAt,
        on: Option<Point>,
        axes: Option<[[f64; 3]; 2]>,
        gap: f64,
    ) -> ContactDefinition {
        let table = self.table;
        let count = self.known.entry(at.node).or_insert(0);
        *count += 1;
        let name = match *count {
            1 => format!("{}_{}", table.name, at.node),
            several => format!("{}_{}_{several}", table.name, at.node),
        };
        ContactDefinition {
            name,
            set: Some(self.place),
            mass: Point::Node(at),
            on,
            angle: table.angle.filter(|_| axes.is_none()),
            axes: axes.or(self.common),
            gap,
            velocity: table.velocity,
            friction: table.friction,
            static_friction: table.static_friction,
            is_shown: true,
        }
    }

    /// Says that the set lacks the superelement whose nodes a line gives.
    fn lacks_on(&self, line: u64, text: &str) -> String {
        let example = match &self.others[..] {
            [one] => format!("write `on = {}`", quoted(one)),
            [] => "write the name of the superelement as `on`".to_owned(),
            several => format!("write `on` with one of the superelements {}", several.join(", ")),
        };
        format!(
            "line {line}, column `on`: `{text}` is the number of a node, but `on` of the contact set is missing; {example}, or a \
             point such as `NAME.{text}` into the column"
        )
    }

    /// The line before this one that joins the same two points along the same normal, if there is one; else keeps this line. Lines of
    /// which one has axes of its own and the other has not are compared where the angle of the slider is known.
    fn known_pair(
        &mut self,
        line: u64,
        points: (NodeAt, Option<Point>),
        own: Option<[[f64; 3]; 2]>,
    ) -> Option<u64> {
        let normal = own.or(self.common).map(|[normal, _]| unit(normal));
        let joined = self.pairs.entry(points).or_default();
        let is_same = |other: &&Joined| match (normal, other.normal) {
            (Some(one), Some(other)) => dot(one, other) > 1.0 - ASKEW,
            (one, other) => one.is_none() && other.is_none(),
        };
        let first = joined.iter().find(is_same).map(|other| other.line);
        if first.is_none() {
            joined.push(Joined { line, normal });
        }
        first
    }

    /// The contact of a line of the CSV file; `None` if a problem of its nodes has been added to `names`.
    fn of_row(
        &mut self,
        row: &NodeRow,
        names: &mut Names<'_>,
    ) -> Result<Option<ContactDefinition>, String> {
        let line = row.line;
        let own = match (row.vector(0, "normal")?, row.vector(3, "tangent")?) {
            (Some(normal), Some(tangent)) => Some([normal, tangent]),
            (None, None) => None,
            _ => return Err(format!("line {line}: normal and tangent are given together")),
        };
        for (column, rule) in [(6, Rule::OPENING), (7, Rule::FRICTION), (8, Rule::FRICTION)] {
            if let Some(wish) = row.value(column).and_then(|value| rule.broken_by(value)) {
                return Err(format!("line {line}, column `{}`: {wish}", COLUMNS[column]));
            }
        }
        let path = format!("contact_set[{}].pairs", self.place + 1);
        let file = quoted(self.table.pairs.as_deref().unwrap_or_default());
        if let Some((fault, help)) = own.and_then(wrong_axes) {
            let problem = Problem::new(path, format!("line {line}: {fault}")).of(file).help(help);
            names.problems.push(problem);
            return Ok(None);
        }
        let before = names.problems.len();
        let at = names.node_number(|| path.clone(), self.superelement, row.node);
        let on = match (&row.on, &self.surface) {
            (None, Surface::Superelement(_)) => {
                return Err(format!("line {line}: the column `on` lacks the number of a node"));
            }
            (None, _) => self.point(),
            (Some(text), Surface::Slider) if text.parse::<u64>().is_ok() => {
                return Err(self.lacks_on(line, text));
            }
            (Some(text), Surface::Superelement(one)) if !text.contains('.') => {
                let node = text.parse().map_err(|_| {
                    format!("line {line}, column `on`: `{text}` is not the number of a node")
                })?;
                names.node_number(|| path.clone(), *one, node).map(Point::Node)
            }
            (Some(text), _) => names.point(|| path.clone(), text),
        };
        if names.problems.len() > before {
            for problem in &mut names.problems[before..] {
                let value = problem.value.replace(file.clone()).unwrap_or_default();
                problem.message = format!("line {line}, {value}: {}", problem.message);
            }
            return Ok(None);
        }
        let Some(at) = at else { return Ok(None) };
        if let Some(first) = self.known_pair(line, (at, on), own) {
            let message =
                format!("line {line}: joins the same points along the same normal as line {first}");
            names.problems.push(Problem::new(path, message).of(file).help("leave one of them out"));
            return Ok(None);
        }
        let contact = self.contact(at, on, own, row.value(6).unwrap_or(self.table.gap));
        Ok(Some(ContactDefinition {
            friction: row.value(7).or(contact.friction),
            static_friction: row.value(8).or(contact.static_friction),
            velocity: row.value(9).or(contact.velocity),
            ..contact
        }))
    }
}
