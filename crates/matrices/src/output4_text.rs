//! Files of OUTPUT4 of Nastran as text.
//!
//! The header has numbers in columns of 8 characters, the name, and the Fortran format of the values, such as `1P,5E16.9`.
//! Programs differ in whether they count values or words of them in the numbers before a column and a string; the reader
//! takes either, since lines of values, which have a decimal point, cannot be mistaken for other lines.

use crate::builder::Builder;
use crate::output4::Header;
use crate::{Fault, Matrix, Place, text};
use std::borrow::Cow;
use std::iter::Peekable;

pub(crate) fn read(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    let lines = text::lines(content).filter(|(_, text)| !text.trim().is_empty());
    let mut lines = Lines { lines: lines.peekable(), line: 0 };
    let mut matrices = Vec::new();
    while let Some((line, text)) = lines.next() {
        matrices.push(matrix(&mut lines, line, &text)?);
    }
    if matrices.is_empty() {
        return Err(Fault::whole("the file is empty; write a matrix with OUTPUT4"));
    }
    Ok(matrices)
}

struct Lines<I: Iterator> {
    lines: Peekable<I>,
    /// The last line that was read.
    line: usize,
}

impl<'a, I: Iterator<Item = (usize, Cow<'a, str>)>> Lines<I> {
    fn next(&mut self) -> Option<I::Item> {
        let next = self.lines.next()?;
        self.line = next.0;
        Some(next)
    }

    /// The next line if it has values.
    fn values(&mut self) -> Option<I::Item> {
        let next = self.lines.next_if(|(_, text)| text.contains('.'))?;
        self.line = next.0;
        Some(next)
    }
}

/// The widths of the values in a line.
struct Format {
    count: usize,
    width: usize,
}

/// Reads a matrix whose header is in this line, up to the column that ends it.
fn matrix<'a, I>(lines: &mut Lines<I>, line: usize, text: &str) -> Result<Matrix, Fault>
where
    I: Iterator<Item = (usize, Cow<'a, str>)>,
{
    let (header, format) = header(line, text)?;
    let mut builder = header.builder();
    loop {
        let Some((line, text)) = lines.next() else {
            return Err(Fault::line(
                lines.line,
                format!(
                    "the file ends before column {} that ends the matrix; it is cut: write it again",
                    header.columns + 1
                ),
            ));
        };
        let [column, row, count] = *integers(line, &text)? else {
            return Err(Fault::line(
                line,
                format!(
                    "{} is no head of a column; write its number, the first row and the number of words",
                    text::quote(&text)
                ),
            ));
        };
        if column > header.columns {
            while lines.values().is_some() {}
            return header.finish(builder);
        }
        let column = header.column(column, Place::Line(line))?;
        if let Ok(first @ 1..) = usize::try_from(row) {
            let count = usize::try_from(count).unwrap_or(0);
            run(lines, &header, &format, &mut builder, (first - 1, column), count)?;
            continue;
        }
        let size = if header.big { 2 } else { 1 };
        while let Some((line, text)) =
            lines.lines.next_if(|(_, text)| text.split_whitespace().count() == size)
        {
            lines.line = line;
            let (first, length) = header.string(&integers(line, &text)?, Place::Line(line))?;
            run(lines, &header, &format, &mut builder, (first, column), length)?;
        }
    }
}

fn header(line: usize, text: &str) -> Result<(Header, Format), Fault> {
    let wrong = || {
        Fault::line(
            line,
            format!(
                "{} is no header of a matrix; write columns, rows, form, type, name and format as 4I8, 2A4, such as \
                 1P,5E16.9",
                text::quote(text)
            ),
        )
    };
    let mut numbers = [0; 4];
    for (index, number) in numbers.iter_mut().enumerate() {
        let field = text.get(8 * index..8 * index + 8).ok_or_else(wrong)?;
        *number = text::integer(field).ok_or_else(wrong)?;
    }
    let name = text.get(32..40).ok_or_else(wrong)?;
    let format = text.get(40..).and_then(format).ok_or_else(wrong)?;
    Ok((Header::new(numbers, name, Place::Line(line))?, format))
}

/// The format `1P,5E16.9`, with or without the scale and parentheses.
fn format(text: &str) -> Option<Format> {
    let (count, rest) =
        text.rsplit(',').next()?.trim_matches([' ', '(', ')']).split_once(['E', 'D'])?;
    let (width, _) = rest.split_once('.')?;
    let count = count.trim_start_matches("1P").parse().ok().filter(|&count| count > 0)?;
    Some(Format { count, width: width.parse().ok().filter(|&width| width > 0)? })
}

fn integers(line: usize, text: &str) -> Result<Vec<i64>, Fault> {
    let numbers = text.split_whitespace().map(text::integer).collect::<Option<Vec<_>>>();
    numbers.ok_or_else(|| {
        Fault::line(
            line,
            format!(
                "{} stands where whole numbers belong; write the file again",
                text::quote(text)
            ),
        )
    })
}

/// Adds the values in the next lines, which stand below each other, from a row and a column on. `count` is the number of
/// them, or of their words.
fn run<'a, I>(
    lines: &mut Lines<I>,
    header: &Header,
    format: &Format,
    builder: &mut Builder,
    (first, column): (usize, usize),
    count: usize,
) -> Result<(), Fault>
where
    I: Iterator<Item = (usize, Cow<'a, str>)>,
{
    let start = lines.line;
    let mut found = 0;
    while let Some((line, text)) = lines.values() {
        let mut rest = text.trim_end();
        for _ in 0..format.count {
            if rest.is_empty() {
                break;
            }
            let (field, after) = rest
                .split_at_checked(format.width.min(rest.len()))
                .ok_or_else(|| wrong(line, rest))?;
            let value = text::number(field).ok_or_else(|| wrong(line, field))?;
            if value != 0.0 {
                builder.push(first + found, column, value, Place::Line(line))?;
            }
            found += 1;
            rest = after;
        }
        if !rest.is_empty() {
            return Err(wrong(line, rest));
        }
    }
    if found != count && found * header.words != count {
        return Err(Fault::line(
            start,
            format!(
                "the line states {count} words, but {found} values follow it; the file is damaged: write it again"
            ),
        ));
    }
    Ok(())
}

fn wrong(line: usize, text: &str) -> Fault {
    Fault::line(
        line,
        format!(
            "{} is no number in the format of the header; write the file again",
            text::quote(text)
        ),
    )
}
