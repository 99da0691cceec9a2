//! Lemke's algorithm for the contact problem as a linear complementarity problem.
//!
//! With T = T⁺ − T⁻ and γ the size of the sliding acceleration, Coulomb friction in the plane is (Stewart and Trinkle,
//! Int. J. Numer. Methods Eng. 39, 1996, with two limits of friction f and b)
//!
//! * 0 ≤ N ⊥ a_N ≥ 0,
//! * 0 ≤ T⁺ ⊥ a_T + γ/f ≥ 0,
//! * 0 ≤ T⁻ ⊥ −a_T + γ/b ≥ 0,
//! * 0 ≤ γ ⊥ N − T⁺/f − T⁻/b ≥ 0.
//!
//! A contact that must slip has N alone, with T = ±µN. The matrix of all other contacts is copositive for any
//! symmetric W ≥ 0 (xᵀ M x = λᵀ W λ + γᵀ N). Pivots are chosen in lexicographic order, so they end: in a solution, or in
//! a ray, which proves nothing.

use super::{ContactConstraint, ContactProblem, Strictness};
use crate::contact::ContactState;

/// Ratios within this part of the least are tied.
const TIE: f64 = 1e-12;
/// An entry below this part of the largest in its column is rounding.
const NOTHING: f64 = 1e-13;
/// The limits of friction are first those of the law, then wider by this part of the largest force: at the limits of the
/// law many rows are tied, and rounding may choose a row between them that leads to a ray.
const WIDER: [f64; 2] = [0.0, 1e-10];
/// Largest number of pivots for each variable; one or two are usual.
const MOST_PIVOTS: usize = 50;

/// An unknown z of a contact, and the condition w that it complements.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LemkeVariable {
    /// N and a_N.
    Normal,
    /// T⁺ and a_T + γ/f.
    Forward,
    /// T⁻ and −a_T + γ/b.
    Backward,
    /// γ and N − T⁺/f − T⁻/b.
    Sliding,
}

/// The variable of a row or a column of the tableau.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Name {
    /// The condition w of this place.
    W(usize),
    /// The unknown z of this place.
    Z(usize),
    /// The artificial unknown that lets all conditions hold at the start.
    Cover,
}

/// The tableau: each row expresses its basic variable as a constant plus multiples of the others.
pub(super) struct Lemke {
    parts: Vec<(usize, LemkeVariable)>,
    rows: Vec<Name>,
    columns: Vec<Name>,
    /// The entries by rows; the constant comes first.
    entries: Vec<f64>,
    pivot_row: Vec<f64>,
}

impl Lemke {
    /// Allocates memory for groups of up to `contacts` contacts.
    pub(super) fn with_room(contacts: usize) -> Self {
        let places = if contacts > 1 { 4 * contacts } else { 0 };
        Self {
            parts: Vec::with_capacity(places),
            rows: Vec::with_capacity(places),
            columns: Vec::with_capacity(places + 2),
            entries: Vec::with_capacity(places * (places + 2)),
            pivot_row: Vec::with_capacity(places + 2),
        }
    }

    /// Number of unknowns.
    fn size(&self) -> usize {
        self.parts.len()
    }

    /// Pivots until the artificial unknown has left the basis; `false` where a ray comes first.
    fn run(&mut self) -> bool {
        let width = self.size() + 2;
        let constant = |entries: &[f64], row: usize| entries[row * width];
        let least = (0..self.size())
            .min_by(|&a, &b| constant(&self.entries, a).total_cmp(&constant(&self.entries, b)));
        let Some(least) = least else { return true };
        if constant(&self.entries, least) >= 0.0 {
            return true;
        }
        // In the order of the perturbation εᵏ the last of equal rows is the lowest.
        let lowest = constant(&self.entries, least);
        let row = (0..self.size()).rev().find(|&row| constant(&self.entries, row) <= lowest);
        let mut leaving = self.pivot(row.unwrap_or(least), width - 1);
        for _ in 0..MOST_PIVOTS * width {
            let entering = match leaving {
                Name::Cover => return true,
                Name::W(place) => Name::Z(place),
                Name::Z(place) => Name::W(place),
            };
            let Some(column) = self.columns.iter().position(|name| *name == entering) else {
                return false;
            };
            let Some(row) = self.leaving_row(column + 1) else { return false };
            leaving = self.pivot(row, column + 1);
        }
        false
    }

    /// The row whose variable falls to zero first when the variable of this column grows; among ties the artificial
    /// unknown, else the lexicographic least.
    fn leaving_row(&self, column: usize) -> Option<usize> {
        let width = self.size() + 2;
        let entry = |row: usize, column: usize| self.entries[row * width + column];
        let largest =
            (0..self.size()).fold(0.0, |most, row| f64::max(most, entry(row, column).abs()));
        let falls = |row: &usize| entry(*row, column) < -NOTHING * largest;
        let ratio = |row: usize| entry(row, 0).max(0.0) / -entry(row, column);
        let least = (0..self.size()).filter(falls).map(ratio).fold(f64::INFINITY, f64::min);
        let is_least = |row: &usize| falls(row) && ratio(*row) <= least * (1.0 + TIE);
        let tied = || (0..self.size()).filter(is_least);
        if let Some(cover) = tied().find(|&row| self.rows[row] == Name::Cover) {
            return Some(cover);
        }
        tied().reduce(|a, b| if self.is_before(b, a, column) { b } else { a })
    }

    /// `true` if row `a` precedes row `b` in the order of the perturbation εᵏ of each constant.
    fn is_before(&self, a: usize, b: usize, column: usize) -> bool {
        let width = self.size() + 2;
        let factor = |row: usize, place: usize| {
            let by = -self.entries[row * width + column];
            let coefficient = match self.columns.iter().position(|name| *name == Name::W(place)) {
                Some(column) => -self.entries[row * width + column + 1],
                None if self.rows[row] == Name::W(place) => 1.0,
                None => 0.0,
            };
            coefficient / by
        };
        let differs = (0..self.size()).map(|place| (factor(a, place), factor(b, place)));
        differs.into_iter().find(|(a, b)| a != b).is_some_and(|(a, b)| a < b)
    }

    /// Exchanges the variables of a row and a column (0 is the constant's); returns the one that leaves the rows.
    fn pivot(&mut self, row: usize, column: usize) -> Name {
        let width = self.size() + 2;
        let Self { entries, pivot_row, .. } = self;
        let own = &mut entries[row * width..][..width];
        let pivot = own[column];
        // From basic = … + pivot · entering to entering = (basic − …) / pivot.
        for entry in own.iter_mut() {
            *entry /= -pivot;
        }
        own[column] = 1.0 / pivot;
        pivot_row.clear();
        pivot_row.extend_from_slice(own);
        for (other, entries) in entries.chunks_exact_mut(width).enumerate() {
            let factor = entries[column];
            if other == row || factor == 0.0 {
                continue;
            }
            entries[column] = 0.0;
            for (entry, own) in entries.iter_mut().zip(&*pivot_row) {
                *entry += factor * own;
            }
        }
        std::mem::swap(&mut self.rows[row], &mut self.columns[column - 1]);
        self.columns[column - 1]
    }

    /// The value of an unknown; `None` where it is not basic, and so zero.
    fn value(&self, contact: usize, part: LemkeVariable) -> Option<f64> {
        let width = self.size() + 2;
        let place = self.parts.iter().position(|known| *known == (contact, part))?;
        let row = self.rows.iter().position(|name| *name == Name::Z(place))?;
        Some(self.entries[row * width])
    }
}

impl ContactProblem {
    /// Solves for the forces of a group by pivots; `true` if forces were found that obey the law.
    pub(super) fn pivot(&mut self, group: usize, strictness: Strictness) -> bool {
        WIDER.into_iter().any(|wider| {
            if !self.tabulate(group, wider) || !self.lemke.run() {
                return false;
            }
            for place in 0..self.delassus.groups()[group].len() {
                let contact = self.delassus.groups()[group][place];
                self.states[contact] = self.pivoted_state(contact);
            }
            self.solve_states(group, strictness) || self.correct_states(group, strictness)
        })
    }

    /// Writes the tableau of a group, in units in which the own blocks of W are near to 1, with limits of friction that
    /// are wider by a part of the largest free acceleration; `false` where a contact's law is not a complementarity
    /// condition.
    fn tabulate(&mut self, group: usize, wider: f64) -> bool {
        let Self { lemke, delassus, constraints, free, .. } = self;
        let largest = delassus.groups()[group].iter().fold(0.0, |largest, &contact| {
            let ([normal, tangential], [n, t]) = (delassus.scales(contact), free[contact]);
            f64::max(largest, (n * normal).abs().max((t * tangential).abs()))
        });
        lemke.parts.clear();
        for &contact in &delassus.groups()[group] {
            match &constraints[contact] {
                ContactConstraint::Open => {}
                ContactConstraint::Slipping { .. } => {
                    lemke.parts.push((contact, LemkeVariable::Normal));
                }
                ContactConstraint::Law(range) => {
                    lemke.parts.push((contact, LemkeVariable::Normal));
                    let limits = [
                        (LemkeVariable::Forward, range.forward),
                        (LemkeVariable::Backward, range.backward),
                    ];
                    let mut has_friction = false;
                    for (part, limit) in limits {
                        if limit > 0.0 {
                            lemke.parts.push((contact, part));
                            has_friction = true;
                        }
                    }
                    if has_friction {
                        lemke.parts.push((contact, LemkeVariable::Sliding));
                    }
                }
                ContactConstraint::Held(_)
                | ContactConstraint::HeldSlipping { .. }
                | ContactConstraint::Fixed
                | ContactConstraint::Guided { .. } => return false,
            }
        }
        let size = lemke.parts.len();
        lemke.rows.clear();
        lemke.rows.extend((0..size).map(Name::W));
        lemke.columns.clear();
        lemke.columns.extend((0..size).map(Name::Z));
        lemke.columns.push(Name::Cover);
        lemke.entries.clear();
        let scales = |contact: usize| delassus.scales(contact);
        // 1/f or 1/b, in these units.
        let inverse_limit =
            |contact: usize, part: LemkeVariable| match (&constraints[contact], part) {
                (
                    ContactConstraint::Law(range),
                    LemkeVariable::Forward | LemkeVariable::Backward,
                ) => {
                    let [normal, tangential] = scales(contact);
                    let limit =
                        if part == LemkeVariable::Forward { range.forward } else { range.backward };
                    tangential / (normal * limit)
                }
                _ => 0.0,
            };
        // The force (N, T) of a unit of an unknown; the same factors weigh accelerations.
        let unit = |(contact, part): (usize, LemkeVariable)| -> [f64; 2] {
            let [normal, tangential] = scales(contact);
            match (part, &constraints[contact]) {
                (LemkeVariable::Normal, &ContactConstraint::Slipping { direction, friction }) => {
                    [normal, direction * friction * normal]
                }
                (LemkeVariable::Normal, _) => [normal, 0.0],
                (LemkeVariable::Forward, _) => [0.0, tangential],
                (LemkeVariable::Backward, _) => [0.0, -tangential],
                (LemkeVariable::Sliding, _) => [0.0; 2],
            }
        };
        for row in 0..size {
            let (contact, part) = lemke.parts[row];
            let weights = match part {
                LemkeVariable::Normal => [scales(contact)[0], 0.0],
                _ => unit((contact, part)),
            };
            #[allow(clippy::cast_precision_loss)]
            let constant = match part {
                // No two rows are equal.
                LemkeVariable::Sliding => wider * largest * (1.0 + row as f64 / size as f64),
                _ => weights[0] * free[contact][0] + weights[1] * free[contact][1],
            };
            lemke.entries.push(constant);
            for column in 0..size {
                let (other, kind) = lemke.parts[column];
                let w = delassus.block(contact, other);
                let by = unit((other, kind));
                let mut entry = weights[0] * (w[0] * by[0] + w[1] * by[1])
                    + weights[1] * (w[2] * by[0] + w[3] * by[1]);
                if contact == other {
                    entry += match (part, kind) {
                        (
                            LemkeVariable::Forward | LemkeVariable::Backward,
                            LemkeVariable::Sliding,
                        ) => inverse_limit(contact, part),
                        (LemkeVariable::Sliding, LemkeVariable::Normal) => 1.0,
                        (
                            LemkeVariable::Sliding,
                            LemkeVariable::Forward | LemkeVariable::Backward,
                        ) => -inverse_limit(contact, kind),
                        _ => 0.0,
                    };
                }
                lemke.entries.push(entry);
            }
            lemke.entries.push(1.0);
        }
        true
    }

    /// The state of a contact after the last pivots.
    fn pivoted_state(&self, contact: usize) -> ContactState {
        let ContactConstraint::Law(range) = &self.constraints[contact] else {
            let presses = self.lemke.value(contact, LemkeVariable::Normal).is_some();
            return if presses { ContactState::Slide } else { ContactState::Detached };
        };
        if self.lemke.value(contact, LemkeVariable::Normal).is_none() {
            return ContactState::Detached;
        }
        let slides = self.lemke.value(contact, LemkeVariable::Sliding).is_some();
        let [forward, backward] = [LemkeVariable::Forward, LemkeVariable::Backward]
            .map(|part| self.lemke.value(contact, part).is_some_and(|value| value > 0.0));
        match (slides, forward, backward) {
            (true, true, _) => ContactState::Slide,
            (true, _, true) => ContactState::ReverseSlide,
            _ if range.forward > 0.0 && range.backward > 0.0 => ContactState::Stick,
            // Without friction in a direction either state is right for a contact at rest.
            _ if range.backward > 0.0 => ContactState::Slide,
            _ => ContactState::ReverseSlide,
        }
    }
}
