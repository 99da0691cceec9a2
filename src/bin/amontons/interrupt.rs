//! Ctrl-C, and how far a long command is.

use amontons::accuracy::Study;
use amontons::scene::Scene;
use indicatif::{ProgressBar, ProgressStyle};
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};

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

/// A bar on standard error, shown only to a person.
pub fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")
        .expect("the template is fixed");
    ProgressBar::new(1000).with_style(style).with_message("the reference")
}

/// Sets a bar to this part of it.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn show(bar: &ProgressBar, part: f64) {
    bar.set_position((1e3 * part) as u64);
}

/// The study of a scene, under the first part of a bar.
///
/// # Errors
/// What is wrong with the scene; [`Interrupted`].
pub fn study(
    scene: &Scene,
    dof: Option<usize>,
    bar: &ProgressBar,
) -> Result<Study, Box<dyn Error>> {
    let (mut runs, mut last) = (0.0, 0.0);
    let watch = &mut |passed: f64| {
        // How many runs the reference takes is not known before.
        if passed < last {
            runs += 1.0;
        }
        last = passed;
        show(bar, REFERENCE_SHARE * (1.0 - 0.5_f64.powf(runs + passed)));
        stopped()
    };
    let study = Study::new(scene, dof, watch);
    if !matches!(study, Ok(Some(_))) {
        bar.finish_and_clear();
    }
    study?.ok_or_else(|| Interrupted.into())
}
