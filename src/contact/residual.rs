//! The residual of a contact in the Signorini–Coulomb law, an independent check of integrators.
//!
//! The residual depends only on positions, velocities and forces of one contact at one instant, and shares nothing with
//! the code that solves the law. The law, with the gap g, N compressive, T on the mass and v_r = v − ẋ_t:
//!
//! * 0 ≤ g ⊥ N ≥ 0, and on a closed contact 0 ≤ ġ ⊥ N ≥ 0;
//! * |T| ≤ µ_s N;
//! * v_r = 0, or T = sign(v_r) µ_k N.
//!
//! The condition that one of two values vanishes is measured by the smaller of the two, each over its scale, so no
//! threshold decides which contacts are closed or stuck.

use super::Friction;
use std::fmt;

/// Gap, velocities and forces of a contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Gap g, m; negative where the mass is inside the slider.
    pub gap: f64,
    /// Rate of the gap ġ, m/s; positive where the contact opens.
    pub gap_velocity: f64,
    /// Slip velocity v_r = v − ẋ_t, slider against mass, m/s.
    pub slip_velocity: f64,
    /// Normal force N, compressive, N.
    pub normal_force: f64,
    /// Friction force T on the mass along the tangent, N.
    pub friction_force: f64,
}

/// The scales by which violations of the law are divided; all above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Scale of lengths, m.
    pub length: f64,
    /// Scale of velocities, m/s.
    pub velocity: f64,
    /// Scale of forces, N.
    pub force: f64,
}

/// A condition of the law of contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All values are finite.
    Finite,
    /// The gap is not negative: g ≥ 0.
    Penetration,
    /// A closed contact does not approach: ġ ≥ 0.
    Approach,
    /// The normal force does not pull: N ≥ 0.
    Adhesion,
    /// A contact that is open or opens carries no force: N = 0.
    ForceAtADistance,
    /// Friction is within its limit: |T| ≤ µ_s N.
    FrictionLimit,
    /// A contact that slips has kinetic friction: |T| = µ_k N.
    SlidingFriction,
    /// Friction dissipates power in a contact that slips: T v_r ≥ 0.
    Feeding,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Finite => "a value is not a number",
            Self::Penetration => "the mass is inside the slider",
            Self::Approach => "the surfaces of a closed contact approach each other",
            Self::Adhesion => "the normal force pulls",
            Self::ForceAtADistance => "an open contact carries a force",
            Self::FrictionLimit => "friction is above its limit",
            Self::SlidingFriction => "friction in slip differs from its kinetic value",
            Self::Feeding => "friction adds energy to the slip",
        })
    }
}

/// The part of the law that is violated most, and the size of the violation relative to the scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Size of the violation: zero where the law holds, infinite where values are not finite.
    pub size: f64,
    /// The violated part; `None` if the law holds.
    pub part: Option<Part>,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.part {
            Some(part) => write!(f, "{part}, by {:.3e}", self.size),
            None => f.write_str("the law of contact is satisfied"),
        }
    }
}

/// Returns the largest violation of the law by a contact.
///
/// ```
/// use amontons::contact::Friction;
/// use amontons::contact::residual::{Instant, Part, Scales, residual};
///
/// let sliding = Instant {
///     gap: 0.0,
///     gap_velocity: 0.0,
///     slip_velocity: 0.1,
///     normal_force: 10.0,
///     friction_force: 3.0,
/// };
/// let scales = Scales { length: 1e-3, velocity: 0.1, force: 10.0 };
/// assert_eq!(residual(&sliding, Friction::from(0.3), &scales).part, None);
/// let feeding = Instant { friction_force: -3.0, ..sliding };
/// assert_eq!(residual(&feeding, Friction::from(0.3), &scales).part, Some(Part::Feeding));
/// ```
#[must_use]
pub fn residual(instant: &Instant, friction: Friction, scales: &Scales) -> Violation {
    let Instant { gap, gap_velocity, slip_velocity, normal_force, friction_force } = *instant;
    let values = [gap, gap_velocity, slip_velocity, normal_force, friction_force];
    if !values.iter().all(|value| value.is_finite()) {
        return Violation { size: f64::INFINITY, part: Some(Part::Finite) };
    }
    let (gap, opening) = (gap / scales.length, gap_velocity / scales.velocity);
    let (pressing, held) = (normal_force / scales.force, friction_force.abs() / scales.force);
    let slip = slip_velocity.abs() / scales.velocity;
    let compressed = pressing.max(0.0);
    let feeds = friction_force * slip_velocity < 0.0;
    let kinetic = friction.kinetic * compressed;
    // A force against the slip differs from the kinetic one by the sum of both.
    let missed = if feeds { held + kinetic } else { (held - kinetic).abs() };
    let sliding = if feeds { Part::Feeding } else { Part::SlidingFriction };
    let parts = [
        (Part::Penetration, -gap),
        (Part::Approach, if gap <= 0.0 { -opening } else { 0.0 }),
        (Part::Adhesion, -pressing),
        (Part::ForceAtADistance, gap.max(opening).min(pressing)),
        (Part::FrictionLimit, held - friction.static_ * compressed),
        (sliding, slip.min(missed)),
    ];
    let none = Violation { size: 0.0, part: None };
    parts.into_iter().fold(none, |worst, (part, size)| {
        if size > worst.size { Violation { size, part: Some(part) } } else { worst }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: Scales = Scales { length: 1e-3, velocity: 0.1, force: 10.0 };
    const FRICTION: Friction = Friction::with_static(0.4, 0.6);
    /// Stuck within its cone: N = 10 N, T = 5 N of 6.
    const STUCK: Instant = Instant {
        gap: 0.0,
        gap_velocity: 0.0,
        slip_velocity: 0.0,
        normal_force: 10.0,
        friction_force: 5.0,
    };
    const SLIPPING: Instant = Instant { slip_velocity: 0.1, friction_force: 4.0, ..STUCK };
    const OPEN: Instant = Instant {
        gap: 1e-3,
        gap_velocity: -0.1,
        slip_velocity: 0.3,
        normal_force: 0.0,
        friction_force: 0.0,
    };

    #[track_caller]
    fn assert_found(instant: Instant, part: Part, size: f64) {
        // The law is symmetric in the direction along the tangent.
        let (slip, friction) = (-instant.slip_velocity, -instant.friction_force);
        let mirrored = Instant { slip_velocity: slip, friction_force: friction, ..instant };
        for instant in [instant, mirrored] {
            let found = residual(&instant, FRICTION, &SCALES);
            assert_eq!(found.part, Some(part), "{found}");
            assert!((found.size - size).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn each_state_that_obeys_the_law_has_no_residual() {
        let reverse = Instant { slip_velocity: -0.2, friction_force: -4.0, ..STUCK };
        let at_limit = Instant { friction_force: -6.0, ..STUCK };
        let opening = Instant { gap: 0.0, gap_velocity: 0.3, ..OPEN };
        for state in [STUCK, at_limit, SLIPPING, reverse, OPEN, opening] {
            assert_eq!(
                residual(&state, FRICTION, &SCALES),
                Violation { size: 0.0, part: None },
                "{state:?}"
            );
        }
    }

    #[test]
    fn penetration_and_what_leads_to_it_are_seen() {
        assert_found(Instant { gap: -2e-5, ..STUCK }, Part::Penetration, 0.02);
        assert_found(Instant { gap_velocity: -0.03, ..STUCK }, Part::Approach, 0.3);
    }

    #[test]
    fn a_contact_that_pulls_is_seen() {
        let pulls = Instant { normal_force: -1.0, friction_force: 0.0, ..STUCK };
        assert_found(pulls, Part::Adhesion, 0.1);
    }

    #[test]
    fn a_force_at_a_distance_is_seen_as_far_as_both_are_above_zero() {
        let near = Instant { gap: 1e-4, ..STUCK };
        assert_found(near, Part::ForceAtADistance, 0.1);
        let light = Instant { gap: 1e-3, normal_force: 0.5, friction_force: 0.2, ..STUCK };
        assert_found(light, Part::ForceAtADistance, 0.05);
        assert_found(Instant { gap_velocity: 0.02, ..STUCK }, Part::ForceAtADistance, 0.2);
    }

    #[test]
    fn friction_above_its_limit_is_seen_also_where_nothing_presses() {
        assert_found(Instant { friction_force: 7.0, ..STUCK }, Part::FrictionLimit, 0.1);
        assert_found(
            Instant { slip_velocity: 0.0, friction_force: 1.0, ..OPEN },
            Part::FrictionLimit,
            0.1,
        );
    }

    #[test]
    fn a_contact_that_slips_under_another_than_its_kinetic_friction_is_seen() {
        // The static limit of 6 N would allow it.
        assert_found(Instant { friction_force: 5.5, ..SLIPPING }, Part::SlidingFriction, 0.15);
        assert_found(Instant { friction_force: 3.0, ..SLIPPING }, Part::SlidingFriction, 0.1);
        let creeping = Instant { slip_velocity: 1e-3, friction_force: 2.0, ..STUCK };
        assert_found(creeping, Part::SlidingFriction, 0.01);
    }

    #[test]
    fn friction_that_feeds_the_slip_is_seen() {
        assert_found(Instant { friction_force: -4.0, ..SLIPPING }, Part::Feeding, 0.8);
        let slow = Instant { slip_velocity: 0.01, friction_force: -4.0, ..SLIPPING };
        assert_found(slow, Part::Feeding, 0.1);
    }

    #[test]
    fn what_is_not_a_number_is_no_state_at_all() {
        for value in [f64::NAN, f64::INFINITY] {
            let found = residual(&Instant { friction_force: value, ..STUCK }, FRICTION, &SCALES);
            assert_eq!(found, Violation { size: f64::INFINITY, part: Some(Part::Finite) });
        }
    }
}
