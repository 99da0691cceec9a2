//! Ranges of µ in which two motions were met.

use super::findings::{Bistable, RestAndMotion, ThirdMotion, words};
use super::follow::PlanRun;
use super::followed::{Followed, Reached, are_alike};
use super::motions::FoundMotions;
use crate::stability::candidates::Candidate;
use crate::study::long_term::{Kind, LongTermMotion};
use crate::study::visit::visited;
use amontons::Error;
use amontons::simulation::Progress;

/// Positions inside a candidate's range at which motions are observed, in parts of the range.
const COMPARED: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Ranges of µ, and motions that were met only when these were compared.
#[derive(Default)]
pub(super) struct Ranges {
    /// Ranges with two motions.
    pub(super) bistable: Vec<Bistable>,
    /// Ranges in which a second motion may exist.
    pub(super) unknown: Vec<[f64; 2]>,
    /// Ranges in which fewer than two motions are known.
    pub(super) lone: Vec<[f64; 2]>,
    /// Motions that the scene's own start or a push out of rest leads to in the middle of a range in which fewer than two others are known.
    pub(super) new: Vec<Reached>,
}

/// All motions that are known at a value.
pub(super) struct Motions {
    /// The known motions, each once; that of the way upwards first, then that of the way downwards.
    pub(super) known: Vec<(LongTermMotion, Progress)>,
    /// `true` where another one that was met may be there and is not known.
    misses: bool,
}

impl PlanRun<'_> {
    /// The ranges of µ in which two motions were met, and those in which that is not known: all motions are run at a value in
    /// the middle between each two neighbouring jumps, and so are the scene's own start and rest where it is stable.
    pub(super) fn compare(&self, found: &FoundMotions) -> Result<Option<Ranges>, Error> {
        let values = self.plan.values;
        let ends = [values[0], values[values.len() - 1]];
        let mut bounds = found.bounds();
        bounds.extend(ends.map(|end| (end, 0.0)));
        bounds.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Jumps whose brackets overlap may be at the same place.
        bounds.dedup_by(|a, b| a.0 - b.0 <= a.1 + b.1 && !ends.contains(&a.0));
        let mut ranges = Ranges::default();
        for range in bounds.windows(2).map(|two| [two[0].0, two[1].0]) {
            let middle = f64::midpoint(range[0], range[1]);
            let Some(mut motions) = self.motions(middle, found.all())? else { return Ok(None) };
            motions.misses |= found.is_unsettled(middle);
            let is_narrow = range[1] - range[0] <= 2.0 * self.plan.resolution;
            // Motions that exist only in a range as narrow are not searched for.
            if is_narrow && motions.known.len() < 2 {
                continue;
            }
            if self.has_own_start() && !is_narrow {
                let Some(own) = self.own_start(middle)? else { return Ok(None) };
                motions.meet(own, found, &mut ranges.new);
            }
            if !is_narrow && !motions.rest() && self.may_rest(middle) {
                let Some(rest) = self.rest(middle)? else { return Ok(None) };
                motions.meet(rest, found, &mut ranges.new);
            }
            ranges.add(range, range.map(|end| !ends.contains(&end)), middle, motions);
        }
        Ok(Some(ranges))
    }

    /// Rest and each motion beside it at some values in each part of a candidate's range in which both are.
    pub(super) fn compare_inside(
        &self,
        candidate: &Candidate,
        bistable: &[Bistable],
        found: &FoundMotions,
    ) -> Result<Option<Vec<RestAndMotion>>, Error> {
        let mut compared = Vec::new();
        let [from, to] = candidate.range;
        for range in bistable.iter().filter(|range| range.rests) {
            let [from, to] = [from.max(range.range[0]), to.min(range.range[1])];
            for part in COMPARED.into_iter().filter(|_| from < to) {
                let friction = from + part * (to - from);
                let Some(motions) = self.motions(friction, found.all())? else { return Ok(None) };
                let (rest, others): (Vec<_>, Vec<_>) =
                    motions.known.into_iter().partition(|(ending, _)| ending.rests());
                let Some((rest, _)) = rest.first() else { continue };
                for (other, progress) in &others {
                    let mut takes = [false; 2];
                    if other.kind.is_cycle() {
                        let simulation = self.resume(friction, progress.clone())?;
                        let visited = visited(&simulation, self.plan.observation, other.period)?;
                        takes[1] = visited.has(&candidate.states);
                    }
                    compared.push(RestAndMotion {
                        friction,
                        endings: [rest.clone(), other.clone()],
                        takes,
                    });
                }
            }
        }
        Ok(Some(compared))
    }

    /// The motions, among those that were followed, that are known at a value.
    pub(super) fn motions<'a>(
        &self,
        friction: f64,
        followed: impl Iterator<Item = &'a Followed>,
    ) -> Result<Option<Motions>, Error> {
        let mut motions = Motions { known: Vec::new(), misses: false };
        for followed in followed.filter(|followed| followed.may_reach(friction)) {
            let Some(there) = self.reached(friction, followed)? else { return Ok(None) };
            match there {
                Some(there) if motions.has(&there.0) => {}
                Some(there) => motions.known.push(there),
                None => motions.misses = true,
            }
        }
        Ok(Some(motions))
    }
}

impl Motions {
    /// `true` if a motion is one of them.
    pub(super) fn has(&self, ending: &LongTermMotion) -> bool {
        self.known.iter().any(|(known, _)| are_alike(known, ending))
    }

    /// `true` if one of them rests.
    fn rest(&self) -> bool {
        self.known.iter().any(|(known, _)| known.rests())
    }

    /// Takes in what the scene's own start, or a push out of rest, leads to. One that cannot be followed may exist at this value alone.
    fn meet(&mut self, own: Reached, found: &FoundMotions, new: &mut Vec<Reached>) {
        let (Ok(ending), Some(progress)) = (&own.point.ending, &own.progress) else { return };
        if self.has(ending) || found.has_end_of(&own.point) {
            return;
        }
        if !own.is_settled() {
            self.misses = true;
            return;
        }
        let is_needed = self.known.len() < 2;
        self.known.push((ending.clone(), progress.clone()));
        new.extend(is_needed.then_some(own));
    }
}

impl Ranges {
    /// Adds a range by the motions in its middle, to the last one where that has motions of the same kinds.
    fn add(&mut self, range: [f64; 2], bounded: [bool; 2], friction: f64, motions: Motions) {
        let mut endings = motions.known.into_iter().map(|(ending, _)| ending);
        let (first, second, third) = (endings.next(), endings.next(), endings.next());
        let (Some(first), Some(second)) = (first, second) else {
            self.lone.push(range);
            if motions.misses {
                self.unknown.push(range);
            }
            return;
        };
        let rests = first.rests() != second.rests();
        let kind =
            |ending: &LongTermMotion| if ending.rests() { Kind::Equilibrium } else { ending.kind };
        let kinds = [kind(&first), kind(&second)];
        let third = third.map(|ending| ThirdMotion { friction, ending });
        match self.bistable.last_mut() {
            Some(last) if last.range[1] == range[0] && last.words() == words(kinds) => {
                (last.range[1], last.bounded[1]) = (range[1], bounded[1]);
                last.third = last.third.take().or(third);
            }
            _ => self.bistable.push(Bistable { range, bounded, rests, kinds, third }),
        }
    }
}
