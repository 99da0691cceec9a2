//! Solutions with the factors.

use super::dense::{add, dot, subtract_product};
use super::factors::Factors;
use faer::{MatRef, c64};

impl Factors<'_> {
    /// Replaces the right-hand side by the solution x of P(λ) x = b, or of P(λ)ᵀ x = b.
    pub(super) fn solve(&self, transposed: bool, x: &mut [c64]) {
        let order = &self.analysis.order;
        let [left, right] = if transposed { [1, 0] } else { [0, 1] };
        let mut y: Vec<c64> =
            order.iter().zip(&self.scales[left]).map(|(&old, scale)| x[old] * scale).collect();
        if transposed {
            self.solve_transposed(&mut y);
        } else {
            self.solve_plain(&mut y);
        }
        for ((&old, scale), y) in order.iter().zip(&self.scales[right]).zip(y) {
            x[old] = y * scale;
        }
    }

    fn solve_plain(&self, y: &mut [c64]) {
        let (mut gathered, mut below) = (vec![], vec![]);
        for supernode in &self.analysis.supernodes {
            let (width, rows) = (supernode.width(), supernode.width() + supernode.below.len());
            let panel = &self.values[supernode.offset..][..rows * width];
            let head = &y[supernode.columns.clone()];
            gathered.clear();
            gathered.extend(self.exchanged[supernode.columns.clone()].iter().map(|&row| head[row]));
            gathered.resize(rows, c64::default());
            let (head, tail) = gathered.split_at_mut(width);
            for (local, column) in panel.chunks_exact(rows).enumerate() {
                let factor = -head[local];
                add(factor, &column[local + 1..width], &mut head[local + 1..]);
            }
            let panel = MatRef::from_column_major_slice(panel, rows, width);
            subtract_product(panel.get(width.., ..), head, tail);
            y[supernode.columns.clone()].copy_from_slice(&gathered[..width]);
            for (&row, value) in supernode.below.iter().zip(&gathered[width..]) {
                y[row] += value;
            }
        }
        for supernode in self.analysis.supernodes.iter().rev() {
            let (width, rows) = (supernode.width(), supernode.width() + supernode.below.len());
            let panel = &self.values[supernode.offset..][..rows * width];
            let right = &self.values[supernode.right()..][..width * supernode.below.len()];
            gathered.clear();
            gathered.extend_from_slice(&y[supernode.columns.clone()]);
            below.clear();
            below.extend(supernode.below.iter().map(|&row| y[row]));
            let right = MatRef::from_column_major_slice(right, width, below.len());
            subtract_product(right, &below, &mut gathered);
            for (local, column) in panel.chunks_exact(rows).enumerate().rev() {
                gathered[local] /= column[local];
                let factor = -gathered[local];
                add(factor, &column[..local], &mut gathered[..local]);
            }
            y[supernode.columns.clone()].copy_from_slice(&gathered);
        }
    }

    fn solve_transposed(&self, y: &mut [c64]) {
        let mut gathered = vec![];
        for supernode in &self.analysis.supernodes {
            let (width, rows) = (supernode.width(), supernode.width() + supernode.below.len());
            let panel = &self.values[supernode.offset..][..rows * width];
            let right = &self.values[supernode.right()..][..width * supernode.below.len()];
            let head = &mut y[supernode.columns.clone()];
            for (local, column) in panel.chunks_exact(rows).enumerate() {
                head[local] =
                    (head[local] - dot::<false>(&column[..local], &head[..local])) / column[local];
            }
            gathered.clear();
            gathered.extend_from_slice(head);
            for (&row, column) in supernode.below.iter().zip(right.chunks_exact(width)) {
                y[row] -= dot::<false>(column, &gathered);
            }
        }
        for supernode in self.analysis.supernodes.iter().rev() {
            let (width, rows) = (supernode.width(), supernode.width() + supernode.below.len());
            let panel = &self.values[supernode.offset..][..rows * width];
            gathered.clear();
            gathered.extend_from_slice(&y[supernode.columns.clone()]);
            gathered.extend(supernode.below.iter().map(|&row| y[row]));
            for (local, column) in panel.chunks_exact(rows).enumerate().rev() {
                let sum = dot::<false>(&column[local + 1..], &gathered[local + 1..]);
                gathered[local] -= sum;
            }
            let exchanged = &self.exchanged[supernode.columns.clone()];
            for (&row, value) in exchanged.iter().zip(&gathered) {
                y[supernode.columns.start + row] = *value;
            }
        }
    }
}
