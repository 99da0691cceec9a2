//! Complex eigenvalues of quadratic problems, all in a rectangle.

mod analysis;
mod arnoldi;
mod count;
mod dense;
mod disc;
mod drift;
mod factors;
mod merge;
mod problem;
mod rectangle;
mod search;
mod shifted;
mod solve;

pub use count::{Count, Outcome, count};
pub use problem::Quadratic;
pub use rectangle::Rectangle;
pub use search::{eigenvalues, eigenvalues_again};

use faer::c64;

/// How eigenvalues are searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The largest dimension of the Krylov space of a shift.
    pub dimension: usize,
    /// The shifts, 1/s; if there are none, they are chosen.
    pub shifts: Vec<c64>,
    /// `true` to compute the left vectors as well, for bounds of the errors. The time of the search about doubles.
    pub bounds: bool,
    /// No more shifts are chosen after as many.
    pub most: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { dimension: 100, shifts: vec![], bounds: true, most: 1000 }
    }
}

/// An eigenvalue with its vector and its errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// λ, whose imaginary part is not negative; its conjugate is an eigenvalue as well. That of a real one is 0.
    pub eigenvalue: c64,
    /// x of P(λ) x = 0, of 2-norm 1.
    pub vector: Vec<c64>,
    /// ‖P(λ) x‖ / ((|λ|² ‖M‖ + |λ| ‖C‖ + ‖K‖) ‖x‖), with the 1-norms of the matrices: the smallest change of the matrices,
    /// relative to them, of which the pair is an exact one.
    pub backward: f64,
    /// A bound of the error of λ to first order, by the left vectors. None if they were not wanted, or if not as many of
    /// them as of the right ones were found near λ. It is large for eigenvalues that are almost defective.
    pub bound: Option<f64>,
}

/// A disc whose eigenvalues have all converged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trusted {
    /// The shift.
    pub centre: c64,
    /// The radius.
    pub radius: f64,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenvalues {
    /// All modes of the discs, also those outside the rectangle, by imaginary and then by real part.
    pub modes: Vec<Mode>,
    /// The rectangle that was asked for.
    pub rectangle: Rectangle,
    /// The rectangle with its edges [cleared](Rectangle::cleared) of the modes.
    pub edges: Rectangle,
    /// Rough places of eigenvalues outside the rectangle and the discs, with positive imaginary parts.
    pub rough: Vec<c64>,
    /// The discs.
    pub trusted: Vec<Trusted>,
    /// The number of factorisations.
    pub factorizations: usize,
    /// The number of solutions with factors.
    pub solves: usize,
}

impl Eigenvalues {
    /// The modes within [`Self::edges`].
    pub fn inside(&self) -> impl Iterator<Item = &Mode> {
        self.modes.iter().filter(|mode| self.edges.contains(mode.eigenvalue))
    }

    /// All eigenvalues that were found, inside and outside, as [`count`] takes them.
    #[must_use]
    pub fn found(&self) -> Vec<c64> {
        self.modes.iter().map(|mode| mode.eigenvalue).collect()
    }
}

/// The determinant of P(λ): exp(log + i phase).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Determinant {
    /// The logarithm of its magnitude.
    log: f64,
    /// Its phase in [0, 2π), rad.
    phase: f64,
}

#[cfg(test)]
mod tests;
