//! What a motion that has settled does over one period or, without one, over a window, found from the motion itself.

use crate::Error;
use crate::simulation::{Simulation, Variable};
use crate::sweep::passage::Passage;

/// The fewest rows of such a span.
const FEWEST_ROWS: f64 = 1000.0;

/// What a motion does over a span of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OverSpan {
    /// Half of the difference between the output's largest and smallest value, in its unit.
    pub amplitude: f64,
    /// Half of the difference between the largest and the smallest displacement of each degree of freedom, m.
    pub extents: Vec<f64>,
    /// The part of the time for which contacts are in each state, in the order of
    /// [`ContactState::ALL`](crate::contact::ContactState::ALL).
    pub shares: [f64; 4],
}

/// Follows the motion of a simulation over a span (s) in rows of `interval` (s), or shorter ones.
///
/// # Errors
/// A step fails.
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
    let mut row = 0.0;
    while row < rows {
        row += 1.0;
        simulation.advance_to(start + row / rows * span)?;
        passage.note(&mut simulation)?;
    }
    let mut amplitudes = passage.amplitudes();
    let amplitude = amplitudes.next().unwrap_or(0.0);
    Ok(OverSpan { amplitude, extents: amplitudes.collect(), shares: passage.shares() })
}
