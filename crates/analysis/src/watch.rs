//! Progress of long work, and its end before it is done.

use amontons::Error;
use std::ops::ControlFlow;

/// The interface by which long work reports its progress and asks if it is over, from any of its threads.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Decides if the work continues; called often. After the first `Break` the work ends with the results so far.
    pub go_on: &'a (dyn Fn() -> ControlFlow<()> + Sync),
    /// Receives the part of the work that is done, from 0 to 1, at intervals.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Watch<'_> {
    /// A watch that never ends the work and ignores its progress.
    pub const IDLE: Watch<'static> =
        Watch { go_on: &|| ControlFlow::Continue(()), progress: &|_| {} };

    /// `true` if the work has been ended.
    #[must_use]
    pub fn is_over(&self) -> bool {
        (self.go_on)().is_break()
    }

    /// Refuses to begin more work after the end.
    ///
    /// # Errors
    /// Returns an error if the work has been ended.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_over() {
            Err(Error::analysis("the analysis was ended before it was done"))
        } else {
            Ok(())
        }
    }

    /// Returns a function that is given the number of finished pieces and reports it as a part of all `count` pieces.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn parts(&self, count: usize) -> impl Fn(usize) + Sync {
        move |done| (self.progress)(done as f64 / count as f64)
    }

    /// Reports that a part of the work, from 0 to 1, is done. `true` if the work has been ended.
    #[must_use]
    pub fn ends_after(&self, part: f64) -> bool {
        (self.progress)(part);
        self.is_over()
    }
}
