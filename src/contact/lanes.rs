//! Numbers that go through the law of contact together: one, or a vector of them.

use super::ContactState;
use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

/// One number of each of several independent simulations, its *lanes*. A plain `f64` is the lane of a
/// single one.
///
/// Each operation is that of IEEE 754 in every lane, so a lane has the doubles of a run by itself. What a
/// lane decides becomes a mask; where all lanes agree, whoever asks may branch instead.
///
/// Everything is inlined: into a function that is compiled for wider vectors, that makes it such.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// A yes or no of each lane.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;
    /// The state of a contact in each lane.
    type States: Copy;

    /// The same number in all lanes; `self` says in how many.
    #[must_use]
    fn splat(self, value: f64) -> Self;
    /// Its size.
    #[must_use]
    fn abs(self) -> Self;
    /// f of each number with that of the other in its lane.
    #[must_use]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
    /// self < other.
    fn is_below(self, other: Self) -> Self::Mask;
    /// self ≤ other.
    fn is_at_most(self, other: Self) -> Self::Mask;
    /// self = other.
    fn is(self, other: Self) -> Self::Mask;
    /// `yes` where the mask says so, `no` elsewhere.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Does any lane say yes?
    fn any(mask: Self::Mask) -> bool;
    /// Do all lanes?
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        !Self::any(!mask)
    }
    /// Does this lane (from 0)?
    fn lane(mask: Self::Mask, lane: usize) -> bool;

    /// The same state in all lanes; `self` says in how many.
    fn in_state(self, state: ContactState) -> Self::States;
    /// As [`select`](Self::select).
    fn select_states(mask: Self::Mask, yes: Self::States, no: Self::States) -> Self::States;
    /// Which lanes are in this state?
    fn are(self, states: Self::States, state: ContactState) -> Self::Mask;
    /// Which lanes differ in their states?
    fn changed(before: Self::States, after: Self::States) -> Self::Mask;
    /// The state of this lane (from 0).
    fn state(states: Self::States, lane: usize) -> ContactState;
}

impl Lanes for f64 {
    type Mask = bool;
    type States = ContactState;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f(self, other)
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn is(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn lane(mask: bool, _: usize) -> bool {
        mask
    }

    #[inline(always)]
    fn in_state(self, state: ContactState) -> ContactState {
        state
    }

    #[inline(always)]
    fn select_states(mask: bool, yes: ContactState, no: ContactState) -> ContactState {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn are(self, states: ContactState, state: ContactState) -> bool {
        states == state
    }

    #[inline(always)]
    fn changed(before: ContactState, after: ContactState) -> bool {
        before != after
    }

    #[inline(always)]
    fn state(states: ContactState, _: usize) -> ContactState {
        states
    }
}
