//! Matrix Market files (`.mtx`), as SciPy, Julia and many solvers write them.
//!
//! Format: R. F. Boisvert, R. Pozo, K. A. Remington, The Matrix Market Exchange Formats: Initial Design, NISTIR 5935, 1996.
//! A header line, comment lines that begin with `%`, a line of sizes, then the entries: `row column value` of a coordinate
//! layout, or the values alone of an array, column by column. Of a symmetric matrix the lower triangle is given, of a
//! skew-symmetric one the lower triangle without the diagonal.

use crate::builder::Builder;
use crate::text::{integer, lines, number, quote};
use crate::{Fault, Matrix, Place, Symmetry};

/// The first bytes of a Matrix Market file, in upper or lower case.
const MARK: &[u8] = b"%%MatrixMarket";

/// `true` if the content begins as a Matrix Market file does; other programs use the extension `.mtx` as well.
#[must_use]
pub fn is_matrix_market(content: &[u8]) -> bool {
    content.get(..MARK.len()).is_some_and(|start| start.eq_ignore_ascii_case(MARK))
}

/// Reads a real or integer matrix.
///
/// # Errors
/// Returns a fault if the content is no Matrix Market file, has no real values, or is wrong.
pub fn read(content: &[u8]) -> Result<Matrix, Fault> {
    let mut lines = lines(content);
    let (_, first) = lines.next().ok_or_else(|| Fault::whole("the file is empty"))?;
    let (array, symmetry) = header(&first)?;

    let mut lines =
        lines.filter(|(_, text)| !text.starts_with('%') && !text.trim().is_empty()).peekable();
    let (line, sizes) = lines
        .next()
        .ok_or_else(|| Fault::whole("the line of sizes is missing after the header"))?;
    let names = if array { "rows columns" } else { "rows columns entries" };
    let sizes: Option<Vec<usize>> =
        sizes.split_whitespace().map(|size| usize::try_from(integer(size)?).ok()).collect();
    let (rows, columns, stated) = match (sizes.as_deref(), array) {
        (Some(&[rows, columns]), true) => (rows, columns, stored(rows, columns, symmetry)),
        (Some(&[rows, columns, entries]), false) => (rows, columns, entries as u128),
        _ => return Err(Fault::line(line, format!("the line of sizes must be `{names}`"))),
    };
    if symmetry != Symmetry::General && rows != columns {
        let message = format!(
            "a symmetric or skew-symmetric matrix must be square, but this one has {rows} rows and {columns} columns; \
             correct the sizes, or write `general` in the header"
        );
        return Err(Fault::line(line, message));
    }

    let mut builder = Builder::new(rows, columns, symmetry);
    let mut position = Position { rows, symmetry, row: first_row(0, symmetry), column: 0 };
    let mut found = 0_u128;
    let mut last = line;
    for (line, text) in lines {
        if found == stated {
            let message = format!(
                "the line follows after all {stated} entries that line {last} completes; remove it, or correct the sizes"
            );
            return Err(Fault::line(line, message));
        }
        found += 1;
        last = line;
        let mut words = text.split_whitespace();
        let (row, column) = if array {
            position.advance()
        } else {
            (index(line, "row", words.next())?, index(line, "column", words.next())?)
        };
        let value = words.next().and_then(number);
        let (Some(value), None) = (value, words.next()) else {
            let form = if array { "one number" } else { "`row column value`" };
            return Err(Fault::line(line, format!("{} must be {form}", quote(text.trim()))));
        };
        // An array gives each zero.
        if !array || value != 0.0 {
            builder.push(row, column, value, Place::Line(line))?;
        }
    }
    if found < stated {
        let message = format!(
            "the file ends after {found} of {stated} entries; it may have been cut off: write it again, or correct the sizes"
        );
        return Err(Fault::line(last, message));
    }
    builder.finish()
}

/// `true` for an array and `false` for coordinates, and the symmetry.
fn header(text: &str) -> Result<(bool, Symmetry), Fault> {
    let fault = |message: String| Err(Fault::line(1, message));
    let text = text.to_lowercase();
    let words: Vec<_> = text.split_whitespace().collect();
    let &["%%matrixmarket", "matrix", layout, field, symmetry] = &*words else {
        return fault(format!(
            "{} must be `%%MatrixMarket matrix LAYOUT FIELD SYMMETRY`, such as `%%MatrixMarket matrix coordinate real symmetric`",
            quote(&text)
        ));
    };
    let array = match layout {
        "array" => true,
        "coordinate" => false,
        _ => {
            return fault(format!(
                "the layout {} is unknown; write `coordinate` or `array`",
                quote(layout)
            ));
        }
    };
    match field {
        "real" | "integer" => {}
        "complex" => {
            return fault("the values are complex, but a real matrix is needed; write the real part of the matrix alone".into());
        }
        "pattern" => {
            return fault("the file has the pattern of a matrix without its values; write the matrix with its values (`real`)".into());
        }
        _ => {
            return fault(format!(
                "the field {} is unknown; write `real` or `integer`",
                quote(field)
            ));
        }
    }
    let symmetry = match symmetry {
        "general" => Symmetry::General,
        "symmetric" => Symmetry::Symmetric,
        "skew-symmetric" => Symmetry::SkewSymmetric,
        "hermitian" => {
            return fault("the matrix is Hermitian, but a real matrix is needed; write `symmetric`, if the values are real".into());
        }
        _ => {
            return fault(format!(
                "the symmetry {} is unknown; write `general`, `symmetric` or `skew-symmetric`",
                quote(symmetry)
            ));
        }
    };
    Ok((array, symmetry))
}

/// The number of values of an array.
fn stored(rows: usize, columns: usize, symmetry: Symmetry) -> u128 {
    let (rows, columns) = (rows as u128, columns as u128);
    match symmetry {
        Symmetry::General => rows * columns,
        Symmetry::Symmetric => rows * (rows + 1) / 2,
        Symmetry::SkewSymmetric => rows * rows.saturating_sub(1) / 2,
    }
}

/// The row of the first value that an array gives of a column.
const fn first_row(column: usize, symmetry: Symmetry) -> usize {
    match symmetry {
        Symmetry::General => 0,
        Symmetry::Symmetric => column,
        Symmetry::SkewSymmetric => column.saturating_add(1),
    }
}

/// The place of the next value of an array.
struct Position {
    rows: usize,
    symmetry: Symmetry,
    row: usize,
    column: usize,
}

impl Position {
    /// The place of this value; goes to the next.
    const fn advance(&mut self) -> (usize, usize) {
        let place = (self.row, self.column);
        self.row += 1;
        if self.row >= self.rows {
            self.column += 1;
            self.row = first_row(self.column, self.symmetry);
        }
        place
    }
}

/// An index, which files count from 1, counted from 0.
fn index(line: usize, name: &str, word: Option<&str>) -> Result<usize, Fault> {
    let word = word.unwrap_or_default();
    match integer(word).map(|index| usize::try_from(index.saturating_sub(1))) {
        Some(Ok(index)) => Ok(index),
        Some(Err(_)) => Err(Fault::line(
            line,
            format!("the {name} is {}; rows and columns are counted from 1", quote(word)),
        )),
        None => Err(Fault::line(
            line,
            format!("the {name} {} is no whole number; write `row column value`", quote(word)),
        )),
    }
}
