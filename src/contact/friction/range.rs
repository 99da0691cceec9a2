//! How far friction may go where it holds.

/// What friction is on a contact, over its normal force: −`backward` ≤ T/N ≤ `forward` where it
/// holds, ±`kinetic` where it slips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRange {
    /// Against the tangent.
    pub backward: f64,
    /// Along the tangent.
    pub forward: f64,
    /// µ_k, no more than the other two.
    pub kinetic: f64,
}

impl FrictionRange {
    /// The range of Coulomb's law: one coefficient in both directions and for what slips.
    #[inline(always)]
    #[must_use]
    pub fn of(coefficient: f64) -> Self {
        Self { backward: coefficient, forward: coefficient, kinetic: coefficient }
    }

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

    /// Can friction be T under the normal force N (both N)?
    #[inline(always)]
    #[must_use]
    pub fn holds(&self, tangential: f64, normal: f64) -> bool {
        -(self.backward * normal) <= tangential && tangential <= self.forward * normal
    }
}
