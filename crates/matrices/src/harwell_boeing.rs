//! Harwell–Boeing and Rutherford–Boeing files (`.rua`, `.rsa`, `.hb`, `.rb`, and `.matrix` of the command HBMAT of Ansys).
//!
//! Format: I. S. Duff, R. G. Grimes, J. G. Lewis, Users' Guide for the Harwell–Boeing Sparse Matrix Collection, TR/PA/92/86,
//! CERFACS, 1992, and The Rutherford–Boeing Sparse Matrix Collection, RAL-TR-97-031, 1997. Line 1 is a title; line 2 has
//! numbers of lines, which the formats give as well; line 3 has the type and the sizes; line 4 has the Fortran formats of the
//! pointers, the rows and the values, which follow by compressed columns. Right-hand sides at the end are ignored.

use crate::compressed::Compressed;
use crate::text::{integer, lines, number, quote};
use crate::{Fault, Matrix, Place, Symmetry};
use std::borrow::Cow;

/// Reads a real, assembled matrix.
///
/// # Errors
/// Returns a fault if the content is no such file, has no real values, or is wrong.
pub fn read(content: &[u8]) -> Result<Matrix, Fault> {
    if content.contains(&0) {
        return Err(Fault::whole(
            "the file is binary; write it as text (in Ansys: HBMAT with Form = ASCII)",
        ));
    }
    let mut lines = lines(content);
    let mut header = |line: usize| {
        let cut = || {
            Fault::whole(format!(
                "the file ends before line {line}, which is of its header; write it again"
            ))
        };
        lines.next().map(|(_, text)| text).ok_or_else(cut)
    };
    header(1)?;
    let counts = header(2)?;
    let sizes = header(3)?;
    let formats = header(4)?;
    // Rutherford–Boeing files have no number of lines of right-hand sides, nor a line of them.
    let right_hand_sides = counts.split_whitespace().nth(4).and_then(integer).unwrap_or(0);
    if right_hand_sides > 0 {
        header(5)?;
    }

    let (symmetry, [rows, columns, entries]) = type_and_sizes(&sizes)?;
    let [of_pointers, of_rows, of_values] = formats_of(&formats)?;
    let mut position = 4 + usize::from(right_hand_sides > 0);
    let pointers = fields(
        &mut lines,
        &mut position,
        of_pointers,
        "pointer",
        columns.saturating_add(1),
        integer,
    )?;
    let indices = fields(&mut lines, &mut position, of_rows, "row", entries, integer)?;
    let start = position;
    let values = fields(&mut lines, &mut position, of_values, "value", entries, |text| {
        // Fortran puts a decimal point into a number without one, C does not.
        let point = of_values.whole || text.contains('.');
        number(text).filter(|value| point || *value == 0.0 || !value.is_finite())
    })?;
    let last = pointers.last().copied().unwrap_or_default();
    if usize::try_from(last) != Ok(entries + 1) {
        return Err(Fault::whole(format!(
            "the last column pointer is {last}; with {entries} entries it must be {}",
            entries + 1
        )));
    }
    let parts = Compressed {
        rows,
        columns,
        symmetry,
        by_rows: false,
        base: 1,
        pointers: &pointers,
        indices: &indices,
        values: &values,
    };
    parts.matrix(|entry| Place::Line(start + entry / of_values.count + 1))
}

/// The symmetry, and the numbers of rows, columns and entries, from line 3.
fn type_and_sizes(text: &str) -> Result<(Symmetry, [usize; 3]), Fault> {
    let fault = |message: String| Err(Fault::line(3, message));
    let mut words = text.split_whitespace();
    let name = words.next().unwrap_or_default().to_uppercase();
    let symmetry = match &*name.chars().collect::<Vec<_>>() {
        ['C', ..] => {
            return fault("the values are complex, but a real matrix is needed; write the real part of the matrix alone".into());
        }
        ['P', ..] => return fault("the file has the pattern of a matrix without its values; write the matrix with its values".into()),
        [_, 'H', _] => return fault("the matrix is Hermitian, but a real matrix is needed; write it as RSA".into()),
        [_, _, 'E'] => return fault("the matrix is in elements; write it assembled".into()),
        ['R' | 'I', 'U' | 'R', 'A'] => Symmetry::General,
        ['R' | 'I', 'S', 'A'] => Symmetry::Symmetric,
        ['R' | 'I', 'Z', 'A'] => Symmetry::SkewSymmetric,
        _ => {
            return fault(format!(
                "the type {} is unknown; known are RUA (unsymmetric), RSA (symmetric), RZA (skew-symmetric) and RRA (rectangular)",
                quote(&name)
            ));
        }
    };
    let sizes: Option<Vec<_>> =
        words.take(3).map(|size| usize::try_from(integer(size)?).ok()).collect();
    let Some(&[rows, columns, entries]) = sizes.as_deref() else {
        return fault("numbers of rows, columns and entries must follow the type".into());
    };
    if symmetry != Symmetry::General && rows != columns {
        return fault(format!(
            "the type {name} needs a square matrix, but this one has {rows} rows and {columns} columns; write it as RRA"
        ));
    }
    Ok((symmetry, [rows, columns, entries]))
}

/// How Fortran writes numbers in lines.
#[derive(Clone, Copy)]
struct Format {
    /// Numbers in a line, not 0.
    count: usize,
    /// Characters of a number, not 0.
    width: usize,
    /// `true` if the numbers are whole.
    whole: bool,
}

/// The formats of pointers, rows and values, from line 4.
fn formats_of(text: &str) -> Result<[Format; 3], Fault> {
    let fault = |message: String| Fault::line(4, message);
    let texts: Vec<_> = text.split(')').filter_map(|text| Some(text.split_once('(')?.1)).collect();
    let &[pointers, rows, values, ..] = &*texts else {
        return Err(fault(format!(
            "{} must be three or four Fortran formats, such as `(16I5) (16I5) (3E25.16)`",
            quote(text.trim())
        )));
    };
    let whole = |text| {
        format_of(text).filter(|format| format.whole).ok_or_else(|| {
            fault(format!(
                "the format {} is unknown; one of whole numbers is needed, such as `(16I5)`",
                quote(text)
            ))
        })
    };
    let values = format_of(values).ok_or_else(|| {
        fault(format!("the format {} is unknown; write the values with one such as `(3E25.16)` or `(1P,5D16.8)`", quote(values)))
    })?;
    Ok([whole(pointers)?, whole(rows)?, values])
}

/// A format without its parentheses: scale factor, count, letter, width and digits, as in `1P,5E16.8`.
fn format_of(text: &str) -> Option<Format> {
    let text: String = text.split_whitespace().collect::<String>().to_uppercase();
    // A scale factor moves the decimal point only in numbers without an exponent.
    let (scale, text) = match text.split_once('P') {
        Some((scale, text)) => (integer(scale)?, text.strip_prefix(',').unwrap_or(text)),
        None => (0, &*text),
    };
    let at = text.find(|c: char| !c.is_ascii_digit())?;
    let (count, text) = text.split_at(at);
    let (letter, text) = text.split_at_checked(1)?;
    if !matches!(letter, "I" | "E" | "D" | "F" | "G") || (letter == "F" && scale != 0) {
        return None;
    }
    let width = text.split('.').next()?;
    let count = if count.is_empty() { 1 } else { count.parse().ok()? };
    let format = Format { count, width: width.parse().ok()?, whole: letter == "I" };
    (format.count > 0 && format.width > 0).then_some(format)
}

/// Reads `total` numbers in fixed columns from the next lines. `position` is the number of lines that have been read.
fn fields<'a, T>(
    lines: &mut impl Iterator<Item = (usize, Cow<'a, str>)>,
    position: &mut usize,
    format: Format,
    name: &str,
    total: usize,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Fault> {
    let mut found = Vec::new();
    while found.len() < total {
        let Some((line, text)) = lines.next() else {
            return Err(Fault::line(
                *position,
                format!(
                    "the file ends after {} of {total} {name}s; it may have been cut off: write it again",
                    found.len()
                ),
            ));
        };
        *position = line;
        let expected = format.count.min(total - found.len());
        for field in split(&text, format.width, expected) {
            found.push(parse(field).ok_or_else(|| {
                let kind =
                    if name == "value" { "numbers with a decimal point" } else { "whole numbers" };
                let message = format!(
                    "{} is no {name}; this line needs {expected} {kind}, each of {} characters, as line 4 says",
                    quote(field.trim()),
                    format.width
                );
                Fault::line(line, message)
            })?);
        }
    }
    Ok(found)
}

/// The numbers in a line: its words, if there are as many as the format says, since SciPy states another width than it writes;
/// else its columns, as no space need be between them. What is too much is in the last one.
fn split(text: &str, width: usize, expected: usize) -> Vec<&str> {
    let words: Vec<_> = text.split_whitespace().collect();
    if words.len() == expected {
        return words;
    }
    let mut rest = text.trim_end();
    let mut columns = Vec::new();
    while columns.len() + 1 < expected && !rest.is_empty() {
        let (column, after) = rest.split_at_checked(width).unwrap_or((rest, ""));
        columns.push(column);
        rest = after;
    }
    columns.push(rest);
    columns
}
