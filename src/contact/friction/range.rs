//! The range of friction over the normal force of a contact.

/// The range of friction on a contact over its normal force: −`backward` ≤ T/N ≤ `forward` where friction holds the
/// contact, ±`kinetic` where it slips.
///
/// ```
/// use amontons::contact::FrictionRange;
///
/// let range = FrictionRange::of(0.3);
/// assert!(range.holds(-2.9, 10.0) && !range.holds(3.1, 10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRange {
    /// Limit against the tangent.
    pub backward: f64,
    /// Limit along the tangent.
    pub forward: f64,
    /// Kinetic coefficient µ_k, no more than the other two.
    pub kinetic: f64,
}

impl FrictionRange {
    /// The range of Coulomb's law: one coefficient in both directions and in slip.
    #[inline(always)]
    #[must_use]
    pub fn of(coefficient: f64) -> Self {
        Self { backward: coefficient, forward: coefficient, kinetic: coefficient }
    }

    /// Largest |T/N| in this direction (±1).
    #[must_use]
    pub fn limit(&self, direction: f64) -> f64 {
        if direction > 0.0 { self.forward } else { self.backward }
    }

    /// The limits of T/N where N is below zero and T is held by |N|: T/N then has the other sign.
    #[must_use]
    pub fn pulling(&self) -> Self {
        Self { backward: self.forward, forward: self.backward, ..*self }
    }

    /// Mutable access to the limit that [`limit`](Self::limit) returns.
    #[must_use]
    pub fn limit_mut(&mut self, direction: f64) -> &mut f64 {
        if direction > 0.0 { &mut self.forward } else { &mut self.backward }
    }

    /// `true` if friction can be T under the normal force N (both N).
    #[inline(always)]
    #[must_use]
    pub fn holds(&self, tangential: f64, normal: f64) -> bool {
        -(self.backward * normal) <= tangential && tangential <= self.forward * normal
    }
}
