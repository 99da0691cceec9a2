//! Files of degrees of freedom that Ansys writes beside a Harwell–Boeing matrix (`HBMAT`, with Mapping = YES): after a line of
//! headings a line for each row of the matrix with its number, the node and a label such as `UX`.

use crate::text::{integer, lines, quote};
use crate::{Fault, Freedom};

/// The labels of displacements and rotations, in the order of their directions.
const LABELS: [&str; 6] = ["UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ"];

/// Reads the degree of freedom of each row.
///
/// # Errors
/// Returns a fault if a line has another form, a row is missing, or a label is unknown.
pub fn read(content: &[u8]) -> Result<Vec<Freedom>, Fault> {
    let mut freedoms = Vec::new();
    for (line, text) in lines(content).filter(|(_, text)| !text.trim().is_empty()) {
        let words: Vec<_> = text.split_whitespace().take(4).collect();
        if freedoms.is_empty() && words.first().copied().and_then(integer).is_none() {
            continue;
        }
        let fault = |message: String| Fault::line(line, message);
        let &[row, node, label] = &*words else {
            return Err(fault(format!("{} must be `row node label`", quote(text.trim()))));
        };
        if row.parse() != Ok(freedoms.len() + 1) {
            return Err(fault(format!(
                "the row is {}; the rows must follow one another, so it must be {}",
                quote(row),
                freedoms.len() + 1
            )));
        }
        let node = node
            .parse()
            .map_err(|_| fault(format!("the node {} is no whole number", quote(node))))?;
        let known = LABELS.iter().position(|known| known.eq_ignore_ascii_case(label));
        let Some(direction) = known else {
            return Err(fault(format!(
                "the label {} is unknown; known are {}. Leave the other degrees of freedom out of the matrix, or remove this \
                 file to read the matrix without nodes",
                quote(label),
                LABELS.join(", ")
            )));
        };
        freedoms.push(Freedom { node, direction: direction as u8 + 1 });
    }
    Ok(freedoms)
}
