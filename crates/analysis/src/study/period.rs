//! Quantities of a settled motion over one period or, without one, over a window, found from the motion itself.

use crate::spectral::{Lines, lines};
use crate::sweep::passage::Passage;
use amontons::Error;
use amontons::simulation::{Simulation, Variable};

/// The fewest rows of such a span.
const FEWEST_ROWS: f64 = 1000.0;
/// Periods in which the lines of a periodic motion are looked for, of one with many rows fewer of them, and the most rows of all
/// of them. Through the window of [`lines`] as many as the fewest still tell neighbouring multiples of the base frequency apart.
const PERIODS: usize = 16;
const FEWEST_PERIODS: usize = 8;
const MOST_REPEATED: usize = 2_000_000;

/// Quantities of a motion over a span of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OverSpan {
    /// Half of the difference between the output's largest and smallest value, in its unit.
    pub amplitude: f64,
    /// Half of the difference between the largest and the smallest displacement of each degree of freedom, m.
    pub extents: Vec<f64>,
    /// The part of the time for which contacts are in each state, in the order of
    /// [`ContactState::ALL`](amontons::contact::ContactState::ALL).
    pub shares: [f64; 4],
    /// The output at the end of each row, in its unit, and s between two of them.
    pub history: Vec<f64>,
    pub interval: f64,
}

impl OverSpan {
    /// The lines of a motion that repeats itself after the span: those of many periods, since one holds none that could be
    /// told from a drift. `None` of a span of very many rows.
    pub(super) fn lines_of_period(&self, floor: f64) -> Option<Lines> {
        let periods = (MOST_REPEATED / self.history.len().max(1)).min(PERIODS);
        let is_short = periods >= FEWEST_PERIODS;
        is_short.then(|| lines(&self.history.repeat(periods), self.interval, floor))
    }
}

/// Follows the motion of a simulation over a span (s) in rows of `interval` (s), or shorter ones.
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn over_span(
    simulation: &Simulation,
    output: &Variable,
    span: f64,
    interval: f64,
) -> Result<OverSpan, Error> {
    let mut simulation = Simulation::resume(simulation.save())?;
    let start = simulation.time();
    let rows = (span / interval).ceil().max(FEWEST_ROWS);
    let dofs = simulation.displacement().len();
    let outputs = std::slice::from_ref(output);
    let mut passage = Passage::new(simulation.scene(), outputs).with_displacements(dofs);
    passage.note(&mut simulation)?;
    let mut history = Vec::new();
    let mut row = 0.0;
    while row < rows {
        row += 1.0;
        simulation.advance_to(start + row / rows * span)?;
        passage.note(&mut simulation)?;
        history.push(simulation.read(output)?);
    }
    let mut amplitudes = passage.amplitudes();
    let amplitude = amplitudes.next().unwrap_or(0.0);
    let (extents, shares) = (amplitudes.collect(), passage.shares());
    Ok(OverSpan { amplitude, extents, shares, history, interval: span / rows })
}
