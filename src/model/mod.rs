//! The lumped model: mass, stiffness, damping, load, contact directions. No time here.
//!
//! M ẍ + C ẋ + K x = F + Σ (G_Nᵀ N + G_Tᵀ T) over the contacts (paper, eq. 1), C = α M + β K.

mod banded;
mod equilibrium;
mod reduced;
pub mod ring;
mod sparse;

pub use equilibrium::Equilibrium;
pub use reduced::ReducedMatrices;
pub use sparse::{Entry, SparseMatrix};

pub use crate::scene::Damping;

/// A structure of masses and springs with frictional contacts, linear but for its contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct LumpedModel {
    /// M, symmetric positive definite, kg; n × n.
    pub mass: SparseMatrix,
    /// K, symmetric, N/m; n × n.
    pub stiffness: SparseMatrix,
    /// C = α M + β K.
    pub damping: Damping,
    /// F, the constant load, N; length n.
    pub load: Vec<f64>,
    /// The contacts.
    pub contacts: Vec<Contact>,
}

/// A frictional contact: the two rows that it adds to G (paper, eq. 7).
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// G_N: the gap is G_N x, positive where the contact is open.
    pub normal: Direction,
    /// G_T: the tangential displacement is G_T x.
    pub tangent: Direction,
}

/// A direction in the space of the degrees of freedom, as its non-zero components.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction(pub Vec<(usize, f64)>);

impl Direction {
    /// The direction of one degree of freedom.
    #[must_use]
    pub fn unit(dof: usize) -> Self {
        Self(vec![(dof, 1.0)])
    }

    /// The degree of freedom, if this is the direction of just one.
    #[must_use]
    pub fn as_unit(&self) -> Option<usize> {
        match self.0[..] {
            [(dof, 1.0)] => Some(dof),
            _ => None,
        }
    }

    /// The component of `vector` along this direction.
    #[must_use]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.0.iter().fold(0.0, |sum, &(dof, value)| sum + value * vector[dof])
    }

    /// Adds `factor` times this direction to `vector`.
    pub fn add_to(&self, vector: &mut [f64], factor: f64) {
        for &(dof, value) in &self.0 {
            vector[dof] += factor * value;
        }
    }
}

impl LumpedModel {
    /// Number of degrees of freedom, n.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.load.len()
    }
}
