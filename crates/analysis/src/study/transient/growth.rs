//! Growth and decay in a history.
//!
//! Where contacts take the same states over and over, a small motion beside a cycle grows or decays as an
//! exponential: the logarithm of its amplitude is straight. It is looked for band by band, through windows of several
//! lengths: long ones tell near lines apart, short ones follow a fast growth. A change that is too fast for all
//! windows is seen in the envelope.

use super::bands::{Band, Bands, Combination};
use super::straight::{Fit, pieces};
use crate::accuracy::half_range;
use crate::spectral::cycles;
use amontons::numerics::max_norm;
use serde::Serialize;
use std::f64::consts::LN_10;
use std::ops::Range;

/// Lengths of the windows of the bands, in periods of the strongest line: through the longest, lines of 4/30 of its
/// frequency or more apart are told from each other; a window shorter than the shortest would also see zero frequency
/// and the mirror image of the frequency.
const WINDOWS: [f64; 3] = [30.0, 16.0, 8.0];
/// The least number of windows over which a band changes.
const FEWEST_WINDOWS: f64 = 3.0;
/// Length of a stretch, in periods of the strongest line, that shows a tenfold change in it.
pub(super) const FEWEST_PERIODS: f64 = 24.0;
/// Values below this part of the largest value are rounding.
pub(super) const ROUNDING: f64 = 1e-12;
/// Tolerance of the straightness of the logarithm of an amplitude.
pub(super) const STRAIGHT: f64 = 0.1;

/// A stretch of time over which the logarithm of an amplitude is straight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Phase {
    /// Index of the band; `None` for a mode while no contact changes its state, for the envelope, and for a band of a
    /// shorter window than the bands that are kept.
    pub band: Option<usize>,
    /// Beginning and end, s: for a band, half a window inside of the points where the logarithm bends.
    pub span: [f64; 2],
    /// Amplitudes of the fitted line at the beginning and the end, in the history's unit.
    pub amplitude: [f64; 2],
    /// The displacement of which these are the amplitudes (m), if they are not those of the output.
    pub displacement: Option<String>,
    /// The growth rate, 1/s; negative where it decays.
    pub rate: f64,
    /// Uncertainty of the rate, as far as the amplitudes tell, 1/s.
    pub rate_error: f64,
    /// Frequency, Hz; 0 for a mode that does not oscillate.
    pub frequency: f64,
    /// Uncertainty of the frequency, as far as the phases tell, Hz.
    pub frequency_error: f64,
    /// The combination, if the frequency is that of a sum or difference of stronger lines: no motion of its own.
    pub combination: Option<Combination>,
}

/// Growth and decay that were found in a history.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Growth {
    /// The strongest line of the whole, Hz; `None` if nothing oscillates.
    pub dominant: Option<f64>,
    /// (time, amplitude), s and the history's unit: half of the difference between the largest and the smallest value
    /// within a period of the strongest line.
    ///
    /// This amplitude is used, not the modulus of the analytic signal: it is the amplitude that one sees, whatever
    /// lines the motion has, a slow motion of the middle does not enter it, and it needs no filter that smears a
    /// beginning.
    pub envelope: Vec<[f64; 2]>,
    /// The length of the windows of the bands that are kept, s: lines 4 / window apart are told from each other. 0
    /// where the run is too short for bands.
    pub window: f64,
    /// The bands, by the largest part of the largest line that they have at any time, the strongest first. None where
    /// the run is too short for them.
    pub bands: Vec<Band>,
    /// Phases by beginning, of equal ones the fastest growth first.
    #[serde(skip)]
    pub phases: Vec<Phase>,
}

/// A history with fewer cycles has no strongest line: one that only grows or decays has a peak of some two cycles, whatever its
/// length.
const FEWEST_CYCLES: f64 = 4.0;

/// The strongest line of a history, Hz; `None` if nothing oscillates often enough.
#[allow(clippy::cast_precision_loss)]
pub(super) fn dominant(history: &[f64], interval: f64) -> Option<f64> {
    let cycles = cycles(history).filter(|cycles| *cycles >= FEWEST_CYCLES);
    cycles.map(|cycles| cycles / (history.len() as f64 * interval))
}

/// Finds growth and decay within some `spans` (s) of a history in steps of `interval` (s), besides the `known`
/// phases: straight stretches in which an amplitude changes by a factor of ten or more.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn growth(history: &[f64], interval: f64, spans: &[[f64; 2]], known: Vec<Phase>) -> Growth {
    let length = history.len() as f64 * interval;
    let dominant = dominant(history, interval);
    let Some(frequency) = dominant else {
        let mut found = Growth { phases: known, ..Growth::default() };
        found.sort();
        return found;
    };
    let floor = ROUNDING * max_norm(history);
    let envelope = envelope(history, interval, 1.0 / frequency);
    let mut found = Growth { dominant, envelope, phases: known, ..Growth::default() };
    for window in WINDOWS.map(|periods| periods / frequency) {
        if length < FEWEST_WINDOWS * window {
            continue;
        }
        let bands = Bands::of(history, interval, frequency, window, floor);
        let is_kept = found.window == 0.0;
        for phase in spans.iter().flat_map(|span| bands.phases(*span)) {
            let band = phase.band.filter(|_| is_kept);
            found.add(Phase { band, ..phase }, bands.width());
        }
        if is_kept {
            (found.window, found.bands) = (bands.window, bands.shown());
        }
    }
    for span in spans {
        for phase in whole(history, interval, &found, *span, floor) {
            found.add(phase, f64::INFINITY);
        }
    }
    found.sort();
    found
}

impl Growth {
    /// Sorts the phases by beginning, growth before decay.
    fn sort(&mut self) {
        let order =
            |a: &Phase, b: &Phase| a.span[0].total_cmp(&b.span[0]).then(b.rate.total_cmp(&a.rate));
        self.phases.sort_by(order);
    }

    /// Adds a phase that was found through a shorter window than the others, unless they have it: at a frequency
    /// nearer than `width` (Hz), over half of its time.
    fn add(&mut self, phase: Phase, width: f64) {
        let is_it = |other: &Phase| {
            let common = other.span[1].min(phase.span[1]) - other.span[0].max(phase.span[0]);
            (other.rate > 0.0) == (phase.rate > 0.0)
                && (other.frequency - phase.frequency).abs() < width
                && common > 0.5 * (phase.span[1] - phase.span[0])
        };
        if !self.phases.iter().any(is_it) {
            self.phases.push(phase);
        }
    }
}

/// Half of what lies between the smallest and the largest value of each period (s), at its middle.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn envelope(history: &[f64], interval: f64, period: f64) -> Vec<[f64; 2]> {
    let count = (period / interval).ceil().max(1.0) as usize + 1;
    // A period is no whole number of intervals, and whole numbers would drift away from it.
    let begin = |place: usize| (place as f64 * period / interval).round() as usize;
    let pieces = (0..).map_while(|place| history.get(begin(place)..begin(place) + count));
    let point = |(place, piece)| [(place as f64 + 0.5) * period, half_range(piece)];
    pieces.enumerate().map(point).collect()
}

/// Growth and decay of the whole motion within a span, of which the envelope has a value a period.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn whole(
    history: &[f64],
    interval: f64,
    growth: &Growth,
    span: [f64; 2],
    floor: f64,
) -> Vec<Phase> {
    let Some(dominant) = growth.dominant else { return Vec::new() };
    let half_period = 0.5 / dominant;
    let is_within =
        |[time, _]: &&[f64; 2]| time - half_period >= span[0] && time + half_period <= span[1];
    let logarithm = |half: f64| if half > floor { libm::log(half) } else { f64::NAN };
    let points: Vec<[f64; 2]> = growth
        .envelope
        .iter()
        .filter(is_within)
        .map(|[time, half]| [*time, logarithm(*half)])
        .collect();
    let mut found = Vec::new();
    for run in points.split(|[_, y]| !y.is_finite()) {
        for (_, span, fit) in straight_pieces(run, 2) {
            let [from, to] = span.map(|time| (time / interval).round() as usize);
            // Without its growth the line is steady, and its peak where its frequency is.
            let level =
                |i: usize| history[i] * libm::exp(-fit.slope * (i - from) as f64 * interval);
            let steady: Vec<f64> = (from..to).map(level).collect();
            let length = span[1] - span[0];
            let frequency = cycles(&steady).map_or(dominant, |cycles| cycles / length);
            found.push(Phase::of(None, span, &fit, [frequency, 1.0 / length]));
        }
    }
    found
}

/// The straight pieces of a logarithm that are longer than two windows, and in which it rises or falls enough. Each
/// is given without half a window at each end, which sees values beyond the piece, with its span and its line.
pub(super) fn straight_pieces(
    points: &[[f64; 2]],
    looks_a_window: usize,
) -> Vec<(Range<usize>, [f64; 2], Fit)> {
    let mut found = Vec::new();
    for piece in pieces(points, STRAIGHT) {
        if piece.len() <= 2 * looks_a_window {
            continue;
        }
        let inner = piece.start + looks_a_window / 2..piece.end - looks_a_window / 2;
        let fit = Fit::of(&points[inner.clone()]);
        let [first, last] = [piece.start, piece.end - 1].map(|i| points[i][0]);
        if (fit.at(last) - fit.at(first)).abs() >= LN_10 {
            let span = [points[inner.start][0], points[inner.end - 1][0]];
            found.push((inner, span, fit));
        }
    }
    found
}

impl Phase {
    pub(super) fn of(band: Option<usize>, span: [f64; 2], fit: &Fit, frequency: [f64; 2]) -> Self {
        let [frequency, frequency_error] = frequency;
        Self {
            band,
            span,
            amplitude: span.map(|time| libm::exp(fit.at(time))),
            rate: fit.slope,
            rate_error: fit.slope_error(span[1] - span[0]),
            frequency,
            frequency_error,
            displacement: None,
            combination: None,
        }
    }

    /// This phase, continued at its rate until `end`, s.
    pub(super) fn to(mut self, end: f64) -> Self {
        self.amplitude[1] *= libm::exp(self.rate * (end - self.span[1]));
        self.span[1] = end;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sum of lines a exp(σ t) cos(2π f t), each as [f, a, σ], in steps of 0.2 ms.
    fn history(count: i32, parts: &[[f64; 3]]) -> Vec<f64> {
        let value = |i: i32| {
            let t = 2e-4 * f64::from(i);
            parts.iter().map(|[f, a, rate]| a * (rate * t).exp() * (TAU * f * t).cos()).sum()
        };
        (0..count).map(value).collect()
    }

    /// Growth and decay in the whole of a history.
    fn of(history: &[f64]) -> Growth {
        growth(history, 2e-4, &[[0.0, f64::INFINITY]], Vec::new())
    }

    fn assert_found(phase: &Phase, [frequency, amplitude, rate]: [f64; 3], allowed: f64) {
        assert!((phase.rate - rate).abs() <= phase.rate_error + 1e-9, "{phase:?}");
        assert!((phase.frequency - frequency).abs() <= phase.frequency_error + 1e-9, "{phase:?}");
        // Steady lines are known better than the middle of their band, which comes from an eighth of the run.
        assert!((phase.frequency - frequency).abs() < 2e-4, "{phase:?}");
        assert!(phase.rate_error < allowed, "{phase:?}");
        for (found, time) in phase.amplitude.iter().zip(phase.span) {
            let exact = amplitude * (rate * time).exp();
            // A window of 0.14 s sees exp(σ t) larger by its mean over the window: 1 % where σ is 5/s.
            assert!((found / exact - 1.0).abs() < 0.02 + phase.rate_error, "{phase:?} {exact}");
        }
        assert_eq!(phase.combination, None);
    }

    #[test]
    fn a_growth_under_a_steady_line_and_a_decay_have_their_rates_and_frequencies() {
        let [steady, growing, decaying] =
            [[219.0, 1.0, 0.0], [168.3, 1e-3, 1.6], [43.0, 0.5, -3.0]];
        let found = of(&history(20_000, &[steady, growing, decaying]));
        assert_eq!(found.phases.len(), 2, "{:?}", found.phases);
        for exact in [growing, decaying] {
            let is_it = |phase: &&Phase| (phase.frequency - exact[0]).abs() < 5.0;
            let phase = found.phases.iter().find(is_it).unwrap();
            assert_found(phase, exact, 0.02);
            assert!(phase.span[1] - phase.span[0] > 2.0, "{phase:?}");
        }
        assert!((found.dominant.unwrap() - 219.0).abs() < 1e-3);
        // The envelope is that of all lines: the sum of the two that are left, where they are in phase, as they are
        // 51 times a second: at most 0.02 s before the end, and smallest and largest value half a period apart.
        let last = found.envelope.iter().rev().take(10).fold(0.0, |most, x| f64::max(most, x[1]));
        let exact = 1.0 + 1e-3 * (1.6_f64 * 4.0).exp();
        assert!((last / exact - 1.0).abs() < 0.05, "{last} {exact}");
    }

    #[test]
    fn what_two_lines_make_together_is_no_line_of_its_own() {
        let [steady, growing] = [[219.0, 1.0, 0.0], [168.3, 1e-2, 2.0]];
        let mut values = history(20_000, &[steady, growing]);
        // A law that bends makes sums and differences of the two.
        values.iter_mut().for_each(|value| *value += 0.2 * *value * *value);
        let found = of(&values);
        let own: Vec<&Phase> =
            found.phases.iter().filter(|phase| phase.combination.is_none()).collect();
        let [own] = own[..] else { panic!("{:?}", found.phases) };
        assert!((own.frequency - 168.3).abs() < own.frequency_error + 1e-9, "{own:?}");
        let is_difference = |phase: &&Phase| (phase.frequency - (219.0 - 168.3)).abs() < 0.1;
        let difference = found.phases.iter().find(is_difference).unwrap();
        assert_eq!(difference.combination.unwrap().factors, [1, -1], "{difference:?}");
    }

    #[test]
    fn a_few_periods_show_the_growth_of_the_whole_motion() {
        // 16 periods: too few for bands.
        let exact = [5.0, 1e-3, 1.5];
        let found = of(&history(16_000, &[exact]));
        assert_eq!((found.bands.len(), found.window), (0, 0.0));
        let [phase] = &found.phases[..] else { panic!("{:?}", found.phases) };
        assert_eq!(phase.band, None);
        // Extremes of exp(σ t) cos(ω t) one period apart differ by exp(σ T) exactly.
        assert!(
            (phase.rate - 1.5).abs() <= phase.rate_error + 1e-4 && phase.rate_error < 0.1,
            "{phase:?}"
        );
        assert!((phase.frequency - 5.0).abs() < phase.frequency_error, "{phase:?}");
    }

    #[test]
    #[allow(clippy::cast_possible_truncation)]
    fn a_growth_of_a_few_periods_a_decade_is_found_before_a_cycle_of_any_length() {
        for periods in [2.0, 3.0, 5.0, 12.0] {
            // From 1e-7 to 1 at 100 Hz.
            let rate = 100.0 * LN_10 / periods;
            let onset = 7.0 * periods / 100.0;
            for length in [1.5, 4.0] {
                let value = |i: i32| {
                    let t = 2e-4 * f64::from(i);
                    (rate * (t - onset).min(0.0)).exp() * (TAU * 100.0 * t).cos()
                };
                let count = (length / 2e-4) as i32;
                let values: Vec<f64> = (0..count).map(value).collect();
                let found = of(&values);
                let grows = |phase: &&Phase| phase.rate > 0.0 && phase.combination.is_none();
                let phase = found.phases.iter().find(grows).unwrap();
                assert!((phase.rate - rate).abs() <= phase.rate_error + 1e-2 * rate, "{phase:?}");
                assert!(phase.rate_error < 0.3 * rate, "{phase:?} {rate}");
                let error = phase.frequency_error;
                assert!((phase.frequency - 100.0).abs() <= error && error < 30.0, "{phase:?}");
            }
        }
    }

    #[test]
    fn what_neither_grows_nor_oscillates_has_no_phases() {
        let steady = of(&history(20_000, &[[219.0, 1.0, 0.0], [180.0, 0.3, 0.0]]));
        assert_eq!(steady.phases, []);
        assert_eq!(of(&[]), Growth::default());
        assert_eq!(of(&[1.0; 500]), Growth::default());
    }
}
