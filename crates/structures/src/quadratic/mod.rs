//! Complex eigenvalues of quadratic problems, all in a rectangle.

mod analysis;
mod dense;
mod factors;
mod problem;
mod solve;

pub use problem::Quadratic;

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
