//! Complex eigenvalue analysis of one contact state (paper, eqs. 3–6).
//!
//! With C̃ = α M̃ + β K̃, which Rayleigh damping gives because friction follows the whole normal
//! force, the quadratic problem (λ² M̃ + λ C̃ + K̃) u = 0 has the eigenvectors of M̃⁻¹ K̃, and each of
//! its eigenvalues σ two eigenvalues of the state: λ² + (α + β σ) λ + σ = 0. So the problem solved is
//! half as large as eq. (6), and two modes coalesce exactly where two σ do, damped or not. With single
//! dampers there are no such σ; `damped_modes` then solves the problem at its full size.

use super::damped_modes;
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
    /// ‖λ² M̃ u + λ C̃ u + K̃ u‖ against the sum of the norms of its terms.
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

    /// Takes in one eigenvalue with its vector; of each conjugate pair one stays.
    fn add(
        &mut self,
        reduced: &ReducedMatrices,
        eigenvalue: Complex<f64>,
        stiffness_eigenvalue: Complex<f64>,
        vector: &[Complex<f64>],
    ) {
        let list = match Kind::of(eigenvalue) {
            Kind::Real => &mut self.real,
            Kind::Oscillating => &mut self.oscillating,
            Kind::Conjugate => return,
        };
        list.push(Mode {
            eigenvalue,
            stiffness_eigenvalue,
            residual: residual(reduced, eigenvalue, vector),
            shape: shape(&reduced.motions, vector),
        });
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
/// The masses of the state cannot be inverted (friction wedges a contact), or the eigenvalue
/// iteration does not converge.
pub fn modes(
    model: &LumpedModel,
    states: &[ContactState],
    friction_coefficient: f64,
) -> Result<Modes, Error> {
    let mut found = Modes { oscillating: Vec::new(), real: Vec::new() };
    let Some(reduced) = model.reduced(states, friction_coefficient) else { return Ok(found) };
    if !model.dampers.is_empty() {
        for (eigenvalue, vector) in damped_modes::solve(&reduced)? {
            let Damping { alpha, beta } = model.damping;
            let rayleigh = -eigenvalue * (eigenvalue + alpha) / (eigenvalue * beta + 1.0);
            found.add(&reduced, eigenvalue, rayleigh, &vector);
        }
        found.sort();
        return Ok(found);
    }
    let size = reduced.mass.nrows();
    let eigen = operator(&reduced)?.eigen().map_err(|error| no_convergence(&error))?;
    for (column, &sigma) in eigen.S().column_vector().iter().enumerate() {
        let sigma = cleaned(Complex::new(sigma.re, sigma.im));
        let vector: Vec<Complex<f64>> = (0..size)
            .map(|row| Complex::new(eigen.U()[(row, column)].re, eigen.U()[(row, column)].im))
            .collect();
        for eigenvalue in quadratic_roots(model, sigma) {
            found.add(&reduced, eigenvalue, sigma, &vector);
        }
    }
    found.sort();
    Ok(found)
}

/// Eigenvalues alone, without shapes; 1/s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// One of each conjugate pair (Im λ > 0), by frequency.
    pub oscillating: Vec<Complex<f64>>,
    /// Real eigenvalues, ascending.
    pub real: Vec<f64>,
}

impl Spectrum {
    /// The eigenvalues λ of a contact state.
    ///
    /// # Errors
    /// As [`modes`].
    pub fn of(model: &LumpedModel, states: &[ContactState], friction: f64) -> Result<Self, Error> {
        if !model.dampers.is_empty() {
            let Some(reduced) = model.reduced(states, friction) else { return Ok(Self::default()) };
            return Ok(Self::from_eigenvalues(damped_modes::eigenvalues(&reduced)?));
        }
        Ok(Self::from_stiffness(model, &stiffness_eigenvalues(model, states, friction)?))
    }

    /// The eigenvalues λ that belong to all eigenvalues σ of M̃⁻¹ K̃ of a state of this model.
    pub(super) fn from_stiffness(model: &LumpedModel, sigmas: &[Complex<f64>]) -> Self {
        Self::from_eigenvalues(sigmas.iter().flat_map(|&sigma| quadratic_roots(model, sigma)))
    }

    fn from_eigenvalues(eigenvalues: impl IntoIterator<Item = Complex<f64>>) -> Self {
        let mut found = Self::default();
        for eigenvalue in eigenvalues {
            match Kind::of(eigenvalue) {
                Kind::Real => found.real.push(eigenvalue.re),
                Kind::Oscillating => found.oscillating.push(eigenvalue),
                Kind::Conjugate => {}
            }
        }
        found.oscillating.sort_by(|a, b| a.im.total_cmp(&b.im));
        found.real.sort_by(f64::total_cmp);
        found
    }

    /// The largest growth rate, 1/s; −∞ where nothing can move.
    #[must_use]
    pub fn growth_rate(&self) -> f64 {
        let oscillating = self.oscillating.iter().map(|eigenvalue| eigenvalue.re);
        oscillating.chain(self.real.iter().copied()).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Does anything grow?
    #[must_use]
    pub fn unstable(&self) -> bool {
        self.growth_rate() > 0.0
    }
}

/// The eigenvalues σ of M̃⁻¹ K̃, 1/s².
pub(super) fn stiffness_eigenvalues(
    model: &LumpedModel,
    states: &[ContactState],
    friction: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    if !model.dampers.is_empty() {
        return Err(Error::analysis(
            "root loci, bi-stable ranges and waves follow the eigenvalues of M⁻¹ K, which needs \
             damping by α M + β K alone; this scene has single dampers: look at its states and \
             modes at one value of µ at a time",
        ));
    }
    let Some(reduced) = model.reduced(states, friction) else { return Ok(Vec::new()) };
    let values = operator(&reduced)?.eigenvalues().map_err(|error| no_convergence(&error))?;
    Ok(values.into_iter().map(|sigma| cleaned(Complex::new(sigma.re, sigma.im))).collect())
}

/// A double real eigenvalue, as equal modules have, comes out of rounding as a pair that is complex
/// by a little. Where two real ones do merge, this moves the place by 1e-14 of the parameter.
fn cleaned(sigma: Complex<f64>) -> Complex<f64> {
    let is_real = sigma.im.abs() <= 1e-7 * sigma.re.abs();
    if is_real { Complex::new(sigma.re, 0.0) } else { sigma }
}

fn operator(reduced: &ReducedMatrices) -> Result<Mat<f64>, Error> {
    let size = reduced.mass.nrows();
    let matrix = reduced.mass.clone().lu().solve(&reduced.stiffness).ok_or_else(|| {
        Error::analysis("the masses that this contact state leaves free cannot be accelerated")
    })?;
    Ok(Mat::from_fn(size, size, |i, j| matrix[(i, j)]))
}

pub(super) fn no_convergence(error: &dyn std::fmt::Debug) -> Error {
    Error::analysis(format!("the eigenvalues of the contact state were not found: {error:?}"))
}

/// Which of the eigenvalues of a real problem one is.
enum Kind {
    Oscillating,
    Conjugate,
    Real,
}

impl Kind {
    fn of(eigenvalue: Complex<f64>) -> Self {
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

/// x = V u, turned and scaled so that its largest value is 1.
fn shape(motions: &DMatrix<f64>, u: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let x: Vec<Complex<f64>> = (0..motions.nrows())
        .map(|row| (0..u.len()).map(|column| u[column] * motions[(row, column)]).sum())
        .collect();
    let largest = x.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let largest = largest.unwrap_or(Complex::new(1.0, 0.0));
    x.into_iter().map(|value| value / largest).collect()
}
