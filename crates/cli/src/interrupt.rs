//! Ctrl-C ends a long command with what is done.

use crate::progress::Progress;
use amontons_analysis::watch::Watch;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};

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

/// From now on Ctrl-C does not end the program; [`stopped`] tells it.
pub fn listen() {
    // Without a handler Ctrl-C ends the program at once, as ever.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// `Break` as soon as a person has pressed Ctrl-C.
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
