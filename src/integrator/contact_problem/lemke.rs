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
//! symmetric W ≥ 0 (xᵀ M x = λᵀ W λ + γᵀ N).

use super::{ContactConstraint, ContactProblem, Strictness};
use crate::contact::ContactState;
use crate::numerics::Lemke;

/// The limits of friction are first those of the law, then wider by this part of the largest force: at the limits of the
/// law many rows are tied, and rounding may choose a row between them that leads to a ray.
const WIDER: [f64; 2] = [0.0, 1e-10];

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

/// The complementarity problem of a group of contacts.
pub(super) struct Pivots {
    parts: Vec<(usize, LemkeVariable)>,
    tableau: Lemke,
}

impl Pivots {
    /// Allocates memory for groups of up to `contacts` contacts.
    pub(super) fn with_room(contacts: usize) -> Self {
        let places = if contacts > 1 { 4 * contacts } else { 0 };
        Self { parts: Vec::with_capacity(places), tableau: Lemke::with_room(places) }
    }

    /// The value of an unknown; `None` where it is not basic, and so zero.
    fn value(&self, contact: usize, part: LemkeVariable) -> Option<f64> {
        let place = self.parts.iter().position(|known| *known == (contact, part))?;
        self.tableau.value(place)
    }
}

impl ContactProblem {
    /// Solves for the forces of a group by pivots; `true` if forces were found that obey the law.
    pub(super) fn pivot(&mut self, group: usize, strictness: Strictness) -> bool {
        WIDER.into_iter().any(|wider| {
            if !self.tabulate(group, wider) || !self.lemke.tableau.run() {
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
        let Pivots { parts, tableau } = lemke;
        let size = parts.len();
        let entries = tableau.begin(size);
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
            let (contact, part) = parts[row];
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
            entries.push(constant);
            for &(other, kind) in &*parts {
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
                entries.push(entry);
            }
            entries.push(1.0);
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
