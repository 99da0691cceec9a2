//! Lanes in the processor's vectors.

use crate::contact::{ContactState, Lanes};
use pulp::Simd;
use pulp::bytemuck::{bytes_of, cast_slice, cast_slice_mut};
use std::borrow::{Borrow, BorrowMut};
use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};
use std::slice::{from_mut, from_ref};

/// A vector of the processor's, whose kind is S.
#[derive(Clone, Copy)]
pub(super) struct Wide<S: Simd>(S, S::f64s);

/// A yes or no of each of its lanes.
#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd>(S, S::m64s);

/// Something that begins with a line of the processor's cache: a vector that lies in two costs two accesses.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Aligned<T>(pub(super) T);

impl<S: Simd> Wide<S> {
    /// How many numbers it holds.
    pub(super) const LANES: usize = S::F64_LANES;

    /// Zeros.
    pub(super) fn zero(simd: S) -> Self {
        Self(simd, simd.splat_f64s(0.0))
    }

    /// The number in this lane.
    pub(super) fn get(&self, lane: usize) -> f64 {
        cast_slice::<S::f64s, f64>(from_ref(&self.1))[lane]
    }

    /// Puts a number in this lane.
    pub(super) fn set(&mut self, lane: usize, value: f64) {
        cast_slice_mut::<S::f64s, f64>(from_mut(&mut self.1))[lane] = value;
    }
}

impl<S: Simd> Add for Wide<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0, self.0.add_f64s(self.1, other.1))
    }
}

impl<S: Simd> Sub for Wide<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0, self.0.sub_f64s(self.1, other.1))
    }
}

impl<S: Simd> Mul for Wide<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0, self.0.mul_f64s(self.1, other.1))
    }
}

impl<S: Simd> Neg for Wide<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg_f64s(self.1))
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0, self.0.and_m64s(self.1, other.1))
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0, self.0.or_m64s(self.1, other.1))
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0, self.0.not_m64s(self.1))
    }
}

/// States are kept as their numbers, which compare like all others.
impl<S: Simd> Lanes for Wide<S> {
    type Mask = Mask<S>;
    type States = Self;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self(self.0, self.0.splat_f64s(value))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0, self.0.abs_f64s(self.1))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut result = self;
        for lane in 0..Self::LANES {
            result.set(lane, f(self.get(lane), other.get(lane)));
        }
        result
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> Mask<S> {
        Mask(self.0, self.0.less_than_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask<S> {
        Mask(self.0, self.0.less_than_or_equal_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn is(self, other: Self) -> Mask<S> {
        Mask(self.0, self.0.equal_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn select(mask: Mask<S>, yes: Self, no: Self) -> Self {
        Self(mask.0, mask.0.select_f64s(mask.1, yes.1, no.1))
    }

    #[inline(always)]
    fn any(mask: Mask<S>) -> bool {
        // A bit a lane, or all bits of a lane.
        match bytes_of(&mask.1) {
            [bits] => *bits != 0,
            bytes => {
                let mut any = 0;
                for lane in bytes.as_chunks().0 {
                    any |= u64::from_ne_bytes(*lane);
                }
                any != 0
            }
        }
    }

    fn lane(mask: Mask<S>, lane: usize) -> bool {
        let Mask(simd, mask) = mask;
        let ones = simd.select_f64s(mask, simd.splat_f64s(1.0), simd.splat_f64s(0.0));
        Self(simd, ones).get(lane) > 0.0
    }

    #[inline(always)]
    fn in_state(self, state: ContactState) -> Self {
        self.splat(f64::from(state as u8))
    }

    #[inline(always)]
    fn select_states(mask: Mask<S>, yes: Self, no: Self) -> Self {
        Self::select(mask, yes, no)
    }

    #[inline(always)]
    fn are(self, states: Self, state: ContactState) -> Mask<S> {
        states.is(self.in_state(state))
    }

    #[inline(always)]
    fn changed(before: Self, after: Self) -> Mask<S> {
        !before.is(after)
    }

    fn state(states: Self, lane: usize) -> ContactState {
        let number = states.get(lane);
        let is_it = |state: &ContactState| f64::from(*state as u8) == number;
        ContactState::ALL.into_iter().find(is_it).expect("nothing else is put in there")
    }
}

impl<T> Borrow<T> for Aligned<T> {
    #[inline(always)]
    fn borrow(&self) -> &T {
        &self.0
    }
}

impl<T> BorrowMut<T> for Aligned<T> {
    #[inline(always)]
    fn borrow_mut(&mut self) -> &mut T {
        &mut self.0
    }
}
