//! The rows of a run by stretches of time in which no contact changes its state and no signal has an edge.

use amontons::contact::ContactState;
use amontons::numerics::max_norm;
use amontons::scene::{Shape, Signal};

/// The most rows that are kept of a stretch; of a longer one every other row is kept, every fourth one, ….
const MOST_ROWS: usize = 512;

/// A stretch of time that the modes explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExplainedInterval {
    /// Beginning and end of the stretch, s.
    pub(super) span: [f64; 2],
    /// `true` if it begins with the run or at an edge of a signal, and not where a contact has changed its state.
    pub(super) is_woken: bool,
    /// `true` if contacts hold all masses on surfaces that stand still, so that nothing can grow or decay.
    pub(super) rests: bool,
}

/// The signals that drive a run.
pub(super) struct Drives {
    /// The frequencies of the sines among the signals, Hz, each once.
    pub(super) frequencies: Vec<f64>,
    shapes: Vec<Shape>,
    /// The first time (s) that has not been passed at which a signal jumps or has a corner.
    pub(super) next_edge: f64,
}

impl Drives {
    pub(super) fn of(signals: &[Signal]) -> Self {
        let mut frequencies: Vec<f64> = signals.iter().filter_map(Signal::frequency).collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies.dedup();
        let shapes: Vec<Shape> = signals.iter().map(|signal| signal.shape.clone()).collect();
        Self { frequencies, next_edge: next_edge(&shapes, 0.0), shapes }
    }

    /// `true` if a time (s) is beyond an edge that no time before it was beyond.
    pub(super) fn passes_edge(&mut self, time: f64) -> bool {
        // A row at an edge is the last one before it.
        let reached = time * (1.0 - 1e-12);
        let passes = self.next_edge < reached;
        if passes {
            self.next_edge = next_edge(&self.shapes, reached);
        }
        passes
    }
}

/// The first time (s) after `time` at which one of the shapes jumps or has a corner.
fn next_edge(shapes: &[Shape], time: f64) -> f64 {
    shapes.iter().map(|shape| shape.next_edge(time, 0.0)).fold(f64::INFINITY, f64::min)
}

/// The rows of one stretch.
pub(super) struct Rows {
    pub(super) states: Vec<ContactState>,
    /// Changes of state up to here.
    pub(super) changes: u64,
    /// `true` if it begins with the run or at an edge of a signal.
    pub(super) is_woken: bool,
    pub(super) first: usize,
    pub(super) last: usize,
    /// The first rows: all, every other one, every fourth one, …
    pub(super) levels: Vec<Level>,
}

/// Rows from the beginning of a stretch: every `step`-th is kept, until there are [`MOST_ROWS`].
pub(super) struct Level {
    pub(super) step: usize,
    /// Displacements, then velocities.
    pub(super) kept: Vec<Vec<f64>>,
}

impl Rows {
    pub(super) fn of(states: &[ContactState], changes: u64, is_woken: bool, first: usize) -> Self {
        let levels = vec![Level { step: 1, kept: Vec::new() }];
        Self { states: states.to_vec(), changes, is_woken, first, last: first, levels }
    }

    /// The stretch as a span that the modes explain, with rows each `interval`, s. The time between two stretches
    /// belongs to the second.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn explained(&self, interval: f64) -> ExplainedInterval {
        let span = [self.first.saturating_sub(1), self.last].map(|row| row as f64 * interval);
        ExplainedInterval { span, is_woken: self.is_woken, rests: false }
    }

    /// The largest velocity of a degree of freedom in the last row that is kept, m/s.
    pub(super) fn fastest(&self) -> f64 {
        let last = self.levels.last().and_then(|level| level.kept.last());
        last.map_or(0.0, |kept| max_norm(&kept[kept.len() / 2..]))
    }

    pub(super) fn push(&mut self, row: usize, displacement: &[f64], velocity: &[f64]) {
        self.last = row;
        let [.., coarsest] = &mut self.levels[..] else { return };
        if coarsest.kept.len() == MOST_ROWS {
            let (step, every_other) = (2 * coarsest.step, coarsest.kept.iter().step_by(2));
            let kept = every_other.cloned().collect();
            self.levels.push(Level { step, kept });
        }
        let [.., coarsest] = &mut self.levels[..] else { return };
        if (row - self.first).is_multiple_of(coarsest.step) {
            coarsest.kept.push([displacement, velocity].concat());
        }
    }
}
