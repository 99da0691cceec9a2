//! Following a motion from one value of µ to the next.

use super::Plan;
use super::findings::{Jump, Point, SweepDirection};
use super::followed::{Followed, Reached, is_known, is_open};
use crate::assign::assign;
use crate::journal::Journal;
use crate::study::Watch;
use crate::study::difference::{are_two, have_other_kinds};
use crate::study::long_term::{Kind, LongTermMotion};
use crate::study::push::Push;
use crate::study::settling::run_to_steady_state;
use crate::sweep::FRICTION;
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::{Parameters, Progress, Simulation, Snapshot};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::ControlFlow::{Break, Continue};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A motion that has not settled and in which contacts change their states is followed for this many times longer.
const MORE_TIMES: usize = 2;
/// One cycle that changes steeply is told from two by a change of µ that is this part of the resolution. Where a
/// motion is followed closely, changes by 0.5 % and not only by 5 % count, and a change of µ by the square of this
/// part tells.
const STEEP: f64 = 1.0 / 16.0;

/// The largest step of a way that is followed closely, in parts of the step between two values that were asked for.
const CLOSELY: f64 = 1.0 / 8.0;

/// Number of rows that a motion may take from a value that it has passed to another one at which it is compared.
const ROWS_BETWEEN: u64 = 10_000_000;

/// The part of a push that a cycle is given which does not survive the whole one.
const SMALLER: f64 = 1e-3;
/// Time that such a cycle is given, in parts of the time that the whole push took to end it.
const WAITS: f64 = 2.0;

/// A piece of the work: the ending that was found, and the state from which the next value starts.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Piece {
    ending: Result<LongTermMotion, String>,
    progress: Option<Progress>,
}

/// The state that a value starts in.
#[derive(Clone, Copy)]
pub(super) enum Start<'a> {
    /// The state in which another value has ended.
    From(&'a Reached),
    /// The state of the first value of a way: upwards at rest, downwards as the scene says, which may be in a cycle.
    Scene(SweepDirection),
}

/// A plan on its way.
pub(super) struct PlanRun<'a> {
    pub(super) plan: &'a Plan<'a>,
    pub(super) journal: &'a Journal,
    pub(super) watch: Watch<'a>,
    /// The rows of each run so far, by what the journal calls it.
    rows: Mutex<HashMap<String, u64>>,
}

impl<'a> PlanRun<'a> {
    pub(super) fn new(plan: &'a Plan<'a>, journal: &'a Journal, watch: Watch<'a>) -> Self {
        Self { plan, journal, watch, rows: Mutex::default() }
    }

    /// Number of rows that all runs so far have taken, those in the journal from before included: a measure of work
    /// that is the same on every machine while no run is on its way.
    pub(super) fn rows(&self) -> u64 {
        self.rows_by_key().values().sum()
    }

    fn rows_by_key(&self) -> MutexGuard<'_, HashMap<String, u64>> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of rows that a run has taken.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn rows_of(&self, ending: &Result<LongTermMotion, String>) -> u64 {
        ending
            .as_ref()
            .map_or(1, |ending| (ending.time / self.plan.observation.interval).ceil() as u64)
    }

    /// `true` of a scene that starts anywhere else than in its equilibrium.
    pub(super) fn has_own_start(&self) -> bool {
        Push::of_resting(self.plan.scene).is_none()
    }

    /// The values that are asked for, in the order of a way.
    pub(super) fn values(&self, way: SweepDirection) -> Vec<f64> {
        let values = self.plan.values.iter().copied();
        match way {
            SweepDirection::Rising => values.collect(),
            SweepDirection::Falling => values.rev().collect(),
        }
    }

    /// All values of one way, in its order, as far as it goes.
    pub(super) fn follow(
        &self,
        way: SweepDirection,
        step_done: &dyn Fn(),
    ) -> Result<Option<Followed>, Error> {
        let values = self.values(way);
        let label = way.name().to_owned();
        let Some(first) = self.reach(&label, values[0], Start::Scene(way))? else {
            return Ok(None);
        };
        let mut followed = Followed::way(way, label, first);
        step_done();
        let is_done = self.advance_through(&mut followed, &values[1..], |followed| {
            step_done();
            followed.can_continue()
        })?;
        Ok(is_done.then_some(followed))
    }

    /// Follows a motion through values, as far as it goes and as long as it is to; `can_continue` is asked after each
    /// value. `false` if the watch ended it.
    pub(super) fn advance_through(
        &self,
        followed: &mut Followed,
        values: &[f64],
        can_continue: impl Fn(&Followed) -> bool,
    ) -> Result<bool, Error> {
        if !followed.can_continue() {
            return Ok(true);
        }
        for value in values {
            if !self.advance(followed, *value)? {
                return Ok(false);
            }
            if !can_continue(followed) {
                break;
            }
        }
        Ok(true)
    }

    /// Follows a way from the last value that it has passed to another one. The change of µ is halved wherever the
    /// motion gives way to another, until it stays or the change is as small as the resolution. `false` if the watch
    /// ended it.
    pub(super) fn advance(&self, followed: &mut Followed, to: f64) -> Result<bool, Error> {
        let resolution = self.plan.resolution * (1.0 + 1e-9);
        let way = followed.way;
        let Some(mut here) = followed.passed.last().cloned() else { return Ok(true) };
        let whole = to - here.point.friction;
        let most = if followed.looks_closely { CLOSELY * whole.abs() } else { whole.abs() };
        let mut step = whole.clamp(-most, most);
        loop {
            let from = here.point.friction;
            let is_whole = step.abs() >= (to - from).abs() * (1.0 - 1e-9);
            let target = if is_whole { to } else { from + step };
            if followed.rows_left == 0 {
                followed.passed.push(Reached::not_tried(target));
                return Ok(true);
            }
            let Some(next) = self.reach(&followed.label, target, Start::From(&here))? else {
                return Ok(false);
            };
            followed.rows_left =
                followed.rows_left.saturating_sub(self.rows_of(&next.point.ending));
            let stays = matches!((here.ending(), next.ending()), (Some(a), Some(b)) if followed.stays(a, b));
            let half = 0.5 * (target - from);
            // A cycle of another kind may be another cycle that looks alike: a small change tells.
            let has_other_kind = !followed.is_leaving
                && matches!((here.ending(), next.ending()), (Some(a), Some(b)) if have_other_kinds(a, b));
            // Rest is left at once; a cycle may change steeply, which a smaller change shows.
            let leaves_cycle = here.is_cycle();
            let is_of_cycles = leaves_cycle && next.is_cycle();
            let smallest = if leaves_cycle && followed.looks_closely {
                STEEP * STEEP * resolution
            } else if leaves_cycle {
                STEEP * resolution
            } else {
                resolution
            };
            // No double lies between them where half of the change is nothing.
            let is_coarse = !stays || is_of_cycles && has_other_kind;
            if is_coarse
                && half.abs() >= 0.5 * smallest
                && from + half != target
                && from + half != from
            {
                step = half;
                continue;
            }
            if let (Some(before), Some(after)) = (here.ending(), next.ending()) {
                if !stays {
                    let (between, endings) = ([from, target], [before.clone(), after.clone()]);
                    let is_end = !followed.is_way();
                    followed.jumps.push(Jump { way, among: Some(way), is_end, between, endings });
                    if let Some(beyond) = &mut followed.beyond {
                        beyond.push(next);
                        return Ok(true);
                    }
                }
                // A motion that has left another one and not yet settled may become any motion.
                followed.is_leaving = (followed.is_leaving || !stays) && is_open(after);
            }
            let next_step = if stays { 2.0 * step } else { to - target };
            step = next_step.clamp(-most, most);
            let is_over = target == to || next.progress.is_none();
            followed.passed.push(next.clone());
            if is_over {
                return Ok(true);
            }
            here = next;
        }
    }

    /// Follows a motion to one value from the state in which it starts.
    pub(super) fn reach(
        &self,
        label: &str,
        friction: f64,
        start: Start<'_>,
    ) -> Result<Option<Reached>, Error> {
        let key = match start {
            Start::Scene(_) => format!("{label} {friction:?}"),
            Start::From(from) => format!("{label} {friction:?} from {:?}", from.point.friction),
        };
        let work = || match self.run(friction, start) {
            Ok(None) => Ok(None),
            Ok(Some((ending, progress))) => {
                Ok(Some(Piece { ending: Ok(ending), progress: Some(progress) }))
            }
            // A finding, not the end of the study.
            Err(error) => Ok(Some(Piece { ending: Err(error.to_string()), progress: None })),
        };
        let piece: Option<Piece> = self.journal.piece(&key, work)?;
        if let Some(piece) = &piece {
            self.rows_by_key().insert(key, self.rows_of(&piece.ending));
        }
        Ok(piece.map(|Piece { ending, progress }| Reached {
            point: Point { friction, ending },
            progress,
        }))
    }

    /// A motion at a value, from where it was.
    pub(super) fn resume(&self, friction: f64, progress: Progress) -> Result<Simulation, Error> {
        Simulation::resume(Snapshot::new(Parameters::of(self.scene(friction)?), progress))
    }

    fn scene(&self, friction: f64) -> Result<Scene, Error> {
        let mut scene = self.plan.scene.clone();
        assign(&mut scene, FRICTION, friction)?;
        Ok(scene)
    }

    /// The scene in its equilibrium at a value.
    pub(super) fn at_rest(&self, friction: f64) -> Result<Simulation, Error> {
        let mut scene = self.scene(friction)?;
        scene.rest();
        Simulation::new(scene, 0.0)
    }

    fn run(
        &self,
        friction: f64,
        start: Start<'_>,
    ) -> Result<Option<(LongTermMotion, Progress)>, Error> {
        let mut simulation = match start {
            Start::Scene(SweepDirection::Falling) => Simulation::new(self.scene(friction)?, 0.0)?,
            Start::From(Reached { point, progress: Some(progress) })
                if !point.ending.as_ref().is_ok_and(has_no_state) =>
            {
                self.resume(friction, progress.clone())?
            }
            // An equilibrium moves with µ; a motion that rests follows it, and one that grows without bound has no state to
            // begin with.
            Start::Scene(SweepDirection::Rising) | Start::From(_) => self.at_rest(friction)?,
        };
        self.plan.push.give(&mut simulation);
        let mut ending =
            run_to_steady_state(&mut simulation, self.plan.observation, &|| self.watch.is_over())?;
        // A motion that drifts slowly to another one would else drift on with each further value, and no jump be seen.
        for _ in 0..MORE_TIMES {
            match &ending {
                Some(drifts) if is_drifting(drifts) => {
                    ending = run_to_steady_state(&mut simulation, self.plan.observation, &|| {
                        self.watch.is_over()
                    })?;
                }
                _ => break,
            }
        }
        if let (Some(ending), Start::From(reached)) = (&ending, start) {
            let is_small =
                (friction - reached.point.friction).abs() <= self.plan.resolution * (1.0 + 1e-9);
            if is_small && let Some(stayed) = self.stay(friction, reached, ending)? {
                return Ok(Some(stayed));
            }
        }
        Ok(ending.map(|ending| (ending, simulation.save().into_progress())))
    }

    /// Follows a cycle that a push has ended after a much smaller push, to see if it stays: near its end it may
    /// survive no larger one. A motion that leaves the cycle whatever the push is given time to do so.
    fn stay(
        &self,
        friction: f64,
        from: &Reached,
        ending: &LongTermMotion,
    ) -> Result<Option<(LongTermMotion, Progress)>, Error> {
        let (Some(before), Some(progress)) = (from.ending(), &from.progress) else {
            return Ok(None);
        };
        if !before.kind.is_cycle() || !are_two(before, ending) {
            return Ok(None);
        }
        let mut simulation = self.resume(friction, progress.clone())?;
        self.plan.push.give_part(&mut simulation, SMALLER);
        let interval = self.plan.observation.interval;
        let first = (simulation.time() / interval).round();
        let rows = (WAITS * ending.time / interval).ceil();
        let go_on = || if self.watch.is_over() { Break(()) } else { Continue(()) };
        if simulation.advance_while((first + rows) * interval, go_on)?.is_break() {
            return Ok(None);
        }
        let after =
            run_to_steady_state(&mut simulation, self.plan.observation, &|| self.watch.is_over())?;
        let stays = |after: &LongTermMotion| !are_two(before, after);
        Ok(after.filter(stays).map(|after| (after, simulation.save().into_progress())))
    }

    /// The motion of a way at a value, from the nearest one that it has passed; `None` inside where it is not known.
    #[allow(clippy::type_complexity)]
    pub(super) fn reached(
        &self,
        friction: f64,
        followed: &Followed,
    ) -> Result<Option<Option<(LongTermMotion, Progress)>>, Error> {
        let Some(start) = followed.nearest(friction) else { return Ok(Some(None)) };
        let from = start.point.friction;
        let label = format!("{}, compared at {friction:?}:", followed.label);
        let rows = if followed.is_way() { u64::MAX } else { ROWS_BETWEEN };
        let there = Followed::motion(followed.way, label, start, rows);
        let mut there = Followed { is_leaving: false, ..there };
        if from != friction && !self.advance(&mut there, friction)? {
            return Ok(None);
        }
        let Some(Reached { point: Point { ending: Ok(ending), .. }, progress: Some(progress) }) =
            there.passed.pop()
        else {
            return Ok(Some(None));
        };
        Ok(Some((is_known(&ending) && there.jumps.is_empty()).then_some((ending, progress))))
    }
}

/// `true` if contacts change their states in the motion and it has not settled, or has not come back as near as a
/// periodic one does.
fn is_drifting(ending: &LongTermMotion) -> bool {
    let is_open = ending.kind == Kind::Unsettled
        || ending.kind == Kind::Undecided && ending.closure.is_some();
    is_open && !ending.linear
}

/// `true` of a motion after which the next value starts in its own equilibrium.
fn has_no_state(ending: &LongTermMotion) -> bool {
    ending.rests() || ending.kind == Kind::Unbounded
}
