//! Which effects a scene calls for.

use crate::contact::Law;

/// What is simulated of a scene besides its masses and springs.
///
/// A contact comes with the whole law of contact, for anything less is an idealisation that has to be asked
/// for; everything else is off unless the scene asks for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// May a contact stick? If not, friction keeps the direction that it has in uniform sliding, as the
    /// linearised analysis assumes.
    pub sticking: bool,
    /// May a contact open? If not, it holds in both directions: x_N = 0, N of either sign.
    pub detachment: bool,
    /// Is energy accounted for?
    pub energy: bool,
    /// Is the present contact state's stability looked at?
    pub stability: bool,
    /// Does a part α M of C damp? A value of zero does too: it may be given another.
    pub mass_damping: bool,
    /// Does a part β K of C damp?
    pub stiffness_damping: bool,
    /// Do links join the modules of a ring?
    pub links: bool,
    /// Have the modules of a ring a preload? The springs of a network have one each, or none.
    pub preload: bool,
}

impl Effects {
    /// Does friction of this law keep its direction, so that a slip may be against it?
    #[must_use]
    pub fn has_frozen_slip(&self, law: Law) -> bool {
        !self.sticking && law.info().sticks
    }
}

impl Default for Effects {
    fn default() -> Self {
        Self {
            sticking: true,
            detachment: true,
            energy: false,
            stability: false,
            mass_damping: false,
            stiffness_damping: false,
            links: false,
            preload: false,
        }
    }
}
