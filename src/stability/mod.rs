//! Stability of the contact states: complex eigenvalues, and the largest step of the scheme.
//!
//! | file | what it finds |
//! | --- | --- |
//! | `complex` | modulus, root and logarithm of a complex number, the same on each machine |
//! | `critical_step` | the largest step of the explicit scheme |
//! | `damped_step` | the same for a state with single dampers |
//! | `step_search` | the largest step that fulfils a condition |
//! | `step_guard` | refuses steps above the critical one during a run |
//! | `frequency_bound` | bounds over all contact states |
//! | `oblique_projection` | how far friction leans motions in any contact state |
//! | `eigenvalues` | the eigenvalues of a matrix |
//! | `reduced_problem` | the eigenvalue problem of one contact state |
//! | `damped_modes` | the full problem where there are single dampers |
//! | `modes` | eigenvalues and shapes of one contact state |
//! | `symmetry` | which states of a ring are alike; waves in place of the whole ring |
//! | `spectrum` | the eigenvalues of one contact state, without shapes |
//! | `states` | the eigenvalues of all contact states |
//! | `departure` | how large a mode may become before a contact leaves sliding |
//! | `locus` | modes over a parameter: where they merge, where they begin to grow |
//! | `linearised` | a scene's model as eigenvalues need it |
//! | `growth` | ranges of a parameter in which modes grow |
//! | `reach` | how large a motion must be before contacts can be in another state |
//! | `candidates` | ranges of µ that can be bi-stable |
//! | `map` | the verdict over two parameters |
//!
//! The critical step and the eigenvalues of one state go into the library inside an FMU; all else needs the
//! feature `tools`.

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

/// A frequency that no mode without friction exceeds, rad/s, in any contact state; `None` for a full mass
/// matrix. The same double on each machine.
#[must_use]
pub fn highest_frequency(model: &LumpedModel) -> Option<f64> {
    frequency_bound::frictionless(model)
}

mod damped_modes;
mod eigenvalues;
mod reduced_problem;
mod singular_values;
mod spectrum;
mod symmetry;

pub use {eigenvalues::eigenvalues, spectrum::Spectrum, symmetry::Symmetry};

#[cfg(feature = "tools")]
pub mod candidates;
#[cfg(feature = "tools")]
mod departure;
#[cfg(feature = "tools")]
mod growth;
#[cfg(feature = "tools")]
mod linearised;
#[cfg(feature = "tools")]
pub mod locus;
#[cfg(feature = "tools")]
pub mod map;
#[cfg(feature = "tools")]
mod modes;
#[cfg(feature = "tools")]
pub(crate) mod parallel;
#[cfg(feature = "tools")]
mod reach;
#[cfg(feature = "tools")]
mod states;

#[cfg(feature = "tools")]
pub use {
    departure::{Departure, departure},
    linearised::Linearised,
    modes::{Mode, Modes, modes},
    reach::{Reach, reach},
    states::{MAX_CONTACTS, StateClasses},
};
