//! Rows of several matrices of one structure, numbered alike.

use crate::{Freedom, Matrix};
use std::collections::{BTreeSet, HashMap};

/// Gives matrices whose files name the degrees of freedom of their rows the same rows in the same order: those of all.
///
/// Abaqus and Nastran write only rows that have entries, so a mass matrix can have fewer of them than a stiffness matrix.
/// Matrices stay as they are if their rows agree already, or if one of the files does not name its rows.
pub fn align(matrices: &mut [&mut Matrix]) {
    let named: Option<Vec<&Vec<Freedom>>> =
        matrices.iter().map(|matrix| matrix.freedoms.as_ref()).collect();
    let Some(named) = named else { return };
    if named.windows(2).all(|pair| pair[0] == pair[1]) {
        return;
    }
    let all: BTreeSet<Freedom> = named.into_iter().flatten().copied().collect();
    let all: Vec<Freedom> = all.into_iter().collect();
    let place: HashMap<Freedom, usize> = all.iter().copied().zip(0..).collect();
    for matrix in matrices {
        let own = matrix.freedoms.take().unwrap_or_default();
        for entry in &mut matrix.entries {
            entry.row = place[&own[entry.row]];
            entry.column = place[&own[entry.column]];
        }
        matrix.entries.sort_by_key(|entry| (entry.column, entry.row));
        (matrix.rows, matrix.columns) = (all.len(), all.len());
        matrix.freedoms = Some(all.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Entry, Symmetry};

    fn matrix(freedoms: &[(u64, u8)], entries: &[(usize, usize, f64)]) -> Matrix {
        let entries = entries.iter().map(|&(row, column, value)| Entry { row, column, value });
        let freedom = |&(node, direction)| Freedom { node, direction };
        Matrix {
            name: None,
            rows: freedoms.len(),
            columns: freedoms.len(),
            entries: entries.collect(),
            symmetry: Symmetry::General,
            freedoms: Some(freedoms.iter().map(freedom).collect()),
        }
    }

    #[test]
    fn a_matrix_with_fewer_rows_gets_those_of_the_other_one() {
        let mut stiffness =
            matrix(&[(2, 1), (1, 3), (1, 1)], &[(0, 0, 2.0), (1, 0, 3.0), (2, 1, 4.0)]);
        let mut mass = matrix(&[(2, 1)], &[(0, 0, 7.0)]);
        align(&mut [&mut stiffness, &mut mass]);
        let all = [(1, 1), (1, 3), (2, 1)];
        assert_eq!(stiffness, matrix(&all, &[(0, 1, 4.0), (1, 2, 3.0), (2, 2, 2.0)]));
        assert_eq!(mass, matrix(&all, &[(2, 2, 7.0)]));
    }

    #[test]
    fn rows_without_names_stay() {
        let mut stiffness = matrix(&[(2, 1), (1, 1)], &[(0, 0, 2.0)]);
        let mut mass = Matrix { freedoms: None, ..matrix(&[(2, 1)], &[(0, 0, 7.0)]) };
        let before = (stiffness.clone(), mass.clone());
        align(&mut [&mut stiffness, &mut mass]);
        assert_eq!((stiffness, mass), before);
    }
}
