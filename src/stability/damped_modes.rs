//! The quadratic eigenvalue problem (λ² M̃ + λ C̃ + K̃) u = 0 at its full size (paper, eq. 6), for any C̃.

use super::complex::modulus;
use super::eigenvalues::eigenvalues;
use super::reduced_problem::{per_mass, rounding};
use super::singular_values::SingularValues;
use crate::Error;
use crate::model::ReducedMatrices;
use nalgebra::{Complex, DMatrix};

/// All eigenvalues λ, 1/s.
pub(super) fn all_eigenvalues(reduced: &ReducedMatrices) -> Result<Vec<Complex<f64>>, Error> {
    let problem = QuadraticProblem::of(reduced)?;
    let mut values = eigenvalues(problem.companion())
        .ok_or_else(|| Error::analysis("the eigenvalues of the contact state were not found"))?;
    problem.refine(&mut values);
    Ok(values.into_iter().map(|value| value * problem.unit).collect())
}

/// Eigenvalues below this part of the largest have lost digits to rounding.
const SMALL: f64 = 1e-4;
/// Rounding splits a double zero into two values of up to this size, the square root of the rounding.
const SPLIT: f64 = 1e-7;
/// A Newton step that is longer than this part of the distance to the next eigenvalue may lead to that one.
const NEAR: f64 = 0.3;
/// Values that differ by less than this part of themselves, or by rounding, are those of equal parts of a structure.
const TWINS: f64 = 1e-6;
const ROUNDING: f64 = 1e-14;
/// Largest number of refined eigenvalues, the smallest ones; each refinement takes several times as long as a
/// factorisation.
const MOST_REFINED: usize = 16;
/// A real part below this part of the largest eigenvalue is the rounding of zero in a mode that oscillates without
/// damping: it neither grows nor decays.
const NO_GROWTH: f64 = 1e-13;

/// The quadratic problem λ² + λ C + K, both multiplied by M̃⁻¹, in a unit of time that gives them the same magnitude.
pub struct QuadraticProblem {
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// Unit of the eigenvalues, 1/s: they are those of the companion matrix times this.
    pub unit: f64,
}

impl QuadraticProblem {
    /// The problem of a contact state.
    ///
    /// # Errors
    /// Returns an error if the mass matrix cannot be inverted, or if an entry leaves the range of numbers.
    pub fn of(reduced: &ReducedMatrices) -> Result<Self, Error> {
        let ReducedMatrices { mass, damping, stiffness, .. } = reduced;
        let (stiffness, damping) = (per_mass(mass, stiffness)?, per_mass(mass, damping)?);
        let unit = stiffness.amax().sqrt().max(damping.amax()).max(f64::MIN_POSITIVE);
        Ok(Self { damping: damping / unit, stiffness: stiffness / unit / unit, unit })
    }

    /// Companion matrix [[0, 1], [−K, −C]].
    #[must_use]
    pub fn companion(&self) -> DMatrix<f64> {
        let size = self.stiffness.nrows();
        let entry = |row: usize, column: usize| match (row < size, column < size) {
            (true, _) => f64::from(u8::from(column == row + size)),
            (false, true) => -self.stiffness[(row - size, column)],
            (false, false) => -self.damping[(row - size, column - size)],
        };
        DMatrix::from_fn(2 * size, 2 * size, entry)
    }

    /// Restores the digits of small eigenvalues of the companion matrix that large ones have taken from them, and sets
    /// to zero those that are rounding of zero.
    pub fn refine(&self, values: &mut [Complex<f64>]) {
        let by_size =
            |one: &usize, other: &usize| modulus(values[*one]).total_cmp(&modulus(values[*other]));
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(by_size);
        let count = order.iter().take_while(|&&at| modulus(values[at]) <= SPLIT).count();
        let zeros = if count > 0 { self.zeros().min(count) } else { 0 };
        for &at in &order[..zeros] {
            values[at] = Complex::ZERO;
        }
        let found = values.to_vec();
        let (mut refined, mut pairs) = (0, Vec::new());
        for &at in &order[zeros..] {
            let value = found[at];
            // The lower one of a pair is the conjugate of the other.
            let is_other = |other: &Complex<f64>| value.im < 0.0 && *other == value.conj();
            if let Some(other) = found.iter().position(is_other) {
                pairs.push([at, other]);
                continue;
            }
            let is_small = modulus(value) <= SMALL && refined < MOST_REFINED;
            refined += usize::from(is_small);
            let again = if is_small { self.again(value, &found, at) } else { None };
            // A value of the size of rounding that is not found again counts as zero.
            let is_lost = again.is_none() && modulus(value) <= SPLIT;
            let better = if is_lost { Complex::ZERO } else { again.unwrap_or(value) };
            let is_real = better.im == 0.0 && again.is_some();
            let nothing = if is_real { 0.0 } else { NO_GROWTH };
            let grows = better.re.abs() > nothing;
            values[at] = if grows { better } else { Complex::new(0.0, better.im) };
        }
        for [below, other] in pairs {
            values[below] = values[other].conj();
        }
    }

    /// The refined value at a place among those that were found; `None` where the refinement fails.
    fn again(
        &self,
        value: Complex<f64>,
        found: &[Complex<f64>],
        at: usize,
    ) -> Option<Complex<f64>> {
        let others = (0..found.len()).filter(|other| *other != at);
        let distances: Vec<f64> = others.map(|other| modulus(found[other] - value)).collect();
        let is_twin = |distance: &&f64| **distance <= (TWINS * modulus(value)).max(ROUNDING);
        let count = 1 + distances.iter().filter(is_twin).count();
        let far = distances.iter().filter(|distance| !is_twin(distance));
        self.refined(value, far.copied().fold(f64::INFINITY, f64::min), count)
    }

    /// Number of zero eigenvalues: one for each motion that no spring holds, and another one if no damper does.
    fn zeros(&self) -> usize {
        let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
        let stiffness = complex(&self.stiffness);
        let both = [SingularValues::of(stiffness.adjoint()), SingularValues::of(stiffness)];
        let [Some(left), Some(right)] = both else { return 0 };
        let floor = rounding(&self.stiffness);
        let free = right.values().into_iter().filter(|value| *value <= floor).count();
        let [left, right] = [left.least_vectors(free), right.least_vectors(free)];
        let damped = left.ad_mul(&(complex(&self.damping) * right));
        let floor = rounding(&self.damping);
        let Some(damped) = SingularValues::of(damped) else { return free };
        2 * free - damped.values().into_iter().filter(|value| *value > floor).count()
    }

    /// Refines a root of det(λ² + λ C + K) of multiplicity `count` by Newton's method from a start near it; `gap` is
    /// the distance to the next one. `None` where the iteration leads elsewhere.
    #[allow(clippy::cast_precision_loss)]
    fn refined(&self, start: Complex<f64>, gap: f64, count: usize) -> Option<Complex<f64>> {
        const STEPS: usize = 4;
        let size = self.stiffness.nrows();
        let mut value = start;
        for _ in 0..STEPS {
            let at = |row: usize, column: usize| {
                let diagonal = if row == column { value * value } else { Complex::ZERO };
                diagonal + value * self.damping[(row, column)] + self.stiffness[(row, column)]
            };
            let slope = |row: usize, column: usize| {
                let diagonal = if row == column { value * 2.0 } else { Complex::ZERO };
                diagonal + self.damping[(row, column)]
            };
            let problem = DMatrix::from_fn(size, size, at).lu();
            // If the matrix is singular to the last digit, the value is the root.
            let Some(solved) = problem.solve(&DMatrix::from_fn(size, size, slope)) else { break };
            let step = -solved.trace().inv() * count as f64;
            if !step.is_finite() {
                break;
            }
            value += step;
            if modulus(value - start) > NEAR * gap {
                return None;
            }
            if modulus(step) <= f64::EPSILON * modulus(value) {
                break;
            }
        }
        Some(value)
    }
}
