//! Meshes: nodes with their places, and cells between them.
//!
//! [`Mesh::open`] reads them from input files of Abaqus and CalculiX, [`Mesh::surface`] gives the faces that can be seen, and
//! [`write_vtu`] writes a mesh with values at its nodes for ParaView.
//!
//! ```
//! use amontons_matrices::mesh::{Shape, inp};
//!
//! let deck = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
//! let mesh = inp::read(deck.as_bytes())?;
//! assert_eq!(mesh.cells[0].shape, Shape::Tetrahedron);
//! assert_eq!(mesh.surface().len(), 4);
//! # Ok::<(), amontons_matrices::Fault>(())
//! ```

pub mod inp;
mod shape;
mod vtu;

pub use shape::Shape;
pub use vtu::{Field, write_pvd, write_vtu};

use crate::{Error, Fault};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::Path;

/// Nodes and the cells between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The number of each node, ascending.
    pub nodes: Vec<u64>,
    /// The place of each node: x, y and z in the unit of length of the file.
    pub points: Vec<[f64; 3]>,
    /// The cells.
    pub cells: Vec<Cell>,
}

/// A finite element as a picture needs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The form of the cell.
    pub shape: Shape,
    /// Its nodes, as positions in [`Mesh::nodes`], in the order of Abaqus.
    pub nodes: Vec<usize>,
}

impl Mesh {
    /// Reads the mesh of an input file of Abaqus or CalculiX (`.inp`); see [`inp`].
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is wrong.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let content = fs::read(path).map_err(|error| {
            Error::new(path, Fault::whole(format!("cannot read the file: {error}")))
        })?;
        inp::read(&content).map_err(|fault| Error::new(path, fault))
    }

    /// The position of the node with this number.
    #[must_use]
    pub fn position(&self, node: u64) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// The faces that belong to one solid cell alone, and all flat cells. Each face has its corners in order, against the clock
    /// as seen from outside; nodes between corners are left out.
    #[must_use]
    pub fn surface(&self) -> Vec<Vec<usize>> {
        let mut once: BTreeMap<Vec<usize>, Option<Vec<usize>>> = BTreeMap::new();
        let mut flat = Vec::new();
        for cell in &self.cells {
            for face in cell.shape.faces() {
                let face: Vec<usize> = face.iter().map(|&corner| cell.nodes[corner]).collect();
                if !cell.shape.is_solid() {
                    flat.push(face);
                    continue;
                }
                let mut key = face.clone();
                key.sort_unstable();
                match once.entry(key) {
                    Entry::Vacant(place) => {
                        place.insert(Some(face));
                    }
                    Entry::Occupied(mut place) => {
                        place.insert(None);
                    }
                }
            }
        }
        once.into_values().flatten().chain(flat).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cubes beside each other along x.
    fn cubes() -> Mesh {
        let mut deck = String::from("*NODE\n");
        for (number, x, y, z) in (0..12).map(|at| (at + 1, at % 3, at / 3 % 2, at / 6)) {
            deck += &format!("{number}, {x}, {y}, {z}\n");
        }
        deck += "*ELEMENT, TYPE=C3D8\n1, 1, 2, 5, 4, 7, 8, 11, 10\n2, 2, 3, 6, 5, 8, 9, 12, 11\n";
        inp::read(deck.as_bytes()).unwrap()
    }

    #[test]
    fn the_face_between_two_cells_is_not_of_the_surface() {
        let mesh = cubes();
        let surface = mesh.surface();
        assert_eq!(surface.len(), 10);
        let between = |face: &Vec<usize>| face.iter().all(|&node| mesh.points[node][0] == 1.0);
        assert!(!surface.iter().any(between));
    }

    /// By Gauss the flux of the position through a surface whose faces look outwards is three times the volume inside.
    #[test]
    fn faces_look_outwards() {
        let solids = [
            ("C3D4", 4, 1.0 / 6.0),
            ("C3D6", 6, 0.5),
            ("C3D8", 8, 1.0),
            ("C3D10", 10, 1.0 / 6.0),
            ("C3D15", 15, 0.5),
            ("C3D20R", 20, 1.0),
        ];
        let corners: [&[[u8; 3]]; 3] = [
            &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
            &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
            &[
                [0, 0, 0],
                [1, 0, 0],
                [1, 1, 0],
                [0, 1, 0],
                [0, 0, 1],
                [1, 0, 1],
                [1, 1, 1],
                [0, 1, 1],
            ],
        ];
        for (at, (kind, count, volume)) in solids.into_iter().enumerate() {
            let mut deck = String::from("*NODE\n");
            let corners = corners[at % 3];
            for node in 0..count {
                let [x, y, z] = corners.get(node).copied().unwrap_or_default();
                deck += &format!("{}, {x}, {y}, {z}\n", node + 1);
            }
            let nodes: Vec<String> = (1..=count).map(|node| node.to_string()).collect();
            deck += &format!("*ELEMENT, TYPE={kind}\n1, {}\n", nodes.join(", "));
            let mesh = inp::read(deck.as_bytes()).unwrap();
            let mut flux = 0.0;
            for face in mesh.surface() {
                let place = |at: usize| mesh.points[face[at]];
                for last in 2..face.len() {
                    let [a, b, c] = [place(0), place(last - 1), place(last)];
                    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|i| end[i] - a[i]));
                    let normal = [0, 1, 2].map(|i| {
                        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                        0.5 * (u[j] * v[k] - u[k] * v[j])
                    });
                    flux += (0..3).map(|i| normal[i] * (a[i] + b[i] + c[i]) / 3.0).sum::<f64>();
                }
            }
            assert!((flux - 3.0 * volume).abs() < 1e-15, "{kind}: {flux}");
        }
    }
}
