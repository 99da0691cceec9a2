//! Numbers in binary files.

use crate::{Fault, Matrix, Place, Symmetry, builder::Builder};
use flate2::read::ZlibDecoder;
use std::io::Read;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A signed integer.
    Signed,
    /// An integer without sign, or a truth value.
    Unsigned,
    /// A floating-point number.
    Float,
}

/// Numbers of one kind, one after another.
#[derive(Clone, Copy)]
pub(crate) struct Numbers<'a> {
    bytes: &'a [u8],
    kind: Kind,
    /// Bytes of a number: 1, 2, 4 or 8; of a floating-point number 4 or 8.
    size: usize,
    big_endian: bool,
}

impl<'a> Numbers<'a> {
    /// The numbers in these bytes; `None` if there is no such kind of this size, or the last number is cut off.
    pub(crate) fn new(bytes: &'a [u8], kind: Kind, size: usize, big_endian: bool) -> Option<Self> {
        let known = match kind {
            Kind::Float => matches!(size, 4 | 8),
            Kind::Signed | Kind::Unsigned => matches!(size, 1 | 2 | 4 | 8),
        };
        (known && bytes.len().is_multiple_of(size)).then_some(Self {
            bytes,
            kind,
            size,
            big_endian,
        })
    }

    /// How many numbers there are.
    pub(crate) const fn len(&self) -> usize {
        self.bytes.len() / self.size
    }

    /// The bits of the numbers, whose sign is extended.
    fn bits(self) -> impl Iterator<Item = u64> + 'a {
        let unused = 64 - 8 * self.size as u32;
        self.bytes.chunks_exact(self.size).map(move |chunk| {
            let mut bytes = [0; 8];
            bytes[..self.size].copy_from_slice(chunk);
            if self.big_endian {
                bytes[..self.size].reverse();
            }
            let bits = u64::from_le_bytes(bytes);
            let signed = self.kind == Kind::Signed;
            if signed { ((bits << unused).cast_signed() >> unused).cast_unsigned() } else { bits }
        })
    }

    /// The numbers as doubles.
    pub(crate) fn reals(self) -> impl Iterator<Item = f64> + 'a {
        self.bits().map(move |bits| match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            (Kind::Signed, _) => bits.cast_signed() as f64,
            (Kind::Unsigned, _) => bits as f64,
        })
    }

    /// The numbers as integers; `None` if one is none, or too large.
    pub(crate) fn integers(self) -> Option<Vec<i64>> {
        match self.kind {
            // 2^53, up to which each integer is a double.
            Kind::Float => self
                .reals()
                .map(|value| {
                    (value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0)
                        .then_some(value as i64)
                })
                .collect(),
            Kind::Signed => Some(self.bits().map(u64::cast_signed).collect()),
            Kind::Unsigned => self.bits().map(|bits| i64::try_from(bits).ok()).collect(),
        }
    }
}

/// A matrix of which all values are given, `count` in number, by columns or by rows. Its zeros are no entries.
///
/// # Errors
/// Returns a fault if there is another number of values, or a value is not finite.
pub(crate) fn dense(
    rows: usize,
    columns: usize,
    count: usize,
    values: impl Iterator<Item = f64>,
    by_rows: bool,
) -> Result<Matrix, Fault> {
    if rows.checked_mul(columns) != Some(count) {
        return Err(Fault::whole(format!(
            "there are {count} values, but {rows} rows and {columns} columns; the file may have been cut off: write it again"
        )));
    }
    let mut builder = Builder::new(rows, columns, Symmetry::General);
    for (index, value) in values.enumerate().filter(|&(_, value)| value != 0.0) {
        let (row, column) =
            if by_rows { (index / columns, index % columns) } else { (index % rows, index / rows) };
        builder.push(row, column, value, Place::Whole)?;
    }
    builder.finish()
}

/// The number of bytes that are read from a compressed part of a file of this size: 32 MiB and 64 times the file. A file that
/// has more is refused, so that a short one cannot fill the memory. Numbers count as doubles, since they become such.
pub(crate) const fn decompressed_limit(file: usize) -> u64 {
    (32 << 20) + 64 * file as u64
}

/// Decompresses bytes in the format of zlib, up to `limit`.
///
/// # Errors
/// Returns a fault if they are wrong or there are more.
pub(crate) fn inflate(bytes: &[u8], limit: u64) -> Result<Vec<u8>, Fault> {
    let mut content = Vec::new();
    ZlibDecoder::new(bytes).take(limit + 1).read_to_end(&mut content).map_err(|error| {
        Fault::whole(format!("the compressed part is wrong: {error}; write the file again"))
    })?;
    if content.len() as u64 > limit { Err(too_large(limit)) } else { Ok(content) }
}

/// These numbers, if they are not too many for a compressed part.
///
/// # Errors
/// Returns a fault if they have more than `limit` bytes as doubles.
pub(crate) fn within(limit: u64, numbers: Numbers<'_>) -> Result<Numbers<'_>, Fault> {
    if 8 * numbers.len() as u64 > limit { Err(too_large(limit)) } else { Ok(numbers) }
}

/// The fault of a part that has more than `limit` bytes when it is decompressed.
pub(crate) fn too_large(limit: u64) -> Fault {
    Fault::whole(format!(
        "the matrix needs more than {limit} bytes when it is decompressed, which is the limit for a file of this size; write \
         it as a sparse matrix, or without compression"
    ))
}
