//! Ctrl-C, and how far a long command is.

use amontons::scene::Scene;
use amontons_analysis::accuracy::Study;
use amontons_analysis::watch::Watch;
use amontons_cli::progress::Progress;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// A reference's cost against the whole command's, as the bar shows it.
pub const REFERENCE_SHARE: f64 = 0.1;

static STOP: AtomicBool = AtomicBool::new(false);

/// A person has ended a command before its end.
#[derive(Debug)]
pub struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("interrupted")
    }
}

impl Error for Interrupted {}

/// From now on Ctrl-C is asked for by [`stopped`].
pub fn listen() {
    // Without a handler Ctrl-C ends the program at once, as ever.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Whether to go on.
pub fn stopped() -> ControlFlow<()> {
    if STOP.load(Ordering::Relaxed) { Break(()) } else { Continue(()) }
}

/// Does work under a bar that shows how far it is, until it is done or a person ends it.
pub fn watched<T>(bar: &Progress, work: impl FnOnce(Watch<'_>) -> T) -> T {
    listen();
    let result = work(Watch { go_on: &stopped, progress: &|part| bar.set_part(part) });
    bar.finish();
    result
}

/// How far a command is that begins with a reference.
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
