//! LU factors of P(λ) for one λ, with its determinant.

use super::Determinant;
use super::analysis::{Analysis, Supernode};
use super::dense;
use amontons::Error;
use faer::c64;
use std::f64::consts::{LN_2, PI};

/// Factors of R P(λ) S = L U, with R and S diagonal powers of two and rows exchanged within the fronts.
pub(super) struct Factors<'a> {
    pub(super) analysis: &'a Analysis,
    /// The panels of all supernodes: L below the diagonal, whose ones are not stored, and U.
    pub(super) values: Vec<c64>,
    /// For each row in the order of elimination, the row of its front that was exchanged to it.
    pub(super) exchanged: Vec<usize>,
    /// The diagonals of R and S in the order of elimination.
    pub(super) scales: [Vec<f64>; 2],
    /// The determinant of P(λ).
    pub(super) determinant: Determinant,
}

impl<'a> Factors<'a> {
    /// Factorises P(λ) by the multifrontal method. Rows are exchanged within the columns of a front only, so the caller has
    /// to check the backward error of a solution.
    ///
    /// # Errors
    /// Returns an error if a pivot is zero or not finite.
    pub(super) fn new(analysis: &'a Analysis, lambda: c64) -> Result<Self, Error> {
        let mut values = vec![c64::default(); analysis.size];
        let scales = assemble(analysis, lambda, &mut values);
        let size = analysis.order.len();
        let mut exchanged = vec![0; size];
        let mut odd = false;
        let mut updates: Vec<Option<Vec<c64>>> = vec![None; analysis.supernodes.len()];
        let mut place = vec![0; size];
        for (number, supernode) in analysis.supernodes.iter().enumerate() {
            let (width, below) = (supernode.width(), supernode.below.len());
            let indices = supernode.columns.clone().chain(supernode.below.iter().copied());
            for (local, index) in indices.enumerate() {
                place[index] = local;
            }
            let mut update = vec![c64::default(); below * below];
            let (panel, right) = values[supernode.offset..]
                [..supernode.right() - supernode.offset + width * below]
                .split_at_mut(supernode.right() - supernode.offset);
            for &child in &supernode.children {
                let taken = updates[child].take().expect("children come before parents");
                let rows = &analysis.supernodes[child].below;
                add(supernode, rows, &taken, &place, panel, right, &mut update);
            }
            let exchanged = &mut exchanged[supernode.columns.clone()];
            odd ^= dense::eliminate(width, below, panel, right, &mut update, exchanged);
            if below > 0 {
                updates[number] = Some(update);
            }
        }
        let mut factors = Self {
            analysis,
            values,
            exchanged,
            scales,
            determinant: Determinant { log: 0.0, phase: if odd { PI } else { 0.0 } },
        };
        factors.sum_determinant()?;
        Ok(factors)
    }

    /// Multiplies the pivots into the determinant and divides the scales out.
    fn sum_determinant(&mut self) -> Result<(), Error> {
        let (mut log, mut phase) = (0.0, self.determinant.phase);
        for supernode in &self.analysis.supernodes {
            let rows = supernode.width() + supernode.below.len();
            for local in 0..supernode.width() {
                let pivot = self.values[supernode.offset + local * (rows + 1)];
                let magnitude = pivot.norm();
                if !(magnitude > 0.0 && magnitude.is_finite()) {
                    return Err(Error::analysis(
                        "P(λ) has a zero pivot: λ is an eigenvalue, or the order of elimination meets a singular block",
                    ));
                }
                log += magnitude.ln();
                phase += pivot.arg();
            }
        }
        // Powers of two have exact logarithms to the base 2, and their sum is exact.
        let exponents: f64 = self.scales.iter().flatten().map(|scale| scale.log2()).sum();
        self.determinant =
            Determinant { log: log - exponents * LN_2, phase: phase.rem_euclid(2.0 * PI) };
        Ok(())
    }
}

/// Writes the scaled entries of P(λ) to their places and returns the scales of its rows and columns.
fn assemble(analysis: &Analysis, lambda: c64, values: &mut [c64]) -> [Vec<f64>; 2] {
    let size = analysis.order.len();
    let value =
        |[mass, damping, stiffness]: [f64; 3]| (lambda * mass + damping) * lambda + stiffness;
    let entries: Vec<c64> = analysis.terms.iter().map(|term| value(term.coefficients)).collect();
    let magnitudes: Vec<f64> = entries.iter().map(|entry| entry.norm()).collect();
    let mut scales = [vec![1.0; size], vec![1.0; size]];
    // Ruiz: the root of the largest magnitude of each row and column, a few times.
    for _ in 0..3 {
        let mut largest = [vec![0f64; size], vec![0f64; size]];
        for (term, magnitude) in analysis.terms.iter().zip(&magnitudes) {
            let scaled = magnitude * scales[0][term.row] * scales[1][term.column];
            largest[0][term.row] = largest[0][term.row].max(scaled);
            largest[1][term.column] = largest[1][term.column].max(scaled);
        }
        for (scale, &largest) in scales.iter_mut().flatten().zip(largest.iter().flatten()) {
            if largest > 0.0 {
                *scale *= (-0.5 * largest.log2()).round().exp2();
            }
        }
    }
    for (term, entry) in analysis.terms.iter().zip(entries) {
        values[term.target] = entry * (scales[0][term.row] * scales[1][term.column]);
    }
    scales
}

/// Adds the update of a child, whose rows and columns are `rows`, to the front of its parent.
fn add(
    parent: &Supernode,
    rows: &[usize],
    child: &[c64],
    place: &[usize],
    panel: &mut [c64],
    right: &mut [c64],
    update: &mut [c64],
) {
    let (width, below) = (parent.width(), parent.below.len());
    let places: Vec<usize> = rows.iter().map(|&row| place[row]).collect();
    let inner = places.partition_point(|&place| place < width);
    let (upper, lower) = places.split_at(inner);
    for (column, values) in places.iter().zip(child.chunks_exact(rows.len())) {
        if *column < width {
            let target = &mut panel[column * (width + below)..][..width + below];
            for (&row, value) in places.iter().zip(values) {
                target[row] += value;
            }
        } else {
            let column = column - width;
            let target = &mut right[column * width..][..width];
            for (&row, value) in upper.iter().zip(values) {
                target[row] += value;
            }
            let target = &mut update[column * below..][..below];
            for (&row, value) in lower.iter().zip(&values[inner..]) {
                target[row - width] += value;
            }
        }
    }
}
