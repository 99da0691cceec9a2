//! How far the modes of a superelement are from those of the full matrices, and that none is missing.

use super::bounds::{Bounded, frequency, grouped};
use super::factor::negative;
use super::lanczos::dense;
use super::modes::below;
use super::reduction::Superelement;
use super::structure::Structure;
use amontons::Error;
use amontons_analysis::watch::Watch;
use faer::{Mat, Side};

/// The modes of a superelement below a limit, beside those of the full matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// The frequency at which modes were counted, Hz.
    pub limit: f64,
    /// The number of modes of the full matrices below the limit, by the signs of the pivots of K − ω²M.
    pub full: usize,
    /// The number of modes of the superelement below the limit, by the same count.
    pub reduced: usize,
    /// For each mode of the full matrices below the limit, in ascending order: an interval that contains its eigenvalue. A
    /// group of m intervals that overlap contains m eigenvalues.
    pub intervals: Vec<Bounded>,
    /// The rounding of an eigenvalue by the digits of the matrices, 1/s².
    pub rounding: f64,
    /// The frequency of the superelement's mode of the same rank, Hz: it is never lower, but for rounding.
    pub frequencies: Vec<f64>,
}

impl Certificate {
    /// `true` if full matrices and superelement have the same number of modes below the limit, and each interval ends below
    /// it.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.full == self.reduced
            && self.full == self.intervals.len()
            && self.intervals.iter().all(|interval| interval.frequencies()[1] < self.limit)
    }

    /// `true` for a mode that moves the structure as a rigid body or a mechanism: its eigenvalue cannot be told from 0 by the
    /// digits of the matrices.
    #[must_use]
    pub fn is_rigid(&self, mode: usize) -> bool {
        let Bounded { value, distance } = self.intervals[mode];
        value.abs() - distance <= self.rounding
    }

    /// The largest possible relative error of a frequency of the superelement; `None` for a rigid mode.
    #[must_use]
    pub fn error(&self, mode: usize) -> Option<f64> {
        let [low, high] = self.intervals[mode].frequencies();
        let reduced = *self.frequencies.get(mode)?;
        (!self.is_rigid(mode)).then(|| (reduced - low).abs().max((reduced - high).abs()) / low)
    }
}

/// Compares the modes of a superelement below a frequency in Hz with those of the full matrices, while the degrees of freedom
/// `held` (rows of the full matrices, all of them retained) are held.
///
/// # Errors
/// Returns an error if a held degree of freedom is not retained, if the structure is not at rest in a stable position or has a
/// motion without mass, if more than `memory` bytes are needed, or if the work has been ended.
pub fn certify(
    structure: &Structure,
    superelement: &Superelement,
    held: &[usize],
    limit: f64,
    memory: usize,
    watch: Watch<'_>,
) -> Result<Certificate, Error> {
    let mut is_held = vec![false; structure.freedoms.len()];
    for &row in held {
        if !superelement.retained.contains(&row) {
            return Err(Error::argument(format!("row {} is held but not retained", row + 1)));
        }
        is_held[row] = true;
    }
    let free: Vec<usize> = (0..is_held.len()).filter(|&row| !is_held[row]).collect();
    let stiffness = structure.stiffness.part(&free, &free);
    let mass = structure.mass.part(&free, &free);
    let counted = below(&stiffness, &mass, limit, memory, watch)?;
    let intervals = grouped(&counted.bounds);

    let coordinates: Vec<usize> = (0..superelement.stiffness.nrows())
        .filter(|&at| superelement.retained.get(at).is_none_or(|&row| !is_held[row]))
        .collect();
    let part = |matrix: &Mat<f64>| {
        Mat::from_fn(coordinates.len(), coordinates.len(), |row, column| {
            matrix[(coordinates[row], coordinates[column])]
        })
    };
    let (reduced_stiffness, reduced_mass) =
        (part(&superelement.stiffness), part(&superelement.mass));
    let (values, _) = dense(&reduced_stiffness, &reduced_mass)?;
    let shifted = &reduced_stiffness - faer::Scale(counted.limit) * &reduced_mass;
    let factors = shifted.lblt(Side::Lower);
    Ok(Certificate {
        limit: frequency(counted.limit),
        full: counted.count,
        reduced: negative(
            coordinates.len(),
            |at| factors.B_diag()[at],
            |at| factors.B_subdiag()[at],
        )
        .ok_or_else(|| {
            Error::analysis("the modes of the superelement cannot be counted at this frequency; ask for another one")
        })?,
        frequencies: values.iter().take(intervals.len()).map(|&value| frequency(value)).collect(),
        intervals,
        rounding: counted.rounding,
    })
}
