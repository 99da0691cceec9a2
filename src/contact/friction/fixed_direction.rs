//! Friction with a fixed direction: T = s µ N with the sign s of the surface's velocity, independent of the direction
//! in which the mass moves.

use super::{Friction, FrictionLaw};
use crate::contact::ContactState;

/// A law without sticking, as the linearised analysis of uniform sliding assumes. Friction follows N with its sign, so
/// a contact that is held in both directions has linear motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedDirection<L> {
    law: L,
    surface: f64,
}

impl<L: FrictionLaw> FrictionLaw for FixedDirection<L> {
    const STICKS: bool = false;

    type FixedDirection = Self;

    #[inline(always)]
    fn new(friction: Friction, surface: f64) -> Self {
        Self { law: L::new(friction, surface), surface }
    }

    #[inline(always)]
    fn at(self, slip: f64, before: ContactState) -> Self {
        Self { law: self.law.at(slip, before), ..self }
    }

    #[inline(always)]
    fn limit(self, normal: f64) -> f64 {
        self.law.limit(normal)
    }

    #[inline(always)]
    fn slip(self, _: f64, normal: f64) -> (f64, ContactState) {
        self.law.slip(self.surface, normal)
    }
}
