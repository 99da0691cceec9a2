//! Equation of motion in given contact states, with accelerations and multipliers in one row.

use crate::contact::{ContactState, Friction, FrictionRange};
use crate::integrator::contact_problem::{GivenStates, StateEquations};
use crate::integrator::dynamics::Dynamics;
use crate::integrator::per_mass::Strain;
use crate::integrator::{AppliedLoad, ConstrainedResponse, HeldStates};
use crate::model::{Contact, Direction};

/// Forces balance each other if their sum is at most this part of their magnitudes.
const SHARED: f64 = 1e-9;

/// The actions on the masses, or one power of them in time.
#[derive(Clone, Copy)]
pub(super) struct Actions<'a> {
    /// x + β ẋ, m; one value for each degree of freedom, as `velocity` and `outer`.
    pub(super) stretch: &'a [f64],
    /// Velocity ẋ, m/s, on which discrete dampers and α act.
    pub(super) velocity: &'a [f64],
    /// Outer forces, N.
    pub(super) outer: &'a [f64],
    /// Accelerations of the sliders, m/s²; one value for each contact.
    pub(super) slider: &'a [f64],
}

/// Linear map from the actions on the masses to accelerations and multipliers in given contact states, on sparse
/// matrices.
///
/// Accelerations and multipliers form one row. A degree of freedom that a contact holds has no free acceleration, so
/// its place carries the multiplier that holds it; multipliers without such a place (of inclined contacts, and of a
/// second contact on the same degree of freedom) follow behind. So the row has the same places in all contact states.
pub(super) struct StateLaw {
    held: GivenStates,
    /// The contact states for which `held` is set up.
    states: Vec<ContactState>,
    friction: Vec<Friction>,
    /// Self-balanced forces (N, T) of each contact, N: the correction to the forces of the equations where these do not
    /// determine how contacts share their load.
    shared: Vec<[f64; 2]>,
    /// The place of (N, T) of each contact in a row.
    places: Vec<[usize; 2]>,
    /// Number of places of a row.
    width: usize,
    force: Vec<f64>,
    acceleration: Vec<f64>,
    free: Vec<[f64; 2]>,
    multipliers: Vec<[f64; 2]>,
}

/// Returns the places of N and T of each contact in a row, and the number of places of a row.
pub(super) fn places(contacts: &[Contact], dofs: usize) -> (Vec<[usize; 2]>, usize) {
    let mut is_taken = vec![false; dofs];
    let mut width = dofs;
    let mut place = |direction: &Direction| match direction.as_unit() {
        Some(dof) if !is_taken[dof] => {
            is_taken[dof] = true;
            dof
        }
        _ => {
            width += 1;
            width - 1
        }
    };
    let places = contacts.iter().map(|contact| [place(&contact.normal), place(&contact.tangent)]);
    (places.collect(), width)
}

impl StateLaw {
    pub(super) fn new(dynamics: &Dynamics) -> Self {
        let (dofs, contacts) = (dynamics.acceleration.len(), dynamics.contacts.len());
        let (places, width) = places(&dynamics.contacts, dofs);
        Self {
            held: GivenStates::new(&dynamics.problem.delassus),
            states: Vec::with_capacity(contacts),
            friction: Vec::with_capacity(contacts),
            shared: vec![[0.0; 2]; contacts],
            places,
            width,
            force: vec![0.0; dofs],
            acceleration: vec![0.0; dofs],
            free: vec![[0.0; 2]; contacts],
            multipliers: vec![[0.0; 2]; contacts],
        }
    }

    /// Number of places of a row.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Places of N and T of a contact in a row; that of T is used only while the contact sticks.
    pub(super) fn places(&self, contact: usize) -> [usize; 2] {
        self.places[contact]
    }

    /// T/N of a contact that slides; zero for any other.
    pub(super) fn slope(&self, contact: usize) -> f64 {
        self.held.slope(contact)
    }

    /// Sets the contact states and µ of each contact.
    pub(super) fn set(
        &mut self,
        dynamics: &Dynamics,
        states: &[ContactState],
        friction: &[Friction],
    ) {
        if self.states != states || self.friction != friction {
            self.states.clear();
            self.states.extend_from_slice(states);
            self.friction.clear();
            self.friction.extend_from_slice(friction);
            let delassus = &dynamics.problem.delassus;
            let equations = |contact: usize| {
                let friction = friction[contact];
                let limit = match states[contact] {
                    ContactState::Stick => friction.static_,
                    _ => friction.kinetic,
                };
                let own = delassus.local(contact);
                StateEquations::of(states[contact], &FrictionRange::of(limit), own)
            };
            self.held.set_all(delassus, equations, &dynamics.problem.given);
        }
    }

    /// Lets the contacts of a group share their load as in the forces of the contact problem, if these move the masses
    /// as those of the equations do. `dynamics` has the accelerations without contact forces.
    pub(super) fn share(&mut self, dynamics: &Dynamics, slider: &[f64], group: usize) {
        let Dynamics { problem, .. } = dynamics;
        let contacts = &problem.delassus.groups()[group];
        self.forces(dynamics, slider);
        for &contact in contacts {
            let (found, given) = (problem.forces[contact], self.multipliers[contact]);
            self.shared[contact] = [0, 1].map(|part| found[part] - given[part]);
        }
        let holds = |&contact: &usize| {
            [0, 1].into_iter().all(|row| {
                let along =
                    |forces: &[[f64; 2]]| problem.delassus.along(contact, row, |i| forces[i]);
                let ([sum, _], [_, found], [_, given]) =
                    (along(&self.shared), along(&problem.forces), along(&self.multipliers));
                // The sum is compared with the forces, not with their difference: where they are equal, that is rounding.
                sum.abs() <= SHARED * (found + given)
            })
        };
        if !contacts.iter().all(holds) {
            self.share_no_more(dynamics, group);
        }
    }

    /// Lets the contacts of a group share their load as the equations give it.
    pub(super) fn share_no_more(&mut self, dynamics: &Dynamics, group: usize) {
        for &contact in &dynamics.problem.delassus.groups()[group] {
            self.shared[contact] = [0.0; 2];
        }
    }

    /// Lets all contacts share their load as the equations give it.
    pub(super) fn forget_shared(&mut self) {
        self.shared.fill([0.0; 2]);
    }

    /// Adds to the row of these states the correction of the shared loads.
    pub(super) fn add_shared(&self, states: &[ContactState], row: &mut [f64]) {
        for ((places, shared), state) in self.places.iter().zip(&self.shared).zip(states) {
            if *shared != [0.0; 2] {
                row[places[0]] += shared[0];
                if *state == ContactState::Stick {
                    row[places[1]] += shared[1];
                }
            }
        }
    }

    /// (N, T) of each contact, N, where `dynamics` has the accelerations without contact forces.
    pub(super) fn forces(&mut self, dynamics: &Dynamics, slider: &[f64]) -> &[[f64; 2]] {
        let free = |i: usize, part| {
            let contact = &dynamics.contacts[i];
            match part {
                0 => contact.normal.dot(&dynamics.acceleration),
                _ => contact.tangent.dot(&dynamics.acceleration) - slider[i],
            }
        };
        self.held.all_forces(free, &mut self.multipliers);
        &self.multipliers
    }

    /// Computes the response to forces on the masses of contacts that keep their states.
    pub(super) fn respond(
        &mut self,
        dynamics: &Dynamics,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) {
        let along = |(state, slope): (&ContactState, &f64)| match state.sliding_direction() {
            Some(direction) => Friction::from(direction * slope),
            // Static friction without a limit.
            None => Friction::from(f64::INFINITY),
        };
        let friction: Vec<Friction> = held.states.iter().zip(held.slopes).map(along).collect();
        self.set(dynamics, held.states, &friction);
        dynamics.accelerate_freely(load, response);
        let ConstrainedResponse { forces, acceleration } = response;
        let free = |i: usize, part| match part {
            0 => dynamics.contacts[i].normal.dot(acceleration),
            _ => dynamics.contacts[i].tangent.dot(acceleration) - load.slider_acceleration[i],
        };
        self.held.all_forces(free, forces);
        dynamics.add_contact_accelerations(response);
    }

    /// Removes the drift of gaps (m) that rounding causes at closed contacts. Only inclined contacts drift.
    pub(super) fn project_positions(&mut self, dynamics: &Dynamics, x: &mut [f64]) {
        let contacts = &dynamics.contacts;
        let gap = |i: usize, part| if part == 0 { contacts[i].gap_at(x) } else { 0.0 };
        self.held.all_forces(gap, &mut self.multipliers);
        dynamics.add_responses(&self.multipliers, x);
    }

    /// Removes the velocities (m/s) that rounding has given to contacts along directions in which they are held,
    /// relative to those of their surfaces, `surface`.
    pub(super) fn project_velocities(
        &mut self,
        dynamics: &Dynamics,
        surface: &[f64],
        v: &mut [f64],
    ) {
        let contacts = &dynamics.contacts;
        let drift = |i: usize, part| match part {
            0 => contacts[i].normal.dot(v),
            _ => contacts[i].tangent.dot(v) - surface[i],
        };
        self.held.all_forces(drift, &mut self.multipliers);
        dynamics.add_responses(&self.multipliers, v);
    }

    /// Writes accelerations (m/s²) and multipliers (N) into `row`; places without either are zero.
    pub(super) fn apply(&mut self, dynamics: &Dynamics, acting: Actions, row: &mut [f64]) {
        let Actions { stretch, velocity, outer, slider } = acting;
        let Self { force, acceleration, .. } = self;
        let Dynamics { stiffness, dampers, inverse_mass, damping, .. } = dynamics;
        let alpha = damping.alpha;
        if let Some(per_mass) = &dynamics.per_mass {
            if outer.iter().all(|force| *force == 0.0) {
                acceleration.fill(0.0);
            } else {
                inverse_mass.each_product(outer, |dof, driven| acceleration[dof] = driven);
            }
            per_mass.subtract(Strain { stretch, velocity, alpha }, acceleration);
        } else {
            stiffness.each_product(stretch, |dof, springs| force[dof] = outer[dof] - springs);
            if !dampers.is_empty() {
                dampers.each_product(velocity, |dof, damped| force[dof] -= damped);
            }
            inverse_mass.each_product(force, |dof, a| {
                acceleration[dof] = a - alpha * velocity[dof];
            });
        }
        // A stuck contact has the acceleration of its slider.
        for (i, (free, contact)) in self.free.iter_mut().zip(&dynamics.contacts).enumerate() {
            *free = [
                contact.normal.dot(&self.acceleration),
                contact.tangent.dot(&self.acceleration) - slider[i],
            ];
        }
        self.held.all_forces(|contact, part| self.free[contact][part], &mut self.multipliers);
        dynamics.add_responses(&self.multipliers, &mut self.acceleration);
        let dofs = self.acceleration.len();
        row[..dofs].copy_from_slice(&self.acceleration);
        row[dofs..].fill(0.0);
        held_dofs(dynamics, &self.states, |dof, _| row[dof] = 0.0);
        for (i, &state) in self.states.iter().enumerate() {
            if state == ContactState::Detached {
                continue;
            }
            let ([normal, tangent], force) = (self.places[i], self.multipliers[i]);
            row[normal] = force[0];
            if state == ContactState::Stick {
                row[tangent] = force[1];
            }
        }
    }
}

/// Returns the degrees of freedom that contacts hold, each with the contact whose slider moves it.
pub(super) fn held_dofs(
    dynamics: &Dynamics,
    states: &[ContactState],
    mut found: impl FnMut(usize, Option<usize>),
) {
    for (i, (contact, state)) in dynamics.contacts.iter().zip(states).enumerate() {
        if *state == ContactState::Detached {
            continue;
        }
        if let Some(dof) = contact.normal.as_unit() {
            found(dof, None);
        }
        if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
            found(dof, Some(i));
        }
    }
}
