//! From the units of matrix files to SI units.
//!
//! A degree of freedom has the unit s of its SI value: the unit of length for a displacement, 1 for a rotation, and
//! (unit of length) √(unit of mass) for a modal coordinate, in which the modal mass keeps its value. The energies ½ q̇ᵀ M q̇ and
//! ½ qᵀ K q and the power q̇ᵀ C q̇ then give M_ij the unit (mass) (length)² / (s_i s_j), K_ij that by (time)², and C_ij that by
//! (time). Frequencies, displacements and forces of nodes do not depend on the unit of modal coordinates.

use amontons::scene::{Freedom, UnitFactors};

/// Factors of the entries of matrices.
pub(super) struct Scales {
    units: UnitFactors,
    /// (unit of length) / s of each row.
    rows: Vec<f64>,
}

/// The unit of length of the files over the unit of a coordinate of theirs, both as SI values: 1 for a displacement, the unit of length
/// for a rotation, 1/√(unit of mass) for a modal coordinate. The displacements of the nodes in m are the shapes of the files times the
/// coordinates in SI units, each coordinate multiplied by this.
#[must_use]
pub fn length_per_unit(units: UnitFactors, freedom: Freedom) -> f64 {
    match freedom.direction {
        0 => 1.0 / units.mass.sqrt(),
        1..=3 => 1.0,
        _ => units.length,
    }
}

impl Scales {
    pub(super) fn new(units: UnitFactors, freedoms: &[Freedom]) -> Self {
        let rows = freedoms.iter().map(|freedom| length_per_unit(units, *freedom));
        Self { units, rows: rows.collect() }
    }

    pub(super) fn mass(&self, matrix: &mut [f64]) {
        self.scale(matrix, self.units.mass);
    }

    pub(super) fn damping(&self, matrix: &mut [f64]) {
        self.scale(matrix, self.units.mass / self.units.time);
    }

    pub(super) fn stiffness(&self, matrix: &mut [f64]) {
        self.scale(matrix, self.units.mass / (self.units.time * self.units.time));
    }

    /// Multiplies each entry by its factor; `unit` is that of two displacements.
    fn scale(&self, matrix: &mut [f64], unit: f64) {
        let n = self.rows.len();
        for (values, row) in matrix.chunks_exact_mut(n).zip(&self.rows) {
            for (value, column) in values.iter_mut().zip(&self.rows) {
                *value *= unit * (row * column);
            }
        }
    }
}
