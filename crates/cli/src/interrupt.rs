//! Handling of Ctrl-C, which ends a long command with the results so far.

use crate::progress::Progress;
use amontons_analysis::watch::Watch;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// The error that the user has ended a command.
#[derive(Debug)]
pub struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("interrupted")
    }
}

impl Error for Interrupted {}

/// Makes Ctrl-C set a flag, which [`stopped`] reads, instead of ending the program.
pub fn listen() {
    // Without a handler Ctrl-C ends the program at once.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Returns `Break` as soon as the user has pressed Ctrl-C.
pub fn stopped() -> ControlFlow<()> {
    if STOP.load(Ordering::Relaxed) { Break(()) } else { Continue(()) }
}

/// Runs work under a bar that shows its progress, until the work is done or the user ends it.
pub fn watched<T>(bar: &Progress, work: impl FnOnce(Watch<'_>) -> T) -> T {
    listen();
    let result = work(Watch { go_on: &stopped, progress: &|part| bar.set_part(part) });
    bar.finish();
    result
}
