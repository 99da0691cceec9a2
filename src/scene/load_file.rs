//! `[[load]]` of a scene file: constant forces on nodes of superelements.

use super::names::Names;
use super::network_check::quoted;
use super::node_table::NodeTable;
use super::source::Folder;
use super::{Network, NodeAt, Problem, Rule};
use serde::Deserialize;
use std::collections::HashSet;

/// Constant forces on nodes of a superelement, which are part of the equilibrium: a force on each node, or a pressure.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(extend(
    "oneOf" = [
        { "required": ["nodes", "force"] },
        { "required": ["nodes", "pressure", "area", "normal"] },
        { "required": ["pressure", "areas"], "not": { "required": ["normal"] } },
        { "required": ["pressure", "areas", "normal"] },
    ],
)))]
#[serde(deny_unknown_fields)]
pub(super) struct LoadTable {
    /// Name of the superelement.
    superelement: String,
    /// Numbers of the nodes.
    nodes: Option<Vec<u64>>,
    /// Force on each of the nodes along x, y and z, N.
    force: Option<[f64; 3]>,
    /// Pressure on the surface, Pa; it pushes against the outward normal.
    pressure: Option<f64>,
    /// Area of all nodes together, m²; each has an equal part.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::Positive.bounds()))]
    area: Option<f64>,
    /// Outward normal of the surface, of any length.
    normal: Option<[f64; 3]>,
    /// CSV file beside the scene with the columns node and area (m²), and nx, ny, nz where the surface is not plane.
    areas: Option<String>,
}

impl LoadTable {
    /// Reports a load that is not given in exactly one way.
    pub(super) fn unlike_schema(&self, place: usize) -> Option<Problem> {
        let has = [
            self.nodes.is_some(),
            self.force.is_some(),
            self.pressure.is_some(),
            self.area.is_some(),
            self.areas.is_some(),
        ];
        let is_one = match has {
            [true, true, false, false, false] => self.normal.is_none(),
            [true, false, true, true, false] => self.normal.is_some(),
            [false, false, true, false, true] => true,
            _ => false,
        };
        let message = "needs `nodes` with `force`, or `nodes` with `pressure`, `area` and `normal`, or `pressure` with \
                       `areas` and, unless the file has normals, `normal`";
        (!is_one).then(|| Problem::new(format!("load[{}]", place + 1), message))
    }

    /// Adds the forces to the loads of the superelement.
    pub(super) fn add_to(
        &self,
        place: usize,
        network: &mut Network,
        names: &mut Names<'_>,
        folder: &mut Folder<'_>,
    ) {
        let path = |key: &str| format!("load[{}].{key}", place + 1);
        let Some(superelement) = names.superelement(|| path("superelement"), &self.superelement)
        else {
            return;
        };
        let numbers = self.force.into_iter().flatten().chain(self.pressure);
        if !numbers.chain(self.normal.into_iter().flatten()).all(f64::is_finite) {
            let message = "has a number that is not finite";
            names.problems.push(Problem::new(format!("load[{}]", place + 1), message));
            return;
        }
        if let Some(wish) = self.area.and_then(|area| Rule::Positive.broken_by(area)) {
            names.problems.push(Problem::new(path("area"), wish).of(self.area.unwrap_or_default()));
            return;
        }
        if let Some(problem) =
            self.nodes.as_deref().and_then(|nodes| not_a_set(path("nodes"), nodes))
        {
            names.problems.push(problem);
            return;
        }
        let mut forces: Vec<(NodeAt, [f64; 3], String)> = Vec::new();
        if let Some(nodes) = &self.nodes {
            #[allow(clippy::cast_precision_loss)]
            let count = nodes.len() as f64;
            let Some(force) = self.force.or_else(|| self.push(self.area? / count, self.normal?))
            else {
                let message = "must be a vector of some length";
                names.problems.push(Problem::new(path("normal"), message));
                return;
            };
            for (i, node) in nodes.iter().enumerate() {
                let path = format!("{}[{}]", path("nodes"), i + 1);
                let at = names.node_number(|| path.clone(), superelement, *node);
                forces.extend(at.map(|at| (at, force, path)));
            }
        } else if let Some(file) = &self.areas {
            let columns = ["area", "nx", "ny", "nz"];
            let table = folder.csv(file).and_then(|text| NodeTable::parse(text, false, &columns));
            let found = table.and_then(|table| {
                let force = |row: &super::node_table::NodeRow| {
                    let area = row.value(0).filter(|area| *area >= 0.0).ok_or_else(|| {
                        format!("line {}: the area must be a number, not negative", row.line)
                    })?;
                    let normal = row.vector(1, "normal")?.or(self.normal);
                    let force = normal.and_then(|normal| self.push(area, normal));
                    let force = force.ok_or_else(|| {
                        format!("line {}: the normal is missing: give nx, ny, nz, or a `normal` for all", row.line)
                    })?;
                    Ok((row.node, force))
                };
                table.rows.iter().map(force).collect::<Result<Vec<_>, String>>()
            });
            match found {
                Ok(rows) => {
                    for (node, force) in rows {
                        let at = names.node_number(|| path("areas"), superelement, node);
                        forces.extend(at.map(|at| (at, force, path("areas"))));
                    }
                }
                Err(message) => {
                    names.problems.push(Problem::new(path("areas"), message).of(quoted(file)));
                }
            }
        }
        for (at, force, path) in forces {
            for (direction, part) in (1..).zip(force).filter(|(_, part)| *part != 0.0) {
                match network.node_row(at, direction) {
                    Some(row) => network.superelements[superelement].load[row] += part,
                    None => {
                        names.problems.push(lacks(network, at, direction, path.clone()));
                        break;
                    }
                }
            }
        }
    }

    /// The force of the pressure on an area (m²) with this outward normal, N; `None` for a normal without length.
    fn push(&self, area: f64, normal: [f64; 3]) -> Option<[f64; 3]> {
        let length = super::network::dot(normal, normal).sqrt();
        let pressure = self.pressure?;
        (length > 0.0).then(|| normal.map(|part| 0.0 - pressure * area * (part / length)))
    }
}

/// Problem of a list of nodes that is empty or names a node twice.
fn not_a_set(path: String, nodes: &[u64]) -> Option<Problem> {
    if nodes.is_empty() {
        return Some(
            Problem::new(path, "names no nodes").help("name the nodes that the load acts on"),
        );
    }
    let mut known = HashSet::new();
    let i = nodes.iter().position(|node| !known.insert(*node))?;
    let message = format!("node {} stands a second time", nodes[i]);
    let help = "name each node once; write a second [[load]] for a further force on it";
    Some(Problem::new(format!("{path}[{}]", i + 1), message).help(help))
}

/// Problem of a node that has no degree of freedom in a direction (1, 2, 3) in which something acts.
pub(super) fn lacks(network: &Network, at: NodeAt, direction: u8, path: String) -> Problem {
    let name = &network.superelements[at.superelement].name;
    let node = at.node;
    let axis = ["x", "y", "z"][usize::from(direction - 1)];
    let message = format!(
        "node {node} of {name} has no displacement along {axis} among its degrees of freedom"
    );
    let help = "keep all directions of the node when the structure is reduced, or choose another direction";
    Problem::new(path, message).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_of_a_load_is_named_once() {
        let problem =
            |nodes: &[u64]| not_a_set("load[1].nodes".into(), nodes).map(|it| it.to_string());
        assert_eq!(problem(&[7, 12]), None);
        assert!(problem(&[]).unwrap().contains("names no nodes"));
        let twice = problem(&[7, 12, 7]).unwrap();
        assert!(twice.contains("load[1].nodes[3]") && twice.contains("node 7"), "{twice}");
    }
}
