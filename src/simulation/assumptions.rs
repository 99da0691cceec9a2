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
            "up to {time} s masses slipped against the direction that friction keeps in this scene \
             (statistics.reversed_slips = {reversed_slips}): the motion is not that of contacts that can \
             stick; leave `sticking = false` out"
        )
    });
    let pulls = has_pulled.then(|| {
        format!(
            "up to {time} s contacts had to pull that cannot open in this scene \
             (statistics.pulled_contacts = {pulled_contacts}): the motion is not that of contacts that can \
             open; leave `detachment = false` out"
        )
    });
    let others = has_others.then(|| {
        format!(
            "up to {time} s the law of contact had another solution besides the one that was taken, \
             {other_solutions} times: contacts stay in the states that they are in as long as the \
             law lets them; another motion is possible too, and another program may take it"
        )
    });
    slips.into_iter().chain(pulls).chain(others).collect()
}
