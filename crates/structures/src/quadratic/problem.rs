//! The quadratic eigenvalue problem.

use crate::sparse::Sparse;
use amontons::Error;
use faer::c64;

/// The quadratic eigenvalue problem P(λ) x = (λ² M + λ C + K) x = 0 with real matrices.
///
/// M may be singular; C and K may be unsymmetric (friction, gyroscopic forces). λ has the unit 1/s if the matrices belong to
/// seconds: its imaginary part is the angular frequency in rad/s, a positive real part is growth.
#[derive(Clone, Debug)]
pub struct Quadratic {
    mass: Sparse,
    damping: Sparse,
    stiffness: Sparse,
    norms: [f64; 3],
}

impl Quadratic {
    /// Takes over M, C and K.
    ///
    /// # Errors
    /// Returns an error if they are not square matrices of one size, at least 1.
    pub fn new(mass: Sparse, damping: Sparse, stiffness: Sparse) -> Result<Self, Error> {
        let size = mass.rows();
        for (name, matrix) in [("mass", &mass), ("damping", &damping), ("stiffness", &stiffness)] {
            let (rows, columns) = (matrix.rows(), matrix.columns());
            if rows != columns {
                return Err(Error::argument(format!(
                    "the {name} matrix has {rows} rows and {columns} columns; it must be square"
                )));
            }
            if rows != size {
                return Err(Error::argument(format!(
                    "the {name} matrix has {rows} rows, the mass matrix {size}; they must have as many"
                )));
            }
        }
        if size == 0 {
            return Err(Error::argument("the matrices have no rows; at least one is needed"));
        }
        let norms = [&mass, &damping, &stiffness].map(Sparse::norm_1);
        Ok(Self { mass, damping, stiffness, norms })
    }

    /// The number of rows of the matrices.
    #[must_use]
    pub fn size(&self) -> usize {
        self.mass.rows()
    }

    /// M.
    #[must_use]
    pub fn mass(&self) -> &Sparse {
        &self.mass
    }

    /// C.
    #[must_use]
    pub fn damping(&self) -> &Sparse {
        &self.damping
    }

    /// K.
    #[must_use]
    pub fn stiffness(&self) -> &Sparse {
        &self.stiffness
    }

    /// The diagonal of the mass matrix, without its sign.
    #[must_use]
    pub fn masses(&self) -> Vec<f64> {
        (0..self.size()).map(|row| self.mass.entry(row, row).abs()).collect()
    }

    /// |λ|² ‖M‖ + |λ| ‖C‖ + ‖K‖ in the 1-norm, to which the residual of a backward error is compared.
    pub(super) fn norm(&self, lambda: c64) -> f64 {
        let [mass, damping, stiffness] = self.norms;
        (lambda.norm() * mass + damping) * lambda.norm() + stiffness
    }

    /// P(λ) x, or P(λ)ᵀ x.
    pub(super) fn apply(&self, lambda: c64, transposed: bool, x: &[c64]) -> Vec<c64> {
        let factors = [lambda * lambda, lambda, c64::new(1.0, 0.0)];
        self.combine(factors, transposed, x)
    }

    /// P′(λ) x = (2 λ M + C) x.
    pub(super) fn derivative(&self, lambda: c64, x: &[c64]) -> Vec<c64> {
        self.combine([2.0 * lambda, c64::new(1.0, 0.0), c64::default()], false, x)
    }

    /// − M v − C x, or with the matrices transposed.
    pub(super) fn inertia(&self, transposed: bool, v: &[c64], x: &[c64]) -> Vec<c64> {
        let factor = c64::new(-1.0, 0.0);
        let mut y = self.combine([factor, c64::default(), c64::default()], transposed, v);
        add(&self.damping, factor, transposed, x, &mut y);
        y
    }

    /// (a M + b C + c K) x for the factors [a, b, c], or with the matrices transposed.
    fn combine(&self, factors: [c64; 3], transposed: bool, x: &[c64]) -> Vec<c64> {
        let mut y = vec![c64::default(); x.len()];
        let matrices = [&self.mass, &self.damping, &self.stiffness];
        for (matrix, factor) in matrices.into_iter().zip(factors) {
            if factor != c64::default() {
                add(matrix, factor, transposed, x, &mut y);
            }
        }
        y
    }
}

/// Adds `factor` times the product with the matrix, or with its transposed, to y.
fn add(matrix: &Sparse, factor: c64, transposed: bool, x: &[c64], y: &mut [c64]) {
    if transposed {
        matrix.multiply_transposed(factor, x, y);
    } else {
        matrix.multiply(factor, x, y);
    }
}
