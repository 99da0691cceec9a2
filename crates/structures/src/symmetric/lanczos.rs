//! The lowest eigenvalues of a large symmetric problem, by a block Lanczos iteration with full orthogonalisation.

use super::bounds::frequency;
use super::factor::Factors;
use crate::random;
use crate::sparse::Sparse;
use amontons::Error;
use amontons_analysis::watch::Watch;
use faer::{Mat, MatRef, Side};

/// Vectors that are multiplied at once. As many copies of a multiple eigenvalue are found together; more take longer.
const BLOCK: usize = 8;
/// A vector has converged if its residual is below this part of its value.
const CONVERGED: f64 = 1e-12;
/// A vector with less than this part left after it was made orthogonal is lost to rounding.
const LOST: f64 = 1e-10;

/// The eigenvalues that are looked for.
pub struct Wanted {
    /// The number of eigenvalues.
    pub count: usize,
    /// They are below this one, 1/s², and no others are.
    pub below: f64,
    /// The most vectors that may be kept.
    pub room: usize,
}

/// Eigenvalues in ascending order, and their vectors as columns, XᵀMX = I.
pub struct Modes {
    pub values: Vec<f64>,
    pub vectors: Mat<f64>,
}

/// The lowest eigenvalues λ of K x = λ M x, by factors of K − `shift` M, with `shift` below all of them.
///
/// The iteration goes on until as many vectors have converged as are wanted; how many there are must be known, so that a copy
/// of a multiple eigenvalue is not missed. It never has more values below the limit than there are (Cauchy), so if it has more
/// than are wanted, the count was wrong.
///
/// # Errors
/// Returns an error if the work has been ended, if the count is wrong, or if the vectors do not find room.
pub fn lowest(
    stiffness: &Sparse,
    mass: &Sparse,
    factors: &Factors<'_>,
    shift: f64,
    &Wanted { count, below, room }: &Wanted,
    watch: Watch<'_>,
) -> Result<Modes, Error> {
    let order = mass.rows();
    if count == 0 {
        return Ok(Modes { values: Vec::new(), vectors: Mat::zeros(order, 0) });
    }
    let mut basis = Basis::new(order);
    let mut block = basis.append(mass, random::block(0, order, BLOCK.min(order))).0;
    // T = VᵀM(K − shift M)⁻¹MV, by its columns.
    let mut projected: Vec<Mat<f64>> = Vec::new();
    let mut next_look = count;
    loop {
        watch.check()?;
        let size = basis.size;
        if size > room {
            return Err(Error::analysis(format!(
                "{count} modes below {:.6} Hz need more memory than is allowed; allow more with --memory, or ask for a lower frequency",
                frequency(below)
            )));
        }
        let mut next = mass.times(basis.columns(size - block, block));
        factors.solve(next.as_mut());
        let (appended, coefficients) = basis.append(mass, next);
        projected.push(coefficients);
        if size >= next_look || appended == 0 {
            // Each look costs the cube of the size.
            next_look = size + (size / 10).max(BLOCK);
            let (values, vectors) = eigen(&projected, size)?;
            // θ = 1 / (λ − shift); ascending, so that the wanted ones are last.
            let last = projected.last().expect("one was pushed");
            let beyond = last.submatrix(size, 0, last.nrows() - size, last.ncols());
            let residual = beyond * vectors.submatrix(size - block, 0, block, size);
            let is_wanted = |at: &usize| values[*at] > 0.0 && shift + 1.0 / values[*at] < below;
            let inside: Vec<usize> = (0..size).rev().filter(is_wanted).collect();
            let is_found = |at: &usize| {
                residual.nrows() == 0 || residual.col(*at).norm_l2() < CONVERGED * values[*at]
            };
            let found: Vec<usize> = inside.iter().copied().filter(is_found).collect();
            #[allow(clippy::cast_precision_loss)]
            (watch.progress)(found.len() as f64 / count as f64);
            if inside.len() > count {
                return Err(Error::analysis(format!(
                    "there are {} modes below {:.6} Hz, but {count} were counted; ask for another frequency",
                    inside.len(),
                    frequency(below)
                )));
            }
            if found.len() == count {
                let chosen = Mat::from_fn(size, count, |row, at| vectors[(row, found[at])]);
                return polish(stiffness, mass, factors, &(basis.columns(0, size) * chosen));
            }
        }
        block = appended;
        if block == 0 {
            // The space is closed under multiplication: other modes have no part in it.
            block = basis.append(mass, random::block(size as u64, order, BLOCK.min(order))).0;
            if block == 0 {
                return Err(Error::analysis(format!(
                    "fewer than {count} modes are below {:.6} Hz, but so many were counted; ask for another frequency",
                    frequency(below)
                )));
            }
        }
    }
}

/// Multiplies once more, which takes away the parts of high modes, and rotates the vectors to those of the smallest
/// residual in their space (Rayleigh and Ritz).
fn polish(
    stiffness: &Sparse,
    mass: &Sparse,
    factors: &Factors<'_>,
    vectors: &Mat<f64>,
) -> Result<Modes, Error> {
    let mut vectors = mass.times(vectors.as_ref());
    factors.solve(vectors.as_mut());
    for vector in 0..vectors.ncols() {
        let scale = 1.0 / vectors.col(vector).norm_max();
        vectors.col_mut(vector).iter_mut().for_each(|value| *value *= scale);
    }
    let elastic = vectors.transpose() * stiffness.times(vectors.as_ref());
    let inertia = vectors.transpose() * mass.times(vectors.as_ref());
    let (values, rotation) = dense(&elastic, &inertia)?;
    Ok(Modes { values, vectors: vectors * rotation })
}

/// Eigenvalues in ascending order of a small problem K x = λ M x, and its vectors, XᵀMX = I.
///
/// # Errors
/// Returns an error if M is not positive definite.
pub fn dense(stiffness: &Mat<f64>, mass: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), Error> {
    let symmetric =
        |a: &Mat<f64>| Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * (a[(i, j)] + a[(j, i)]));
    let factor = symmetric(mass)
        .llt(Side::Lower)
        .map_err(|_| Error::analysis("the mass matrix is not positive definite"))?;
    let lower = factor.L();
    // L⁻¹ K L⁻ᵀ.
    let mut standard = symmetric(stiffness);
    lower.solve_lower_triangular_in_place(standard.as_mut());
    let mut standard = standard.transpose().to_owned();
    lower.solve_lower_triangular_in_place(standard.as_mut());
    let eigen = symmetric(&standard)
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| Error::analysis("the eigenvalues of a reduced matrix do not converge"))?;
    let mut vectors = eigen.U().to_owned();
    lower.transpose().solve_upper_triangular_in_place(vectors.as_mut());
    Ok((eigen.S().column_vector().iter().copied().collect(), vectors))
}

/// Eigenvalues in ascending order of the symmetric matrix whose first `size` rows the columns hold, and its vectors.
fn eigen(columns: &[Mat<f64>], size: usize) -> Result<(Vec<f64>, Mat<f64>), Error> {
    let mut matrix = Mat::zeros(size, size);
    let mut at = 0;
    for block in columns {
        for column in 0..block.ncols() {
            for row in 0..size.min(block.nrows()) {
                matrix[(row, at + column)] = block[(row, column)];
            }
        }
        at += block.ncols();
    }
    let symmetric = Mat::from_fn(size, size, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]));
    let eigen = symmetric
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| Error::analysis("the eigenvalues of a projected matrix do not converge"))?;
    Ok((eigen.S().column_vector().iter().copied().collect(), eigen.U().to_owned()))
}

/// Vectors that are orthonormal in the inner product of M.
struct Basis {
    vectors: Mat<f64>,
    size: usize,
}

impl Basis {
    fn new(order: usize) -> Self {
        Self { vectors: Mat::zeros(order, 0), size: 0 }
    }

    fn columns(&self, first: usize, count: usize) -> MatRef<'_, f64> {
        self.vectors.get(.., first..first + count)
    }

    /// Appends what a block has outside of the space. Returns the number of vectors that this is, and the block's
    /// coefficients in all vectors, old and new.
    fn append(&mut self, mass: &Sparse, mut block: Mat<f64>) -> (usize, Mat<f64>) {
        let (order, old, width) = (block.nrows(), self.size, block.ncols());
        let before: Vec<f64> = norms(mass, &block);
        let mut coefficients = Mat::zeros(old + width, width);
        for _ in 0..2 {
            let part = self.columns(0, old).transpose() * mass.times(block.as_ref());
            block -= self.columns(0, old) * &part;
            for column in 0..width {
                for row in 0..old {
                    coefficients[(row, column)] += part[(row, column)];
                }
            }
        }
        // Within the block, vector by vector.
        self.vectors.resize_with(order, old + width, |_, _| 0.0);
        let mut new = 0;
        for column in 0..width {
            let mut vector = block.get(.., column..column + 1).to_owned();
            for _ in 0..2 {
                let part = self.columns(old, new).transpose() * mass.times(vector.as_ref());
                vector -= self.columns(old, new) * &part;
                for row in 0..new {
                    coefficients[(old + row, column)] += part[(row, 0)];
                }
            }
            let norm = norms(mass, &vector)[0];
            if norm > LOST * before[column] {
                coefficients[(old + new, column)] = norm;
                for row in 0..order {
                    self.vectors[(row, old + new)] = vector[(row, 0)] / norm;
                }
                new += 1;
            }
        }
        self.size = old + new;
        self.vectors.resize_with(order, self.size, |_, _| 0.0);
        (new, coefficients.get(..old + new, ..).to_owned())
    }
}

/// The norm of each column in the inner product of M.
fn norms(mass: &Sparse, block: &Mat<f64>) -> Vec<f64> {
    let product = mass.times(block.as_ref());
    (0..block.ncols())
        .map(|column| (block.col(column).transpose() * product.col(column)).max(0.0).sqrt())
        .collect()
}
