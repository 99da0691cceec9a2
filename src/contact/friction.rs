//! Friction coefficients, and what friction may be on a contact.

use super::{ContactState, Lanes};
use serde::{Deserialize, Serialize};

/// The friction coefficients of a contact. Coulomb's law with one of them has both alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Friction<V = f64> {
    /// µ_k ≥ 0, of a contact that slips.
    pub kinetic: V,
    /// µ_s ≥ µ_k, of one that does not.
    pub static_: V,
}

impl From<f64> for Friction {
    fn from(coefficient: f64) -> Self {
        Self { kinetic: coefficient, static_: coefficient }
    }
}

impl<V: Lanes> Friction<V> {
    /// How far T may go on a contact that was in this state.
    ///
    /// One that slips sticks where µ_k N brings its slip velocity to zero, and then holds with up to
    /// µ_s N against slipping the other way. A touch-down has slipped.
    #[inline(always)]
    #[must_use]
    pub fn range(self, before: V::States) -> FrictionRange<V> {
        let Self { kinetic, static_ } = self;
        let stuck = kinetic.are(before, ContactState::Stick);
        let slid = stuck | kinetic.are(before, ContactState::Slide);
        let slid_back = stuck | kinetic.are(before, ContactState::ReverseSlide);
        FrictionRange {
            backward: V::select(slid, static_, kinetic),
            forward: V::select(slid_back, static_, kinetic),
            kinetic,
        }
    }
}

/// What friction may be on a contact, over its normal force: −`backward` ≤ T/N ≤ `forward` where it
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

/// A law that says what friction is on a closed contact. For several simulations at once it says so of each
/// by itself ([`Lanes`]).
pub trait FrictionLaw<V: Lanes = f64>: Copy {
    /// Can friction be `holding` (N) on a contact that was in state `before` and presses with `normal` (N)?
    fn holds(self, holding: V, normal: V, before: V::States) -> V::Mask;

    /// The size of T on a contact that slips and presses with `normal`, N.
    #[must_use]
    fn limit(self, normal: V) -> V;

    /// T on a contact that friction does not hold, N, and its state.
    #[inline(always)]
    #[must_use]
    fn slip(self, holding: V, normal: V) -> (V, V::States) {
        let limit = self.limit(normal);
        let forward = holding.splat(0.0).is_below(holding);
        let slide = limit.in_state(ContactState::Slide);
        let reverse = limit.in_state(ContactState::ReverseSlide);
        (V::select(forward, limit, -limit), V::select_states(forward, slide, reverse))
    }
}

/// Coulomb's law with one coefficient µ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<V = f64>(pub V);

/// Of two that are alike.
impl<V> From<Friction<V>> for Coulomb<V> {
    #[inline(always)]
    fn from(friction: Friction<V>) -> Self {
        Self(friction.kinetic)
    }
}

impl<V: Lanes> FrictionLaw<V> for Coulomb<V> {
    #[inline(always)]
    fn holds(self, holding: V, normal: V, _: V::States) -> V::Mask {
        holding.abs().is_at_most(self.limit(normal))
    }

    #[inline(always)]
    fn limit(self, normal: V) -> V {
        self.0 * normal
    }
}

/// With a static coefficient above the kinetic one.
impl<V: Lanes> FrictionLaw<V> for Friction<V> {
    #[inline(always)]
    fn holds(self, holding: V, normal: V, before: V::States) -> V::Mask {
        self.range(before).holds(holding, normal)
    }

    #[inline(always)]
    fn limit(self, normal: V) -> V {
        self.kinetic * normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{Detached, ReverseSlide, Slide, Stick};

    const DROPS: Friction = Friction { kinetic: 0.4, static_: 0.6 };

    fn friction(
        law: impl FrictionLaw,
        holding: f64,
        normal: f64,
        before: ContactState,
    ) -> (f64, ContactState) {
        if law.holds(holding, normal, before) {
            (holding, Stick)
        } else {
            law.slip(holding, normal)
        }
    }

    #[test]
    fn friction_holds_up_to_its_limit_and_no_further() {
        for (holding, expected) in
            [(3.0, (3.0, Stick)), (3.1, (3.0, Slide)), (-3.1, (-3.0, ReverseSlide))]
        {
            assert_eq!(friction(Coulomb(0.5), holding, 6.0, Slide), expected);
            // One law, whichever way it is written.
            assert_eq!(friction(Friction::from(0.5), holding, 6.0, Slide), expected);
        }
    }

    #[test]
    fn what_sticks_holds_to_the_static_limit_and_then_drops_to_the_kinetic() {
        for sign in [-1.0, 1.0] {
            let slips = if sign > 0.0 { Slide } else { ReverseSlide };
            assert_eq!(friction(DROPS, sign * 6.0, 10.0, Stick), (sign * 6.0, Stick));
            assert_eq!(friction(DROPS, sign * 6.1, 10.0, Stick), (sign * 4.0, slips));
        }
    }

    #[test]
    fn what_slips_is_stopped_by_kinetic_friction_and_held_on_the_other_side_by_static() {
        for (slips, other, sign) in [(Slide, ReverseSlide, 1.0), (ReverseSlide, Slide, -1.0)] {
            assert_eq!(friction(DROPS, sign * 4.1, 10.0, slips), (sign * 4.0, slips));
            assert_eq!(friction(DROPS, sign * 4.0, 10.0, slips), (sign * 4.0, Stick));
            assert_eq!(friction(DROPS, sign * -6.0, 10.0, slips), (sign * -6.0, Stick));
            assert_eq!(friction(DROPS, sign * -6.1, 10.0, slips), (sign * -4.0, other));
            // An impact is stopped by kinetic friction alone.
            assert_eq!(friction(DROPS, sign * 4.1, 10.0, Detached), (sign * 4.0, slips));
        }
    }
}
