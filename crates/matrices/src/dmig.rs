//! Direct matrix input of Nastran (`.pch`, `.dmig`, `.bdf`): cards `DMIG` among others, which are skipped.
//!
//! A matrix has a header, `DMIG NAME 0 IFO TIN TOUT POLAR _ NCOL`, whose form IFO is 1 for square, 6 for symmetric (of which
//! one triangle is enough), and 2 or 9 for rectangular, and whose type TIN is 1 for real numbers of single precision and 2 for
//! those of double precision. Each of its columns is a card `DMIG NAME GJ CJ _ G1 C1 A1 B1 G2 C2 A2 B2 …`: node and direction
//! of the column, then those of each row, with the real and the imaginary part of the entry. A scalar point has the direction
//! 0.
//!
//! The rows of the matrix are all degrees of freedom that its entries name, by node and then by direction, so that a mass
//! matrix may have fewer rows than the stiffness matrix of the same structure. Those of a rectangular matrix have no degrees of
//! freedom in [`Matrix`]; GJ is the number of the column of form 9, from 1.
//!
//! Source: Quick Reference Guide of MSC Nastran, bulk data entry DMIG.

use crate::builder::Builder;
use crate::cards::{self, Card};
use crate::labelled::{self, Labelled};
use crate::{Fault, Freedom, Matrix, Place, Symmetry, text};

/// Reads the matrices of a file. `INCLUDE` is not followed.
///
/// # Errors
/// Returns a fault if a card is wrong, if a matrix has no header, two headers, or complex numbers, or if two entries
/// contradict each other.
pub fn read(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let mut matrices: Vec<Parts> = Vec::new();
    cards::each(content, "DMIG", |card| {
        let name = card.field(0).to_uppercase();
        if name.is_empty() || name.chars().count() > 8 {
            let message =
                format!("{} is no name of a matrix; write 1 to 8 characters", text::quote(&name));
            return Err(Fault::line(card.line, message));
        }
        let known = matrices.iter().position(|matrix| matrix.name == name);
        let index = known.unwrap_or_else(|| {
            let header = None;
            matrices.push(Parts { name, line: card.line, header, entries: Vec::new() });
            matrices.len() - 1
        });
        if card.field(1) == "0" {
            matrices[index].header(&card)
        } else {
            matrices[index].column(&card)
        }
    })?;
    matrices.into_iter().map(Parts::finish).collect()
}

/// A matrix of which some cards have been read.
struct Parts {
    name: String,
    /// The line of the first card.
    line: usize,
    header: Option<Header>,
    entries: Vec<Labelled>,
}

struct Header {
    line: usize,
    form: Form,
}

#[derive(Clone, Copy)]
enum Form {
    Square(Symmetry),
    /// With the number of columns if GJ counts them.
    Rectangular {
        columns: Option<usize>,
    },
}

impl Parts {
    fn header(&mut self, card: &Card) -> Result<(), Fault> {
        let name = &self.name;
        let fault = |message| Err(Fault::line(card.line, message));
        if let Some(Header { line, .. }) = self.header {
            return fault(format!(
                "matrix {name} has a second header (the first is in line {line}); remove one"
            ));
        }
        match card.field(3) {
            "1" | "2" => {}
            "3" | "4" => {
                return fault(format!(
                    "matrix {name} has complex numbers (TIN {}); write a real matrix",
                    card.field(3)
                ));
            }
            other => {
                return fault(format!(
                    "the type TIN of matrix {name} is {}; write 1 or 2 for real numbers of single or double precision",
                    text::quote(other)
                ));
            }
        }
        let form = match card.field(2) {
            "1" => Form::Square(Symmetry::General),
            "6" => Form::Square(Symmetry::Symmetric),
            "2" => Form::Rectangular { columns: None },
            "9" => match card.field(7).parse() {
                Ok(columns) => Form::Rectangular { columns: Some(columns) },
                Err(_) => {
                    return fault(format!(
                        "matrix {name} is rectangular, but NCOL is {}; write its number of columns",
                        text::quote(card.field(7))
                    ));
                }
            },
            other => {
                return fault(format!(
                    "the form IFO of matrix {name} is {}; write 1 for square, 6 for symmetric, 2 or 9 for rectangular",
                    text::quote(other)
                ));
            }
        };
        self.header = Some(Header { line: card.line, form });
        Ok(())
    }

    fn column(&mut self, card: &Card) -> Result<(), Fault> {
        let column = freedom(card, card.line, 1)?;
        let before = self.entries.len();
        for (index, group) in card.fields.chunks(4).enumerate().skip(1) {
            let line = group[0].0;
            let field = |at: usize| group.get(at).map_or("", |(_, field)| field);
            if group.iter().all(|(_, field)| field.is_empty()) {
                continue;
            }
            let row = freedom(card, line, 4 * index)?;
            let value = text::number(field(2)).ok_or_else(|| {
                Fault::line(
                    line,
                    format!(
                        "{} is no real number; write one such as -1.5+3 or -1.5D+3",
                        text::quote(field(2))
                    ),
                )
            })?;
            if !field(3).is_empty() && text::number(field(3)) != Some(0.0) {
                let message = format!(
                    "the imaginary part {} belongs to no real matrix; leave it out",
                    text::quote(field(3))
                );
                return Err(Fault::line(line, message));
            }
            self.entries.push((row, column, value, Place::Line(line)));
        }
        if self.entries.len() == before {
            let name = &self.name;
            return Err(Fault::line(
                card.line,
                format!(
                    "the column of matrix {name} has no entry; the file is cut, or a continuation line is missing"
                ),
            ));
        }
        Ok(())
    }

    fn finish(self) -> Result<Matrix, Fault> {
        let Self { name, line, header, entries } = self;
        let Some(Header { form, .. }) = header else {
            return Err(Fault::line(
                line,
                format!(
                    "matrix {name} has no header; add a card such as DMIG {name} 0 6 2 0 for a symmetric one"
                ),
            ));
        };
        let matrix = match form {
            Form::Square(symmetry) => labelled::matrix(&entries, symmetry)?,
            Form::Rectangular { columns } => {
                let rows = labelled::sorted(entries.iter().map(|&(row, ..)| row));
                let labels = labelled::sorted(entries.iter().map(|&(_, column, ..)| column));
                let count = columns.unwrap_or(labels.len());
                let mut builder = Builder::new(rows.len(), count, Symmetry::General);
                for (row, column, value, place) in entries {
                    let column = match columns {
                        Some(_) => usize::try_from(column.node - 1).unwrap_or(usize::MAX),
                        None => labelled::position(&labels, column),
                    };
                    builder.push(labelled::position(&rows, row), column, value, place)?;
                }
                builder.finish()?
            }
        };
        Ok(Matrix { name: Some(name), ..matrix })
    }
}

/// The degree of freedom in two fields of a card.
fn freedom(card: &Card, line: usize, at: usize) -> Result<Freedom, Fault> {
    let (node, direction) = (card.field(at), card.field(at + 1));
    let number = node.parse().ok().filter(|&node: &u64| node > 0);
    let number = number.ok_or_else(|| {
        Fault::line(line, format!("{} is no node; write a number from 1", text::quote(node)))
    })?;
    let component = if direction.is_empty() { Some(0) } else { direction.parse().ok() };
    let direction = component.filter(|direction| (0..=6).contains(direction)).ok_or_else(|| {
        Fault::line(
            line,
            format!(
                "node {number} has the direction {}; write 1 to 6, or 0 for a scalar point",
                text::quote(direction)
            ),
        )
    })?;
    Ok(Freedom { node: number, direction })
}
