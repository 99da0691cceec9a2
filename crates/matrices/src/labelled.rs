//! Matrices whose rows and columns are degrees of freedom.

use crate::builder::Builder;
use crate::{Fault, Freedom, Matrix, Place, Symmetry};
use std::collections::HashSet;
use std::hash::Hash;

/// An entry as a file gives it: the degrees of freedom of its row and its column, its value, and its place.
pub(crate) type Labelled = (Freedom, Freedom, f64, Place);

/// The square matrix of these entries. Its rows are all degrees of freedom that occur, by node and then by direction.
///
/// # Errors
/// Returns a fault as [`Builder`] does.
pub(crate) fn matrix(entries: &[Labelled], symmetry: Symmetry) -> Result<Matrix, Fault> {
    let freedoms = sorted(entries.iter().flat_map(|&(row, column, ..)| [row, column]));
    let mut builder = Builder::labelled(freedoms.clone(), symmetry);
    for &(row, column, value, place) in entries {
        builder.push(position(&freedoms, row), position(&freedoms, column), value, place)?;
    }
    builder.finish()
}

/// Degrees of freedom by node and then by direction, each once.
pub(crate) fn sorted(freedoms: impl Iterator<Item = Freedom>) -> Vec<Freedom> {
    let mut freedoms: Vec<Freedom> = freedoms.collect();
    freedoms.sort_unstable();
    freedoms.dedup();
    freedoms
}

/// The index of a degree of freedom among sorted ones that contain it.
pub(crate) fn position(freedoms: &[Freedom], freedom: Freedom) -> usize {
    freedoms.partition_point(|&other| other < freedom)
}

/// Tells by the places of its entries if a matrix is symmetric whose file does not say so. Programs write one triangle of a
/// symmetric matrix, so that no entry has a partner across the diagonal. A matrix of friction alone has such entries too, but
/// not a diagonal entry in each of its rows.
pub(crate) fn symmetry<T: Copy + Ord + Hash>(
    mut places: impl Iterator<Item = (T, T)> + Clone,
) -> Symmetry {
    let seen: HashSet<(T, T)> = places.clone().collect();
    let is_symmetric = places.all(|(row, column)| {
        let has_partner = row != column && seen.contains(&(column, row));
        !has_partner && seen.contains(&(row, row)) && seen.contains(&(column, column))
    });
    if is_symmetric { Symmetry::Symmetric } else { Symmetry::General }
}
