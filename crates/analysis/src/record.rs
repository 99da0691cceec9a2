//! A run of an experiment, row by row.

use crate::watch::Watch;
use amontons::Error;
use amontons::scene::Experiment;
use amontons::simulation::Simulation;

/// Number of rows between two checks of the watch.
const ROWS_AT_ONCE: usize = 64;

/// Runs an experiment from its start. At each row after that of the start `note` is given the simulation, the time
/// (s), and `true` if the row ends a whole interval. Returns `false` if the watch, to which the elapsed part of the
/// time is reported, ended the run.
///
/// # Errors
/// Returns an error if a step or `note` fails.
pub fn record_rows(
    simulation: &mut Simulation,
    experiment: Experiment,
    watch: Watch<'_>,
    mut note: impl FnMut(&mut Simulation, f64, bool) -> Result<(), Error>,
) -> Result<bool, Error> {
    for (row, (time, is_whole)) in experiment.row_times().enumerate() {
        if row.is_multiple_of(ROWS_AT_ONCE) && watch.ends_after(time / experiment.stop_time) {
            return Ok(false);
        }
        simulation.advance_to(time)?;
        note(simulation, time, is_whole)?;
    }
    Ok(true)
}
