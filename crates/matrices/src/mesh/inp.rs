//! Meshes in input files of Abaqus and CalculiX (`.inp`).
//!
//! Read are `*NODE` (number, x, y, z; coordinates that are left out are 0) and `*ELEMENT` (number, then the nodes, in as many
//! lines as they need). All other keywords are passed over with their lines. Nodes and elements are numbered once in a file:
//! parts and instances of Abaqus, which number their own, are refused.
//!
//! Sources: Abaqus Keywords Guide; CalculiX CrunchiX User's Manual 2.20, `*NODE` and `*ELEMENT`.

use super::{Cell, Mesh, Shape};
use crate::abaqus::{Keyword, fields};
use crate::{Fault, text};
use std::collections::HashMap;

/// The part of the file that the lines of numbers belong to.
enum Part {
    /// A keyword that a mesh does not need.
    Other,
    Nodes,
    Elements(Shape),
}

/// The mesh of the content of an input file.
///
/// # Errors
/// Returns a fault if a line is wrong, if a node or an element has a number twice, if an element has nodes that are not there,
/// or if there is no element with a form.
pub fn read(content: &[u8]) -> Result<Mesh, Fault> {
    let mut reader = Reader {
        part: Part::Other,
        nodes: HashMap::new(),
        elements: HashMap::new(),
        cells: Vec::new(),
        open: None,
    };
    for (line, text) in text::lines(content) {
        let text = text.trim();
        if text.is_empty() || text.starts_with("**") {
            continue;
        }
        if text.starts_with('*') {
            reader.complete()?;
            reader.keyword(line, &Keyword::new(text))?;
        } else {
            reader.numbers(line, text)?;
        }
    }
    reader.complete()?;
    reader.mesh()
}

struct Reader {
    part: Part,
    /// The place of each node, and its line.
    nodes: HashMap<u64, ([f64; 3], usize)>,
    /// The line of each element.
    elements: HashMap<u64, usize>,
    /// The form of each element, its nodes by number, and its line.
    cells: Vec<(Shape, Vec<u64>, usize)>,
    /// The element whose nodes are not complete.
    open: Option<(Shape, u64, Vec<u64>, usize)>,
}

impl Reader {
    fn keyword(&mut self, line: usize, keyword: &Keyword) -> Result<(), Fault> {
        if matches!(&*keyword.name, "NODE" | "ELEMENT") && keyword.parameter("INPUT").is_some() {
            return Err(Fault::line(
                line,
                "the lines of another file are not read; put them in place of the parameter INPUT",
            ));
        }
        self.part = match &*keyword.name {
            "NODE" => {
                if keyword
                    .parameter("SYSTEM")
                    .is_some_and(|system| !system.eq_ignore_ascii_case("R"))
                {
                    return Err(Fault::line(
                        line,
                        "the nodes are in cylindrical or spherical coordinates; write x, y and z",
                    ));
                }
                Part::Nodes
            }
            "ELEMENT" => {
                let kind = keyword.parameter("TYPE").unwrap_or_default();
                match Shape::of_element(kind) {
                    Ok(Some(shape)) => Part::Elements(shape),
                    Ok(None) => Part::Other,
                    Err(()) => {
                        return Err(Fault::line(
                            line,
                            format!(
                                "elements of the type {} have no known form; known are C3D4, C3D6, C3D8, C3D10, C3D15, C3D20, shells, \
                                 plane elements, beams and trusses: leave others out of the file of the mesh",
                                text::quote(kind)
                            ),
                        ));
                    }
                }
            }
            "INCLUDE" => {
                return Err(Fault::line(
                    line,
                    "the mesh of another file is not read; put its lines in place of *INCLUDE",
                ));
            }
            "SYSTEM" => {
                return Err(Fault::line(
                    line,
                    "*SYSTEM turns and shifts the nodes that follow; write their places without it",
                ));
            }
            "INSTANCE" | "PART" => {
                return Err(Fault::line(
                    line,
                    "parts and instances number their own nodes; write the file without them (Abaqus: Model, Edit Attributes, Do not use \
                     parts and assemblies in input files)",
                ));
            }
            _ => Part::Other,
        };
        Ok(())
    }

    fn numbers(&mut self, line: usize, text: &str) -> Result<(), Fault> {
        match self.part {
            Part::Other => Ok(()),
            Part::Nodes => self.node(line, text),
            Part::Elements(shape) => self.element(line, shape, text),
        }
    }

    fn node(&mut self, line: usize, text: &str) -> Result<(), Fault> {
        let mut fields = text.split(',').map(str::trim);
        let number = whole(line, fields.next().unwrap_or_default())?;
        let mut place = [0.0; 3];
        // An empty field is a coordinate that is left out; those after it keep their axes.
        let given = place.iter_mut().zip(fields).filter(|(_, field)| !field.is_empty());
        for (coordinate, field) in given {
            let value = text::number(field).filter(|value| value.is_finite());
            *coordinate = value.ok_or_else(|| {
                Fault::line(
                    line,
                    format!("{} is no coordinate; write a number", text::quote(field)),
                )
            })?;
        }
        if let Some((_, first)) = self.nodes.insert(number, (place, line)) {
            return Err(Fault::line(
                line,
                format!(
                    "node {number} stands a second time, first in line {first}; number each node once"
                ),
            ));
        }
        Ok(())
    }

    fn element(&mut self, line: usize, shape: Shape, text: &str) -> Result<(), Fault> {
        for field in fields(text) {
            let number = whole(line, field)?;
            match &mut self.open {
                None => {
                    if let Some(first) = self.elements.insert(number, line) {
                        return Err(Fault::line(
                            line,
                            format!(
                                "element {number} stands a second time, first in line {first}; number each element once"
                            ),
                        ));
                    }
                    self.open = Some((shape, number, Vec::with_capacity(shape.count()), line));
                }
                Some((_, _, nodes, _)) => nodes.push(number),
            }
            self.open
                .take_if(|(_, _, nodes, _)| nodes.len() == shape.count())
                .into_iter()
                .for_each(|(shape, _, nodes, line)| self.cells.push((shape, nodes, line)));
        }
        Ok(())
    }

    /// Refuses an element of which nodes are missing.
    fn complete(&mut self) -> Result<(), Fault> {
        let Some((shape, number, nodes, line)) = self.open.take() else { return Ok(()) };
        Err(Fault::line(
            line,
            format!(
                "element {number} has {} nodes, and its type needs {}; write all of them",
                nodes.len(),
                shape.count()
            ),
        ))
    }

    fn mesh(self) -> Result<Mesh, Fault> {
        if self.cells.is_empty() {
            return Err(Fault::whole(
                "the file has no element with a form; give an input file with *NODE and *ELEMENT",
            ));
        }
        let mut sorted: Vec<(u64, [f64; 3])> =
            self.nodes.into_iter().map(|(number, (place, _))| (number, place)).collect();
        sorted.sort_unstable_by_key(|&(number, _)| number);
        let (nodes, points): (Vec<u64>, _) = sorted.into_iter().unzip();
        let cells = self.cells.into_iter().map(|(shape, numbers, line)| {
            let position = |number: u64| {
                nodes.binary_search(&number).map_err(|_| {
                    Fault::line(
                        line,
                        format!("the element has node {number}, which the file does not place; add it to *NODE"),
                    )
                })
            };
            let nodes = numbers.into_iter().map(position).collect::<Result<_, _>>()?;
            Ok(Cell { shape, nodes })
        });
        let cells = cells.collect::<Result<_, Fault>>()?;
        Ok(Mesh { nodes, points, cells })
    }
}

/// The number of a node or an element.
fn whole(line: usize, field: &str) -> Result<u64, Fault> {
    let number = text::integer(field).and_then(|number| u64::try_from(number).ok());
    number.filter(|&number| number > 0).ok_or_else(|| {
        Fault::line(
            line,
            format!(
                "{} is no number of a node or an element; write a whole number above 0",
                text::quote(field)
            ),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;

    #[test]
    fn nodes_and_elements_are_read_among_other_keywords() {
        let mesh = read(
            b"*HEADING\r\n1, 2, 3\r\n*Node, nset=all\r\n 30, 1.5, 0., 2D0\r\n10, 0, 0\r\n20,0,1.\r\n** a comment\r\n\
              *MATERIAL, NAME=A\r\n*ELASTIC\r\n2e11, 0.3\r\n*ELEMENT, TYPE=S3, ELSET=E\r\n7, 30, 10,\r\n20\r\n*ELEMENT, TYPE=MASS\r\n8, 10\r\n",
        );
        let mesh = mesh.unwrap();
        assert_eq!(mesh.nodes, [10, 20, 30]);
        assert_eq!(mesh.points, [[0.0; 3], [0.0, 1.0, 0.0], [1.5, 0.0, 2.0]]);
        assert_eq!(mesh.cells, [Cell { shape: Shape::Triangle, nodes: vec![2, 0, 1] }]);
        assert_eq!(mesh.position(30), Some(2));
        assert_eq!(mesh.position(11), None);
    }

    #[test]
    fn a_coordinate_that_is_left_out_is_zero_and_the_others_keep_their_axes() {
        let mesh = read(
            b"*NODE\n5, , 2.0, 1.0\n6, 1., , 3.\n7, 1.,\n8\n*ELEMENT, TYPE=C3D4\n1, 5, 6, 7, 8\n",
        );
        let expected = [[0.0, 2.0, 1.0], [1.0, 0.0, 3.0], [1.0, 0.0, 0.0], [0.0; 3]];
        assert_eq!(mesh.unwrap().points, expected);
    }

    #[test]
    fn a_wrong_line_is_named() {
        let nodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n";
        for (text, line, words) in [
            ("*NODE\n1, 0, zero", 2, "`zero` is no coordinate"),
            ("*NODE\n1, 0, 1e999", 2, "`1e999` is no coordinate"),
            ("*NODE\n-1, 0, 0", 2, "`-1` is no number of a node"),
            ("*NODE, SYSTEM=C\n", 1, "cylindrical"),
            ("*NODE\n1, 0\n1, 0", 3, "node 1 stands a second time, first in line 2"),
            ("*ELEMENT, TYPE=C3D27\n", 1, "`C3D27` have no known form"),
            ("*ELEMENT\n", 1, "`` have no known form"),
            ("*INCLUDE, INPUT=mesh.inp\n", 1, "put its lines in place"),
            ("@*NODE, INPUT=nodes.inp\n", 5, "in place of the parameter INPUT"),
            ("@*ELEMENT, TYPE=S3, INPUT=e.inp\n", 5, "in place of the parameter INPUT"),
            ("*SYSTEM\n0, 0, 1\n", 1, "without it"),
            ("*PART, NAME=DISC\n", 1, "without them"),
            (
                "@*ELEMENT, TYPE=S3\n1, 1, 2\n*STEP\n",
                6,
                "element 1 has 2 nodes, and its type needs 3",
            ),
            ("@*ELEMENT, TYPE=S3\n1, 1, 2, 4\n", 6, "node 4, which the file does not place"),
            ("@*ELEMENT, TYPE=S3\n1, 1, 2, 3\n1, 1, 2, 3", 7, "element 1 stands a second time"),
        ] {
            let fault = read(text.replace('@', nodes).as_bytes()).unwrap_err();
            assert_eq!(fault.place, Place::Line(line), "{text}: {}", fault.message);
            assert!(fault.message.contains(words), "{}", fault.message);
        }
        let fault = read(nodes.as_bytes()).unwrap_err();
        assert!(fault.place == Place::Whole && fault.message.contains("no element"), "{fault:?}");
    }
}
