//! Progress of the work on many points.

use super::Watch;
use std::cell::Cell;
use std::sync::{Mutex, PoisonError};

/// Progress of the work on some points: a point that is followed counts by the part of the longest time that it may
/// take.
pub(super) struct Work<'a> {
    points: usize,
    /// Beginning and end of this work within that of the basin, from 0 to 1.
    within: [f64; 2],
    watch: Watch<'a>,
    /// The work that is done, in points.
    done: Mutex<f64>,
}

impl<'a> Work<'a> {
    /// Work on `points` points.
    pub(super) fn of(points: usize, within: [f64; 2], watch: Watch<'a>) -> Self {
        Self { points, within, watch, done: Mutex::new(0.0) }
    }

    /// Carries out a piece of the work, which may report the number of points done since its last report.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn piece<T>(&self, points: usize, work: impl FnOnce(&dyn Fn(f64)) -> T) -> T {
        let told = Cell::new(0.0);
        let tell = |more: f64| {
            told.set(told.get() + more);
            let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += more;
            let [from, to] = self.within;
            (self.watch.progress)(from + (to - from) * *done / self.points as f64);
        };
        let result = work(&tell);
        // Points that were noted before have reported nothing.
        tell(points as f64 - told.get());
        result
    }
}
