//! Complex eigenvalue analysis of one contact state (paper, eqs. 3–6).
//!
//! With C̃ = α M̃ + β K̃, which Rayleigh damping gives because friction follows the whole normal
//! force, the quadratic problem (λ² M̃ + λ C̃ + K̃) u = 0 has the eigenvectors of M̃⁻¹ K̃, and each of
//! its eigenvalues σ two eigenvalues of the state: λ² + (α + β σ) λ + σ = 0. So the problem solved is
//! half as large as eq. (6), and two modes coalesce exactly where two σ do, damped or not. With single
//! dampers there are no such σ; `damped_modes` then solves the problem at its full size.

use super::damped_modes;
use super::eigenvalues::eigenvalues;
use super::symmetry::{Part, module_of_wave, turn};
use crate::Error;
use crate::contact::{ContactState, Joined};
use crate::model::{Damping, LumpedModel, ReducedMatrices};
use faer::Mat;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

/// One mode of a contact state.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// λ, 1/s.
    pub eigenvalue: Complex<f64>,
    /// σ with λ² + (α + β σ) λ + σ = 0, 1/s²: the eigenvalue of M̃⁻¹ K̃ that λ belongs to, but where
    /// there are single dampers.
    pub stiffness_eigenvalue: Complex<f64>,
    /// x, one value a degree of freedom; the largest is 1.
    pub shape: Vec<Complex<f64>>,
    /// In a ring of equal modules in equal states, how many waves the shape has around it. All but
    /// none and half as many as modules come twice, as cosine and sine; any mixture is a mode too.
    pub waves: Option<usize>,
    /// ‖λ² M̃ u + λ C̃ u + K̃ u‖ against what its rows would have if their terms did not cancel.
    pub residual: f64,
}

impl Mode {
    /// Re λ, 1/s: positive where the mode grows.
    #[must_use]
    pub fn growth_rate(&self) -> f64 {
        self.eigenvalue.re
    }

    /// Im λ / 2π, Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        self.eigenvalue.im / TAU
    }

    /// −Re λ / |λ|.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        -self.eigenvalue.re / self.eigenvalue.norm()
    }
}

/// All modes of one contact state.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// Modes that oscillate, one of each conjugate pair (Im λ > 0), by frequency.
    pub oscillating: Vec<Mode>,
    /// Modes that do not (Im λ = 0), by growth rate; a positive one is divergence.
    pub real: Vec<Mode>,
}

impl Modes {
    /// Does any mode grow?
    #[must_use]
    pub fn unstable(&self) -> bool {
        self.all().any(|mode| mode.growth_rate() > 0.0)
    }

    fn add(&mut self, modes: Vec<Mode>) {
        for mode in modes {
            match Kind::of(mode.eigenvalue) {
                Kind::Real => self.real.push(mode),
                Kind::Oscillating | Kind::Conjugate => self.oscillating.push(mode),
            }
        }
    }

    fn sort(&mut self) {
        self.oscillating.sort_by(|a, b| a.eigenvalue.im.total_cmp(&b.eigenvalue.im));
        self.real.sort_by(|a, b| a.eigenvalue.re.total_cmp(&b.eigenvalue.re));
    }

    /// Oscillating modes, then real ones.
    pub fn all(&self) -> impl Iterator<Item = &Mode> {
        self.oscillating.iter().chain(&self.real)
    }
}

/// The modes of a contact state, one entry of `states` a contact; none where its contacts contradict
/// each other (two on one mass, one Sl, one R-Sl).
///
/// # Errors
/// The masses of the state cannot be inverted (friction wedges a contact), the eigenvalue iteration
/// does not converge or leaves the range of numbers, or the model is too large for dense matrices.
pub fn modes(
    model: &LumpedModel,
    states: &[ContactState],
    friction_coefficient: f64,
) -> Result<Modes, Error> {
    let mut found = Modes { oscillating: Vec::new(), real: Vec::new() };
    for part in Part::all([model], states) {
        match part {
            Part::Whole => found.add(modes_of(model, states, friction_coefficient)?),
            Part::Wave { k, modules } => {
                let module = module_of_wave(model, k, modules);
                let one = modes_of(&module, &states[..1], friction_coefficient)?;
                found.add(one.iter().map(|mode| around(mode, k, modules, f64::cos)).collect());
                if part.copies() == 2 {
                    found.add(one.iter().map(|mode| around(mode, k, modules, f64::sin)).collect());
                }
            }
        }
    }
    found.sort();
    Ok(found)
}

/// A mode of a module as a standing wave around the ring.
fn around(mode: &Mode, k: usize, modules: usize, wave: fn(f64) -> f64) -> Mode {
    let shape = (0..modules).flat_map(|j| {
        let factor = wave(turn(k * j, modules));
        mode.shape.iter().map(move |x| x * factor)
    });
    Mode { shape: scaled(shape.collect()), waves: Some(k), ..mode.clone() }
}

/// The modes of a contact state, from its whole matrices.
fn modes_of(model: &LumpedModel, states: &[ContactState], mu: f64) -> Result<Vec<Mode>, Error> {
    check_size(model)?;
    let Some(reduced) = model.reduced(states, mu) else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    let mut add = |eigenvalue, stiffness_eigenvalue, vector: &[Complex<f64>]| {
        if !matches!(Kind::of(eigenvalue), Kind::Conjugate) {
            found.push(Mode {
                eigenvalue,
                stiffness_eigenvalue,
                residual: residual(&reduced, eigenvalue, vector),
                shape: shape(&reduced.motions, vector),
                waves: None,
            });
        }
    };
    if model.has_single_damping() {
        let Damping { alpha, beta } = model.damping;
        for (eigenvalue, vector) in damped_modes::solve(&reduced)? {
            let rayleigh = -eigenvalue * (eigenvalue + alpha) / (eigenvalue * beta + 1.0);
            add(eigenvalue, rayleigh, &vector);
        }
        return Ok(found);
    }
    let (operator, scale) = operator(&reduced)?;
    let floor = rounding(&operator);
    for (sigma, mut vector) in eigenpairs(&operator)? {
        let sigma = cleaned(sigma, floor);
        vector.iter_mut().zip(&scale).for_each(|(value, scale)| *value *= scale);
        for eigenvalue in quadratic_roots(model, sigma) {
            add(eigenvalue, sigma, &vector);
        }
    }
    Ok(found)
}

/// An eigenvalue with its vector.
pub(super) type Eigenpair = (Complex<f64>, Vec<Complex<f64>>);

/// The eigenvalues of a matrix with their vectors.
pub(super) fn eigenpairs(matrix: &DMatrix<f64>) -> Result<Vec<Eigenpair>, Error> {
    let size = matrix.nrows();
    let eigen = Mat::from_fn(size, size, |i, j| matrix[(i, j)]).eigen().map_err(|error| {
        Error::analysis(format!("the modes of the contact state were not found: {error:?}"))
    })?;
    let values = eigen.S().column_vector();
    let pairs = values.iter().enumerate().map(|(column, value)| {
        let part = |row| Complex::new(eigen.U()[(row, column)].re, eigen.U()[(row, column)].im);
        (Complex::new(value.re, value.im), (0..size).map(part).collect())
    });
    Ok(pairs.collect())
}

/// The eigenvalues σ of M̃⁻¹ K̃, 1/s², from the whole matrices; those of a state's modes where there
/// are no single dampers.
pub(super) fn stiffness_eigenvalues(
    model: &LumpedModel,
    states: &[ContactState],
    friction: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    check_size(model)?;
    let Some(reduced) = model.reduced(states, friction) else { return Ok(Vec::new()) };
    let (operator, _) = operator(&reduced)?;
    let floor = rounding(&operator);
    let found = eigenvalues(operator).ok_or_else(|| {
        let states = Joined(states);
        Error::analysis(format!(
            "the eigenvalues of state {states} were not found at µ = {friction}"
        ))
    })?;
    Ok(found.into_iter().map(|sigma| cleaned(sigma, floor)).collect())
}

/// What rounding leaves of an eigenvalue zero, 1/s².
fn rounding(operator: &DMatrix<f64>) -> f64 {
    let size = u32::try_from(operator.nrows()).unwrap_or(u32::MAX);
    f64::from(size) * f64::EPSILON * operator.amax()
}

/// A double real eigenvalue comes out of rounding as a pair that is complex by a little, and that of
/// a motion which strains no spring as one that is not quite zero. Where two real ones do merge, this
/// moves the place by the square of that little.
fn cleaned(sigma: Complex<f64>, floor: f64) -> Complex<f64> {
    if sigma.norm() <= floor {
        return Complex::new(0.0, 0.0);
    }
    let is_real = sigma.im.abs() <= 1e-7 * sigma.re.abs();
    if is_real { Complex::new(sigma.re, 0.0) } else { sigma }
}

/// The most degrees of freedom that are analysed as one dense matrix: some seconds of work.
const MAX_DENSE: usize = 1200;

pub(super) fn check_size(model: &LumpedModel) -> Result<(), Error> {
    if model.dofs() <= MAX_DENSE {
        return Ok(());
    }
    Err(Error::analysis(format!(
        "{} degrees of freedom: dense eigenvalues are found for up to {MAX_DENSE}; of longer rings \
         only those of equal modules that are all in one state, wave by wave",
        model.dofs()
    )))
}

/// A matrix with the eigenvalues of M̃⁻¹ K̃, and what each component of its eigenvectors w is to be
/// multiplied by to give those of M̃⁻¹ K̃. Where M̃ is diagonal it is M̃^-½ K̃ M̃^-½, which keeps the
/// digits of low modes where masses differ by orders of magnitude.
fn operator(reduced: &ReducedMatrices) -> Result<(DMatrix<f64>, Vec<f64>), Error> {
    let ReducedMatrices { mass, stiffness, .. } = reduced;
    let size = mass.nrows();
    let diagonal = mass.diagonal();
    let is_diagonal = *mass == DMatrix::from_diagonal(&diagonal);
    let (operator, scale) = if is_diagonal && diagonal.iter().all(|mass| *mass > 0.0) {
        let scale: Vec<f64> = diagonal.iter().map(|mass| 1.0 / mass.sqrt()).collect();
        (DMatrix::from_fn(size, size, |i, j| scale[i] * stiffness[(i, j)] * scale[j]), scale)
    } else {
        (per_mass(mass, stiffness)?, vec![1.0; size])
    };
    finite(&operator)?;
    Ok((operator, scale))
}

/// M̃⁻¹ A.
pub(super) fn per_mass(mass: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let quotient = mass.clone().lu().solve(matrix).ok_or_else(|| {
        Error::analysis("the masses that this contact state leaves free cannot be accelerated")
    })?;
    finite(&quotient)?;
    Ok(quotient)
}

fn finite(matrix: &DMatrix<f64>) -> Result<(), Error> {
    if matrix.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(Error::analysis(
        "M⁻¹ K or M⁻¹ C leaves the range of numbers; look for a value that is too large",
    ))
}

/// Which of the eigenvalues of a real problem one is.
pub(super) enum Kind {
    Oscillating,
    Conjugate,
    Real,
}

impl Kind {
    pub(super) fn of(eigenvalue: Complex<f64>) -> Self {
        // Below this part of |λ| an imaginary part is what rounding leaves of zero.
        if eigenvalue.im.abs() <= 1e-9 * eigenvalue.norm() {
            Self::Real
        } else if eigenvalue.im > 0.0 {
            Self::Oscillating
        } else {
            Self::Conjugate
        }
    }
}

/// The roots of λ² + (α + β σ) λ + σ = 0, without cancellation.
pub(super) fn quadratic_roots(model: &LumpedModel, sigma: Complex<f64>) -> [Complex<f64>; 2] {
    let half = (sigma * model.damping.beta + model.damping.alpha) * -0.5;
    let root = (half * half - sigma).sqrt();
    // The larger of the two, then the other from their product σ.
    let larger = if (half.conj() * root).re >= 0.0 { half + root } else { half - root };
    if larger.norm() == 0.0 { [larger; 2] } else { [larger, sigma / larger] }
}

fn residual(reduced: &ReducedMatrices, lambda: Complex<f64>, u: &[Complex<f64>]) -> f64 {
    let times = |matrix: &DMatrix<f64>, row: usize| -> Complex<f64> {
        (0..u.len()).map(|column| u[column] * matrix[(row, column)]).sum()
    };
    let (mut rest, mut terms) = (0.0, 0.0);
    for row in 0..u.len() {
        let parts = [
            lambda * lambda * times(&reduced.mass, row),
            lambda * times(&reduced.damping, row),
            times(&reduced.stiffness, row),
        ];
        rest += parts.iter().sum::<Complex<f64>>().norm_sqr();
        terms += parts.iter().map(|part| part.norm()).sum::<f64>().powi(2);
    }
    if terms > 0.0 { (rest / terms).sqrt() } else { 0.0 }
}

/// x = V u.
fn shape(motions: &DMatrix<f64>, u: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let row = |row: usize| (0..u.len()).map(|column| u[column] * motions[(row, column)]).sum();
    scaled((0..motions.nrows()).map(row).collect())
}

/// Turned and scaled so that the largest value is 1.
fn scaled(shape: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    let Some(largest) = largest(&shape).map(|dof| shape[dof]) else { return shape };
    shape.into_iter().map(|value| value / largest).collect()
}

/// The place of the largest value; the first, where symmetry makes several equal.
pub(super) fn largest(shape: &[Complex<f64>]) -> Option<usize> {
    let most = shape.iter().map(|value| value.norm()).fold(0.0, f64::max);
    shape.iter().position(|value| value.norm() >= most * (1.0 - 1e-9))
}
