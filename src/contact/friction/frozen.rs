//! Friction whose direction is frozen: T = s µ N with the sign s of the surface's velocity, whichever way
//! the mass moves.

use super::{Friction, FrictionLaw};
use crate::contact::Lanes;

/// A law without sticking: what the linearised analysis of uniform sliding assumes. Friction follows N with
/// its sign, so a contact that is held in both directions has linear motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frozen<V, L> {
    law: L,
    surface: V,
}

impl<V: Lanes, L: FrictionLaw<V>> FrictionLaw<V> for Frozen<V, L> {
    const STICKS: bool = false;

    type Frozen = Self;

    #[inline(always)]
    fn new(friction: Friction<V>, surface: V) -> Self {
        Self { law: L::new(friction, surface), surface }
    }

    #[inline(always)]
    fn at(self, slip: V, before: V::States) -> Self {
        Self { law: self.law.at(slip, before), ..self }
    }

    #[inline(always)]
    fn limit(self, normal: V) -> V {
        self.law.limit(normal)
    }

    #[inline(always)]
    fn slip(self, _: V, normal: V) -> (V, V::States) {
        self.law.slip(self.surface, normal)
    }
}
