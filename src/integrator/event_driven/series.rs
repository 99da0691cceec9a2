//! The motion in one contact state as a power series in time.

use super::held::HeldContacts;
use crate::contact::ContactState;
use crate::integrator::Drive;
use crate::integrator::dynamics::Dynamics;

/// The highest power of the displacements.
pub(super) const ORDER: usize = 22;
/// What the last terms may be against the largest.
const TRUNCATION: f64 = 1e-17;
/// By how much a step that the series does not cover is shortened, again and again.
const SHORTER: f64 = 0.8;
/// How often at the most: to 1e-19 of it.
const MOST_SHORTENINGS: u32 = 200;

/// Coefficients of x(τ) = Σ c_k τ^k and of the contact forces; the forces have two powers less.
///
/// With ẍ = M⁻¹ (F − C ẋ − K x + Gᵀ λ) each coefficient follows from the two before it, so that one
/// product with K gives a further power: (k + 2)(k + 1) c_{k+2} is the k-th coefficient of ẍ.
pub(super) struct Series {
    dofs: usize,
    contacts: usize,
    /// c_k, power by power.
    displacement: Vec<f64>,
    /// λ_k, power by power, (N, T) of each contact.
    forces: Vec<[f64; 2]>,
    /// x + β ẋ and ẋ of one power.
    stretch: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
    acceleration: Vec<f64>,
    free: Vec<[f64; 2]>,
}

/// A small number as a double.
pub(super) fn index(k: usize) -> f64 {
    f64::from(u32::try_from(k).unwrap_or(u32::MAX))
}

impl Series {
    pub(super) fn new(dynamics: &Dynamics) -> Self {
        let (dofs, contacts) = (dynamics.acceleration.len(), dynamics.contacts.len());
        Self {
            dofs,
            contacts,
            displacement: vec![0.0; (ORDER + 1) * dofs],
            forces: vec![[0.0; 2]; (ORDER - 1) * contacts],
            stretch: vec![0.0; dofs],
            velocity: vec![0.0; dofs],
            force: vec![0.0; dofs],
            acceleration: vec![0.0; dofs],
            free: vec![[0.0; 2]; contacts],
        }
    }

    /// The series from (x, ẋ) under the outer forces (N) and their rates in the drive, for contact states
    /// that `held` has been set to.
    pub(super) fn expand(
        &mut self,
        dynamics: &Dynamics,
        held: &mut HeldContacts,
        states: &[ContactState],
        drive: &Drive,
        outer: &[f64],
        (x, v): (&[f64], &[f64]),
    ) {
        let n = self.dofs;
        self.displacement[..n].copy_from_slice(x);
        self.displacement[n..2 * n].copy_from_slice(v);
        for k in 0..=ORDER - 2 {
            let ahead = index(k + 1);
            let (known, next) = self.displacement.split_at_mut((k + 2) * n);
            let (c, above) = known[k * n..].split_at(n);
            for ((stretch, velocity), (c, above)) in
                self.stretch.iter_mut().zip(&mut self.velocity).zip(c.iter().zip(above))
            {
                *velocity = ahead * above;
                *stretch = c + dynamics.damping.beta * *velocity;
            }
            for (row, force) in self.force.iter_mut().enumerate() {
                let outer = match k {
                    0 => outer[row],
                    1 => drive.force_rate[row],
                    _ => 0.0,
                };
                *force = outer - dynamics.stiffness.row_times(row, &self.stretch);
            }
            if !dynamics.dampers.is_empty() {
                for (row, force) in self.force.iter_mut().enumerate() {
                    *force -= dynamics.dampers.row_times(row, &self.velocity);
                }
            }
            for (row, a) in self.acceleration.iter_mut().enumerate() {
                *a = dynamics.inverse_mass.row_times(row, &self.force)
                    - dynamics.damping.alpha * self.velocity[row];
            }
            // A stuck contact has the acceleration of its slider.
            let surface = |i: usize| if k == 0 { drive.slider_acceleration[i] } else { 0.0 };
            for (i, (free, contact)) in self.free.iter_mut().zip(&dynamics.contacts).enumerate() {
                *free = [
                    contact.normal.dot(&self.acceleration),
                    contact.tangent.dot(&self.acceleration) - surface(i),
                ];
            }
            let forces = &mut self.forces[k * self.contacts..(k + 1) * self.contacts];
            held.forces(|contact, row| self.free[contact][row], forces);
            for (i, (force, responses)) in forces.iter().zip(&dynamics.responses).enumerate() {
                let (contact, state) = (&dynamics.contacts[i], &states[i]);
                if *state == ContactState::Detached {
                    continue;
                }
                for (&force, response) in force.iter().zip(responses) {
                    response.add_to(&mut self.acceleration, force);
                }
                // What is held lies still to the last bit.
                if let Some(dof) = contact.normal.as_unit() {
                    self.acceleration[dof] = 0.0;
                }
                if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                    self.acceleration[dof] = surface(i);
                }
            }
            let factor = 1.0 / (index(k + 2) * ahead);
            for (next, a) in next[..n].iter_mut().zip(&self.acceleration) {
                *next = a * factor;
            }
        }
    }

    /// The longest step up to `h` (s) that the series covers to the last digits; next to nothing where its
    /// numbers have left their range.
    pub(super) fn reach(&self, h: f64) -> f64 {
        let largest = |k: usize| {
            let c = &self.displacement[k * self.dofs..(k + 1) * self.dofs];
            c.iter().fold(0.0, |largest, c| f64::max(largest, c.abs()))
        };
        let last = [ORDER - 1, ORDER].map(largest);
        let first = [0, 1, 2].map(largest);
        let mut reach = h;
        for _ in 0..MOST_SHORTENINGS {
            let size = first[0].max(first[1] * reach).max(first[2] * reach * reach);
            let mut power = 1.0;
            for _ in 0..ORDER - 1 {
                power *= reach;
            }
            if power * last[0].max(last[1] * reach) <= TRUNCATION * size {
                break;
            }
            reach *= SHORTER;
        }
        reach
    }

    /// x and ẋ at time τ (s).
    pub(super) fn evaluate(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        x.fill(0.0);
        v.fill(0.0);
        for c in self.displacement.chunks_exact(self.dofs).rev() {
            for ((x, v), c) in x.iter_mut().zip(v.iter_mut()).zip(c) {
                *v = *v * t + *x;
                *x = *x * t + c;
            }
        }
    }

    /// The largest acceleration at the beginning, m/s².
    pub(super) fn largest_acceleration(&self) -> f64 {
        let c = &self.displacement[2 * self.dofs..3 * self.dofs];
        2.0 * c.iter().fold(0.0, |largest, c| f64::max(largest, c.abs()))
    }

    /// c_k of the degrees of freedom.
    pub(super) fn displacement(&self, k: usize) -> &[f64] {
        &self.displacement[k * self.dofs..(k + 1) * self.dofs]
    }

    /// λ_k (N, T) of a contact.
    pub(super) fn force(&self, k: usize, contact: usize) -> [f64; 2] {
        self.forces[k * self.contacts + contact]
    }
}
