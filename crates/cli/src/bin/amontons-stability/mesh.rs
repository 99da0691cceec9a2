//! The modes of a scene on the meshes of its superelements: files for ParaView, and a picture.

use crate::modes::name_of;
use amontons::Error;
use amontons::assembly::Numbering;
use amontons::scene::{Scene, Superelement, SuperelementFiles, UnitFactors, did_you_mean};
use amontons_analysis::output;
use amontons_analysis::stability::Mode;
use amontons_export::superelement::length_per_unit;
use amontons_matrices::Freedom;
use amontons_matrices::mesh::{Field, Mesh, write_pvd, write_vtu};
use amontons_pictures::picture::{MeshShape, MeshShapes};
use amontons_structures::nodes::{displacements, open_mesh};
use amontons_structures::shapes::Shapes;
use nalgebra::Complex;
use std::fs;
use std::path::{Path, PathBuf};

/// The most modes of a picture.
const DRAWN: usize = 12;
/// The largest amplitude in files for ParaView, as a part of the extent of all meshes.
const REACH: f64 = 0.05;
/// Smaller motions are those of rounding, since the largest coordinate of a mode is 1.
const AT_REST: f64 = 1e-9;
/// Smaller parts of |λ| are growth of rounding.
const GROWS: f64 = 1e-9;

/// A mode and its number in the list of all.
pub type Numbered<'a> = (usize, &'a Mode);

/// The complex amplitude of each node of a mesh along x, y and z.
type Motion = Vec<[Complex<f64>; 3]>;

/// The superelements of a scene whose meshes are known.
pub struct Meshes(Vec<Part>);

/// A superelement on its mesh.
struct Part {
    name: String,
    /// Its places are in m.
    mesh: Mesh,
    shapes: Shapes,
    /// For each coordinate of the shapes, the scene's degree of freedom and the factor with which the shapes give m.
    columns: Vec<(usize, f64)>,
}

impl Meshes {
    /// Reads the given meshes, and the shapes of their superelements. `path` is that of the scene, and `files` are the files
    /// of its superelements.
    ///
    /// # Errors
    /// Returns an error if a mesh is given for no superelement or for one twice, if the superelement has no shapes or others
    /// than its own, or if the mesh lacks a node of the shapes.
    pub fn open(
        given: &[(String, PathBuf)],
        scene: &Scene,
        path: &Path,
        files: &[SuperelementFiles],
    ) -> Result<Self, Error> {
        let mut parts: Vec<Part> = Vec::new();
        for (name, mesh) in given {
            if parts.iter().any(|part| part.name == *name) {
                return Err(Error::argument(format!(
                    "--mesh is given twice for the superelement {name}; give one mesh for each"
                )));
            }
            parts.push(Part::open(name, mesh, scene, path, files)?);
        }
        Ok(Self(parts))
    }

    /// Writes each mode that oscillates on each mesh, and a list of all files with the frequencies as times.
    ///
    /// # Errors
    /// Returns an error if no mode oscillates, or if a file cannot be written.
    pub fn write_vtk(&self, folder: &Path, modes: &[Numbered<'_>]) -> Result<(), Error> {
        let modes = oscillating(modes)?;
        fs::create_dir_all(folder).map_err(|error| Error::file(folder, &error))?;
        let mut files = Vec::new();
        let mut time = f64::NEG_INFINITY;
        for (number, mode) in modes {
            // Two modes that have merged have one frequency, and files of one time are one picture.
            time = mode.frequency_hz().max(time.next_up());
            for (place, (part, motion)) in self.0.iter().zip(self.motions(mode)?).enumerate() {
                let name = format!("mode_{number:03}_{}.vtu", part.name);
                let [real, imaginary] = parts_of(&motion).map(|part| part.concat());
                let field = |name, values| Field { name, values, components: 3 };
                let fields = [
                    field("displacement", &real),
                    field("displacement_quarter_earlier", &imaginary),
                ];
                output::write(&folder.join(&name), write_vtu(&part.mesh, &fields).as_bytes())?;
                files.push((time, place, name));
            }
        }
        let listed = files.iter().map(|(time, place, name)| (*time, *place, name.as_str()));
        output::write(&folder.join("modes.pvd"), write_pvd(listed).as_bytes())
    }

    /// Draws modes that oscillate on all meshes together, the growing ones first.
    ///
    /// # Errors
    /// Returns an error if no mode oscillates, or if the picture cannot be drawn or written.
    pub fn draw(&self, path: &Path, title: String, modes: &[Numbered<'_>]) -> Result<(), Error> {
        let modes = oscillating(modes)?;
        let drawn = drawn(&modes);
        if drawn.len() < modes.len() {
            eprintln!(
                "note: {} of {} modes are drawn, those that grow first; --frequencies A:B chooses others",
                drawn.len(),
                modes.len()
            );
        }
        let shapes = drawn.into_iter().map(|(number, mode)| {
            let [real, imaginary] = parts_of(&self.motions(mode)?.concat());
            Ok(MeshShape { title: name_of((number, mode)), real, imaginary })
        });
        let modes = shapes.collect::<Result<_, Error>>()?;
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for Part { mesh, .. } in &self.0 {
            let shift = points.len();
            points.extend(&mesh.points);
            let moved = |face: Vec<usize>| face.into_iter().map(|corner| corner + shift).collect();
            faces.extend(mesh.surface().into_iter().map(moved).collect::<Vec<Vec<usize>>>());
        }
        MeshShapes { title, points, faces, modes }.write(path)
    }

    /// The motion of each mesh in a mode, all in one scale.
    fn motions(&self, mode: &Mode) -> Result<Vec<Motion>, Error> {
        let mut motions: Vec<Motion> =
            self.0.iter().map(|part| part.motion(mode)).collect::<Result<_, _>>()?;
        let all = || motions.iter().flatten().flatten();
        let largest = all().map(|value| value.norm()).fold(0.0, f64::max);
        let scale = if largest > AT_REST { REACH * self.extent() / largest } else { 0.0 };
        motions.iter_mut().flatten().flatten().for_each(|value| *value *= scale);
        Ok(motions)
    }

    /// The diagonal of the box around all meshes, m.
    fn extent(&self) -> f64 {
        let sides = [0, 1, 2].map(|axis| {
            let places = self.0.iter().flat_map(|part| &part.mesh.points).map(|place| place[axis]);
            let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            });
            high - low
        });
        sides.iter().map(|side| side * side).sum::<f64>().sqrt()
    }
}

impl Part {
    fn open(
        name: &str,
        mesh: &Path,
        scene: &Scene,
        path: &Path,
        files: &[SuperelementFiles],
    ) -> Result<Self, Error> {
        let place = superelements(scene).iter().position(|one| one.name == name);
        let place = place.ok_or_else(|| no_superelement(name, scene))?;
        let (folder, units) = folder_of(name, files)?;
        let shapes = Shapes::open(&path.with_file_name(folder))?;
        let mut mesh = open_mesh(mesh, shapes.rows())?;
        mesh.points.iter_mut().flatten().for_each(|value| *value *= units.length);
        let numbering = scene.network().map(Numbering::of).unwrap_or_default();
        let superelement = &superelements(scene)[place];
        let rows = rows_of(superelement, &shapes)?;
        let columns = rows.into_iter().filter_map(|row| {
            let freedom = superelement.matrices.freedoms()[row];
            Some((numbering.row(place, row)?, length_per_unit(units, freedom)))
        });
        Ok(Self { name: name.to_owned(), mesh, shapes, columns: columns.collect() })
    }

    /// The complex amplitude of each node, m.
    fn motion(&self, mode: &Mode) -> Result<Motion, Error> {
        let one = |part: fn(&Complex<f64>) -> f64| {
            let values = self.columns.iter().map(|(dof, factor)| factor * part(&mode.shape[*dof]));
            let rows = self.shapes.motion(&values.collect::<Vec<_>>());
            displacements(&self.mesh, self.shapes.rows(), &rows)
        };
        let nodes = one(|value| value.re)?.into_iter().zip(one(|value| value.im)?);
        Ok(nodes.map(|(a, b)| [0, 1, 2].map(|axis| Complex::new(a[axis], b[axis]))).collect())
    }
}

/// The modes that oscillate.
fn oscillating<'a>(modes: &[Numbered<'a>]) -> Result<Vec<Numbered<'a>>, Error> {
    let found: Vec<_> =
        modes.iter().copied().filter(|(_, mode)| mode.frequency_hz() > 0.0).collect();
    if found.is_empty() {
        return Err(Error::argument(
            "none of the modes oscillates, and meshes show those that do; choose others with --frequencies or --state",
        ));
    }
    Ok(found)
}

/// The modes of a picture: those that grow, then the others, by number.
fn drawn<'a>(modes: &[Numbered<'a>]) -> Vec<Numbered<'a>> {
    let mut modes = modes.to_vec();
    modes.sort_by_key(|(number, mode)| (-mode.damping_ratio() <= GROWS, *number));
    modes.truncate(DRAWN);
    modes
}

/// Real and imaginary parts.
fn parts_of(motion: &[[Complex<f64>; 3]]) -> [Vec<[f64; 3]>; 2] {
    let part = |of: fn(Complex<f64>) -> f64| motion.iter().map(|node| node.map(of)).collect();
    [part(|value| value.re), part(|value| value.im)]
}

/// The superelements of a scene, in order.
pub fn superelements(scene: &Scene) -> &[Superelement] {
    scene.network().map_or(&[], |network| &network.superelements)
}

/// Names the superelements of a scene.
pub fn superelements_of(scene: &Scene) -> String {
    let names: Vec<&str> = superelements(scene).iter().map(|one| &*one.name).collect();
    match &*names {
        [] => "the scene has no superelement".into(),
        [name] => format!("its superelement is {name}"),
        names => format!("its superelements are {}", names.join(", ")),
    }
}

fn no_superelement(name: &str, scene: &Scene) -> Error {
    let names = superelements(scene).iter().map(|one| &*one.name);
    let help = did_you_mean(name, names).unwrap_or_else(|| superelements_of(scene));
    Error::argument(format!(
        "--mesh names {name}, and {} has no such superelement; {help}",
        scene.name
    ))
}

/// The folder that `amontons reduce` wrote for a superelement, as the scene names it, and the units of its files.
fn folder_of<'a>(
    name: &str,
    files: &'a [SuperelementFiles],
) -> Result<(&'a str, UnitFactors), Error> {
    let wish = "name its folder of amontons reduce --shapes in the scene (folder = \"…\")";
    let Some(files) = files.iter().find(|files| files.name == name) else {
        return Err(Error::argument(format!(
            "the superelement {name} is a packed file, which holds no shapes for a mesh; {wish}"
        )));
    };
    let folder = files.folder.as_deref().ok_or_else(|| {
        Error::argument(format!(
            "the superelement {name} has single files of matrices, without shapes for a mesh; {wish}"
        ))
    })?;
    Ok((folder, files.units))
}

/// The row of the superelement for each coordinate of its shapes.
///
/// # Errors
/// Returns an error if they do not have the same degrees of freedom.
fn rows_of(superelement: &Superelement, shapes: &Shapes) -> Result<Vec<usize>, Error> {
    let Superelement { name, matrices, .. } = superelement;
    let coordinates = shapes.coordinates();
    let row = |&Freedom { node, direction }| matrices.row(node, direction);
    let rows: Option<Vec<usize>> = coordinates.iter().map(row).collect();
    rows.filter(|rows| rows.len() == matrices.dofs()).ok_or_else(|| {
        Error::argument(format!(
            "the superelement {name} has {} degrees of freedom, which are not the {} of the shapes in its folder; use the matrices \
             and freedoms.csv as amontons reduce --shapes wrote them",
            matrices.dofs(),
            coordinates.len()
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_the_modes_that_grow_and_then_the_first_of_the_others() {
        let mode = |growth: f64| Mode {
            eigenvalue: Complex::new(growth, 1000.0),
            stiffness_eigenvalue: Complex::new(1e6, 0.0),
            shape: Vec::new(),
            waves: None,
            residual: 0.0,
        };
        let mut modes: Vec<Mode> = (0..20).map(|_| mode(-1.0)).collect();
        modes[3] = mode(1e-10); // growth of rounding
        modes[14] = mode(2.0);
        modes[17] = mode(5.0);
        let all: Vec<Numbered<'_>> = (1..).zip(&modes).collect();
        let numbers: Vec<usize> = drawn(&all).into_iter().map(|(number, _)| number).collect();
        assert_eq!(numbers, [15, 18, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    }
}
