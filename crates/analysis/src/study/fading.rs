//! Contact states that a periodic motion takes ever more briefly, and in the end not at all.
//!
//! A mass that friction holds but for short slips may creep to a place from which it slips no more. It comes there
//! like a power of time, so that its slips get shorter for ever. What lasts, and what fades, shows from one doubling
//! of time to the next.
//!
//! If no share of the time falls by 3e-3 in a window more, all stay. Otherwise the time since the motion began is
//! doubled. With the shares a, b, c of a state at the last three times, the state
//!
//! - fades if c = 0, or if a, b, c [tend to zero](tends_to_zero);
//! - stays if c ≥ (1 − 3e-3) b, or if Aitken's [`limit`] of a, b, c is at least c/2;
//! - is open otherwise, and the time is doubled again, up to the longest time. A share that is open then counts as one
//!   that stays.

use super::period::{OverSpan, over_span};
use crate::sweep::steady::{limit, tends_to_zero};
use amontons::Error;
use amontons::simulation::{Simulation, Variable};
use std::ops::ControlFlow::{Break, Continue};

/// A share of the time stays if it falls by less than this part.
const STAYS: f64 = 3e-3;
/// A share that still falls stays, too, if its limit is at least this part of it.
const LASTS: f64 = 0.5;

/// A periodic motion of a simulation as its windows have shown it.
pub(super) struct ObservedCycle<'a> {
    /// Rows are so far apart, s.
    pub interval: f64,
    /// Length of a window, time since the motion has been as it is, and longest time that it may take, s.
    pub window: f64,
    pub elapsed: f64,
    pub longest: f64,
    /// Time after which the motion comes back, s.
    pub period: f64,
    pub output: &'a Variable,
    /// The part of the time for which contacts are in each state.
    pub shares: [f64; 4],
}

/// The contact states of a motion in the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastingStates {
    /// The part of the time for which contacts are in each state.
    pub shares: [f64; 4],
    /// `true` for each state that they take no more, though they still took it in the windows shown.
    pub fading: [bool; 4],
}

/// Long-term behaviour of the share of time that a contact state takes.
#[derive(Clone, Copy, PartialEq)]
enum ShareTrend {
    Stays,
    Fades,
    /// Later times must show it.
    Open,
}

/// The contact states that last, if shares of them still fall: those whose share does not tend to zero as the time
/// since the motion began is doubled again and again, until that shows or the motion has taken its longest time.
/// `None` if none falls, or no one waits any more.
///
/// # Errors
/// Returns an error if a step fails.
pub(super) fn lasting(
    simulation: &Simulation,
    shown: &ObservedCycle<'_>,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<LastingStates>, Error> {
    let ObservedCycle { window, mut elapsed, longest, shares, .. } = *shown;
    let mut motion = Simulation::resume(simulation.save())?;
    let Some(next) = shown.after(&mut motion, window, is_over)? else { return Ok(None) };
    if (0..4).all(|i| next[i] >= (1.0 - STAYS) * shares[i]) {
        return Ok(None);
    }
    let Some(doubled) = shown.after(&mut motion, elapsed - window, is_over)? else {
        return Ok(None);
    };
    elapsed *= 2.0;
    let mut three = [shares, shares, doubled];
    loop {
        let Some(again) = shown.after(&mut motion, elapsed, is_over)? else { return Ok(None) };
        elapsed *= 2.0;
        three = [three[1], three[2], again];
        let trends = [0, 1, 2, 3].map(|i| share_trend(three.map(|shares| shares[i])));
        if !trends.contains(&ShareTrend::Open) || 2.0 * elapsed > longest {
            let fading = [0, 1, 2, 3].map(|i| trends[i] == ShareTrend::Fades && shares[i] > 0.0);
            let mut shares = again;
            (0..4).filter(|i| trends[*i] == ShareTrend::Fades).for_each(|i| shares[i] = 0.0);
            let all: f64 = shares.iter().sum();
            return Ok(Some(LastingStates { shares: shares.map(|share| share / all), fading }));
        }
    }
}

/// Behaviour of a share that had these values at three times. Each time is twice as long after the beginning as the
/// one before.
fn share_trend(three: [f64; 3]) -> ShareTrend {
    let [_, before, last] = three;
    if last == 0.0 || tends_to_zero(three) {
        ShareTrend::Fades
    } else if last >= (1.0 - STAYS) * before
        || limit(three).is_some_and(|limit| limit >= LASTS * last)
    {
        ShareTrend::Stays
    } else {
        ShareTrend::Open
    }
}

impl ObservedCycle<'_> {
    /// The shares of the contact states over a period that begins at least so long (s) later, whole periods; `None`
    /// if no one waits for them any more.
    fn after(
        &self,
        motion: &mut Simulation,
        later: f64,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Option<[f64; 4]>, Error> {
        let span = (later / self.period).ceil().max(0.0) * self.period;
        let go_on = || if is_over() { Break(()) } else { Continue(()) };
        if motion.advance_while(motion.time() + span, go_on)?.is_break() {
            return Ok(None);
        }
        let OverSpan { shares, .. } = over_span(motion, self.output, self.period, self.interval)?;
        Ok(Some(shares))
    }
}
