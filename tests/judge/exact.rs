//! The judge of exact motion: the matrix exponential of each contact state, and the law at each event.
//!
//! Between two changes of state the motion is linear, and x and ẋ at the end follow from those at the
//! beginning by the exponential of a matrix that is built here from M, C, K, the directions of the
//! contacts and their states. No series, no root and no Delassus block of the integrator is used.
//!
//! A step in which something changes is taken again from its beginning, as long as up to the change: the
//! interval that holds it is halved until it is next to nothing. On both of its sides the law must hold,
//! of forces on velocities and, where those vanish, of forces on accelerations; what happens in it is

mod law;
mod motion;

use super::Run;
use amontons::contact::{ContactForce, ContactState};
use amontons::simulation::{Simulation, Snapshot};
pub use motion::Place;
use motion::Span;
pub(super) use motion::{Memory, Swing, fastest};
use nalgebra::DVector;

/// A step asked for that is shorter than this part of the internal step is not taken.
const SHORTEST: f64 = 1.01e-6;
/// One that is nearer to a whole one than this part of it is taken as whole.
const NEAREST: f64 = 1.01e-9;
/// How near a change of state is looked at, as a part of the step.
const NEAR: f64 = 1e-13;
/// Contacts that throw each other off may be left with this part of the fastest velocity, or not.
const SLOW: f64 = 1e-10;
/// More changes in one step than this are not followed one by one.
const MOST_CHANGES: usize = 60;

/// A change of state.
#[derive(Clone, Debug)]
pub struct Change {
    /// s.
    pub time: f64,
    /// Did a contact land?
    pub has_landed: bool,
    /// Displacements and velocities before and after.
    pub before: Place,
    pub after: Place,
}

/// What has happened up to some time in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Count {
    changes: u64,
    touch_downs: u64,
    ended_hops: u64,
    events: u64,
}

impl Count {
    pub(super) fn of(simulation: &Simulation) -> Self {
        let statistics = simulation.statistics();
        let (changes, touch_downs) = (statistics.state_changes(), statistics.touch_downs);
        let (ended_hops, events) = (statistics.ended_hops, statistics.events);
        Self { changes, touch_downs, ended_hops, events }
    }
}

impl Count {
    /// Has less happened than so much?
    fn is_fewer(self, than: Self) -> bool {
        self.changes < than.changes
            || self.touch_downs < than.touch_downs
            || self.events < than.events
    }
}

/// The state of a step that began in `start` after `t` (s).
#[derive(Clone)]
struct Look {
    t: f64,
    count: Count,
    states: Vec<ContactState>,
    place: Place,
}

impl Look {
    /// Has nothing happened between the two? Whether a slip that just touches zero is an event may differ
    /// between a step and parts of it, so counts alone do not tell.
    fn is_same(&self, other: &Self) -> bool {
        self.count == other.count && self.states == other.states
    }
}

impl Run {
    /// The step that began with `self.start`, `t` (s) after its beginning, and the forces reported then.
    fn look(&mut self, t: f64) -> (Look, Vec<ContactForce>) {
        let start: &Snapshot = &self.start.as_ref().unwrap().0;
        let probe =
            self.memory.probe.get_or_insert_with(|| Simulation::resume(start.clone()).unwrap());
        probe.restore(start).unwrap();
        if t > 0.0 {
            probe.advance_to(probe.time() + t).unwrap();
        }
        let place = [probe.displacement(), probe.velocity()].map(DVector::from_column_slice);
        let count = Count::of(probe);
        let states = probe.contact_states().to_vec();
        let forces = probe.contact_forces().unwrap().to_vec();
        (Look { t, count, states, place }, forces)
    }

    /// Judges the last step of an integrator whose motion is exact.
    #[track_caller]
    pub(super) fn judge_exact_step(&mut self) {
        let h = self.h();
        self.changes.clear();
        self.segments.clear();
        let span = self.span(self.time() - h);
        let count = Count::of(&self.simulation);
        let states = self.simulation.contact_states().to_vec();
        let end = Look { t: h, count, states, place: self.now.clone() };
        self.let_off.steps += 1;
        let (_, states, count) = self.start.as_ref().unwrap();
        if end.count.ended_hops > count.ended_hops {
            // What ends a hop is no impulse that a contact can give.
            self.let_off.ended += 1;
            return;
        }
        let mut states = states.clone();
        let place = self.before.clone();
        let mut from = Look { t: 0.0, count: *count, states: states.clone(), place };
        if !span.is_straight && !from.is_same(&end) {
            // Parts of the step would have the slider on other ways.
            self.let_off.bent += 1;
            return;
        }
        for _ in 0..MOST_CHANGES {
            let is_last = from.is_same(&end);
            let [mut before, mut after] =
                if is_last { [end.clone(), end.clone()] } else { self.bracket(&from, &end) };
            if !is_last {
                self.forget_flicker(&mut after, &end);
            }
            let passed_over = self.passed_over(&span, &from, &before, &states);
            if let Some(found) = passed_over {
                [before, after] = found;
            } else if is_last {
                self.judge_segment(&span, &from, &end, &mut states);
                return;
            }
            if before.t > from.t {
                self.judge_segment(&span, &from, &before, &mut states);
            }
            let (moved, allowed) = self.moved(&span, &before, &after);
            if after.count.is_fewer(before.count) && moved <= allowed {
                // One bounce or change more in the shorter part: two motions that both obey the law.
                self.let_off.flickers += 1;
                from = after;
                continue;
            }
            self.judge_event(&span, &before, &after, &states);
            self.changes.push(Change {
                time: self.time() - h + after.t,
                has_landed: after.count.touch_downs > before.count.touch_downs,
                before: before.place,
                after: after.place.clone(),
            });
            from = after;
        }
        self.let_off.crowded += 1;
    }

    /// The integral over the last step of what `f` makes of a motion and its contact forces: Gauss's
    /// formula of five points between changes of state.
    pub fn integral<const N: usize>(
        &mut self,
        f: impl Fn(&Self, &Place, &[ContactForce]) -> [f64; N],
    ) -> [f64; N] {
        let (near, far) = (0.538_469_310_105_683, 0.906_179_845_938_664);
        let [inner, outer] = [0.478_628_670_499_366_5, 0.236_926_885_056_189_1];
        let middle = 2.0 - 2.0 * (inner + outer);
        let rule = [(-far, outer), (-near, inner), (0.0, middle), (near, inner), (far, outer)];
        let mut sum = [0.0; N];
        for [from, to] in self.segments.clone() {
            let half = 0.5 * (to - from);
            for (at, weight) in rule {
                let t = from + half * (1.0 + at);
                if t < SHORTEST * self.internal_step() {
                    continue;
                }
                let (look, forces) = self.look(t);
                let values = f(self, &look.place, &forces);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * half * value);
            }
        }
        sum
    }

    /// How near a change of state is looked at, s.
    fn near(&self) -> f64 {
        (NEAR * self.h()).max(8.0 * f64::EPSILON * self.time())
    }

    /// A step that ends right after a change may count changes there and back that one which goes on does not:
    /// rounding is all that there is of the motion in between. They would be missed later.
    fn forget_flicker(&mut self, after: &mut Look, end: &Look) {
        let (left, shortest) = (end.t - after.t, SHORTEST * self.internal_step());
        let parts = (1..20).map(|halvings| 0.5_f64.powi(halvings));
        for part in parts.filter(|part| part * left > shortest) {
            let (later, _) = self.look(after.t + part * left);
            if later.count.changes < after.count.changes {
                after.count = later.count;
                self.let_off.flickers += 1;
            }
        }
    }

    /// The last time known to be before the next change of state, and the first known to be after it.
    fn bracket(&mut self, from: &Look, end: &Look) -> [Look; 2] {
        self.bracket_of(from, end, |_, look| look.is_same(from))
    }

    /// The last time known to be before the end of what `keeps` says, and the first known to be after it.
    fn bracket_of(
        &mut self,
        from: &Look,
        end: &Look,
        mut keeps: impl FnMut(&mut Self, &Look) -> bool,
    ) -> [Look; 2] {
        let (mut before, mut after) = (from.clone(), end.clone());
        // Signals take a time that is as near to an edge of theirs for the edge.
        let nearest = if self.signals.is_empty() { NEAREST } else { SHORTEST };
        let internal = self.internal_step();
        let (shortest, longest) = (SHORTEST * internal, self.h() - nearest * internal);
        let near = self.near();
        while after.t - before.t > near {
            let middle = 0.5 * (before.t + after.t);
            if middle < shortest || middle > longest {
                break;
            }
            let (look, _) = self.look(middle);
            if keeps(self, &look) {
                before = look;
            } else {
                after = look;
            }
        }
        [before, after]
    }

    /// The contact states between two times of a step without a change of state between them; `last` are those in the
    /// segment before.
    fn states_between(
        &mut self,
        span: &Span,
        from: &Look,
        to: &Look,
        last: &[ContactState],
    ) -> Vec<ContactState> {
        let is_whole = from.t == 0.0 && to.t == self.h();
        let now = self.simulation.contact_states();
        // Parts of a step in which a slider bends would not be parts of the same motion.
        if is_whole && (last == now || !span.is_straight) {
            return now.to_vec();
        }
        self.look((0.5 * (from.t + to.t)).max(SHORTEST * self.internal_step())).0.states
    }

    /// Does the motion from one time to another keep to these states?
    fn follows(&mut self, span: &Span, from: &Look, to: &Look, states: &[ContactState]) -> bool {
        let held = self.held(states, &span.start.friction);
        let (expected, lost) = self.follow(held, &from.place, span, [from.t, to.t - from.t]);
        let allowed = lost + self.forgiven * self.scales.velocity;
        let factors = [self.fastest, 1.0];
        let mut parts = expected.iter().zip(&to.place).zip(factors);
        parts.all(|((expected, found), factor)| ((expected - found) * factor).amax() <= allowed)
    }

    /// An impact or a change of state between two times of a step whose counts and states are the same, as `bracket` has it.
    /// Of contacts that throw each other off, a part of a step may count one bounce more. That hides the next event, if
    /// the states before and after it are the same. The motion tells of it: there it leaves the way that it was on. What leaves its way in no
    /// such event is left to `judge_segment`.
    fn passed_over(
        &mut self,
        span: &Span,
        from: &Look,
        to: &Look,
        last: &[ContactState],
    ) -> Option<[Look; 2]> {
        if !span.is_straight || to.t - from.t < 10.0 * self.near() {
            return None;
        }
        let states = self.states_between(span, from, to, last);
        // A step may begin with inputs that have ended the states before it.
        let goes_on = from.t == 0.0 || states == from.states;
        if goes_on && self.follows(span, from, to, &states) {
            return None;
        }
        let keeps = |run: &mut Self, look: &Look| {
            look.states == from.states && run.follows(span, from, look, &from.states)
        };
        let [before, after] = self.bracket_of(from, to, keeps);
        let (moved, allowed) = self.moved(span, &before, &after);
        (after.states != before.states || moved > allowed).then_some([before, after])
    }

    /// Judges the motion between two times of a step without a change of state between them, and the law
    /// at both. `last` are the contact states in the segment before, and then those in this one.
    #[track_caller]
    fn judge_segment(&mut self, span: &Span, from: &Look, to: &Look, last: &mut Vec<ContactState>) {
        let time = self.time() - self.h();
        if to.t - from.t < 10.0 * self.near() {
            // Nothing can happen in so short a time, and what goes on in it cannot be looked at.
            let (moved, allowed) = self.moved(span, from, to);
            assert!(moved <= allowed, "at {time} s velocities jump by {moved}");
            return;
        }
        self.segments.push([from.t, to.t]);
        let states = self.states_between(span, from, to, last);
        let held = self.held(&states, &span.start.friction);
        let (expected, lost) = self.follow(held, &from.place, span, [from.t, to.t - from.t]);
        for (i, factor) in [self.fastest, 1.0].into_iter().enumerate() {
            let off = (&expected[i] - &to.place[i]) * factor;
            assert!(
                off.amax() <= lost + self.forgiven * self.scales.velocity,
                "the motion is off by {:e}, allowed {lost:e}, from {} to {} s in {states:?}: {:?} and not {:?}",
                off.amax(),
                time + from.t,
                time + to.t,
                to.place,
                expected,
            );
        }
        // Either end is known as near as a change is looked at.
        self.lasts = to.t - from.t - 2.0 * self.near();
        self.judge_instant(span, from, held, false);
        if from.t > 0.0 {
            self.judge_onset(span, from, held);
        }
        self.lasts = f64::INFINITY;
        self.judge_instant(span, to, held, true);
        *last = states;
    }
}
