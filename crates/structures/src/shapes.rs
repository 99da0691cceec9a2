//! From the coordinates of a superelement to the motion of all rows of its structure.

use amontons::Error;
use amontons_matrices::{Freedom, Location, Matrix, open, read_freedoms};
use std::path::Path;

/// The file of the motion of all rows for a unit of each coordinate, in the folder of a superelement.
pub const SHAPES: &str = "shapes.npy";
/// The file of the nodes and directions of these rows.
pub const ROWS: &str = "shapes.csv";
/// The file of the nodes and directions of the coordinates.
pub const COORDINATES: &str = "freedoms.csv";

/// The motion of all rows of a structure for a unit of each coordinate of its superelement, in the units of the structure.
pub struct Shapes {
    rows: Vec<Freedom>,
    coordinates: Vec<Freedom>,
    basis: Matrix,
}

impl Shapes {
    /// Reads the shapes in the folder of a superelement, as `amontons reduce --shapes` writes them.
    ///
    /// # Errors
    /// Returns an error if the folder has no shapes, if a file is wrong, or if the files do not belong together: the shapes have
    /// other rows or other coordinates, or a coordinate that is the displacement of a node does not move this node by 1.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        for name in [SHAPES, ROWS] {
            if !folder.join(name).exists() {
                return Err(Error::unusable_file(format!(
                    "{} has no {name}; run amontons reduce with --shapes, which writes it",
                    folder.display()
                )));
            }
        }
        let unusable = |error: amontons_matrices::Error| Error::unusable_file(error.to_string());
        let basis = open(&Location { path: folder.join(SHAPES), name: None }).map_err(unusable)?;
        let table = |name: &str| read_freedoms(&folder.join(name)).map_err(unusable);
        let shapes = Self { rows: table(ROWS)?, coordinates: table(COORDINATES)?, basis };
        shapes.check().map_err(|message| {
            Error::unusable_file(format!(
                "{}: {message}; run amontons reduce with --shapes once more",
                folder.join(SHAPES).display()
            ))
        })?;
        Ok(shapes)
    }

    fn check(&self) -> Result<(), String> {
        for (number, table, of) in [
            (self.basis.rows, ROWS, self.rows.len()),
            (self.basis.columns, COORDINATES, self.coordinates.len()),
        ] {
            let kind = if table == ROWS { "rows" } else { "columns" };
            if number != of {
                return Err(format!("the array has {number} {kind}, and {table} names {of}"));
            }
        }
        // Retained degrees of freedom are coordinates: their rows have a 1 in their own columns.
        let retained = self.basis.entries.iter().filter(|entry| {
            entry.value == 1.0 && self.rows[entry.row] == self.coordinates[entry.column]
        });
        let mut is_retained = vec![false; self.coordinates.len()];
        retained.for_each(|entry| is_retained[entry.column] = true);
        let mut all = self.coordinates.iter().zip(is_retained);
        match all.find(|(coordinate, is_retained)| coordinate.direction != 0 && !is_retained) {
            Some((Freedom { node, direction }, _)) => Err(format!(
                "the shapes are of another superelement: a unit of its coordinate does not move node {node} by 1 in direction \
                 {direction}"
            )),
            None => Ok(()),
        }
    }

    /// Node and direction of each row of the structure.
    #[must_use]
    pub fn rows(&self) -> &[Freedom] {
        &self.rows
    }

    /// Node and direction of each coordinate of the superelement.
    #[must_use]
    pub fn coordinates(&self) -> &[Freedom] {
        &self.coordinates
    }

    /// The motion of all rows for the value of each coordinate.
    #[must_use]
    pub fn motion(&self, values: &[f64]) -> Vec<f64> {
        let mut motion = vec![0.0; self.rows.len()];
        for entry in &self.basis.entries {
            motion[entry.row] += entry.value * values[entry.column];
        }
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons_matrices::{Entry, Symmetry};

    fn freedoms(all: &[(u64, u8)]) -> Vec<Freedom> {
        all.iter().map(|&(node, direction)| Freedom { node, direction }).collect()
    }

    /// Nodes 1 and 2 along x; node 2 is retained, and node 1 moves half as far, or in the mode 3.
    fn shapes() -> Shapes {
        let entries = [(0, 0, 0.5), (1, 0, 1.0), (0, 1, 4.0)];
        let entries = entries.map(|(row, column, value)| Entry { row, column, value });
        Shapes {
            rows: freedoms(&[(1, 1), (2, 1)]),
            coordinates: freedoms(&[(2, 1), (3, 0)]),
            basis: Matrix {
                name: None,
                rows: 2,
                columns: 2,
                entries: entries.to_vec(),
                symmetry: Symmetry::General,
                freedoms: None,
            },
        }
    }

    #[test]
    fn rows_move_by_the_sum_over_all_coordinates() {
        let shapes = shapes();
        assert_eq!(shapes.check(), Ok(()));
        assert_eq!(shapes.motion(&[2.0, 10.0]), [41.0, 2.0]);
    }

    #[test]
    fn shapes_of_another_superelement_are_told() {
        let few = Shapes { rows: freedoms(&[(1, 1)]), ..shapes() };
        let many = Shapes { coordinates: freedoms(&[(2, 1), (3, 0), (4, 0)]), ..shapes() };
        let other = Shapes { coordinates: freedoms(&[(1, 1), (3, 0)]), ..shapes() };
        for (shapes, words) in [
            (few, "has 2 rows, and shapes.csv names 1"),
            (many, "has 2 columns, and freedoms.csv names 3"),
            (other, "does not move node 1 by 1 in direction 1"),
        ] {
            let message = shapes.check().unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
