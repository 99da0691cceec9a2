//! Handling of Ctrl-C, which ends a long command with the results so far.

use crate::progress::Progress;
use amontons_analysis::watch::Watch;
use std::error::Error;
use std::fmt;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::spawn;
use std::time::Duration;

/// Time after which Ctrl-C is heard.
const HEARD: Duration = Duration::from_millis(50);

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

/// Runs work on a thread of its own under a bar that shows its progress; `None` if the user ended it. Some steps of the work, such as
/// the eigenvalues of a large matrix, take long and hear no watch: their thread is left behind, for the end of the program to end.
///
/// # Panics
/// Panics if the work does.
pub fn left_behind<T: Send + 'static>(
    bar: Progress,
    work: impl FnOnce(Watch<'_>) -> T + Send + 'static,
) -> Option<T> {
    listen();
    let bar = Arc::new(bar);
    let (sender, receiver) = channel();
    let of_thread = Arc::clone(&bar);
    let thread = spawn(move || {
        let watch = Watch { go_on: &stopped, progress: &|part| of_thread.set_part(part) };
        // Nobody may listen any more.
        let _ = sender.send(work(watch));
    });
    let result = loop {
        match receiver.recv_timeout(HEARD) {
            Ok(result) => break (!stopped().is_break()).then_some(result),
            Err(RecvTimeoutError::Timeout) if stopped().is_break() => break None,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => break None,
            },
        }
    };
    bar.finish();
    result
}

/// Runs work under a bar that shows its progress, until the work is done or the user ends it.
pub fn watched<T>(bar: &Progress, work: impl FnOnce(Watch<'_>) -> T) -> T {
    listen();
    let result = work(Watch { go_on: &stopped, progress: &|part| bar.set_part(part) });
    bar.finish();
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_on_a_thread_of_its_own_gives_its_result_and_its_panic() {
        let bar = || Progress::in_parts("work");
        assert_eq!(left_behind(bar(), |watch| !watch.is_over()), Some(true));
        let panics = || left_behind(bar(), |_| assert!(stopped().is_break(), "not ended"));
        assert!(std::panic::catch_unwind(panics).is_err());
    }
}
