//! Eigenvalues nearest to a shift by the Arnoldi method.

use super::dense::{dot, subtract_product};
use super::shifted::{Shifted, norm};
use crate::random;
use amontons::Error;
use amontons_analysis::watch::Watch;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, c64};

/// The largest residual of a converged Ritz pair, relative to its Ritz value.
const TOLERANCE: f64 = 1e-13;
/// The largest rounding of the operator, relative to a Ritz value that is used.
const ROUNDED: f64 = 1e-11;
/// A new direction that is smaller than this, relative to the vector before its orthogonalisation, is rounding.
const ROUNDING: f64 = 1e-14;
/// Ritz values that differ by less than this part of themselves are one eigenvalue of several vectors.
const EQUAL: f64 = 1e-10;
/// The smallest part outside the span of the others that a given vector must have to be taken in.
const DEPENDENT: f64 = 1e-6;

/// An eigenvalue with its vector.
pub(super) struct Pair {
    pub(super) eigenvalue: c64,
    /// Of 2-norm 1: P(λ) x = 0, or P(λ)ᵀ x = 0.
    pub(super) vector: Vec<c64>,
}

/// All eigenvalues in a disc about the shift, as far as the method can see.
pub(super) struct Nearest {
    /// By distance from the shift; those beyond the radius are some of those that there are.
    pub(super) pairs: Vec<Pair>,
    /// Up to this distance from the shift all Ritz values have converged; 0 if none has.
    pub(super) radius: f64,
    /// Ritz values that have not converged: rough places of eigenvalues farther away.
    pub(super) rough: Vec<c64>,
    /// The number of solutions with the factors.
    pub(super) solves: usize,
}

/// The wish of a caller.
pub(super) struct Wish<'a> {
    /// `true` for the vectors of Pᵀ.
    pub(super) transposed: bool,
    /// The radius that suffices.
    pub(super) radius: f64,
    /// The largest dimension of the Krylov space.
    pub(super) dimension: usize,
    /// The choice of the start vector.
    pub(super) seed: u64,
    /// Known pairs; the search begins orthogonal to them, so it finds others, and the result has both.
    pub(super) known: &'a [Pair],
}

/// An orthonormal basis V and the projected operator H = Vᴴ S V.
struct Space {
    rows: usize,
    /// By column.
    basis: Vec<c64>,
    projected: Mat<c64>,
}

/// Finds the eigenvalues nearest to the shift.
///
/// # Errors
/// Returns an error if the work has been ended, or if the small eigenvalue problem cannot be solved.
pub(super) fn nearest(shifted: &Shifted, wish: &Wish, watch: Watch) -> Result<Nearest, Error> {
    let rows = 2 * shifted.problem.size();
    let most = (wish.dimension.max(2) + wish.known.len()).min(rows);
    let mut space = Space { rows, basis: vec![], projected: Mat::zeros(most + 1, most) };
    for pair in wish.known {
        let mut z = shifted.extended(pair.eigenvalue, &pair.vector);
        let before = norm(&z);
        space.orthogonalise(&mut z);
        if norm(&z) > DEPENDENT * before && space.columns() < most {
            space.push(z);
        }
    }
    let known = space.columns();
    let mut solves = 0;
    for column in 0..known {
        let mut z = space.column(column).to_vec();
        shifted.apply(wish.transposed, &mut z);
        solves += 1;
        for (row, value) in space.orthogonalise(&mut z).into_iter().enumerate() {
            space.projected[(row, column)] = value;
        }
    }
    let mut seed = wish.seed;
    // True if all finite eigenvalues are those of the space.
    let mut closed = known == most;
    if !closed {
        solves += 1;
        match fresh(shifted, wish.transposed, &space, &mut seed) {
            Some(start) => space.push(start),
            None => closed = true,
        }
    }
    let mut check = known + 20;
    loop {
        let columns = space.columns();
        let mut couple = 0.0;
        if !closed {
            watch.check()?;
            let mut z = space.column(columns - 1).to_vec();
            shifted.apply(wish.transposed, &mut z);
            solves += 1;
            let before = norm(&z);
            for (row, value) in space.orthogonalise(&mut z).into_iter().enumerate() {
                space.projected[(row, columns - 1)] = value;
            }
            couple = norm(&z);
            if couple <= ROUNDING * before {
                couple = 0.0;
            }
            if columns < most {
                space.projected[(columns, columns - 1)] = c64::new(couple, 0.0);
                if couple == 0.0 {
                    solves += 1;
                    match fresh(shifted, wish.transposed, &space, &mut seed) {
                        Some(start) => space.push(start),
                        None => closed = true,
                    }
                } else {
                    space.push(z);
                }
            }
        }
        let last = columns == most || closed;
        if last || (wish.radius.is_finite() && columns >= check && couple > 0.0) {
            check = columns + 10.max((columns - known) / 4);
            let whole = columns == rows || closed && columns < most;
            // The whole space is left by nothing.
            let couple = if whole { 0.0 } else { couple };
            let Ritz { mut converged, radius, rough } =
                ritz(&space, shifted.shift, columns, couple)?;
            let radius = if whole && rough.is_empty() { f64::INFINITY } else { radius };
            if last || radius >= wish.radius {
                space.separate(shifted.shift, columns, couple, &mut converged);
                let pairs = space.pairs(shifted.problem.size(), columns, &converged);
                return Ok(Nearest { pairs, radius, rough, solves });
            }
        }
    }
}

/// A direction orthogonal to the space, in the range of the operator, so without parts of infinite eigenvalues. None if the
/// space has the whole range.
fn fresh(shifted: &Shifted, transposed: bool, space: &Space, seed: &mut u64) -> Option<Vec<c64>> {
    let mut z = random::vector(*seed, space.rows);
    *seed += 1;
    shifted.apply(transposed, &mut z);
    let before = norm(&z);
    space.orthogonalise(&mut z);
    (norm(&z) > ROUNDING * before).then_some(z)
}

/// Ritz values by distance from the shift.
struct Ritz {
    /// Those that have converged, each with its vector in the basis.
    converged: Vec<(c64, Vec<c64>)>,
    /// The distance of the last of them before the first that has not converged.
    radius: f64,
    /// The others.
    rough: Vec<c64>,
}

/// The Ritz values of a space. `couple` is the norm of the part of the operator that leaves the space.
fn ritz(space: &Space, shift: c64, columns: usize, couple: f64) -> Result<Ritz, Error> {
    let eigen =
        space.projected.get(..columns, ..columns).eigen().map_err(|_| {
            Error::analysis("the eigenvalues of the projected problem do not converge")
        })?;
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let mut order: Vec<usize> = (0..columns).collect();
    order.sort_by(|&a, &b| values[b].norm().total_cmp(&values[a].norm()));
    let largest = order.first().map_or(0.0, |&index| values[index].norm());
    // The rounding of solutions is relative to the largest value, so near to an eigenvalue a shift shows no others.
    let rounding = f64::EPSILON * largest;
    // Those of infinite eigenvalues are left out.
    order.retain(|&index| values[index].norm() > rounding);
    let mut result = Ritz { converged: vec![], radius: 0.0, rough: vec![] };
    for index in order {
        let (value, vector) = (values[index], vectors.col(index));
        let norm = (0..columns).map(|row| vector[row].norm_sqr()).sum::<f64>().sqrt();
        let residual = couple * vector[columns - 1].norm() / norm;
        let distance = value.inv();
        let converged = residual <= TOLERANCE * value.norm() && rounding <= ROUNDED * value.norm();
        if converged {
            if result.rough.is_empty() {
                result.radius = distance.norm();
            }
            let vector = (0..columns).map(|row| vector[row] / norm).collect();
            result.converged.push((shift + distance, vector));
        } else {
            result.rough.push(shift + distance);
        }
    }
    Ok(result)
}

impl Space {
    fn columns(&self) -> usize {
        self.basis.len() / self.rows
    }

    fn column(&self, column: usize) -> &[c64] {
        &self.basis[column * self.rows..][..self.rows]
    }

    fn matrix(&self) -> MatRef<'_, c64> {
        MatRef::from_column_major_slice(&self.basis, self.rows, self.columns())
    }

    /// Appends a direction that is orthogonal to the others; its length is taken off.
    fn push(&mut self, mut z: Vec<c64>) {
        // Once more, since a short vector has lost digits.
        let length = norm(&z);
        z.iter_mut().for_each(|z| *z /= length);
        self.orthogonalise(&mut z);
        let length = norm(&z);
        self.basis.extend(z.into_iter().map(|z| z / length));
    }

    /// Takes the parts along the basis off a vector, twice, and returns them.
    fn orthogonalise(&self, z: &mut [c64]) -> Vec<c64> {
        let mut parts = vec![c64::default(); self.columns()];
        for _ in 0..2 {
            let part: Vec<c64> =
                self.basis.chunks_exact(self.rows).map(|column| dot::<true>(column, z)).collect();
            subtract_product(self.matrix(), &part, z);
            parts.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        parts
    }

    /// Replaces the vectors of equal Ritz values, which rounding leaves in any and even almost parallel directions, by
    /// orthonormal ones: the smallest singular vectors of H − θ, where their residual is small. Those of defective values stay,
    /// since there are not as many.
    fn separate(&self, shift: c64, columns: usize, couple: f64, ritz: &mut [(c64, Vec<c64>)]) {
        let mut done = vec![false; ritz.len()];
        for first in 0..ritz.len() {
            let place = ritz[first].0;
            let same: Vec<usize> = (first..ritz.len())
                .filter(|&other| {
                    let away = (ritz[other].0 - place).norm();
                    !done[other] && away <= EQUAL * (place - shift).norm()
                })
                .collect();
            same.iter().for_each(|&other| done[other] = true);
            if same.len() < 2 {
                continue;
            }
            let value = (place - shift).inv();
            let mut matrix = self.projected.get(..columns, ..columns).to_owned();
            (0..columns).for_each(|index| matrix[(index, index)] -= value);
            let Ok(parts) = matrix.svd() else { continue };
            let smallest = columns - same.len();
            if parts.S().column_vector()[smallest].norm() > EQUAL * value.norm() {
                continue;
            }
            for (offset, &other) in same.iter().enumerate() {
                let vector = parts.V().col(smallest + offset);
                let inside = parts.S().column_vector()[smallest + offset].norm();
                let residual = inside.hypot(couple * vector[columns - 1].norm());
                let small = residual <= ROUNDED * value.norm();
                // Eigenvalues that differ have vectors of their own, which are better than those of one value.
                if small {
                    ritz[other].1 = vector.iter().copied().collect();
                }
            }
        }
    }

    /// The pairs of Ritz values: of the two halves of z, which are parallel, the longer one.
    fn pairs(&self, size: usize, columns: usize, ritz: &[(c64, Vec<c64>)]) -> Vec<Pair> {
        let small = Mat::from_fn(columns, ritz.len(), |row, column| ritz[column].1[row]);
        let mut vectors = Mat::zeros(self.rows, ritz.len());
        let basis = self.matrix().get(.., ..columns);
        matmul(&mut vectors, Accum::Replace, basis, &small, c64::new(1.0, 0.0), Par::Seq);
        let pair = |(column, (eigenvalue, _)): (usize, &(c64, Vec<c64>))| {
            let z: Vec<c64> = vectors.col(column).iter().copied().collect();
            let (x, v) = z.split_at(size);
            let half = if norm(x) >= norm(v) { x } else { v };
            let length = norm(half);
            let vector = half.iter().map(|x| x / length).collect();
            Pair { eigenvalue: *eigenvalue, vector }
        };
        ritz.iter().enumerate().map(pair).collect()
    }
}
