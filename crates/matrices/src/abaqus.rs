//! The text files of matrices of Abaqus (`.mtx`), and those of substructures of CalculiX.
//!
//! `*MATRIX OUTPUT` writes the matrix of a structure, one entry in a line:
//! - with `FORMAT=MATRIX INPUT`: the node and the direction of the row, those of the column, and the value;
//! - with `FORMAT=COORDINATE`: the row and the column, from 1, and the value; such a file does not tell degrees of freedom.
//!
//! The files have no header; the reader also takes the header `*MATRIX INPUT, NAME=…, TYPE=SYMMETRIC|UNSYMMETRIC` of an input
//! deck, and then several matrices in one file. Without `TYPE`, a matrix with no entry on both sides of the diagonal is
//! symmetric. Abaqus gives a fixed degree of freedom the value 1e36 on the diagonal of the stiffness matrix.
//!
//! The rows are all degrees of freedom that the entries name, by node and then by direction, so that a mass matrix may have
//! fewer rows than the stiffness matrix of the same structure.
//!
//! Files with `*USER ELEMENT` hold elements; the module `abaqus_elements` reads them.
//!
//! Sources: Abaqus Keywords Guide, `*MATRIX INPUT`, `*MATRIX OUTPUT`, `*MATRIX GENERATE`.

use crate::builder::Builder;
use crate::labelled::{self, Labelled};
use crate::{Fault, Freedom, Matrix, Place, Symmetry, abaqus_elements, text};

/// Reads a `.mtx` file that is not of Matrix Market.
///
/// # Errors
/// Returns a fault if a line is none of the layouts, has an internal node of Abaqus, or contradicts another one.
pub fn read(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let mut blocks: Vec<Block> = Vec::new();
    for (line, text) in text::lines(content) {
        let text = text.trim();
        if text.is_empty() || text.starts_with("**") {
            continue;
        }
        if text.starts_with('*') {
            match Keyword::new(text) {
                keyword if keyword.name == "USER ELEMENT" => return abaqus_elements::read(content),
                keyword if keyword.name == "MATRIX ASSEMBLE" => {}
                keyword if ["MATRIX", "MATRIX INPUT"].contains(&&*keyword.name) => {
                    blocks.push(Block::new(&keyword, line)?);
                }
                _ => {
                    return Err(Fault::line(
                        line,
                        format!(
                            "{} begins no matrix; keep *MATRIX INPUT or *USER ELEMENT, and their lines of numbers",
                            text::quote(text)
                        ),
                    ));
                }
            }
            continue;
        }
        if blocks.is_empty() {
            blocks.push(Block { name: None, symmetry: None, entries: Entries::None });
        }
        let block = blocks.last_mut().expect("there is a block");
        block.push(line, text)?;
    }
    if blocks.is_empty() {
        return Err(Fault::whole("the file has no entries; write a matrix with *MATRIX OUTPUT"));
    }
    blocks.into_iter().map(Block::finish).collect()
}

/// A keyword line: `*NAME, PARAMETER=VALUE, …`, in capitals but for the values.
pub(crate) struct Keyword {
    pub(crate) name: String,
    parameters: Vec<(String, String)>,
}

impl Keyword {
    pub(crate) fn new(text: &str) -> Self {
        let mut parts = text.trim_start_matches('*').split(',');
        let name = parts.next().unwrap_or_default().trim().to_uppercase();
        let parameters = parts.map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_uppercase(), value.trim().to_owned())
        });
        Self { name, parameters: parameters.collect() }
    }

    /// The value of a parameter; empty if the parameter stands alone.
    pub(crate) fn parameter(&self, name: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(key, _)| key == name);
        found.map(|(_, value)| value.as_str())
    }
}

/// The numbers of a line, between commas or spaces.
pub(crate) fn fields(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|field| !field.is_empty())
}

/// The entries of a matrix of a structure, in one of the two layouts.
enum Entries {
    None,
    Labelled(Vec<Labelled>),
    Numbered(Vec<(usize, usize, f64, Place)>),
}

/// A matrix of a structure.
struct Block {
    name: Option<String>,
    symmetry: Option<Symmetry>,
    entries: Entries,
}

impl Block {
    fn new(keyword: &Keyword, line: usize) -> Result<Self, Fault> {
        let symmetry = match keyword.parameter("TYPE").map(str::to_uppercase).as_deref() {
            None => None,
            Some("SYMMETRIC") => Some(Symmetry::Symmetric),
            Some("UNSYMMETRIC") => Some(Symmetry::General),
            Some(other) => {
                return Err(Fault::line(
                    line,
                    format!(
                        "the type {} of the matrix is unknown; write SYMMETRIC or UNSYMMETRIC, or *USER ELEMENT before it",
                        text::quote(other)
                    ),
                ));
            }
        };
        let name = keyword.parameter("NAME").map(str::to_owned);
        Ok(Self { name, symmetry, entries: Entries::None })
    }

    /// Adds the entry in a line.
    fn push(&mut self, line: usize, text: &str) -> Result<(), Fault> {
        let place = Place::Line(line);
        let fields: Vec<&str> = fields(text).collect();
        let no_number = || {
            Fault::line(
                line,
                format!(
                    "{} is no entry; write node, direction, node, direction, value, or row, column, value",
                    text::quote(text)
                ),
            )
        };
        match (&mut self.entries, &*fields) {
            (Entries::None, &[row, direction, column, other, value]) => {
                let entry = labelled(line, [row, direction, column, other], value);
                self.entries = Entries::Labelled(vec![entry.ok_or_else(no_number)??]);
            }
            (Entries::Labelled(entries), &[row, direction, column, other, value]) => {
                let entry = labelled(line, [row, direction, column, other], value);
                entries.push(entry.ok_or_else(no_number)??);
            }
            (Entries::None, &[row, column, value]) => {
                let entry = numbered(row, column, value, place).ok_or_else(no_number)?;
                self.entries = Entries::Numbered(vec![entry]);
            }
            (Entries::Numbered(entries), &[row, column, value]) => {
                entries.push(numbered(row, column, value, place).ok_or_else(no_number)?);
            }
            (_, fields) => {
                let message = format!(
                    "a line of {} numbers is no entry of this matrix; write the matrix of the whole structure with *MATRIX \
                     OUTPUT, FORMAT=MATRIX INPUT (five numbers) or COORDINATE (three)",
                    fields.len()
                );
                return Err(Fault::line(line, message));
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<Matrix, Fault> {
        let name = self.name;
        let matrix = match self.entries {
            Entries::None => labelled::matrix(&[], Symmetry::Symmetric)?,
            Entries::Labelled(entries) => {
                let places = entries.iter().map(|&(row, column, ..)| (row, column));
                let symmetry = self.symmetry.unwrap_or_else(|| labelled::symmetry(places));
                labelled::matrix(&entries, symmetry)?
            }
            Entries::Numbered(entries) => {
                let places = entries.iter().map(|&(row, column, ..)| (row, column));
                let symmetry = self.symmetry.unwrap_or_else(|| labelled::symmetry(places));
                let rows = entries.iter().map(|&(row, column, ..)| row.max(column)).max();
                let rows = rows.map_or(0, |last| last + 1);
                let mut builder = Builder::new(rows, rows, symmetry);
                for (row, column, value, place) in entries {
                    builder.push(row, column, value, place)?;
                }
                builder.finish()?
            }
        };
        Ok(Matrix { name, ..matrix })
    }
}

/// An entry of numbered rows and columns, which become numbers from 0.
fn numbered(
    row: &str,
    column: &str,
    value: &str,
    place: Place,
) -> Option<(usize, usize, f64, Place)> {
    let index = |text: &str| text.parse::<usize>().ok()?.checked_sub(1);
    Some((index(row)?, index(column)?, text::number(value)?, place))
}

/// An entry of degrees of freedom: node, direction, node, direction. Without a value where one is no number.
fn labelled(line: usize, freedoms: [&str; 4], value: &str) -> Option<Result<Labelled, Fault>> {
    let [row, direction, column, other] = freedoms.map(text::integer);
    let value = text::number(value)?;
    let row = freedom(line, row?, direction?);
    let column = freedom(line, column?, other?);
    Some(row.and_then(|row| Ok((row, column?, value, Place::Line(line)))))
}

/// A degree of freedom by the numbers of its node and its direction.
///
/// # Errors
/// Returns a fault if the node is an internal one, or the direction is neither a displacement nor a rotation.
pub(crate) fn freedom(line: usize, node: i64, direction: i64) -> Result<Freedom, Fault> {
    match (u64::try_from(node), u8::try_from(direction)) {
        (Ok(node @ 1..), Ok(direction @ 1..=6)) => Ok(Freedom { node, direction }),
        (Ok(1..), _) => Err(Fault::line(
            line,
            format!(
                "degree of freedom {direction} of node {node} is neither a displacement (1 to 3) nor a rotation (4 to 6); \
                 write the matrix of a structure without temperatures, pressures and potentials",
            ),
        )),
        _ => Err(Fault::line(
            line,
            format!(
                "node {node} is internal: Abaqus adds nodes of numbers below 1 for Lagrange multipliers, hybrid elements and modes \
                 of substructures; use elements and constraints without them (penalty instead of Lagrange multipliers), \
                 or write a substructure of the nodes that matter"
            ),
        )),
    }
}
