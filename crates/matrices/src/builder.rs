//! Puts the entries of a file together and finds those that contradict each other.

use crate::{Entry, Fault, Freedom, Matrix, Place, Symmetry};

/// The entries that a reader has found so far.
pub(crate) struct Builder {
    rows: usize,
    columns: usize,
    symmetry: Symmetry,
    /// The degree of freedom of each row of a square matrix, if the file tells it with each entry.
    freedoms: Option<Vec<Freedom>>,
    /// The part of the diagonal by which two entries across it may differ in a symmetric matrix.
    rounding: f64,
    entries: Vec<(Entry, Place)>,
}

impl Builder {
    pub(crate) const fn new(rows: usize, columns: usize, symmetry: Symmetry) -> Self {
        Self { rows, columns, symmetry, freedoms: None, rounding: 0.0, entries: Vec::new() }
    }

    /// A square matrix with these degrees of freedom, which messages name instead of rows and columns.
    pub(crate) fn labelled(freedoms: Vec<Freedom>, symmetry: Symmetry) -> Self {
        let rows = freedoms.len();
        Self { freedoms: Some(freedoms), ..Self::new(rows, rows, symmetry) }
    }

    /// Lets two entries across the diagonal of a symmetric matrix differ by this part of the geometric mean of their diagonal
    /// entries; both become their mean.
    pub(crate) fn rounded(self, rounding: f64) -> Self {
        Self { rounding, ..self }
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
            let pair = pair(self.freedoms.as_deref(), row, column);
            return Err(fault(format!(
                "the value of {pair} is {value}; a matrix needs finite numbers"
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
        let Self { rows, columns, symmetry, freedoms, rounding, mut entries } = self;
        let pair = |row, column| pair(freedoms.as_deref(), row, column);
        let key = |entry: &Entry| (entry.column, entry.row);
        entries.sort_by_key(|(entry, _)| key(entry));
        if let Some(two) = entries.windows(2).find(|two| key(&two[0].0) == key(&two[1].0)) {
            let Entry { row, column, .. } = two[1].0;
            let message = format!(
                "{} have a second entry{}; add the two up, or remove one",
                pair(row, column),
                earlier(two[0].1),
            );
            return Err(Fault { place: two[1].1, message });
        }
        if symmetry != Symmetry::General {
            mirror(&mut entries, symmetry, rounding, pair)?;
        }
        let entries = entries.into_iter().map(|(entry, _)| entry).collect();
        Ok(Matrix { name: None, rows, columns, entries, symmetry, freedoms })
    }
}

/// Names the place of an entry in the matrix.
fn pair(freedoms: Option<&[Freedom]>, row: usize, column: usize) -> String {
    match freedoms {
        Some(freedoms) => {
            let name = |at: usize| {
                format!("node {} direction {}", freedoms[at].node, freedoms[at].direction)
            };
            format!("{} and {}", name(row), name(column))
        }
        None => format!("row {} and column {}", row + 1, column + 1),
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
fn mirror(
    entries: &mut Vec<(Entry, Place)>,
    symmetry: Symmetry,
    rounding: f64,
    pair: impl Fn(usize, usize) -> String,
) -> Result<(), Fault> {
    let (sign, kind) = match symmetry {
        Symmetry::SkewSymmetric => (-1.0, "skew-symmetric"),
        _ => (1.0, "symmetric"),
    };
    let find =
        |row, column| entries.binary_search_by_key(&(column, row), |(e, _)| (e.column, e.row));
    let diagonal = |row| find(row, row).map_or(0.0, |found| entries[found].0.value.abs());
    let mut added = Vec::new();
    let mut means = Vec::new();
    for (index, &(Entry { row, column, value }, place)) in entries.iter().enumerate() {
        if row == column {
            if sign < 0.0 && value != 0.0 {
                let message = format!(
                    "the file says that the matrix is skew-symmetric, but {} hold {value}; it must be 0",
                    pair(row, row)
                );
                return Err(Fault { place, message });
            }
            continue;
        }
        let Ok(partner) = find(column, row) else {
            added.push((Entry { row: column, column: row, value: sign * value }, place));
            continue;
        };
        let other = entries[partner].0.value;
        if other == sign * value {
            continue;
        }
        if (other - sign * value).abs() > rounding * (diagonal(row) * diagonal(column)).sqrt() {
            let message = format!(
                "the file says that the matrix is {kind}, but {} hold {value}, and {} hold {other}; say that it is general, or \
                 correct one of them",
                pair(row, column),
                pair(column, row),
            );
            return Err(Fault { place, message });
        }
        means.push((index, f64::midpoint(value, sign * other)));
    }
    for (index, mean) in means {
        entries[index].0.value = mean;
    }
    entries.append(&mut added);
    entries.sort_by_key(|(entry, _)| (entry.column, entry.row));
    Ok(())
}
