//! Rows of several matrices of one structure, numbered alike.

use crate::{Freedom, Matrix};
use std::collections::{BTreeSet, HashMap};

/// Gives matrices whose files name the degrees of freedom of their rows the same rows in the same order: those of all.
///
/// Abaqus and Nastran write only rows that have entries, so a mass matrix can have fewer of them than a stiffness matrix.
/// Matrices without names stay as they are. `files` has the name of each matrix's file, for messages.
///
/// # Errors
/// Returns a sentence if some files name their rows and others do not, since rows in one order may not be in the other's, or
/// if no matrix has the rows of all others, so that they are of different models.
pub fn align(matrices: &mut [&mut Matrix], files: &[impl AsRef<str>]) -> Result<(), String> {
    let named: Vec<&Vec<Freedom>> =
        matrices.iter().filter_map(|matrix| matrix.freedoms.as_ref()).collect();
    if named.is_empty()
        || named.len() == matrices.len() && named.windows(2).all(|pair| pair[0] == pair[1])
    {
        return Ok(());
    }
    if named.len() < matrices.len() {
        return Err(format!(
            "{} of {} files name the nodes and directions of their rows and the others do not, so the order of rows may differ; \
             give the others names with a table of freedoms",
            named.len(),
            matrices.len()
        ));
    }
    let sets = named.iter().map(|freedoms| freedoms.iter().copied().collect::<BTreeSet<Freedom>>());
    let sets: Vec<BTreeSet<Freedom>> = sets.collect();
    let all: BTreeSet<Freedom> = sets.iter().flatten().copied().collect();
    if let Some((place, largest)) = sets.iter().enumerate().max_by_key(|(_, set)| set.len())
        && let Some(lacking) = all.difference(largest).next()
        && let Some(other) = sets.iter().position(|set| set.contains(lacking))
    {
        let [file, other] = [place, other].map(|place| files.get(place).map_or("", AsRef::as_ref));
        let Freedom { node, direction } = lacking;
        return Err(format!(
            "{file} and {other} are of different models: direction {direction} of node {node} is in {other}, and not in {file}, \
             which has the most rows; give files that were written for one model, all before or all after a reduction"
        ));
    }
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
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Entry, Symmetry};

    const FILES: [&str; 2] = ["k.mtx", "m.mtx"];

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
        align(&mut [&mut stiffness, &mut mass], &FILES).unwrap();
        let all = [(1, 1), (1, 3), (2, 1)];
        assert_eq!(stiffness, matrix(&all, &[(0, 1, 4.0), (1, 2, 3.0), (2, 2, 2.0)]));
        assert_eq!(mass, matrix(&all, &[(2, 2, 7.0)]));
    }

    /// The unnamed rows once got the names of the others in ascending order, whatever their own order was.
    #[test]
    fn files_with_and_without_names_are_not_mixed() {
        let mut stiffness = matrix(&[(2, 1), (1, 1)], &[(0, 0, 2.0)]);
        let mut mass = Matrix { freedoms: None, ..stiffness.clone() };
        let refused = align(&mut [&mut stiffness, &mut mass], &FILES).unwrap_err();
        assert!(refused.starts_with("1 of 2 files name the nodes"), "{refused}");
        stiffness.freedoms = None;
        let before = stiffness.clone();
        align(&mut [&mut stiffness, &mut mass], &FILES).unwrap();
        assert_eq!(stiffness, before);
    }

    #[test]
    fn matrices_of_different_models_are_refused() {
        let mut stiffness = matrix(&[(2, 1), (1, 1), (1, 2)], &[]);
        let mut mass = matrix(&[(2, 1), (3, 1)], &[]);
        let refused = align(&mut [&mut stiffness, &mut mass], &FILES).unwrap_err();
        let words = "k.mtx and m.mtx are of different models: direction 1 of node 3 is in m.mtx, and not in k.mtx";
        assert!(refused.starts_with(words), "{refused}");
        assert!(refused.ends_with("all before or all after a reduction"), "{refused}");
    }
}
