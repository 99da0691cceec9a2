//! All motions that are met, each followed both ways to its ends.
//!
//! Motions are met at rest, from the scene's own start at each value, and where a motion that ends gives way to another one.
//! Each is followed unless one that was followed before has the same motion at that value. Where two others are known, a third
//! one waits: it is followed only towards values at which fewer than two are known.

use super::findings::{Jump, Point, SweepDirection};
use super::follow::{PlanRun, Start};
use super::followed::{Followed, Reached, are_alike};
use crate::stability::parallel::collect;
use crate::study::linear::growth_of_small;
use crate::study::long_term::LongTermMotion;
use amontons::Error;
use amontons::simulation::Simulation;
use std::collections::VecDeque;

/// The rows that all other motions together may take, or as many as the ways and the scene's own starts have taken if that is
/// more. These take some minutes. A scene may have any number of motions, and each run of one without a period is long.
const ROWS: u64 = 40_000_000;

/// A motion that was met at a value and is to be followed from there.
#[derive(Clone)]
pub(super) struct MotionStart {
    reached: Reached,
    /// The way on which it was met, in which one that has not settled is followed until it has.
    way: SweepDirection,
    /// The only way in which it is to be followed; `None` for both.
    only: Option<SweepDirection>,
    /// For a motion that a way has jumped to and followed on: the place of the way and µ of the jump. Such a motion
    /// is followed only to find whether it exists on the other side of the jump.
    back: Option<(usize, f64)>,
    /// `true` of one that is to be followed beside two others.
    is_third: bool,
}

impl MotionStart {
    /// A motion that was met on a way.
    pub(super) fn met(reached: Reached, way: SweepDirection) -> Self {
        Self { reached, way, only: None, back: None, is_third: false }
    }

    /// A motion that the scene's own start leads to.
    pub(super) fn own(reached: Reached) -> Self {
        Self::met(reached, SweepDirection::Falling)
    }
}

/// All motions that were followed.
pub(super) struct FoundMotions {
    /// The ways upwards and downwards.
    pub(super) ways: Vec<Followed>,
    /// Other motions, each as far as it exists.
    pub(super) others: Vec<Followed>,
    /// Motions that were met where two others are known.
    waiting: Vec<MotionStart>,
    /// Ranges in which a motion that was met had not settled, from the value at which it was met to that at which it
    /// was first known. Its fate between these is not known.
    unsettled: Vec<[f64; 2]>,
    /// Number of rows of all runs after which no further motion is followed.
    most_rows: u64,
    /// Number of starts that were tried, by which the journal distinguishes their work.
    tried: usize,
    /// `true` where not all that were met were followed to their ends.
    pub(super) more: bool,
}

impl FoundMotions {
    /// Both ways and no other motion, after `rows` rows.
    pub(super) fn new(ways: Vec<Followed>, rows: u64) -> Self {
        let most_rows = rows + rows.max(ROWS);
        let (others, waiting, unsettled) = (Vec::new(), Vec::new(), Vec::new());
        Self { ways, others, waiting, unsettled, most_rows, tried: 0, more: false }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Followed> {
        self.ways.iter().chain(&self.others)
    }

    /// Values at which something changes, with their accuracy: jumps, and the ends of ranges in which a motion had
    /// not settled.
    pub(super) fn bounds(&self) -> Vec<(f64, f64)> {
        let jumps = self.all().flat_map(|followed| followed.jumps.iter());
        let jumps = jumps.map(|jump| (jump.at(), 0.5 * (jump.between[1] - jump.between[0]).abs()));
        jumps.chain(self.unsettled.iter().flatten().map(|end| (*end, 0.0))).collect()
    }

    /// `true` where a motion that was met had not settled.
    pub(super) fn is_unsettled(&self, friction: f64) -> bool {
        self.unsettled.iter().any(|[low, high]| (low..=high).contains(&&friction))
    }

    /// `true` if a motion ends at the value at which it is: that is known no better than to the bracket of its jump.
    pub(super) fn has_end_of(&self, point: &Point) -> bool {
        let ends_here = |jump: &Jump| {
            let [a, b] = jump.between;
            let is_near = (a.min(b)..=a.max(b)).contains(&point.friction);
            is_near && point.ending.as_ref().is_ok_and(|here| are_alike(&jump.endings[0], here))
        };
        self.all().any(|followed| followed.jumps.iter().any(ends_here))
    }

    /// The motions that both ways have jumped to, each to be followed back over its jump.
    pub(super) fn ways_jumped_to(&self) -> Vec<MotionStart> {
        let of_way = |(place, way): (usize, &Followed)| {
            let start = |(reached, jump): (Reached, &Jump)| MotionStart {
                only: Some(way.way.other()),
                back: Some((place, jump.at())),
                ..MotionStart::met(reached, way.way)
            };
            way.jumped_to().map(start).collect::<Vec<_>>()
        };
        self.ways.iter().enumerate().flat_map(of_way).collect()
    }

    /// The waiting motion that is nearest to a range in which fewer than two are known, to be followed towards it.
    pub(super) fn towards(&mut self, ranges: &[[f64; 2]]) -> Option<MotionStart> {
        let apart = |start: &MotionStart, [low, high]: [f64; 2]| {
            let friction = start.reached.point.friction;
            let (apart, way) = if friction < low {
                (low - friction, SweepDirection::Rising)
            } else {
                (friction - high, SweepDirection::Falling)
            };
            let is_open = apart > 0.0 && start.only.is_none_or(|only| only == way);
            is_open.then_some((apart, way))
        };
        let all = self.waiting.iter().enumerate().flat_map(|(place, start)| {
            let towards = ranges.iter().filter_map(move |range| apart(start, *range));
            towards.map(move |(apart, way)| (apart, way, place))
        });
        let (_, way, place) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let start = self.waiting.remove(place);
        if start.only.is_none() {
            self.waiting.push(MotionStart { only: Some(way.other()), ..start.clone() });
        }
        Some(MotionStart { only: Some(way), is_third: true, ..start })
    }

    /// The entry in the table of the way downwards at a value: another cycle than the one that both ways end in,
    /// where one was met.
    pub(super) fn falling(&self, friction: f64) -> Option<&Reached> {
        let other = self.shown(friction).and_then(|place| self.others[place].at(friction));
        other.or_else(|| self.ways[1].at(friction))
    }

    /// The place of the other motion that stands in the table of the way downwards.
    fn shown(&self, friction: f64) -> Option<usize> {
        let [up, down] = [0, 1].map(|way| self.ways[way].at(friction).and_then(Reached::ending));
        let (up, down) = (up?, down?);
        let is_other = |other: &Followed| {
            let there = other.at(friction).and_then(Reached::ending);
            there.is_some_and(|there| there.kind.is_cycle() && !are_alike(there, down))
        };
        if !are_alike(up, down) {
            return None;
        }
        self.others.iter().position(is_other)
    }

    /// All jumps, rising ones first and by ascending µ. Those at the ends of another motion are among the values of the way
    /// downwards where that motion stands there at the last value before the jump.
    pub(super) fn jumps(&self, values: &[f64]) -> Vec<Jump> {
        let mut jumps: Vec<Jump> = self.ways.iter().flat_map(|way| way.jumps.clone()).collect();
        for (place, other) in self.others.iter().enumerate() {
            for jump in &other.jumps {
                let apart = |value: &f64| (value - jump.between[0]).abs();
                let passed = values.iter().copied().filter(|value| other.covers(*value));
                let last = passed.min_by(|a, b| apart(a).total_cmp(&apart(b)));
                let is_shown = last.is_some_and(|last| self.shown(last) == Some(place));
                jumps.push(Jump {
                    among: is_shown.then_some(SweepDirection::Falling),
                    ..jump.clone()
                });
            }
        }
        jumps.sort_by(|a, b| (a.way as u8).cmp(&(b.way as u8)).then(a.at().total_cmp(&b.at())));
        jumps
    }
}

impl PlanRun<'_> {
    /// The motions that the scene's own start leads to at each value, from the highest on; the way downwards has
    /// begun from it at the last one.
    pub(super) fn own_starts(
        &self,
        step_done: &(dyn Fn() + Sync),
    ) -> Result<Option<Vec<Reached>>, Error> {
        // A scene that starts in its equilibrium starts as the way upwards does.
        if !self.has_own_start() {
            return Ok(Some(Vec::new()));
        }
        let values = &self.plan.values[..self.plan.values.len() - 1];
        let start = |i: usize| {
            let reached = self.own_start(values[values.len() - 1 - i]);
            step_done();
            reached
        };
        let reached = collect(values.len(), &start, &|_| {})?;
        let Some(reached) = reached.into_iter().collect::<Option<Vec<Reached>>>() else {
            return Ok(None);
        };
        Ok(Some(reached.into_iter().filter(Reached::is_settled).collect()))
    }

    /// Rest where both ways have passed it by, since ways that begin in a cycle need not meet it. It is looked for at values at
    /// which neither way rests and all small motions decay; of several such values that follow each other, at the first.
    pub(super) fn rests(&self, ways: &[Followed]) -> Result<Option<Vec<Reached>>, Error> {
        let mut found = Vec::new();
        let mut is_next = false;
        for value in self.plan.values {
            let rests = |way: &Followed| {
                way.at(*value).and_then(Reached::ending).is_some_and(LongTermMotion::rests)
            };
            if ways.iter().any(rests) || !self.may_rest(*value) {
                is_next = false;
                continue;
            }
            if !is_next {
                let Some(reached) = self.rest(*value)? else { return Ok(None) };
                found.push(reached);
            }
            is_next = true;
        }
        Ok(Some(found.into_iter().filter(Reached::is_settled).collect()))
    }

    /// `true` if all small motions beside rest decay at a value, according to the eigenvalues.
    pub(super) fn may_rest(&self, friction: f64) -> bool {
        let decays = |simulation: &Simulation| {
            growth_of_small(simulation).is_some_and(|growth| growth.rate < 0.0)
        };
        // A scene that signals drive on does not rest.
        let may_rest = |simulation: Simulation| !simulation.is_driven_on() && decays(&simulation);
        self.at_rest(friction).is_ok_and(may_rest)
    }

    /// The motion that a small push out of rest leads to at a value of µ.
    pub(super) fn rest(&self, friction: f64) -> Result<Option<Reached>, Error> {
        self.reach("rest", friction, Start::Scene(SweepDirection::Rising))
    }

    /// The motion that the scene's own start leads to at a value.
    pub(super) fn own_start(&self, friction: f64) -> Result<Option<Reached>, Error> {
        self.reach("start", friction, Start::Scene(SweepDirection::Falling))
    }

    /// Follows all motions that are not known yet, and those that they give way to. `false` if the watch ended it.
    pub(super) fn follow_all(
        &self,
        starts: Vec<MotionStart>,
        found: &mut FoundMotions,
    ) -> Result<bool, Error> {
        let mut left: VecDeque<MotionStart> = starts.into();
        while let Some(mut start) = left.pop_front() {
            found.tried += 1;
            let label = format!("motion {}", found.tried);
            let rows_left = found.most_rows.saturating_sub(self.rows());
            if rows_left == 0 {
                found.more = true;
                break;
            }
            let settling = format!("{label} settling");
            let met = Followed::motion(start.way, settling, start.reached, rows_left);
            let Some(met) = self.settled(met)? else { return Ok(false) };
            found.more |= met.rows_left == 0;
            let Some(last) = met.passed.last().cloned() else { continue };
            if met.is_leaving {
                // Its fate is not known within the range over which it was followed.
                found.others.push(met);
                continue;
            }
            if met.passed.len() > 1 {
                found.unsettled.push(met.extent());
            }
            start.reached = last;
            let except = start.back.map(|(way, _)| way);
            let Some(others) = self.others(&start.reached, except, found)? else {
                return Ok(false);
            };
            match others {
                Some(0 | 1) => {}
                Some(_) if start.is_third => {}
                Some(_) => {
                    found.waiting.push(start);
                    continue;
                }
                None => continue,
            }
            let rows_left = found.most_rows.saturating_sub(self.rows());
            let followed = self.to_its_ends(&label, &start, rows_left)?;
            let Some(followed) = followed else { return Ok(false) };
            found.more |= followed.rows_left == 0;
            // A motion that does not exist on the other side of the jump is told with the way.
            let ends_there = start.back.is_some_and(|(_, at)| {
                let [low, high] = followed.extent();
                let near = 2.0 * self.plan.resolution;
                if start.way == SweepDirection::Rising {
                    low >= at - near
                } else {
                    high <= at + near
                }
            });
            let has_failed = followed.passed.iter().any(|reached| reached.point.ending.is_err());
            for (reached, jump) in followed.beyond.iter().flatten().zip(&followed.jumps) {
                left.push_back(MotionStart::met(reached.clone(), jump.way));
            }
            if !ends_there || has_failed {
                found.others.push(followed);
            }
        }
        Ok(true)
    }

    /// A motion as it is once it has settled, at the value at which it is met or at one of those beyond.
    fn settled(&self, mut motion: Followed) -> Result<Option<Followed>, Error> {
        let first = motion.passed[0].point.friction;
        if !motion.is_leaving {
            return Ok(Some(motion));
        }
        let values = self.beyond(first, motion.way);
        let is_open = |motion: &Followed| motion.is_leaving && motion.can_continue();
        Ok(self.advance_through(&mut motion, &values, is_open)?.then_some(motion))
    }

    /// The values beyond one, in the order of a way.
    fn beyond(&self, friction: f64, way: SweepDirection) -> Vec<f64> {
        let mut values = self.values(way);
        values.retain(|value| match way {
            SweepDirection::Rising => *value > friction,
            SweepDirection::Falling => *value < friction,
        });
        values
    }

    /// Number of other motions known at the value at which one was met, except for that of one of the ways; `None`
    /// inside if it is known itself, or cannot be followed.
    #[allow(clippy::option_option)]
    fn others(
        &self,
        start: &Reached,
        except: Option<usize>,
        found: &FoundMotions,
    ) -> Result<Option<Option<usize>>, Error> {
        let Some(ending) = start.ending().filter(|_| start.is_settled()) else {
            return Ok(Some(None));
        };
        if found.has_end_of(&start.point) {
            return Ok(Some(None));
        }
        let ways = found.ways.iter().enumerate().filter(|(place, _)| Some(*place) != except);
        let followed = ways.map(|(_, way)| way).chain(&found.others);
        let Some(motions) = self.motions(start.point.friction, followed)? else { return Ok(None) };
        Ok(Some((!motions.has(ending)).then_some(motions.known.len())))
    }

    /// Follows a motion downwards and upwards or only one of these, each on a core, as far as it exists and no more than some
    /// rows. `None` if the watch ended it.
    fn to_its_ends(
        &self,
        label: &str,
        start: &MotionStart,
        rows_left: u64,
    ) -> Result<Option<Followed>, Error> {
        let rows_left = if start.only.is_some() { rows_left } else { rows_left / 2 };
        let follow = |i: usize| {
            let way = [SweepDirection::Falling, SweepDirection::Rising][i];
            let label = format!("{label} {}", way.name());
            let mut followed = Followed::motion(way, label, start.reached.clone(), rows_left);
            if start.only.is_some_and(|only| only != way) {
                return Ok(Some(followed));
            }
            let values = self.beyond(start.reached.point.friction, way);
            let is_done = self.advance_through(&mut followed, &values, Followed::can_continue)?;
            Ok(is_done.then_some(followed))
        };
        let followed = collect(2, &follow, &|_| {})?;
        let Some(followed) = followed.into_iter().collect::<Option<Vec<Followed>>>() else {
            return Ok(None);
        };
        Ok(followed.into_iter().reduce(Followed::joined))
    }
}
