//! A record of the events of a motion: when they were, why, and the motion before and after each.

use super::EventDriven;
use super::ledger::{Impact, MotionObserver, Segment};
use super::rounding::NOISE;
use super::watch::Event;
use crate::Error;
use crate::contact::ContactState;
use crate::integrator::Motion;
use crate::model::LumpedModel;
use std::mem::take;

/// One change of contact states: the events of all contacts at one instant, and what followed.
#[derive(Clone, Debug, PartialEq)]
pub struct EventRecord {
    /// Time since the record began, s.
    pub time: f64,
    /// The contacts with an event, from 0.
    pub events: Vec<(usize, Event)>,
    /// The motion before and after the change, without statistics of its own: x (m), ẋ (m/s), and contact states.
    pub before: Motion,
    /// See `before`.
    pub after: Motion,
    /// How contacts took part in the impact of those that touched: `Stick` for each whose slip the impact stopped, a
    /// sliding state for each that slips afterwards, with Λ_T = ±µ_k Λ_N, and `Detached` for those without an impulse.
    /// `None` if none touched.
    pub impact: Option<Vec<ContactState>>,
}

/// Observer that records the events of a motion.
#[derive(Default)]
pub struct EventRecorder {
    time: f64,
    records: Vec<EventRecord>,
    impact: Option<Vec<ContactState>>,
}

impl EventDriven<EventRecorder> {
    /// The event-driven integrator for this model, with a record of its events.
    ///
    /// # Errors
    /// Returns the errors of [`EventDriven::new`].
    pub fn recording(model: &LumpedModel) -> Result<Self, Error> {
        Self::with_observer(model, EventRecorder::default())
    }

    /// Takes the events that have been recorded since the last call, in their order, and begins a new record at time 0.
    pub fn take_record(&mut self) -> Vec<EventRecord> {
        self.observer.time = 0.0;
        take(&mut self.observer.records)
    }
}

impl MotionObserver for EventRecorder {
    fn passes(&mut self, segment: Segment<'_>, _: &mut Motion) {
        self.time += segment.part * segment.series.span();
    }

    fn is_struck(&mut self, impact: Impact<'_>, _: &mut Motion) {
        let problem = &impact.dynamics.problem;
        let carries = |i: usize| problem.forces[i][0] > NOISE * problem.forces[i][1].abs();
        let states = problem.states.iter().enumerate();
        let states =
            states.map(|(i, &state)| if carries(i) { state } else { ContactState::Detached });
        self.impact = Some(states.collect());
    }

    fn sees_hops_end(&mut self, _: &mut Motion, _: f64) {}

    fn sees_events(&mut self, events: &[Option<Event>], motion: &Motion) {
        let events = events.iter().enumerate();
        let events = events.filter_map(|(contact, event)| Some((contact, (*event)?))).collect();
        let (before, after) = (motion.clone(), motion.clone());
        self.records.push(EventRecord { time: self.time, events, before, after, impact: None });
    }

    fn sees_states(&mut self, motion: &Motion) {
        let impact = self.impact.take();
        if let Some(record) = self.records.last_mut() {
            record.after.clone_from(motion);
            record.impact = impact;
        }
    }
}
