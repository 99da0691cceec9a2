//! MATLAB files (`.mat`) of level 5, which `save -v7` and `save -v6` of MATLAB, Octave and SciPy write.
//!
//! Format: MathWorks, MAT-File Format. A header of 128 bytes, then elements: a tag with the type and the number of bytes, and
//! the data. A variable is an element of elements (flags, dimensions, name, data), which can be compressed.

use crate::compressed::Compressed;
use crate::matrix::position;
use crate::numbers::{Kind, Numbers, decompressed_limit, dense, inflate, within};
use crate::text::quote;
use crate::{Fault, Matrix, Place, Symmetry};
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Classes of variables: sparse, and the first and last of those of numbers.
const SPARSE: u8 = 5;
const DOUBLE: u8 = 6;
const UINT64: u8 = 15;

/// The flag of complex values.
const COMPLEX: u8 = 8;

/// Bytes at the begin of a compressed variable that hold its flags, dimensions and name, which has up to 63 characters.
const HEAD: u64 = 512;

/// The variables of a file that are real matrices.
pub struct File<'a> {
    big_endian: bool,
    limit: u64,
    names: Vec<String>,
    /// The offset of each variable, `true` if it is compressed, and its bytes.
    variables: Vec<(usize, bool, &'a [u8])>,
}

impl<'a> File<'a> {
    /// Finds the matrices.
    ///
    /// # Errors
    /// Returns a fault if the content is no such file.
    pub fn new(content: &'a [u8]) -> Result<Self, Fault> {
        let big_endian = match content.get(124..128) {
            Some([_, _, b'I', b'M']) => false,
            Some([_, _, b'M', b'I']) => true,
            _ => {
                return Err(Fault::whole(
                    "the file is no MATLAB file of level 5; write it with `save -v7` in MATLAB, or with scipy.io.savemat",
                ));
            }
        };
        let mut file = Self {
            big_endian,
            limit: decompressed_limit(content.len()),
            names: Vec::new(),
            variables: Vec::new(),
        };
        let mut offset = 128;
        while offset < content.len() {
            let fault = |message: &str| Fault::offset(offset, message);
            let mut rest = &content[offset..];
            let (kind, data) = element(&mut rest, big_endian)
                .ok_or_else(|| fault("the file ends within this variable; write it again"))?;
            let compressed = kind == COMPRESSED;
            if compressed || kind == MATRIX {
                let body = if compressed { Cow::Owned(head(data)) } else { Cow::Borrowed(data) };
                let body = if compressed { body.get(8..).unwrap_or_default() } else { &body };
                let variable = Variable::parse(body, big_endian).ok_or_else(|| {
                    fault("the flags, dimensions or name of this variable are wrong; write the file again")
                })?;
                if variable.is_real_matrix() {
                    file.names.push(variable.name);
                    file.variables.push((offset, compressed, data));
                }
            }
            offset = content.len() - rest.len();
        }
        Ok(file)
    }

    /// The names of the matrices.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Reads the matrix of this name.
    ///
    /// # Errors
    /// Returns a fault if there is none, or it is wrong.
    pub fn read(&self, name: &str) -> Result<Matrix, Fault> {
        let found = position(&self.names, name)?;
        let (offset, compressed, data) = self.variables[found];
        let at = |fault: Fault| Fault {
            place: Place::Offset(offset),
            message: format!("in the matrix {}: {}", quote(name), fault.message),
        };
        let inflated;
        let body = if compressed {
            inflated = inflate(data, self.limit).map_err(at)?;
            let mut rest = &*inflated;
            let cut = || {
                at(Fault::whole(
                    "the compressed part is shorter than it states; write the file again",
                ))
            };
            element(&mut rest, self.big_endian).ok_or_else(cut)?.1
        } else {
            data
        };
        let mut matrix = self.matrix(body).map_err(at)?;
        matrix.name = Some(name.to_owned());
        Ok(matrix)
    }

    /// The matrix of a variable.
    fn matrix(&self, body: &[u8]) -> Result<Matrix, Fault> {
        let wrong = |part: &str| {
            Fault::whole(format!(
                "its {part} are cut off, or of no known type; write the file again"
            ))
        };
        let big_endian = self.big_endian;
        let variable = Variable::parse(body, big_endian).ok_or_else(|| wrong("dimensions"))?;
        let &[rows, columns] = &*variable.dimensions else {
            return Err(wrong("dimensions"));
        };
        let mut rest = variable.rest;
        let mut part = |name| {
            let found = element(&mut rest, big_endian)
                .and_then(|(kind, data)| numbers(kind, data, big_endian));
            within(self.limit, found.ok_or_else(|| wrong(name))?)
        };
        if variable.class != SPARSE {
            let values = part("values")?;
            return dense(rows, columns, values.len(), values.reals(), false);
        }
        let indices = part("rows")?.integers().ok_or_else(|| wrong("rows"))?;
        let pointers = part("columns")?.integers().ok_or_else(|| wrong("columns"))?;
        let values: Vec<_> = part("values")?.reals().collect();
        // A file can have room for more entries than there are, for the rows and the values each.
        let used = pointers.last().and_then(|&end| usize::try_from(end).ok()).unwrap_or(0);
        let parts = Compressed {
            rows,
            columns,
            symmetry: Symmetry::General,
            by_rows: false,
            base: 0,
            pointers: &pointers,
            indices: indices.get(..used).unwrap_or(&indices),
            values: values.get(..used).unwrap_or(&values),
        };
        parts.matrix(|_| Place::Whole)
    }
}

/// The flags, dimensions and name of a variable, and the elements after them.
struct Variable<'a> {
    class: u8,
    complex: bool,
    dimensions: Vec<usize>,
    name: String,
    rest: &'a [u8],
}

impl<'a> Variable<'a> {
    fn parse(body: &'a [u8], big_endian: bool) -> Option<Self> {
        let mut rest = body;
        let (_, flags) = element(&mut rest, big_endian)?;
        let flags = word(flags, big_endian)?;
        let (class, complex) = (flags as u8, (flags >> 8) as u8 & COMPLEX != 0);
        // Variables of other classes have other elements, which nothing needs.
        if class != SPARSE && !(DOUBLE..=UINT64).contains(&class) {
            return Some(Self {
                class,
                complex,
                dimensions: Vec::new(),
                name: String::new(),
                rest,
            });
        }
        let (kind, dimensions) = element(&mut rest, big_endian)?;
        let dimensions = numbers(kind, dimensions, big_endian)?.integers()?;
        let dimensions = dimensions
            .into_iter()
            .map(|length| usize::try_from(length).ok())
            .collect::<Option<_>>()?;
        let (_, name) = element(&mut rest, big_endian)?;
        let name = String::from_utf8_lossy(name).into_owned();
        Some(Self { class, complex, dimensions, name, rest })
    }

    fn is_real_matrix(&self) -> bool {
        // MATLAB keeps its own data in a variable without a name.
        !self.complex && self.dimensions.len() == 2 && !self.name.is_empty()
    }
}

/// Takes an element off: its type and its data, which fill up to a multiple of 8 bytes unless they are compressed. `None` if
/// it is cut off.
fn element<'a>(rest: &mut &'a [u8], big_endian: bool) -> Option<(u32, &'a [u8])> {
    let first = word(rest, big_endian)?;
    // Up to 4 bytes are within the tag, and their number is in the upper half of its first word.
    let length = (first >> 16) as usize;
    if length > 0 {
        let data = rest.get(4..8)?.get(..length)?;
        *rest = &rest[8..];
        return Some((first & 0xffff, data));
    }
    let length = word(rest.get(4..)?, big_endian)? as usize;
    let (data, after) = rest[8..].split_at_checked(length)?;
    let padding = if first == COMPRESSED { 0 } else { length.wrapping_neg() % 8 };
    *rest = after.get(padding..).unwrap_or_default();
    Some((first, data))
}

/// The first 32 bits.
fn word(bytes: &[u8], big_endian: bool) -> Option<u32> {
    let &bytes = bytes.first_chunk()?;
    Some(if big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
}

/// The numbers of an element of this type.
fn numbers(kind: u32, data: &[u8], big_endian: bool) -> Option<Numbers<'_>> {
    let (kind, size) = match kind {
        1 => (Kind::Signed, 1),
        2 => (Kind::Unsigned, 1),
        3 => (Kind::Signed, 2),
        4 => (Kind::Unsigned, 2),
        5 => (Kind::Signed, 4),
        6 => (Kind::Unsigned, 4),
        7 => (Kind::Float, 4),
        9 => (Kind::Float, 8),
        12 => (Kind::Signed, 8),
        13 => (Kind::Unsigned, 8),
        _ => return None,
    };
    Numbers::new(data, kind, size, big_endian)
}

/// The first bytes of a compressed variable; fewer if it is wrong, which its reader finds.
fn head(data: &[u8]) -> Vec<u8> {
    let mut head = Vec::new();
    // What was decompressed before an error stays in `head`.
    let _ = ZlibDecoder::new(data).take(HEAD).read_to_end(&mut head);
    head
}
