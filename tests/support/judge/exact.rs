//! The judge of exact motion: the matrix exponential of each contact state, and the law at each event.
//!
//! Between two changes of state the motion is linear, and x and ẋ at the end follow from those at the
//! beginning by the exponential of a matrix that is built here from M, C, K, the directions of the
//! contacts and their states. No series, no root and no Delassus block of the integrator is used.
//!
//! If the state changes in a step, the integrator is asked for steps of other lengths from the last change, and the
//! interval that holds the next change is halved until it is negligible. On both of its sides the law must hold, of
//! forces on velocities and, where those vanish, of forces on accelerations; within it nothing happens, or an impact
//! under the law.

mod law;
mod motion;

use super::Run;
use amontons::contact::{ContactForce, ContactState};
use amontons::integrator::{Motion, Statistics, StepFailure, choose};
use amontons::scene::Method;
use amontons::simulation::{Simulation, Snapshot};
pub use motion::Place;
use motion::Span;
pub(super) use motion::{Memory, Swing, fastest};
use nalgebra::DVector;

/// A step asked for that is shorter than this part of the internal step is not taken.
const SHORTEST: f64 = 1.01e-6;
/// Accuracy with which a change of state is located, as a part of the step.
const NEAR: f64 = 1e-13;
/// A slip or gap may hide in rounding for this long, against the time of the fastest mode (rad).
const HIDDEN: f64 = 1e-3;
/// The motion that is judged and the step that was taken have diverged if their velocities differ by more than this
/// part of the fastest.
const FORK: f64 = 1e-9;
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

/// The motion after `t` (s) of a step.
#[derive(Clone)]
struct Observation {
    t: f64,
    statistics: Statistics,
    states: Vec<ContactState>,
    place: Place,
}

impl Observation {
    /// `true` if nothing has happened between the two. Rounding decides whether a slip that just touches zero is an
    /// event, so counts alone do not suffice.
    fn is_same(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|observation| observation.statistics);
        (a.entered, a.touch_downs, a.events, a.ended_hops)
            == (b.entered, b.touch_downs, b.events, b.ended_hops)
            && self.states == other.states
    }
}

impl Run {
    /// The step that began with `self.start`, `t` (s) after its beginning, and the forces reported then.
    fn reported_after(&mut self, t: f64) -> (Place, Vec<ContactForce>) {
        let start: &Snapshot = &self.start.as_ref().unwrap().0;
        let probe =
            self.memory.probe.get_or_insert_with(|| Simulation::resume(start.clone()).unwrap());
        probe.restore(start).unwrap();
        probe.advance_to(probe.time() + t).unwrap();
        let place = [probe.displacement(), probe.velocity()].map(DVector::from_column_slice);
        (place, probe.contact_forces().unwrap().to_vec())
    }

    /// Lets the integrator advance from a time of the step to time `t` (s) of it, in one step.
    ///
    /// # Errors
    /// Returns an error if the integrator finds no forces, which may happen on a way that the step itself does not
    /// take.
    fn go(&mut self, span: &Span, from: &Observation, t: f64) -> Result<Observation, StepFailure> {
        let rest =
            span.force(from.t) - &self.stiffness * self.total(&DVector::zeros(self.model.dofs()));
        let drive = span.drive(&rest, [from.t, t]);
        let [x, v] = from.place.each_ref().map(|place| place.as_slice().to_vec());
        let mut motion = Motion::new(x, v, from.states.clone());
        motion.statistics = from.statistics;
        let integrator = self
            .memory
            .integrator
            .get_or_insert_with(|| choose(&self.model, Method::EventDriven).unwrap());
        integrator.advance(&mut motion, &drive, t - from.t, 1)?;
        let Motion { displacement, velocity, contacts, statistics, .. } = motion;
        let place = [displacement, velocity].map(DVector::from_vec);
        Ok(Observation { t, statistics, states: contacts, place })
    }

    /// Judges the last step of an integrator whose motion is exact.
    ///
    /// If impacts follow each other closely, rounding decides the sequence, so two steps of different lengths from one
    /// state differ after a few impacts. So the motion is followed from change to change: after each the integrator
    /// begins anew, and the judged motion is one of its own.
    #[track_caller]
    pub(super) fn judge_exact_step(&mut self) {
        self.changes.clear();
        self.segments.clear();
        self.let_off.steps += 1;
        let span = self.span(self.time() - self.h());
        let end = Observation {
            t: self.h(),
            statistics: self.simulation.statistics(),
            states: self.simulation.contact_states().to_vec(),
            place: self.now.clone(),
        };
        let (_, states, statistics) = self.start.as_ref().unwrap();
        let (statistics, states) = (*statistics, states.clone());
        if end.statistics.ended_hops > statistics.ended_hops {
            // The end of a hop is no impulse that a contact can give.
            self.let_off.ended += 1;
            return;
        }
        let from = Observation { t: 0.0, statistics, states, place: self.before.clone() };
        if !from.is_same(&end) && (!span.is_straight || self.turns(&span)) {
            // Parts of the step would have the slider on other ways.
            self.let_off.bent += 1;
            return;
        }
        match self.judge_way(&span, from, &end) {
            Ok(Some(reached)) => {
                let off = |k: usize| (&reached.place[k] - &end.place[k]).amax();
                let fastest = end.place[1].amax().max(self.scales.velocity);
                let is_other = off(1).max(self.fastest * off(0)) > FORK * fastest;
                self.let_off.forks += u64::from(is_other);
            }
            Ok(None) => self.let_off.crowded += 1,
            Err(_) => self.let_off.forks += 1,
        }
    }

    /// Judges the way of a step from change to change; where it ends, if it has not too many changes. `end`: where the step
    /// ends that was taken.
    ///
    /// # Errors
    /// The integrator finds no forces.
    #[track_caller]
    fn judge_way(
        &mut self,
        span: &Span,
        mut from: Observation,
        end: &Observation,
    ) -> Result<Option<Observation>, StepFailure> {
        let start = self.time() - self.h();
        let mut states = from.states.clone();
        for _ in 0..MOST_CHANGES {
            let goal = match end.t - from.t {
                _ if from.t == 0.0 => end.clone(),
                left if left <= self.near() => from.clone(),
                _ => self.go(span, &from, end.t)?,
            };
            if from.is_same(&goal) {
                self.judge_segment(span, &from, &goal, &mut states)?;
                return Ok(Some(goal));
            }
            let [mut before, after] = self.bracket(span, &from, &goal)?;
            if self.turned_at_once(span, &from, &before, &after) {
                self.let_off.turned += 1;
                before = from.clone();
            }
            if before.t > from.t {
                self.judge_segment(span, &from, &before, &mut states)?;
            } else if from.t > 0.0 {
                states.clone_from(&from.states);
            }
            self.judge_event(span, &before, &after, &states);
            self.changes.push(Change {
                time: start + after.t,
                has_landed: after.statistics.touch_downs > before.statistics.touch_downs,
                before: before.place,
                after: after.place.clone(),
            });
            from = after;
        }
        Ok(None)
    }

    /// `true` if a surface that gives frozen friction its direction turns round within the step. The friction keeps the
    /// direction of the whole step.
    fn turns(&self, span: &Span) -> bool {
        let contacts = 0..span.steady.len();
        let turns = |i| span.slider(i, 0.0) * span.slider(i, self.h()) < 0.0;
        self.model.law.has_fixed_state() && contacts.into_iter().any(turns)
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
                let (place, forces) = self.reported_after(t);
                let values = f(self, &place, &forces);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * half * value);
            }
        }
        sum
    }

    /// Accuracy with which a change of state is located, s.
    fn near(&self) -> f64 {
        (NEAR * self.h()).max(8.0 * f64::EPSILON * self.time())
    }

    /// The last time known to be before the next change of state, and the first known to be after it.
    ///
    /// If a contact just touches, a way that ends at one time may miss the touch that one which ends earlier has found:
    /// the earliest touch is searched for.
    fn bracket(
        &mut self,
        span: &Span,
        from: &Observation,
        goal: &Observation,
    ) -> Result<[Observation; 2], StepFailure> {
        let (mut before, mut after) = (from.clone(), goal.clone());
        let near = self.near();
        while after.t - before.t > near {
            let middle = self.go(span, from, 0.5 * (before.t + after.t))?;
            if middle.is_same(from) {
                before = middle;
            } else {
                after = middle;
            }
            if after.t - before.t <= near
                && let Some(found) = self.found_before(span, from, &before)?
            {
                (before, after) = (from.clone(), found);
            }
        }
        Ok([before, after])
    }

    /// If other contacts push a contact that has just begun to slip the wrong way, or press one that has just opened,
    /// its slip or gap is only rounding error at first: shorter steps do not see it. A longer one does, and its motion
    /// is that of the new states from the beginning, without an impact.
    fn turned_at_once(
        &mut self,
        span: &Span,
        from: &Observation,
        before: &Observation,
        after: &Observation,
    ) -> bool {
        let passed = [from.t, after.t - from.t];
        let (moved, allowed) = self.moved(span, before, after);
        if before.t == from.t || moved <= allowed || passed[1] * self.fastest > HIDDEN {
            return false;
        }
        // A contact that lands with a velocity makes an impact of its own.
        let fast = from.place[1].amax().max(self.scales.velocity);
        let lands = (0..after.states.len()).any(|i| {
            let opening = self.directions.column(2 * i).dot(&from.place[1]);
            after.states[i] != from.states[i] && opening.abs() > 8.0 * f64::EPSILON * fast
        });
        if lands {
            return false;
        }
        let held = self.held(&after.states, &span.start.friction);
        let (expected, lost) = self.follow(held, &from.place, span, passed);
        let off = |k: usize| (&expected[k] - &after.place[k]).amax();
        off(1).max(self.fastest * off(0)) <= lost + self.forgiven * self.scales.velocity
    }

    /// A way that ends before this one and has found a change.
    fn found_before(
        &mut self,
        span: &Span,
        from: &Observation,
        to: &Observation,
    ) -> Result<Option<Observation>, StepFailure> {
        let near = self.near();
        let earlier = (1..20).map(|growths| to.t - near * 8.0_f64.powi(growths));
        for t in earlier.take_while(|t| t - from.t > near) {
            let observation = self.go(span, from, t)?;
            if !observation.is_same(from) {
                return Ok(Some(observation));
            }
        }
        Ok(None)
    }

    /// The contact states between two times of a step without a change of state between them; `last` are those in the
    /// segment before.
    fn states_between(
        &mut self,
        span: &Span,
        from: &Observation,
        to: &Observation,
        last: &[ContactState],
    ) -> Result<Vec<ContactState>, StepFailure> {
        let is_whole = from.t == 0.0 && to.t == self.h();
        let now = self.simulation.contact_states();
        // Parts of a step in which a slider bends would not be parts of the same motion.
        if is_whole && (last == now || !span.is_straight) {
            return Ok(now.to_vec());
        }
        Ok(self.go(span, from, 0.5 * (from.t + to.t))?.states)
    }

    /// Judges the motion between two times of a step without a change of state between them, and the law
    /// at both. `last` are the contact states in the segment before, and then those in this one.
    #[track_caller]
    fn judge_segment(
        &mut self,
        span: &Span,
        from: &Observation,
        to: &Observation,
        last: &mut Vec<ContactState>,
    ) -> Result<(), StepFailure> {
        let time = self.time() - self.h();
        if to.t - from.t < 10.0 * self.near() {
            // Nothing can happen in so short a time, and what goes on in it cannot be looked at.
            let (moved, allowed) = self.moved(span, from, to);
            assert!(moved <= allowed, "at {time} s velocities jump by {moved}");
            last.clone_from(&to.states);
            return Ok(());
        }
        let states = self.states_between(span, from, to, last)?;
        let held = self.held(&states, &span.start.friction);
        if self.memory.held[held].is_undetermined {
            self.let_off.undetermined += 1;
            *last = states;
            return Ok(());
        }
        self.segments.push([from.t, to.t]);
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
        *last = states;
        if self.fit.is_none() && to.t - from.t < SHORTEST * self.internal_step() {
            // The length of the requested step determines how soon a contact is seen to leave a surface that begins to
            // move.
            return Ok(());
        }
        // Either end is known up to the accuracy of a change.
        self.lasts = to.t - from.t - 2.0 * self.near();
        self.judge_instant(span, from, held, false);
        if from.t > 0.0 {
            self.judge_onset(span, from, held);
        }
        self.lasts = f64::INFINITY;
        self.judge_instant(span, to, held, true);
        Ok(())
    }
}
