//! NumPy arrays (`.npy`), as `numpy.save` writes them.
//!
//! Format: NEP 1 (numpy.lib.format). A mark, the version, the length of the header, the header (a literal of a Python
//! dictionary with the type of the numbers, their order and the shape), then the numbers.

use crate::numbers::{Kind, Numbers, dense};
use crate::text::quote;
use crate::{Fault, Matrix};

/// Reads a dense matrix.
///
/// # Errors
/// Returns a fault if the content is no array of real numbers with two dimensions, or is wrong.
pub fn read(content: &[u8]) -> Result<Matrix, Fault> {
    Array::parse(content)?.matrix()
}

/// An array of real numbers or of text.
pub(crate) struct Array<'a> {
    /// The length of each dimension.
    pub(crate) shape: Vec<usize>,
    /// `true` if the first index changes fastest, as in Fortran.
    fortran: bool,
    data: Data<'a>,
}

/// The data of an array.
enum Data<'a> {
    Numbers(Numbers<'a>),
    Text(String),
}

impl<'a> Array<'a> {
    /// The array in the content of a `.npy` file.
    pub(crate) fn parse(content: &'a [u8]) -> Result<Self, Fault> {
        let cut = || Fault::whole("the file ends within its header; write it again");
        let rest = content.strip_prefix(b"\x93NUMPY").ok_or_else(|| {
            Fault::offset(0, "the file is no NumPy array; write it with numpy.save")
        })?;
        let (&[major, _], rest) = rest.split_first_chunk().ok_or_else(cut)?;
        let (length, rest) = match major {
            1 => {
                let (&length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
                (usize::from(u16::from_le_bytes(length)), rest)
            }
            2 | 3 => {
                let (&length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
                (u32::from_le_bytes(length) as usize, rest)
            }
            _ => {
                return Err(Fault::offset(
                    6,
                    format!("the version {major} of the format is unknown; known are 1, 2 and 3"),
                ));
            }
        };
        let (header, data) = rest.split_at_checked(length).ok_or_else(cut)?;
        let header = String::from_utf8_lossy(header);
        let header = header.trim();
        let wrong = || {
            Fault::offset(
                10,
                format!(
                    "the header {} needs the keys descr, fortran_order and shape; write the array with numpy.save",
                    quote(header)
                ),
            )
        };
        let descr = value_of(header, "descr").ok_or_else(wrong)?;
        let fortran = match value_of(header, "fortran_order").ok_or_else(wrong)? {
            text if text.starts_with("True") => true,
            text if text.starts_with("False") => false,
            _ => return Err(wrong()),
        };
        let shape = value_of(header, "shape").and_then(shape_of).ok_or_else(wrong)?;
        let total = shape.iter().try_fold(1_usize, |total, &length| total.checked_mul(length));
        let data = data_of(descr, data, total)?;
        Ok(Self { shape, fortran, data })
    }

    /// The array as a matrix.
    pub(crate) fn matrix(&self) -> Result<Matrix, Fault> {
        let &[rows, columns] = &*self.shape else {
            return Err(Fault::whole(format!(
                "the array has {} dimensions; a matrix has two",
                self.shape.len()
            )));
        };
        let numbers = self.numbers()?;
        dense(rows, columns, numbers.len(), numbers.reals(), !self.fortran)
    }

    /// The numbers.
    pub(crate) fn numbers(&self) -> Result<Numbers<'a>, Fault> {
        match self.data {
            Data::Numbers(numbers) => Ok(numbers),
            Data::Text(_) => Err(Fault::whole("the array has text; a matrix needs numbers")),
        }
    }

    /// The text of an array that has some.
    pub(crate) fn text(&self) -> Option<&str> {
        match &self.data {
            Data::Numbers(_) => None,
            Data::Text(text) => Some(text),
        }
    }
}

/// The text after a key of a dictionary.
fn value_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// The numbers of a tuple.
fn shape_of(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let lengths = inside.split(',').map(str::trim).filter(|length| !length.is_empty());
    // Python 2 wrote `2L`.
    lengths.map(|length| length.trim_end_matches('L').parse().ok()).collect()
}

/// The data of an array of `total` values with this type, such as `'<f8'`.
fn data_of<'a>(descr: &str, bytes: &'a [u8], total: Option<usize>) -> Result<Data<'a>, Fault> {
    let name = descr.strip_prefix('\'').and_then(|rest| Some(rest.split_once('\'')?.0));
    let name = name.unwrap_or(descr);
    let mut letters = name.chars();
    let order = letters.next();
    let kind = letters.next();
    let size =
        letters.as_str().parse::<usize>().ok().filter(|_| matches!(order, Some('<' | '>' | '|')));
    let known = match (kind, size) {
        (Some('f'), Some(size)) => Some((Kind::Float, size)),
        (Some('i'), Some(size)) => Some((Kind::Signed, size)),
        (Some('u' | 'b'), Some(size)) => Some((Kind::Unsigned, size)),
        // Names of layouts: of one byte or four for each character.
        (Some('S' | 'U'), Some(_)) => {
            let text = bytes.iter().filter(|&&byte| byte != 0).map(|&byte| char::from(byte));
            return Ok(Data::Text(text.take(40).collect()));
        }
        _ => None,
    };
    let unknown = || {
        Fault::whole(format!(
            "the array has numbers of the type {}; a matrix needs real numbers: convert it with astype(float)",
            quote(name)
        ))
    };
    let (kind, size) = known.ok_or_else(unknown)?;
    let expected = total.and_then(|total| total.checked_mul(size));
    if expected != Some(bytes.len()) {
        let expected =
            expected.map_or_else(|| "more than there can be".to_owned(), |bytes| bytes.to_string());
        return Err(Fault::whole(format!(
            "the values have {} bytes, but the header states {expected}; the file may have been cut off: write it again",
            bytes.len()
        )));
    }
    Numbers::new(bytes, kind, size, order == Some('>')).map(Data::Numbers).ok_or_else(unknown)
}
