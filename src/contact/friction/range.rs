//! How far friction may go where it holds.

use crate::contact::Lanes;

/// What friction is on a contact, over its normal force: −`backward` ≤ T/N ≤ `forward` where it
/// holds, ±`kinetic` where it slips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRange<V = f64> {
    /// Against the tangent.
    pub backward: V,
    /// Along the tangent.
    pub forward: V,
    /// µ_k, no more than the other two.
    pub kinetic: V,
}

impl<V: Copy> FrictionRange<V> {
    /// The range of Coulomb's law: one coefficient in both directions and for what slips.
    #[inline(always)]
    #[must_use]
    pub fn of(coefficient: V) -> Self {
        Self { backward: coefficient, forward: coefficient, kinetic: coefficient }
    }
}

impl FrictionRange {
    /// The most that T/N may be in this direction (±1).
    #[must_use]
    pub fn limit(&self, direction: f64) -> f64 {
        if direction > 0.0 { self.forward } else { self.backward }
    }

    /// The limits of T/N where N is below zero and T is held by |N|: T/N then has the other sign.
    #[must_use]
    pub fn pulling(&self) -> Self {
        Self { backward: self.forward, forward: self.backward, ..*self }
    }

    /// The limit of T/N in a direction, as [`limit`](Self::limit) has it, to be changed.
    #[must_use]
    pub fn limit_mut(&mut self, direction: f64) -> &mut f64 {
        if direction > 0.0 { &mut self.forward } else { &mut self.backward }
    }
}

impl<V: Lanes> FrictionRange<V> {
    /// Can friction be T under the normal force N (both N)?
    #[inline(always)]
    #[must_use]
    pub fn holds(&self, tangential: V, normal: V) -> V::Mask {
        (-(self.backward * normal)).is_at_most(tangential)
            & tangential.is_at_most(self.forward * normal)
    }
}
