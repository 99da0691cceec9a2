//! The matrices of CalculiX (`.sti`, `.mas`, `.dof`).
//!
//! `*FREQUENCY, SOLVER=MATRIXSTORAGE` writes the stiffness matrix to `.sti` and the mass matrix to `.mas`: in each line the
//! row, the column, both from 1, and the value of one entry of the upper triangle, column by column. Every diagonal entry
//! is there. Line r of `.dof` is the degree of freedom of row r, `node.direction`; degrees of freedom that a boundary
//! condition or a constraint removes have no row. With `*TRANSFORM` the directions are local ones.

use crate::builder::Builder;
use crate::{Fault, Freedom, Matrix, Place, labelled, text};
use std::collections::HashSet;

/// Reads a `.sti` or `.mas` file. [`freedoms`] reads the `.dof` file beside it.
///
/// # Errors
/// Returns a fault if a line is wrong, or if two entries contradict each other.
pub fn read(content: &[u8]) -> Result<Matrix, Fault> {
    let mut entries = Vec::new();
    for (line, text) in text::lines(content) {
        if !text.trim().is_empty() {
            entries.push((entry(line, &text)?, Place::Line(line)));
        }
    }
    let rows = entries.iter().map(|&((row, column, _), _)| row.max(column)).max();
    let rows = rows.ok_or_else(|| {
        Fault::whole("the file has no entries; run CalculiX with *FREQUENCY, SOLVER=MATRIXSTORAGE")
    })?;
    let places = entries.iter().map(|&((row, column, _), _)| (row, column));
    let mut builder = Builder::new(rows, rows, labelled::symmetry(places));
    for ((row, column, value), place) in entries {
        builder.push(row - 1, column - 1, value, place)?;
    }
    builder.finish()
}

/// The row and the column, from 1, and the value in a line.
fn entry(line: usize, text: &str) -> Result<(usize, usize, f64), Fault> {
    let mut words = text.split_whitespace();
    let mut word = || words.next().unwrap_or_default();
    let index = |word: &str| word.parse().ok().filter(|&index| index > 0);
    match (index(word()), index(word()), text::number(word()), word()) {
        (Some(row), Some(column), Some(value), "") => Ok((row, column, value)),
        _ => Err(Fault::line(
            line,
            format!(
                "{} is no entry; write a row, a column and a value, such as 1 2 -3.5e+08",
                text::quote(text)
            ),
        )),
    }
}

/// The degree of freedom of each row, which a `.dof` file has.
///
/// # Errors
/// Returns a fault if a line is wrong, or if two are the same.
pub fn freedoms(content: &[u8]) -> Result<Vec<Freedom>, Fault> {
    let mut freedoms = Vec::new();
    let mut seen = HashSet::new();
    for (line, text) in text::lines(content) {
        let text = text.trim();
        if text.is_empty() {
            continue;
        }
        let fault = |message| Fault::line(line, message);
        let freedom = freedom(text).ok_or_else(|| {
            fault(format!(
                "{} is no degree of freedom; write a node and a direction from 1 to 3, such as 12.3",
                text::quote(text)
            ))
        })?;
        if !seen.insert(freedom) {
            return Err(fault(format!(
                "node {} has direction {} a second time: shells and beams, which CalculiX expands into solids, and cyclic sectors, \
                 whose matrices are complex, cannot be read; store the matrices of the whole structure, made of solids",
                freedom.node, freedom.direction,
            )));
        }
        freedoms.push(freedom);
    }
    Ok(freedoms)
}

fn freedom(text: &str) -> Option<Freedom> {
    let (node, direction) = text.split_once('.')?;
    let direction = direction.parse().ok().filter(|direction| (1..=3).contains(direction))?;
    Some(Freedom { node: node.parse().ok().filter(|&node| node > 0)?, direction })
}
