//! Search for another solution of the law of contact than the one that was taken.
//!
//! With little friction the solution is unique. With more, or where a mass cannot move in all directions, the states of
//! contacts may overlap: several of them obey the law, each with a motion of its own. Then the matrix of some state
//! (eqs. 19–21 for all contacts of a group) has another sign of its determinant than without friction. A matrix of
//! another sign is looked for first, since that does not depend on the motion; where there is one, all states are
//! tried.

use super::given_states::StateEquations;
use super::states::Strictness;
use super::{ContactConstraint, ContactProblem, MISSES};
use crate::contact::ContactState;

/// Largest number of contacts of a group whose states are all tried whenever one of them changes its own: 4⁴ states.
const MOST_CONTACTS: usize = 4;
/// Two motions differ if an acceleration differs by more than this part of the terms that it is the sum of.
const OTHER: f64 = 1e-8;

/// The groups whose states may overlap, and memory for a solution.
pub(super) struct OtherSolutions {
    /// T/N up to which states have been examined, one for each contact.
    limits: Vec<f64>,
    /// `true` for each group of which some state may overlap with another.
    may_overlap: Vec<bool>,
    forces: Vec<[f64; 2]>,
    states: Vec<ContactState>,
    accelerations: Vec<[f64; 2]>,
}

impl OtherSolutions {
    pub(super) fn with_room(contacts: usize, groups: usize) -> Self {
        Self {
            limits: vec![0.0; contacts],
            may_overlap: vec![false; groups],
            forces: vec![[0.0; 2]; contacts],
            states: vec![ContactState::Detached; contacts],
            accelerations: vec![[0.0; 2]; contacts],
        }
    }
}

impl ContactProblem {
    /// Returns, after [`solve`](Self::solve), `true` if the law of contact has another solution with another motion.
    /// Groups of more than four contacts, or with a contact held in both directions, are not examined. The solution
    /// stays as it is.
    pub(in crate::integrator) fn has_another_solution(&mut self) -> bool {
        (0..self.given.groups()).any(|group| self.may_overlap(group) && self.overlaps(group))
    }

    /// `true` if states of a group may overlap with its present or earlier friction.
    #[inline]
    fn may_overlap(&mut self, group: usize) -> bool {
        match self.delassus.groups()[group][..] {
            // Friction does not change the normal force of a single contact whose directions are not coupled.
            [contact] if self.delassus.own(contact)[1] == 0.0 => false,
            _ => self.may_contacts_overlap(group),
        }
    }

    fn may_contacts_overlap(&mut self, group: usize) -> bool {
        let contacts = &self.delassus.groups()[group];
        if contacts.len() > MOST_CONTACTS || !self.is_enumerable(group) || self.has_held(group) {
            return false;
        }
        let mut is_known = true;
        for &contact in contacts {
            let limit = match &self.constraints[contact] {
                ContactConstraint::Law(range) => range.forward.max(range.backward),
                ContactConstraint::Slipping { friction, .. } => *friction,
                _ => 0.0,
            };
            let known = &mut self.others.limits[contact];
            is_known &= limit <= *known;
            *known = known.max(limit);
        }
        if !is_known {
            self.others.may_overlap[group] = self.has_turned_state(group);
        }
        self.others.may_overlap[group]
    }

    /// `true` if the matrix of any state has the other sign. Determinants are linear in the friction of each contact,
    /// so their values at its limits decide for all lower ones.
    fn has_turned_state(&mut self, group: usize) -> bool {
        let Self { given, delassus, others, .. } = self;
        let contacts = &delassus.groups()[group];
        (0..states(contacts.len())).any(|code| {
            given.set(delassus, group, |contact| {
                let place = contacts.binary_search(&contact).unwrap_or(0);
                let state = state(code, place);
                match (state, state.sliding_direction()) {
                    (ContactState::Detached, _) => StateEquations::Nothing,
                    (_, Some(direction)) => {
                        StateEquations::Normal { slope: direction * others.limits[contact] }
                    }
                    _ => StateEquations::Both,
                }
            });
            given.orientation(group) < 0.0
        })
    }

    /// `true` if another state of a group obeys the law with another motion.
    fn overlaps(&mut self, group: usize) -> bool {
        self.accelerate(group);
        for &contact in &self.delassus.groups()[group] {
            self.others.forces[contact] = self.forces[contact];
            self.others.states[contact] = self.states[contact];
            self.others.accelerations[contact] = self.accelerations[contact].value;
        }
        let count = states(self.delassus.groups()[group].len());
        let found = (0..count).any(|code| {
            let mut is_possible = true;
            for (place, &contact) in self.delassus.groups()[group].iter().enumerate() {
                self.states[contact] = state(code, place);
                is_possible &= self.possible(contact).contains(&self.states[contact]);
            }
            is_possible
                && self.solve_states(group, Strictness::UpTo(MISSES[1]))
                && self.moves_otherwise(group)
        });
        for &contact in &self.delassus.groups()[group] {
            self.forces[contact] = self.others.forces[contact];
            self.states[contact] = self.others.states[contact];
        }
        found
    }

    /// `true` if the present motion differs from the one that was kept.
    fn moves_otherwise(&self, group: usize) -> bool {
        self.delassus.groups()[group].iter().any(|&contact| {
            let (now, kept) = (&self.accelerations[contact], &self.others.accelerations[contact]);
            (0..2).any(|row| (now.value[row] - kept[row]).abs() > OTHER * now.terms[row])
        })
    }
}

/// Number of joint states of this number of contacts.
fn states(contacts: usize) -> usize {
    1 << (2 * contacts)
}

/// The state of the contact at a place in its group, in the joint state with this code.
fn state(code: usize, place: usize) -> ContactState {
    ContactState::ALL[(code >> (2 * place)) & 3]
}
