//! Writes meshes with values at their nodes for ParaView and other programs that read the files of VTK.
//!
//! Source: VTK file formats, XML formats, UnstructuredGrid (docs.vtk.org).

use super::Mesh;
use std::fmt::Write;

/// Values at the nodes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field<'a> {
    /// Its name in the program that shows it.
    pub name: &'a str,
    /// The values, node by node in the order of [`Mesh::nodes`], each of `components` numbers.
    pub values: &'a [f64],
    /// The numbers of a value: 1, or 3 for a vector.
    pub components: usize,
}

/// A mesh with fields as a file of VTK (`.vtu`, text). The field `node` has the numbers of the nodes. Each number is the
/// shortest that reads back as the same double.
///
/// # Panics
/// Panics if a field has not one value for each node.
#[must_use]
pub fn write_vtu(mesh: &Mesh, fields: &[Field<'_>]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n",
    );
    let (points, cells) = (mesh.points.len(), mesh.cells.len());
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    text += "<PointData>\n";
    array(&mut text, "Int64", "node", 1, mesh.nodes.iter());
    for &Field { name, values, components } in fields {
        assert_eq!(values.len(), components * points, "one value for each node");
        array(&mut text, "Float64", name, components, values.iter().map(Double));
    }
    text += "</PointData>\n<Points>\n";
    array(&mut text, "Float64", "place", 3, mesh.points.iter().flatten().map(Double));
    text += "</Points>\n<Cells>\n";
    let nodes = mesh.cells.iter().flat_map(|cell| {
        // VTK has the middle of a line last.
        let mut nodes = cell.nodes.clone();
        if cell.shape == super::Shape::QuadraticLine {
            nodes.swap(1, 2);
        }
        nodes
    });
    array(&mut text, "Int64", "connectivity", 1, nodes);
    let ends = mesh.cells.iter().scan(0, |end, cell| {
        *end += cell.nodes.len();
        Some(*end)
    });
    array(&mut text, "Int64", "offsets", 1, ends);
    array(&mut text, "UInt8", "types", 1, mesh.cells.iter().map(|cell| cell.shape.vtk()));
    text + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
}

/// A list of files as one that ParaView opens (`.pvd`): each has a number, such as its frequency, that takes the place of time.
/// Files of one time are the parts of one picture and have different numbers of parts, from 0. Names must be those of plain files
/// in the same folder.
#[must_use]
pub fn write_pvd<'a>(files: impl IntoIterator<Item = (f64, usize, &'a str)>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, part, file) in files {
        let time = Double(&time);
        let _ = writeln!(text, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>");
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// A number with an exponent where it is far from 1.
struct Double<'a>(&'a f64);

impl std::fmt::Display for Double<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-3..1e6).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

/// An array of numbers, ten in a line.
fn array(
    text: &mut String,
    kind: &str,
    name: &str,
    components: usize,
    values: impl Iterator<Item = impl std::fmt::Display>,
) {
    let _ = write!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for (place, value) in values.enumerate() {
        let _ = write!(text, "{}{value}", if place % 10 == 0 { '\n' } else { ' ' });
    }
    *text += "\n</DataArray>\n";
}
