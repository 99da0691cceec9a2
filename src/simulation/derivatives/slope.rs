//! ±µ of a sliding contact as a function.

use crate::contact::{ContactForce, ContactLaw, Friction};

/// T/N of a sliding contact, with its derivatives; zero in the other states.
#[derive(Clone, Copy, Default)]
pub(super) struct Slope {
    pub(super) value: f64,
    by_slip: f64,
    /// Derivatives by µ_k and µ_s.
    by_coefficients: [f64; 2],
}

impl Slope {
    /// The slope of a contact in its present state.
    pub(super) fn of(law: ContactLaw, friction: Friction, force: &ContactForce) -> Self {
        let Some(direction) = force.state.sliding_direction() else { return Self::default() };
        let is_pulled = law.follows_size() && force.normal_force < 0.0;
        let sign = if is_pulled { -direction } else { direction };
        Self::with_sign(law, friction, force.slip_velocity, sign)
    }

    /// The slope of friction with this sign, at a slip velocity, m/s.
    pub(super) fn with_sign(law: ContactLaw, friction: Friction, slip: f64, sign: f64) -> Self {
        let Some(dependence) = law.friction.info().velocity_dependence else {
            let value = sign * friction.kinetic;
            return Self { value, by_slip: 0.0, by_coefficients: [sign, 0.0] };
        };
        let by = (dependence.friction_by)(friction, slip);
        Self {
            value: sign * (dependence.friction)(friction, slip),
            by_slip: sign * by.speed * slip.signum(),
            by_coefficients: [by.kinetic, by.static_].map(|by| sign * by),
        }
    }

    /// Change of T/N due to changes of the slip velocity, m/s, and of µ_k and µ_s.
    pub(super) fn change(self, slip: f64, [kinetic, static_]: [f64; 2]) -> f64 {
        let [by_kinetic, by_static] = self.by_coefficients;
        self.by_slip * slip + by_kinetic * kinetic + by_static * static_
    }
}
