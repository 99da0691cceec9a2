//! Coulomb's law with one coefficient: |T| ≤ µ N where the contact sticks, T = ±µ N where it slips.

use super::{About, Friction, FrictionLaw, Frozen};
use crate::contact::Lanes;

pub(super) const ABOUT: About = About {
    name: "coulomb",
    keys: &["coefficient"],
    equation: "|T| ≤ µ N, T = ±µ N in slip",
    falls: None,
    sticks: true,
};

/// Coulomb's law with one coefficient µ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<V = f64>(pub V);

impl<V: Lanes> FrictionLaw<V> for Coulomb<V> {
    type Frozen = Frozen<V, Self>;

    #[inline(always)]
    fn new(friction: Friction<V>, _: V) -> Self {
        Self(friction.kinetic)
    }

    #[inline(always)]
    fn limit(self, normal: V) -> V {
        self.0 * normal
    }
}
