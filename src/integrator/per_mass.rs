//! Accelerations of structures whose matrices are full.
//!
//! Where M⁻¹ is full, M⁻¹ K and M⁻¹ D are no larger than K and D, so one product with each gives accelerations at once: a
//! third less work than forces first and M⁻¹ after them. With a diagonal M nothing would be gained.

use crate::model::{LumpedModel, SparseMatrix};

/// M⁻¹ K and M⁻¹ D of a structure.
pub(super) struct PerMass {
    stiffness: SparseMatrix,
    dampers: SparseMatrix,
}

/// The motion that a structure answers with accelerations.
#[derive(Clone, Copy)]
pub(super) struct Strain<'a> {
    /// x + β ẋ, m; one value for each degree of freedom.
    pub(super) stretch: &'a [f64],
    /// ẋ, m/s.
    pub(super) velocity: &'a [f64],
    /// α, 1/s.
    pub(super) alpha: f64,
}

impl PerMass {
    /// `true` for structures that are faster with these products.
    pub(super) fn suits(model: &LumpedModel) -> bool {
        model.stiffness.is_full() && model.mass.as_diagonal().is_none()
    }

    /// The products of a structure that they [suit](Self::suits).
    pub(super) fn of(model: &LumpedModel, inverse_mass: &SparseMatrix) -> Option<Self> {
        Self::suits(model).then(|| Self {
            stiffness: product(inverse_mass, &model.stiffness),
            dampers: product(inverse_mass, &model.dampers),
        })
    }

    /// Subtracts M⁻¹ K (x + β ẋ) + M⁻¹ D ẋ + α ẋ from accelerations, m/s².
    pub(super) fn subtract(&self, strain: Strain<'_>, acceleration: &mut [f64]) {
        let Strain { stretch, velocity, alpha } = strain;
        self.stiffness.each_product(stretch, |dof, springs| acceleration[dof] -= springs);
        if !self.dampers.is_empty() {
            self.dampers.each_product(velocity, |dof, damped| acceleration[dof] -= damped);
        }
        if alpha != 0.0 {
            for (acceleration, velocity) in acceleration.iter_mut().zip(velocity) {
                *acceleration -= alpha * velocity;
            }
        }
    }
}

/// The product of two matrices, each entry summed by ascending places.
fn product(a: &SparseMatrix, b: &SparseMatrix) -> SparseMatrix {
    let rows = a.rows();
    let mut entries = Vec::new();
    for row in 0..rows {
        let mut sums = vec![0.0; rows];
        for (place, factor) in a.row(row) {
            b.row(place).for_each(|(column, value)| sums[column] += factor * value);
        }
        entries.extend(sums.into_iter().enumerate().map(|(column, value)| (row, column, value)));
    }
    SparseMatrix::from_entries(rows, entries)
}
