//! Enumeration of contact states: a search that finds a solution of the law, or proves that none exists.
//!
//! Where a state's equations determine its forces, those obey the law or do not. Where they do not (contacts that hold one
//! mass twice), the first phase of the simplex method tells whether any forces do. So where no state has forces, the law has no
//! solution.
//!
//! The states of contacts are chosen one contact after the other. For contacts without a chosen state the law asks at
//! least that nothing pulls, that friction stays within its limits, and that no contact is pressed into its surface. If
//! no forces meet even these conditions, all states that follow are left out (branch and bound).

use super::{ContactConstraint, ContactProblem, Strictness};
use crate::contact::ContactState;

/// The search is always completed if there are no more states than this: those of eight contacts under the full law.
const FEW_STATES: usize = 4_usize.pow(8);
/// Limit of the work among more states. The work of a choice is counted as the third power of the number of contacts.
const MOST_WORK: usize = 200_000_000;
/// A state is taken to have forces if the artificial unknowns sum up to no more than this part of the right-hand sides.
const FEASIBLE: f64 = 1e-11;
/// States are proven to have no forces if the artificial unknowns sum up to no less than this part of the right-hand
/// sides.
const INFEASIBLE: f64 = 1e-8;
/// A reduced cost or an entry below this value counts as zero, where rows are of order one.
const NOTHING: f64 = 1e-12;
/// Largest number of pivots of Bland's rule for each column and row.
const MOST_PIVOTS: usize = 64;

/// A non-negative unknown.
#[derive(Clone, Copy, Debug)]
enum Unknown {
    /// |N| of a contact, which pulls where `sign` is −1, with T = `slope` |N|.
    Normal { contact: usize, sign: f64, slope: f64 },
    /// T − (−b |N|) of a contact that sticks.
    Tangential { contact: usize },
    /// Slack of a row: the amount by which its left side exceeds its right side.
    Rest { row: usize },
}

/// An equation of the program.
#[derive(Clone, Copy, Debug)]
enum Equation {
    /// a_N, or a_N less its slack.
    Normal { contact: usize },
    /// ±a_T and its slack.
    Tangential { contact: usize, direction: f64 },
    /// (f + b) |N| − (T + b |N|) less its slack.
    Cone { contact: usize, width: f64 },
}

/// The result of the first phase of the simplex method.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FirstPhase {
    /// A solution was found.
    Solved,
    /// No solution exists: the artificial unknowns sum up to at least this part of the right-hand sides.
    Impossible(f64),
    /// The pivots ended without a result.
    Open,
}

/// The result of a search through all states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Search {
    /// A state was found whose forces obey the law.
    Found,
    /// No state has forces that obey the law.
    Nothing,
    /// The search was given up, or it does not apply to these contacts.
    Unfinished,
}

/// A linear program of contact states, or of the necessary conditions of the law.
pub(super) struct LinearProgram {
    unknowns: Vec<Unknown>,
    rows: Vec<Equation>,
    /// The table by rows, with the right-hand side at the end.
    table: Vec<f64>,
    costs: Vec<f64>,
    /// The unknown of each row; numbers from that of the unknowns on are artificial ones.
    basis: Vec<usize>,
    pivot_row: Vec<f64>,
    /// The likely states with which the search begins, one for each contact of the group.
    first: Vec<ContactState>,
}

impl LinearProgram {
    /// Allocates memory for groups of up to `contacts` contacts.
    pub(super) fn with_room(contacts: usize) -> Self {
        let contacts = if contacts > 1 { contacts } else { 0 };
        let (rows, unknowns) = (3 * contacts, 5 * contacts);
        Self {
            unknowns: Vec::with_capacity(unknowns),
            rows: Vec::with_capacity(rows),
            table: Vec::with_capacity(rows * (unknowns + 1)),
            costs: Vec::with_capacity(unknowns + 1),
            basis: Vec::with_capacity(rows),
            pivot_row: Vec::with_capacity(unknowns + 1),
            first: Vec::with_capacity(contacts),
        }
    }

    /// Writes the necessary conditions of the law of a contact, in whatever state it is.
    fn ask_least(&mut self, contact: usize, constraint: &ContactConstraint) {
        let Self { unknowns, rows, .. } = self;
        let (slope, width) = match constraint {
            ContactConstraint::Slipping { direction, friction }
            | ContactConstraint::HeldSlipping { direction, friction } => {
                (direction * friction, None)
            }
            ContactConstraint::Law(range) | ContactConstraint::Held(range) => {
                (-range.backward, Some(range.forward + range.backward))
            }
            ContactConstraint::Open
            | ContactConstraint::Fixed
            | ContactConstraint::Guided { .. } => return,
        };
        unknowns.push(Unknown::Normal { contact, sign: 1.0, slope });
        unknowns.push(match constraint.is_held() {
            true => Unknown::Normal { contact, sign: -1.0, slope },
            false => Unknown::Rest { row: rows.len() },
        });
        rows.push(Equation::Normal { contact });
        if let Some(width) = width {
            unknowns.push(Unknown::Tangential { contact });
            unknowns.push(Unknown::Rest { row: rows.len() });
            rows.push(Equation::Cone { contact, width });
        }
    }

    /// Runs the first phase of the simplex method with Bland's rule.
    fn run(&mut self) -> FirstPhase {
        let Self { unknowns, table, costs, basis, pivot_row, .. } = self;
        let (count, width) = (unknowns.len(), unknowns.len() + 1);
        let size =
            table.chunks_exact(width).fold(0.0, |most, row| f64::max(most, row[count].abs()));
        basis.clear();
        costs.clear();
        costs.resize(width, 0.0);
        for (place, row) in table.chunks_exact_mut(width).enumerate() {
            if row[count] < 0.0 {
                row.iter_mut().for_each(|entry| *entry = -*entry);
            }
            basis.push(count + place);
            for (cost, entry) in costs.iter_mut().zip(&*row) {
                *cost -= entry;
            }
        }
        for _ in 0..MOST_PIVOTS * (width + basis.len()) {
            if -costs[count] <= FEASIBLE * size {
                return FirstPhase::Solved;
            }
            let Some(entering) = costs[..count].iter().position(|cost| *cost < -NOTHING) else {
                return FirstPhase::Impossible(-costs[count] / size);
            };
            let falls = |row: &&[f64]| row[entering] > NOTHING;
            let least = table.chunks_exact(width).filter(falls);
            let least = least.map(|row| row[count] / row[entering]).fold(f64::INFINITY, f64::min);
            let leaves = |place: &usize| {
                let row = &table[place * width..][..width];
                row[entering] > NOTHING && row[count] / row[entering] <= least
            };
            let Some(place) = (0..basis.len()).filter(leaves).min_by_key(|place| basis[*place])
            else {
                return FirstPhase::Open;
            };
            let own = &mut table[place * width..][..width];
            let pivot = own[entering];
            own.iter_mut().for_each(|entry| *entry /= pivot);
            pivot_row.clear();
            pivot_row.extend_from_slice(own);
            for (other, row) in table.chunks_exact_mut(width).enumerate() {
                if other != place {
                    subtract(row, pivot_row, entering);
                }
            }
            subtract(costs, pivot_row, entering);
            basis[place] = entering;
        }
        FirstPhase::Open
    }
}

/// Subtracts the multiple of the pivot's row that makes the entering column zero.
fn subtract(row: &mut [f64], pivot_row: &[f64], entering: usize) {
    let factor = row[entering];
    if factor != 0.0 {
        for (entry, own) in row.iter_mut().zip(pivot_row) {
            *entry -= factor * own;
        }
        row[entering] = 0.0;
    }
}

impl ContactProblem {
    /// `true` if the law of each contact of a group is one of contact states. Contacts that are held along both
    /// directions, or guided, have none.
    pub(super) fn is_enumerable(&self, group: usize) -> bool {
        let has_none = |i: &usize| {
            matches!(
                self.constraints[*i],
                ContactConstraint::Fixed | ContactConstraint::Guided { .. }
            )
        };
        !self.delassus.groups()[group].iter().any(has_none)
    }

    /// Looks for a state of a group whose forces obey the law, first near the present one.
    pub(super) fn enumerate(&mut self, group: usize, strictness: Strictness) -> Search {
        let contacts = self.delassus.groups()[group].len();
        let contact = |of: &Self, place: usize| of.delassus.groups()[group][place];
        if !self.is_enumerable(group) {
            return Search::Unfinished;
        }
        self.enumeration.first.clear();
        let mut states = 1_usize;
        for place in 0..contacts {
            let contact = contact(self, place);
            let possible = self.possible(contact);
            // A contact that is held may press or pull.
            let signs = if self.is_held(contact) { 2 } else { 1 };
            states = states.saturating_mul(signs * possible.len());
            let is_at_hand = |state: &&ContactState| **state == self.states[contact];
            let first = possible.iter().find(is_at_hand).unwrap_or(&possible[0]);
            self.enumeration.first.push(*first);
        }
        // Number of contacts whose state is chosen.
        let mut chosen = 0;
        let mut work = 0;
        loop {
            work += contacts.pow(3);
            if states > FEW_STATES && work > MOST_WORK {
                return Search::Unfinished;
            }
            if chosen == contacts {
                let obeys = self.solve_states(group, strictness)
                    || !self.given.is_regular(group) && self.program(group, strictness);
                if obeys {
                    return Search::Found;
                }
            } else if chosen + 1 == contacts || !self.is_impossible(group, chosen) {
                let next = contact(self, chosen);
                self.states[next] = self.enumeration.first[chosen];
                self.pulls[next] = false;
                chosen += 1;
                continue;
            }
            loop {
                if chosen == 0 {
                    return Search::Nothing;
                }
                let first = self.enumeration.first[chosen - 1];
                if self.take_next(contact(self, chosen - 1), first) {
                    break;
                }
                chosen -= 1;
            }
        }
    }

    /// Gives a contact its next state or sign; `false` where it begins again with the first one.
    fn take_next(&mut self, contact: usize, first: ContactState) -> bool {
        if self.is_held(contact) {
            self.pulls[contact] = !self.pulls[contact];
            if self.pulls[contact] {
                return true;
            }
        }
        let possible = self.possible(contact);
        let now = possible.iter().position(|state| *state == self.states[contact]);
        self.states[contact] = possible[now.map_or(0, |now| (now + 1) % possible.len())];
        self.states[contact] != first
    }

    /// The possible states of a contact.
    pub(super) fn possible(&self, contact: usize) -> &'static [ContactState] {
        use ContactState::{Detached, ReverseSlide, Slide, Stick};
        match self.constraints[contact] {
            ContactConstraint::Law(_) => &[Stick, Slide, ReverseSlide, Detached],
            ContactConstraint::Slipping { direction, .. } if direction > 0.0 => &[Slide, Detached],
            ContactConstraint::Slipping { .. } => &[ReverseSlide, Detached],
            ContactConstraint::Held(_) => &[Stick, Slide, ReverseSlide],
            ContactConstraint::HeldSlipping { direction, .. } if direction > 0.0 => &[Slide],
            ContactConstraint::HeldSlipping { .. } => &[ReverseSlide],
            _ => &[Detached],
        }
    }

    /// Solves for forces in the present states, whose equations do not determine them; `true` if forces were found that
    /// obey the law.
    pub(super) fn program(&mut self, group: usize, strictness: Strictness) -> bool {
        self.write_program(group, usize::MAX);
        if self.enumeration.run() != FirstPhase::Solved {
            return false;
        }
        self.clear(group);
        let LinearProgram { unknowns, table, basis, .. } = &self.enumeration;
        let width = unknowns.len() + 1;
        for (row, &unknown) in table.chunks_exact(width).zip(basis) {
            let value = row[width - 1];
            match unknowns.get(unknown) {
                Some(&Unknown::Normal { contact, sign, slope }) => {
                    let scale = self.delassus.scales(contact)[0];
                    self.forces[contact][0] += sign * scale * value;
                    self.forces[contact][1] += slope * scale * value;
                }
                Some(&Unknown::Tangential { contact }) => {
                    self.forces[contact][1] += self.delassus.scales(contact)[1] * value;
                }
                Some(Unknown::Rest { .. }) | None => {}
            }
        }
        self.are_lawful(group, strictness)
    }

    /// `true` if it is proven that a group has no forces under its law where the first `chosen` contacts are in their
    /// present states, whatever the states of the others are.
    fn is_impossible(&mut self, group: usize, chosen: usize) -> bool {
        self.write_program(group, chosen);
        matches!(self.enumeration.run(), FirstPhase::Impossible(by) if by >= INFEASIBLE)
    }

    /// Writes the conditions of the present states of the first `chosen` contacts, and the necessary conditions of the
    /// law of the others.
    fn write_program(&mut self, group: usize, chosen: usize) {
        let Self { enumeration, delassus, constraints, states, pulls, .. } = self;
        enumeration.unknowns.clear();
        enumeration.rows.clear();
        for (place, &contact) in delassus.groups()[group].iter().enumerate() {
            if place >= chosen {
                enumeration.ask_least(contact, &constraints[contact]);
                continue;
            }
            let LinearProgram { unknowns, rows, .. } = &mut *enumeration;
            let state = states[contact];
            let sign = constraints[contact].sign(pulls[contact]);
            match (&constraints[contact], state) {
                (ContactConstraint::Open, _) => {}
                (_, ContactState::Detached) => {
                    unknowns.push(Unknown::Rest { row: rows.len() });
                    rows.push(Equation::Normal { contact });
                }
                (
                    ContactConstraint::Law(range) | ContactConstraint::Held(range),
                    ContactState::Stick,
                ) => {
                    unknowns.push(Unknown::Normal { contact, sign, slope: -range.backward });
                    unknowns.push(Unknown::Tangential { contact });
                    rows.push(Equation::Normal { contact });
                    rows.push(Equation::Tangential { contact, direction: 1.0 });
                    unknowns.push(Unknown::Rest { row: rows.len() });
                    rows.push(Equation::Cone { contact, width: range.forward + range.backward });
                }
                (constraint, _) => {
                    let direction = state.sliding_direction().unwrap_or(1.0);
                    let (friction, may_turn) = match constraint {
                        ContactConstraint::Law(range) | ContactConstraint::Held(range) => {
                            (range.limit(direction), true)
                        }
                        &(ContactConstraint::Slipping { friction, .. }
                        | ContactConstraint::HeldSlipping { friction, .. }) => (friction, false),
                        _ => (0.0, false),
                    };
                    unknowns.push(Unknown::Normal { contact, sign, slope: direction * friction });
                    rows.push(Equation::Normal { contact });
                    if may_turn {
                        unknowns.push(Unknown::Rest { row: rows.len() });
                        rows.push(Equation::Tangential { contact, direction: -direction });
                    }
                }
            }
        }
        self.write_table();
    }

    /// Writes the table of the present unknowns and rows.
    fn write_table(&mut self) {
        let Self { enumeration, delassus, free, .. } = self;
        let LinearProgram { unknowns, rows, table, .. } = enumeration;
        let scales = |contact: usize| delassus.scales(contact);
        table.clear();
        for (place, row) in rows.iter().enumerate() {
            for unknown in &*unknowns {
                let (other, [n, t]) = match *unknown {
                    Unknown::Rest { row } => {
                        table.push(if row == place { -1.0 } else { 0.0 });
                        continue;
                    }
                    Unknown::Normal { contact, sign, slope } => {
                        let scale = scales(contact)[0];
                        (contact, [sign * scale, slope * scale])
                    }
                    Unknown::Tangential { contact } => (contact, [0.0, scales(contact)[1]]),
                };
                table.push(match *row {
                    Equation::Normal { contact } => {
                        let w = delassus.block(contact, other);
                        scales(contact)[0] * (w[0] * n + w[1] * t)
                    }
                    Equation::Tangential { contact, direction } => {
                        let w = delassus.block(contact, other);
                        direction * scales(contact)[1] * (w[2] * n + w[3] * t)
                    }
                    // The width is in the units of T.
                    Equation::Cone { contact, width } if contact == other => match unknown {
                        Unknown::Normal { .. } => width * n.abs() / scales(contact)[1],
                        _ => -t / scales(contact)[1],
                    },
                    Equation::Cone { .. } => 0.0,
                });
            }
            table.push(match *row {
                Equation::Normal { contact } => -scales(contact)[0] * free[contact][0],
                Equation::Tangential { contact, direction } => {
                    -direction * scales(contact)[1] * free[contact][1]
                }
                Equation::Cone { .. } => 0.0,
            });
        }
    }
}
