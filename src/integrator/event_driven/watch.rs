//! What must not become negative while the contact states stay, and when it does.

use super::series::{ORDER, index};
use super::{EventDriven, NOISE, roots};
use crate::contact::ContactState;
use crate::integrator::{Drive, Motion};

/// Why a contact may not stay as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// The gap closes.
    Touch,
    /// The normal force falls to zero.
    Lift,
    /// The slip velocity falls to zero.
    Stop,
    /// The friction force reaches its limit; in this direction.
    Slip(ContactState),
}

impl EventDriven {
    /// The time of the next event up to `reach` (s), and in `events` what happens then.
    pub(super) fn next_event(&mut self, motion: &Motion, drive: &Drive, reach: f64) -> Option<f64> {
        self.events.fill(None);
        let mut first = None;
        for i in 0..self.events.len() {
            for (event, size) in self.watched(i, motion.contacts[i], drive, reach) {
                let terms = self.fill(i, event, drive);
                let p = &self.polynomial[..terms];
                let Some(time) = roots::first_negative(p, reach, NOISE * size) else { continue };
                // Those that are apart by rounding alone are one.
                let is_same = |first: f64| (time - first).abs() <= 4.0 * f64::EPSILON * reach;
                match first {
                    Some(first) if is_same(first) => {}
                    Some(first) if time > first => continue,
                    _ => self.events.fill(None),
                }
                self.events[i] = Some(event);
                first = Some(first.map_or(time, |first: f64| first.min(time)));
            }
        }
        first
    }

    /// What must not become negative at a contact, with the size that its rounding is measured by.
    fn watched(
        &self,
        contact: usize,
        state: ContactState,
        drive: &Drive,
        reach: f64,
    ) -> impl Iterator<Item = (Event, f64)> + use<> {
        let [normal, _] = self.series.force(0, contact);
        let own = self.dynamics.multipliers.delassus.own(contact);
        let acceleration = self.series.largest_acceleration();
        let force = normal.abs().max(acceleration / own[0]);
        let speed = self.surface[contact].abs().max(acceleration * reach);
        let friction = drive.friction_coefficient[contact];
        let limit = |direction| (Event::Slip(direction), (1.0 + friction) * force);
        let events = match state {
            ContactState::Detached => {
                [Some((Event::Touch, acceleration * reach * reach)), None, None]
            }
            ContactState::Stick => [
                Some((Event::Lift, force)),
                Some(limit(ContactState::Slide)),
                Some(limit(ContactState::ReverseSlide)),
            ],
            _ => [Some((Event::Lift, force)), Some((Event::Stop, speed)), None],
        };
        events.into_iter().flatten()
    }

    /// Writes what must not become negative as a polynomial; its number of terms.
    fn fill(&mut self, contact: usize, event: Event, drive: &Drive) -> usize {
        let Self { series, dynamics, polynomial, surface, .. } = self;
        let rows = &dynamics.contacts[contact];
        let friction = drive.friction_coefficient[contact];
        match event {
            Event::Touch => {
                for (k, value) in polynomial.iter_mut().enumerate() {
                    *value = rows.normal.dot(series.displacement(k));
                }
                return ORDER + 1;
            }
            Event::Stop => {
                let direction = self.held_states[contact].sliding_direction().unwrap_or(1.0);
                for (k, value) in polynomial[..ORDER].iter_mut().enumerate() {
                    let along = index(k + 1) * rows.tangent.dot(series.displacement(k + 1));
                    let slider = match k {
                        0 => surface[contact],
                        1 => drive.slider_acceleration[contact],
                        _ => 0.0,
                    };
                    *value = direction * (slider - along);
                }
                return ORDER;
            }
            Event::Lift => {
                for (k, value) in polynomial[..=ORDER - 2].iter_mut().enumerate() {
                    *value = series.force(k, contact)[0];
                }
            }
            Event::Slip(direction) => {
                let sign = direction.sliding_direction().unwrap_or(1.0);
                for (k, value) in polynomial[..=ORDER - 2].iter_mut().enumerate() {
                    let [normal, tangential] = series.force(k, contact);
                    *value = friction * normal - sign * tangential;
                }
            }
        }
        ORDER - 1
    }
}
