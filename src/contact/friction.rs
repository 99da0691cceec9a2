//! Friction coefficients, and what friction may be on a contact.

use super::ContactState;
use serde::{Deserialize, Serialize};

/// The friction coefficients of a contact. Coulomb's law with one of them has both alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Friction {
    /// µ_k ≥ 0, of a contact that slips.
    pub kinetic: f64,
    /// µ_s ≥ µ_k, of one that does not.
    pub static_: f64,
}

impl From<f64> for Friction {
    fn from(coefficient: f64) -> Self {
        Self { kinetic: coefficient, static_: coefficient }
    }
}

impl Friction {
    /// How far T may go on a contact that was in this state.
    ///
    /// One that slips sticks where µ_k N brings its slip velocity to zero, and then holds with up to
    /// µ_s N against slipping the other way. A touch-down has slipped.
    #[must_use]
    pub fn range(self, before: ContactState) -> FrictionRange {
        let Self { kinetic, static_ } = self;
        let (backward, forward) = match before {
            ContactState::Slide => (static_, kinetic),
            ContactState::ReverseSlide => (kinetic, static_),
            ContactState::Stick => (static_, static_),
            ContactState::Detached => (kinetic, kinetic),
        };
        FrictionRange { backward, forward, kinetic }
    }
}

/// What friction may be on a contact, over its normal force: −`backward` ≤ T/N ≤ `forward` where it
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
    /// The most that T/N may be in this direction (±1).
    #[must_use]
    pub fn limit(&self, direction: f64) -> f64 {
        if direction > 0.0 { self.forward } else { self.backward }
    }

    /// The same, to be changed.
    #[must_use]
    pub fn limit_mut(&mut self, direction: f64) -> &mut f64 {
        if direction > 0.0 { &mut self.forward } else { &mut self.backward }
    }

    /// Can friction be T under the normal force N (both N)?
    #[inline]
    #[must_use]
    pub fn holds(&self, tangential: f64, normal: f64) -> bool {
        -(self.backward * normal) <= tangential && tangential <= self.forward * normal
    }
}

/// A law that says what friction is on a closed contact.
pub trait FrictionLaw: Copy {
    /// T, N, and the state that belongs to it: `holding` (N) where friction can hold, else what acts on a
    /// contact that slips; N is `normal`, and the contact was in state `before`.
    fn friction(self, holding: f64, normal: f64, before: ContactState) -> (f64, ContactState);
}

/// Coulomb's law with one coefficient µ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb(pub f64);

impl FrictionLaw for Coulomb {
    #[inline]
    fn friction(self, holding: f64, normal: f64, _: ContactState) -> (f64, ContactState) {
        let limit = self.0 * normal;
        if holding.abs() <= limit { (holding, ContactState::Stick) } else { slip(holding, limit) }
    }
}

/// With a static coefficient above the kinetic one.
impl FrictionLaw for Friction {
    #[inline]
    fn friction(self, holding: f64, normal: f64, before: ContactState) -> (f64, ContactState) {
        if self.range(before).holds(holding, normal) {
            (holding, ContactState::Stick)
        } else {
            slip(holding, self.kinetic * normal)
        }
    }
}

/// Friction of a contact that it does not hold; `limit` is µ_k N.
#[inline]
fn slip(holding: f64, limit: f64) -> (f64, ContactState) {
    if holding > 0.0 { (limit, ContactState::Slide) } else { (-limit, ContactState::ReverseSlide) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{Detached, ReverseSlide, Slide, Stick};

    const DROPS: Friction = Friction { kinetic: 0.4, static_: 0.6 };

    #[test]
    fn friction_holds_up_to_its_limit_and_no_further() {
        for (holding, expected) in
            [(3.0, (3.0, Stick)), (3.1, (3.0, Slide)), (-3.1, (-3.0, ReverseSlide))]
        {
            assert_eq!(Coulomb(0.5).friction(holding, 6.0, Slide), expected);
            // One law, whichever way it is written.
            assert_eq!(Friction::from(0.5).friction(holding, 6.0, Slide), expected);
        }
    }

    #[test]
    fn what_sticks_holds_to_the_static_limit_and_then_drops_to_the_kinetic() {
        for sign in [-1.0, 1.0] {
            let slips = if sign > 0.0 { Slide } else { ReverseSlide };
            assert_eq!(DROPS.friction(sign * 6.0, 10.0, Stick), (sign * 6.0, Stick));
            assert_eq!(DROPS.friction(sign * 6.1, 10.0, Stick), (sign * 4.0, slips));
        }
    }

    #[test]
    fn what_slips_is_stopped_by_kinetic_friction_and_held_on_the_other_side_by_static() {
        for (slips, other, sign) in [(Slide, ReverseSlide, 1.0), (ReverseSlide, Slide, -1.0)] {
            assert_eq!(DROPS.friction(sign * 4.1, 10.0, slips), (sign * 4.0, slips));
            assert_eq!(DROPS.friction(sign * 4.0, 10.0, slips), (sign * 4.0, Stick));
            assert_eq!(DROPS.friction(sign * -6.0, 10.0, slips), (sign * -6.0, Stick));
            assert_eq!(DROPS.friction(sign * -6.1, 10.0, slips), (sign * -4.0, other));
            // An impact is stopped by kinetic friction alone.
            assert_eq!(DROPS.friction(sign * 4.1, 10.0, Detached), (sign * 4.0, slips));
        }
    }
}
