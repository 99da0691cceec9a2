//! Velocities along which some contacts neither open nor close.
//!
//! With M = L Lᵀ and ξ = Lᵀ v the kinetic energy of a velocity v is |ξ|²/2. A contact with the normal n is held if nᵀ v =
//! (L⁻¹ n)ᵀ ξ vanishes, so ξ is at right angles to all L⁻¹ n of held contacts. The nearest such velocity, in kinetic energy, is v
//! after impulses along the held normals.

use amontons::Error;
use amontons::model::{Direction, SparseMatrix};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A vector this small, in parts of what it was before a projection, is rounding.
pub(crate) const ROUNDING: f64 = 1e-9;

/// L of M = L Lᵀ.
enum Root {
    /// The square roots of a diagonal M.
    Diagonal(Vec<f64>),
    Full(Cholesky<f64, Dyn>),
}

impl Root {
    fn of(mass: &SparseMatrix) -> Result<Self, Error> {
        if let Some(diagonal) = mass.as_diagonal() {
            return Ok(Self::Diagonal(diagonal.iter().map(|mass| mass.sqrt()).collect()));
        }
        let full = DMatrix::from_fn(mass.rows(), mass.rows(), |i, j| mass.get(i, j));
        Cholesky::new(full).map(Self::Full).ok_or_else(|| {
            Error::argument(
                "the scene cannot be pushed: its mass matrix is not positive definite; give every motion a mass",
            )
        })
    }

    /// L⁻¹ n.
    fn scaled(&self, normal: &Direction, dofs: usize) -> DVector<f64> {
        let mut vector = DVector::zeros(dofs);
        for &(dof, part) in &normal.0 {
            vector[dof] += part;
        }
        match self {
            Self::Diagonal(roots) => {
                vector.iter_mut().zip(roots).for_each(|(part, root)| *part /= root);
            }
            Self::Full(factor) => {
                factor.l_dirty().solve_lower_triangular_mut(&mut vector);
            }
        }
        vector
    }

    /// L⁻ᵀ ξ.
    fn velocity(&self, mut xi: DVector<f64>) -> Vec<f64> {
        match self {
            Self::Diagonal(roots) => {
                xi.iter_mut().zip(roots).for_each(|(part, root)| *part /= root);
            }
            Self::Full(factor) => {
                factor.l_dirty().tr_solve_lower_triangular_mut(&mut xi);
            }
        }
        xi.iter().copied().collect()
    }

    /// Lᵀ v.
    fn xi(&self, velocity: &[f64]) -> DVector<f64> {
        match self {
            Self::Diagonal(roots) => DVector::from_iterator(
                roots.len(),
                velocity.iter().zip(roots).map(|(v, root)| v * root),
            ),
            Self::Full(factor) => factor.l().tr_mul(&DVector::from_column_slice(velocity)),
        }
    }
}

/// Contacts that are held, as vectors of length 1 at right angles in the coordinates ξ.
pub(crate) struct Held {
    root: Root,
    dofs: usize,
    units: Vec<DVector<f64>>,
}

impl Held {
    /// No contact is held.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is not positive definite.
    pub(crate) fn none(mass: &SparseMatrix) -> Result<Self, Error> {
        Ok(Self { root: Root::of(mass)?, dofs: mass.rows(), units: Vec::new() })
    }

    /// Holds a contact with this normal too.
    pub(crate) fn hold(&mut self, normal: &Direction) {
        let mut vector = self.root.scaled(normal, self.dofs);
        let before = vector.norm();
        self.remove(&mut vector);
        // A normal that others hold already adds none.
        let after = vector.norm();
        if after > ROUNDING * before {
            self.units.push(vector / after);
        }
    }

    /// `true` if held contacts leave no motion.
    pub(crate) fn is_all(&self) -> bool {
        self.units.len() >= self.dofs
    }

    /// The velocity L⁻ᵀ ξ without its part along held normals. Of independent normal draws ξ it has the same kinetic energy on average
    /// in every direction along which no held contact opens or closes.
    pub(crate) fn velocity(&self, mut xi: DVector<f64>) -> Vec<f64> {
        self.remove(&mut xi);
        self.root.velocity(xi)
    }

    /// The velocity nearest to another one, in kinetic energy, along which no held contact opens or closes.
    pub(crate) fn nearest(&self, velocity: &[f64]) -> Vec<f64> {
        self.velocity(self.root.xi(velocity))
    }

    /// Removes the parts of a vector along held normals; twice, against rounding.
    fn remove(&self, vector: &mut DVector<f64>) {
        for _ in 0..2 {
            for unit in &self.units {
                let part = unit.dot(vector);
                vector.axpy(-part, unit, 1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One mass of 2 kg and one of 1 kg whose coupling is 0.5 kg.
    fn coupled() -> SparseMatrix {
        SparseMatrix::from_entries(2, vec![(0, 0, 2.0), (0, 1, 0.5), (1, 0, 0.5), (1, 1, 1.0)])
    }

    /// Independent draws ξ of unit variance give velocities L⁻ᵀ ξ with the covariance L⁻ᵀ L⁻¹.
    #[test]
    fn velocities_of_a_full_mass_matrix_have_its_inverse_as_covariance() {
        let held = Held::none(&coupled()).unwrap();
        let [a, b] = [[1.0, 0.0], [0.0, 1.0]].map(|xi| held.velocity(DVector::from_row_slice(&xi)));
        let found = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| a[i] * a[j] + b[i] * b[j]);
        // The determinant is 1.75.
        for (found, expected) in found.into_iter().zip([1.0 / 1.75, -0.5 / 1.75, 2.0 / 1.75]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }

    /// An impulse J on the second mass stops it: v = (3, 5) + M⁻¹ (0, J) with M⁻¹ = (1, −0.5; −0.5, 2) / 1.75 and J = −5 · 1.75 / 2.
    #[test]
    fn the_nearest_velocity_that_holds_a_contact_is_that_after_an_impulse_on_it() {
        let mut held = Held::none(&coupled()).unwrap();
        held.hold(&Direction::unit(1));
        let found = held.nearest(&[3.0, 5.0]);
        for (found, expected) in found.iter().zip([3.0 + 0.5 * 5.0 / 2.0, 0.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        held.hold(&Direction::unit(1));
        assert!(!held.is_all());
        held.hold(&Direction::unit(0));
        assert!(held.is_all());
    }
}
