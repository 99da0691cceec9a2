//! Questions that a run leaves open, and the runs that would answer them.

use super::growth::{FEWEST_PERIODS, Growth, Phase};
use super::linear::{Slow, TooSlow};
use super::rows::ExplainedInterval;
use serde::Serialize;
use std::f64::consts::LN_10;

/// A growth or decay that was found at another frequency, but for this part of it, is that of another mode.
const SAME_FREQUENCY: f64 = 3e-2;
/// A growth or decay at another rate, but for this part of it and the uncertainty of both, is that of another mode.
const SAME_RATE: f64 = 0.2;
/// A run that is to show a tenfold change is asked to be longer than that by this factor.
const MARGIN: f64 = 1.1;

/// A question that a longer run would answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OpenQuestion {
    /// A mode that grows or decays to the end of the run, but less than tenfold.
    LessThanTenfold {
        /// The growth or decay, as far as the run shows it.
        phase: Phase,
        /// The end of a run that would show it tenfold, s.
        stop_time: f64,
        /// `true` if another mode grows beside it, which may make contacts change their states before that.
        is_beside_growth: bool,
    },
    /// A mode that grows or decays from the beginning or from an edge of a signal, but less than tenfold before the motion is no
    /// longer that of the modes.
    EndsBeforeTenfold {
        /// The growth or decay, as far as the run shows it.
        phase: Phase,
        /// `true` if it may be ended by something else than this motion: a signal, or another mode that grows beside
        /// it.
        is_ended_by_others: bool,
    },
    /// Modes that are too slow for the run to show whether they grow or decay.
    TooSlow {
        /// Number of these modes.
        count: usize,
        /// The frequency, Hz, of the one that takes longest; 0 where it does not oscillate.
        frequency: f64,
        /// The end of a run that may show it, s.
        stop_time: f64,
    },
    /// Contacts change their states to the end of the run, over too few periods to tell growth from decay.
    TooShort {
        /// Beginning and end of the span, s.
        span: [f64; 2],
        /// Length of the span in periods of the strongest line.
        periods: f64,
        /// The end of a run that has enough, s.
        stop_time: f64,
    },
    /// Contacts change their states to the end of the run: a tenfold change that is slower than its length would not have
    /// been found.
    Slower {
        /// Beginning and end of the span, s.
        span: [f64; 2],
        /// The growth rate or decay that would have been tenfold over that span, 1/s.
        rate: f64,
    },
}

/// The spans of a run to `end` (s) that the modes do not explain: those in which contacts change their states, or do
/// not follow the modes. Between two changes of state, stretches have to last for some periods of the strongest line
/// to be no part of these.
pub(super) fn unexplained(
    explained: &[ExplainedInterval],
    end: f64,
    dominant: Option<f64>,
) -> Vec<[f64; 2]> {
    let shortest = dominant.map_or(0.0, |frequency| FEWEST_PERIODS / frequency);
    let mut found = Vec::new();
    let mut from = 0.0;
    for &ExplainedInterval { span: [begin, last], is_woken, rests } in explained {
        let rests = rests && last >= end * (1.0 - 1e-9);
        if !is_woken && !rests && last - begin < shortest {
            continue;
        }
        if begin > from {
            found.push([from, begin]);
        }
        from = last;
    }
    if from < end {
        found.push([from, end]);
    }
    found
}

/// The questions left open by modes that change by less than ten, and by spans that the modes do not explain.
pub(super) fn questions(
    (slow, too_slow): (Vec<Slow>, Option<TooSlow>),
    unexplained: &[[f64; 2]],
    growth: &Growth,
    (end, is_driven): (f64, bool),
) -> Vec<OpenQuestion> {
    let lasts = |span: [f64; 2]| span[1] >= end * (1.0 - 1e-2);
    // The last of many short stretches between changes of state ends with the run by chance.
    let is_by_chance =
        |phase: &Phase| unexplained.iter().any(|span| span[0] < phase.span[0] && lasts(*span));
    // A tenfold change that has been seen is no question any more, though the mode may continue elsewhere.
    let is_answered = |phase: &Phase| {
        let is_same = |found: &Phase| {
            let apart = (found.frequency - phase.frequency).abs();
            let off = SAME_RATE * found.rate.abs() + found.rate_error + phase.rate_error;
            found.combination.is_none()
                && found.rate * phase.rate > 0.0
                && (found.rate - phase.rate).abs() <= off
                && apart <= SAME_FREQUENCY * phase.frequency
        };
        growth.phases.iter().any(is_same)
    };
    let less = slow.into_iter().filter_map(|Slow { phase, is_whole, is_beside_growth }| {
        if is_answered(&phase) {
            return None;
        }
        if lasts(phase.span) {
            if is_by_chance(&phase) {
                return None;
            }
            let stop_time = phase.span[0] + MARGIN * LN_10 / phase.rate.abs();
            let phase = phase.to(end);
            return Some(OpenQuestion::LessThanTenfold { phase, stop_time, is_beside_growth });
        }
        let is_ended_by_others = is_driven || is_beside_growth;
        is_whole.then_some(OpenQuestion::EndsBeforeTenfold { phase, is_ended_by_others })
    });
    let too_slow = too_slow.map(|TooSlow { from, count, slowest, length }| OpenQuestion::TooSlow {
        count,
        frequency: slowest,
        stop_time: from + MARGIN * length,
    });
    let last = unexplained.last().filter(|span| lasts(**span)).zip(growth.dominant);
    let last = last.and_then(|(&span, frequency)| {
        let length = span[1] - span[0];
        let periods = length * frequency;
        if periods < FEWEST_PERIODS {
            let stop_time = span[0] + MARGIN * FEWEST_PERIODS / frequency;
            return Some(OpenQuestion::TooShort { span, periods, stop_time });
        }
        let is_found =
            growth.phases.iter().any(|phase| phase.span[0] >= span[0] && lasts(phase.span));
        (!is_found).then(|| OpenQuestion::Slower { span, rate: LN_10 / length })
    });
    less.chain(too_slow).chain(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_stretches_between_two_changes_are_part_of_what_is_not_explained() {
        let of =
            |span: [f64; 2]| ExplainedInterval { span, is_woken: span[0] == 0.0, rests: false };
        let explained = [[0.0, 0.1], [0.2, 0.21], [0.4, 0.9]].map(of);
        assert_eq!(unexplained(&explained, 1.0, Some(100.0)), [[0.1, 0.4], [0.9, 1.0]]);
        assert_eq!(unexplained(&[of([0.0, 1.0])], 1.0, Some(100.0)), Vec::<[f64; 2]>::new());
        // A knock is no change of state.
        let after = ExplainedInterval { is_woken: true, ..of([0.1, 0.2]) };
        let knocked = unexplained(&[explained[0], after], 0.2, Some(100.0));
        assert_eq!(knocked, Vec::<[f64; 2]>::new());
        // Nor is anything left open by masses that rest to the end.
        let held = |span| ExplainedInterval { rests: true, ..of(span) };
        let spans = unexplained(&[held([0.2, 0.21]), held([0.95, 1.0])], 1.0, Some(100.0));
        assert_eq!(spans, [[0.0, 0.95]]);
        assert_eq!(unexplained(&[], 1.0, None), [[0.0, 1.0]]);
    }

    #[test]
    fn a_short_stretch_that_the_end_of_the_run_cuts_off_asks_for_nothing() {
        let growth = Growth { dominant: Some(100.0), ..Growth::default() };
        let phase = |span| Phase {
            band: None,
            span,
            amplitude: [1e-6; 2],
            displacement: None,
            rate: -2.0,
            rate_error: 1e-6,
            frequency: 150.0,
            frequency_error: 1e-6,
            combination: None,
        };
        // Contacts change their states from 0.5 s on.
        let slow = |span| Slow { phase: phase(span), is_whole: true, is_beside_growth: false };
        let asked =
            |span| questions((vec![slow(span)], None), &[[0.5, 1.0]], &growth, (1.0, false));
        assert!(
            !asked([0.995, 1.0])
                .iter()
                .any(|open| matches!(open, OpenQuestion::LessThanTenfold { .. }))
        );
        let open = questions((vec![slow([0.0, 1.0])], None), &[], &growth, (1.0, false));
        assert!(matches!(open[..], [OpenQuestion::LessThanTenfold { .. }]), "{open:?}");
        // This mode has been seen to decay tenfold elsewhere, or one of another frequency has, or it has grown.
        let with = |rate, frequency| {
            let phases = vec![Phase { rate, frequency, ..phase([0.0, 0.5]) }];
            let growth = Growth { phases, ..growth.clone() };
            questions((vec![slow([0.6, 1.0])], None), &[], &growth, (1.0, false)).len()
        };
        let open = [with(-2.1, 150.5), with(-2.0, 160.0), with(2.0, 150.0), with(-9.0, 150.5)];
        assert_eq!(open, [0, 1, 1, 1]);
    }

    #[test]
    fn a_rest_of_few_periods_asks_for_a_longer_run() {
        let growth = Growth { dominant: Some(100.0), ..Growth::default() };
        let open = questions((Vec::new(), None), &[[0.9, 1.0]], &growth, (1.0, false));
        let [OpenQuestion::TooShort { periods, stop_time, .. }] = open[..] else {
            panic!("{open:?}")
        };
        assert!((periods - 10.0).abs() < 1e-9 && (stop_time - 1.164).abs() < 1e-9, "{open:?}");
        // 50 periods: a change tenfold over half a second would have been seen.
        let open = questions((Vec::new(), None), &[[0.5, 1.0]], &growth, (1.0, false));
        let [OpenQuestion::Slower { rate, .. }] = open[..] else { panic!("{open:?}") };
        assert!((rate - LN_10 / 0.5).abs() < 1e-9, "{open:?}");
        assert_eq!(questions((Vec::new(), None), &[[0.1, 0.5]], &growth, (1.0, false)), []);
    }
}
