//! Complex eigenvalue analysis of one contact state (paper, eqs. 3–6).

use super::damped_modes;
use super::reduced_problem::{Kind, check_size, cleaned, operator, quadratic_roots, rounding};
use super::symmetry::{Part, module_of_wave, turn};
use crate::Error;
use crate::contact::ContactState;
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
    if model.has_single_damping_in(states) {
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
