//! The endings of a scene over the friction coefficient, followed upwards and downwards: the paper's
//! "pseudo-continuation" (Figs. 6 and 7).
//!
//! The first value upwards starts at rest, the first downwards as the scene says; each other one from the state in
//! which the one before has ended, or from its own equilibrium where that one rests. All start with a small push. The
//! paper pushes where µ rises, out of an equilibrium that has become unstable. Here falling values are pushed too: a
//! cycle that has lost its stability would else be followed for as long as rounding takes to grow.
//!
//! A change of µ is a push too. Where a motion gives way to another, the change is halved until the motion stays or the
//! change is as small as the resolution: only what a motion does not survive at that size is a jump. There a cycle that the
//! push has ended is run again with a thousandth of it, since a cycle near its end may survive no larger one. So jumps by
//! more than 5 % do not depend on the values of µ that are asked for. Smaller ones are found where the ways have two periodic motions
//! at one of these values.

mod findings;
mod follow;
mod followed;
mod motions;
mod ranges;
mod small_jumps;

pub use findings::{
    Bistable, Continuation, Jump, Point, RestAndMotion, SweepDirection, ThirdMotion,
};

use super::Watch;
use super::observation::ObservationSettings;
use super::push::Push;
use crate::assign::assign;
use crate::journal::Journal;
use crate::stability::candidates::Candidate;
use crate::stability::parallel::collect;
use crate::sweep::FRICTION;
use amontons::Error;
use amontons::scene::Scene;
use follow::PlanRun;
use followed::Followed;
use motions::{FoundMotions, MotionStart};
use ranges::Ranges;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Input of a continuation.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan<'a> {
    /// The scene, with the method and step that are to be used.
    pub scene: &'a Scene,
    /// Settings with which its motions are observed.
    pub observation: &'a ObservationSettings,
    /// Values of µ, ascending.
    pub values: &'a [f64],
    /// The size of a change of µ that a motion must survive, and the width of the bracket of a jump.
    pub resolution: f64,
    /// The push that each value starts with.
    pub push: Push,
    /// Candidates, in whose ranges of µ motions beside rest are examined by runs of their own.
    pub candidates: &'a [Candidate],
}

/// Follows both ways, each on a core, and all other motions that are met. `None` if the watch ended it; what was finished
/// is in the journal.
///
/// # Errors
/// Returns an error if the scene has no common friction coefficient or cannot start at either end, if µ cannot have a
/// value, or if the journal cannot be written.
pub fn continuation(
    plan: &Plan<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Continuation>, Error> {
    for value in plan.values {
        assign(&mut plan.scene.clone(), FRICTION, *value)?;
    }
    let done = AtomicUsize::new(0);
    let run = PlanRun::new(plan, journal, watch);
    // Two ways, the scene's own starts, and what these lead to: how much that is nobody knows before.
    let pieces = if run.has_own_start() { 4.0 } else { 2.5 };
    #[allow(clippy::cast_precision_loss)]
    let all = pieces * plan.values.len() as f64;
    #[allow(clippy::cast_precision_loss)]
    let step_done = || (watch.progress)(done.fetch_add(1, Ordering::Relaxed) as f64 / all);
    let ways = collect(2, &|i| run.follow(SweepDirection::ALL[i], &step_done), &|_| {})?;
    let Some(mut ways) = ways.into_iter().collect::<Option<Vec<Followed>>>() else {
        return Ok(None);
    };
    // Nothing was followed: a way ends at its first failure.
    if let [Err(failure), Err(_)] = [0, 1].map(|way: usize| &ways[way].passed[0].point.ending) {
        return Err(Error::scene(failure.clone()));
    }
    let Some(lost) = run.find_small_jumps(&mut ways)? else { return Ok(None) };
    let Some(own) = run.own_starts(&step_done)? else { return Ok(None) };
    let Some(rests) = run.rests(&ways)? else { return Ok(None) };
    let mut found = FoundMotions::new(ways, run.rows());
    let mut starts: Vec<MotionStart> = rests.into_iter().chain(own).map(MotionStart::own).collect();
    starts.extend(
        lost.into_iter()
            .map(|(place, reached)| MotionStart::met(reached, SweepDirection::ALL[place])),
    );
    starts.extend(found.ways_jumped_to());
    let Ranges { bistable, unknown, .. } = loop {
        if !run.follow_all(starts, &mut found)? {
            return Ok(None);
        }
        let Some(ranges) = run.compare(&found)? else { return Ok(None) };
        // A range may show a motion that none of the values has, whose ends are bounds of new ranges.
        starts = ranges.new.iter().cloned().map(MotionStart::own).collect();
        if starts.is_empty() {
            starts.extend(found.towards(&ranges.lone));
        }
        if starts.is_empty() || found.more {
            break ranges;
        }
    };
    let mut compared = Vec::new();
    for candidate in plan.candidates {
        let Some(both) = run.compare_inside(candidate, &bistable, &found)? else { return Ok(None) };
        compared.push(both);
    }
    let jumps = found.jumps(plan.values);
    let points =
        |at: &dyn Fn(f64) -> Option<Point>| plan.values.iter().filter_map(|v| at(*v)).collect();
    let rising = points(&|value| found.ways[0].at(value).map(|reached| reached.point.clone()));
    let falling = points(&|value| found.falling(value).map(|reached| reached.point.clone()));
    let more = found.more;
    Ok(Some(Continuation { rising, falling, jumps, bistable, unknown, more, compared }))
}
