//! Entries of K and D from springs and dampers.

use crate::model::Entry;

/// The elongation of a spring or damper as a combination of degrees of freedom.
pub(super) type Elongation = Vec<(usize, f64)>;

/// The elongation between two ends.
pub(super) fn difference(mut a: Elongation, b: Elongation) -> Elongation {
    a.extend(b.into_iter().map(|(dof, value)| (dof, -value)));
    a
}

/// Adds k b bᵀ for a spring k (or a damper) with elongation b.
pub(super) fn spring(entries: &mut Vec<Entry>, k: f64, elongation: &Elongation) {
    for &(i, a) in elongation {
        for &(j, b) in elongation {
            entries.push((i, j, k * (a * b)));
        }
    }
}
