//! Contact states and the Signorini–Coulomb law of one contact, without matrices of the structure.
//!
//! Signs: the normal force N ≥ 0 is compressive. The slip velocity is that of the slider against
//! the mass, v_r = v − ẋ_t. The friction force is the one on the mass, along the tangent:
//! T = +µN where v_r > 0, −µN where v_r < 0, any value with |T| ≤ µN where v_r = 0. Where a law has
//! an additional static coefficient, that one applies in the last of the three cases ([`friction`]).

pub mod friction;
mod local;
pub mod residual;

pub use friction::{Friction, FrictionLaw, FrictionRange, Law, LawVisitor};
pub use local::{LocalProblem, LocalSolution};

use crate::Error;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The kinematic state of a contact (paper, section 2.1). The numbers are those of the FMU's enumeration.
///
/// ```
/// use amontons::contact::ContactState::{Slide, Stick};
/// use amontons::contact::{all_states, parse_states};
///
/// assert_eq!(parse_states("Sl-St", 2)?, [Slide, Stick]);
/// assert_eq!(all_states(2).count(), 16);
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum ContactState {
    /// v_r > 0: the slider overtakes the mass; T = +µN.
    Slide = 1,
    /// v_r < 0: the mass overtakes the slider; T = −µN.
    ReverseSlide = 2,
    /// v_r = 0: the mass moves with the slider; |T| ≤ µN, with the static coefficient.
    Stick = 3,
    /// The contact is open: N = T = 0.
    Detached = 4,
}

impl ContactState {
    /// All four states, in the paper's order.
    pub const ALL: [Self; 4] = [Self::Slide, Self::ReverseSlide, Self::Stick, Self::Detached];

    /// The direction of the friction force on a sliding mass: +1 or −1; `None` in the other states.
    #[must_use]
    pub fn sliding_direction(self) -> Option<f64> {
        match self {
            Self::Slide => Some(1.0),
            Self::ReverseSlide => Some(-1.0),
            Self::Stick | Self::Detached => None,
        }
    }
}

/// The parts of the law of contact that are in force. The step does not evaluate the parts that are left out.
///
/// ```
/// use amontons::contact::ContactState::{Detached, Stick};
/// use amontons::contact::{ContactLaw, Law};
///
/// let law = ContactLaw { friction: Law::Coulomb, sticking: true, detachment: false };
/// assert!(law.allows(Stick) && !law.allows(Detached));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ContactLaw {
    /// The law of friction.
    pub friction: Law,
    /// `true` if contacts can stick. Otherwise friction keeps the direction of uniform sliding: that of the surface's
    /// velocity.
    pub sticking: bool,
    /// `true` if contacts can open. Otherwise they hold in both directions: x_N = 0, N of either sign. Friction that
    /// can stick then follows |N|.
    pub detachment: bool,
}

impl Default for ContactLaw {
    /// The whole law, with both coefficients of friction.
    fn default() -> Self {
        Self { friction: Law::StaticKinetic, sticking: true, detachment: true }
    }
}

impl ContactLaw {
    /// `true` if sticking or detachment, which the motion might need, is left out.
    #[must_use]
    pub fn is_reduced(self) -> bool {
        !self.sticking || !self.detachment
    }

    /// `true` if closed contacts keep their state whatever their slip velocity is.
    #[must_use]
    pub fn has_fixed_state(self) -> bool {
        !(self.sticking && self.friction.info().sticks)
    }

    /// `true` if the law lets a contact be in this state.
    #[must_use]
    pub fn allows(self, state: ContactState) -> bool {
        match state {
            ContactState::Slide => true,
            ContactState::ReverseSlide => self.friction.info().sticks,
            ContactState::Stick => !self.has_fixed_state(),
            ContactState::Detached => self.detachment,
        }
    }

    /// `true` if friction has a fixed direction, which a slip may oppose.
    #[must_use]
    pub fn has_fixed_direction(self) -> bool {
        !self.sticking && self.friction.info().sticks
    }

    /// `true` if friction follows |N|: contacts can stick and cannot open. A contact state then has no linear motion.
    #[must_use]
    pub fn follows_size(self) -> bool {
        !self.has_fixed_state() && !self.detachment
    }

    /// The fixed state of closed contacts on a surface with this velocity, m/s; `None` if the law lets them change it.
    #[must_use]
    pub fn fixed_state(self, surface: f64) -> Option<ContactState> {
        let has_direction = self.friction.info().sticks;
        self.has_fixed_state().then_some(if has_direction && surface <= 0.0 {
            ContactState::ReverseSlide
        } else {
            ContactState::Slide
        })
    }
}

/// Writes the abbreviation that the paper uses.
impl fmt::Display for ContactState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Slide => "Sl",
            Self::ReverseSlide => "R-Sl",
            Self::Stick => "St",
            Self::Detached => "Dt",
        })
    }
}

/// Several contact states, displayed joined as in the paper: `Sl-St`.
pub struct JoinedStates<'a>(pub &'a [ContactState]);

impl fmt::Display for JoinedStates<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, state) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("-")?;
            }
            state.fmt(f)?;
        }
        Ok(())
    }
}

/// Parses the states of `contacts` contacts from their joined names; one name alone stands for all.
///
/// # Errors
/// Returns an error that describes the expected names.
pub fn parse_states(text: &str, contacts: usize) -> Result<Vec<ContactState>, Error> {
    let wish = || {
        let several = format!(" for all {contacts} contacts, or one for each, joined as in Sl-St");
        let several = if contacts > 1 { &*several } else { "" };
        Error::argument(format!(
            "{text} is not a contact state: give one of Sl, R-Sl, St, Dt{several}"
        ))
    };
    let mut states = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let known = ContactState::ALL.into_iter().find_map(|state| {
            let rest = rest.strip_prefix(&state.to_string())?;
            let next = rest.strip_prefix('-').filter(|next| !next.is_empty());
            let rest = if rest.is_empty() { rest } else { next? };
            Some((state, rest))
        });
        let state;
        (state, rest) = known.ok_or_else(wish)?;
        states.push(state);
    }
    match states[..] {
        [state] => Ok(vec![state; contacts]),
        _ if states.len() == contacts => Ok(states),
        _ => Err(wish()),
    }
}

/// All 4ⁿ states of `contacts` contacts, the last contact changing fastest.
pub fn all_states(contacts: u32) -> impl Iterator<Item = Vec<ContactState>> {
    (0..4_usize.pow(contacts)).map(move |number| {
        (0..contacts).rev().map(|contact| ContactState::ALL[number >> (2 * contact) & 3]).collect()
    })
}

/// The state and the forces of a contact at one instant.
///
/// ```
/// use amontons::simulation::Simulation;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let mut simulation = Simulation::new(scene, 0.0)?;
/// for contact in simulation.contact_forces()? {
///     assert!(contact.normal_force > 0.0, "{contact:?}");
/// }
/// # Ok::<(), amontons::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// The state of the contact.
    pub state: ContactState,
    /// Normal force N ≥ 0, compressive, N.
    pub normal_force: f64,
    /// Friction force T on the mass along the tangent, N.
    pub friction_force: f64,
    /// Slip velocity v_r = v − ẋ_t, m/s.
    pub slip_velocity: f64,
}

impl ContactForce {
    /// The values of an open contact.
    #[must_use]
    pub fn detached(slip_velocity: f64) -> Self {
        Self {
            state: ContactState::Detached,
            normal_force: 0.0,
            friction_force: 0.0,
            slip_velocity,
        }
    }
}

/// The inputs for the friction of a closed contact, to be evaluated under a law known at compile time.
struct Closing {
    friction: Friction,
    surface: f64,
    normal_force: f64,
    slip_velocity: f64,
    holding_force: f64,
    detachment: bool,
}

impl LawVisitor for Closing {
    type Output = ContactForce;

    fn under<L: FrictionLaw>(self) -> ContactForce {
        let Self { normal_force, slip_velocity, holding_force, .. } = self;
        let is_still = slip_velocity == 0.0;
        let before = if is_still { ContactState::Stick } else { ContactState::Slide };
        let law = L::new(self.friction, self.surface).at(slip_velocity, before);
        let follows_size = L::STICKS && !self.detachment;
        let size = if follows_size { normal_force.abs() } else { normal_force };
        let (friction_force, state) = if !L::STICKS || slip_velocity.abs() > 0.0 {
            law.slip(slip_velocity, size)
        } else if law.holds(holding_force, size, ContactState::Stick) {
            (holding_force, ContactState::Stick)
        } else {
            law.slip(holding_force, size)
        };
        // A force of zero has no negative sign.
        let friction_force = friction_force + 0.0;
        ContactForce { state, normal_force, friction_force, slip_velocity }
    }
}

impl ContactLaw {
    /// The values of a closed contact that presses with `normal_force` on a surface of velocity `surface` (m/s) and
    /// needs `holding_force` to keep its tangential velocity. A contact that does not slip may stick; one that slips
    /// may not.
    #[must_use]
    pub fn closed(
        self,
        friction: Friction,
        surface: f64,
        normal_force: f64,
        slip_velocity: f64,
        holding_force: f64,
    ) -> ContactForce {
        let Self { friction: law, sticking, detachment } = self;
        law.apply(
            sticking,
            Closing { friction, surface, normal_force, slip_velocity, holding_force, detachment },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_enumerated_once_each_in_the_papers_order() {
        let names: Vec<String> =
            all_states(2).map(|states| JoinedStates(&states).to_string()).collect();
        assert_eq!(names.len(), 16);
        assert_eq!(names[..5], ["Sl-Sl", "Sl-R-Sl", "Sl-St", "Sl-Dt", "R-Sl-Sl"]);
        assert_eq!(names[15], "Dt-Dt");
    }

    #[test]
    fn names_of_states_read_back() {
        for states in all_states(2) {
            assert_eq!(parse_states(&JoinedStates(&states).to_string(), 2), Ok(states));
        }
        assert_eq!(parse_states("R-Sl", 3), Ok(vec![ContactState::ReverseSlide; 3]));
        for wrong in ["", "Sl-", "Sl-St-Dt", "sl", "SlSt", "-Sl"] {
            assert!(parse_states(wrong, 2).is_err(), "{wrong}");
        }
    }

    #[test]
    fn friction_never_feeds_a_slipping_contact() {
        for slip in [-0.3, 0.3] {
            let force = ContactLaw::default().closed(0.5.into(), 0.1, 10.0, slip, 1e3);
            // The slider drags the mass along: the power lost in the contact is T·v_r.
            assert!(force.friction_force * slip > 0.0);
        }
    }
}
