//! A structure as its matrices give it.

use crate::sparse::Sparse;
use amontons::Error;
use amontons_matrices::{Freedom, Matrix};
use std::collections::BTreeSet;

/// Rounding of printed digits that counts as symmetric, as a part of the diagonal.
const SYMMETRIC: f64 = 1e-9;

/// An undamped structure: M q̈ + K q = f with symmetric matrices, M positive definite.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    pub(super) stiffness: Sparse,
    pub(super) mass: Sparse,
    pub(super) freedoms: Vec<Freedom>,
}

impl Structure {
    /// A structure of matrices from files whose rows are [aligned](amontons_matrices::align). The stiffness matrix names the
    /// rows, or the mass matrix; if neither does, each row is a scalar point with the row's number, counted from 1.
    ///
    /// # Errors
    /// Returns an error if the matrices are not square, of one size and symmetric, or if a degree of freedom has no mass.
    pub fn new(stiffness: &Matrix, mass: &Matrix) -> Result<Self, Error> {
        let order = stiffness.rows;
        for (matrix, what) in [(stiffness, "stiffness"), (mass, "mass")] {
            if matrix.rows != matrix.columns || matrix.rows != order {
                return Err(Error::analysis(format!(
                    "the {what} matrix has {} rows and {} columns, and the stiffness matrix {order} rows; both must be square and \
                     of one size",
                    matrix.rows, matrix.columns
                )));
            }
        }
        let freedoms =
            stiffness.freedoms.clone().or_else(|| mass.freedoms.clone()).unwrap_or_else(|| {
                (1..=order as u64).map(|node| Freedom { node, direction: 0 }).collect()
            });
        let structure = Self {
            stiffness: symmetric(stiffness, "stiffness", &freedoms)?,
            mass: symmetric(mass, "mass", &freedoms)?,
            freedoms,
        };
        structure.check_order()?;
        structure.check_masses()?;
        structure.check_springs()?;
        Ok(structure)
    }

    /// The degree of freedom of each row.
    #[must_use]
    pub fn freedoms(&self) -> &[Freedom] {
        &self.freedoms
    }

    /// The rows of nodes, in ascending order.
    ///
    /// # Errors
    /// Returns an error if the structure has no row of a node.
    pub fn rows_of(&self, nodes: &[u64]) -> Result<Vec<usize>, Error> {
        let sorted: BTreeSet<u64> = nodes.iter().copied().collect();
        let known: BTreeSet<u64> = self.freedoms.iter().map(|freedom| freedom.node).collect();
        if let Some(missing) = sorted.difference(&known).next() {
            return Err(Error::analysis(format!(
                "the matrices have no node {missing}; their nodes go from {} to {}",
                known.first().unwrap_or(&0),
                known.last().unwrap_or(&0)
            )));
        }
        Ok((0..self.freedoms.len())
            .filter(|&row| sorted.contains(&self.freedoms[row].node))
            .collect())
    }

    /// Reports matrices that are given in each other's place. A translation of all nodes has the kinetic energy of the whole mass,
    /// and strains a structure at its supports alone.
    fn check_order(&self) -> Result<(), Error> {
        /// The part of the entries that is left of a translation, of the matrix with less of it, beside the other.
        const FEW: f64 = 0.1;
        let moved = |matrix: &Sparse, axis: u8| {
            let is_along = |row: usize| self.freedoms[row].direction == axis;
            let columns = (0..matrix.rows()).filter(|&column| is_along(column));
            let entries = columns.flat_map(|column| matrix.column(column));
            let values = entries.filter(|&(row, _)| is_along(row)).map(|(_, value)| value);
            let [sum, size] = values.fold([0.0_f64; 2], |[sum, size], v| [sum + v, size + v.abs()]);
            (size > 0.0).then_some(sum.abs() / size)
        };
        let axes =
            (1..=3).filter_map(|axis| moved(&self.stiffness, axis).zip(moved(&self.mass, axis)));
        let mut axes = axes.peekable();
        if axes.peek().is_some() && axes.all(|(stiffness, mass)| mass < FEW * stiffness) {
            return Err(Error::analysis(
                "the matrices seem to be in each other's place: the mass matrix cancels when all nodes move alike, as a stiffness \
                 matrix does, and the stiffness matrix does not; give the stiffness as --stiffness and the mass as --mass",
            ));
        }
        Ok(())
    }

    /// Each degree of freedom needs a mass: the bounds of eigenvalues are measured with the inverse of M.
    fn check_masses(&self) -> Result<(), Error> {
        let without: Vec<usize> =
            (0..self.mass.rows()).filter(|&row| self.mass.entry(row, row) <= 0.0).collect();
        let Some(&first) = without.first() else { return Ok(()) };
        Err(Error::analysis(format!(
            "{} degrees of freedom have no mass or a negative one, the first is row {}, {}; remove them by static condensation \
             in the program that wrote the matrices",
            without.len(),
            first + 1,
            name(self.freedoms[first])
        )))
    }

    /// A row of mass alone is a mistake: of another model, or of a node that no element has.
    fn check_springs(&self) -> Result<(), Error> {
        let without: Vec<usize> = (0..self.stiffness.rows())
            .filter(|&row| self.stiffness.column(row).all(|(_, value)| value == 0.0))
            .collect();
        let Some(&first) = without.first() else { return Ok(()) };
        Err(Error::analysis(format!(
            "{} degrees of freedom have mass but no stiffness, the first is row {}, {}; check that both matrices are of one model, and \
             remove nodes without elements",
            without.len(),
            first + 1,
            name(self.freedoms[first])
        )))
    }
}

/// A degree of freedom in a message.
pub(super) fn name(freedom: Freedom) -> String {
    match freedom.direction {
        0 => format!("point {}", freedom.node),
        direction => format!("direction {direction} of node {}", freedom.node),
    }
}

/// The matrix, with the rounding of its digits evened out.
fn symmetric(matrix: &Matrix, what: &str, freedoms: &[Freedom]) -> Result<Sparse, Error> {
    let sparse = Sparse::new(matrix)?;
    let Some((row, column)) = sparse.asymmetry(SYMMETRIC) else {
        return Ok(sparse.sum(0.5, &sparse.transposed(), 0.5));
    };
    Err(Error::analysis(format!(
        "the {what} matrix is not symmetric: row {} ({}) and column {} ({}) hold {}, and their transpose {}; only symmetric \
             structures can be reduced",
        row + 1,
        name(freedoms[row]),
        column + 1,
        name(freedoms[column]),
        sparse.entry(row, column),
        sparse.entry(column, row)
    )))
}
