//! The forces of contacts that hold, for given contact states.

use crate::contact::{ContactState, Friction};
use crate::integrator::dynamics::Dynamics;

/// An unknown multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unknown {
    contact: usize,
    /// 0: the normal force, with the friction force of one that slides; 1: the friction force of one
    /// that sticks.
    row: usize,
    /// ±µ of a contact that slides.
    slope: f64,
}

/// λ of given contact states as a linear function of the accelerations without contact forces: closed
/// contacts do not move along their normals, stuck ones not against the slider, sliding ones have
/// T = ±µN. Contacts that share masses are solved together.
pub(super) struct HeldContacts {
    /// The contacts, group by group.
    order: Vec<usize>,
    /// The end of each group in `order`.
    ends: Vec<usize>,
    unknowns: Vec<Unknown>,
    /// Where each group's part of `unknowns` ends.
    unknown_ends: Vec<usize>,
    /// The inverse of each group's matrix, by rows, one after the other.
    inverses: Vec<f64>,
    /// Room for one group's matrix.
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl HeldContacts {
    pub(super) fn new(dynamics: &Dynamics) -> Self {
        let count = dynamics.contacts.len();
        let mut group = vec![usize::MAX; count];
        let (mut order, mut ends) = (Vec::with_capacity(count), Vec::new());
        for start in 0..count {
            if group[start] != usize::MAX {
                continue;
            }
            let mut next = order.len();
            order.push(start);
            group[start] = ends.len();
            while next < order.len() {
                for &(other, _) in dynamics.multipliers.delassus.others(order[next]) {
                    if group[other] == usize::MAX {
                        group[other] = ends.len();
                        order.push(other);
                    }
                }
                next += 1;
            }
            ends.push(order.len());
        }
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let sizes: Vec<usize> = starts.zip(&ends).map(|(from, to)| 2 * (to - from)).collect();
        let entries = sizes.iter().map(|size| size * size).sum();
        let most = sizes.iter().copied().max().unwrap_or(0);
        Self {
            order,
            unknowns: Vec::with_capacity(2 * count),
            unknown_ends: Vec::with_capacity(ends.len()),
            ends,
            inverses: Vec::with_capacity(entries),
            matrix: vec![0.0; most * most],
            right: vec![0.0; most],
        }
    }

    /// The number of contacts in the largest group that shares masses.
    pub(super) fn largest_group(&self) -> usize {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(from, to)| to - from).max().unwrap_or(0)
    }

    /// Takes over the contact states; `friction` holds the coefficients of each contact. Redundant rows (two contacts that
    /// hold one mass) carry nothing: the motion is the same whichever of them does.
    pub(super) fn set(
        &mut self,
        dynamics: &Dynamics,
        states: &[ContactState],
        friction: &[Friction],
    ) {
        self.unknowns.clear();
        self.unknown_ends.clear();
        self.inverses.clear();
        let mut from = 0;
        for group in 0..self.ends.len() {
            let first = self.unknowns.len();
            for &contact in &self.order[from..self.ends[group]] {
                let slope =
                    states[contact].sliding_direction().unwrap_or(0.0) * friction[contact].kinetic;
                if states[contact] != ContactState::Detached {
                    self.unknowns.push(Unknown { contact, row: 0, slope });
                }
                if states[contact] == ContactState::Stick {
                    self.unknowns.push(Unknown { contact, row: 1, slope: 0.0 });
                }
            }
            from = self.ends[group];
            self.unknown_ends.push(self.unknowns.len());
            self.invert(dynamics, first);
        }
    }

    /// T/N of a contact that slides; zero for any other.
    pub(super) fn slope(&self, contact: usize) -> f64 {
        let mut unknowns = self.unknowns.iter();
        unknowns.find(|unknown| unknown.contact == contact).map_or(0.0, |unknown| unknown.slope)
    }

    /// Appends the inverse of the matrix of the unknowns from `first` on.
    fn invert(&mut self, dynamics: &Dynamics, first: usize) {
        let unknowns = &self.unknowns[first..];
        let size = unknowns.len();
        let matrix = &mut self.matrix[..size * size];
        for (entry, (row, column)) in unknowns
            .iter()
            .flat_map(|row| unknowns.iter().map(move |column| (row, column)))
            .enumerate()
        {
            let block = dynamics.multipliers.delassus.block(row.contact, column.contact);
            let at = |part: usize| block[2 * row.row + part];
            matrix[entry] = at(column.row) + column.slope * at(1);
        }
        let start = self.inverses.len();
        self.inverses.resize(start + size * size, 0.0);
        invert(matrix, &mut self.inverses[start..], size);
    }

    /// λ (N, T) of each contact, where `free` holds the accelerations without contact forces along
    /// normal and tangent; those that the contacts must have are zero.
    pub(super) fn forces(&mut self, free: impl Fn(usize, usize) -> f64, forces: &mut [[f64; 2]]) {
        forces.fill([0.0; 2]);
        let (mut from, mut start) = (0, 0);
        for &to in &self.unknown_ends {
            let unknowns = &self.unknowns[from..to];
            let size = unknowns.len();
            for (right, unknown) in self.right.iter_mut().zip(unknowns) {
                *right = free(unknown.contact, unknown.row);
            }
            for (row, unknown) in unknowns.iter().enumerate() {
                let inverse = &self.inverses[start + row * size..start + (row + 1) * size];
                let sum = inverse.iter().zip(&self.right).fold(0.0, |sum, (i, r)| sum + i * r);
                forces[unknown.contact][unknown.row] = 0.0 - sum;
                if unknown.slope != 0.0 {
                    forces[unknown.contact][1] = unknown.slope * (0.0 - sum);
                }
            }
            start += size * size;
            from = to;
        }
    }
}

/// The inverse by elimination with full pivots; rows and columns that depend on others stay zero.
fn invert(matrix: &mut [f64], inverse: &mut [f64], size: usize) {
    if let [entry] = matrix {
        inverse[0] = if *entry == 0.0 { 0.0 } else { 1.0 / *entry };
        return;
    }
    // Gauss–Jordan in place on [matrix | 1], one pivot a column, taken from rows not used so far.
    let largest = matrix.iter().fold(0.0, |largest, entry| f64::max(largest, entry.abs()));
    inverse.fill(0.0);
    for i in 0..size {
        inverse[i * size + i] = 1.0;
    }
    let mut used = [usize::MAX; 2 * MAX_GROUP];
    for _ in 0..size {
        let mut pivot = (0, 0, 1e-12 * largest);
        for row in (0..size).filter(|row| used[*row] == usize::MAX) {
            for column in (0..size).filter(|column| !used[..size].contains(column)) {
                let entry = matrix[row * size + column].abs();
                if entry > pivot.2 {
                    pivot = (row, column, entry);
                }
            }
        }
        let (row, column, entry) = pivot;
        if entry <= 1e-12 * largest {
            break;
        }
        used[row] = column;
        let scale = 1.0 / matrix[row * size + column];
        for k in 0..size {
            matrix[row * size + k] *= scale;
            inverse[row * size + k] *= scale;
        }
        for other in (0..size).filter(|other| *other != row) {
            let factor = matrix[other * size + column];
            if factor != 0.0 {
                for k in 0..size {
                    matrix[other * size + k] -= factor * matrix[row * size + k];
                    inverse[other * size + k] -= factor * inverse[row * size + k];
                }
            }
        }
    }
    // Row `r` of the eliminated system gives the unknown `used[r]`; those without a row are zero.
    matrix.fill(0.0);
    for row in 0..size {
        let unknown = used[row];
        if unknown != usize::MAX {
            for k in 0..size {
                let is_used = used[k] != usize::MAX;
                matrix[unknown * size + k] = if is_used { inverse[row * size + k] } else { 0.0 };
            }
        }
    }
    inverse.copy_from_slice(matrix);
}

/// The most contacts that may share masses.
pub(super) const MAX_GROUP: usize = 32;

#[cfg(test)]
mod tests {
    use super::*;

    fn product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
        let at = |i: usize, j: usize| (0..n).fold(0.0, |sum, k| sum + a[i * n + k] * b[k * n + j]);
        (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
    }

    #[test]
    fn the_inverse_is_one() {
        let matrix = [0.0, 2.0, 1.0, 3.0, -1.0, 0.5, 1.0, 1.0, 4.0];
        let mut inverse = [0.0; 9];
        invert(&mut matrix.clone(), &mut inverse, 3);
        for (i, value) in product(&matrix, &inverse, 3).into_iter().enumerate() {
            let expected = if i % 4 == 0 { 1.0 } else { 0.0 };
            assert!((value - expected).abs() < 1e-14, "{value}");
        }
    }

    #[test]
    fn rows_that_depend_on_others_carry_nothing() {
        // Two contacts that hold one mass: whatever is consistent is met.
        let matrix = [1.0, 1.0, 1.0, 1.0];
        let mut inverse = [0.0; 4];
        invert(&mut matrix.clone(), &mut inverse, 2);
        let force = [inverse[0] * 3.0 + inverse[1] * 3.0, inverse[2] * 3.0 + inverse[3] * 3.0];
        assert_eq!(force[0] + force[1], 3.0);
    }
}
