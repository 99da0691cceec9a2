//! The part of contacts in a step: their multipliers, the corrector, and gaps and slips that are exact zeros.

use crate::contact::ContactState;
use crate::integrator::dynamics::Dynamics;
use crate::integrator::{Inputs, Motion, StepFailure};
use crate::model::Direction;
use std::ops::Range;

/// G and M⁻¹ Gᵀ, contact by contact in one list.
pub(super) struct Contacts {
    /// Degrees of freedom and factors.
    parts: Vec<(usize, f64)>,
    places: Vec<Place>,
}

/// Places of a contact in the list, and the degrees of freedom along which it lies.
struct Place {
    normal: Range<usize>,
    tangent: Range<usize>,
    /// M⁻¹ Gᵀ for the normal and for the tangent.
    responses: [Range<usize>; 2],
    /// The degree of freedom that is its gap, and the one that is its tangential displacement; `None` if there is none.
    along: [Option<usize>; 2],
    /// Its gap in the reference position, m.
    gap: f64,
    /// The place along that degree of freedom at which the contact is closed, m.
    closed: f64,
}

impl Contacts {
    pub(super) fn new(dynamics: &Dynamics) -> Self {
        let mut parts = Vec::new();
        let mut add = |direction: &Direction| {
            let start = parts.len();
            parts.extend(&direction.0);
            start..parts.len()
        };
        let pairs = dynamics.contacts.iter().zip(&dynamics.responses);
        let places = pairs.map(|(contact, responses)| Place {
            normal: add(&contact.normal),
            tangent: add(&contact.tangent),
            responses: responses.each_ref().map(&mut add),
            along: [contact.normal.as_unit(), contact.tangent.as_unit()],
            gap: contact.gap,
            closed: contact.closed_place(),
        });
        let places = places.collect();
        Self { parts, places }
    }

    /// Takes a step from x and ẋ with the acceleration ẍ without contact forces. The multipliers of the step stay in
    /// `dynamics`.
    pub(super) fn step(
        &self,
        dynamics: &mut Dynamics,
        motion: &mut Motion,
        (x, v, a): (&mut [f64], &mut [f64], &mut [f64]),
        inputs: &Inputs,
        h: f64,
    ) -> Result<(), StepFailure> {
        let Dynamics { problem, constraint_of, law, response_columns, .. } = &mut *dynamics;
        // In slices of one length no index needs a check of its own.
        let (v, a) = (&mut v[..x.len()], &mut a[..x.len()]);
        let contacts = self.places.len();
        let (before, slider) = (&motion.contacts[..contacts], &inputs.slider_velocity[..contacts]);
        let (friction, free) = (&inputs.friction[..contacts], &mut problem.free[..contacts]);
        let constraints = &mut problem.constraints[..contacts];
        for (i, place) in self.places.iter().enumerate() {
            let (mut normal, mut gap, mut approach) = (0.0, place.gap, 0.0);
            for &(dof, factor) in &self.parts[place.normal.clone()] {
                normal += factor * v[dof];
                gap += factor * x[dof];
                approach += factor * a[dof];
            }
            let (mut slip, mut drift) = (0.0, 0.0);
            for &(dof, factor) in &self.parts[place.tangent.clone()] {
                slip += factor * v[dof];
                drift += factor * a[dof];
            }
            // A closed contact has no gap: a rounding error of one would be an impulse gap/h.
            gap = match before[i] {
                // A value below zero is the rounding of the gap when a contact opens.
                ContactState::Detached => f64::max(gap, 0.0),
                _ => 0.0,
            };
            let slip = slip - slider[i];
            constraints[i] = constraint_of(friction[i], -slip, slider[i], before[i]);
            free[i] = [approach + (normal + gap / h) / h, drift + slip / h];
        }
        let follows_size = law.follows_size();
        if follows_size {
            problem.pulls.copy_from_slice(&motion.pulls);
        }
        let sweeps = problem.solve(before)?;
        if follows_size {
            motion.pulls.copy_from_slice(&problem.pulls);
        }
        let is_decided = motion.statistics.steps == 0 || problem.states != before;
        let has_others = is_decided && problem.has_another_solution();
        motion.statistics.other_solutions += u64::from(has_others);
        motion.statistics.steps += 1;
        motion.statistics.count_sweeps(sweeps);

        if let Some(columns) = response_columns {
            columns.add_product(problem.forces.as_flattened(), a);
        } else {
            for (place, forces) in self.places.iter().zip(&problem.forces) {
                for (force, response) in forces.iter().zip(&place.responses) {
                    for &(dof, factor) in &self.parts[response.clone()] {
                        a[dof] += force * factor;
                    }
                }
            }
        }
        for (v, a) in v.iter_mut().zip(&*a) {
            *v += h * a;
        }
        self.advance_displacements(&problem.states, motion, (x, &mut *v), slider, h);
        if dynamics.law.is_reduced() {
            dynamics.count_broken(motion, v, inputs);
        }
        Ok(())
    }

    /// Advances the displacements; where a contact lies along a degree of freedom, its gap and its slip become exact
    /// zeros, so that the tolerance of the multipliers leaves no drift.
    fn advance_displacements(
        &self,
        states: &[ContactState],
        motion: &mut Motion,
        (x, v): (&mut [f64], &mut [f64]),
        slider: &[f64],
        h: f64,
    ) {
        for (i, (&state, old)) in states.iter().zip(&mut motion.contacts).enumerate() {
            if state != *old {
                motion.statistics.count_change(state);
                motion.statistics.touch_downs += u64::from(*old == ContactState::Detached);
                *old = state;
            }
            if let ([_, Some(tangent)], ContactState::Stick) = (self.places[i].along, state) {
                v[tangent] = slider[i];
            }
        }
        let held = || {
            let closed = |state: &ContactState| *state != ContactState::Detached;
            let places = self.places.iter().zip(states).filter(move |(_, state)| closed(state));
            places.filter_map(|(place, _)| Some((place.along[0]?, place.closed)))
        };
        for (normal, closed) in held() {
            v[normal] = (closed - x[normal]) / h;
        }
        for (x, v) in x.iter_mut().zip(&*v) {
            *x += h * v;
        }
        for (normal, closed) in held() {
            x[normal] = closed;
        }
    }
}
