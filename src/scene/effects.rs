//! The effects that a scene includes.

use crate::contact::Law;

/// Effects of a scene that are simulated besides its masses and springs.
///
/// A contact has the whole law of contact by default, since anything less is an idealisation that a scene has to
/// request; all other effects are off by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// `true` if contacts may stick. If `false`, friction keeps the direction that it has in uniform sliding, as the
    /// linearised analysis assumes.
    pub sticking: bool,
    /// `true` if contacts may open. If `false`, contacts are bilateral: x_N = 0, with N of either sign.
    pub detachment: bool,
    /// `true` if the run keeps an energy ledger.
    pub energy: bool,
    /// `true` if the run analyses the stability of the present contact state.
    pub stability: bool,
    /// `true` if C has a part α M. It may be zero at first, since α can change during a run.
    pub mass_damping: bool,
    /// `true` if C has a part β K. It may be zero at first, since β can change during a run.
    pub stiffness_damping: bool,
    /// `true` if links join the modules of a ring.
    pub links: bool,
    /// `true` if the modules of a ring have a preload. In a network each spring has its own, or none.
    pub preload: bool,
}

impl Effects {
    /// Returns `true` if friction of this law keeps its direction, so that the slip may oppose it.
    #[must_use]
    pub fn has_fixed_direction(&self, law: Law) -> bool {
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
