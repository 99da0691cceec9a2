//! The law of contact for scenes that leave parts of it out, and friction that depends on the slip velocity.
//!
//! A contact that cannot open has no gap, and its friction follows the size of its normal force, or the signed force if
//! the direction of friction is frozen. A contact that cannot stick has the direction of its surface's velocity,
//! whatever its slip.

use super::Run;
use amontons::contact::residual::{Instant, Scales, Violation, residual};
use amontons::contact::{ContactLaw, Friction, Law};

/// A slip velocity beyond all scales, in parts of the scale of velocities.
const FAST: f64 = 1e30;

/// Violation by a contact of those parts of the law that the scene has, on a surface with this velocity, m/s.
pub(super) fn residual_under(
    law: ContactLaw,
    surface: f64,
    instant: &Instant,
    friction: Friction,
    scales: &Scales,
) -> Violation {
    let mut now = *instant;
    let has_fixed_direction = law.has_fixed_direction();
    if !law.detachment {
        (now.gap, now.gap_velocity) = (-now.gap.abs(), -now.gap_velocity.abs());
        if has_fixed_direction && now.normal_force < 0.0 {
            now.friction_force = -now.friction_force;
        }
        now.normal_force = now.normal_force.abs();
    }
    if has_fixed_direction {
        let direction = if surface > 0.0 { 1.0 } else { -1.0 };
        now.slip_velocity = direction * FAST * scales.velocity;
    }
    residual(&now, friction, scales)
}

impl Run {
    /// `true` if the scene has the whole law of contact.
    pub(super) fn has_whole_law(&self) -> bool {
        !self.model.law.is_reduced()
    }

    /// The friction of a contact that has this slip velocity (m/s) when a step begins, or sticks.
    pub(super) fn friction_at(&self, friction: Friction, slip: f64, sticks: bool) -> Friction {
        let Friction { kinetic, static_, .. } = friction;
        let slip = if sticks && !self.model.law.has_fixed_state() { 0.0 } else { slip.abs() };
        match self.model.law.friction {
            Law::Frictionless | Law::Coulomb | Law::StaticKinetic => friction,
            Law::Stribeck => {
                let decay = (-slip / friction.stribeck_velocity).exp();
                Friction::from(kinetic + (static_ - kinetic) * decay)
            }
        }
    }

    /// Edges of the cone of forces for a direction of friction, or for a range between two.
    pub(super) fn edges(&self, [from, to]: [f64; 2], surface: f64) -> [f64; 2] {
        if !self.model.law.has_fixed_direction() {
            return [from, to];
        }
        let size = from.abs().max(to.abs());
        [if surface > 0.0 { size } else { -size }; 2]
    }
}
