//! Tables of the degrees of freedom that the rows of a matrix stand for, as CSV.

use crate::{Error, Fault, Freedom, Matrix};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The first line of a table.
const HEAD: &str = "node,direction";
/// The last direction: the rotation about z.
const DIRECTIONS: u8 = 6;

/// Reads a table: a line `node,direction`, then one line for each row of the matrices (see [`Freedom`]).
///
/// # Errors
/// Returns an error if the file cannot be read, or a line is not of this form.
pub fn read_freedoms(path: &Path) -> Result<Vec<Freedom>, Error> {
    let text = fs::read_to_string(path).map_err(|error| {
        Error::new(path, Fault::whole(format!("cannot read the table: {error}")))
    })?;
    parse(&text).map_err(|fault| Error::new(path, fault))
}

/// Names the rows of a matrix by the table that was read from this path.
///
/// # Errors
/// Returns an error if the table has not one line for each row.
pub fn name_rows(matrix: &mut Matrix, freedoms: &[Freedom], path: &Path) -> Result<(), Error> {
    let count = freedoms.len();
    if [matrix.rows, matrix.columns] != [count; 2] {
        let message = format!(
            "the table names {count} rows, and a matrix has {} rows and {} columns; name each row once",
            matrix.rows, matrix.columns
        );
        return Err(Error::new(path, Fault::whole(message)));
    }
    matrix.freedoms = Some(freedoms.to_vec());
    Ok(())
}

fn parse(text: &str) -> Result<Vec<Freedom>, Fault> {
    let mut lines = (1..).zip(text.lines().map(str::trim));
    match lines.next() {
        Some((_, HEAD)) => {}
        _ => return Err(Fault::line(1, format!("the table must begin with the line {HEAD}"))),
    }
    let mut freedoms = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
        let freedom = line.split_once(',').and_then(|(node, direction)| {
            Some(Freedom {
                node: node.trim().parse().ok()?,
                direction: direction.trim().parse().ok().filter(|it| *it <= DIRECTIONS)?,
            })
        });
        freedoms.push(freedom.ok_or_else(|| {
            Fault::line(
                number,
                format!(
                    "`{line}` is no degree of freedom; write the number of a node, a comma and a direction from 0 to {DIRECTIONS}"
                ),
            )
        })?);
    }
    let mut sorted: Vec<(Freedom, usize)> = freedoms.iter().copied().zip(2..).collect();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let Freedom { node, direction } = pair[1].0;
        let message = format!(
            "node {node} has direction {direction} twice, first in line {}; name each row once",
            pair[0].1
        );
        return Err(Fault::line(pair[1].1, message));
    }
    // Sorted by node and direction, so that a direction 0 stands before the node's others.
    let counted_from_0 =
        |pair: &&[(Freedom, usize)]| pair[0].0.node == pair[1].0.node && pair[0].0.direction == 0;
    if let Some(pair) = sorted.windows(2).find(counted_from_0) {
        let [Freedom { node, .. }, Freedom { direction, .. }] = [pair[0].0, pair[1].0];
        let message = format!(
            "node {node} has direction 0 and direction {direction}; directions count from 1 (1 to 3 displacements, 4 to 6 rotations), \
             and 0 is for modes and scalar points, which have no other"
        );
        return Err(Fault::line(pair[0].1, message));
    }
    Ok(freedoms)
}

/// The table that [`read_freedoms`] reads.
#[must_use]
pub fn write_freedoms(freedoms: &[Freedom]) -> String {
    let mut table = format!("{HEAD}\n");
    for Freedom { node, direction } in freedoms {
        writeln!(table, "{node},{direction}").expect("a string takes all");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let freedoms = [(17, 1), (17, 2), (3, 6), (900, 0)]
            .map(|(node, direction)| Freedom { node, direction });
        assert_eq!(parse(&write_freedoms(&freedoms)).unwrap(), freedoms);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, line, words) in [
            ("", 1, "must begin with"),
            ("node,direction\n1,1\n2", 3, "`2` is no degree of freedom"),
            ("node,direction\n1,7\n", 2, "a direction from 0 to 6"),
            ("node,direction\n1,1\n1,2\n1,1\n", 4, "twice, first in line 2"),
            (
                "node,direction\n5,0\n1,0\n1,1\n1,2\n",
                3,
                "node 1 has direction 0 and direction 1; directions count from 1",
            ),
        ] {
            let fault = parse(text).unwrap_err();
            assert_eq!(fault.place, crate::Place::Line(line), "{text}");
            assert!(fault.message.contains(words), "{}", fault.message);
        }
    }
}
