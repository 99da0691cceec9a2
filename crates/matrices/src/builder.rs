//! Puts the entries of a file together and finds those that contradict each other.

use crate::{Entry, Fault, Matrix, Place, Symmetry};

/// The entries that a reader has found so far.
pub(crate) struct Builder {
    rows: usize,
    columns: usize,
    symmetry: Symmetry,
    entries: Vec<(Entry, Place)>,
}

impl Builder {
    pub(crate) const fn new(rows: usize, columns: usize, symmetry: Symmetry) -> Self {
        Self { rows, columns, symmetry, entries: Vec::new() }
    }

    /// Adds an entry; rows and columns are counted from 0. Of a symmetric matrix either triangle, or both.
    ///
    /// # Errors
    /// Returns a fault if the entry is outside of the matrix or its value is not finite.
    pub(crate) fn push(
        &mut self,
        row: usize,
        column: usize,
        value: f64,
        place: Place,
    ) -> Result<(), Fault> {
        let fault = |message| Fault { place, message };
        if row >= self.rows || column >= self.columns {
            return Err(fault(format!(
                "the entry in row {} and column {} is outside of the matrix, which has {} rows and {} columns; state larger \
                 numbers of rows and columns, or remove the entry",
                row + 1,
                column + 1,
                self.rows,
                self.columns,
            )));
        }
        if !value.is_finite() {
            return Err(fault(format!(
                "the value of row {} and column {} is {value}; a matrix needs finite numbers",
                row + 1,
                column + 1
            )));
        }
        self.entries.push((Entry { row, column, value }, place));
        Ok(())
    }

    /// The matrix.
    ///
    /// # Errors
    /// Returns a fault if two entries have one place, or if the two triangles of a symmetric matrix differ.
    pub(crate) fn finish(self) -> Result<Matrix, Fault> {
        let Self { rows, columns, symmetry, mut entries } = self;
        let key = |entry: &Entry| (entry.column, entry.row);
        entries.sort_by_key(|(entry, _)| key(entry));
        if let Some(pair) = entries.windows(2).find(|pair| key(&pair[0].0) == key(&pair[1].0)) {
            let Entry { row, column, .. } = pair[1].0;
            let message = format!(
                "row {} and column {} have a second entry{}; add the two up, or remove one",
                row + 1,
                column + 1,
                earlier(pair[0].1),
            );
            return Err(Fault { place: pair[1].1, message });
        }
        if symmetry != Symmetry::General {
            mirror(&mut entries, symmetry)?;
        }
        let entries = entries.into_iter().map(|(entry, _)| entry).collect();
        Ok(Matrix { name: None, rows, columns, entries, symmetry, freedoms: None })
    }
}

/// Names the place of an earlier entry in a message.
fn earlier(place: Place) -> String {
    match place {
        Place::Line(line) => format!(" (the first is in line {line})"),
        Place::Offset(offset) => format!(" (the first is at byte {offset})"),
        Place::Whole => String::new(),
    }
}

/// Adds the entries of the triangle that the file leaves out. `entries` are sorted by column and row, and stay so.
fn mirror(entries: &mut Vec<(Entry, Place)>, symmetry: Symmetry) -> Result<(), Fault> {
    let sign = if symmetry == Symmetry::SkewSymmetric { -1.0 } else { 1.0 };
    let mut added = Vec::new();
    for &(Entry { row, column, value }, place) in &*entries {
        if row == column {
            if sign < 0.0 && value != 0.0 {
                let message = format!(
                    "the file says that the matrix is skew-symmetric, but row {0} and column {0} hold {value}; it must be 0",
                    row + 1
                );
                return Err(Fault { place, message });
            }
            continue;
        }
        match entries.binary_search_by_key(&(row, column), |(e, _)| (e.column, e.row)) {
            Err(_) => {
                added.push((Entry { row: column, column: row, value: sign * value }, place));
            }
            Ok(found) if entries[found].0.value == sign * value => {}
            Ok(found) => {
                let other = entries[found].0.value;
                let (row, column) = (row + 1, column + 1);
                let kind = if sign < 0.0 { "skew-symmetric" } else { "symmetric" };
                let message = format!(
                    "the file says that the matrix is {kind}, but row {row} and column {column} hold {value}, and row \
                     {column} and column {row} hold {other}; say that it is general, or correct one of them"
                );
                return Err(Fault { place, message });
            }
        }
    }
    entries.append(&mut added);
    entries.sort_by_key(|(entry, _)| (entry.column, entry.row));
    Ok(())
}
