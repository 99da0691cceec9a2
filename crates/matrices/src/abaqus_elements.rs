//! Elements in the text files of matrices of Abaqus, and of substructures of CalculiX (`.mtx`).
//!
//! `*ELEMENT MATRIX OUTPUT` and `*SUBSTRUCTURE MATRIX OUTPUT` of Abaqus, with `OUTPUT FILE=USER DEFINED`, and `*SUBSTRUCTURE
//! MATRIX OUTPUT` of CalculiX write for each element:
//! - `*USER ELEMENT, NODES=n, LINEAR`;
//! - a comment `** ELEMENT NODES`, and the n nodes in the comments after it;
//! - a line with the directions of the first node; then, for each k where the directions change, a line with k and the
//!   directions of the nodes from the k-th on. CalculiX gives each degree of freedom a node of its own, so that a node
//!   occurs several times;
//! - `*MATRIX, TYPE=STIFFNESS` or `MASS`, and its values in lines of up to four: of each column those from the first row to
//!   the diagonal, or those of all rows where the matrix is unsymmetric.
//!
//! A node of a substructure whose number is not positive, with direction 1, is the coordinate of a mode that the substructure
//! retains. It becomes a degree of freedom without a direction, and node -3 becomes node 3, direction 0.
//!
//! Several elements are added up to the matrix of the structure, one for each type, without its zeros.
//!
//! Sources: Abaqus Keywords Guide, `*USER ELEMENT` and `*MATRIX`; Abaqus Output Guide, records 1011 to 1022, for the order.

use crate::abaqus::{Keyword, fields, freedom};
use crate::labelled::{self, Labelled};
use crate::{Fault, Freedom, Matrix, Place, Symmetry, text};
use std::collections::{BTreeMap, HashSet};

/// Reads a file of elements.
///
/// # Errors
/// Returns a fault if a line is wrong, or if an element has other numbers of nodes or values than it states.
pub(crate) fn read(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let mut reader = Reader::default();
    for (line, text) in text::lines(content) {
        let text = text.trim();
        if let Some(comment) = text.strip_prefix("**") {
            reader.comment(comment)?;
        } else if text.starts_with('*') {
            reader.close()?;
            reader.keyword(line, &Keyword::new(text))?;
        } else if !text.is_empty() {
            reader.numbers(line, text)?;
        }
    }
    reader.close()?;
    reader.matrices.into_iter().map(|(name, sum)| sum.finish(name)).collect()
}

/// What the comments and the lines of numbers belong to.
#[derive(Default, PartialEq, Eq)]
enum Part {
    #[default]
    Nothing,
    Nodes,
    Directions,
    Values,
}

#[derive(Default)]
struct Reader {
    part: Part,
    /// The number of the next element.
    number: Option<u64>,
    element: Element,
    /// The type of the matrix whose values are read, and the line of its keyword.
    matrix: (String, usize),
    values: Vec<(f64, usize)>,
    matrices: BTreeMap<String, Sum>,
    /// The number of each element so far, with the types of its matrices.
    numbers: HashSet<(u64, String)>,
}

/// The element whose matrices are read.
#[derive(Default)]
struct Element {
    line: usize,
    /// The number in the comment before it; a substructure has none.
    number: Option<u64>,
    stated: usize,
    nodes: Vec<i64>,
    /// The position of the first node with these directions, from 1.
    directions: Vec<(usize, Vec<i64>)>,
}

/// A matrix of the structure.
#[derive(Default)]
struct Sum {
    unsymmetric: bool,
    entries: Vec<Labelled>,
}

impl Sum {
    fn finish(mut self, name: String) -> Result<Matrix, Fault> {
        let symmetry = if self.unsymmetric { Symmetry::General } else { Symmetry::Symmetric };
        self.entries.sort_by_key(|&(row, column, ..)| (row, column));
        self.entries.dedup_by(|next, sum| {
            let same = (next.0, next.1) == (sum.0, sum.1);
            if same {
                sum.2 += next.2;
            }
            same
        });
        self.entries.retain(|&(_, _, value, _)| value != 0.0);
        Ok(Matrix { name: Some(name), ..labelled::matrix(&self.entries, symmetry)? })
    }
}

impl Reader {
    fn comment(&mut self, text: &str) -> Result<(), Fault> {
        let text = text.trim();
        let mut words = text.split_whitespace();
        match (words.next(), words.next(), words.next()) {
            (Some("ELEMENT"), Some("NODES"), None) => {
                self.close()?;
                self.part = Part::Nodes;
            }
            (Some("ELEMENT"), Some("NUMBER"), Some(number)) => {
                self.close()?;
                self.part = Part::Nothing;
                self.number = number.parse().ok();
            }
            // A remark on internal nodes may stand among the nodes.
            _ if self.part == Part::Nodes => {
                let nodes = fields(text).map(text::integer).collect::<Option<Vec<_>>>();
                self.element.nodes.extend(nodes.unwrap_or_default());
            }
            _ => {}
        }
        Ok(())
    }

    fn keyword(&mut self, line: usize, keyword: &Keyword) -> Result<(), Fault> {
        match &*keyword.name {
            "USER ELEMENT" => {
                let stated = keyword.parameter("NODES").and_then(|nodes| nodes.parse().ok());
                let stated = stated.ok_or_else(|| {
                    Fault::line(
                        line,
                        "the element states no number of nodes; write NODES=8, for instance",
                    )
                })?;
                let number = self.number.take();
                self.element = Element { line, number, stated, ..Element::default() };
                self.part = Part::Directions;
            }
            "MATRIX" if self.element.line > 0 => {
                let kind = keyword.parameter("TYPE").unwrap_or_default().to_uppercase();
                self.matrix = (kind, line);
                self.part = Part::Values;
            }
            other => {
                return Err(Fault::line(
                    line,
                    format!(
                        "{} is not of a file of elements; keep *USER ELEMENT, and *MATRIX with TYPE=STIFFNESS or MASS",
                        text::quote(other)
                    ),
                ));
            }
        }
        Ok(())
    }

    fn numbers(&mut self, line: usize, text: &str) -> Result<(), Fault> {
        match self.part {
            Part::Values => {
                for field in fields(text) {
                    let value = text::number(field).ok_or_else(|| no_number(line, field))?;
                    self.values.push((value, line));
                }
            }
            Part::Directions | Part::Nodes => {
                self.part = Part::Directions;
                let mut numbers =
                    fields(text)
                        .map(|field| integer(line, field))
                        .collect::<Result<Vec<_>, _>>()?;
                let earlier = self.element.directions.last().map_or(0, |&(first, _)| first);
                let first = match (earlier, &*numbers) {
                    (0, _) => 1,
                    (_, []) => 0,
                    _ => numbers.remove(0),
                };
                let first = usize::try_from(first).unwrap_or(0);
                if first <= earlier || first > self.element.stated {
                    return Err(Fault::line(
                        line,
                        format!(
                            "the directions change at node {first} of the element; state nodes from {} to {}, in order",
                            earlier + 1,
                            self.element.stated
                        ),
                    ));
                }
                self.element.directions.push((first, numbers));
            }
            Part::Nothing => {
                return Err(Fault::line(
                    line,
                    "numbers stand before *USER ELEMENT; remove them, or put the keyword before them",
                ));
            }
        }
        Ok(())
    }

    /// Ends the matrix whose values are read, if any, and adds it to that of the structure.
    fn close(&mut self) -> Result<(), Fault> {
        if self.part != Part::Values {
            return Ok(());
        }
        let freedoms = self.element.freedoms()?;
        let count = freedoms.len();
        let (kind, line) = std::mem::take(&mut self.matrix);
        let values = std::mem::take(&mut self.values);
        let triangle = count * (count + 1) / 2;
        let unsymmetric = values.len() != triangle;
        if unsymmetric && values.len() != count * count {
            return Err(Fault::line(
                line,
                format!(
                    "the matrix has {} values, but an element of {count} degrees of freedom needs {triangle}, or {} if it is \
                     unsymmetric; write the whole file again",
                    values.len(),
                    count * count,
                ),
            ));
        }
        if let Some(number) = self.element.number
            && !self.numbers.insert((number, kind.clone()))
        {
            return Err(Fault::line(
                line,
                format!(
                    "element {number} has a second matrix of type {}; write the matrices of one increment of one step",
                    text::quote(&kind)
                ),
            ));
        }
        let sum = self.matrices.entry(kind).or_default();
        sum.unsymmetric |= unsymmetric;
        let mut values = values.into_iter();
        for (index, &column) in freedoms.iter().enumerate() {
            let last = if unsymmetric { count } else { index + 1 };
            for (&row, (value, line)) in freedoms[..last].iter().zip(values.by_ref()) {
                sum.entries.push((row, column, value, Place::Line(line)));
                if !unsymmetric && row != column {
                    sum.entries.push((column, row, value, Place::Line(line)));
                }
            }
        }
        self.part = Part::Directions;
        Ok(())
    }
}

impl Element {
    /// The degrees of freedom, in the order of the rows.
    fn freedoms(&self) -> Result<Vec<Freedom>, Fault> {
        let fault = |message: String| Fault::line(self.line, message);
        if self.nodes.len() != self.stated {
            return Err(fault(format!(
                "the element states {} nodes, but has {} in the comments after ** ELEMENT NODES; write the whole file again",
                self.stated,
                self.nodes.len()
            )));
        }
        if self.directions.is_empty() {
            return Err(fault(
                "the element has no line of directions, such as 1, 2, 3; add one".into(),
            ));
        }
        let mut freedoms = Vec::new();
        let mut seen = HashSet::new();
        let mut changes = self.directions.iter().peekable();
        let mut directions: &[i64] = &[];
        for (index, &node) in self.nodes.iter().enumerate() {
            if let Some((_, changed)) = changes.next_if(|&&(first, _)| first == index + 1) {
                directions = changed;
            }
            for &direction in directions {
                let freedom = match directions {
                    [1] if node <= 0 => Freedom { node: node.unsigned_abs(), direction: 0 },
                    _ => freedom(self.line, node, direction)?,
                };
                if !seen.insert(freedom) {
                    return Err(fault(format!(
                        "the element has direction {direction} of node {node} a second time; state each once"
                    )));
                }
                freedoms.push(freedom);
            }
        }
        Ok(freedoms)
    }
}

fn integer(line: usize, field: &str) -> Result<i64, Fault> {
    text::integer(field).ok_or_else(|| {
        Fault::line(
            line,
            format!("{} is no whole number; write a node or a direction", text::quote(field)),
        )
    })
}

fn no_number(line: usize, field: &str) -> Fault {
    Fault::line(line, format!("{} is no number; write one such as -3.5E+08", text::quote(field)))
}
