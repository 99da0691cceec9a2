//! The critical step of one contact state with discrete dampers, C̃ ≠ α M̃ + β K̃.
//!
//! A mode z, u of the scheme solves ((z − 1)² M̃ + h (z − 1) C̃ + h² z K̃) u = 0. With z = 1 + h s that is
//! (s² M̃ + s (C̃ + h K̃) + K̃) u = 0: the physics with its damping C̃ raised to C̃ + h K̃, stepped by
//! explicit Euler.
//!
//! Where M̃, C̃, K̃ are symmetric and not negative (no contact slides with friction), every mode solves
//! a scalar equation with real c = uᴴ C u, k = uᴴ K u, which lies in the unit circle while
//! h² k + 2 h c ≤ 4 (Jury): the limit is where 4 M̃ − 2 h C̃ − h² K̃ becomes singular and a mode leaves
//! through −1. This is 1/η for the largest real η of the quadratic problem 4 η² M̃ − 2 η C̃ − K̃.
//!
//! Where friction makes them unsymmetric, modes may grow because the physics does. Then every z is
//! compared with the eigenvalue λ of the physics that is nearest to ln z / h, as for Rayleigh damping.

use super::complex::{logarithm, modulus};
use super::critical_step::INVENTED_GROWTH;
use super::eigenvalues::{self, Solver, by_schur};
use super::step_search;
use crate::Error;
use crate::model::ReducedMatrices;
use nalgebra::{Complex, DMatrix};

/// Returns the largest step (s) of a state, and `true` if the mode that sets it does not leave through −1.
pub(super) fn limit(reduced: &ReducedMatrices) -> Result<(f64, bool), Error> {
    let Limits { through_minus_one, friction } = Limits::of(reduced, by_schur)?;
    let step = friction.map_or(through_minus_one, |friction| {
        step_search::largest(friction.end, |step| friction.admits(step))
    });
    Ok((step, step < through_minus_one))
}

/// `true` if a step (s) is at most the largest one of a state, but for rounding.
pub(super) fn reaches(step: f64, reduced: &ReducedMatrices) -> Result<bool, Error> {
    let Limits { through_minus_one, friction } = Limits::of(reduced, eigenvalues::eigenvalues)?;
    Ok(friction.map_or(step <= through_minus_one, |friction| {
        step_search::reaches(step, friction.end, |step| friction.admits(step))
    }))
}

/// `true` if a state admits a step (s); smaller ones are not examined.
pub(super) fn admits(step: f64, reduced: &ReducedMatrices) -> Result<bool, Error> {
    let Limits { through_minus_one, friction } = Limits::of(reduced, eigenvalues::eigenvalues)?;
    let is_below = step <= friction.as_ref().map_or(through_minus_one, |friction| friction.end);
    Ok(is_below && friction.is_none_or(|friction| friction.admits(step)))
}

/// The first step (s) that a state admits of the limit of real modes and steps that are each four fifths of the one before.
pub(super) fn coarse_limit(reduced: &ReducedMatrices) -> Result<f64, Error> {
    const TRIED: usize = 60;
    let Limits { through_minus_one, friction } = Limits::of(reduced, eigenvalues::eigenvalues)?;
    let Some(friction) = friction else { return Ok(through_minus_one) };
    let mut tried = std::iter::successors(Some(friction.end), |step| Some(0.8 * step)).take(TRIED);
    tried
        .find(|step| friction.admits(*step))
        .ok_or_else(|| Error::step_too_large("no step was found that a contact state admits"))
}

/// The limits of the step in one contact state.
struct Limits {
    /// The step at which a mode leaves the unit circle through −1, s.
    through_minus_one: f64,
    /// Limits of modes that may grow; `None` where friction leaves the matrices symmetric.
    friction: Option<WithFriction>,
}

/// A contact state with friction, in which modes may grow.
struct WithFriction {
    /// The matrix M̃⁻¹ K̃, 1/s².
    stiffness: DMatrix<f64>,
    /// The matrix M̃⁻¹ C̃, 1/s.
    damping: DMatrix<f64>,
    /// Eigenvalues λ of the physics, 1/s.
    physical: Vec<Complex<f64>>,
    /// Upper bound of the admissible steps, s.
    end: f64,
    solver: Solver,
}

impl Limits {
    fn of(reduced: &ReducedMatrices, solver: Solver) -> Result<Self, Error> {
        let failed = || Error::step_too_large("the eigenvalues of a contact state were not found");
        if reduced.mass.nrows() == 0 {
            return Ok(Self { through_minus_one: f64::INFINITY, friction: None });
        }
        let inverse = reduced.mass.clone().try_inverse().ok_or_else(failed)?;
        let (k, c) = (&inverse * &reduced.stiffness, &inverse * &reduced.damping);
        let rates = eigenvalues(companion(&k, 0.25, &c, 0.5), solver).ok_or_else(failed)?;
        let real = |rate: &Complex<f64>| rate.im.abs() <= 1e-7 * modulus(*rate);
        let reals = rates.iter().filter(|rate| real(rate));
        let through_minus_one = 1.0 / reals.fold(0.0, |most, rate| f64::max(most, rate.re));
        if is_symmetric(&reduced.stiffness) && is_symmetric(&reduced.damping) {
            return Ok(Self { through_minus_one, friction: None });
        }
        let physical = eigenvalues(companion(&k, -1.0, &c, -1.0), solver).ok_or_else(failed)?;
        let size = physical.iter().fold(0.0, |size, lambda| f64::max(size, modulus(*lambda)));
        let end = through_minus_one.min(2.0 / size);
        let friction = Some(WithFriction { stiffness: k, damping: c, physical, end, solver });
        Ok(Self { through_minus_one, friction })
    }
}

impl WithFriction {
    /// `true` if no mode of the scheme grows faster than the physics at this step (s).
    fn admits(&self, step: f64) -> bool {
        // z = 1 + h s.
        let raised = &self.damping + &self.stiffness * step;
        eigenvalues(companion(&self.stiffness, -1.0, &raised, -1.0), self.solver).is_some_and(
            |rates| rates.iter().all(|s| is_admissible(s * step + 1.0, step, &self.physical)),
        )
    }
}

/// `true` if the scheme's mode z grows no faster than the physics.
fn is_admissible(z: Complex<f64>, h: f64, physical: &[Complex<f64>]) -> bool {
    // Inside the circle nothing grows; divergence is the physics' own.
    if modulus(z) <= 1.0 || (z.re > 0.0 && z.im.abs() <= 1e-9 * modulus(z)) {
        return true;
    }
    let rate = logarithm(z) / h;
    let distance = |lambda: &Complex<f64>| modulus(lambda - rate);
    let nearest = physical.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.is_some_and(|lambda| rate.re <= lambda.re.max(0.0) + INVENTED_GROWTH * modulus(*lambda))
}

/// The matrix [[0, 1], [p a, q b]], whose eigenvalues λ solve λ² u = (p a + λ q b) u.
fn companion(a: &DMatrix<f64>, p: f64, b: &DMatrix<f64>, q: f64) -> DMatrix<f64> {
    let n = a.nrows();
    DMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(i + n == j)),
        (false, true) => p * a[(i - n, j)],
        (false, false) => q * b[(i - n, j - n)],
    })
}

fn eigenvalues(mut companion: DMatrix<f64>, solver: Solver) -> Option<Vec<Complex<f64>>> {
    // In its own unit of time, so that both rows are of one size.
    let n = companion.nrows() / 2;
    let unit =
        companion.view((n, 0), (n, n)).amax().sqrt().max(companion.view((n, n), (n, n)).amax());
    if unit == 0.0 {
        return Some(vec![Complex::new(0.0, 0.0); 2 * n]);
    }
    companion.view_mut((n, 0), (n, n)).scale_mut(1.0 / (unit * unit));
    companion.view_mut((n, n), (n, n)).scale_mut(1.0 / unit);
    let mut found = solver(companion)?;
    found.iter_mut().for_each(|value| *value *= unit);
    Some(found)
}

fn is_symmetric(matrix: &DMatrix<f64>) -> bool {
    (matrix - matrix.transpose()).amax() <= 1e-12 * matrix.amax()
}
