//! P(λ) seen from a shift: the linear problem whose eigenvalues nearest to the shift are the largest.

use super::Quadratic;
use super::analysis::Analysis;
use super::factors::Factors;
use amontons::Error;
use faer::c64;

/// The largest backward error of a solution with factors that are used.
const BACKWARD: f64 = 1e-10;

/// The operator z ↦ (A − σ B)⁻¹ B z on z = (x, λ x / s), whose eigenvalues are 1 / (λ − σ).
///
/// A and B are of the companion form x λ = (λ x), M λ (λ x) = − K x − C (λ x); the scale s keeps both halves of z alike.
pub(super) struct Shifted<'a> {
    pub(super) problem: &'a Quadratic,
    pub(super) factors: Factors<'a>,
    pub(super) shift: c64,
    scale: f64,
}

impl<'a> Shifted<'a> {
    /// Factorises P at a shift.
    ///
    /// # Errors
    /// Returns an error if P(σ) is singular, or so near to it that the factors do not solve.
    pub(super) fn new(
        problem: &'a Quadratic,
        analysis: &'a Analysis,
        shift: c64,
        scale: f64,
    ) -> Result<Self, Error> {
        let factors = factorise(problem, analysis, shift)?;
        Ok(Self { problem, factors, shift, scale })
    }

    /// The vector z of an eigenvector.
    pub(super) fn extended(&self, lambda: c64, x: &[c64]) -> Vec<c64> {
        x.iter().copied().chain(x.iter().map(|x| x * lambda / self.scale)).collect()
    }

    /// Replaces z by the operator's value, of P or of Pᵀ.
    pub(super) fn apply(&self, transposed: bool, z: &mut [c64]) {
        let (x, v) = z.split_at_mut(self.problem.size());
        // Of the equation in the second half with λ x eliminated: P(σ) x⁺ = − M λx − (C + σ M) x.
        let inner: Vec<c64> =
            v.iter().zip(&*x).map(|(v, x)| v * self.scale + x * self.shift).collect();
        let mut next = self.problem.inertia(transposed, &inner, x);
        self.factors.solve(transposed, &mut next);
        for ((v, x), next) in v.iter_mut().zip(x).zip(next) {
            *v = (*x + self.shift * next) / self.scale;
            *x = next;
        }
    }
}

/// Factorises P(λ) and checks that the factors solve.
///
/// # Errors
/// Returns an error if they do not.
pub(super) fn factorise<'a>(
    problem: &Quadratic,
    analysis: &'a Analysis,
    lambda: c64,
) -> Result<Factors<'a>, Error> {
    let factors = Factors::new(analysis, lambda)?;
    let start = crate::random::vector(1, problem.size());
    let mut x = start.clone();
    factors.solve(false, &mut x);
    let residual = norm(&difference(problem.apply(lambda, false, &x), &start));
    let backward = residual / (problem.norm(lambda) * norm(&x) + norm(&start));
    // Also false if it is not a number.
    if backward <= BACKWARD {
        Ok(factors)
    } else {
        Err(Error::analysis(format!(
            "P({lambda}) cannot be factorised well: the backward error of a solution is {backward:.1e}, the most is {BACKWARD:.0e}"
        )))
    }
}

/// x − y.
fn difference(mut x: Vec<c64>, y: &[c64]) -> Vec<c64> {
    for (x, y) in x.iter_mut().zip(y) {
        *x -= y;
    }
    x
}

/// The 2-norm.
pub(super) fn norm(x: &[c64]) -> f64 {
    x.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt()
}
