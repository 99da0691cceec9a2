//! Friction that falls with the slip velocity (Stribeck): µ(v_r) = µ_k + (µ_s − µ_k) exp(−|v_r|/v_s);
//! |T| ≤ µ_s N where the contact sticks, T = ±µ(v_r) N where it slips.
//!
//! Over a step, µ is that of the slip velocity at its beginning, as for damping: an approximation of first order.

use super::{
    FixedDirection, Friction, FrictionDerivatives, FrictionLaw, LawInfo, VelocityDependence,
};
use crate::contact::ContactState;

pub(super) const INFO: LawInfo = LawInfo {
    name: "stribeck",
    keys: &["coefficient", "static", "stribeck_velocity"],
    equation: "|T| ≤ µ_s N, T = ±(µ + (µ_s − µ) exp(−|v_r|/v_s)) N in slip",
    velocity_dependence: Some(VelocityDependence {
        friction: |friction, slip| Stribeck::new(friction, 0.0).at(slip, ContactState::Slide).now,
        friction_by: |friction, slip| {
            let Friction { kinetic, static_, stribeck_velocity: v_s } = friction;
            let decay = libm::exp(-slip.abs() / v_s);
            FrictionDerivatives {
                kinetic: 1.0 - decay,
                static_: decay,
                stribeck_velocity: (static_ - kinetic) * decay * (slip.abs() / v_s) / v_s,
                speed: -(static_ - kinetic) * (decay / v_s),
            }
        },
        slope_by: |friction, slip| {
            let Friction { kinetic, static_, stribeck_velocity: v_s } = friction;
            let rate = libm::exp(-slip.abs() / v_s) / v_s;
            FrictionDerivatives {
                kinetic: rate,
                static_: -rate,
                stribeck_velocity: (static_ - kinetic) * rate * (1.0 - slip.abs() / v_s) / v_s,
                speed: (static_ - kinetic) * (rate / v_s),
            }
        },
        greatest: |friction| friction.static_,
    }),
    sticks: true,
};

/// The Stribeck law µ(v_r), with its value in the present step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck {
    friction: Friction,
    now: f64,
}

impl FrictionLaw for Stribeck {
    type FixedDirection = FixedDirection<Self>;

    #[inline(always)]
    fn new(friction: Friction, _: f64) -> Self {
        Self { friction, now: friction.static_ }
    }

    #[inline(always)]
    fn at(self, slip: f64, before: ContactState) -> Self {
        let Friction { kinetic, static_, stribeck_velocity, .. } = self.friction;
        // A contact that sticks has no slip, though its surface may be faster by the end of the step.
        if before == ContactState::Stick {
            return Self { now: static_, ..self };
        }
        let decay = libm::exp(-slip.abs() / stribeck_velocity);
        Self { now: kinetic + (static_ - kinetic) * decay, ..self }
    }

    #[inline(always)]
    fn limit(self, normal: f64) -> f64 {
        self.now * normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ContactState::{Slide, Stick};

    const FRICTION: Friction =
        Friction { stribeck_velocity: 0.1, ..Friction::with_static(0.2, 0.5) };

    const FALLS: VelocityDependence = INFO.velocity_dependence.unwrap();

    fn mu(slip: f64) -> f64 {
        (FALLS.friction)(FRICTION, slip)
    }

    #[test]
    fn friction_falls_by_a_factor_e_over_each_stribeck_velocity() {
        for (slip, over_kinetic) in
            [(0.0, 0.3), (0.1, 0.3 / 1_f64.exp()), (-0.2, 0.3 / 2_f64.exp())]
        {
            assert!((mu(slip) - (0.2 + over_kinetic)).abs() < 1e-15);
        }
    }

    /// µ, or its slope, of a slip velocity, m/s.
    type Function = fn(Friction, f64) -> f64;

    /// Central differences with Richardson's correction: their error is of the fourth order.
    fn difference(function: impl Fn(f64) -> f64, at: f64) -> f64 {
        let central = |h: f64| (function(at + h) - function(at - h)) / (2.0 * h);
        (4.0 * central(1e-4) - central(2e-4)) / 3.0
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let slope = |friction, slip| (FALLS.friction_by)(friction, slip).speed;
        for slip in [0.03, 0.1, -0.25] {
            let all: [(Function, FrictionDerivatives); 2] = [
                (FALLS.friction, (FALLS.friction_by)(FRICTION, slip)),
                (slope, (FALLS.slope_by)(FRICTION, slip)),
            ];
            for (of, by) in all {
                let expected = [
                    difference(|kinetic| of(Friction { kinetic, ..FRICTION }, slip), 0.2),
                    difference(|static_| of(Friction { static_, ..FRICTION }, slip), 0.5),
                    difference(
                        |stribeck_velocity| of(Friction { stribeck_velocity, ..FRICTION }, slip),
                        0.1,
                    ),
                    difference(|speed| of(FRICTION, speed), slip.abs()),
                ];
                let found = [by.kinetic, by.static_, by.stribeck_velocity, by.speed];
                // The slope has a largest value over v_s at v_s = |v_r|, where differences leave rounding.
                let floor = 1e-10 * found.iter().fold(0.0, |most, by| f64::max(most, by.abs()));
                for (found, expected) in found.iter().zip(expected) {
                    let bound = 1e-8 * expected.abs() + floor;
                    assert!((found - expected).abs() < bound, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn what_sticks_is_held_by_static_friction_and_lets_go_without_a_jump() {
        let law = Stribeck::new(FRICTION, 1.0).at(0.0, Slide);
        assert!(law.holds(5.0, 10.0, Stick) && !law.holds(5.01, 10.0, Stick));
        assert_eq!(law.slip(5.01, 10.0), (5.0, Slide));
        let law = law.at(0.1, Slide);
        let (friction, state) = law.slip(5.01, 10.0);
        assert!((friction - 10.0 * mu(0.1)).abs() < 1e-15 && state == Slide);
        // A surface that speeds up under it has not moved on yet.
        assert!(law.at(0.1, Stick).holds(5.0, 10.0, Stick));
    }
}
