//! No friction: T = 0.

use super::{About, Friction, FrictionLaw};
use crate::contact::{ContactState, Lanes};

pub(super) const ABOUT: About =
    About { name: "none", keys: &[], equation: "T = 0", falls: None, sticks: false };

/// Nothing holds a contact but its normal. Slip has no direction then: a closed contact is said to slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frictionless<V = f64>(V);

impl<V: Lanes> FrictionLaw<V> for Frictionless<V> {
    const STICKS: bool = false;
    const HAS_DIRECTION: bool = false;

    type Frozen = Self;

    #[inline(always)]
    fn new(_: Friction<V>, surface: V) -> Self {
        Self(surface.splat(0.0))
    }

    #[inline(always)]
    fn limit(self, _: V) -> V {
        self.0
    }

    #[inline(always)]
    fn slip(self, _: V, _: V) -> (V, V::States) {
        (self.0, self.0.in_state(ContactState::Slide))
    }
}
