//! What a scene ends in over the friction coefficient, followed upwards and downwards: the paper's
//! "pseudo-continuation" (Figs. 6 and 7).
//!
//! The first value upwards starts at rest, the first downwards as the scene says; each other one from the state in
//! which the one before has ended, or from its own equilibrium where that one rests. All start with a small push. The
//! paper pushes where µ rises, out of an equilibrium that has become unstable. Here falling values are pushed too: a
//! cycle that has lost its stability would else be followed for as long as rounding takes to grow.
//!
//! A change of µ is a push too. Where a motion gives way to another, the change is halved until the motion stays or the
//! change is as small as the resolution: only what a motion does not survive at that size is a jump. So jumps do not
//! depend on the values of µ that are asked for.

use super::Watch;
use super::difference::{OTHER_EXTENT, distance, have_other_kinds};
use super::ending::{Ending, Kind};
use super::journal::Journal;
use super::look::Look;
use super::push::Push;
use super::settling::settle;
use super::visit::visited;
use crate::Error;
use crate::contact::ContactState;
use crate::scene::Scene;
use crate::simulation::{Progress, Simulation, Snapshot, assign};
use crate::stability::candidates::Candidate;
use crate::stability::parallel::collect;
use crate::sweep::FRICTION;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A motion that has not settled and in which contacts change their states is followed for this many times longer.
const MORE_TIMES: usize = 2;
/// One cycle that changes steeply is told from two by a change of µ that is this part of the resolution.
const STEEP: f64 = 1.0 / 16.0;
/// Where both ways are compared inside a range of a candidate, in parts of it.
const COMPARED: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

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
    /// The size of a change of µ that a motion must survive, and the width of the bracket of a jump.
    pub resolution: f64,
    /// The push that each value starts with.
    pub push: Push,
    /// Candidates, in whose ranges of µ the motions of both ways are compared by runs of their own, wherever one of them
    /// is rest and the other is not.
    pub candidates: &'a [Candidate],
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
pub struct Jump {
    /// Which way µ goes.
    pub way: Way,
    /// The way whose values it lies among. The falling way, too, has jumps of rising µ: upper ends of motions that it has
    /// found below them.
    pub among: Way,
    /// The last µ that still has the motion, and the first that has it no more.
    pub between: [f64; 2],
    /// The motion there, before and after.
    pub endings: [Ending; 2],
}

impl Jump {
    /// The middle of its bounds.
    #[must_use]
    pub fn at(&self) -> f64 {
        0.5 * (self.between[0] + self.between[1])
    }
}

/// A range of µ in which the two ways end in different motions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bistable {
    /// From and to, by the jumps that bound it or, where it reaches the ends of what was followed, those values.
    pub range: [f64; 2],
    /// `true` for an end that is bounded by a jump.
    pub bounded: [bool; 2],
    /// `true` if one of the two motions is rest.
    pub rests: bool,
    /// The kinds of both, upwards and downwards; of what decays to rest that of rest.
    pub kinds: [Kind; 2],
    /// Where the scene's own start was seen to lead to a third motion.
    pub third: Option<Third>,
}

impl Bistable {
    /// Both motions in words, such as `rest and a cycle`.
    #[must_use]
    pub fn words(&self) -> String {
        words(self.kinds)
    }
}

/// A motion beside two others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Third {
    /// µ.
    pub friction: f64,
    /// The motion.
    pub ending: Ending,
}

/// Two motions in words, rest first and cycles before others.
fn words(kinds: [Kind; 2]) -> String {
    let one = |kind: Kind| match kind {
        Kind::Equilibrium => (0, "rest", "rest"),
        Kind::Periodic | Kind::QuasiPeriodic => (1, "a cycle", "two cycles"),
        Kind::Irregular => (2, "an irregular motion", "two irregular motions"),
        Kind::Undecided => (3, "an undecided motion", "two undecided motions"),
        Kind::Unsettled => {
            (4, "a motion that has not settled", "two motions that have not settled")
        }
        Kind::Unbounded => (5, "growth without bound", "growth without bound"),
    };
    let mut both = kinds.map(one);
    both.sort_unstable();
    let [first, second] = both;
    if first == second { first.2.to_owned() } else { format!("{} and {}", first.1, second.1) }
}

/// The motions of both ways at one value of µ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Both {
    /// µ.
    pub friction: f64,
    /// Upwards and downwards.
    pub endings: [Ending; 2],
    /// `true` of a motion in which contacts take the states of the candidate that it was looked at for.
    pub takes: [bool; 2],
}

/// What was followed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Continuation {
    /// By ascending µ.
    pub rising: Vec<Point>,
    /// By ascending µ too. The way begins from the scene's own start at the last value. Where both ways end in the same
    /// motion, the scene's start is tried as well, from high values to low ones; other motions that it leads to stand in
    /// place of that one, as far as they can be followed.
    pub falling: Vec<Point>,
    /// By ascending µ, rising ones first.
    pub jumps: Vec<Jump>,
    /// By ascending µ.
    pub bistable: Vec<Bistable>,
    /// Ranges of µ in which it is not known whether both ways end in the same motion, by ascending µ.
    pub unknown: Vec<[f64; 2]>,
    /// For each of [`Plan::candidates`] some values of µ in each part of it in which one way rests and the other does not.
    pub compared: Vec<Vec<Both>>,
}

/// A piece of the work: what was found, and the state from which the next value starts.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Piece {
    ending: Result<Ending, String>,
    progress: Option<Progress>,
}

/// The state that a value starts in.
#[derive(Clone, Copy)]
enum Start<'a> {
    /// That in which another value has ended.
    From(&'a Reached),
    /// That of the first value of a way: upwards at rest, downwards as the scene says, which may be in a cycle.
    Scene(Way),
}

/// A value of a way with the state that it has ended in.
#[derive(Clone)]
struct Reached {
    point: Point,
    progress: Option<Progress>,
}

impl Reached {
    fn ending(&self) -> Option<&Ending> {
        self.point.ending.as_ref().ok()
    }
}

/// A way as far as it was followed.
#[derive(Clone)]
struct Followed {
    way: Way,
    /// What the journal calls it, and nothing else: it knows a piece of work by that and the values of µ.
    label: String,
    /// All values that it has passed, in its order, those between the asked ones included.
    passed: Vec<Reached>,
    jumps: Vec<Jump>,
    /// `true` while the last motion is one that has left another at a jump and has not settled.
    is_leaving: bool,
}

/// All that was followed.
struct Found {
    /// Upwards and downwards.
    ways: Vec<Followed>,
    /// Other motions, which the scene's own start leads to where both ways end in the same one.
    begun: Vec<Followed>,
}

impl Found {
    fn all(&self) -> impl Iterator<Item = &Followed> {
        self.ways.iter().chain(&self.begun)
    }

    /// What the scene's own start has led to at a value at which both ways end in the same motion.
    fn begun_at(&self, friction: f64) -> Option<&Reached> {
        agreed(&self.ways, friction)?;
        self.begun.iter().find_map(|begun| begun.at(friction))
    }
}

/// Follows both ways, each on a core. `None` if the watch ended it; what was finished is in the journal.
///
/// # Errors
/// A scene without a common friction coefficient or that cannot start at either end, a value that µ cannot have, or a
/// journal that cannot be written.
pub fn continuation(
    plan: &Plan<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Continuation>, Error> {
    for value in plan.values {
        assign(&mut plan.scene.clone(), FRICTION, *value)?;
    }
    let done = AtomicUsize::new(0);
    let run = Run { plan, journal, watch };
    // Two ways, the scene's own starts and the comparisons: about a tenth.
    let pieces = if run.has_own_start() { 3.2 } else { 2.2 };
    #[allow(clippy::cast_precision_loss)]
    let all = pieces * plan.values.len() as f64;
    #[allow(clippy::cast_precision_loss)]
    let step_done = || (watch.progress)(done.fetch_add(1, Ordering::Relaxed) as f64 / all);
    let ways = collect(2, &|i| run.follow(Way::ALL[i], &step_done), &|_| {})?;
    let Some(ways) = ways.into_iter().collect::<Option<Vec<Followed>>>() else { return Ok(None) };
    // Nothing was followed: a way ends at its first failure.
    if let [Err(failure), Err(_)] = [0, 1].map(|way: usize| &ways[way].passed[0].point.ending) {
        return Err(Error::scene(failure.clone()));
    }
    let Some(begun) = run.begin(&ways, &step_done)? else { return Ok(None) };
    let found = Found { ways, begun };
    let Some((bistable, unknown)) = run.compare_ways(&found)? else { return Ok(None) };
    let mut compared = Vec::new();
    for candidate in plan.candidates {
        let Some(both) = run.compare_inside(candidate, &bistable, &found)? else { return Ok(None) };
        compared.push(both);
    }
    let mut jumps: Vec<Jump> = found.all().flat_map(|way| way.jumps.clone()).collect();
    jumps.sort_by(|a, b| (a.way as u8).cmp(&(b.way as u8)).then(a.at().total_cmp(&b.at())));
    let rising = plan.values.iter().filter_map(|value| found.ways[0].at(*value));
    let falling = plan.values.iter();
    let falling =
        falling.filter_map(|value| found.begun_at(*value).or_else(|| found.ways[1].at(*value)));
    let (rising, falling) = (points(rising), points(falling));
    Ok(Some(Continuation { rising, falling, jumps, bistable, unknown, compared }))
}

/// The motion that both ways end in at a value that they have passed, if it is the same one and is known.
fn agreed(ways: &[Followed], friction: f64) -> Option<&Ending> {
    let [rising, falling] = ways else { return None };
    let [up, down] = [rising.at(friction)?.ending()?, falling.at(friction)?.ending()?];
    let are_alike =
        [up, down].iter().all(|ending| is_known(ending)) && distance(up, down) <= OTHER_EXTENT;
    are_alike.then_some(down)
}

/// Has a motion settled, or is it on its way to rest or away from it?
fn is_known(ending: &Ending) -> bool {
    ending.kind != Kind::Unsettled || ending.is_known()
}

fn points<'a>(reached: impl Iterator<Item = &'a Reached>) -> Vec<Point> {
    reached.map(|reached| reached.point.clone()).collect()
}

/// A plan on its way.
struct Run<'a> {
    plan: &'a Plan<'a>,
    journal: &'a Journal,
    watch: Watch<'a>,
}

impl Run<'_> {
    /// All values of one way, in its order, as far as it goes.
    fn follow(&self, way: Way, step_done: &dyn Fn()) -> Result<Option<Followed>, Error> {
        let mut values = self.plan.values.to_vec();
        if way == Way::Falling {
            values.reverse();
        }
        let label = way.name().to_owned();
        let Some(first) = self.reach(&label, values[0], Start::Scene(way))? else {
            return Ok(None);
        };
        let mut followed = Followed::from(way, label, first);
        step_done();
        for value in &values[1..] {
            if !followed.has_state() {
                break;
            }
            if !self.advance(way, &mut followed, *value)? {
                return Ok(None);
            }
            step_done();
        }
        Ok(Some(followed))
    }

    /// Other motions, which the scene's own start leads to where both ways end in the same one: each from the highest value
    /// at which it does and that those before do not reach, upwards to its end, and downwards to its end or to where the
    /// ways part.
    fn begin(
        &self,
        ways: &[Followed],
        step_done: &(dyn Fn() + Sync),
    ) -> Result<Option<Vec<Followed>>, Error> {
        let mut found: Vec<Followed> = Vec::new();
        // A scene that starts in its equilibrium finds nothing that the ways do not.
        if !self.has_own_start() {
            return Ok(Some(found));
        }
        // The way downwards has begun from the scene's start at the last value.
        let values = &self.plan.values[..self.plan.values.len() - 1];
        let agreed_at = |place: usize| agreed(ways, values[place]);
        let mut left: Vec<usize> =
            (0..values.len()).filter(|place| agreed_at(*place).is_some()).collect();
        while !left.is_empty() {
            let places = left.split_off(left.len().saturating_sub(2));
            let start = |i: usize| {
                let reached = self.reach("begun", values[places[i]], Start::Scene(Way::Falling));
                step_done();
                reached
            };
            let reached = collect(places.len(), &start, &|_| {})?;
            let Some(reached) = reached.into_iter().collect::<Option<Vec<Reached>>>() else {
                return Ok(None);
            };
            for (place, begun) in places.into_iter().zip(reached).rev() {
                let is_other = matches!([begun.ending(), agreed_at(place)], [Some(ending), Some(of_both)]
                    if ending.kind.is_cycle() && distance(ending, of_both) > OTHER_EXTENT);
                if !is_other || found.iter().any(|other| other.covers(values[place])) {
                    continue;
                }
                let below = (0..place).rev().take_while(|below| agreed_at(below + 1).is_some());
                let below: Vec<f64> = below.map(|below| values[below]).collect();
                let above = &self.plan.values[place + 1..];
                let Some(followed) = self.follow_both_ways(begun, &below, above)? else {
                    return Ok(None);
                };
                found.push(followed);
            }
            left.retain(|place| !found.iter().any(|other| other.covers(values[*place])));
        }
        Ok(Some(found))
    }

    /// Follows a motion downwards over the values below it and upwards over those above it, each to its end.
    fn follow_both_ways(
        &self,
        begun: Reached,
        below: &[f64],
        above: &[f64],
    ) -> Result<Option<Followed>, Error> {
        let mut down = Followed::from(Way::Falling, "begun".to_owned(), begun.clone());
        let mut up = Followed::from(Way::Falling, "begun, back:".to_owned(), begun);
        if !self.follow_to_its_end(Way::Falling, &mut down, below)?
            || !self.follow_to_its_end(Way::Rising, &mut up, above)?
        {
            return Ok(None);
        }
        down.passed.extend(up.passed.into_iter().skip(1));
        down.jumps.extend(up.jumps);
        Ok(Some(down))
    }

    /// Does the scene start anywhere else than in its equilibrium?
    fn has_own_start(&self) -> bool {
        Push::of_resting(self.plan.scene).is_none()
    }

    /// Follows a motion over some values up to its first jump; what comes after that is another motion. `false` if the
    /// watch ended it.
    fn follow_to_its_end(
        &self,
        way: Way,
        followed: &mut Followed,
        values: &[f64],
    ) -> Result<bool, Error> {
        for &value in values {
            if !followed.jumps.is_empty() || !followed.has_state() {
                break;
            }
            if !self.advance(way, followed, value)? {
                return Ok(false);
            }
        }
        followed.jumps.truncate(1);
        if let Some(jump) = followed.jumps.first() {
            let end = jump.between[0];
            let last = followed.passed.iter().position(|reached| reached.point.friction == end);
            followed.passed.truncate(last.map_or(1, |last| last + 1));
        }
        Ok(true)
    }

    /// Follows a way from the last value that it has passed to another one. The change of µ is halved wherever the
    /// motion gives way to another, until it stays or the change is as small as the resolution. `false` if the watch
    /// ended it.
    fn advance(&self, way: Way, followed: &mut Followed, to: f64) -> Result<bool, Error> {
        let resolution = self.plan.resolution * (1.0 + 1e-9);
        let Some(mut here) = followed.passed.last().cloned() else { return Ok(true) };
        let mut step = to - here.point.friction;
        loop {
            let from = here.point.friction;
            let is_whole = step.abs() >= (to - from).abs() * (1.0 - 1e-9);
            let target = if is_whole { to } else { from + step };
            let Some(next) = self.reach(&followed.label, target, Start::From(&here))? else {
                return Ok(false);
            };
            let stays = match (here.ending(), next.ending()) {
                (Some(before), Some(after)) => {
                    followed.is_leaving || distance(before, after) <= OTHER_EXTENT
                }
                _ => false,
            };
            let half = 0.5 * (target - from);
            // A cycle of another kind may be another cycle that looks alike: a small change tells.
            let has_other_kind = !followed.is_leaving
                && matches!((here.ending(), next.ending()), (Some(a), Some(b)) if have_other_kinds(a, b));
            // Rest is left at once; a cycle may change steeply, which a smaller change shows.
            let is_of_cycles = [&here, &next]
                .map(Reached::ending)
                .iter()
                .all(|ending| ending.is_some_and(|ending| ending.kind.is_cycle()));
            let smallest = if is_of_cycles { STEEP * resolution } else { resolution };
            // No double lies between them where half of the change is nothing.
            let is_open = !stays || is_of_cycles && has_other_kind;
            if is_open
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
                    followed.jumps.push(Jump { way, among: followed.way, between, endings });
                }
                // A motion that has left another one and not yet settled may become any motion.
                followed.is_leaving = (followed.is_leaving || !stays)
                    && after.kind == Kind::Unsettled
                    && !after.rests();
            }
            step = if stays { 2.0 * step } else { to - target };
            let is_over = target == to || next.progress.is_none();
            followed.passed.push(next.clone());
            if is_over {
                return Ok(true);
            }
            here = next;
        }
    }

    /// One value, from where it starts.
    fn reach(
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
        let piece = self.journal.piece(&key, work)?;
        Ok(piece.map(|Piece { ending, progress }| Reached {
            point: Point { friction, ending },
            progress,
        }))
    }

    /// A motion at a value, from where it was.
    fn resume(&self, friction: f64, progress: Progress) -> Result<Simulation, Error> {
        Simulation::resume(Snapshot::new(self.scene(friction)?, progress))
    }

    fn scene(&self, friction: f64) -> Result<Scene, Error> {
        let mut scene = self.plan.scene.clone();
        assign(&mut scene, FRICTION, friction)?;
        Ok(scene)
    }

    fn run(&self, friction: f64, start: Start<'_>) -> Result<Option<(Ending, Progress)>, Error> {
        let mut simulation = match start {
            Start::Scene(Way::Falling) => Simulation::new(self.scene(friction)?, 0.0)?,
            Start::From(Reached { point, progress: Some(progress) })
                if !point.ending.as_ref().is_ok_and(has_no_state) =>
            {
                self.resume(friction, progress.clone())?
            }
            // An equilibrium moves with µ; a motion that rests follows it, and one that grows without bound has no state to
            // begin with.
            Start::Scene(Way::Rising) | Start::From(_) => {
                let mut scene = self.scene(friction)?;
                scene.rest();
                Simulation::new(scene, 0.0)?
            }
        };
        self.plan.push.give(&mut simulation);
        let mut ending = settle(&mut simulation, self.plan.look, &|| self.watch.is_over())?;
        // A motion that drifts slowly to another one would else drift on with each further value, and no jump be seen.
        for _ in 0..MORE_TIMES {
            match &ending {
                Some(drifts) if is_drifting(drifts) => {
                    ending = settle(&mut simulation, self.plan.look, &|| self.watch.is_over())?;
                }
                _ => break,
            }
        }
        Ok(ending.map(|ending| (ending, simulation.save().into_progress())))
    }

    /// The ranges of µ in which both ways end in different motions, and those in which that is not known: between each
    /// two neighbouring jumps both ways are run at a value in the middle.
    #[allow(clippy::type_complexity)]
    fn compare_ways(&self, found: &Found) -> Result<Option<(Vec<Bistable>, Vec<[f64; 2]>)>, Error> {
        let values = self.plan.values;
        let ends = [values[0], values[values.len() - 1]];
        let jumps = found.all().flat_map(|way| way.jumps.iter().map(Jump::at));
        let mut bounds: Vec<f64> = jumps.chain(ends).collect();
        bounds.sort_by(f64::total_cmp);
        // Jumps of both ways at the same place have nothing between them.
        bounds.dedup_by(|a, b| (*a - *b).abs() <= 2.0 * self.plan.resolution && !ends.contains(a));
        let (mut bistable, mut unknown): (Vec<Bistable>, Vec<[f64; 2]>) = Default::default();
        for range in bounds.windows(2).map(|two| [two[0], two[1]]) {
            let middle = f64::midpoint(range[0], range[1]);
            let Some(both) = self.both(middle, found, None)? else {
                return Ok(None);
            };
            let Some(Both { endings: [up, down], .. }) = both else {
                unknown.push(range);
                continue;
            };
            if distance(&up, &down) <= OTHER_EXTENT {
                continue;
            }
            let rests = up.rests() != down.rests();
            let bounded = range.map(|end| !ends.contains(&end));
            let kind =
                |ending: &Ending| if ending.rests() { Kind::Equilibrium } else { ending.kind };
            let kinds = [kind(&up), kind(&down)];
            let Some(third) = self.third(middle, [&up, &down], found)? else { return Ok(None) };
            match bistable.last_mut() {
                Some(last) if last.range[1] == range[0] && last.words() == words(kinds) => {
                    (last.range[1], last.bounded[1]) = (range[1], bounded[1]);
                    last.third = last.third.take().or(third);
                }
                _ => bistable.push(Bistable { range, bounded, rests, kinds, third }),
            }
        }
        Ok(Some((bistable, unknown)))
    }

    /// A motion that the scene's own start leads to, at this value or from another one, where it is none of the two of both
    /// ways; `None` inside where it is one of them, or is not known.
    fn third(
        &self,
        friction: f64,
        two: [&Ending; 2],
        found: &Found,
    ) -> Result<Option<Option<Third>>, Error> {
        // A scene that starts in its equilibrium starts as the way upwards does.
        if !self.has_own_start() {
            return Ok(Some(None));
        }
        let is_third = |ending: &Ending| {
            let is_other = |other: &&Ending| distance(other, ending) > OTHER_EXTENT;
            is_known(ending) && two.iter().all(is_other)
        };
        let start = Start::Scene(Way::Falling);
        let Some(reached) = self.reach("start", friction, start)? else { return Ok(None) };
        let mut third = reached.point.ending.ok().filter(is_third);
        for begun in found.begun.iter().filter(|begun| begun.covers(friction)) {
            if third.is_some() {
                break;
            }
            let Some(there) = self.reached(friction, Way::Falling, begun)? else { return Ok(None) };
            third = there.map(|(ending, _)| ending).filter(is_third);
        }
        Ok(Some(third.map(|ending| Third { friction, ending })))
    }

    /// Both ways' motions at some values in each part of a range in which one way rests and the other does not.
    fn compare_inside(
        &self,
        candidate: &Candidate,
        bistable: &[Bistable],
        found: &Found,
    ) -> Result<Option<Vec<Both>>, Error> {
        let mut compared = Vec::new();
        let [from, to] = candidate.range;
        for range in bistable.iter().filter(|range| range.rests) {
            let [from, to] = [from.max(range.range[0]), to.min(range.range[1])];
            for part in COMPARED.into_iter().filter(|_| from < to) {
                let friction = from + part * (to - from);
                let Some(both) = self.both(friction, found, Some(&candidate.states))? else {
                    return Ok(None);
                };
                compared.extend(both);
            }
        }
        Ok(Some(compared))
    }

    /// The motions of both ways at a value, and whether contacts take some states in them; `None` inside where one of them
    /// is not known there. Where both ways have the same motion, the one that the scene's own start has led to, if there
    /// is one, takes the place of the second.
    fn both(
        &self,
        friction: f64,
        found: &Found,
        states: Option<&[ContactState]>,
    ) -> Result<Option<Option<Both>>, Error> {
        let [rising, falling] = &found.ways[..] else { return Ok(Some(None)) };
        let Some(up) = self.reached(friction, Way::Rising, rising)? else { return Ok(None) };
        let Some(down) = self.reached(friction, Way::Falling, falling)? else { return Ok(None) };
        let (Some(up), Some(mut down)) = (up, down) else { return Ok(Some(None)) };
        let are_alike = distance(&up.0, &down.0) <= OTHER_EXTENT;
        let mut begun = found.begun.iter().filter(|begun| are_alike && begun.covers(friction));
        if let Some(begun) = begun.next() {
            let Some(there) = self.reached(friction, Way::Falling, begun)? else { return Ok(None) };
            let Some(there) = there else { return Ok(Some(None)) };
            down = there;
        }
        let pair = [up, down];
        let mut takes = [false; 2];
        for (takes, (ending, progress)) in takes.iter_mut().zip(&pair) {
            if let Some(states) = states.filter(|_| ending.kind.is_cycle()) {
                let simulation = self.resume(friction, progress.clone())?;
                *takes = visited(&simulation, self.plan.look, ending.period)?.has(states);
            }
        }
        let endings = pair.map(|(ending, _)| ending);
        Ok(Some(Some(Both { friction, endings, takes })))
    }

    /// The motion of a way at a value, from the nearest one that it has passed; `None` inside where it is not known.
    #[allow(clippy::type_complexity)]
    fn reached(
        &self,
        friction: f64,
        way: Way,
        followed: &Followed,
    ) -> Result<Option<Option<(Ending, Progress)>>, Error> {
        let Some(start) = followed.nearest(friction) else { return Ok(Some(None)) };
        let from = start.point.friction;
        let label = format!("{}, compared at {friction:?}:", followed.label);
        let mut there = Followed::from(way, label, start);
        if from != friction && !self.advance(way, &mut there, friction)? {
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

impl Followed {
    fn from(way: Way, label: String, first: Reached) -> Self {
        Self { way, label, passed: vec![first], jumps: Vec::new(), is_leaving: false }
    }

    /// What it has reached at a value that it has passed.
    fn at(&self, friction: f64) -> Option<&Reached> {
        self.passed.iter().find(|reached| reached.point.friction == friction)
    }

    /// Can it be followed further from where it is?
    fn has_state(&self) -> bool {
        self.passed.last().is_some_and(|last| last.progress.is_some())
    }

    /// Does a value lie among those that it has passed?
    fn covers(&self, friction: f64) -> bool {
        let passed = || self.passed.iter().map(|reached| reached.point.friction);
        passed().any(|value| value <= friction) && passed().any(|value| value >= friction)
    }

    /// The passed value nearest to another one with a motion, on the same side of all jumps; one with a settled motion
    /// where there is one.
    fn nearest(&self, friction: f64) -> Option<Reached> {
        let is_beside = |reached: &&Reached| {
            let (low, high) =
                (reached.point.friction.min(friction), reached.point.friction.max(friction));
            reached.progress.is_some()
                && !self.jumps.iter().any(|jump| (low..=high).contains(&jump.at()))
        };
        let apart = |reached: &Reached| (reached.point.friction - friction).abs();
        let has_settled = |reached: &Reached| {
            reached.ending().is_some_and(|ending| ending.kind != Kind::Unsettled || ending.rests())
        };
        let beside = self.passed.iter().filter(is_beside);
        let order = |a: &&Reached, b: &&Reached| {
            has_settled(b).cmp(&has_settled(a)).then(apart(a).total_cmp(&apart(b)))
        };
        beside.min_by(order).cloned()
    }
}

/// `true` of a motion in which contacts change their states and that has not settled, or not come back as near as a
/// periodic one does.
fn is_drifting(ending: &Ending) -> bool {
    let is_open = ending.kind == Kind::Unsettled
        || ending.kind == Kind::Undecided && ending.closure.is_some();
    is_open && !ending.linear
}

/// `true` of a motion after which the next value starts in its own equilibrium.
fn has_no_state(ending: &Ending) -> bool {
    ending.rests() || ending.kind == Kind::Unbounded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_motions_are_called_what_they_are() {
        let said = |a, b| words([a, b]);
        assert_eq!(said(Kind::Periodic, Kind::Equilibrium), "rest and a cycle");
        assert_eq!(said(Kind::Periodic, Kind::QuasiPeriodic), "two cycles");
        assert_eq!(said(Kind::Undecided, Kind::Periodic), "a cycle and an undecided motion");
        assert_eq!(said(Kind::Equilibrium, Kind::Irregular), "rest and an irregular motion");
        assert_eq!(said(Kind::Undecided, Kind::Undecided), "two undecided motions");
        assert_eq!(said(Kind::Unbounded, Kind::Equilibrium), "rest and growth without bound");
    }
}
