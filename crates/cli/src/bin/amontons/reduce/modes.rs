//! The modes of the free superelement on the mesh of the model: files for ParaView, and a picture.

use crate::arguments::Reduce;
use amontons::Error;
use amontons_analysis::output;
use amontons_matrices::mesh::{Field, Mesh, write_pvd, write_vtu};
use amontons_pictures::picture::{MeshShape, MeshShapes};
use amontons_structures::nodes::displacements;
use amontons_structures::symmetric::{Structure, Superelement};
use std::fs;

/// The most modes of a picture.
const DRAWN: usize = 12;
/// Modes below this part of the limit are motions of a rigid body or a mechanism, which a picture does not need.
const RIGID: f64 = 1e-3;

/// Writes what `--vtk` and `--picture` ask for.
///
/// # Errors
/// Returns an error if the mesh is of another model, or a file cannot be written.
pub fn write(
    arguments: &Reduce,
    mesh: &Mesh,
    structure: &Structure,
    superelement: &Superelement,
) -> Result<(), Error> {
    let limit = arguments.frequency;
    let mut modes = Vec::new();
    for (frequency, shape) in superelement.free_modes(limit)? {
        modes.push((frequency, displacements(mesh, structure.freedoms(), &shape)?));
    }
    if let Some(folder) = &arguments.vtk {
        fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
        let mut files = Vec::new();
        for (number, (frequency, shape)) in (1..).zip(&modes) {
            let name = format!("mode_{number:03}.vtu");
            let values: Vec<f64> = shape.iter().flatten().copied().collect();
            let displacement = Field { name: "displacement", values: &values, components: 3 };
            output::write(&folder.join(&name), write_vtu(mesh, &[displacement]).as_bytes())?;
            files.push((*frequency, name));
        }
        let listed = files.iter().map(|(frequency, name)| (*frequency, 0, name.as_str()));
        output::write(&folder.join("modes.pvd"), write_pvd(listed).as_bytes())?;
    }
    let Some(path) = &arguments.picture else { return Ok(()) };
    let named = (1..).zip(modes).filter(|(_, (frequency, _))| *frequency > RIGID * limit);
    let drawn: Vec<MeshShape> = named
        .take(DRAWN)
        .map(|(number, (frequency, real)): (usize, _)| MeshShape {
            title: format!("mode {number}: {frequency:.0} Hz"),
            imaginary: vec![[0.0; 3]; real.len()],
            real,
        })
        .collect();
    if drawn.is_empty() {
        return Err(Error::argument(format!(
            "the free superelement has no mode between 0 Hz and {limit} Hz to draw; ask for a higher --frequency"
        )));
    }
    let title = format!("Modes of the free superelement up to {limit} Hz");
    MeshShapes { title, points: mesh.points.clone(), faces: mesh.surface(), modes: drawn }
        .write(path)
}
