//! Reports of a run that violated the idealisations of its scene, or met several solutions of the law of contact.

use super::Simulation;
use crate::error::Short;
use crate::integrator::Statistics;

/// All such violations since the start, in words; empty if there are none.
#[must_use]
pub fn broken_assumptions(simulation: &Simulation) -> Vec<String> {
    newly_broken(simulation, Statistics::default())
}

/// Those violations, in words, that have occurred since the counters were `before`, and not earlier.
#[inline]
pub(crate) fn newly_broken(simulation: &Simulation, before: Statistics) -> Vec<String> {
    let now = simulation.statistics();
    let has_slipped = before.reversed_slips == 0 && now.reversed_slips > 0;
    let has_pulled = before.pulled_contacts == 0 && now.pulled_contacts > 0;
    let has_others = before.other_solutions == 0 && now.other_solutions > 0;
    // Most short steps have no violation.
    if has_slipped || has_pulled || has_others {
        words(simulation, [has_slipped, has_pulled, has_others])
    } else {
        Vec::new()
    }
}

#[cold]
fn words(simulation: &Simulation, [has_slipped, has_pulled, has_others]: [bool; 3]) -> Vec<String> {
    let Statistics { reversed_slips, pulled_contacts, other_solutions, .. } =
        simulation.statistics();
    let time = Short(simulation.time());
    let slips = has_slipped.then(|| {
        format!(
            "up to {time} s masses slipped against the fixed direction of friction \
             (statistics.reversed_slips = {reversed_slips}), so that contacts that can stick would move \
             differently; remove `sticking = false` from the scene"
        )
    });
    let pulls = has_pulled.then(|| {
        format!(
            "up to {time} s contacts that cannot open had to pull \
             (statistics.pulled_contacts = {pulled_contacts}), so that contacts that can open would move \
             differently; remove `detachment = false` from the scene"
        )
    });
    let others = has_others.then(|| {
        format!(
            "up to {time} s the law of contact had more than one solution (number of cases: {other_solutions}): \
             each contact kept its state as long as the law allowed it; other motions are possible too, and \
             another program may compute one of them"
        )
    });
    slips.into_iter().chain(pulls).chain(others).collect()
}
