//! What a peer hands over: runs to be timed, and what came out of one.

use crate::scenes::ROWS;
use std::time::Instant;

/// One simulated second, made once more each time that it is called.
pub type Run = Box<dyn FnMut() -> Outcome>;

/// A program with one setting.
pub struct Candidate {
    pub who: &'static str,
    pub setting: String,
    pub run: Run,
}

/// What came out of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The displacements, m, row by row, one row a millisecond.
    pub displacements: Vec<f64>,
    /// Changes of a contact's state; `None` where the peer does not say.
    pub events: Option<u64>,
    /// How many of them closed a gap.
    pub touch_downs: Option<u64>,
    /// Time without set-up, s, slice by slice.
    pub slices: Vec<f64>,
}

/// Rows in a slice. Other work on the machine makes a time longer, never shorter; slices are short, so each
/// of them runs undisturbed in one turn or another, and the shortest of each make a run.
const SLICE: usize = 20;

/// Measures slices.
pub struct Stopwatch {
    last: Instant,
    slices: Vec<f64>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { last: Instant::now(), slices: Vec::with_capacity(ROWS / SLICE) }
    }

    /// Row `row`, counted from 1, is there.
    pub fn row(&mut self, row: usize) {
        if row.is_multiple_of(SLICE) {
            let now = Instant::now();
            self.slices.push((now - self.last).as_secs_f64());
            self.last = now;
        }
    }

    pub fn slices(self) -> Vec<f64> {
        self.slices
    }
}
