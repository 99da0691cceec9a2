//! The draws and the runs of a study of robustness.

use super::draws::Design;
use super::squeal::{Pushes, Squeals, squeals};
use super::study::{Robustness, robustness};
use crate::journal::Journal;
use crate::watch::Watch;
use amontons::Error;
use serde::Serialize;

/// The part of the time that draws take beside runs.
const DRAWS: f64 = 0.1;

/// The results of draws and of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Both {
    /// Probabilities and indices from eigenvalues; `None` if no parameter scatters.
    pub eigenvalues: Option<Robustness>,
    /// Ends of runs; `None` without pushes.
    pub runs: Option<Squeals>,
}

/// The eigenvalues of draws, if a parameter scatters, and the ends of runs, if there are pushes. `bands` are those of
/// [`robustness`]. `None` if the watch ended the work, or if pieces of other workers are missing.
///
/// # Errors
/// Returns an error as [`robustness`] and [`squeals`] do.
pub fn both(
    design: &Design<'_>,
    bands: Option<&[[f64; 2]]>,
    pushes: Option<&Pushes<'_>>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Both>, Error> {
    let first = if pushes.is_some() { DRAWS } else { 1.0 };
    let part = |from: f64, to: f64| move |part: f64| (watch.progress)(from + (to - from) * part);
    let (of_draws, of_runs) = (part(0.0, first), part(first, 1.0));
    let draws = Watch { progress: &of_draws, ..watch };
    let eigenvalues = if design.parameters.is_empty() {
        Some(None)
    } else {
        robustness(design, bands, journal, draws)?.map(Some)
    };
    let runs = match pushes {
        // Workers share the pieces of both parts in one round.
        Some(pushes) => squeals(pushes, journal, Watch { progress: &of_runs, ..watch })?.map(Some),
        None => Some(None),
    };
    Ok(eigenvalues.zip(runs).map(|(eigenvalues, runs)| Both { eigenvalues, runs }))
}
