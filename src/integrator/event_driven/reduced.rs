//! The equation of motion of small structures as one full matrix for each contact state met.

use super::law::{Actions, StateLaw};
use crate::contact::{ContactState, Friction};
use crate::integrator::dynamics::Dynamics;

/// The most places of a row (degrees of freedom, and multipliers that need places of their own) for
/// which matrices are kept. Up to here making one costs no more than a series.
pub(super) const MOST_PLACES: usize = 16;
/// The most contact states whose matrices are kept, a power of 4. With [`MOST_PLACES`] they take up to
/// 300 kB.
pub(super) const MOST_STATES: usize = 64;

/// The map of [`StateLaw::apply`] to a row as full matrices: the contributions of effective displacements, of
/// velocities and of the inputs.
pub(super) struct Reduced {
    /// Key of the contact states that the matrices belong to; `None` before the first.
    key: Option<usize>,
    /// The degrees of freedom in the order of the columns: those that no contact holds come first.
    columns: Vec<usize>,
    free: usize,
    /// Columns of `places` values, by pairs: for x + β ẋ, and for ẋ (dampers and α).
    springs: Vec<Pair>,
    dampers: Vec<Pair>,
    /// The row for the forces in `outer` and the slider accelerations in `slider`.
    load: Vec<f64>,
    outer: Vec<f64>,
    slider: Vec<f64>,
}

/// Two values for one instruction of a processor.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Pair([f64; 2]);

/// The matrices of the contact states met last. Memory for all is allocated at construction. A matrix depends on
/// nothing but its state, µ and the damping, so results do not depend on which matrices were kept.
pub(super) struct ReducedLaws {
    slots: Vec<Reduced>,
    /// Friction of each contact for which all matrices were made.
    friction: Vec<Friction>,
    /// Number of places of a row, rounded up.
    places: usize,
    zeros: Vec<f64>,
    unit: Vec<f64>,
    row: Vec<f64>,
}

impl ReducedLaws {
    /// Allocates memory for the matrices of up to `slots` states, for rows with this many places.
    pub(super) fn new(dynamics: &Dynamics, places: usize, slots: usize) -> Self {
        let (dofs, contacts) = (dynamics.acceleration.len(), dynamics.contacts.len());
        let slot = || Reduced {
            key: None,
            columns: Vec::with_capacity(dofs),
            free: 0,
            springs: vec![Pair([0.0; 2]); dofs * places / 2],
            dampers: vec![Pair([0.0; 2]); dofs * places / 2],
            load: vec![0.0; places],
            outer: vec![f64::NAN; dofs],
            slider: vec![f64::NAN; contacts],
        };
        Self {
            slots: (0..slots).map(|_| slot()).collect(),
            friction: vec![f64::NAN.into(); contacts],
            places,
            zeros: vec![0.0; dofs.max(contacts)],
            unit: vec![0.0; dofs],
            row: vec![0.0; places],
        }
    }

    /// Forgets all matrices.
    pub(super) fn clear(&mut self) {
        for slot in &mut self.slots {
            slot.key = None;
        }
    }

    /// The matrices of these states under this friction, with the row for these outer forces (N) and
    /// slider accelerations (m/s²).
    pub(super) fn of(
        &mut self,
        dynamics: &Dynamics,
        law: &mut StateLaw,
        states: &[ContactState],
        friction: &[Friction],
        (outer, slider): (&[f64], &[f64]),
    ) -> &Reduced {
        if self.friction != friction {
            self.clear();
            self.friction.copy_from_slice(friction);
        }
        let key = states.iter().rev().fold(0, |key, &state| 4 * key + state as usize % 4);
        // Up to three contacts have a slot for each state; of more, states that differ in one contact alone have slots
        // of their own.
        let folded = key ^ (key / MOST_STATES) ^ (key / (MOST_STATES * MOST_STATES));
        let Self { slots, places, zeros, unit, row, .. } = self;
        let count = slots.len();
        let slot = &mut slots[folded % count];
        let (dofs, contacts) = (unit.len(), states.len());
        let nothing = Actions {
            stretch: &zeros[..dofs],
            velocity: &zeros[..dofs],
            outer: &zeros[..dofs],
            slider: &zeros[..contacts],
        };
        if slot.key != Some(key) {
            law.set(dynamics, states, friction);
            slot.set_columns(dynamics, states);
            for (column, &dof) in slot.columns.iter().enumerate() {
                let pairs = *places / 2;
                let range = column * pairs..(column + 1) * pairs;
                unit[dof] = 1.0;
                law.apply(dynamics, Actions { stretch: unit, ..nothing }, row);
                write(row, &mut slot.springs[range.clone()]);
                law.apply(dynamics, Actions { velocity: unit, ..nothing }, row);
                write(row, &mut slot.dampers[range]);
                unit[dof] = 0.0;
            }
            slot.outer.fill(f64::NAN);
            slot.key = Some(key);
        }
        if slot.outer != outer || slot.slider != slider {
            law.set(dynamics, states, friction);
            slot.outer.copy_from_slice(outer);
            slot.slider.copy_from_slice(slider);
            let acting = Actions { outer, slider: &slot.slider, ..nothing };
            law.apply(dynamics, acting, &mut slot.load);
        }
        slot
    }
}

impl Reduced {
    fn set_columns(&mut self, dynamics: &Dynamics, states: &[ContactState]) {
        let dofs = self.outer.len();
        let mut is_held = [false; MOST_PLACES];
        super::law::held_dofs(dynamics, states, |dof, _| is_held[dof] = true);
        self.columns.clear();
        for held in [false, true] {
            self.columns.extend((0..dofs).filter(|dof| is_held[*dof] == held));
        }
        self.free = is_held[..dofs].iter().filter(|held| !**held).count();
    }

    /// The row of the inputs at the beginning of a series.
    pub(super) fn load<const N: usize>(&self) -> [f64; N] {
        std::array::from_fn(|place| self.load[place])
    }

    /// Returns `sum` plus the contributions of effective displacements (m): `all`, or those of the free degrees of
    /// freedom. N rows are P pairs.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn add_springs<const N: usize, const P: usize>(
        &self,
        stretch: &[f64; N],
        all: bool,
        sum: [f64; N],
    ) -> [f64; N] {
        self.add::<N, P>(&self.springs, stretch, all, sum)
    }

    /// Returns `sum` plus the contributions of velocities (m/s) by dampers and α: `all`, or those of the free degrees
    /// of freedom. N rows are P pairs.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn add_dampers<const N: usize, const P: usize>(
        &self,
        velocity: &[f64; N],
        all: bool,
        sum: [f64; N],
    ) -> [f64; N] {
        self.add::<N, P>(&self.dampers, velocity, all, sum)
    }

    // The loops of a series are several times as fast where its sums stay in registers.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn add<const N: usize, const P: usize>(
        &self,
        matrix: &[Pair],
        by: &[f64; N],
        all: bool,
        mut sum: [f64; N],
    ) -> [f64; N] {
        let count = if all { self.columns.len() } else { self.free };
        let columns = matrix.as_chunks::<P>().0;
        for (&dof, column) in self.columns[..count].iter().zip(columns) {
            let by = by[dof];
            for (sum, pair) in sum.as_chunks_mut::<2>().0.iter_mut().zip(column) {
                sum[0] += pair.0[0] * by;
                sum[1] += pair.0[1] * by;
            }
        }
        sum
    }
}

fn write(row: &[f64], pairs: &mut [Pair]) {
    for (pair, values) in pairs.iter_mut().zip(row.as_chunks().0) {
        pair.0 = *values;
    }
}
