//! The packed form of superelements, which an FMU carries as a file `NAME.superelement`. All numbers are little endian:
//!
//! | bytes | content |
//! | --- | --- |
//! | 8 | `AMSUPER` and the version, 1 |
//! | 4 | number n of degrees of freedom |
//! | 3 | form of mass, stiffness and damping: 0 absent, 1 lower triangle by rows, 2 all rows |
//! | 9 n | node (8 bytes) and direction (1 byte) of each degree of freedom |
//! | 8 each | the values of the matrices as doubles, in this order |
//! | 8 | checksum of all bytes before it (FNV-1a) |

use super::superelement::{is_symmetric, too_many};
use super::{Freedom, MAX_FREEDOMS, SuperelementMatrices};

/// The first bytes of a packed file; the last of them is the version.
const MAGIC: [u8; 8] = *b"AMSUPER\x01";

impl SuperelementMatrices {
    /// The packed form, which [`from_bytes`](Self::from_bytes) reads.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let (freedoms, n) = (self.freedoms(), self.dofs());
        let parts = [self.mass(), self.stiffness(), self.damping()]
            .map(|matrix| (Form::of(matrix, n), matrix));
        let mut bytes = MAGIC.to_vec();
        // `new` bounds the number.
        bytes.extend_from_slice(&u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
        bytes.extend(parts.iter().map(|(form, _)| *form as u8));
        for Freedom { node, direction } in freedoms {
            bytes.extend_from_slice(&node.to_le_bytes());
            bytes.push(*direction);
        }
        for (form, matrix) in parts {
            for (row, values) in matrix.chunks_exact(n).enumerate() {
                let end = if form == Form::Lower { row + 1 } else { n };
                bytes.extend(values[..end].iter().flat_map(|value| value.to_le_bytes()));
            }
        }
        let sum = checksum(&bytes);
        bytes.extend_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// Reads the packed form.
    ///
    /// # Errors
    /// Returns why the bytes are not a superelement: another kind of file, another version, damage, or what
    /// [`new`](Self::new) refuses.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        const SHORT: &str = "ends too early: write or copy it once more";
        if !bytes.starts_with(&MAGIC[..7]) {
            return Err(
                "is not a packed superelement; give matrix files as `stiffness` and `mass`".into(),
            );
        }
        let version = bytes.get(7).copied().unwrap_or_default();
        if version != MAGIC[7] {
            return Err(format!(
                "has version {version} of the packed form, but this program reads version 1"
            ));
        }
        let (content, sum) = bytes.split_last_chunk::<8>().ok_or(SHORT)?;
        if u64::from_le_bytes(*sum) != checksum(content) {
            return Err(
                "is damaged: its checksum does not match; write or copy it once more".into()
            );
        }
        let mut rest = Bytes(&content[8..]);
        let n =
            usize::try_from(u32::from_le_bytes(rest.take().ok_or(SHORT)?)).unwrap_or(usize::MAX);
        if n > MAX_FREEDOMS {
            return Err(too_many(n));
        }
        let forms: [u8; 3] = rest.take().ok_or(SHORT)?;
        let mut freedoms = Vec::with_capacity(n);
        for _ in 0..n {
            let node = u64::from_le_bytes(rest.take().ok_or(SHORT)?);
            let [direction] = rest.take().ok_or(SHORT)?;
            freedoms.push(Freedom { node, direction });
        }
        let mut matrix = |form| -> Result<Vec<f64>, String> {
            Ok(rest.matrix(Form::try_from(form)?, n).ok_or(SHORT)?)
        };
        let [mass, stiffness, damping] = [matrix(forms[0])?, matrix(forms[1])?, matrix(forms[2])?];
        if !rest.0.is_empty() {
            return Err(
                "has more numbers than its matrices need; write or copy it once more".into()
            );
        }
        Self::new(freedoms, mass, stiffness, damping).map_err(|problems| {
            let all: Vec<String> = problems.iter().map(ToString::to_string).collect();
            format!("is no superelement: {}", all.join("; "))
        })
    }
}

/// How a matrix is packed.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Absent = 0,
    Lower = 1,
    Full = 2,
}

impl Form {
    fn of(matrix: &[f64], n: usize) -> Self {
        if matrix.is_empty() {
            Self::Absent
        } else if is_symmetric(matrix, n) {
            Self::Lower
        } else {
            Self::Full
        }
    }
}

impl TryFrom<u8> for Form {
    type Error = String;

    fn try_from(byte: u8) -> Result<Self, String> {
        match byte {
            0 => Ok(Self::Absent),
            1 => Ok(Self::Lower),
            2 => Ok(Self::Full),
            _ => Err(format!(
                "has a matrix in the form {byte}, but the forms of version 1 are 0, 1 and 2; write the file once more"
            )),
        }
    }
}

/// Bytes that have not been read yet.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    fn matrix(&mut self, form: Form, n: usize) -> Option<Vec<f64>> {
        if form == Form::Absent {
            return Some(Vec::new());
        }
        let mut matrix = vec![0.0; n * n];
        for row in 0..n {
            let end = if form == Form::Lower { row + 1 } else { n };
            for column in 0..end {
                let value = f64::from_le_bytes(self.take()?);
                matrix[row * n + column] = value;
                if form == Form::Lower {
                    matrix[column * n + row] = value;
                }
            }
        }
        Some(matrix)
    }
}

/// The hash FNV-1a of 64 bits, <http://www.isthe.com/chongo/tech/comp/fnv/>.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3)
    })
}
