//! Counts of the events that a judge could not judge.

use super::Run;
use std::ops::AddAssign;

/// Counts of the judged parts of a run and of those that were let off. A run that lets anything off fails, unless its
/// caller takes the counts and holds them to a bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LetOff {
    /// Steps that were judged.
    pub steps: u64,
    /// Changes of state that were judged, impacts among them, and contacts that began to slip.
    pub changes: u64,
    pub impacts: u64,
    pub releases: u64,
    /// Let off: steps within which the velocity of a slider bends, or turns round where friction has its direction, while a contact
    /// changes its state.
    pub bent: u64,
    /// Let off: steps that ended elsewhere than the way that was judged, since rounding decided what followed on a change.
    pub forks: u64,
    /// Let off: what is left of a step after more changes than are followed.
    pub crowded: u64,
    /// Let off: the short time from a change that rounding hides from short steps to the first one that sees it.
    pub turned: u64,
    /// Let off but for what happens at their ends: times in which redundant contacts share their load as they like, and the
    /// motion depends on it.
    pub undetermined: u64,
    /// Let off: contacts on masses that they share which slip from a step of the paper's scheme on, and could
    /// have held if all others had gone on in their states.
    pub coupled: u64,
    /// Let off: steps of exact motion in which hops were ended before they began.
    pub ended: u64,
}

impl LetOff {
    /// All that was let off.
    pub fn total(&self) -> u64 {
        self.bent
            + self.forks
            + self.crowded
            + self.turned
            + self.undetermined
            + self.coupled
            + self.ended
    }
}

impl AddAssign for LetOff {
    fn add_assign(&mut self, other: Self) {
        let Self { steps, changes, impacts, releases, forks, .. } = other;
        let Self { bent, crowded, turned, undetermined, coupled, ended, .. } = other;
        self.steps += steps;
        self.changes += changes;
        self.impacts += impacts;
        self.releases += releases;
        self.forks += forks;
        self.bent += bent;
        self.crowded += crowded;
        self.turned += turned;
        self.undetermined += undetermined;
        self.coupled += coupled;
        self.ended += ended;
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let is_silent = self.let_off.total() > 0 && !std::thread::panicking();
        assert!(!is_silent, "some of a run was not judged: {:?}", self.let_off);
    }
}
