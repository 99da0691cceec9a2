//! A periodic motion as a chain of segments, and Newton's method on all of them together.
//!
//! Segment k begins in the state y_k, just after an instant at which contacts changed their states, keeps its contact
//! states for the time τ_k, and ends where h_k(y) = 0: at the next such instant or, in a driven motion, once in a
//! period where the first sine has its phase of time 0. R_k is the linear map across that instant. With
//! y_k⁻ = exp(A_k τ_k) y_k the unknowns (x_k, ẋ_k) and τ_k satisfy
//!
//! ```text
//! y_{k+1} = R_k y_k⁻,   h_k y_k⁻ = 0,   y_m = y_0.
//! ```
//!
//! The linear equations of Newton's method are condensed to the changes of (x_0, ẋ_0): each τ_k follows from its own
//! h_k, whose rate along the motion must not be zero, and each y_{k+1} from y_k. A motion without a drive begins at an
//! event, which fixes its phase. Unlike a run over the whole period, the chain leaves no error that an unstable motion
//! amplifies: each equation is met to rounding.

use super::flow::{Field, Flow, Instant, Stage};
use super::matrix::{product, times};
use amontons::contact::ContactState;
use amontons::integrator::StepFailure;
use nalgebra::{DMatrix, DVector};
use std::rc::Rc;

/// Most corrections of one chain.
const MOST_CORRECTIONS: usize = 40;
/// A chain whose next correction is smaller, in parts of the motion's size and of its period, is solved.
const SOLVED: f64 = 1e-12;
/// A correction this small that no longer falls is rounding.
const ROUNDING: f64 = 1e-9;
/// Least part of a correction that is tried.
const LEAST_PART: f64 = 1.0 / 256.0;

/// A part of a periodic motion in which contacts keep their states.
#[derive(Clone, Debug)]
pub struct Segment {
    /// The states of the contacts.
    pub states: Vec<ContactState>,
    /// The state at its beginning.
    pub start: DVector<f64>,
    /// Its duration, s.
    pub duration: f64,
    /// What ends it; empty where a driven motion's period ends.
    pub stages: Vec<Stage>,
}

/// A closed chain of segments.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The segments, in their order.
    pub segments: Vec<Segment>,
    /// Scales of displacements, m, and of velocities, m/s: the largest ranges over the segments' ends.
    pub scales: [f64; 2],
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
    /// exp(A τ).
    pub flow: DMatrix<f64>,
    /// The state y⁻ before the instant that ends the segment.
    pub before: DVector<f64>,
    /// Its rate f⁻.
    pub rate: DVector<f64>,
    /// The rate f⁺ after the instant.
    pub rate_after: DVector<f64>,
    /// The row h of the function that ends the segment.
    pub row: DVector<f64>,
    /// h y⁻.
    pub value: f64,
    /// h f⁻.
    pub slope: f64,
    /// The map R across the instant.
    pub reset: DMatrix<f64>,
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
    pub fn of_run(
        flow: &Flow,
        first: &amontons::integrator::Motion,
        t: f64,
        instants: &[Instant],
        end: Option<f64>,
    ) -> Self {
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
        let mut chain = Self { segments, scales: [1.0; 2] };
        chain.set_scales(flow.dofs());
        chain
    }

    fn set_scales(&mut self, dofs: usize) {
        let range = |places: std::ops::Range<usize>| {
            let of = |place: usize| {
                let values = self.segments.iter().map(|segment| segment.start[place]);
                let [least, most] = amontons::numerics::range(values);
                // A motion with one segment returns to the state that it begins with.
                f64::max(most - least, most.abs().max(least.abs()) * 1e-3)
            };
            places.map(of).fold(f64::MIN_POSITIVE, f64::max)
        };
        self.scales = [range(0..dofs), range(dofs..2 * dofs)];
    }

    /// The period, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration).sum()
    }

    /// The times at which segments begin, s.
    fn times(&self) -> Vec<f64> {
        let mut time = 0.0;
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
                let field = flow.field(&segment.states)?;
                let propagator = flow.propagator(&field, segment.duration);
                let before = times(&propagator, &segment.start);
                let rate = Flow::rate(&field, &before);
                let next = &self.segments[(k + 1) % count];
                let after = flow.field(&next.states)?;
                let row = end_row(flow, &field, segment).ok_or(Unsolved::Unknown { segment: k })?;
                let mut reset = DMatrix::identity(flow.size(), flow.size());
                let mut states = segment.states.clone();
                for stage in &segment.stages {
                    reset = product(&flow.reset(&states, stage)?, &reset);
                    states.clone_from(&stage.states);
                }
                let reached = times(&reset, &before);
                let slope = row.dot(&rate);
                // In a tangential meeting the function is as good as flat over the whole segment.
                let bound: f64 = row.iter().zip(&rate).map(|(a, b)| (a * b).abs()).sum();
                if !(slope.abs() > 1e-12 * bound) {
                    return Err(Unsolved::Grazes { segment: k });
                }
                Ok(Linear {
                    value: row.dot(&before),
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

    /// What is left of each equation: the changes of state from the end of each segment to the beginning of the next,
    /// and by how much each event is missed, s.
    fn rests(&self, linear: &[Linear]) -> (Vec<DVector<f64>>, Vec<f64>) {
        let count = self.segments.len();
        let gap = |(k, linear): (usize, &Linear)| {
            times(&linear.reset, &linear.before) - &self.segments[(k + 1) % count].start
        };
        let gaps = linear.iter().enumerate().map(gap).collect();
        (gaps, linear.iter().map(|linear| -linear.value / linear.slope).collect())
    }

    /// The largest rest, in parts of the motion's size and of its period.
    fn largest_rest(&self, dofs: usize, (gaps, misses): &(Vec<DVector<f64>>, Vec<f64>)) -> f64 {
        let period = self.period();
        let gaps = gaps.iter().map(|gap| self.size(dofs, gap)).fold(0.0, f64::max);
        misses.iter().map(|miss| miss.abs() / period).fold(gaps, f64::max)
    }

    /// The largest gap between the end of a segment and the beginning of the next, in parts of the motion's size, or by
    /// which an event is missed, in parts of the period; `None` where the chain has no derivative.
    pub fn largest_gap(&self, flow: &mut Flow) -> Option<f64> {
        let linear = self.linear(flow).ok()?;
        Some(self.largest_rest(flow.dofs(), &self.rests(&linear)))
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
            let rests = self.rests(&linear);
            let now = self.largest_rest(dofs, &rests);
            let (states, delays) =
                self.correction(dofs, &linear, &rests).ok_or(Unsolved::Stalled)?;
            let period = self.period();
            let size = states.iter().map(|change| self.size(dofs, change)).fold(0.0, f64::max);
            let size = delays.iter().map(|delay| delay.abs() / period).fold(size, f64::max);
            if size <= SOLVED || size <= ROUNDING && size > 0.5 * last {
                return Ok(corrections);
            }
            last = size;
            let mut part = 1.0;
            let corrected = loop {
                let mut trial = self.clone();
                trial.correct(flow, part, &states, &delays);
                if trial.segments.iter().all(|segment| segment.duration > 0.0) {
                    match trial.linear(flow) {
                        Ok(linear) => {
                            let left = trial.largest_rest(dofs, &trial.rests(&linear));
                            if left < now || size <= ROUNDING {
                                break Some(trial);
                            }
                        }
                        Err(Unsolved::Grazes { .. }) => {}
                        Err(other) => return Err(other),
                    }
                }
                part *= 0.5;
                if part < LEAST_PART {
                    break None;
                }
            };
            match corrected {
                Some(trial) => *self = trial,
                None => return Err(Unsolved::Stalled),
            }
        }
        Err(Unsolved::Stalled)
    }

    fn correct(&mut self, flow: &Flow, part: f64, states: &[DVector<f64>], delays: &[f64]) {
        for ((segment, change), delay) in self.segments.iter_mut().zip(states).zip(delays) {
            segment.start.axpy(part, change, 1.0);
            segment.duration += part * delay;
        }
        let times = self.times();
        for (segment, time) in self.segments.iter_mut().zip(times) {
            flow.set_time(&mut segment.start, time);
        }
    }

    /// Newton's correction of all states and durations.
    #[allow(clippy::type_complexity)]
    fn correction(
        &self,
        dofs: usize,
        linear: &[Linear],
        (gaps, misses): &(Vec<DVector<f64>>, Vec<f64>),
    ) -> Option<(Vec<DVector<f64>>, Vec<f64>)> {
        let (size, motion) = (linear[0].before.len(), 2 * dofs);
        // Changes of each state: those of the first one times `by`, plus `own`.
        let mut by = DMatrix::identity(size, motion);
        let mut own = DVector::zeros(size);
        let mut chain = Vec::with_capacity(linear.len());
        for ((linear, gap), miss) in linear.iter().zip(gaps).zip(misses) {
            chain.push((by.clone(), own.clone()));
            let across = linear.from_event_to_event();
            by = product(&across, &product(&linear.flow, &by));
            own = times(&across, &times(&linear.flow, &own))
                + gap
                + times(&linear.reset, &linear.rate) * *miss;
        }
        // Numbers of one size make the pivots of the elimination right.
        let [place, speed] = self.scales;
        let unit = |i: usize| if i < dofs { place } else { speed };
        let matrix = DMatrix::from_fn(motion, motion, |i, j| {
            (f64::from(u8::from(i == j)) - by[(i, j)]) * unit(j) / unit(i)
        });
        let right = DVector::from_fn(motion, |i, _| own[i] / unit(i));
        let first = matrix.lu().solve(&right)?;
        let first = DVector::from_fn(motion, |i, _| first[i] * unit(i));
        let states: Vec<DVector<f64>> =
            chain.iter().map(|(by, own)| times(by, &first) + own).collect();
        let delays = linear.iter().zip(&states).zip(misses);
        let delays = delays.map(|((linear, change), miss)| {
            miss - linear.row.dot(&times(&linear.flow, change)) / linear.slope
        });
        let delays: Vec<f64> = delays.collect();
        let is_finite = states.iter().all(|change| change.iter().all(|value| value.is_finite()));
        is_finite.then_some((states, delays))
    }
}

/// The row of the function that ends a segment: that of its first event, or the phase of the first sine.
fn end_row(flow: &Flow, field: &Rc<Field>, segment: &Segment) -> Option<DVector<f64>> {
    match segment.stages.first() {
        None => flow.phase_row(),
        Some(stage) => {
            let (contact, event) = *stage.events.first()?;
            flow.event_row(field, contact, event)
        }
    }
}
