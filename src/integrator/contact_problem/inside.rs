//! Forces well inside the limits of the law, for contacts that hold more directions than their masses have.
//!
//! The motion of such contacts does not determine how they share their load. Of all lawful shares, those that solve the
//! contact problem lie at a limit: some contact carries nothing, or is about to slip. A moment later they would break
//! the law. A share inside the limits stays lawful while the load changes.

use super::states::Strictness;
use super::{ContactConstraint, ContactProblem, MISSES};
use crate::contact::ContactState;

/// Largest margin to the limits that is tried, relative to the largest force that the load requires.
const MOST: f64 = 0.5;
/// Forces whose margin is below this part are at the limit but for rounding.
const LEAST: f64 = MOST / 134_217_728.0;
/// Ratio of the margins of successive trials.
const FALLS: f64 = 0.125;
/// Largest number of contacts of a group that is solved: a program takes the cube of that number.
const MOST_CONTACTS: usize = 32;

impl ContactProblem {
    /// Looks for forces of a group in these states, under these constraints, that are as far inside the limits of the law
    /// as possible, to a factor of eight; `true` if some were found. Otherwise the forces stay as they were; states and
    /// constraints are those given.
    pub(in crate::integrator) fn solve_inside(
        &mut self,
        group: usize,
        states: &[ContactState],
        constraint: impl Fn(usize) -> ContactConstraint,
    ) -> bool {
        // One contact has no other share, and a larger group would need too large a program.
        if !(2..=MOST_CONTACTS).contains(&self.delassus.groups()[group].len()) {
            return false;
        }
        let mut size = 0.0_f64;
        for &contact in &self.delassus.groups()[group] {
            self.states[contact] = states[contact];
            self.constraints[contact] = constraint(contact);
            self.swept[contact] = self.forces[contact];
            self.unpressed[contact] = self.free[contact];
            let own = self.delassus.own(contact);
            for (free, own) in self.free[contact].iter().zip([own[0], own[3]]) {
                size = size.max(if own > 0.0 { free.abs() / own } else { 0.0 });
            }
        }
        if !self.is_enumerable(group) {
            return false;
        }
        let mut is_found = self.press(group, LEAST * size);
        let mut part = if is_found { MOST } else { 0.0 };
        while part > LEAST && !self.press(group, part * size) {
            part *= FALLS;
        }
        if is_found && part <= LEAST {
            is_found = self.press(group, LEAST * size);
        }
        if !is_found {
            for &contact in &self.delassus.groups()[group] {
                self.forces[contact] = self.swept[contact];
            }
        }
        is_found
    }

    /// Presses each closed contact of a group with `least` (N), and looks for lawful forces that carry the remaining
    /// load; the sum of both is inside the limits of the law. Returns `true` if there are such forces.
    fn press(&mut self, group: usize, least: f64) -> bool {
        for &contact in &self.delassus.groups()[group] {
            self.corrections[contact] = match (self.states[contact], &self.constraints[contact]) {
                (ContactState::Detached, _) => [0.0; 2],
                (_, ContactConstraint::Slipping { direction, friction }) => {
                    [least, direction * friction * least]
                }
                _ => [least, 0.0],
            };
        }
        for &contact in &self.delassus.groups()[group] {
            for row in [0, 1] {
                let [pressed, _] = self.delassus.along(contact, row, |i| self.corrections[i]);
                self.free[contact][row] = self.unpressed[contact][row] + pressed;
            }
        }
        let is_found = self.program(group, Strictness::UpTo(MISSES[1]));
        for &contact in &self.delassus.groups()[group] {
            self.free[contact] = self.unpressed[contact];
            for (force, pressed) in self.forces[contact].iter_mut().zip(self.corrections[contact]) {
                *force += pressed;
            }
        }
        is_found
    }
}
