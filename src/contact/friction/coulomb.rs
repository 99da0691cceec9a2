//! Coulomb's law with one coefficient: |T| ≤ µ N where the contact sticks, T = ±µ N where it slips.

use super::{FixedDirection, Friction, FrictionLaw, LawInfo};

pub(super) const INFO: LawInfo = LawInfo {
    name: "coulomb",
    keys: &["coefficient"],
    equation: "|T| ≤ µ N, T = ±µ N in slip",
    velocity_dependence: None,
    sticks: true,
};

/// Coulomb's law with one coefficient µ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb(pub f64);

impl FrictionLaw for Coulomb {
    type FixedDirection = FixedDirection<Self>;

    #[inline(always)]
    fn new(friction: Friction, _: f64) -> Self {
        Self(friction.kinetic)
    }

    #[inline(always)]
    fn limit(self, normal: f64) -> f64 {
        self.0 * normal
    }
}
