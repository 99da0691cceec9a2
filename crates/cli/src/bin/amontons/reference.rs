//! Progress of a command that begins with a reference run.

use amontons::scene::Scene;
use amontons_analysis::accuracy::ConvergenceStudy;
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::{Interrupted, stopped};
use amontons_cli::progress::Progress;
use std::error::Error;
use std::sync::{Mutex, PoisonError};

/// Share of the reference in the work of the whole command, as the bar shows it.
pub const REFERENCE_SHARE: f64 = 0.1;

/// The progress bar of the command.
pub fn bar() -> Progress {
    Progress::in_parts("the reference")
}

/// Makes the convergence study of a scene and shows its progress in the first part of a bar.
///
/// # Errors
/// Returns an error if the scene is invalid, or [`Interrupted`] if the user has ended the command.
pub fn study(
    scene: &Scene,
    dof: Option<usize>,
    bar: &Progress,
) -> Result<ConvergenceStudy, Box<dyn Error>> {
    let before = Mutex::new((0.0, 0.0));
    let progress = |passed: f64| {
        let mut before = before.lock().unwrap_or_else(PoisonError::into_inner);
        // The number of runs of the reference is not known in advance.
        let runs = if passed < before.1 { before.0 + 1.0 } else { before.0 };
        *before = (runs, passed);
        bar.set_part(REFERENCE_SHARE * (1.0 - 0.5_f64.powf(runs + passed)));
    };
    let watch = Watch { go_on: &stopped, progress: &progress };
    ConvergenceStudy::new(scene, dof, watch)?.ok_or_else(|| Interrupted.into())
}
