//! The progress of several runs at once, of which each may take long.

use crate::watch::Watch;
use std::sync::atomic::{AtomicU32, Ordering};

/// Parts of a run that are told apart.
const PARTS: f64 = 1000.0;

/// Runs with the part that is done of each.
pub(super) struct Runs<'a> {
    watch: Watch<'a>,
    done: Vec<AtomicU32>,
}

impl<'a> Runs<'a> {
    pub(super) fn of(watch: Watch<'a>, count: usize) -> Self {
        Self { watch, done: (0..count).map(|_| AtomicU32::new(0)).collect() }
    }

    /// Reports that a part of a run is done, from 0 to 1.
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
    pub(super) fn reached(&self, run: usize, part: f64) {
        self.done[run].store((PARTS * part.clamp(0.0, 1.0)) as u32, Ordering::Relaxed);
        let done = self.done.iter().map(|it| f64::from(it.load(Ordering::Relaxed))).sum::<f64>();
        (self.watch.progress)(done / (PARTS * self.done.len() as f64));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn a_run_that_is_half_done_counts_as_half_a_run() {
        let told = Mutex::new(Vec::new());
        let watch = Watch { progress: &|part| told.lock().unwrap().push(part), ..Watch::IDLE };
        let runs = Runs::of(watch, 4);
        runs.reached(1, 0.5);
        runs.reached(3, 1.0);
        runs.reached(1, 2.0);
        assert_eq!(*told.lock().unwrap(), [0.125, 0.375, 0.5]);
    }
}
