//! What contacts add to a step: their multipliers, the corrector, and gaps and slips that are exact zeros.

use crate::contact::ContactState;
use crate::integrator::dynamics::Dynamics;
use crate::integrator::{Drive, Motion, StepFailure};
use crate::model::Contact;

/// The contacts that lie along degrees of freedom.
pub(super) struct Contacts {
    /// Of each contact: the degree of freedom that is its gap, and the one that is its tangential displacement.
    along: Vec<[Option<usize>; 2]>,
}

impl Contacts {
    pub(super) fn new(contacts: &[Contact]) -> Self {
        let along = |contact: &Contact| [contact.normal.as_unit(), contact.tangent.as_unit()];
        Self { along: contacts.iter().map(along).collect() }
    }

    /// Takes a step from x and ẋ with the acceleration ẍ that there would be without contact forces. The
    /// multipliers of the step stay in `dynamics`.
    pub(super) fn step(
        &self,
        dynamics: &mut Dynamics,
        motion: &mut Motion,
        (x, v, a): (&mut [f64], &mut [f64], &mut [f64]),
        drive: &Drive,
        h: f64,
    ) -> Result<(), StepFailure> {
        let Dynamics { contacts, multipliers, responses, freedom_of, .. } = &mut *dynamics;
        for (i, contact) in contacts.iter().enumerate() {
            let normal = contact.normal.dot(v);
            let slip = contact.tangent.dot(v) - drive.slider_velocity[i];
            // A closed contact has no gap: a rounding error of one would be an impulse gap/h.
            let gap = match motion.contacts[i] {
                // Below zero it is what rounding leaves when a contact opens.
                ContactState::Detached => contact.normal.dot(x).max(0.0),
                _ => 0.0,
            };
            let surface = drive.slider_velocity[i];
            multipliers.freedom[i] =
                freedom_of(drive.friction[i], -slip, surface, motion.contacts[i]);
            multipliers.free[i] =
                [contact.normal.dot(a) + (normal + gap / h) / h, contact.tangent.dot(a) + slip / h];
        }
        let sweeps = multipliers.solve()?;
        motion.statistics.steps += 1;
        motion.statistics.count_sweeps(sweeps);

        for (force, responses) in multipliers.forces.iter().zip(&*responses) {
            for (&force, response) in force.iter().zip(responses) {
                response.add_to(a, force);
            }
        }
        for (v, a) in v.iter_mut().zip(&*a) {
            *v += h * a;
        }
        self.settle(&multipliers.states, motion, (x, &mut *v), drive, h);
        if dynamics.law.is_reduced() {
            dynamics.count_broken(motion, v, drive);
        }
        Ok(())
    }

    /// Moves the masses on; where a contact lies along a degree of freedom, its gap and its slip
    /// become exact zeros, so that the tolerance of the multipliers leaves no drift.
    fn settle(
        &self,
        states: &[ContactState],
        motion: &mut Motion,
        (x, v): (&mut [f64], &mut [f64]),
        drive: &Drive,
        h: f64,
    ) {
        for (i, (&state, old)) in states.iter().zip(&mut motion.contacts).enumerate() {
            if state != *old {
                motion.statistics.state_changes += 1;
                motion.statistics.touch_downs += u64::from(*old == ContactState::Detached);
                *old = state;
            }
            if let ([_, Some(tangent)], ContactState::Stick) = (self.along[i], state) {
                v[tangent] = drive.slider_velocity[i];
            }
        }
        let held = || {
            let closed = self
                .along
                .iter()
                .zip(states)
                .filter(|(_, state)| **state != ContactState::Detached);
            closed.filter_map(|(along, _)| along[0])
        };
        for normal in held() {
            v[normal] = (0.0 - x[normal]) / h;
        }
        for (x, v) in x.iter_mut().zip(&*v) {
            *x += h * v;
        }
        for normal in held() {
            x[normal] = 0.0;
        }
    }
}
