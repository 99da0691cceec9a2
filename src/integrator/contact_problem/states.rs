//! Forces of given contact states, and the check that they obey the law.

use super::{ContactConstraint, ContactProblem, MISSES, StateEquations};
use crate::contact::{ContactState, FrictionRange, LocalProblem};

/// Number of corrections of a solution of linear equations by its residual.
const CORRECTIONS: usize = 2;

/// Largest number of repairs of states that break the law; one or two are usual.
const MENDS: usize = 20;

/// Limit of rounding in forces that are found directly: they are refused if W λ times [`MISSES`], the error that the
/// law allows, is more than this part of the largest acceleration without contact forces in their group. Terms may so
/// be 10⁹ times as large as that, or 10⁷ times where W is nearly singular. The equations of contacts that wedge each
/// other may be singular but for rounding, and then have forces of any size.
const BLURRED: f64 = 1e-4;

/// Strictness of the check that forces obey the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Strictness {
    /// No condition is at its limit, so that no other state is lawful too.
    Inside,
    /// Conditions hold up to this part of the terms that cause rounding.
    UpTo(f64),
}

impl Strictness {
    /// The tolerance of equations, as a part of their terms.
    fn missed(self) -> f64 {
        match self {
            Self::Inside => MISSES[0],
            Self::UpTo(missed) => missed,
        }
    }
}

/// The acceleration of a contact, m/s², along normal and tangent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Acceleration {
    pub(super) value: [f64; 2],
    /// Sum of the magnitudes of its terms, which scales rounding.
    pub(super) terms: [f64; 2],
}

impl ContactProblem {
    /// Solves a group in the present states, as far as its constraints allow them; `true` if the forces obey the law.
    pub(super) fn solve_states(&mut self, group: usize, strictness: Strictness) -> bool {
        self.clear(group);
        self.take_states(group);
        self.correct(group, strictness)
    }

    /// Removes the residual of a solution by Gauss–Seidel, if the result obeys the law as well.
    pub(super) fn polish(&mut self, group: usize) {
        for &contact in &self.delassus.groups()[group] {
            self.swept[contact] = self.forces[contact];
        }
        self.take_signs(group);
        self.take_states(group);
        if !self.correct(group, Strictness::UpTo(MISSES[0])) {
            for &contact in &self.delassus.groups()[group] {
                self.forces[contact] = self.swept[contact];
            }
        }
    }

    /// `true` if some contact of a group is held in both directions along its normal, with friction that follows |N|.
    pub(super) fn has_held(&self, group: usize) -> bool {
        self.delassus.groups()[group].iter().any(|&contact| self.is_held(contact))
    }

    pub(super) fn is_held(&self, contact: usize) -> bool {
        self.constraints[contact].is_held()
    }

    /// Sets the signs of contacts that pull from the present forces.
    pub(super) fn take_signs(&mut self, group: usize) {
        for &contact in &self.delassus.groups()[group] {
            self.pulls[contact] = self.is_held(contact) && self.forces[contact][0] < 0.0;
        }
    }

    /// Sets up the equations of the present states.
    fn take_states(&mut self, group: usize) {
        for &contact in &self.delassus.groups()[group] {
            let state = self.states[contact];
            let slides = |direction: f64| match state {
                ContactState::Detached => ContactState::Detached,
                _ if direction > 0.0 => ContactState::Slide,
                _ => ContactState::ReverseSlide,
            };
            self.states[contact] = match self.constraints[contact] {
                ContactConstraint::Law(_) => state,
                ContactConstraint::Open => ContactState::Detached,
                ContactConstraint::Slipping { direction, .. } => slides(direction),
                ContactConstraint::Fixed => ContactState::Stick,
                ContactConstraint::Guided { state, .. } => state,
                ContactConstraint::Held(_) if state == ContactState::Detached => {
                    ContactState::Stick
                }
                ContactConstraint::Held(_) => state,
                ContactConstraint::HeldSlipping { .. } => self.constraints[contact].closed_state(),
            };
        }
        let Self { given, delassus, constraints, states, pulls, .. } = self;
        given.set(delassus, group, |contact| {
            let own = delassus.local(contact);
            let equations = |range: &FrictionRange| StateEquations::of(states[contact], range, own);
            match &constraints[contact] {
                ContactConstraint::Law(range) => equations(range),
                &ContactConstraint::Slipping { friction, .. } => {
                    equations(&FrictionRange::of(friction))
                }
                ContactConstraint::Fixed => equations(&FrictionRange::of(f64::INFINITY)),
                &ContactConstraint::Guided { slope, .. } => StateEquations::Normal { slope },
                ContactConstraint::Held(range) => held(states[contact], range, own, pulls[contact]),
                &ContactConstraint::HeldSlipping { friction, .. } => {
                    held(states[contact], &FrictionRange::of(friction), own, pulls[contact])
                }
                ContactConstraint::Open => StateEquations::Nothing,
            }
        });
    }

    /// Adds corrections to the forces of a group until its equations hold; `true` if the forces obey the law.
    fn correct(&mut self, group: usize, strictness: Strictness) -> bool {
        self.accelerate(group);
        (0..=CORRECTIONS).any(|_| {
            let Self { given, accelerations, corrections, .. } = self;
            given.forces(group, |contact, row| accelerations[contact].value[row], corrections);
            for &contact in &self.delassus.groups()[group] {
                let [normal, tangential] = self.corrections[contact];
                let force = &mut self.forces[contact];
                force[0] += normal;
                force[1] += tangential;
                match self.states[contact] {
                    ContactState::Detached => *force = [0.0; 2],
                    ContactState::Stick => {}
                    // Exact to the last digit, whatever Gauss–Seidel has left.
                    _ => force[1] = self.given.slope(contact) * force[0],
                }
            }
            self.are_lawful(group, strictness)
        })
    }

    /// Gives contacts that break the law in the present states the state that they tend to, and solves again, a few
    /// times; `true` if the forces then obey the law.
    pub(super) fn correct_states(&mut self, group: usize, strictness: Strictness) -> bool {
        (0..MENDS).any(|_| {
            for place in 0..self.delassus.groups()[group].len() {
                let contact = self.delassus.groups()[group][place];
                self.correct_state(contact);
            }
            self.solve_states(group, strictness)
        })
    }

    /// Gives a contact that breaks the law in its present state the state that it tends to.
    fn correct_state(&mut self, contact: usize) {
        let [a_normal, a_tangential] = self.accelerations[contact].value;
        let [mut normal, tangential] = self.forces[contact];
        if self.is_held(contact) {
            self.pulls[contact] = normal < 0.0;
            normal = normal.abs();
        }
        let limits = match &self.constraints[contact] {
            ContactConstraint::Law(range) | ContactConstraint::Held(range) => {
                [range.backward, range.forward]
            }
            _ => [f64::INFINITY; 2],
        };
        let state = &mut self.states[contact];
        *state = match *state {
            ContactState::Detached if a_normal < 0.0 => ContactState::Stick,
            ContactState::Detached => ContactState::Detached,
            _ if normal < 0.0 => ContactState::Detached,
            ContactState::Stick if tangential > limits[1] * normal => ContactState::Slide,
            ContactState::Stick if tangential < -limits[0] * normal => ContactState::ReverseSlide,
            ContactState::Slide if a_tangential > 0.0 => ContactState::Stick,
            ContactState::ReverseSlide if a_tangential < 0.0 => ContactState::Stick,
            state => state,
        };
    }

    /// `true` if forces that were found by another method obey the law in the present states.
    pub(super) fn are_lawful(&mut self, group: usize, strictness: Strictness) -> bool {
        self.accelerate(group);
        if self.is_lawful(group, strictness) {
            let are_clear = self.are_clear(group, strictness);
            self.has_blurred |= !are_clear;
            return are_clear;
        }
        false
    }

    /// `true` if the forces of a group are small enough for rounding to be negligible; see [`BLURRED`].
    fn are_clear(&self, group: usize, strictness: Strictness) -> bool {
        let missed = strictness.missed();
        let contacts = &self.delassus.groups()[group];
        let largest = |values: [f64; 2]| f64::max(values[0].abs(), values[1].abs());
        let asked = contacts.iter().fold(0.0, |most, &i| f64::max(most, largest(self.free[i])));
        contacts.iter().all(|&i| missed * largest(self.accelerations[i].terms) <= BLURRED * asked)
    }

    /// `true` if the gap of an open contact accelerates away from its surface under the present forces.
    pub(in crate::integrator) fn stays_open(&mut self, contact: usize) -> bool {
        let group = self.delassus.groups().iter().position(|group| group.contains(&contact));
        group.is_some_and(|group| {
            self.accelerate(group);
            self.accelerations[contact].value[0] > 0.0
        })
    }

    /// Computes the accelerations of a group under its forces.
    pub(super) fn accelerate(&mut self, group: usize) {
        let contacts = &self.delassus.groups()[group];
        if contacts.iter().all(|&contact| self.forces[contact] == [0.0; 2]) {
            for &contact in contacts {
                // The sum of a zero has no negative sign.
                let value = self.free[contact].map(|free| free + 0.0);
                self.accelerations[contact] = Acceleration { value, terms: value.map(f64::abs) };
            }
            return;
        }
        for &contact in contacts {
            let mut value = self.free[contact];
            let mut terms = value.map(f64::abs);
            let own = (contact, self.delassus.own(contact));
            for (other, w) in self.delassus.others(contact).iter().copied().chain([own]) {
                let [n, t] = self.forces[other];
                for (row, w) in [[w[0], w[1]], [w[2], w[3]]].into_iter().enumerate() {
                    value[row] += w[0] * n + w[1] * t;
                    terms[row] += (w[0] * n).abs() + (w[1] * t).abs();
                }
            }
            self.accelerations[contact] = Acceleration { value, terms };
        }
    }

    /// `true` if the forces of a group obey the law in its states.
    fn is_lawful(&self, group: usize, strictness: Strictness) -> bool {
        let missed = strictness.missed();
        let room = if strictness == Strictness::Inside { 0.0 } else { missed };
        // If no condition may be at its limit, a value of zero is not above zero.
        let is_above = |value: f64, rounding: f64| match strictness {
            Strictness::Inside => value > 0.0,
            Strictness::UpTo(_) => value >= -rounding,
        };
        self.delassus.groups()[group].iter().all(|&contact| {
            let Acceleration { value, terms } = self.accelerations[contact];
            let [normal, tangential] = self.forces[contact];
            let is_held = |row: usize| value[row].abs() <= missed * terms[row];
            // The rounding of the acceleration in terms of the normal force.
            let nothing = room * terms[0] / self.delassus.own(contact)[0];
            let sign = self.constraints[contact].sign(self.pulls[contact]);
            let presses = || is_held(0) && is_above(sign * normal, nothing);
            match (&self.constraints[contact], self.states[contact]) {
                (ContactConstraint::Open, _) => true,
                (ContactConstraint::Fixed, _) => is_held(0) && is_held(1),
                (ContactConstraint::Guided { .. }, _) => is_held(0),
                (_, ContactState::Detached) => is_above(value[0], room * terms[0]),
                (
                    constraint @ (ContactConstraint::Law(range) | ContactConstraint::Held(range)),
                    ContactState::Stick,
                ) => {
                    // The equations of a contact that is held and sticks are the same whether it presses or pulls.
                    let (has_sign, normal) = match constraint {
                        ContactConstraint::Held(_) => (is_held(0), normal.abs()),
                        _ => (presses(), normal),
                    };
                    let below = tangential + range.backward * normal;
                    let above = range.forward * normal - tangential;
                    let nothing = nothing * (1.0 + range.backward.max(range.forward));
                    has_sign && is_held(1) && is_above(below, nothing) && is_above(above, nothing)
                }
                (ContactConstraint::Law(_) | ContactConstraint::Held(_), state) => {
                    let direction = state.sliding_direction().unwrap_or(1.0);
                    presses() && is_above(-direction * value[1], room * terms[1])
                }
                _ => presses(),
            }
        })
    }
}

/// The equations of a contact that is held in both directions and pulls or presses.
fn held(
    state: ContactState,
    range: &FrictionRange,
    own: LocalProblem,
    pulls: bool,
) -> StateEquations {
    if !pulls {
        return StateEquations::of(state, range, own);
    }
    // T = ±µ|N| = ∓µN.
    let state = match state {
        ContactState::Slide => ContactState::ReverseSlide,
        ContactState::ReverseSlide => ContactState::Slide,
        state => state,
    };
    StateEquations::of(state, &range.pulling(), own)
}
