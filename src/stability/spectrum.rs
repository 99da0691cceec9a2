//! The eigenvalues of one contact state, without shapes.

use super::damped_modes;
use super::reduced_problem::{EigenvalueKind, check_size, quadratic_roots};
use super::symmetry::all_stiffness_eigenvalues;
use crate::Error;
use crate::contact::{ContactState, JoinedStates};
use crate::model::LinearModel;
use nalgebra::Complex;

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
    /// Returns an error if the model is too large to be solved as one matrix, if its masses cannot be accelerated, or if
    /// no eigenvalues are found.
    pub fn of(model: LinearModel<'_>, states: &[ContactState]) -> Result<Self, Error> {
        let found = if !model.has_single_damping_in(states) {
            let sigmas = all_stiffness_eigenvalues(model, states)?;
            Self::from_all(sigmas.iter().flat_map(|&sigma| quadratic_roots(model.model(), sigma)))
        } else {
            check_size(model.model())?;
            let Some(reduced) = model.reduced(states) else { return Ok(Self::default()) };
            Self::from_all(damped_modes::all_eigenvalues(&reduced)?)
        };
        if found.growth_rate() < f64::INFINITY && found.oscillating.iter().all(|v| v.is_finite()) {
            return Ok(found);
        }
        Err(Error::analysis(format!(
            "the eigenvalues of contact state {} leave the range of floating-point numbers; look for a \
             value that is too large",
            JoinedStates(states)
        )))
    }

    fn from_all(eigenvalues: impl IntoIterator<Item = Complex<f64>>) -> Self {
        let mut found = Self::default();
        for eigenvalue in eigenvalues {
            match EigenvalueKind::of(eigenvalue) {
                EigenvalueKind::Real => found.real.push(eigenvalue.re),
                EigenvalueKind::Oscillating => found.oscillating.push(eigenvalue),
                EigenvalueKind::Conjugate => {}
            }
        }
        found.oscillating.sort_by(|a, b| a.im.total_cmp(&b.im));
        found.real.sort_by(f64::total_cmp);
        found
    }

    /// The largest growth rate, 1/s; −∞ where no motion is possible.
    #[must_use]
    pub fn growth_rate(&self) -> f64 {
        let oscillating = self.oscillating.iter().map(|eigenvalue| eigenvalue.re);
        oscillating.chain(self.real.iter().copied()).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The eigenvalue with the largest growth rate, of a pair the one with Im λ > 0; among equals the first that
    /// oscillates, by frequency. `None` where no motion is possible.
    #[must_use]
    pub fn fastest_growing(&self) -> Option<Complex<f64>> {
        let real = self.real.iter().map(|&value| Complex::new(value, 0.0));
        let all = self.oscillating.iter().copied().chain(real);
        all.reduce(|fastest, other| if other.re > fastest.re { other } else { fastest })
    }

    /// `true` if any eigenvalue has a positive growth rate.
    #[must_use]
    pub fn unstable(&self) -> bool {
        self.growth_rate() > 0.0
    }
}
