//! Motions over µ as far as they were followed.

use super::findings::{Jump, Point, SweepDirection};
use crate::study::difference::{OTHER_EXTENT, are_two, distance, is_exact};
use crate::study::long_term::{Kind, LongTermMotion};
use amontons::numerics::range;
use amontons::simulation::Progress;

/// A value of µ with the state that its motion has ended in.
#[derive(Clone)]
pub(super) struct Reached {
    pub(super) point: Point,
    pub(super) progress: Option<Progress>,
}

impl Reached {
    /// A value at which a motion is not followed because it has taken too many rows.
    pub(super) fn not_tried(friction: f64) -> Self {
        let ending =
            Err("the motion was not followed to this value because that would take too long"
                .to_owned());
        Self { point: Point { friction, ending }, progress: None }
    }

    pub(super) fn ending(&self) -> Option<&LongTermMotion> {
        self.point.ending.as_ref().ok()
    }

    /// `true` of a motion that can be followed: it has settled or is on its way to rest, and does not grow without bound.
    pub(super) fn is_settled(&self) -> bool {
        self.ending().is_some_and(|ending| ending.kind.is_cycle() || ending.rests())
    }

    /// `true` of a cycle.
    pub(super) fn is_cycle(&self) -> bool {
        self.ending().is_some_and(|ending| ending.kind.is_cycle())
    }

    /// `true` of a motion that has neither settled nor is on its way to rest.
    pub(super) fn is_open(&self) -> bool {
        self.ending().is_some_and(is_open)
    }
}

/// One way, or another motion, as far as it was followed.
#[derive(Clone)]
pub(super) struct Followed {
    pub(super) way: SweepDirection,
    /// Its label in the journal, and nowhere else: the journal identifies a piece of work by the label and the values
    /// of µ.
    pub(super) label: String,
    /// All values that it has passed, in its order, those between the asked ones included.
    pub(super) passed: Vec<Reached>,
    pub(super) jumps: Vec<Jump>,
    /// `true` while the last motion is one that has left another at a jump and has not settled.
    pub(super) is_leaving: bool,
    /// The motions beyond the ends of one that is followed no farther than it exists; `None` of a way, which passes its
    /// jumps.
    pub(super) beyond: Option<Vec<Reached>>,
    /// Number of rows that its runs may still take.
    pub(super) rows_left: u64,
    /// `true` where each step of µ is to be so small that the smallest jump is seen, not only those by 5 %.
    pub(super) looks_closely: bool,
}

impl Followed {
    /// A way, which passes its jumps.
    pub(super) fn way(way: SweepDirection, label: String, first: Reached) -> Self {
        Self {
            way,
            label,
            passed: vec![first],
            jumps: Vec::new(),
            is_leaving: false,
            beyond: None,
            rows_left: u64::MAX,
            looks_closely: false,
        }
    }

    /// One motion, which is followed no farther than to its first jump and for no more than some rows.
    pub(super) fn motion(
        way: SweepDirection,
        label: String,
        first: Reached,
        rows_left: u64,
    ) -> Self {
        let is_leaving = first.is_open();
        Self { is_leaving, beyond: Some(Vec::new()), rows_left, ..Self::way(way, label, first) }
    }

    /// One motion, followed downwards and upwards from the same value.
    pub(super) fn joined(mut down: Self, up: Self) -> Self {
        down.passed.extend(up.passed.into_iter().skip(1));
        down.jumps.extend(up.jumps);
        down.rows_left = down.rows_left.min(up.rows_left);
        down.beyond.get_or_insert_default().extend(up.beyond.into_iter().flatten());
        down
    }

    /// The motion reached at a value that it has passed.
    pub(super) fn at(&self, friction: f64) -> Option<&Reached> {
        self.passed.iter().find(|reached| reached.point.friction == friction)
    }

    /// `true` if a motion of it at one value and the next may be the same motion.
    pub(super) fn stays(&self, before: &LongTermMotion, after: &LongTermMotion) -> bool {
        let differ = if self.looks_closely {
            are_two(before, after)
        } else {
            distance(before, after) > OTHER_EXTENT
        };
        self.is_leaving || !differ
    }

    /// `true` if this way and another one have two different periodic motions at a value, both known exactly.
    pub(super) fn is_other_than(&self, other: &Self, friction: f64) -> bool {
        let [here, there] = [self, other].map(|way| way.at(friction).and_then(Reached::ending));
        let (Some(here), Some(there)) = (here, there) else { return false };
        is_exact(here) && is_exact(there) && are_two(here, there)
    }

    /// Takes over the state of this way on a stretch on which it was followed once more. Where the stretch has
    /// failed, the way ends.
    /// Returns the first of each run of settled motions of this way that the stretch has not met.
    pub(super) fn take_over(&mut self, stretch: Self) -> Vec<Reached> {
        let way = self.way;
        let along = |friction: f64| match way {
            SweepDirection::Rising => friction,
            SweepDirection::Falling => -friction,
        };
        let [Some(first), Some(last)] = [stretch.passed.first(), stretch.passed.last()] else {
            return Vec::new();
        };
        let [from, to] = [first, last].map(|end| along(end.point.friction));
        let can_continue = stretch.can_continue();
        let is_beside =
            |friction: f64| along(friction) < from || can_continue && along(friction) > to;
        let (kept, replaced): (Vec<_>, Vec<_>) = std::mem::take(&mut self.passed)
            .into_iter()
            .partition(|reached| is_beside(reached.point.friction));
        let is_lost = |reached: &Reached| {
            let now = stretch.at(reached.point.friction).and_then(Reached::ending);
            let is_met = matches!((reached.ending(), now), (Some(a), Some(b)) if are_alike(a, b));
            reached.is_settled() && !is_met
        };
        // Each passes values of its own between those that are asked for.
        let both = |reached: &&Reached| {
            let friction = reached.point.friction;
            along(friction) > to || stretch.at(friction).is_some()
        };
        let compared: Vec<&Reached> = replaced.iter().filter(both).collect();
        let runs = compared.chunk_by(|a, b| is_lost(a) == is_lost(b));
        let lost = runs.map(|run| run[0].clone()).filter(is_lost).collect();
        self.passed = kept;
        self.jumps.retain(|jump| is_beside(jump.at()));
        self.passed.extend(stretch.passed);
        self.jumps.extend(stretch.jumps);
        self.passed.sort_by(|a, b| along(a.point.friction).total_cmp(&along(b.point.friction)));
        self.jumps.sort_by(|a, b| along(a.at()).total_cmp(&along(b.at())));
        lost
    }

    /// `true` if it can be followed further from where it is.
    pub(super) fn can_continue(&self) -> bool {
        let has_ended = self.beyond.is_some() && !self.jumps.is_empty();
        !has_ended && self.passed.last().is_some_and(|last| last.progress.is_some())
    }

    /// The lowest and the highest value that it has passed.
    pub(super) fn extent(&self) -> [f64; 2] {
        range(self.passed.iter().map(|reached| reached.point.friction))
    }

    /// `true` of a way, which passes its jumps.
    pub(super) const fn is_way(&self) -> bool {
        self.beyond.is_none()
    }

    /// `true` of a value that lies among those that it has passed.
    pub(super) fn covers(&self, friction: f64) -> bool {
        let [low, high] = self.extent();
        (low..=high).contains(&friction)
    }

    /// `true` of a value for which its motion is asked: any of a way; of another motion one that it covers or that lies beyond
    /// one at which it could not be followed on.
    pub(super) fn may_reach(&self, friction: f64) -> bool {
        let [low, high] = self.extent();
        let fails = |end: f64| self.at(end).is_some_and(|reached| reached.point.ending.is_err());
        self.is_way()
            || self.covers(friction)
            || friction < low && fails(low)
            || friction > high && fails(high)
    }

    /// The passed value nearest to another one with a motion, on the same side of all jumps; one with a settled motion
    /// where there is one.
    pub(super) fn nearest(&self, friction: f64) -> Option<Reached> {
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

    /// The settled motions that this way has jumped to, each with the place of its jump: at the first value beyond at which
    /// the motion has settled.
    pub(super) fn jumped_to(&self) -> impl Iterator<Item = (Reached, &Jump)> {
        self.jumps.iter().enumerate().filter_map(|(place, jump)| {
            let from = self.place(jump.between[1])?;
            let next = self.jumps.get(place + 1);
            let to = next.and_then(|jump| self.place(jump.between[0]));
            let mut passed = self.passed[from..=to.unwrap_or(self.passed.len() - 1)].iter();
            let settled = passed.find(|reached| reached.is_settled())?;
            Some((settled.clone(), jump))
        })
    }

    fn place(&self, friction: f64) -> Option<usize> {
        self.passed.iter().position(|reached| reached.point.friction == friction)
    }
}

/// `true` of two motions at the same value that are known and are the same one.
pub(super) fn are_alike(a: &LongTermMotion, b: &LongTermMotion) -> bool {
    is_known(a) && is_known(b) && !are_two(a, b)
}

/// `true` of a motion that has settled, or is on its way to rest or away from it.
pub(super) fn is_known(ending: &LongTermMotion) -> bool {
    ending.kind != Kind::Unsettled || ending.is_known()
}

/// `true` of a motion that may become any motion.
pub(super) fn is_open(ending: &LongTermMotion) -> bool {
    ending.kind == Kind::Unsettled && !ending.rests()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::difference::tests::undecided;
    use amontons::scene::builtin;
    use amontons::simulation::Simulation;

    /// Values of µ that a way has passed, at the last of which it has failed if it `fails`.
    fn passed(values: &[f64], fails: bool) -> Vec<Reached> {
        let simulation = Simulation::new(builtin("set2").unwrap().scene(), 0.0).unwrap();
        let progress = Some(simulation.save().into_progress());
        let reached = |friction: &f64| Reached {
            point: Point { friction: *friction, ending: Err("not looked at".to_owned()) },
            progress: progress.clone(),
        };
        let mut passed: Vec<Reached> = values.iter().map(reached).collect();
        if fails {
            passed.last_mut().unwrap().progress = None;
        }
        passed
    }

    fn falling(values: &[f64], fails: bool) -> Followed {
        let mut reached = passed(values, fails).into_iter();
        let mut way =
            Followed::way(SweepDirection::Falling, "falling".to_owned(), reached.next().unwrap());
        way.passed.extend(reached);
        way
    }

    fn values(way: &Followed) -> Vec<f64> {
        way.passed.iter().map(|reached| reached.point.friction).collect()
    }

    /// A jump of falling µ after a value.
    fn jump(from: f64) -> Jump {
        let between = [from, from - 1e-4];
        let endings = [0, 1].map(|_| undecided(1e-4, 0.0, 168.0));
        Jump {
            way: SweepDirection::Falling,
            among: Some(SweepDirection::Falling),
            is_end: false,
            between,
            endings,
        }
    }

    #[test]
    fn jumps_of_a_way_are_those_of_the_stretch_where_it_was_followed_once_more() {
        let mut way = falling(&[0.9, 0.8, 0.7, 0.6], false);
        way.jumps = vec![jump(0.85), jump(0.72), jump(0.65)];
        let stretch = Followed {
            jumps: vec![jump(0.78), jump(0.74)],
            ..falling(&[0.8, 0.79, 0.78, 0.7], false)
        };
        way.take_over(stretch);
        let from = way.jumps.iter().map(|jump| jump.between[0]);
        assert_eq!(from.collect::<Vec<_>>(), [0.85, 0.78, 0.74, 0.65]);
    }

    #[test]
    fn a_way_goes_on_behind_a_stretch_on_which_it_was_followed_once_more() {
        let mut way = falling(&[0.9, 0.8, 0.75, 0.7, 0.6], false);
        let lost = way.take_over(falling(&[0.8, 0.79, 0.78, 0.7], false));
        assert_eq!(values(&way), [0.9, 0.8, 0.79, 0.78, 0.7, 0.6]);
        assert!(lost.is_empty());
    }

    #[test]
    fn a_way_ends_where_a_stretch_on_which_it_was_followed_once_more_has_failed() {
        let mut way = falling(&[0.9, 0.8, 0.75, 0.7, 0.6], false);
        way.take_over(falling(&[0.8, 0.79, 0.78], true));
        assert_eq!(values(&way), [0.9, 0.8, 0.79, 0.78]);
        assert!(!way.can_continue());
    }
}
