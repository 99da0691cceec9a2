//! How far a command is that begins with a reference.

use amontons::scene::Scene;
use amontons_analysis::accuracy::Study;
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::{Interrupted, stopped};
use amontons_cli::progress::Progress;
use std::error::Error;
use std::sync::{Mutex, PoisonError};

/// A reference's cost against the whole command's, as the bar shows it.
pub const REFERENCE_SHARE: f64 = 0.1;

/// The bar of the command.
pub fn reference() -> Progress {
    Progress::in_parts("the reference")
}

/// The study of a scene, under the first part of a bar.
///
/// # Errors
/// What is wrong with the scene; [`Interrupted`].
pub fn study(scene: &Scene, dof: Option<usize>, bar: &Progress) -> Result<Study, Box<dyn Error>> {
    let before = Mutex::new((0.0, 0.0));
    let progress = |passed: f64| {
        let mut before = before.lock().unwrap_or_else(PoisonError::into_inner);
        // How many runs the reference takes is not known before.
        let runs = if passed < before.1 { before.0 + 1.0 } else { before.0 };
        *before = (runs, passed);
        bar.set_part(REFERENCE_SHARE * (1.0 - 0.5_f64.powf(runs + passed)));
    };
    let watch = Watch { go_on: &stopped, progress: &progress };
    Study::new(scene, dof, watch)?.ok_or_else(|| Interrupted.into())
}
