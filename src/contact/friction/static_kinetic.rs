//! Static and kinetic friction: |T| ≤ µ_s N where the contact sticks, T = ±µ_k N where it slips.
//!
//! A contact that slips sticks where µ_k N brings its slip velocity to zero, and then holds with up to
//! µ_s N against slipping the other way. A touch-down has slipped.

use super::{Coulomb, FixedDirection, Friction, FrictionLaw, FrictionRange, LawInfo};
use crate::contact::ContactState;

pub(super) const INFO: LawInfo = LawInfo {
    name: "static",
    keys: &["coefficient", "static"],
    equation: "|T| ≤ µ_s N, T = ±µ N in slip",
    velocity_dependence: None,
    sticks: true,
};

/// Static and kinetic friction with two coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticKinetic {
    kinetic: f64,
    static_: f64,
}

impl FrictionLaw for StaticKinetic {
    // A contact that never sticks has no use for µ_s.
    type FixedDirection = FixedDirection<Coulomb>;

    #[inline(always)]
    fn new(friction: Friction, _: f64) -> Self {
        Self { kinetic: friction.kinetic, static_: friction.static_ }
    }

    #[inline(always)]
    fn holds(self, holding: f64, normal: f64, before: ContactState) -> bool {
        self.range(before).holds(holding, normal)
    }

    #[inline(always)]
    fn limit(self, normal: f64) -> f64 {
        self.kinetic * normal
    }

    #[inline(always)]
    fn range(self, before: ContactState) -> FrictionRange {
        let Self { kinetic, static_ } = self;
        let (backward, forward) = match before {
            ContactState::Stick => (static_, static_),
            ContactState::Slide => (static_, kinetic),
            ContactState::ReverseSlide => (kinetic, static_),
            ContactState::Detached => (kinetic, kinetic),
        };
        FrictionRange { backward, forward, kinetic }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{Detached, ReverseSlide, Slide, Stick};

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

    fn drops() -> StaticKinetic {
        StaticKinetic::new(Friction::with_static(0.4, 0.6), 1.0)
    }

    #[test]
    fn friction_holds_up_to_its_limit_and_no_further() {
        for (holding, expected) in
            [(3.0, (3.0, Stick)), (3.1, (3.0, Slide)), (-3.1, (-3.0, ReverseSlide))]
        {
            assert_eq!(friction(Coulomb(0.5), holding, 6.0, Slide), expected);
            // Coulomb's law is the same in both forms.
            let alike = StaticKinetic::new(0.5.into(), 1.0);
            assert_eq!(friction(alike, holding, 6.0, Slide), expected);
        }
    }

    #[test]
    fn what_sticks_holds_to_the_static_limit_and_then_drops_to_the_kinetic() {
        for sign in [-1.0, 1.0] {
            let slips = if sign > 0.0 { Slide } else { ReverseSlide };
            assert_eq!(friction(drops(), sign * 6.0, 10.0, Stick), (sign * 6.0, Stick));
            assert_eq!(friction(drops(), sign * 6.1, 10.0, Stick), (sign * 4.0, slips));
        }
    }

    #[test]
    fn what_slips_is_stopped_by_kinetic_friction_and_held_on_the_other_side_by_static() {
        for (slips, other, sign) in [(Slide, ReverseSlide, 1.0), (ReverseSlide, Slide, -1.0)] {
            assert_eq!(friction(drops(), sign * 4.1, 10.0, slips), (sign * 4.0, slips));
            assert_eq!(friction(drops(), sign * 4.0, 10.0, slips), (sign * 4.0, Stick));
            assert_eq!(friction(drops(), sign * -6.0, 10.0, slips), (sign * -6.0, Stick));
            assert_eq!(friction(drops(), sign * -6.1, 10.0, slips), (sign * -4.0, other));
            // An impact is stopped by kinetic friction alone.
            assert_eq!(friction(drops(), sign * 4.1, 10.0, Detached), (sign * 4.0, slips));
        }
    }
}
