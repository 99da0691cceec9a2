//! The eigenvalue problem of one contact state (paper, eqs. 3–6), without shapes.
//!
//! With C̃ = α M̃ + β K̃, which Rayleigh damping gives because friction follows the whole normal
//! force, the quadratic problem (λ² M̃ + λ C̃ + K̃) u = 0 has the eigenvectors of M̃⁻¹ K̃, and each of
//! its eigenvalues σ two eigenvalues of the state: λ² + (α + β σ) λ + σ = 0. So the problem solved is
//! half as large as eq. (6), and two modes coalesce exactly where two σ do, damped or not. With discrete
//! dampers there are no such σ; `damped_modes` then solves the problem at its full size.

use super::complex::{modulus, root};
use super::eigenvalues::eigenvalues;
use crate::Error;
use crate::contact::{ContactState, JoinedStates};
use crate::model::{LinearModel, LumpedModel, ReducedMatrices};
use nalgebra::{Complex, DMatrix};

/// The eigenvalues σ of M̃⁻¹ K̃, 1/s², from the whole matrices; those of a state's modes where there
/// are no discrete dampers.
///
/// # Errors
/// Returns an error if the model is too large ([`check_size`]), its masses cannot be accelerated, or the iteration fails.
pub fn stiffness_eigenvalues(
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<Vec<Complex<f64>>, Error> {
    check_size(model.model())?;
    let Some(reduced) = model.reduced(states) else { return Ok(Vec::new()) };
    let (operator, _) = operator(&reduced)?;
    let floor = rounding(&operator);
    let found = eigenvalues(operator).ok_or_else(|| {
        let states = JoinedStates(states);
        Error::analysis(format!("the eigenvalues of contact state {states} were not found"))
    })?;
    Ok(found.into_iter().map(|sigma| cleaned(sigma, floor)).collect())
}

/// Magnitude of the rounding of a zero eigenvalue, 1/s².
#[must_use]
pub fn rounding(operator: &DMatrix<f64>) -> f64 {
    let size = u32::try_from(operator.nrows()).unwrap_or(u32::MAX);
    f64::from(size) * f64::EPSILON * operator.amax()
}

/// Removes rounding from an eigenvalue σ. Rounding turns a double real eigenvalue into a pair with a small imaginary
/// part, and the zero of a motion that strains no spring into a small number. Where two real eigenvalues do merge, this
/// moves the place by the square of that small part.
#[must_use]
pub fn cleaned(sigma: Complex<f64>, floor: f64) -> Complex<f64> {
    if modulus(sigma) <= floor {
        return Complex::new(0.0, 0.0);
    }
    let is_real = sigma.im.abs() <= 1e-7 * sigma.re.abs();
    if is_real { Complex::new(sigma.re, 0.0) } else { sigma }
}

/// The most degrees of freedom that are analysed as one dense matrix: some seconds of work.
const MAX_DENSE: usize = 1200;

/// Checks that the eigenvalues of a model take no more than some seconds.
///
/// # Errors
/// Returns an error if the model has more than 1200 degrees of freedom.
pub fn check_size(model: &LumpedModel) -> Result<(), Error> {
    if model.dofs() <= MAX_DENSE {
        return Ok(());
    }
    Err(Error::analysis(format!(
        "the model has {} degrees of freedom, but eigenvalues are computed for at most {MAX_DENSE}, or for \
         rings of equal modules that are all in one contact state",
        model.dofs()
    )))
}

/// A matrix with the eigenvalues of M̃⁻¹ K̃, and the factors that turn the components of its eigenvectors w into those
/// of M̃⁻¹ K̃. Where M̃ is diagonal it is M̃^-½ K̃ M̃^-½, which keeps the digits of low modes where masses differ by
/// orders of magnitude.
///
/// # Errors
/// Returns an error if M̃ is singular, or if an entry leaves the range of numbers.
pub fn operator(reduced: &ReducedMatrices) -> Result<(DMatrix<f64>, Vec<f64>), Error> {
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

/// Returns M̃⁻¹ A.
///
/// # Errors
/// Returns an error if M̃ is singular, or if an entry leaves the range of numbers.
pub fn per_mass(mass: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let quotient = mass
        .clone()
        .lu()
        .solve(matrix)
        .ok_or_else(|| Error::analysis("the mass matrix of this contact state is singular"))?;
    finite(&quotient)?;
    Ok(quotient)
}

fn finite(matrix: &DMatrix<f64>) -> Result<(), Error> {
    if matrix.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(Error::analysis(
        "M⁻¹ K or M⁻¹ C leaves the range of floating-point numbers; look for a value that is too large",
    ))
}

/// The kind of an eigenvalue of a real problem: real, or one of a conjugate pair.
pub enum EigenvalueKind {
    /// The one of a conjugate pair with Im λ > 0.
    Oscillating,
    /// The one of a conjugate pair with Im λ < 0.
    Conjugate,
    /// A real eigenvalue: Im λ = 0 but for rounding.
    Real,
}

impl EigenvalueKind {
    /// The kind of an eigenvalue λ.
    #[must_use]
    pub fn of(eigenvalue: Complex<f64>) -> Self {
        // Below this part of |λ| an imaginary part is the rounding of zero.
        if eigenvalue.im.abs() <= 1e-9 * modulus(eigenvalue) {
            Self::Real
        } else if eigenvalue.im > 0.0 {
            Self::Oscillating
        } else {
            Self::Conjugate
        }
    }
}

/// The roots of λ² + (α + β σ) λ + σ = 0, without cancellation.
#[must_use]
pub fn quadratic_roots(model: &LumpedModel, sigma: Complex<f64>) -> [Complex<f64>; 2] {
    let half = (sigma * model.damping.beta + model.damping.alpha) * -0.5;
    let root = root(half * half - sigma);
    // The larger of the two, then the other from their product σ.
    let larger = if (half.conj() * root).re >= 0.0 { half + root } else { half - root };
    if larger == Complex::ZERO { [larger; 2] } else { [larger, sigma / larger] }
}
