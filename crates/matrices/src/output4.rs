//! Matrices that module OUTPUT4 of Nastran writes (`.op4`), as text or as Fortran records.
//!
//! A matrix has a header with its numbers of columns and rows, its form (1 square, 2 rectangular, 6 symmetric), its type
//! (1 single, 2 double precision; 3 and 4 are complex), and its name. Then each column that is not zero has a record with
//! its number, the first row, and a number of words of four bytes. A first row of 0 means strings of entries, each with a
//! head: one word with 65536 (L + 1) + row, or, where the header states a negative number of rows or more than 65535 of
//! them (BIGMAT), two words with L + 1 and the row, for L words of values. Zeros are left out. A record of column NCOL + 1 ends the matrix.
//!
//! The file does not tell degrees of freedom: the rows are in the order of the set of the matrix in Nastran, by node and
//! then by direction for the G-set without scalar points.
//!
//! Sources: QRG and DMAP Programmer's Guide of MSC Nastran, module OUTPUT4.

use crate::builder::Builder;
use crate::{Fault, Matrix, Place, Symmetry, output4_binary, output4_text, text};

/// Reads the matrices of a file of either kind.
///
/// # Errors
/// Returns a fault if a header or a record is wrong, if the file ends within a matrix, or if a matrix is complex.
pub fn read(content: &[u8]) -> Result<Vec<Matrix>, Fault> {
    match output4_binary::order(content) {
        Some(order) => output4_binary::read(content, order),
        None => output4_text::read(content),
    }
}

/// The part of the diagonal by which entries across it may differ in a symmetric matrix of single and of double precision.
/// Nastran computes both triangles of a reduced matrix, and they differ by its rounding; text has fewer digits than a double.
const ROUNDING: [f64; 2] = [1e-5, 1e-9];

/// The header of a matrix.
pub(crate) struct Header {
    pub(crate) columns: i64,
    /// `true` if the heads of strings have two words.
    pub(crate) big: bool,
    /// The number of words of a value: 1 in single, 2 in double precision.
    pub(crate) words: usize,
    rows: usize,
    symmetry: Symmetry,
    name: String,
}

impl Header {
    /// The header with these numbers: columns, rows, form, type.
    ///
    /// # Errors
    /// Returns a fault at the place if a number is out of its range.
    pub(crate) fn new(numbers: [i64; 4], name: &str, place: Place) -> Result<Self, Fault> {
        let [columns, rows, form, kind] = numbers;
        let name = name.trim().to_owned();
        let fault = |message| Fault { place, message };
        let (Ok(count), Ok(magnitude)) =
            (usize::try_from(columns), usize::try_from(rows.unsigned_abs()))
        else {
            return Err(fault(format!(
                "matrix {name} states {columns} columns; write a number from 0"
            )));
        };
        let symmetry = match form {
            1 | 2 => Symmetry::General,
            6 if count == magnitude => Symmetry::Symmetric,
            6 => {
                return Err(fault(format!(
                    "matrix {name} is symmetric (form 6), but has {magnitude} rows and {columns} columns; write form 2"
                )));
            }
            _ => {
                return Err(fault(format!(
                    "matrix {name} has the form {form}; write it as form 1 (square), 2 (rectangular) or 6 (symmetric)"
                )));
            }
        };
        let words = match kind {
            1 | 2 => kind as usize,
            3 | 4 => {
                return Err(fault(format!(
                    "matrix {name} has complex numbers (type {kind}); write a real matrix"
                )));
            }
            _ => {
                return Err(fault(format!(
                    "matrix {name} has the type {kind}; write 1 or 2 for real numbers of single or double precision"
                )));
            }
        };
        let big = !(0..=65535).contains(&rows);
        Ok(Self { columns, big, words, rows: magnitude, symmetry, name })
    }

    pub(crate) fn builder(&self) -> Builder {
        Builder::new(self.rows, self.columns as usize, self.symmetry)
            .rounded(ROUNDING[self.words - 1])
    }

    /// The finished matrix with the name of the header.
    pub(crate) fn finish(self, builder: Builder) -> Result<Matrix, Fault> {
        Ok(Matrix { name: Some(self.name), ..builder.finish()? })
    }

    /// The index of a column by its number from 1.
    pub(crate) fn column(&self, number: i64, place: Place) -> Result<usize, Fault> {
        match usize::try_from(number) {
            Ok(number @ 1..) => Ok(number - 1),
            _ => Err(Fault {
                place,
                message: format!(
                    "column {number} of matrix {} does not exist; write numbers from 1",
                    self.name
                ),
            }),
        }
    }

    /// The first row, from 0, and the number of words of values, by the head of a string of one or two words.
    pub(crate) fn string(&self, head: &[i64], place: Place) -> Result<(usize, usize), Fault> {
        let (length, row) = match *head {
            [length, row] => (length, row),
            [packed] => (packed.div_euclid(65536), packed.rem_euclid(65536)),
            _ => (0, 0),
        };
        match (usize::try_from(length), usize::try_from(row)) {
            (Ok(length @ 1..), Ok(row @ 1..)) => Ok((row - 1, length - 1)),
            _ => {
                let text = head.iter().map(i64::to_string).collect::<Vec<_>>().join(" ");
                Err(Fault {
                    place,
                    message: format!(
                        "{} does not begin a string of matrix {}; the file is damaged, or mixes the forms of strings: write \
                         it again",
                        text::quote(&text),
                        self.name
                    ),
                })
            }
        }
    }
}
