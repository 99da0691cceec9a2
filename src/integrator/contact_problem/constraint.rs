//! Constraints of a contact under the law of the scene.

use crate::contact::{ContactLaw, ContactState, Friction, FrictionLaw, FrictionRange, LawVisitor};

/// The constraint of a contact in the present problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) enum ContactConstraint {
    /// The full law of the contact, with friction in this range where it holds.
    Law(FrictionRange),
    /// An open contact, which carries no force.
    Open,
    /// A slipping contact, with µ_k in this direction (±1).
    Slipping {
        /// Direction of the friction force on the mass.
        direction: f64,
        /// Kinetic coefficient µ_k.
        friction: f64,
    },
    /// Held in both directions along its normal; friction, in this range where it holds, follows |N|.
    Held(FrictionRange),
    /// Held in both directions along its normal, and slipping, with µ_k in this direction (±1).
    HeldSlipping {
        /// Direction of the friction force on the mass.
        direction: f64,
        /// Kinetic coefficient µ_k.
        friction: f64,
    },
    /// Held along normal and tangent by forces without a limit.
    Fixed,
    /// Held in both directions along its normal, with T = `slope` N.
    Guided {
        /// Ratio T/N = ±µ.
        slope: f64,
        /// The state that the contact is given.
        state: ContactState,
    },
}

impl ContactConstraint {
    /// `true` if the contact is held in both directions of its normal, so that it presses or pulls.
    pub fn is_held(&self) -> bool {
        matches!(self, Self::Held(_) | Self::HeldSlipping { .. })
    }

    /// The sign of the normal force: −1 for a contact that is held and pulls.
    pub fn sign(&self, pulls: bool) -> f64 {
        if pulls && self.is_held() { -1.0 } else { 1.0 }
    }

    /// The state of the contact when it is closed and carries no force.
    pub(in crate::integrator) fn closed_state(&self) -> ContactState {
        match *self {
            Self::Slipping { direction, .. } | Self::HeldSlipping { direction, .. } => {
                if direction > 0.0 { ContactState::Slide } else { ContactState::ReverseSlide }
            }
            Self::Guided { state, .. } => state,
            Self::Law(_) | Self::Held(_) | Self::Fixed | Self::Open => ContactState::Stick,
        }
    }

    /// Replaces a static limit of friction in this direction (±1) by the kinetic one; `true` if that changes the limit.
    pub(super) fn release_to_kinetic_friction(&mut self, direction: f64) -> bool {
        match self {
            Self::Law(range) | Self::Held(range) if range.limit(direction) > range.kinetic => {
                *range.limit_mut(direction) = range.kinetic;
                true
            }
            _ => false,
        }
    }

    /// This constraint with lower limits of the friction that holds the contact: each is reduced by `part` of itself.
    pub(in crate::integrator) fn below_limits(self, part: f64) -> Self {
        let below = |range: FrictionRange| FrictionRange {
            backward: (1.0 - part) * range.backward,
            forward: (1.0 - part) * range.forward,
            ..range
        };
        match self {
            Self::Law(range) => Self::Law(below(range)),
            Self::Held(range) => Self::Held(below(range)),
            other => other,
        }
    }

    /// This constraint once the contact slips, with friction in this direction (±1).
    pub(in crate::integrator) fn slipping(self, direction: f64) -> Self {
        match self {
            Self::Law(range) => Self::Slipping { direction, friction: range.kinetic },
            Self::Held(range) => Self::HeldSlipping { direction, friction: range.kinetic },
            Self::Open
            | Self::Slipping { .. }
            | Self::HeldSlipping { .. }
            | Self::Fixed
            | Self::Guided { .. } => self,
        }
    }
}

/// Returns the constraint of a contact from its friction, its slip velocity (m/s), the velocity of its surface (m/s), and
/// its state before.
pub(in crate::integrator) type ConstraintOf =
    fn(Friction, f64, f64, ContactState) -> ContactConstraint;

/// The constraint of contacts under this law.
pub(in crate::integrator) fn constraint_of(law: ContactLaw) -> ConstraintOf {
    law.friction.apply(law.sticking, Choice { detachment: law.detachment })
}

struct Choice {
    detachment: bool,
}

impl LawVisitor for Choice {
    type Output = ConstraintOf;

    fn under<L: FrictionLaw>(self) -> ConstraintOf {
        if self.detachment { constraint::<L, true> } else { constraint::<L, false> }
    }
}

fn constraint<L: FrictionLaw, const DETACHMENT: bool>(
    friction: Friction,
    slip: f64,
    surface: f64,
    before: ContactState,
) -> ContactConstraint {
    let law = L::new(friction, surface).at(slip, before);
    if L::STICKS {
        let range = law.range(before);
        return if DETACHMENT {
            ContactConstraint::Law(range)
        } else {
            ContactConstraint::Held(range)
        };
    }
    let (slope, state) = law.slip(slip, 1.0);
    if DETACHMENT {
        let direction = state.sliding_direction().unwrap_or(1.0);
        ContactConstraint::Slipping { direction, friction: slope.abs() }
    } else {
        ContactConstraint::Guided { slope, state }
    }
}
