//! Growth and decay in a history, band by band.
//!
//! In one contact state the motion is a sum of modes, each of which grows or decays as an exponential, and where
//! contacts take the same states over and over so does a small motion beside a cycle: the logarithm of its
//! amplitude is straight. A growth in one band of frequencies may be hidden under a larger motion in another, so
//! each of the strongest lines is followed by itself.

use super::straight::{Fit, pieces};
use crate::accuracy::half_range;
use crate::spectral::{Lines, cycles, demodulate, lines};
use serde::Serialize;
use std::f64::consts::{LN_10, TAU};
use std::ops::Range;

/// Bands are seen through windows of so many periods of the strongest line: lines of 4/30 of its frequency or more
/// apart are told from each other.
const WINDOW_PERIODS: f64 = 30.0;
/// A window has no less; then what is at zero and at the mirror image of the frequency still is out of sight.
const FEWEST_PERIODS: f64 = 8.0;
/// A run has no less of windows.
const FEWEST_WINDOWS: f64 = 10.0;
/// A band is looked at so often within a window. Its phase is then followed without ambiguity: what the window
/// lets through turns by a quarter of a turn at most.
const LOOKS: usize = 16;
/// In so many parts of a run the strongest lines are looked for.
const PARTS: usize = 8;
/// The most bands.
const MOST_BANDS: usize = 6;
/// A line that is nowhere this part of the largest is not followed.
const FAINT: f64 = 3e-2;
/// What is less than this part of the strongest band at its time may be what the window lets through of that.
const LEAK: f64 = 2e-4;
/// How straight the logarithm of an amplitude has to be.
const STRAIGHT: f64 = 0.1;
/// How well frequencies are known whose phases are straight to rounding, in parts of themselves.
const ROUNDING: f64 = 1e-9;
/// Sums and differences of the frequencies of two lines with so many terms are looked for.
const MOST_TERMS: i32 = 3;

/// The amplitude of a line over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// The middle of the band, Hz.
    pub frequency: f64,
    /// (time, amplitude): s and the history's unit. None where the band is hidden by a stronger one.
    pub amplitude: Vec<[f64; 2]>,
}

/// A stretch of time over which the logarithm of a band's amplitude is straight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Phase {
    /// Its place among the bands; `None` of the whole motion, where the run is too short for bands.
    pub band: Option<usize>,
    /// Beginning and end, s: half a window inside of where the logarithm bends.
    pub span: [f64; 2],
    /// The fitted line's amplitudes there, the history's unit.
    pub amplitude: [f64; 2],
    /// The growth rate, 1/s; negative where it decays.
    pub rate: f64,
    /// How far that may be off, as far as the amplitudes tell, 1/s.
    pub rate_error: f64,
    /// Hz.
    pub frequency: f64,
    /// How far that may be off, as far as the phases tell, Hz.
    pub frequency_error: f64,
    /// The frequency is that of a sum or difference of stronger lines: no motion of its own.
    pub combination: Option<Combination>,
}

/// A frequency as a sum of multiples of others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Combination {
    /// Two stronger lines, Hz.
    pub frequencies: [f64; 2],
    /// How often each.
    pub factors: [i32; 2],
}

/// What was found in a history.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Growth {
    /// The strongest line of the whole, Hz; `None` if nothing oscillates.
    pub dominant: Option<f64>,
    /// (time, amplitude), s and the history's unit: half of what lies between smallest and largest value within a
    /// period of the strongest line.
    ///
    /// That, not the modulus of the analytic signal: it is the amplitude that one sees, whatever lines the motion
    /// has, a slow motion of the middle does not enter it, and it needs no filter that smears a beginning.
    pub envelope: Vec<[f64; 2]>,
    /// The length of the windows through which bands are seen, s: lines 4 / window apart are told from each other. 0
    /// where the run is too short for bands: less than eighty periods of the strongest line.
    pub window: f64,
    /// Strongest first, by what part of the largest line they are somewhere. None where the run is too short for them.
    pub bands: Vec<Band>,
    /// By beginning.
    #[serde(skip)]
    pub phases: Vec<Phase>,
}

/// Finds growth and decay in a history in steps of `interval` (s): straight stretches of two windows or more in
/// which the amplitude changes by a factor of ten or more.
#[must_use]
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn growth(history: &[f64], interval: f64) -> Growth {
    let length = history.len() as f64 * interval;
    let dominant = cycles(history).map(|cycles| cycles / length);
    let Some(frequency) = dominant else { return Growth::default() };
    let window = (WINDOW_PERIODS / frequency).min(length / FEWEST_WINDOWS);
    let envelope = envelope(history, interval, 1.0 / frequency);
    if window * frequency < FEWEST_PERIODS {
        let phases = whole(history, interval, frequency, &envelope);
        return Growth { dominant, envelope, phases, ..Growth::default() };
    }
    let hop = (window / interval / LOOKS as f64).round().max(1.0) as usize;
    let count = hop * LOOKS;
    let width = 4.0 / window;
    let all: Vec<Followed> = frequencies(history, interval, width)
        .into_iter()
        .map(|frequency| Followed::of(history, interval, frequency, [count, hop]))
        .collect();
    let strongest = |i: usize| all.iter().fold(0.0, |most, band| f64::max(most, band.amplitude[i]));
    let strongest: Vec<f64> =
        (0..all.first().map_or(0, |band| band.amplitude.len())).map(strongest).collect();
    let is_seen = |band: &Followed, i: usize| {
        let amplitude = band.amplitude[i];
        amplitude > LEAK * strongest[i] && amplitude >= f64::MIN_POSITIVE
    };
    let mut phases: Vec<Phase> = Vec::new();
    for (place, band) in all.iter().enumerate() {
        let seen: Vec<usize> = (0..strongest.len()).filter(|&i| is_seen(band, i)).collect();
        for run in seen.chunk_by(|a, b| a + 1 == *b) {
            phases.extend(band.phases(place, run[0]..run[0] + run.len()));
        }
    }
    for phase in &mut phases {
        phase.combination = combination(phase, &all);
    }
    phases.sort_by(|a: &Phase, b: &Phase| a.span[0].total_cmp(&b.span[0]));
    let bands = all.iter().map(|band| Band {
        frequency: band.frequency,
        amplitude: (0..strongest.len())
            .filter(|&i| is_seen(band, i))
            .map(|i| [band.time(i), band.amplitude[i]])
            .collect(),
    });
    Growth { dominant, envelope, window, bands: bands.collect(), phases }
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

/// Growth and decay of the whole motion, of which the envelope has a value a period.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn whole(history: &[f64], interval: f64, dominant: f64, envelope: &[[f64; 2]]) -> Vec<Phase> {
    let points: Vec<[f64; 2]> =
        envelope.iter().map(|[time, half]| [*time, libm::log(*half)]).collect();
    let mut found = Vec::new();
    for run in points.split(|[_, y]| !y.is_finite()) {
        for (_, span, fit) in straight_pieces(run, 2) {
            let [from, to] = span.map(|time| (time / interval).round() as usize);
            let frequency = cycles(&history[from..to])
                .map_or(dominant, |cycles| cycles / ((to - from) as f64 * interval));
            let length = span[1] - span[0];
            let phase = Phase::of(None, span, &fit, [frequency, 1.0 / length]);
            found.push(phase);
        }
    }
    found
}

/// The straight pieces of a logarithm that are longer than two windows, and in which it rises or falls enough: the
/// piece but half a window at each end, which sees what is beyond; its span; its line.
fn straight_pieces(
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
    fn of(band: Option<usize>, span: [f64; 2], fit: &Fit, frequency: [f64; 2]) -> Self {
        let [frequency, frequency_error] = frequency;
        Self {
            band,
            span,
            amplitude: span.map(|time| libm::exp(fit.at(time))),
            rate: fit.slope,
            rate_error: fit.slope_error(span[1] - span[0]),
            frequency,
            frequency_error,
            combination: None,
        }
    }
}

/// The strongest lines of the parts of a history, each by what part of the part's largest line it is, no two within
/// `width` (Hz).
fn frequencies(history: &[f64], interval: f64, width: f64) -> Vec<f64> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for part in history.chunks(history.len().div_ceil(PARTS).max(1)) {
        let Lines { lines, .. } = lines(part, interval, FAINT);
        let Some(largest) = lines.first().map(|line| line.amplitude) else { continue };
        found.extend(lines.iter().map(|line| (line.amplitude / largest, line.frequency)));
    }
    // Of equal ones the first.
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<f64> = Vec::new();
    for (_, frequency) in found {
        if kept.len() < MOST_BANDS && kept.iter().all(|other| (other - frequency).abs() >= width) {
            kept.push(frequency);
        }
    }
    kept
}

/// A band at all times.
struct Followed {
    frequency: f64,
    amplitude: Vec<f64>,
    /// Without jumps, rad.
    phase: Vec<f64>,
    /// Of the first look, and between two, s.
    begin: f64,
    hop: f64,
}

impl Followed {
    #[allow(clippy::cast_precision_loss)]
    fn of(history: &[f64], interval: f64, frequency: f64, [count, hop]: [usize; 2]) -> Self {
        let phasors = demodulate(history, interval, frequency, count, hop);
        let mut phase = 0.0;
        let unwrapped = phasors.iter().map(|phasor| {
            phase += libm::remainder(phasor.phase - phase, TAU);
            phase
        });
        Self {
            frequency,
            phase: unwrapped.collect(),
            amplitude: phasors.iter().map(|phasor| phasor.amplitude).collect(),
            begin: 0.5 * (count - 1) as f64 * interval,
            hop: hop as f64 * interval,
        }
    }

    #[allow(clippy::cast_precision_loss)]
    fn time(&self, i: usize) -> f64 {
        self.begin + i as f64 * self.hop
    }

    /// The frequency over some looks, and how far it may be off, Hz.
    fn frequency_over(&self, looks: Range<usize>) -> [f64; 2] {
        let points: Vec<[f64; 2]> = looks.map(|i| [self.time(i), self.phase[i]]).collect();
        let fit = Fit::of(&points);
        let length = points[points.len() - 1][0] - points[0][0];
        [self.frequency + fit.slope / TAU, fit.slope_error(length) / TAU]
    }

    /// The straight stretches within some looks.
    fn phases(&self, band: usize, looks: Range<usize>) -> Vec<Phase> {
        let point = |i: usize| [self.time(i), libm::log(self.amplitude[i])];
        let points: Vec<[f64; 2]> = looks.clone().map(point).collect();
        let phase = |(inner, span, fit): (Range<usize>, _, _)| {
            let looks = looks.start + inner.start..looks.start + inner.end;
            Phase::of(Some(band), span, &fit, self.frequency_over(looks))
        };
        straight_pieces(&points, LOOKS).into_iter().map(phase).collect()
    }

    /// The looks within a span, s.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn looks(&self, span: [f64; 2]) -> Range<usize> {
        let [from, to] = span.map(|time| ((time - self.begin) / self.hop).round() as usize);
        from..(to + 1).min(self.amplitude.len())
    }
}

/// Is the frequency of a phase a combination of those of stronger bands over the same time, as the kinks of the law
/// of contact make them?
fn combination(phase: &Phase, all: &[Followed]) -> Option<Combination> {
    let level = |band: &Followed| {
        let looks = band.looks(phase.span);
        looks.fold(0.0, |sum, i| sum + libm::log(band.amplitude[i].max(f64::MIN_POSITIVE)))
    };
    let own = level(&all[phase.band?]);
    let stronger = all.iter().filter(|band| level(band) > own);
    let stronger: Vec<[f64; 2]> =
        stronger.map(|band| band.frequency_over(band.looks(phase.span))).collect();
    for (i, &[a, a_error]) in stronger.iter().enumerate() {
        for &[b, b_error] in &stronger[i..] {
            for m in 0..=MOST_TERMS {
                for n in -MOST_TERMS..=MOST_TERMS {
                    let [times_a, times_b] = [m, n].map(f64::from);
                    let sum = (times_a * a + times_b * b).abs();
                    let error = times_a * a_error + times_b.abs() * b_error + phase.frequency_error;
                    let is_few = (2..=MOST_TERMS).contains(&(m + n.abs()));
                    if is_few && (sum - phase.frequency).abs() <= error + ROUNDING * sum {
                        return Some(Combination { frequencies: [a, b], factors: [m, n] });
                    }
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of lines a exp(σ t) cos(2π f t), each as [f, a, σ], in steps of 0.2 ms.
    fn history(count: i32, parts: &[[f64; 3]]) -> Vec<f64> {
        let value = |i: i32| {
            let t = 2e-4 * f64::from(i);
            parts.iter().map(|[f, a, rate]| a * (rate * t).exp() * (TAU * f * t).cos()).sum()
        };
        (0..count).map(value).collect()
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
        let found = growth(&history(20_000, &[steady, growing, decaying]), 2e-4);
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
        let found = growth(&values, 2e-4);
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
        let found = growth(&history(16_000, &[exact]), 2e-4);
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
    fn what_neither_grows_nor_oscillates_has_no_phases() {
        let steady = growth(&history(20_000, &[[219.0, 1.0, 0.0], [180.0, 0.3, 0.0]]), 2e-4);
        assert_eq!(steady.phases, []);
        assert_eq!(growth(&[], 1e-3), Growth::default());
        assert_eq!(growth(&[1.0; 500], 1e-3), Growth::default());
    }
}
