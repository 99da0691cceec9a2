//! Contact forces of a motion in its present contact states.

use super::EventDriven;
use super::ledger::MotionObserver;
use super::rounding::{DIFFERENCE, NOISE};
use crate::contact::{ContactForce, ContactState};
use crate::integrator::{Inputs, Motion};
use crate::model::Contact;
use crate::numerics::max_norm;

/// Factor of [`NOISE`] within which forces at a limit of the law obey it. A motion stays in a state until its forces
/// miss the law by more than rounding.
const CLOSE: f64 = 16.0;

impl<W: MotionObserver> EventDriven<W> {
    /// Writes the forces that hold the motion in its present states; `false` if those break the law of
    /// contact, as they may when an input was changed since the last step.
    ///
    /// With friction the law may allow several solutions at once: the report gives the one that the motion is in.
    pub(super) fn present_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> bool {
        self.dynamics.free_acceleration(motion, &inputs.force);
        let law = &mut self.series.law;
        law.set(&self.dynamics, &motion.contacts, &inputs.friction);
        let found = law.forces(&self.dynamics, &inputs.slider_acceleration);
        for (out, &[normal_force, friction_force]) in forces.iter_mut().zip(found) {
            (out.normal_force, out.friction_force) = (normal_force, friction_force);
        }
        let fastest = self.fastest(motion, inputs);
        let has_fixed_state = self.dynamics.law.has_fixed_state();
        let may_pull = !self.dynamics.law.detachment;
        let mut is_overheld = false;
        for (i, out) in forces.iter_mut().enumerate() {
            let state = motion.contacts[i];
            let &mut ContactForce { normal_force, friction_force, .. } = out;
            let (slip, surface) = (self.slip(i, motion, inputs), inputs.slider_velocity[i]);
            // For a slider at rest only the other masses determine the magnitude of rounding.
            let still = NOISE * surface.abs().max(fastest);
            let size = normal_force.abs() + self.pulled_forces(i, &motion.displacement);
            let nothing = CLOSE * NOISE * size;
            let is_lawful = match state {
                ContactState::Detached => true,
                ContactState::Stick => {
                    let friction = inputs.friction[i].static_;
                    slip.abs() <= still
                        && friction_force.abs()
                            <= friction * normal_force + (1.0 + friction) * nothing
                        && normal_force >= -nothing
                }
                _ => {
                    let direction = state.sliding_direction().unwrap_or(1.0);
                    (has_fixed_state || direction * slip >= -still)
                        && (may_pull || normal_force >= -nothing)
                }
            };
            if !is_lawful {
                return false;
            }
            is_overheld |= self.overheld[i] && slip.abs() <= still;
            let slip_velocity = if state == ContactState::Stick { 0.0 } else { slip };
            *out = ContactForce { state, slip_velocity, ..*out };
        }
        let still = NOISE * fastest;
        (!is_overheld || self.follow_surfaces(motion, inputs, forces, still))
            && self.stay_open(motion, inputs, forces)
    }

    /// Sets up the contact problem of a report: contacts have the states of the motion, but open contacts that touch
    /// may close.
    pub(super) fn pose_report(&mut self, motion: &Motion, inputs: &Inputs) {
        let still = NOISE * self.fastest(motion, inputs);
        for i in 0..motion.contacts.len() {
            self.likely[i] = motion.contacts[i];
            if self.likely[i] == ContactState::Detached && self.touches(i, motion, inputs) {
                let slip = self.slip(i, motion, inputs);
                self.likely[i] = if slip.abs() <= still {
                    ContactState::Stick
                } else if slip > 0.0 {
                    ContactState::Slide
                } else {
                    ContactState::ReverseSlide
                };
            }
        }
    }

    /// The slip velocity of a contact: that of its surface against that of its masses, m/s.
    fn slip(&self, contact: usize, motion: &Motion, inputs: &Inputs) -> f64 {
        let along = self.dynamics.contacts[contact].tangent.dot(&motion.velocity);
        inputs.slider_velocity[contact] - along
    }

    /// The fastest velocity, m/s; above zero also where all masses are at rest.
    fn fastest(&self, motion: &Motion, inputs: &Inputs) -> f64 {
        max_norm(&motion.velocity).max(self.load_velocity(inputs))
    }

    /// `true` if a contact of those that hold more directions than there are touches while its masses are at rest,
    /// whatever its surface does. Rounding determines which of such contacts carry a force, and the others have the
    /// state open. Masses that move along each other may be at the highest point of a hop of the size of rounding, and
    /// are open there.
    fn touches(&self, contact: usize, motion: &Motion, inputs: &Inputs) -> bool {
        if !self.overheld[contact] {
            return false;
        }
        let contact = &self.dynamics.contacts[contact];
        let Contact { normal, tangent, .. } = contact;
        let strained = self.shortest * self.load_velocity(inputs);
        let still = NOISE * self.fastest(motion, inputs);
        contact.gap_at(&motion.displacement).abs()
            <= NOISE * max_norm(&motion.displacement).max(strained)
            && normal.dot(&motion.velocity).abs() <= still
            && tangent.dot(&motion.velocity).abs() <= still
    }

    /// `true` if no open contact that touches closes under these forces. Surfaces that begin to move may press such
    /// contacts.
    fn stay_open(&self, motion: &Motion, inputs: &Inputs, forces: &[ContactForce]) -> bool {
        let is_asked = |i: &usize| {
            forces[*i].state == ContactState::Detached && self.touches(*i, motion, inputs)
        };
        (0..forces.len()).filter(is_asked).all(|i| {
            let [opening, size] = self.acceleration(i, 0, motion, inputs, forces);
            opening >= -CLOSE * NOISE * size
        })
    }

    /// The acceleration (m/s²) that these forces give the masses of a contact along its normal (0) or its tangent (1),
    /// and the sum of the magnitudes of its terms. Spring forces and outer forces that may balance each other are
    /// separate terms.
    fn acceleration(
        &self,
        contact: usize,
        row: usize,
        motion: &Motion,
        inputs: &Inputs,
        forces: &[ContactForce],
    ) -> [f64; 2] {
        let Contact { normal, tangent, .. } = &self.dynamics.contacts[contact];
        let free = [normal, tangent][row].dot(&self.dynamics.acceleration);
        let given = |i: usize| [forces[i].normal_force, forces[i].friction_force];
        let [carried, size] = self.dynamics.problem.delassus.along(contact, row, given);
        let lost = self.pulled(contact, row, &motion.displacement)
            + DIFFERENCE * self.load_acceleration(&inputs.force);
        [free + carried, size + free.abs() + lost]
    }

    /// The velocity (m/s) that the largest of the outer forces would give a mass within the time scale of the fastest
    /// oscillation. It scales the rounding of velocities where all masses are at rest.
    fn load_velocity(&self, inputs: &Inputs) -> f64 {
        self.shortest * self.load_acceleration(&inputs.force)
    }

    /// `true` if contacts that hold more directions than there are stay on their surfaces under these forces, and slip
    /// or stick as in their states. Only contacts that slip by no more than `still`, m/s, are examined: surfaces that
    /// begin to move may part them.
    fn follow_surfaces(
        &self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &[ContactForce],
        still: f64,
    ) -> bool {
        let is_asked = |i: &usize| {
            let ContactForce { state, slip_velocity, .. } = forces[*i];
            self.overheld[*i] && state != ContactState::Detached && slip_velocity.abs() <= still
        };
        let has_fixed_state = self.dynamics.law.has_fixed_state();
        (0..forces.len()).filter(is_asked).all(|i| {
            let [opening, size] = self.acceleration(i, 0, motion, inputs, forces);
            // A surface that moves a mass along another one presses it into that one, or lifts it off.
            if opening.abs() > CLOSE * NOISE * size {
                return false;
            }
            let [along, size] = self.acceleration(i, 1, motion, inputs, forces);
            let surface = inputs.slider_acceleration[i];
            let nothing = CLOSE * NOISE * (size + surface.abs());
            let slip = surface - along;
            match forces[i].state.sliding_direction() {
                None => slip.abs() <= nothing,
                Some(direction) => has_fixed_state || direction * slip >= -nothing,
            }
        })
    }
}
