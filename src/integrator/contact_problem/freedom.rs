//! What a contact may do, by the law that the scene calls for.

use crate::contact::{ContactLaw, ContactState, Friction, FrictionLaw, FrictionRange, UnderLaw};

/// What a contact may do in the problem at hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) enum Freedom {
    /// Anything that its law allows, with friction in this range where it holds.
    Law(FrictionRange),
    /// Open for sure: it carries nothing.
    Open,
    /// Slipping for sure, with µ_k in this direction (±1).
    Slipping {
        /// Of the friction force on the mass.
        direction: f64,
        /// µ_k.
        friction: f64,
    },
    /// Held in both directions along its normal; friction, in this range where it holds, follows |N|.
    Held(FrictionRange),
    /// Held in both directions along its normal, and slipping for sure, with µ_k in this direction (±1).
    HeldSlipping {
        /// Of the friction force on the mass.
        direction: f64,
        /// µ_k.
        friction: f64,
    },
    /// Held along normal and tangent, whatever that takes.
    Fixed,
    /// Held in both directions along its normal, with T = `slope` N.
    Guided {
        /// ±µ.
        slope: f64,
        /// The state that it is said to be in.
        state: ContactState,
    },
}

impl Freedom {
    /// `true` of a contact that is held in both directions of its normal, so that it presses or pulls.
    pub fn is_held(&self) -> bool {
        matches!(self, Self::Held(_) | Self::HeldSlipping { .. })
    }

    /// The sign of the normal force: −1 of a contact that is held and pulls.
    pub fn sign(&self, pulls: bool) -> f64 {
        if pulls && self.is_held() { -1.0 } else { 1.0 }
    }

    /// The state of a contact that is closed and carries nothing.
    pub(in crate::integrator) fn closed_state(&self) -> ContactState {
        match *self {
            Self::Slipping { direction, .. } | Self::HeldSlipping { direction, .. } => {
                if direction > 0.0 { ContactState::Slide } else { ContactState::ReverseSlide }
            }
            Self::Guided { state, .. } => state,
            Self::Law(_) | Self::Held(_) | Self::Fixed | Self::Open => ContactState::Stick,
        }
    }

    /// Gives friction that may be static in this direction (±1) its kinetic limit; is that another one?
    pub(super) fn let_go(&mut self, direction: f64) -> bool {
        match self {
            Self::Law(range) | Self::Held(range) if range.limit(direction) > range.kinetic => {
                *range.limit_mut(direction) = range.kinetic;
                true
            }
            _ => false,
        }
    }

    /// This freedom with lower limits of the friction that holds: each is lower by `part` of itself.
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

    /// This freedom once the contact slips for sure, with friction in this direction (±1).
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

/// The freedom of a contact with these numbers, with a slip velocity (m/s), on a surface that moves with a
/// velocity (m/s), that was in this state.
pub(in crate::integrator) type FreedomOf = fn(Friction, f64, f64, ContactState) -> Freedom;

/// The freedom that contacts have under this law.
pub(in crate::integrator) fn freedom_of(law: ContactLaw) -> FreedomOf {
    law.friction.apply(law.sticking, Choice { detachment: law.detachment })
}

struct Choice {
    detachment: bool,
}

impl UnderLaw for Choice {
    type Output = FreedomOf;

    fn under<L: FrictionLaw>(self) -> FreedomOf {
        if self.detachment { freedom::<L, true> } else { freedom::<L, false> }
    }
}

fn freedom<L: FrictionLaw, const DETACHMENT: bool>(
    friction: Friction,
    slip: f64,
    surface: f64,
    before: ContactState,
) -> Freedom {
    let law = L::new(friction, surface).at(slip, before);
    if L::STICKS {
        let range = law.range(before);
        return if DETACHMENT { Freedom::Law(range) } else { Freedom::Held(range) };
    }
    let (slope, state) = law.slip(slip, 1.0);
    if DETACHMENT {
        let direction = state.sliding_direction().unwrap_or(1.0);
        Freedom::Slipping { direction, friction: slope.abs() }
    } else {
        Freedom::Guided { slope, state }
    }
}
