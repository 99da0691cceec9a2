//! Watched functions, which must not become negative while the contact states stay, and their first root. The functions
//! are in the table of the [event-driven method](super), their budgets in that of [`rounding`](super::rounding).

use super::ledger::MotionObserver;
use super::rounding::{DIFFERENCE, NOISE, THROWN};
use super::{EventDriven, MOST_TURNS, roots};
use crate::contact::ContactState;
use crate::integrator::{Inputs, Motion};
use serde::{Deserialize, Serialize};

/// The reason why a contact may not keep its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Event {
    /// The gap closes.
    Touch,
    /// The normal force falls to zero.
    Lift,
    /// The slip velocity falls to zero.
    Stop,
    /// The friction force reaches its limit, and the contact begins to slip in this direction.
    Slip(ContactState),
    /// The surface of a contact that sticks moves on although its mass cannot follow, which slips in this direction.
    Leave(ContactState),
    /// Other contacts carry the mass of a closed contact off its surface, or into it.
    Part,
}

/// A gap opens or closes if its acceleration is more than twice this part of the largest acceleration plus those that
/// springs and outer forces would cause each by itself. The residual of the contact problem is smaller.
const PARTED: f64 = 1e-10;
/// Largest number of watched functions of one contact.
const MOST_WATCHED: usize = 5;

impl<W: MotionObserver> EventDriven<W> {
    /// Returns the time of the next event, in parts of the series' span, and writes the event of each contact at that
    /// time to `events`.
    pub(super) fn next_event(&mut self, motion: &Motion, inputs: &Inputs) -> Option<f64> {
        self.events.fill(None);
        let mut first = None;
        let bend = self.series.largest_bend();
        for i in 0..self.events.len() {
            if self.overheld[i] && self.parts(i, motion.contacts[i], bend) {
                if first != Some(0.0) {
                    self.events.fill(None);
                }
                (self.events[i], first) = (Some(Event::Part), Some(0.0));
                continue;
            }
            let watched = self.watched(i, motion.contacts[i], bend);
            for (event, size) in watched.into_iter().flatten() {
                let terms = self.fill(i, event, inputs);
                let p = &self.polynomial[..terms];
                let first_negative =
                    |more: f64| roots::first_negative(p, size.map(|size| NOISE * (size + more)));
                let time = match first_negative(0.0) {
                    Some(0.0) if self.alternates_stick_and_slip(i, event) => {
                        first_negative(self.slip_budget(i))
                    }
                    time => time,
                };
                let Some(time) = time else { continue };
                // Events that are apart by rounding alone are one.
                let is_same = |first: f64| (time - first).abs() <= 4.0 * f64::EPSILON;
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

    /// The functions of a contact that might become negative, with the magnitudes that scale their rounding: of the
    /// value itself, of its first change, and of further ones.
    fn watched(
        &self,
        contact: usize,
        state: ContactState,
        bend: f64,
    ) -> [Option<(Event, [f64; 3])>; MOST_WATCHED] {
        let span = self.series.span();
        let acceleration = 2.0 * bend / (span * span);
        let own = self.dynamics.problem.delassus.own(contact);
        let doubt = self.rounding_factor(contact);
        let force = || {
            let size = self.series.first_normal_force(contact).abs().max(acceleration / own[0]);
            doubt * (size + self.pulled_forces(contact, self.series.power(0)))
        };
        let friction = self.friction[contact].static_;
        // Gaps and slips between masses are differences of larger values, which lose digits. Putting them
        // where they belong passes that on to all contacts that share masses.
        let of_power = |k| if self.is_inclined { DIFFERENCE * self.series.largest(k) } else { 0.0 };
        let [place, moved] = [0, 1].map(of_power);
        match state {
            ContactState::Detached => {
                // A velocity that an impact has left may be negligible beside the rounding of the gap: the gap
                // then begins at zero, and opens for as long as that velocity lets it. A contact that an impact has
                // thrown off counts as open, however soon it comes back: otherwise it would land again at once.
                let lost = self.pulled(contact, 0, self.series.power(0)) + DIFFERENCE * self.driven;
                let bends = doubt * (2.0 * bend + span * span * lost + moved);
                let fastest = self.series.largest(1).max(self.slowest() * span);
                let slow = bends.min(0.5 * THROWN / NOISE * fastest);
                [Some((Event::Touch, [slow + doubt * place, slow, bends])), None, None, None, None]
            }
            ContactState::Stick => {
                let left = if self.overheld[contact] {
                    let distance = self.slipped(contact, friction, force(), [bend, moved]);
                    [ContactState::Slide, ContactState::ReverseSlide]
                        .map(|direction| Some((Event::Leave(direction), [distance; 3])))
                } else {
                    [None; 2]
                };
                // If the mass has one direction of motion, the force that stops it along the normal holds it along
                // the tangent.
                if self.dynamics.problem.delassus.local(contact).is_singular() {
                    return [Some((Event::Lift, [force(); 3])), left[0], left[1], None, None];
                }
                let least = self.series.least_limit(contact, friction);
                if least > self.series.most_stuck_force(contact) {
                    return [left[0], left[1], None, None, None];
                }
                let force = force();
                let limit =
                    |direction| Some((Event::Slip(direction), [(1.0 + friction) * force; 3]));
                [
                    Some((Event::Lift, [force; 3])),
                    limit(ContactState::Slide),
                    limit(ContactState::ReverseSlide),
                    left[0],
                    left[1],
                ]
            }
            _ => {
                let distance = self.slipped(contact, friction, force(), [bend, moved]);
                let law = self.dynamics.law;
                let may_lift = law.detachment && self.series.least_normal_force(contact) <= 0.0;
                [
                    may_lift.then(|| (Event::Lift, [force(); 3])),
                    (!law.has_fixed_state()).then_some((Event::Stop, [distance; 3])),
                    None,
                    None,
                    None,
                ]
            }
        }
    }

    /// `true` if the gap of a closed contact begins to open or to close at the beginning of the series. Its state
    /// forbids that, but contacts that hold more directions than there are cannot all be held.
    fn parts(&self, contact: usize, state: ContactState, bend: f64) -> bool {
        let normal = &self.dynamics.contacts[contact].normal;
        // A direction that a contact holds alone has no acceleration.
        if state == ContactState::Detached || normal.as_unit().is_some() {
            return false;
        }
        let span = self.series.span();
        let lost = self.pulled(contact, 0, self.series.power(0)) / DIFFERENCE + self.driven;
        let moved = DIFFERENCE * self.series.largest(0);
        let nothing = self.rounding_factor(contact)
            * (PARTED * (2.0 * bend + span * span * lost) + NOISE * moved);
        normal.dot(self.series.power(2)).abs() > nothing
    }

    /// Scale of the rounding of a contact's slip over the series' span, m (D of [`rounding`](super::rounding)):
    /// `force` is the scale of its normal force, N, and `bend` and `moved` those of the bend of the motion and of the
    /// displacements of which slip is a difference, m.
    fn slipped(&self, contact: usize, friction: f64, force: f64, [bend, moved]: [f64; 2]) -> f64 {
        let (span, doubt) = (self.series.span(), self.rounding_factor(contact));
        let own = self.dynamics.problem.delassus.own(contact);
        // A change that is negligible for friction is negligible for the slip that it causes: otherwise a contact at
        // its limit slips and stops without an end.
        let bits = (1.0 + friction) * force * (own[3] + friction * own[1].abs());
        let bend = doubt * 2.0 * bend + bits * span * span;
        let along = doubt * span * self.surface_speed[contact];
        along.max(bend) + doubt * moved
    }

    /// `true` if a contact sticks and slips in turn at one instant, so that [`Self::slip_budget`] applies.
    fn alternates_stick_and_slip(&self, contact: usize, event: Event) -> bool {
        matches!(event, Event::Leave(_)) && self.repeats[contact] > MOST_TURNS
    }

    /// A slip over the series' span, m, relative to which that of a contact that sticks may be rounding: contact forces
    /// that balance each other leave accelerations of rounding to the masses that share them.
    fn slip_budget(&self, contact: usize) -> f64 {
        let Self { series, dynamics, .. } = self;
        let delassus = &dynamics.problem.delassus;
        let size = |&contact: &usize| {
            let along = |row| delassus.along(contact, row, |other| series.first_forces(other))[1];
            f64::max(along(0), along(1))
        };
        let largest = delassus.group_of(contact).iter().map(size).fold(0.0, f64::max);
        let span = series.span();
        self.rounding_factor(contact) * DIFFERENCE * span * span * largest
    }

    /// Counts, if the law of contact is reduced, the contacts that would need the omitted parts within this part of the
    /// series' span.
    pub(super) fn count_broken(&mut self, motion: &mut Motion, inputs: &Inputs, part: f64) {
        let law = self.dynamics.law;
        let (has_direction, detachment) = (law.has_fixed_direction(), law.detachment);
        for i in 0..self.events.len() {
            if motion.contacts[i] == ContactState::Detached {
                continue;
            }
            if has_direction {
                let along = self.series.span() * self.surface[i].abs();
                let is_reversed = self.falls(i, Event::Stop, inputs, along, part);
                motion.statistics.reversed_slips += u64::from(is_reversed);
            }
            if !detachment {
                let force = self.series.first_normal_force(i).abs();
                let is_pulled = self.falls(i, Event::Lift, inputs, force, part);
                motion.statistics.pulled_contacts += u64::from(is_pulled);
            }
        }
    }

    /// `true` if the watched function becomes negative within this part of the series' span.
    fn falls(
        &mut self,
        contact: usize,
        event: Event,
        inputs: &Inputs,
        size: f64,
        part: f64,
    ) -> bool {
        let terms = self.fill(contact, event, inputs);
        let time = roots::first_negative(&self.polynomial[..terms], [NOISE * size; 3]);
        time.is_some_and(|time| time < part)
    }

    /// Writes the watched function as a polynomial; returns its number of terms.
    fn fill(&mut self, contact: usize, event: Event, inputs: &Inputs) -> usize {
        let Self { series, dynamics, polynomial, friction, surface, surface_acceleration, .. } =
            self;
        let rows = &dynamics.contacts[contact];
        match event {
            Event::Touch | Event::Part => {
                let terms = series.along(&rows.normal, polynomial);
                polynomial[0] += rows.gap;
                terms
            }
            Event::Stop | Event::Leave(_) => {
                let terms = series.moved(&rows.tangent, polynomial);
                let span = series.span();
                polynomial[0] -= span * surface[contact];
                polynomial[1] -= span * span * surface_acceleration[contact];
                series.waves.add_velocity(&inputs.waves, contact, (-span, 1.0), polynomial);
                // A slip must keep its direction, and a contact without slip must not begin to slip.
                let is_turned = match event {
                    Event::Leave(direction) => direction == ContactState::ReverseSlide,
                    _ => series.state(contact) == ContactState::Slide,
                };
                if is_turned {
                    polynomial[..terms].iter_mut().for_each(|value| *value = -*value);
                }
                terms
            }
            Event::Lift => series.normal_force(contact, polynomial),
            Event::Slip(direction) => {
                let sign = direction.sliding_direction().unwrap_or(1.0);
                series.reserve(contact, friction[contact].static_, sign, polynomial)
            }
        }
    }
}
