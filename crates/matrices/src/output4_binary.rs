//! Files of OUTPUT4 of Nastran as Fortran records with words of 32 bits, in either order of bytes.

use crate::output4::Header;
use crate::{Fault, Matrix, Place};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Little,
    Big,
}

impl Order {
    fn integer(self, word: [u8; 4]) -> i64 {
        i64::from(match self {
            Self::Little => i32::from_le_bytes(word),
            Self::Big => i32::from_be_bytes(word),
        })
    }

    /// A value of one or two words.
    fn value(self, words: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..words.len()];
        bytes.copy_from_slice(words);
        if self == Self::Big {
            bytes.reverse();
        }
        match *bytes {
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        }
    }
}

/// The order of bytes of a file whose first record has the length of a header, of 24 bytes, or 48 with words of 64 bits.
pub(crate) fn order(content: &[u8]) -> Option<Order> {
    let marker = *content.first_chunk::<4>()?;
    [Order::Little, Order::Big].into_iter().find(|order| [24, 48].contains(&order.integer(marker)))
}

pub(crate) fn read(content: &[u8], order: Order) -> Result<Vec<Matrix>, Fault> {
    let mut records = Records { content, order, at: 0 };
    let mut matrices = Vec::new();
    while let Some(record) = records.next()? {
        if record.bytes.len() == 48 {
            return Err(Fault::offset(
                record.at,
                "the file has words of 64 bits; write it with 32 bits (OP2_64=NO, or the LP-64 version of Nastran)",
            ));
        }
        let header = header(&record, order)?;
        matrices.push(matrix(&mut records, header)?);
    }
    Ok(matrices)
}

/// A Fortran record: its bytes between the markers of its length, and the place of the first of them.
struct Record<'a> {
    at: usize,
    bytes: &'a [u8],
}

struct Records<'a> {
    content: &'a [u8],
    order: Order,
    at: usize,
}

impl<'a> Records<'a> {
    /// The next record; none at the end of the file.
    fn next(&mut self) -> Result<Option<Record<'a>>, Fault> {
        if self.at == self.content.len() {
            return Ok(None);
        }
        let start = self.at;
        let length = self.marker()?;
        let cut = || {
            Fault::offset(
                start,
                format!(
                    "the record states {length} bytes, more than the file has; it is cut: copy or write it again"
                ),
            )
        };
        let length = usize::try_from(length).map_err(|_| cut())?;
        let bytes = self.content[self.at..].get(..length).ok_or_else(cut)?;
        let record = Record { at: self.at, bytes };
        self.at += length;
        let after = self.at;
        let end = self.marker()?;
        if usize::try_from(end) != Ok(length) {
            return Err(Fault::offset(
                after,
                format!(
                    "the record that begins at byte {start} states {length} bytes before and {end} after them; the file is \
                     damaged: copy it in binary mode, or write it again"
                ),
            ));
        }
        Ok(Some(record))
    }

    fn marker(&mut self) -> Result<i64, Fault> {
        let marker = self.content[self.at..].first_chunk::<4>().ok_or_else(|| {
            Fault::offset(
                self.at,
                "the file ends within the length of a record; it is cut: copy or write it again",
            )
        })?;
        self.at += 4;
        Ok(self.order.integer(*marker))
    }
}

fn header(record: &Record, order: Order) -> Result<Header, Fault> {
    let place = Place::Offset(record.at);
    let Some((words, name)) = record.bytes.split_at_checked(16).filter(|(_, name)| name.len() == 8)
    else {
        let message = format!(
            "a record of {} bytes stands where a header of 24 belongs; the file is damaged: write it again",
            record.bytes.len()
        );
        return Err(Fault { place, message });
    };
    let mut numbers = [0; 4];
    for (number, word) in numbers.iter_mut().zip(integers(words, order)) {
        *number = word;
    }
    Header::new(numbers, &String::from_utf8_lossy(name), place)
}

/// The whole words of these bytes as integers.
fn integers(bytes: &[u8], order: Order) -> impl Iterator<Item = i64> {
    bytes.as_chunks().0.iter().map(move |&word| order.integer(word))
}

/// Reads the columns of a matrix up to the record that ends it.
fn matrix(records: &mut Records, header: Header) -> Result<Matrix, Fault> {
    let order = records.order;
    let mut builder = header.builder();
    loop {
        let Some(record) = records.next()? else {
            return Err(Fault::offset(
                records.at,
                format!(
                    "the file ends before column {} that ends the matrix; it is cut: write it again",
                    header.columns + 1
                ),
            ));
        };
        let damaged = || {
            Fault::offset(
                record.at,
                "the record is no column of the matrix: its length does not fit; write the file again",
            )
        };
        let (head, values) = record.bytes.split_at_checked(12).ok_or_else(damaged)?;
        let head: Vec<i64> = integers(head, order).collect();
        let (column, row, words) = (head[0], head[1], head[2]);
        if usize::try_from(words).map(|words| words.checked_mul(4)) != Ok(Some(values.len())) {
            return Err(damaged());
        }
        if column > header.columns {
            return header.finish(builder);
        }
        let place = Place::Offset(record.at);
        let column = header.column(column, place)?;
        let at = record.at + 12;
        if let Ok(first @ 1..) = usize::try_from(row) {
            run(&header, order, &mut builder, (first - 1, column), at, values)?;
            continue;
        }
        let mut rest = values;
        while !rest.is_empty() {
            let at = at + values.len() - rest.len();
            let (head, after) =
                rest.split_at_checked(if header.big { 8 } else { 4 }).ok_or_else(damaged)?;
            let head: Vec<i64> = integers(head, order).collect();
            let (first, length) = header.string(&head, Place::Offset(at))?;
            let bytes = length.checked_mul(4).ok_or_else(damaged)?;
            let (values, after) = after.split_at_checked(bytes).ok_or_else(damaged)?;
            run(&header, order, &mut builder, (first, column), at + 4 * head.len(), values)?;
            rest = after;
        }
    }
}

/// Adds values that stand below each other, from a row and a column on. `at` is the place of the first.
fn run(
    header: &Header,
    order: Order,
    builder: &mut crate::builder::Builder,
    (first, column): (usize, usize),
    at: usize,
    values: &[u8],
) -> Result<(), Fault> {
    let size = 4 * header.words;
    if !values.len().is_multiple_of(size) {
        return Err(Fault::offset(
            at,
            format!(
                "{} words are no values of {} words; write the file again",
                values.len() / 4,
                header.words
            ),
        ));
    }
    for (index, value) in values.chunks_exact(size).enumerate() {
        let value = order.value(value);
        if value != 0.0 {
            builder.push(first + index, column, value, Place::Offset(at + index * size))?;
        }
    }
    Ok(())
}
