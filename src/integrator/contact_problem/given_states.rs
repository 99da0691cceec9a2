//! The contact problem of given contact states: linear equations for each group of contacts that share masses.

use super::delassus::Delassus;
use super::factors::Factors;
use crate::contact::{ContactState, FrictionRange, LocalProblem};

/// The equations that hold for a contact in a given state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) enum StateEquations {
    /// No equation: the contact is open and carries no force.
    Nothing,
    /// The normal force N, with T = `slope` N, makes a_N = 0.
    Normal {
        /// ±µ of a contact that slides.
        slope: f64,
    },
    /// The forces N and T make a_N = a_T = 0.
    Both,
}

impl StateEquations {
    /// The equations of a contact with this block of W, in this state, with T/N in `range`.
    pub(in crate::integrator) fn of(
        state: ContactState,
        range: &FrictionRange,
        own: LocalProblem,
    ) -> Self {
        match (state, state.sliding_direction()) {
            (ContactState::Detached, _) => Self::Nothing,
            (_, Some(direction)) => Self::Normal { slope: direction * range.limit(direction) },
            // If the mass has one direction of motion, the force that holds one row holds both.
            _ if own.is_singular() => Self::Normal { slope: own.stuck_slope(range) },
            _ => Self::Both,
        }
    }
}

/// An unknown multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
struct UnknownMultiplier {
    contact: usize,
    /// 0 for the normal force, with the friction force that follows it; 1 for an independent friction force.
    row: usize,
    /// T/N of a contact without an independent friction force.
    slope: f64,
}

/// λ of given contact states as a linear function of the accelerations without contact forces.
pub(in crate::integrator) struct GivenStates {
    /// The equations of each contact from which those of its group were last made.
    equations: Vec<StateEquations>,
    groups: Vec<EquationGroup>,
}

/// The equations of a group.
struct EquationGroup {
    contacts: Vec<usize>,
    is_set: bool,
    unknowns: Vec<UnknownMultiplier>,
    factors: Factors,
    /// Memory for the right-hand side.
    right: Vec<f64>,
}

impl EquationGroup {
    /// Takes the equations of the same group elsewhere.
    fn take(&mut self, other: &Self) {
        self.is_set = true;
        self.unknowns.clone_from(&other.unknowns);
        self.factors.copy_from(&other.factors);
    }
}

impl GivenStates {
    pub(in crate::integrator) fn new(delassus: &Delassus) -> Self {
        let group = |contacts: &Vec<usize>| {
            let most = 2 * contacts.len();
            EquationGroup {
                contacts: contacts.clone(),
                is_set: false,
                unknowns: Vec::with_capacity(most),
                factors: Factors::with_room(most),
                right: vec![0.0; most],
            }
        };
        Self {
            equations: vec![StateEquations::Nothing; delassus.contacts()],
            groups: delassus.groups().iter().map(group).collect(),
        }
    }

    /// Number of groups.
    pub(in crate::integrator) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Sets the equations of each contact of a group. Where two contacts hold one mass and one of them would suffice, one
    /// carries nothing: the motion is the same for either choice.
    pub(in crate::integrator) fn set(
        &mut self,
        delassus: &Delassus,
        group: usize,
        equations: impl Fn(usize) -> StateEquations,
    ) {
        let EquationGroup { contacts, is_set, unknowns, factors, .. } = &mut self.groups[group];
        let mut is_known = *is_set;
        for &contact in &*contacts {
            let wanted = equations(contact);
            is_known &= self.equations[contact] == wanted;
            self.equations[contact] = wanted;
        }
        if is_known {
            return;
        }
        *is_set = true;
        unknowns.clear();
        for &contact in &*contacts {
            match self.equations[contact] {
                StateEquations::Nothing => {}
                StateEquations::Normal { slope } => {
                    unknowns.push(UnknownMultiplier { contact, row: 0, slope });
                }
                StateEquations::Both => {
                    unknowns.extend([0, 1].map(|row| UnknownMultiplier {
                        contact,
                        row,
                        slope: 0.0,
                    }));
                }
            }
        }
        let size = |unknown: &UnknownMultiplier| delassus.own(unknown.contact)[3 * unknown.row];
        factors.set(
            unknowns.len(),
            |row, column| {
                let (row, column) = (&unknowns[row], &unknowns[column]);
                let block = delassus.block(row.contact, column.contact);
                let at = |part: usize| block[2 * row.row + part];
                at(column.row) + column.slope * at(1)
            },
            |place| size(&unknowns[place]),
        );
    }

    /// Sets the equations of all contacts, as [`set`](Self::set) does for one group. Where `known` has the equations of a group
    /// already, its factors are copied.
    pub(in crate::integrator) fn set_all(
        &mut self,
        delassus: &Delassus,
        equations: impl Fn(usize) -> StateEquations,
        known: &Self,
    ) {
        for group in 0..self.groups() {
            let (here, there) = (&mut self.groups[group], &known.groups[group]);
            let mut contacts = here.contacts.iter();
            if there.is_set && contacts.all(|&i| known.equations[i] == equations(i)) {
                let mut contacts = here.contacts.iter();
                if !(here.is_set && contacts.all(|&i| self.equations[i] == known.equations[i])) {
                    here.take(there);
                    here.contacts.iter().for_each(|&i| self.equations[i] = known.equations[i]);
                }
            } else {
                self.set(delassus, group, &equations);
            }
        }
    }

    /// `true` if a group has as many independent equations as unknowns.
    pub(in crate::integrator) fn is_regular(&self, group: usize) -> bool {
        self.groups[group].factors.is_regular()
    }

    /// The sign of the determinant of a group's equations: 1, −1, or 0 where they are not independent.
    pub(super) fn orientation(&self, group: usize) -> f64 {
        self.groups[group].factors.orientation()
    }

    /// T/N of a contact without an independent friction force; zero for any other.
    pub(in crate::integrator) fn slope(&self, contact: usize) -> f64 {
        match self.equations[contact] {
            StateEquations::Normal { slope } => slope,
            StateEquations::Nothing | StateEquations::Both => 0.0,
        }
    }

    /// λ (N, T) of all contacts, as [`forces`](Self::forces) gives it for one group.
    pub(in crate::integrator) fn all_forces(
        &mut self,
        free: impl Fn(usize, usize) -> f64,
        forces: &mut [[f64; 2]],
    ) {
        (0..self.groups()).for_each(|group| self.forces(group, &free, forces));
    }

    /// λ (N, T) of each contact of a group, where `free` holds the accelerations without contact forces along
    /// normal (0) and tangent (1); those that the contacts must have are zero.
    #[inline]
    pub(in crate::integrator) fn forces(
        &mut self,
        group: usize,
        free: impl Fn(usize, usize) -> f64,
        forces: &mut [[f64; 2]],
    ) {
        let EquationGroup { contacts, unknowns, factors, right, .. } = &mut self.groups[group];
        for &contact in &*contacts {
            forces[contact] = [0.0; 2];
        }
        let right = &mut right[..unknowns.len()];
        for (right, unknown) in right.iter_mut().zip(&*unknowns) {
            *right = free(unknown.contact, unknown.row);
        }
        factors.solve(right);
        for (value, unknown) in right.iter().zip(&*unknowns) {
            forces[unknown.contact][unknown.row] = 0.0 - value;
            if unknown.slope != 0.0 {
                forces[unknown.contact][1] = unknown.slope * (0.0 - value);
            }
        }
    }
}
