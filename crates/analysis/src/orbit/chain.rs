//! A periodic motion as a chain of segments, and Newton's method on all of them together.
//!
//! Segment k begins in the state y_k, just after an instant at which contacts changed their states, keeps its contact
//! states for the time τ_k, and ends where h_k(y) = 0: at the next such instant or, in a driven motion, once in a
//! period where the first sine has its phase of time 0. R_k is the map across that instant, linear or, where a sine
//! drives friction, linearised about the motion. With y_k⁻, the state that y_k reaches after τ_k, the unknowns
//! (x_k, ẋ_k) and τ_k satisfy
//!
//! ```text
//! y_{k+1} = R_k y_k⁻,   h_k y_k⁻ = 0,   y_m = y_0.
//! ```
//!
//! y_k⁻ = Φ_k y_k with the fundamental matrix Φ_k of the segment ([`Flow::propagator`]): exp(A_k τ_k), unless a sine
//! drives friction.
//!
//! The linear equations of Newton's method are condensed to the changes of (x_0, ẋ_0): each τ_k follows from its own
//! h_k, whose rate along the motion must not be zero, and each y_{k+1} from y_k. A motion without a drive begins at an
//! event, which fixes its phase. Unlike a run over the whole period, the chain leaves no error that an unstable motion
//! amplifies: each equation is met to rounding.

use super::field::Field;
use super::flow::{Flow, Instant, Stage};
use super::matrix::{product, times};
use amontons::contact::ContactState;
use amontons::integrator::{Motion, StepFailure};
use nalgebra::{DMatrix, DVector};

/// Most corrections of one chain.
const MOST_CORRECTIONS: usize = 40;
/// A chain whose next correction is smaller, in parts of the motion's size and of its period, is solved.
const SOLVED: f64 = 1e-12;
/// A correction this small that no longer falls is rounding.
const ROUNDING: f64 = 1e-9;
/// Least part of a correction that is tried.
const LEAST_PART: f64 = 1.0 / 256.0;

/// States and durations of a motion that repeats itself differ by less, in parts of its size and period.
const SAME: f64 = 1e-8;

/// A part of a periodic motion in which contacts keep their states.
#[derive(Clone, Debug)]
pub struct Segment {
    /// The states of the contacts.
    pub states: Vec<ContactState>,
    /// The state at its beginning.
    pub start: DVector<f64>,
    /// Its duration, s.
    pub duration: f64,
    /// The events that end the segment; none where the period of a driven motion ends.
    pub stages: Vec<Stage>,
}

/// A closed chain of segments.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The segments, in their order.
    pub segments: Vec<Segment>,
    /// Scales of displacements, m, and of velocities, m/s: the largest ranges over the motion that the chain began with.
    pub scales: [f64; 2],
    /// By how much the first sine has turned since time 0 when the chain begins, rad; 0 without a drive.
    pub turn: f64,
}

/// The reason why a chain has no solution nearby.
#[derive(Clone, Debug, PartialEq)]
pub enum Unsolved {
    /// A step or a contact problem failed.
    Failed(StepFailure),
    /// An event whose function this analysis does not have: contacts hold more directions than their masses have.
    Unknown {
        /// The segment that it ends.
        segment: usize,
    },
    /// A motion meets the end of a segment tangentially.
    Grazes {
        /// The segment.
        segment: usize,
    },
    /// No correction brings the ends of the segments nearer to each other.
    Stalled,
}

impl From<StepFailure> for Unsolved {
    fn from(failure: StepFailure) -> Self {
        Self::Failed(failure)
    }
}

/// The linear parts of one segment.
pub struct Linear {
    /// exp(A τ), or the fundamental matrix ([`Flow::propagator`]).
    pub flow: DMatrix<f64>,
    /// The state y⁻ before the instant that ends the segment.
    pub before: DVector<f64>,
    /// Its rate f⁻.
    pub rate: DVector<f64>,
    /// The rate f⁺ after the instant.
    pub rate_after: DVector<f64>,
    /// The row h of the function that ends the segment.
    pub row: DVector<f64>,
    /// h f⁻.
    pub slope: f64,
    /// The map R across the instant.
    pub reset: DMatrix<f64>,
    /// Number of the state's places that depend on time alone.
    pub times: usize,
}

impl Linear {
    /// R (1 − f⁻ h/(h f⁻)): changes of the state just before the event, to changes just after it, each at the event of
    /// its own motion.
    pub fn from_event_to_event(&self) -> DMatrix<f64> {
        let along = times(&self.reset, &self.rate);
        &self.reset - along * self.row.transpose() / self.slope
    }

    /// The saltation matrix R + (f⁺ − R f⁻) h/(h f⁻): changes across the event at one time.
    pub fn saltation(&self) -> DMatrix<f64> {
        self.from_event_to_event() + &self.rate_after * self.row.transpose() / self.slope
    }
}

impl Chain {
    /// The chain of a run over one period: from `first` at time `t` (s), through these instants, up to the last of them
    /// or, in a driven motion, to `end` (s after the beginning).
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn of_run(
        flow: &mut Flow,
        first: &Motion,
        t: f64,
        instants: &[Instant],
        end: Option<f64>,
    ) -> Result<Self, StepFailure> {
        let mut segments = Vec::with_capacity(instants.len() + 1);
        let (mut start, mut states) = (flow.state(first, t), first.contacts.clone());
        let mut time = 0.0;
        for instant in instants {
            let next = flow.state(&instant.after, t + instant.time);
            segments.push(Segment {
                states: std::mem::replace(&mut states, instant.after.contacts.clone()),
                start: std::mem::replace(&mut start, next),
                duration: instant.time - time,
                stages: instant.stages.clone(),
            });
            time = instant.time;
        }
        if let Some(end) = end {
            segments.push(Segment { states, start, duration: end - time, stages: Vec::new() });
        }
        let mut chain = Self { segments, scales: [1.0; 2], turn: flow.turn(t) };
        chain.set_scales(flow)?;
        Ok(chain)
    }

    /// The chain of the same driven motion, with its first segment beginning `time` (s) later.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub(super) fn begun_later(&self, flow: &mut Flow, time: f64) -> Result<Self, StepFailure> {
        let begin = flow.time_of(self.turn);
        let (mut place, mut within) = (0, time.rem_euclid(self.period()));
        while place + 1 < self.segments.len() && within > self.segments[place].duration {
            within -= self.segments[place].duration;
            place += 1;
        }
        let divided = &self.segments[place];
        let mut middle = flow.propagate(&divided.states, &divided.start, within)?;
        flow.set_time(&mut middle, begin + time);
        // The old end of the period divides nothing any more.
        let count = self.segments.len();
        let mut segments: Vec<Segment> = Vec::with_capacity(count + 1);
        for k in 0..=count {
            let mut segment = self.segments[(place + k) % count].clone();
            if k == 0 {
                segment.duration -= within;
                segment.start = middle.clone();
            }
            if k == count {
                segment.duration = within;
                segment.stages.clear();
            }
            match segments.last_mut() {
                Some(before) if before.stages.is_empty() => {
                    before.duration += segment.duration;
                    before.stages = segment.stages;
                }
                _ => segments.push(segment),
            }
        }
        let mut chain = Self { segments, scales: self.scales, turn: flow.turn(begin + time) };
        chain.set_times(flow);
        Ok(chain)
    }

    /// The chain of the same driven motion, beginning in the middle of its longest segment, far from all events.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub(super) fn begun_between_events(&self, flow: &mut Flow) -> Result<Self, StepFailure> {
        let count = self.segments.len();
        // The first and the last segment are one.
        let duration = |k: usize| {
            let own = self.segments[k].duration;
            if k == count - 1 && k > 0 { own + self.segments[0].duration } else { own }
        };
        let first = usize::from(count > 1);
        let longest = (first..count).max_by(|a, b| duration(*a).total_cmp(&duration(*b)));
        let longest = longest.unwrap_or(0);
        let before: f64 = self.segments[..longest].iter().map(|segment| segment.duration).sum();
        self.begun_later(flow, before + 0.5 * duration(longest))
    }

    /// The chain of one period of a motion that repeats itself within the chain; `None` of one that does not.
    pub(super) fn of_shortest_period(&self, dofs: usize) -> Option<Self> {
        let count = self.segments.len();
        let is_repeated = |part: usize| {
            (0..count).all(|k| {
                let [a, b] = [k, (k + part) % count].map(|k| &self.segments[k]);
                a.states == b.states
                    && (a.duration - b.duration).abs() <= SAME * self.period()
                    && self.size(dofs, &(&a.start - &b.start)) <= SAME
            })
        };
        let part = (1..count).find(|part| count.is_multiple_of(*part) && is_repeated(*part))?;
        Some(Self { segments: self.segments[..part].to_vec(), ..self.clone() })
    }

    /// Sets the scales to the largest ranges of a displacement and of a velocity over the motion.
    pub(super) fn set_scales(&mut self, flow: &mut Flow) -> Result<(), StepFailure> {
        let dofs = flow.dofs();
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; 2 * dofs];
        for segment in &self.segments {
            flow.each_part(&segment.states, &segment.start, segment.duration, |part| {
                for (range, value) in ranges.iter_mut().zip(&part.powers[0]) {
                    *range = [range[0].min(*value), range[1].max(*value)];
                }
            })?;
        }
        let largest = |ranges: &[[f64; 2]]| {
            ranges.iter().map(|[least, most]| most - least).fold(f64::MIN_POSITIVE, f64::max)
        };
        self.scales = [largest(&ranges[..dofs]), largest(&ranges[dofs..])];
        Ok(())
    }

    /// The period, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration).sum()
    }

    /// The part of the period in which contacts are not in the states of the longest segment.
    pub(super) fn part_away_from_longest(&self) -> f64 {
        let longest = self.segments.iter().max_by(|a, b| a.duration.total_cmp(&b.duration));
        let away = |segment: &&Segment| longest.is_some_and(|other| segment.states != other.states);
        let away = self.segments.iter().filter(away).map(|segment| segment.duration);
        away.sum::<f64>() / self.period()
    }

    /// The times at which segments begin, s.
    pub(super) fn times(&self, flow: &Flow) -> Vec<f64> {
        let mut time = flow.time_of(self.turn);
        let begin = |segment: &Segment| {
            let begins = time;
            time += segment.duration;
            begins
        };
        self.segments.iter().map(begin).collect()
    }

    /// Norm of a state's change in parts of the motion's size.
    pub(super) fn size(&self, dofs: usize, change: &DVector<f64>) -> f64 {
        let [place, speed] = self.scales;
        let part = |(i, value): (usize, &f64)| value.abs() / if i < dofs { place } else { speed };
        change.iter().take(2 * dofs).enumerate().map(part).fold(0.0, f64::max)
    }

    /// The linear parts of all segments.
    ///
    /// # Errors
    /// Returns the segment that ends in an event without a function, or tangentially.
    pub fn linear(&self, flow: &mut Flow) -> Result<Vec<Linear>, Unsolved> {
        let count = self.segments.len();
        (0..count)
            .map(|k| {
                let segment = &self.segments[k];
                let Segment { states, start, duration, .. } = segment;
                let propagator = flow.propagator(states, start, *duration)?;
                let before = times(&propagator, start);
                let field = flow.field(states, &before)?;
                let rate = Flow::rate(&field, &before);
                let next = &self.segments[(k + 1) % count];
                let row = end_row(flow, &field, &before, segment, self.turn)
                    .ok_or(Unsolved::Unknown { segment: k })?;
                let mut reset = flow.held(&segment.states)?;
                let mut states = segment.states.clone();
                for stage in &segment.stages {
                    let now = times(&reset, &before);
                    reset = product(&flow.reset(&states, stage, &now)?, &reset);
                    states.clone_from(&stage.states);
                }
                let reached = times(&reset, &before);
                let after = flow.field(&next.states, &reached)?;
                let slope = row.dot(&rate);
                if is_tangential(&row, &rate, slope) {
                    return Err(Unsolved::Grazes { segment: k });
                }
                Ok(Linear {
                    times: flow.size() - 2 * flow.dofs(),
                    rate_after: Flow::rate(&after, &reached),
                    flow: propagator,
                    before,
                    rate,
                    row,
                    slope,
                    reset,
                })
            })
            .collect()
    }

    /// The residuals of all equations of the chain.
    ///
    /// # Errors
    /// Returns the segment that ends in an event without a function.
    pub(super) fn residuals(&self, flow: &mut Flow) -> Result<Residuals, Unsolved> {
        let count = self.segments.len();
        let (mut defects, mut values) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, segment) in self.segments.iter().enumerate() {
            let before = flow.propagate(&segment.states, &segment.start, segment.duration)?;
            let field = flow.field(&segment.states, &before)?;
            let row = end_row(flow, &field, &before, segment, self.turn)
                .ok_or(Unsolved::Unknown { segment: k })?;
            values.push(row.dot(&before));
            let mut reached = times(&flow.held(&segment.states)?, &before);
            let mut states = &segment.states;
            for stage in &segment.stages {
                reached = times(&flow.reset(states, stage, &reached)?, &reached);
                states = &stage.states;
            }
            defects.push(reached - &self.segments[(k + 1) % count].start);
        }
        Ok(Residuals { defects, values })
    }

    /// The largest residual, in parts of the motion's size and of its period.
    fn largest_residual(&self, dofs: usize, linear: &[Linear], residuals: &Residuals) -> f64 {
        let period = self.period();
        let defects = residuals.defects.iter();
        let defects = defects.map(|defect| self.size(dofs, defect)).fold(0.0, f64::max);
        let misses = residuals.values.iter().zip(linear);
        let misses = misses.map(|(value, linear)| (value / linear.slope).abs() / period);
        misses.fold(defects, f64::max)
    }

    /// The largest gap between the end of a segment and the beginning of the next, in parts of the motion's size, or by
    /// which an event is missed, in parts of the period; `None` where the chain has no derivative.
    pub fn largest_gap(&self, flow: &mut Flow) -> Option<f64> {
        let linear = self.linear(flow).ok()?;
        let residuals = self.residuals(flow).ok()?;
        Some(self.largest_residual(flow.dofs(), &linear, &residuals))
    }

    /// Corrects the chain until all its equations are met to rounding; returns the number of corrections.
    ///
    /// # Errors
    /// Returns why it has no solution nearby. The chain is then the best one that was found.
    pub fn solve(&mut self, flow: &mut Flow) -> Result<usize, Unsolved> {
        let dofs = flow.dofs();
        let mut last = f64::INFINITY;
        for corrections in 0..MOST_CORRECTIONS {
            let linear = self.linear(flow)?;
            let residuals = self.residuals(flow)?;
            let now = self.largest_residual(dofs, &linear, &residuals);
            let condensed = Condensed::of(&linear, &residuals, None);
            let first = condensed.close(dofs, self.scales).ok_or(Unsolved::Stalled)?;
            let change = condensed.expand(&first, 0.0).ok_or(Unsolved::Stalled)?;
            let size = self.size_of(dofs, &change);
            if size <= SOLVED || size <= ROUNDING && size > 0.5 * last {
                return Ok(corrections);
            }
            last = size;
            let mut part = 1.0;
            loop {
                let mut trial = self.clone();
                trial.apply(flow, part, &change);
                let is_ordered = trial.segments.iter().all(|segment| segment.duration > 0.0);
                // The rates of events are those before the correction: they measure both alike.
                let left = if is_ordered {
                    trial.largest_residual(dofs, &linear, &trial.residuals(flow)?)
                } else {
                    f64::INFINITY
                };
                if left < now || is_ordered && size <= ROUNDING {
                    *self = trial;
                    break;
                }
                part *= 0.5;
                if part < LEAST_PART {
                    return Err(Unsolved::Stalled);
                }
            }
        }
        Err(Unsolved::Stalled)
    }

    /// The size of a change, in parts of the motion's size and of its period.
    pub(super) fn size_of(&self, dofs: usize, change: &Change) -> f64 {
        let period = self.period();
        let size = change.states.iter().map(|state| self.size(dofs, state)).fold(0.0, f64::max);
        change.delays.iter().map(|delay| delay.abs() / period).fold(size, f64::max)
    }

    /// Adds this part of a change.
    pub(super) fn apply(&mut self, flow: &Flow, part: f64, change: &Change) {
        for ((segment, state), delay) in
            self.segments.iter_mut().zip(&change.states).zip(&change.delays)
        {
            segment.start.axpy(part, state, 1.0);
            segment.duration += part * delay;
        }
        self.set_times(flow);
    }

    /// Writes the places of all states that depend on time alone.
    pub(super) fn set_times(&mut self, flow: &Flow) {
        let times = self.times(flow);
        for (segment, time) in self.segments.iter_mut().zip(times) {
            flow.set_time(&mut segment.start, time);
        }
    }
}

/// The residuals of the equations of a chain.
pub(super) struct Residuals {
    /// R y⁻ of each segment minus the beginning of the next.
    pub defects: Vec<DVector<f64>>,
    /// h y⁻ of each segment.
    pub values: Vec<f64>,
}

/// A change of all states and durations of a chain.
#[derive(Clone)]
pub(super) struct Change {
    /// Of the beginnings of segments.
    pub states: Vec<DVector<f64>>,
    /// Of durations, s.
    pub delays: Vec<f64>,
}

/// The linear equations of a chain, condensed to the changes of its first state (x_0, ẋ_0) and of a parameter.
pub(super) struct Condensed<'a> {
    linear: &'a [Linear],
    misses: Vec<f64>,
    misses_by_parameter: Vec<f64>,
    /// The change of each state, and of the first one after a period: `by` times that of the first one, plus `own`, plus
    /// `by_parameter` times that of the parameter.
    at: Vec<CondensedState>,
}

#[derive(Clone)]
struct CondensedState {
    by: DMatrix<f64>,
    own: DVector<f64>,
    by_parameter: DVector<f64>,
}

impl<'a> Condensed<'a> {
    /// Condenses the equations; `by_parameter` are the derivatives of the residuals by a parameter.
    pub(super) fn of(
        linear: &'a [Linear],
        residuals: &Residuals,
        by_parameter: Option<&Residuals>,
    ) -> Self {
        let size = linear[0].before.len();
        let motion = size - linear[0].times;
        let misses = |residuals: &Residuals| -> Vec<f64> {
            residuals
                .values
                .iter()
                .zip(linear)
                .map(|(value, linear)| -value / linear.slope)
                .collect()
        };
        let own_misses = misses(residuals);
        let misses_by_parameter = by_parameter.map_or_else(|| vec![0.0; linear.len()], misses);
        let mut now = CondensedState {
            by: DMatrix::identity(size, motion),
            own: DVector::zeros(size),
            by_parameter: DVector::zeros(size),
        };
        let mut at = Vec::with_capacity(linear.len() + 1);
        for (k, linear) in linear.iter().enumerate() {
            at.push(now.clone());
            let across = linear.from_event_to_event();
            let onward = |state: &DVector<f64>| times(&across, &times(&linear.flow, state));
            let along = times(&linear.reset, &linear.rate);
            now = CondensedState {
                by: product(&across, &product(&linear.flow, &now.by)),
                own: onward(&now.own) + &residuals.defects[k] + &along * own_misses[k],
                by_parameter: onward(&now.by_parameter) + &along * misses_by_parameter[k],
            };
            if let Some(residuals) = by_parameter {
                now.by_parameter += &residuals.defects[k];
            }
        }
        at.push(now);
        Self { linear, misses: own_misses, misses_by_parameter, at }
    }

    /// 1 − B, the equations of closure, and their right sides: what is left, and the derivatives by the parameter; in
    /// units of displacements and velocities.
    pub(super) fn closure(
        &self,
        dofs: usize,
        [place, speed]: [f64; 2],
    ) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
        let CondensedState { by, own, by_parameter } = &self.at[self.linear.len()];
        let unit = |i: usize| if i < dofs { place } else { speed };
        let motion = by.ncols();
        let matrix = DMatrix::from_fn(motion, motion, |i, j| {
            (f64::from(u8::from(i == j)) - by[(i, j)]) * unit(j) / unit(i)
        });
        let scaled = |vector: &DVector<f64>| DVector::from_fn(motion, |i, _| vector[i] / unit(i));
        (matrix, scaled(own), scaled(by_parameter))
    }

    /// The change of the first state that closes the chain with the parameter as it is.
    fn close(&self, dofs: usize, scales: [f64; 2]) -> Option<DVector<f64>> {
        let (matrix, own, _) = self.closure(dofs, scales);
        let mut first = matrix.lu().solve(&own)?;
        for (i, value) in first.iter_mut().enumerate() {
            *value *= scales[usize::from(i >= dofs)];
        }
        Some(first)
    }

    /// The change of everything that goes with changes of the first state and of the parameter.
    pub(super) fn expand(&self, first: &DVector<f64>, parameter: f64) -> Option<Change> {
        self.expand_with(first, parameter, 1.0)
    }

    /// The change of everything that goes with a direction of the first state and of the parameter alone.
    pub(super) fn direction(&self, first: &DVector<f64>, parameter: f64) -> Option<Change> {
        self.expand_with(first, parameter, 0.0)
    }

    fn expand_with(&self, first: &DVector<f64>, parameter: f64, own: f64) -> Option<Change> {
        let state = |state: &CondensedState| {
            times(&state.by, first) + &state.own * own + &state.by_parameter * parameter
        };
        let states: Vec<DVector<f64>> = self.at[..self.linear.len()].iter().map(state).collect();
        let delay = |k: usize| {
            let linear = &self.linear[k];
            let flown = linear.row.dot(&times(&linear.flow, &states[k])) / linear.slope;
            own * self.misses[k] + parameter * self.misses_by_parameter[k] - flown
        };
        let delays: Vec<f64> = (0..self.linear.len()).map(delay).collect();
        let is_finite = states.iter().flatten().chain(&delays).all(|value| value.is_finite());
        is_finite.then_some(Change { states, delays })
    }
}

/// `true` if a motion with this rate meets the zero of a function tangentially, but for rounding: the rate of the function,
/// `slope`, is a small sum of large terms, or no number.
pub(super) fn is_tangential(row: &DVector<f64>, rate: &DVector<f64>, slope: f64) -> bool {
    let terms: f64 = row.iter().zip(rate).map(|(a, b)| (a * b).abs()).sum();
    slope.abs() <= 1e-12 * terms || !slope.is_finite()
}

/// The row, near the state `before` at its end, of the function that ends a segment: that of its first event, or the phase
/// of the first sine.
fn end_row(
    flow: &Flow,
    field: &Field,
    before: &DVector<f64>,
    segment: &Segment,
    turn: f64,
) -> Option<DVector<f64>> {
    match segment.stages.first() {
        None => flow.phase_row(turn),
        Some(stage) => {
            let (contact, event) = *stage.events.first()?;
            flow.event_row(field, before, contact, event)
        }
    }
}
