//! Direct solution of sparse systems: reverse Cuthill–McKee ordering, banded LU, row pivoting.
//!
//! The loops are written here in a fixed order, so that the equilibrium is the same to the last bit on every
//! machine; libraries choose fused multiply-add at run time.

use super::sparse::Entry;
use std::collections::VecDeque;

/// A zero pivot: the matrix is singular (to working precision).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Singular;

/// Solves `A x = b` for the square matrix with the given entries; entries at one place add up.
pub(super) fn solve(size: usize, entries: &[Entry], b: &[f64]) -> Result<Vec<f64>, Singular> {
    let order = reverse_cuthill_mckee(size, entries);
    let mut place = vec![0; size];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let half_band = entries.iter().map(|&(i, j, _)| place[i].abs_diff(place[j])).max().unwrap_or(0);
    let mut band = Band::new(size, half_band);
    for &(i, j, value) in entries {
        *band.at(place[i], place[j]) += value;
    }
    let mut x: Vec<f64> = order.iter().map(|&old| b[old]).collect();
    band.solve(&mut x)?;
    Ok(place.iter().map(|&new| x[new]).collect())
}

/// A breadth-first numbering from a node of low degree, reversed: neighbours stay close together.
fn reverse_cuthill_mckee(size: usize, entries: &[Entry]) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); size];
    for &(i, j, _) in entries {
        if i != j {
            neighbours[i].push(j);
            neighbours[j].push(i);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let degree: Vec<usize> = neighbours.iter().map(Vec::len).collect();
    for list in &mut neighbours {
        list.sort_by_key(|&node| (degree[node], node));
    }
    let mut starts: Vec<usize> = (0..size).collect();
    starts.sort_by_key(|&node| (degree[node], node));

    let mut order = Vec::with_capacity(size);
    let mut seen = vec![false; size];
    let mut queue = VecDeque::new();
    for start in starts {
        if !std::mem::replace(&mut seen[start], true) {
            queue.push_back(start);
        }
        while let Some(node) = queue.pop_front() {
            order.push(node);
            for &next in &neighbours[node] {
                if !std::mem::replace(&mut seen[next], true) {
                    queue.push_back(next);
                }
            }
        }
    }
    order.reverse();
    order
}

/// A banded matrix by rows; row pivoting widens the upper band to twice the half band.
struct Band {
    size: usize,
    half: usize,
    width: usize,
    values: Vec<f64>,
}

impl Band {
    fn new(size: usize, half: usize) -> Self {
        let width = 3 * half + 1;
        Self { size, half, width, values: vec![0.0; size * width] }
    }

    fn index(&self, row: usize, column: usize) -> usize {
        row * self.width + column + self.half - row
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        let index = self.index(row, column);
        &mut self.values[index]
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), Singular> {
        let scale = self.values.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        for k in 0..self.size {
            let below = (k + self.half).min(self.size - 1);
            let last = (k + 2 * self.half).min(self.size - 1);
            let mut pivot = k;
            for row in k + 1..=below {
                if self.at(row, k).abs() > self.at(pivot, k).abs() {
                    pivot = row;
                }
            }
            // A pivot this small is the rounding of an exact zero.
            if self.at(pivot, k).abs() <= 1e-14 * scale {
                return Err(Singular);
            }
            if pivot != k {
                for column in k..=last {
                    let (a, b) = (self.index(k, column), self.index(pivot, column));
                    self.values.swap(a, b);
                }
                x.swap(k, pivot);
            }
            for row in k + 1..=below {
                let factor = *self.at(row, k) / *self.at(k, k);
                if factor != 0.0 {
                    for column in k..=last {
                        let value = *self.at(k, column);
                        *self.at(row, column) -= factor * value;
                    }
                    x[row] -= factor * x[k];
                }
            }
        }
        for k in (0..self.size).rev() {
            let last = (k + 2 * self.half).min(self.size - 1);
            let mut sum = x[k];
            for (column, x) in x.iter().enumerate().take(last + 1).skip(k + 1) {
                sum -= *self.at(k, column) * x;
            }
            x[k] = sum / *self.at(k, k);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries of A and the right-hand side that belongs to a chosen solution.
    fn right_hand_side(entries: &[Entry], x: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; x.len()];
        for &(i, j, value) in entries {
            b[i] += value * x[j];
        }
        b
    }

    #[test]
    fn a_system_that_needs_pivoting_and_is_not_symmetric_is_solved() {
        let entries = [(0, 1, 2.0), (1, 0, 1.0), (1, 2, -3.0), (2, 2, 4.0), (2, 0, 5.0)];
        let x = [1.0, -2.0, 3.0];
        let solution = solve(3, &entries, &right_hand_side(&entries, &x)).unwrap();
        for (a, b) in solution.iter().zip(x) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn a_closed_ring_is_ordered_into_a_narrow_band() {
        let n = 1000;
        let entries: Vec<Entry> = (0..n)
            .flat_map(|i| [(i, i, 2.5), (i, (i + 1) % n, -1.0), ((i + 1) % n, i, -1.0)])
            .collect();
        let order = reverse_cuthill_mckee(n, &entries);
        let mut place = vec![0_usize; n];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        let half = entries.iter().map(|&(i, j, _)| place[i].abs_diff(place[j])).max();
        assert_eq!(half, Some(2));
        let x: Vec<f64> = (0..n).map(|i| f64::from(u32::try_from(i % 7).unwrap())).collect();
        let solution = solve(n, &entries, &right_hand_side(&entries, &x)).unwrap();
        for (a, b) in solution.iter().zip(&x) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn a_singular_matrix_is_told_apart() {
        let entries = [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)];
        assert_eq!(solve(2, &entries, &[1.0, 1.0]), Err(Singular));
    }
}
