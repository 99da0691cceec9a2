//! The points whose motion is measured.

use amontons::Error;
use amontons::assembly::Numbering;
use amontons::model::LumpedModel;
use amontons::scene::{Network, NodeAt, Point, Scene, nearest};

/// Largest number of names that a message lists.
const MOST_LISTED: usize = 12;
/// Degrees of freedom of a module: two of each of its masses.
const OF_MODULE: usize = 4;

/// A mass or a node.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPoint {
    /// The name: `module[1].m2` in a ring, `pad` or `pad.17` in a network.
    pub name: String,
    /// The degrees of freedom of its displacements, which are along axes at right angles.
    pub dofs: Vec<usize>,
    /// For each contact that the point is part of, the components of the normal of its surface.
    pub normals: Vec<Vec<(usize, f64)>>,
}

/// The points of these names or, without names, all masses with a contact, on both of its sides, and the nodes that the
/// scene shows; where these are none, all nodes with a contact.
///
/// # Errors
/// Returns an error if there is no such point; it gives the nearest name, or the names.
pub fn measured_points(scene: &Scene, names: &[String]) -> Result<Vec<MeasuredPoint>, Error> {
    let all = all_points(scene);
    if names.is_empty() {
        let mut usual: Vec<MeasuredPoint> =
            all.iter().filter(|(_, is_usual)| *is_usual).map(|(point, _)| point.clone()).collect();
        if usual.is_empty() {
            let touching = all.into_iter().map(|(point, _)| point);
            usual = touching.filter(|point| !point.normals.is_empty()).collect();
        }
        if usual.is_empty() {
            return Err(Error::argument(format!(
                "{} has no mass and no node with a contact; name points with --points",
                scene.name
            )));
        }
        return Ok(usual);
    }
    let found = |name: &String| {
        let point = all.iter().find(|(point, _)| point.name == *name);
        point.map(|(point, _)| point.clone()).ok_or_else(|| unknown(scene, name, &all))
    };
    names.iter().map(found).collect()
}

fn unknown(scene: &Scene, name: &str, all: &[(MeasuredPoint, bool)]) -> Error {
    let names = || all.iter().map(|(point, _)| &*point.name);
    let help = match nearest(name, names()) {
        Some(meant) => format!("did you mean {meant}?"),
        None if all.len() <= MOST_LISTED => {
            format!("the points are {}", names().collect::<Vec<_>>().join(", "))
        }
        None => {
            let first: Vec<&str> = names().take(MOST_LISTED).collect();
            format!("there are, for example, {}", first.join(", "))
        }
    };
    Error::argument(format!("{} has no point {name}; {help}", scene.name))
}

/// The degrees of freedom of each mass and of each node of a superelement along directions in space.
pub(crate) fn translations(scene: &Scene) -> Vec<Vec<usize>> {
    all_points(scene).into_iter().map(|(point, _)| point.dofs).collect()
}

/// All points, each with `true` if it is among those that are measured without being named.
fn all_points(scene: &Scene) -> Vec<(MeasuredPoint, bool)> {
    let model = LumpedModel::from(scene);
    let point = |name: String, dofs: Vec<usize>| {
        let own = |parts: &[(usize, f64)]| -> Vec<(usize, f64)> {
            parts.iter().copied().filter(|(dof, part)| dofs.contains(dof) && *part != 0.0).collect()
        };
        let normals = model.contacts.iter().map(|contact| own(&contact.normal.0));
        let normals = normals.filter(|normal| !normal.is_empty()).collect();
        MeasuredPoint { name, dofs, normals }
    };
    let Some(network) = scene.network() else {
        let masses = (0..scene.modules().len()).flat_map(|module| {
            [0, 1].map(|mass| {
                let first = OF_MODULE * module + 2 * mass;
                (format!("module[{}].m{}", module + 1, mass + 1), vec![first, first + 1])
            })
        });
        let points = masses.map(|(name, dofs)| point(name, dofs));
        return points.map(|point| (point.clone(), !point.normals.is_empty())).collect();
    };
    let numbering = Numbering::of(network);
    let masses = network.masses.iter().enumerate().map(|(mass, named)| {
        let dofs = [0, 1].into_iter().filter_map(|axis| numbering.dof(mass, axis)).collect();
        let point = point(named.name.clone(), dofs);
        (point.clone(), !point.normals.is_empty())
    });
    let nodes = nodes(network).into_iter().map(|at| {
        let rows = (1..=3).filter_map(|direction| network.node_row(at, direction));
        let dofs = rows.filter_map(|row| numbering.row(at.superelement, row)).collect();
        let point = point(network.point_name(Point::Node(at)), dofs);
        (point, network.shown.nodes.contains(&at))
    });
    masses.chain(nodes).filter(|(point, _)| !point.dofs.is_empty()).collect()
}

/// The nodes of all superelements, each once, in the order of their rows.
fn nodes(network: &Network) -> Vec<NodeAt> {
    let mut nodes = Vec::new();
    for (superelement, one) in network.superelements.iter().enumerate() {
        let displaced =
            one.matrices.freedoms().iter().filter(|one| (1..=3).contains(&one.direction));
        let first = nodes.len();
        for freedom in displaced {
            let at = NodeAt { superelement, node: freedom.node };
            if !nodes[first..].contains(&at) {
                nodes.push(at);
            }
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::{builtin, parse};

    #[test]
    fn the_masses_on_the_slider_are_measured_and_others_by_their_names() {
        let scene = builtin("set1").unwrap().scene();
        let usual = measured_points(&scene, &[]).unwrap();
        let names: Vec<&str> = usual.iter().map(|point| &*point.name).collect();
        assert_eq!(names, ["module[1].m2", "module[2].m2"]);
        // x4 is along the outward normal.
        assert_eq!(
            (&usual[1].dofs[..], &usual[1].normals[..]),
            (&[6, 7][..], &[vec![(7, 1.0)]][..])
        );
        let upper = measured_points(&scene, &["module[1].m1".to_owned()]).unwrap();
        assert!(upper[0].dofs == [0, 1] && upper[0].normals.is_empty());
        let wrong = measured_points(&scene, &["modul[1].m2".to_owned()]).unwrap_err().to_string();
        assert!(wrong.contains("did you mean module[1].m2?"), "{wrong}");
        let far = measured_points(&scene, &["disc".to_owned()]).unwrap_err().to_string();
        assert!(far.contains("the points are module[1].m1, module[1].m2"), "{far}");
    }

    #[test]
    fn both_sides_of_a_contact_have_its_normal() {
        let text = "integrator = { method = \"event-driven\", step = 1e-2 }\n\
                    slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.4 }\n\
                    mass = [{ name = \"pad\", mass = 1.0, force = [0.0, -10.0] }, { name = \"disc\", mass = 2.0 }]\n\
                    spring = [{ name = \"a\", between = [\"pad\", \"ground\"], direction = \"x\", stiffness = 1.0 },\n\
                    { name = \"b\", between = [\"disc\", \"ground\"], direction = \"x\", stiffness = 1.0 },\n\
                    { name = \"c\", between = [\"disc\", \"ground\"], direction = \"y\", stiffness = 1e3 }]\n\
                    contact = [{ name = \"belt\", mass = \"pad\", on = \"disc\" }]\n";
        let scene = parse("two", text).unwrap();
        let [pad, disc] = &measured_points(&scene, &[]).unwrap()[..] else { panic!() };
        assert_eq!((&*pad.name, &*disc.name), ("pad", "disc"));
        assert_eq!(pad.normals, [[(1, 1.0)]]);
        assert_eq!(disc.normals, [[(3, -1.0)]]);
    }
}
