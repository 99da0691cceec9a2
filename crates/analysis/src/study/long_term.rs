//! The ending of a motion: rest, a motion of some kind for ever, or growth without bound.
//!
//! # What is measured
//!
//! A motion is observed in windows, one after the other
//! ([`ObservationSettings`](super::observation::ObservationSettings)). These are known of each window:
//!
//! - its *size*, m: root mean square, about its mean, of y = Σ_i w_i x_i, a mixture of all displacements with
//!   w_i = 1/2 + frac(0.618 i), so that nothing hides where one output does not see it. Rows have the weights of a
//!   Blackman–Harris window;
//! - its *lines*: frequencies and amplitudes of y. Lines nearer than the *resolution*, 4 / window, are not told apart;
//! - whether a contact changed its state, and whether all contacts are in states in which the scene can rest;
//! - the growth rate of the linear motion in the present contact states: the largest real part of an eigenvalue. It
//!   counts from 1e-9 of the fastest mode's angular frequency on. There is none where friction depends on the slip
//!   velocity.
//!
//! Two more quantities of a motion that has settled need runs of their own:
//!
//! - its *closure*: the time T after which the whole state comes back, and the distance of the states at t and t + T,
//!   root mean square over a period, in parts of the motion's size (`recurrence`);
//! - its *parting*: how the distance to a neighbour grows that starts 1e-9 of the motion's size away (`separation`).
//!
//! # How the kind is decided
//!
//! At the end of each window the first of these rules applies. The *last window* is the one that ends at the longest
//! time.
//!
//! 1. **Wait**: the window began before the last edge of a signal (windows count anew from there; rule 3 is tried all
//!    the same). Or no signal drives the motion, and in the whole window contacts kept states in which the scene
//!    cannot rest: a surface carries a mass along, or a mass flies.
//! 2. **Equilibrium**, if the drive is constant, or has a period of at most a window or of as many windows as nothing
//!    has moved:
//!    - nothing at all moved, whatever eigenvalues say; or
//!    - contacts are in states of rest, and no eigenvalue grows, and the size is rounding (1e-12 of the
//!      displacements), or without a drive tends to zero over four windows, the last three without a change of state;
//!      or
//!    - in states of rest without a drive, all eigenvalues decay, and the size has fallen over two windows without a
//!      change of state; or
//!    - under a drive, the size was rounding for four windows and no eigenvalue grows, although contacts change their
//!      states; or
//!    - under a drive, in states of rest, the size tends to zero like a power of time (`windows`).
//! 3. **Unbounded**, without a drive: no contact can change its state any more, and an eigenvalue grows; or
//!    displacements and velocities are more than 1e6 times those of the equilibrium and the surfaces, and the size
//!    has grown by at least 1 % and about the same factor over each of three windows.
//! 4. **Quasi-periodic**, every 12th window and the last: signals without a common period of at most 100 windows
//!    drive the motion, and neighbours come together, which exact motion alone can show.
//! 5. **Wait**, if neither size and lines are the same over four windows, nor contacts change their states and the
//!    size varies without a trend over 12 windows (in the last window, over 24 or 48 too).
//! 6. **Undecided**: y has no line; or the scheme moves by more than 2e-3 of the motion's size in one step, too far
//!    to tell the kinds apart.
//! 7. **Periodic**: the state comes back after a shortest period, to 1e-6 of the motion's size or rounding; or it
//!    comes back to 2e-3, and nearer over six windows by about the same factor. By the paper's scheme, whose events
//!    are late by up to a step, coming back within the way of four steps is enough. A state that comes back to 2e-3
//!    and no nearer makes the motion wait for the last window. A search in vain is repeated every fourth window, and
//!    with a drive whose period is longer than a window every 12th.
//! 8. The rest is decided every 12th window and in the last:
//!    - **irregular**: neighbours part exponentially;
//!    - **periodic**: neighbours come together under a drive with a common period, and the state comes back, to 1e-6,
//!      after a multiple of that period within 100 windows;
//!    - **quasi-periodic**: neighbours stay near over 32 windows, the search for a period was complete, no return was
//!      within the way of ten steps of the scheme, and the strong lines combine two frequencies, or the state never
//!      came back to 2e-3 and the size does not vary less and less. If the lines beside the strongest one and its
//!      multiples fade meanwhile, the motion waits, and is **unsettled** in the last window;
//!    - **undecided** in the last window, and waiting before it: none of these could be shown.
//!
//! A motion that still waits after the last window is **unsettled**.
//!
//! # Thresholds
//!
//! | threshold | meaning |
//! | --- | --- |
//! | size within 1e-3 of the window before; if it drifts one way over four windows, less than 2e-3 left to go | the size is the same |
//! | line within 0.1 of the resolution, amplitude within 1 % | a strong line (above 1 % of the strongest) is the same in two windows |
//! | 1e-4 of the strongest line | fainter lines may grow unseen |
//! | limit by Aitken's extrapolation, up to 0.2 of the last size | sizes tend to zero |
//! | 1e-6 of the motion's size | a state that comes back as near is the same |
//! | 2e-3 of the motion's size | a state that does not come back as near does not come back |
//! | the way of 4 and of 10 steps of the scheme | up to 4 a return may be late events, beyond 10 it is none; between them it is open |
//! | 64 periods of the strongest line and of the drive, 100 windows | no longer period is looked for |
//! | factor 30, or less than 6, from one half of the time to the next | neighbours part exponentially, or in proportion to time at most |
//!
//! # What is not guaranteed
//!
//! - The thresholds are conventions, checked against motions whose kind is known, not bounds of an error.
//! - A motion that changes only after the longest time, a slow mode that grows below 1e-4 of the strongest line, or a
//!   period above 64 periods is not seen.
//! - The rate of `separation` is that of one stretch of the motion, no Lyapunov exponent with an error.
//! - The kind does not depend on the output that is looked at. Closure and parting are found in the motion itself,
//!   between rows too; a return is seen if the rows beside it are near enough (`recurrence`).

use super::recurrence::Closure;
use super::separation::MOST_WINDOWS_APART;
use crate::spectral::{Line, Lines};
use amontons::contact::ContactState;
use serde::{Deserialize, Serialize};

/// The most lines of a motion that are listed.
const MOST_LINES: usize = 8;
/// A line has no frequency of its own if another one within the resolution has at least this part of its amplitude.
const BLURRING: f64 = 0.05;

/// The kind of motion that a motion ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The motion rests, or decays to rest.
    Equilibrium,
    /// The whole state of the motion comes back after a period.
    Periodic,
    /// The state of the motion does not come back within 64 periods of its strongest line and of its signals
    /// together, and neighbouring motions do not part exponentially over 32 windows. Signals that have no common
    /// period below 100 windows count as having none.
    QuasiPeriodic,
    /// The state of the motion does not come back, and neighbouring motions part exponentially.
    Irregular,
    /// The motion continues with a steady size, but none of the other kinds could be shown.
    Undecided,
    /// The motion grows, and nothing in the scene can stop it: it leaves the range in which the model holds.
    Unbounded,
    /// The motion had not settled when it was left.
    Unsettled,
}

impl Kind {
    /// Name of the kind in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Equilibrium => "equilibrium",
            Self::Periodic => "periodic",
            Self::QuasiPeriodic => "quasi-periodic",
            Self::Irregular => "irregular",
            Self::Undecided => "undecided",
            Self::Unbounded => "unbounded",
            Self::Unsettled => "unsettled",
        }
    }

    /// `true` of a motion that has settled and does not rest.
    #[must_use]
    pub const fn is_cycle(self) -> bool {
        matches!(self, Self::Periodic | Self::QuasiPeriodic | Self::Irregular | Self::Undecided)
    }
}

/// The ending of a motion.
///
/// Amplitude, extents and shares of a periodic motion are found over one period, those of another persisting motion
/// over a window after the last one, all in the motion itself; those of a motion that rests or has not settled are
/// found in the rows of the last window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LongTermMotion {
    /// The kind of the motion.
    pub kind: Kind,
    /// Half of the difference between the output's largest and smallest value, in its unit; 0 of an equilibrium.
    pub amplitude: f64,
    /// Frequency of the output's strongest line, Hz; `None` where nothing oscillates, or where the motion has not
    /// settled and its lines may still change.
    pub frequency: Option<f64>,
    /// Time after which the whole state of a periodic motion comes back, s.
    pub period: Option<f64>,
    /// Distance of the state of a motion with a period from itself after that period, root mean square over a period,
    /// in parts of the motion's size; 0 is exact.
    #[serde(default)]
    pub closure: Option<f64>,
    /// `true` of a quasi-periodic motion whose strong lines are all combinations of two frequencies.
    #[serde(default)]
    pub two_frequencies: bool,
    /// `true` of a quasi-periodic motion that follows signals without a common period: neighbouring motions come
    /// together.
    #[serde(default)]
    pub follows: bool,
    /// For an undecided motion, the longest step of the paper's scheme, s, that can tell its kind, where the steps
    /// were longer.
    #[serde(default)]
    pub longest_step: Option<f64>,
    /// The rate at which neighbours of an irregular motion part, 1/s.
    #[serde(default)]
    pub parting: Option<f64>,
    /// The output's strongest lines, the strongest first: frequency, Hz, and amplitude in its unit.
    pub lines: Vec<[f64; 2]>,
    /// The part of the time for which contacts are in each state, all contacts together, in the order of
    /// [`ContactState::ALL`](amontons::contact::ContactState::ALL).
    pub shares: [f64; 4],
    /// `true` for each state that a contact took, also between the rows.
    pub taken: [bool; 4],
    /// `true` for each state that contacts of a periodic motion take ever more briefly, so that in the end they take
    /// it no more: as where slips get shorter for ever.
    #[serde(default)]
    pub fading: [bool; 4],
    /// Time since the motion was first observed, s.
    pub time: f64,
    /// Rate at which the motion still grew or, below zero, decayed at the end, 1/s: for a linear motion the growth
    /// rate of its fastest growing mode. 0 where signals drive it on.
    pub rate: f64,
    /// `true` for a small motion about the equilibrium that persists with whatever size it has: contacts were in the
    /// states of rest throughout the last window, their forces are linear, and motions of every size near this one
    /// are possible. `false` where the motion is driven and all else decays, and for the largest motion of such a
    /// family.
    #[serde(default)]
    pub linear: bool,
    /// Size of the motion of all degrees of freedom together, m: root mean square of a mixture of their displacements.
    #[serde(default)]
    pub size: f64,
    /// Variation of `size` over the last windows, logarithm of the largest by the smallest.
    #[serde(default)]
    pub scatter: f64,
    /// Half of the difference between the largest and the smallest displacement of each degree of freedom, m.
    #[serde(default)]
    pub extents: Vec<f64>,
}

impl LongTermMotion {
    /// The largest of its [`extents`](Self::extents), m; 0 without any.
    pub(super) fn largest_extent(&self) -> f64 {
        self.extents.iter().copied().fold(0.0, f64::max)
    }

    /// `true` if it had settled, or was seen to leave rest or to come to it.
    #[must_use]
    pub fn is_known(&self) -> bool {
        match self.kind {
            Kind::Equilibrium | Kind::Unbounded => true,
            Kind::Unsettled => self.linear && self.rate != 0.0,
            _ => !self.linear,
        }
    }

    /// `true` if it rests, or was left on its way to rest.
    #[must_use]
    pub fn rests(&self) -> bool {
        self.kind == Kind::Equilibrium
            || self.kind == Kind::Unsettled && self.rate < 0.0 && self.linear
    }

    /// The evidence for the kind, in words; `None` where the kind needs none.
    #[must_use]
    pub fn evidence(&self) -> Option<String> {
        if let (Kind::Undecided, Some(step)) = (self.kind, self.longest_step) {
            return Some(format!(
                "the paper's scheme detects changes of contact state only at the ends of its steps, too coarsely to decide if \
                 the state returns; a --step of {:.1e} or less may decide",
                0.95 * step
            ));
        }
        match (self.kind, self.period, self.closure, self.parting) {
            (Kind::Periodic, Some(period), Some(closure), _) => Some(format!(
                "the state returns after {period:.6e} s to within {closure:.1e} of the motion's size"
            )),
            (Kind::QuasiPeriodic | Kind::Undecided, ..) if self.linear => Some(
                "no contact changes its state, and modes neither grow nor decay: the motion is the sum of these modes, of any \
                 amplitude, and of the response to signals; the state returns only if all frequencies are multiples of \
                 one frequency; amontons-stability states prints the frequencies of the modes"
                    .to_owned(),
            ),
            (Kind::QuasiPeriodic, ..) if self.follows => Some(
                "neighbouring motions converge: the motion follows its signals, which have no common period, or one of more \
                 than 100 windows"
                    .to_owned(),
            ),
            (Kind::QuasiPeriodic, ..) if !self.two_frequencies => Some(format!(
                "the state does not return within 64 periods, and neighbouring motions do not diverge over \
                 {MOST_WINDOWS_APART} windows; not all strong spectral lines are combinations of two frequencies: there \
                 are more independent frequencies, or combinations of high order"
            )),
            (Kind::QuasiPeriodic, ..) => Some(format!(
                "the state does not return within 64 periods, neighbouring motions do not diverge over \
                 {MOST_WINDOWS_APART} windows, and all strong spectral lines are combinations of two frequencies"
            )),
            (Kind::Irregular, .., Some(rate)) => Some(format!(
                "neighbouring motions diverge as e^({rate:.0e} t/s), estimated from one part of the motion: in other parts \
                 the rate may be half or twice as large"
            )),
            (Kind::Undecided, Some(period), Some(closure), _) => Some(format!(
                "the state returns after {period:.6e} s to within {closure:.1e} of the motion's size, but no closer; a longer \
                 --window or --longest, or another --step of the paper's scheme, may decide"
            )),
            (Kind::Undecided, ..) => Some(
                "it is not known if the state returns, if neighbouring motions diverge, or if all spectral lines are \
                 combinations of two frequencies; a longer --window may decide"
                    .to_owned(),
            ),
            _ => None,
        }
    }

    /// Removes the remaining motion: at its end it rests in these contact states.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn come_to_rest(&mut self, states: &[ContactState]) {
        (self.amplitude, self.frequency) = (0.0, None);
        self.lines.clear();
        self.extents.fill(0.0);
        self.taken = [false; 4];
        self.shares = [0.0; 4];
        for state in states {
            self.taken[*state as usize - 1] = true;
            self.shares[*state as usize - 1] += 1.0 / states.len() as f64;
        }
    }

    /// Takes over the strongest of these lines.
    pub(super) fn take_lines(&mut self, found: &Lines) {
        let strongest = found.lines.first().filter(|line| is_told_apart(line, found));
        self.frequency = strongest.map(|line| line.frequency);
        let lines = found.lines.iter().take(MOST_LINES);
        self.lines = lines.map(|line| [line.frequency, line.amplitude]).collect();
    }

    /// Takes over the period and the closure of a periodic motion.
    pub(super) fn come_back(&mut self, Closure { period, distance, .. }: Closure) {
        (self.period, self.closure) = (Some(period), Some(distance));
        // A line of a periodic motion is a multiple of its base frequency.
        let exact = |frequency: f64| match (frequency * period).round() {
            0.0 => frequency,
            multiple => multiple / period,
        };
        if self.kind == Kind::Periodic {
            self.frequency = self.frequency.map(exact);
            self.lines.iter_mut().for_each(|line| line[0] = exact(line[0]));
        }
    }
}

/// `true` if no other line that counts beside this one lies so near that they have shifted each other.
fn is_told_apart(line: &Line, found: &Lines) -> bool {
    let blurs = |other: &&Line| {
        other.frequency != line.frequency
            && (other.frequency - line.frequency).abs() <= found.resolution
            && other.amplitude >= BLURRING * line.amplitude
    };
    !found.lines.iter().any(|other| blurs(&other))
}
