//! Long work: it runs without the interpreter's lock, reports its progress, and Ctrl-C ends it.

use crate::errors::Error;
use amontons_analysis::stability;
use amontons_analysis::watch::Watch;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two looks at Ctrl-C, and between two reports of progress.
const TICK: Duration = Duration::from_millis(50);

/// Calls a Python function as one of many workers: analyses that it asks for start no threads of their own.
#[pyfunction]
pub fn on_this_thread(function: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    stability::on_this_thread(|| function.call0()).map(Bound::unbind)
}

/// Carries out work in a thread of its own, while this one waits for it, calls `progress` with the part that is done,
/// from 0 to 1, and ends the work if Python has an interrupt or `progress` raises.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(Watch<'_>) -> T + Send,
) -> PyResult<T> {
    let is_over = AtomicBool::new(false);
    let done = AtomicU64::new(0.0_f64.to_bits());
    let go_on = || match is_over.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let report = |part: f64| done.store(part.to_bits(), Ordering::Relaxed);
    // Whether an analysis may start threads is known of each thread.
    let is_alone = stability::is_on_this_thread();
    let tell = || {
        let part = f64::from_bits(done.load(Ordering::Relaxed));
        progress.map_or(Ok(()), |progress| progress.call1((part,)).map(|_| ()))
    };
    std::thread::scope(|scope| {
        let (sender, receiver) = channel::<()>();
        let worker = scope.spawn(|| {
            // Dropped at the end of the work, however it ends.
            let _sender = sender;
            let watch = Watch { go_on: &go_on, progress: &report };
            if is_alone { stability::on_this_thread(|| work(watch)) } else { work(watch) }
        });
        let mut raised = None;
        // `detach` hands what it uses to any thread; a receiver alone is for one.
        let receiver = Mutex::new(receiver);
        loop {
            let waited = py.detach(|| {
                let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
                receiver.recv_timeout(TICK)
            });
            if waited != Err(RecvTimeoutError::Timeout) {
                break;
            }
            if raised.is_none()
                && let Err(error) = py.check_signals().and_then(|()| tell())
            {
                is_over.store(true, Ordering::Relaxed);
                raised = Some(error);
            }
        }
        let result = py.detach(|| worker.join());
        match (raised, result) {
            (Some(error), _) => Err(error),
            (None, Ok(result)) => {
                report(1.0);
                tell().map(|()| result)
            }
            (None, Err(panic)) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text =
                    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or_default();
                Err(Error::new_err(format!(
                    "an internal error of Amontons, please report it: {text}"
                )))
            }
        }
    })
}
