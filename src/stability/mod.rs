//! Stability of the contact states: complex eigenvalues, and the largest step of the scheme.
//!
//! | file | contents |
//! | --- | --- |
//! | `complex` | modulus, root and logarithm of a complex number, the same on each machine |
//! | `critical_step` | the largest step of the explicit scheme |
//! | `damped_step` | the largest step for a state with discrete dampers |
//! | `step_search` | the largest step that fulfils a condition |
//! | `step_guard` | refuses steps above the critical one during a run |
//! | `frequency_bound` | bounds over all contact states |
//! | `oblique_projection` | the angle by which friction inclines the projection of motions in any contact state |
//! | `eigenvalues` | the eigenvalues of a matrix |
//! | `eigenvectors` | the eigenvalues of a matrix with their vectors |
//! | `reduced_problem` | the eigenvalue problem of one contact state |
//! | `damped_modes` | the full eigenvalue problem with discrete dampers |
//! | `symmetry` | equivalent states of a ring; waves in place of the whole ring |
//! | `spectrum` | the eigenvalues of one contact state, without shapes |

mod alike_states;
#[cfg(test)]
mod bound_tests;
mod complex;
mod critical_step;
mod damped_step;
mod frequency_bound;
mod oblique_projection;
mod step_guard;
mod step_search;

pub use critical_step::{CriticalStep, Origin, critical_step};
pub use step_guard::StepGuard;

use crate::model::LumpedModel;

/// An upper bound of the frequencies of modes without friction, rad/s, in any contact state; `None` for a full mass
/// matrix. The result is the same double on each machine.
#[must_use]
pub fn highest_frequency(model: &LumpedModel) -> Option<f64> {
    frequency_bound::frictionless(model)
}

pub mod damped_modes;
mod eigenvalues;
mod eigenvectors;
pub mod reduced_problem;
pub mod singular_values;
mod spectrum;
pub mod symmetry;

pub use {
    eigenvalues::eigenvalues, eigenvectors::Eigenpair, eigenvectors::eigenpairs,
    spectrum::Spectrum, symmetry::Symmetry,
};
