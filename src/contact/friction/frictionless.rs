//! No friction: T = 0.

use super::{Friction, FrictionLaw, LawInfo};
use crate::contact::ContactState;

pub(super) const INFO: LawInfo = LawInfo {
    name: "none",
    keys: &[],
    equation: "T = 0",
    velocity_dependence: None,
    sticks: false,
};

/// A law without friction. The slip then has no direction: the state of a closed contact is sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frictionless;

impl FrictionLaw for Frictionless {
    const STICKS: bool = false;
    const HAS_DIRECTION: bool = false;

    type FixedDirection = Self;

    #[inline(always)]
    fn new(_: Friction, _: f64) -> Self {
        Self
    }

    #[inline(always)]
    fn limit(self, _: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn slip(self, _: f64, _: f64) -> (f64, ContactState) {
        (0.0, ContactState::Slide)
    }
}
