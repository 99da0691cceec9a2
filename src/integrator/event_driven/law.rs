//! The equation of motion of given contact states: accelerations and multipliers in one row.

use crate::contact::{ContactState, Friction, FrictionRange};
use crate::integrator::contact_problem::{Delassus, Demand, GivenStates};
use crate::integrator::dynamics::Dynamics;
use crate::integrator::{Kept, Push, Response};
use crate::model::{Contact, Direction};

/// What acts on the masses, or one power of it in time.
#[derive(Clone, Copy)]
pub(super) struct Acting<'a> {
    /// x + β ẋ, m; one value a degree of freedom, as the next two.
    pub(super) stretch: &'a [f64],
    /// ẋ, m/s: what single dampers and α see.
    pub(super) velocity: &'a [f64],
    /// Outer forces, N.
    pub(super) outer: &'a [f64],
    /// The accelerations of the sliders, m/s²; one value a contact.
    pub(super) slider: &'a [f64],
}

/// The accelerations and multipliers of given contact states, on sparse matrices.
///
/// Both stand in one row. What a contact holds has no acceleration of its own, so the place of a degree
/// of freedom that is held carries the multiplier that holds it; multipliers that find no such place
/// (of inclined contacts, and of a second one on the same degree of freedom) stand behind. So the row
/// has the same places in all contact states.
pub(super) struct StateLaw {
    held: GivenStates,
    /// What `held` is set to.
    states: Vec<ContactState>,
    friction: Vec<Friction>,
    /// T/N of contacts that share a load that the equations of sticking leave open.
    shares: Vec<Option<f64>>,
    /// How often shares have changed, and how often they had when `held` was set.
    changes: u64,
    taken: u64,
    /// The place of (N, T) of each contact in a row.
    places: Vec<[usize; 2]>,
    /// Places of a row.
    width: usize,
    force: Vec<f64>,
    acceleration: Vec<f64>,
    free: Vec<[f64; 2]>,
    multipliers: Vec<[f64; 2]>,
}

/// Where N and T of each contact stand in a row, and how many places it has.
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
            shares: vec![None; contacts],
            changes: 0,
            taken: 0,
            places,
            width,
            force: vec![0.0; dofs],
            acceleration: vec![0.0; dofs],
            free: vec![[0.0; 2]; contacts],
            multipliers: vec![[0.0; 2]; contacts],
        }
    }

    /// The number of places of a row.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Where N and T of a contact stand in a row; T of one that sticks alone.
    pub(super) fn places(&self, contact: usize) -> [usize; 2] {
        self.places[contact]
    }

    /// T/N of a contact that slides; zero for any other.
    pub(super) fn slope(&self, contact: usize) -> f64 {
        self.held.slope(contact)
    }

    /// Takes over contact states and µ of each contact.
    pub(super) fn set(
        &mut self,
        dynamics: &Dynamics,
        states: &[ContactState],
        friction: &[Friction],
    ) {
        if self.states != states || self.friction != friction || self.taken != self.changes {
            self.taken = self.changes;
            self.states.clear();
            self.states.extend_from_slice(states);
            self.friction.clear();
            self.friction.extend_from_slice(friction);
            let delassus = &dynamics.problem.delassus;
            self.held.set_all(delassus, |contact| {
                let friction = friction[contact];
                let limit = match states[contact] {
                    ContactState::Stick => friction.static_,
                    _ => friction.kinetic,
                };
                let own = delassus.local(contact);
                Demand::of(states[contact], &FrictionRange::of(limit), own)
            });
            self.take_shares(delassus);
        }
    }

    /// Gives contacts that stick and share their load the share that they have been given, as long as what is held stays the
    /// same.
    fn take_shares(&mut self, delassus: &Delassus) {
        for (group, contacts) in delassus.groups().iter().enumerate() {
            for &contact in contacts {
                let Some(slope) = self.shares[contact] else { continue };
                if self.states[contact] != ContactState::Stick || self.held.is_regular(group) {
                    continue;
                }
                let rank = self.held.rank(group);
                let open = self.held.exchange(delassus, group, contact, Demand::Normal { slope });
                if self.held.rank(group) < rank {
                    self.held.exchange(delassus, group, contact, open);
                }
            }
        }
    }

    /// Notes how a contact shares its load, T/N.
    pub(super) fn share(&mut self, contact: usize, slope: f64) {
        if self.shares[contact] != Some(slope) {
            self.shares[contact] = Some(slope);
            self.changes += 1;
        }
    }

    /// Forgets all shares.
    pub(super) fn forget_shares(&mut self) {
        if self.shares.iter().any(Option::is_some) {
            self.shares.fill(None);
            self.changes += 1;
        }
    }

    /// How often shares have changed: what was computed with others is old.
    pub(super) fn changes(&self) -> u64 {
        self.changes
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

    /// What forces on the masses make of contacts that keep their states.
    pub(super) fn respond(
        &mut self,
        dynamics: &Dynamics,
        kept: Kept<'_>,
        push: Push<'_>,
        response: &mut Response,
    ) {
        let along = |(state, slope): (&ContactState, &f64)| match state.sliding_direction() {
            Some(direction) => Friction::from(direction * slope),
            // Held, whatever that takes.
            None => Friction::from(f64::INFINITY),
        };
        let friction: Vec<Friction> = kept.states.iter().zip(kept.slopes).map(along).collect();
        self.set(dynamics, kept.states, &friction);
        dynamics.push(push, response);
        let Response { forces, acceleration } = response;
        let free = |i: usize, part| match part {
            0 => dynamics.contacts[i].normal.dot(acceleration),
            _ => dynamics.contacts[i].tangent.dot(acceleration) - push.slider_acceleration[i],
        };
        self.held.all_forces(free, forces);
        dynamics.carry(response);
    }

    /// Takes away what rounding has let the gaps (m) of contacts that hold drift. Only inclined contacts
    /// drift.
    pub(super) fn mend_gaps(&mut self, dynamics: &Dynamics, x: &mut [f64]) {
        let contacts = &dynamics.contacts;
        let gap = |i: usize, part| if part == 0 { contacts[i].normal.dot(x) } else { 0.0 };
        self.held.all_forces(gap, &mut self.multipliers);
        respond(dynamics, &self.multipliers, x);
    }

    /// The same of the velocities (m/s), against those of the sliders, `surface`.
    pub(super) fn mend_velocities(&mut self, dynamics: &Dynamics, surface: &[f64], v: &mut [f64]) {
        let contacts = &dynamics.contacts;
        let drift = |i: usize, part| match part {
            0 => contacts[i].normal.dot(v),
            _ => contacts[i].tangent.dot(v) - surface[i],
        };
        self.held.all_forces(drift, &mut self.multipliers);
        respond(dynamics, &self.multipliers, v);
    }

    /// Writes accelerations (m/s²) and multipliers (N) into `row`; places without either are zero.
    pub(super) fn apply(&mut self, dynamics: &Dynamics, acting: Acting, row: &mut [f64]) {
        let Acting { stretch, velocity, outer, slider } = acting;
        for (dof, force) in self.force.iter_mut().enumerate() {
            *force = outer[dof] - dynamics.stiffness.row_times(dof, stretch);
        }
        if !dynamics.dampers.is_empty() {
            for (dof, force) in self.force.iter_mut().enumerate() {
                *force -= dynamics.dampers.row_times(dof, velocity);
            }
        }
        for (dof, a) in self.acceleration.iter_mut().enumerate() {
            *a = dynamics.inverse_mass.row_times(dof, &self.force)
                - dynamics.damping.alpha * velocity[dof];
        }
        // A stuck contact has the acceleration of its slider.
        for (i, (free, contact)) in self.free.iter_mut().zip(&dynamics.contacts).enumerate() {
            *free = [
                contact.normal.dot(&self.acceleration),
                contact.tangent.dot(&self.acceleration) - slider[i],
            ];
        }
        self.held.all_forces(|contact, part| self.free[contact][part], &mut self.multipliers);
        respond(dynamics, &self.multipliers, &mut self.acceleration);
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

/// Adds M⁻¹ Gᵀ λ to what is given; multipliers that are zero are passed over.
fn respond(dynamics: &Dynamics, multipliers: &[[f64; 2]], vector: &mut [f64]) {
    for (forces, responses) in multipliers.iter().zip(&dynamics.responses) {
        for (&force, response) in forces.iter().zip(responses) {
            if force != 0.0 {
                response.add_to(vector, force);
            }
        }
    }
}

/// The degrees of freedom that contacts hold, each with the contact whose slider carries it along.
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
