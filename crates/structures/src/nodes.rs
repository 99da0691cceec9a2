//! The motion of the nodes of a mesh.

use amontons::Error;
use amontons_matrices::Freedom;
use amontons_matrices::mesh::Mesh;
use std::path::Path;

/// Reads the mesh of the structure whose rows are these.
///
/// # Errors
/// Returns an error if the file cannot be read or is wrong, or if a row is a displacement of a node that the mesh does not have.
pub fn open_mesh(path: &Path, freedoms: &[Freedom]) -> Result<Mesh, Error> {
    let mesh = Mesh::open(path).map_err(|error| Error::unusable_file(error.to_string()))?;
    displacements(&mesh, freedoms, &vec![0.0; freedoms.len()])
        .map_err(|error| error.in_words(format!("{}: {error}", path.display())))?;
    Ok(mesh)
}

/// The displacement of each node of a mesh along x, y and z, for the values of the degrees of freedom that the rows of a
/// structure stand for, in the same unit. Nodes without rows are held and rest; rotations and scalar points have no place in a
/// mesh.
///
/// # Errors
/// Returns an error if there is not one value for each row, or if a row is a displacement of a node that the mesh does not have.
pub fn displacements(
    mesh: &Mesh,
    freedoms: &[Freedom],
    values: &[f64],
) -> Result<Vec<[f64; 3]>, Error> {
    if freedoms.len() != values.len() {
        return Err(Error::argument(format!(
            "there are {} values for {} degrees of freedom",
            values.len(),
            freedoms.len()
        )));
    }
    let mut moved = vec![[0.0; 3]; mesh.nodes.len()];
    for (&Freedom { node, direction }, &value) in freedoms.iter().zip(values) {
        if !(1..=3).contains(&direction) {
            continue;
        }
        let position = mesh.position(node).ok_or_else(|| {
            Error::argument(format!(
                "the matrices have node {node}, and the mesh has not, whose nodes go from {} to {}; give the mesh of the model of \
                 which the matrices are",
                mesh.nodes.first().unwrap_or(&0),
                mesh.nodes.last().unwrap_or(&0)
            ))
        })?;
        moved[position][usize::from(direction - 1)] = value;
    }
    Ok(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons_matrices::mesh::inp;

    #[test]
    fn rows_move_their_nodes_and_others_rest() {
        let deck = b"*NODE\n1, 0, 0\n3, 1, 0\n7, 0, 1\n*ELEMENT, TYPE=S3\n1, 1, 3, 7\n";
        let mesh = inp::read(deck).unwrap();
        let freedoms =
            [(7, 2), (3, 1), (7, 4), (9, 0)].map(|(node, direction)| Freedom { node, direction });
        let moved = displacements(&mesh, &freedoms, &[0.5, -1.0, 8.0, 9.0]).unwrap();
        assert_eq!(moved, [[0.0; 3], [-1.0, 0.0, 0.0], [0.0, 0.5, 0.0]]);
        let other = [Freedom { node: 8, direction: 1 }];
        let error = displacements(&mesh, &other, &[1.0]).unwrap_err().to_string();
        assert!(error.contains("node 8") && error.contains("from 1 to 7"), "{error}");
    }
}
