//! The compressed layout, which several formats share: of each column (or row) where its entries begin, and of each entry its
//! row (or column) and value.

use crate::builder::Builder;
use crate::{Fault, Matrix, Place, Symmetry};

/// A matrix in the compressed layout.
pub(crate) struct Compressed<'a> {
    /// The number of rows.
    pub(crate) rows: usize,
    /// The number of columns.
    pub(crate) columns: usize,
    /// The symmetry that the file states.
    pub(crate) symmetry: Symmetry,
    /// `true` if the layout is by rows.
    pub(crate) by_rows: bool,
    /// The number of the first row, column and entry: 0, or 1 in formats of Fortran.
    pub(crate) base: u8,
    /// Where the entries of each column begin, and the end of the last.
    pub(crate) pointers: &'a [i64],
    /// The row of each entry; entries after the last pointer are room that is not used.
    pub(crate) indices: &'a [i64],
    /// The value of each entry, as `indices`.
    pub(crate) values: &'a [f64],
}

impl Compressed<'_> {
    /// The matrix. `place` gives the place of an entry in the file.
    ///
    /// # Errors
    /// Returns a fault if the parts contradict each other, or an entry is wrong.
    pub(crate) fn matrix(&self, place: impl Fn(usize) -> Place) -> Result<Matrix, Fault> {
        let &Self { rows, columns, symmetry, by_rows, base, pointers, indices, values } = self;
        let (line, major) = if by_rows { ("row", rows) } else { ("column", columns) };
        let first = i64::from(base);
        let minor = if by_rows { "column" } else { "row" };
        if major.checked_add(1) != Some(pointers.len()) {
            return Err(Fault::whole(format!(
                "there are {} {line} pointers, but {major} {line}s need one each and one more for the end",
                pointers.len()
            )));
        }
        if indices.len() != values.len() {
            return Err(Fault::whole(format!(
                "there are {} {minor} indices, but {} values; each entry needs one of both",
                indices.len(),
                values.len()
            )));
        }
        if pointers[0] != first {
            return Err(Fault::whole(format!(
                "the first {line} pointer is {}; it must be {base}",
                pointers[0]
            )));
        }
        let mut builder = Builder::new(rows, columns, symmetry);
        for (k, pair) in pointers.windows(2).enumerate() {
            let number = k + usize::from(base);
            let [start, end] = [pair[0], pair[1]];
            if end < start {
                return Err(Fault::whole(format!(
                    "{line} {number} begins at entry {start} and ends at entry {end}; {line} pointers must not decrease"
                )));
            }
            // Not negative, since the pointers begin with `first` and do not decrease.
            let range = (start - first) as usize..(end - first) as usize;
            if range.end > indices.len() {
                return Err(Fault::whole(format!(
                    "{line} {number} ends at entry {end}, but there are {} entries; the file may have been cut off: write it again",
                    indices.len()
                )));
            }
            for entry in range {
                let index = indices[entry];
                let Some(index) = index.checked_sub(first).and_then(|index| index.try_into().ok())
                else {
                    let message = format!(
                        "an entry of {line} {number} has the {minor} {index}; {minor}s are counted from {base}"
                    );
                    return Err(Fault { place: place(entry), message });
                };
                let (row, column) = if by_rows { (k, index) } else { (index, k) };
                builder.push(row, column, values[entry], place(entry))?;
            }
        }
        builder.finish()
    }
}
