//! What a scene ends in over the friction coefficient, followed upwards and downwards: the paper's
//! "pseudo-continuation" (Figs. 6 and 7).
//!
//! The first value upwards starts at rest, the first downwards as the scene says; each other one from the state in
//! which the one before has ended. All with a small push. The paper pushes where µ
//! rises, out of an equilibrium that has become unstable. Here falling values are pushed too: a cycle that has lost
//! its stability would else be followed for as long as rounding takes to grow.

use super::Watch;
use super::ending::{Ending, settle};
use super::journal::Journal;
use super::look::Look;
use super::push::Push;
use crate::Error;
use crate::scene::Scene;
use crate::simulation::{Progress, Simulation, Snapshot, assign};
use crate::stability::parallel::collect;
use crate::sweep::FRICTION;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Amplitudes that differ by more than this part, from one value to the next or between the branches, may be of
/// different motions.
const OTHER_AMPLITUDE: f64 = 0.05;
/// Frequencies that do.
const OTHER_FREQUENCY: f64 = 0.02;
/// What another kind adds: with nothing else it is no other motion, as a second frequency may come and go gently.
const OTHER_KIND: f64 = 0.8 * OTHER_AMPLITUDE;
/// What is left of a jump where its bounds have come together, in parts of what it was; a slope leaves less.
const LEFT: f64 = 0.5;

/// Which way µ goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// From the first value to the last.
    Rising,
    /// From the last value to the first.
    Falling,
}

impl Way {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Rising, Self::Falling];

    /// As tables and the journal have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rising => "rising",
            Self::Falling => "falling",
        }
    }
}

/// What is to be followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan<'a> {
    /// The scene, with the method and step that are to be used.
    pub scene: &'a Scene,
    /// How its motions are looked at.
    pub look: &'a Look,
    /// Values of µ, ascending.
    pub values: &'a [f64],
    /// How far apart the bounds of a fold are in the end, in µ.
    pub resolution: f64,
    /// The push that each value starts with.
    pub push: Push,
}

/// A value of µ on one of the ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// µ.
    pub friction: f64,
    /// What the motion ends in, or why it has failed; after a failure a way is not followed further.
    pub ending: Result<Ending, String>,
}

/// Where one motion gives way to another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fold {
    /// Which way µ goes.
    pub way: Way,
    /// The last µ that still has the motion, and the first that has it no more.
    pub between: [f64; 2],
    /// The motion there, before and after.
    pub endings: [Ending; 2],
}

impl Fold {
    /// The middle of its bounds.
    #[must_use]
    pub fn at(&self) -> f64 {
        0.5 * (self.between[0] + self.between[1])
    }
}

/// A range of µ in which the two ways end in different motions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bistable {
    /// From and to, by the folds that bound it or, where it reaches the ends of what was followed, those values.
    pub range: [f64; 2],
    /// Is an end of it bounded by a fold?
    pub bounded: [bool; 2],
    /// Is one of the two motions rest?
    pub rests: bool,
}

/// What was followed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Continuation {
    /// By ascending µ.
    pub rising: Vec<Point>,
    /// By ascending µ too.
    pub falling: Vec<Point>,
    /// By ascending µ, rising ones first.
    pub folds: Vec<Fold>,
    /// By ascending µ.
    pub bistable: Vec<Bistable>,
}

/// A piece of the work: what was found, and the state from which the next value starts.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Piece {
    ending: Result<Ending, String>,
    progress: Option<Progress>,
}

/// Where a value starts.
#[derive(Clone, Copy)]
enum Start<'a> {
    /// In the state that the value before has ended in.
    State(&'a Progress),
    /// The first of a way: upwards at rest, downwards as the scene says, which may be in a cycle.
    Scene(Way),
}

/// A value of a way with the state that it has ended in.
#[derive(Clone)]
struct Reached {
    point: Point,
    progress: Option<Progress>,
}

/// Follows both ways, then refines the folds, on all cores. `None` if the watch ended it; what was finished is in
/// the journal.
///
/// # Errors
/// A scene without a common friction coefficient, a value that µ cannot have, or a journal that cannot be written.
pub fn continuation(
    plan: &Plan<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Continuation>, Error> {
    for value in plan.values {
        assign(&mut plan.scene.clone(), FRICTION, *value)?;
    }
    let done = AtomicUsize::new(0);
    // Two ways, and what folds take: about a tenth.
    #[allow(clippy::cast_precision_loss)]
    let all = 2.2 * plan.values.len() as f64;
    #[allow(clippy::cast_precision_loss)]
    let step_done = || (watch.progress)(done.fetch_add(1, Ordering::Relaxed) as f64 / all);
    let ways = collect(2, &|i| plan.follow(Way::ALL[i], journal, watch, &step_done), &|_| {})?;
    let Some(ways) = ways.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
    let jumps: Vec<(Way, &[Reached])> = Way::ALL
        .into_iter()
        .zip(&ways)
        .flat_map(|(way, reached)| reached.windows(2).map(move |two| (way, two)))
        .filter(|(_, two)| differ(&two[0].point, &two[1].point))
        .collect();
    let refine = |i: usize| plan.refine(jumps[i].0, jumps[i].1, journal, watch);
    let folds = collect(jumps.len(), &refine, &|_| {})?;
    let Some(folds) = folds.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
    let mut folds: Vec<Fold> = folds.into_iter().flatten().collect();
    folds.sort_by(|a, b| (a.way as u8).cmp(&(b.way as u8)).then(a.at().total_cmp(&b.at())));
    let [rising, falling] = <[_; 2]>::try_from(ways).unwrap_or_default();
    let rising: Vec<Point> = rising.into_iter().map(|reached| reached.point).collect();
    let falling: Vec<Point> = falling.into_iter().rev().map(|reached| reached.point).collect();
    let bistable = bistable(&rising, &falling, &folds);
    Ok(Some(Continuation { rising, falling, folds, bistable }))
}

impl Plan<'_> {
    /// All values of one way, in its order, as far as it goes.
    fn follow(
        &self,
        way: Way,
        journal: &Journal,
        watch: Watch<'_>,
        step_done: &dyn Fn(),
    ) -> Result<Option<Vec<Reached>>, Error> {
        let mut values = self.values.to_vec();
        if way == Way::Falling {
            values.reverse();
        }
        let mut reached: Vec<Reached> = Vec::with_capacity(values.len());
        for value in values {
            let before = reached.last().and_then(|last| last.progress.as_ref());
            let key = format!("{} {value:?}", way.name());
            let start = before.map_or(Start::Scene(way), Start::State);
            let Some(next) = self.reach(&key, value, start, journal, watch)? else {
                return Ok(None);
            };
            let has_failed = next.progress.is_none();
            reached.push(next);
            step_done();
            if has_failed {
                break;
            }
        }
        Ok(Some(reached))
    }

    /// One value, from where it starts.
    fn reach(
        &self,
        key: &str,
        friction: f64,
        start: Start<'_>,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Reached>, Error> {
        let work = || match self.run(friction, start, watch) {
            Ok(None) => Ok(None),
            Ok(Some((ending, progress))) => {
                Ok(Some(Piece { ending: Ok(ending), progress: Some(progress) }))
            }
            // A finding, not the end of the study.
            Err(error) => Ok(Some(Piece { ending: Err(error.to_string()), progress: None })),
        };
        let piece = journal.piece(key, work)?;
        Ok(piece.map(|Piece { ending, progress }| Reached {
            point: Point { friction, ending },
            progress,
        }))
    }

    fn run(
        &self,
        friction: f64,
        start: Start<'_>,
        watch: Watch<'_>,
    ) -> Result<Option<(Ending, Progress)>, Error> {
        let mut scene = self.scene.clone();
        assign(&mut scene, FRICTION, friction)?;
        let mut simulation = match start {
            Start::State(progress) => Simulation::resume(Snapshot::new(scene, progress.clone()))?,
            Start::Scene(Way::Falling) => Simulation::new(scene, 0.0)?,
            Start::Scene(Way::Rising) => {
                scene.rest();
                Simulation::new(scene, 0.0)?
            }
        };
        self.push.give(&mut simulation);
        let ending = settle(&mut simulation, self.look, &|| watch.is_over())?;
        Ok(ending.map(|ending| (ending, simulation.save().into_progress())))
    }

    /// Brings the bounds of a jump together, from the state of the value that still has the motion. `None` inside
    /// where nothing is left of the jump: there the motion changes steeply, but as one.
    fn refine(
        &self,
        way: Way,
        two: &[Reached],
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Option<Fold>>, Error> {
        let [first, last] = two else { return Ok(Some(None)) };
        let (Ok(first_ending), Ok(last_ending)) = (&first.point.ending, &last.point.ending) else {
            return Ok(Some(None));
        };
        let Some(mut state) = first.progress.clone() else { return Ok(Some(None)) };
        let mut between = [first.point.friction, last.point.friction];
        let mut endings = [first_ending.clone(), last_ending.clone()];
        let whole = distance(first_ending, last_ending);
        while (between[1] - between[0]).abs() > self.resolution {
            let middle = 0.5 * (between[0] + between[1]);
            // No double lies between them.
            if between.contains(&middle) {
                break;
            }
            if watch.is_over() {
                return Ok(None);
            }
            let key = format!("{} fold {middle:?}", way.name());
            let Some(reached) = self.reach(&key, middle, Start::State(&state), journal, watch)?
            else {
                return Ok(None);
            };
            let (Ok(ending), Some(progress)) = (reached.point.ending, reached.progress) else {
                return Ok(Some(None));
            };
            if distance(&endings[0], &ending) <= distance(&ending, &endings[1]) {
                (between[0], endings[0], state) = (middle, ending, progress);
            } else {
                (between[1], endings[1]) = (middle, ending);
            }
        }
        let left = distance(&endings[0], &endings[1]);
        let is_left = left > LEFT * whole && left > OTHER_AMPLITUDE;
        Ok(Some(is_left.then_some(Fold { way, between, endings })))
    }
}

/// How different two motions are: 0 for the same; one rests and the other does not: as far as can be.
fn distance(a: &Ending, b: &Ending) -> f64 {
    const REST: f64 = 10.0;
    match (a.rests(), b.rests()) {
        (true, true) => 0.0,
        (true, false) | (false, true) => REST,
        (false, false) => {
            // One output may be zero throughout, and the whole may hide what one output shows.
            let log =
                |a: f64, b: f64| if a > 0.0 && b > 0.0 { libm::log(a / b).abs() } else { 0.0 };
            let ratio = log(a.size, b.size).max(log(a.amplitude, b.amplitude));
            let pitch = match (a.frequency, b.frequency) {
                (Some(a), Some(b)) => libm::log(a / b).abs(),
                (None, None) => 0.0,
                _ => 1.0,
            };
            // Frequencies change less than amplitudes where motions are the same.
            let kind = if a.kind == b.kind { 0.0 } else { OTHER_KIND };
            ratio + pitch * OTHER_AMPLITUDE / OTHER_FREQUENCY + kind
        }
    }
}

/// Are two points known to have different motions?
fn differ(a: &Point, b: &Point) -> bool {
    match (&a.ending, &b.ending) {
        (Ok(a), Ok(b)) => a.is_known() && b.is_known() && distance(a, b) > OTHER_AMPLITUDE,
        _ => false,
    }
}

/// Where the two ways end in different motions, the ends by the folds.
fn bistable(rising: &[Point], falling: &[Point], folds: &[Fold]) -> Vec<Bistable> {
    // A way that failed is shorter, at its end: rising ones lack the last values, falling ones the first.
    let pairs: Vec<(&Point, &Point)> = rising
        .iter()
        .filter_map(|up| {
            let down = falling.iter().find(|down| down.friction == up.friction)?;
            Some((up, down))
        })
        .collect();
    let mut found = Vec::new();
    let mut place = 0_usize;
    let rests = |point: &Point| point.ending.as_ref().is_ok_and(Ending::rests);
    let kind = |(up, down): &(&Point, &Point)| (differ(up, down), rests(up) != rests(down));
    for run in pairs.chunk_by(|a, b| kind(a) == kind(b)) {
        let (before, after) = (place.checked_sub(1), place + run.len());
        place = after;
        let (first, last) = (run[0], run[run.len() - 1]);
        if !differ(first.0, first.1) {
            continue;
        }
        // From the last value where both ways agree up to the first where they do not.
        let fold_between = |from: Option<&(&Point, &Point)>, to: Option<&(&Point, &Point)>| {
            let (from, to) = (from?.0.friction, to?.0.friction);
            let inside = |fold: &&Fold| (from..=to).contains(&fold.at());
            folds.iter().find(inside).map(Fold::at)
        };
        let low = fold_between(before.and_then(|i| pairs.get(i)), Some(&first));
        let high = fold_between(Some(&last), pairs.get(after));
        found.push(Bistable {
            range: [low.unwrap_or(first.0.friction), high.unwrap_or(last.0.friction)],
            bounded: [low.is_some(), high.is_some()],
            rests: kind(&first).1,
        });
    }
    found
}
