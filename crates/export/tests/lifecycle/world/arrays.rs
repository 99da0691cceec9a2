//! The arrays of a call.

use super::{HUGE, Kind};
use crate::draw::Dice;
use crate::standard::Fit;
use std::ptr;

/// The arrays of a call: the references, and values for each twin with room for one more that stays as it is.
pub(super) struct Arrays<T> {
    pub(super) references: Vec<u32>,
    pub(super) values: [Vec<T>; 2],
    pub(super) count: usize,
    /// Bytes to add to the pointers, or none for NULL.
    pub(super) offsets: [Option<usize>; 2],
}

impl<T: Copy> Arrays<T> {
    pub(super) fn new(
        kind: Kind,
        references: Vec<u32>,
        values: &[T],
        fill: T,
        dice: &mut Dice,
    ) -> Self {
        let mut all = values.to_vec();
        all.resize(references.len() + 1, fill);
        let count = match kind {
            Kind::Empty => 0,
            Kind::Huge => dice.pick(HUGE),
            _ => references.len(),
        };
        let offsets = match kind {
            Kind::Empty | Kind::Huge => [(); 2].map(|()| (!dice.one_in(2)).then_some(0)),
            Kind::NullArray => dice.pick(&[[None, Some(0)], [Some(0), None], [None, None]]),
            Kind::Misaligned => dice.pick(&[[Some(1), Some(0)], [Some(0), Some(1)]]),
            _ => [Some(0), Some(0)],
        };
        Self { references, values: [all.clone(), all], count, offsets }
    }

    pub(super) fn references(&self) -> *const u32 {
        let pointer = self.references.as_ptr();
        self.offsets[0].map_or(ptr::null(), |offset| pointer.wrapping_byte_add(offset))
    }

    pub(super) fn values(&mut self, twin: usize) -> *mut T {
        let pointer = self.values[twin].as_mut_ptr();
        self.offsets[1].map_or(ptr::null_mut(), |offset| pointer.wrapping_byte_add(offset))
    }
}

/// Validity of arrays of this kind.
pub(super) fn fit_of(kind: Kind) -> Fit {
    match kind {
        Kind::Good | Kind::Empty | Kind::NullInstance => Fit::Good,
        _ => Fit::Bad,
    }
}

impl<T: Copy> Arrays<T> {
    /// The values of both twins, and what lies behind them.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [T; 2]> {
        let [a, b] = &self.values;
        a.iter().zip(b).map(|(&a, &b)| [a, b])
    }
}

impl Arrays<f64> {
    /// Values that were read are finite and equal for both twins; memory outside the array is unchanged.
    pub(super) fn check_read(&self, is_read: bool, canary: f64) -> Result<(), String> {
        for (i, [a, b]) in self.pairs().enumerate() {
            if a.to_bits() != b.to_bits() {
                return Err(format!("twins read {a} and {b}"));
            }
            let is_asked = i < self.count.min(self.references.len());
            if is_read && is_asked && (!a.is_finite() || a == canary) {
                return Err(format!("{a} is read"));
            }
            if !is_asked && a != canary {
                return Err("what is none of the array was written to".to_owned());
            }
        }
        Ok(())
    }
}
