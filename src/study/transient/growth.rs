//! Growth and decay in a history, band by band.
//!
//! In one contact state the motion is a sum of modes, each of which grows or decays as an exponential, and where
//! contacts take the same states over and over so does a small motion beside a cycle: the logarithm of its
//! amplitude is straight. A growth in one band of frequencies may be hidden under a larger motion in another, so
//! each of the strongest lines is followed by itself.

use super::straight::{Fit, pieces};
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
    /// The length of the windows through which bands are seen, s; lines 4 / window apart are told from each other.
    pub window: f64,
    /// Strongest first. None where the run is too short for them.
    pub bands: Vec<Band>,
    /// By beginning.
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
    let found = Growth { dominant, window, ..Growth::default() };
    if window * frequency < FEWEST_PERIODS {
        return found;
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
    let mut phases = Vec::new();
    for (place, band) in all.iter().enumerate() {
        let seen: Vec<usize> = (0..strongest.len()).filter(|&i| is_seen(band, i)).collect();
        for run in seen.chunk_by(|a, b| a + 1 == *b) {
            phases.extend(band.phases(place, run[0]..run[0] + run.len()));
        }
    }
    for i in 0..phases.len() {
        phases[i].combination = combination(&phases[i], &all);
    }
    phases.sort_by(|a: &Phase, b: &Phase| a.span[0].total_cmp(&b.span[0]));
    let bands = all.iter().map(|band| Band {
        frequency: band.frequency,
        amplitude: (0..strongest.len())
            .filter(|&i| is_seen(band, i))
            .map(|i| [band.time(i), band.amplitude[i]])
            .collect(),
    });
    Growth { bands: bands.collect(), phases, ..found }
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
        let points: Vec<[f64; 2]> =
            looks.map(|i| [self.time(i), self.phase[i]]).collect();
        let fit = Fit::of(&points);
        let length = points[points.len() - 1][0] - points[0][0];
        [self.frequency + fit.slope / TAU, fit.slope_error(length) / TAU]
    }

    /// The straight stretches within some looks.
    fn phases(&self, band: usize, looks: Range<usize>) -> Vec<Phase> {
        let point = |i: usize| [self.time(i), libm::log(self.amplitude[i])];
        let points: Vec<[f64; 2]> = looks.clone().map(point).collect();
        let mut found = Vec::new();
        for piece in pieces(&points, STRAIGHT) {
            if piece.len() <= 2 * LOOKS {
                continue;
            }
            // Half a window at each end sees what is beyond.
            let inner = piece.start + LOOKS / 2..piece.end - LOOKS / 2;
            let fit = Fit::of(&points[inner.clone()]);
            let span = [points[inner.start][0], points[inner.end - 1][0]];
            let ends = [points[piece.start][0], points[piece.end - 1][0]].map(|time| fit.at(time));
            if (ends[1] - ends[0]).abs() < LN_10 {
                continue;
            }
            let [frequency, frequency_error] =
                self.frequency_over(looks.start + inner.start..looks.start + inner.end);
            found.push(Phase {
                band,
                span,
                amplitude: span.map(|time| libm::exp(fit.at(time))),
                rate: fit.slope,
                rate_error: fit.slope_error(span[1] - span[0]),
                frequency,
                frequency_error,
                combination: None,
            });
        }
        found
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
    let mean = |band: &Followed| {
        let looks = band.looks(phase.span);
        let sum: f64 = looks.map(|i| libm::log(band.amplitude[i].max(f64::MIN_POSITIVE))).sum();
        sum
    };
    let own = mean(&all[phase.band]);
    let stronger = all.iter().filter(|band| mean(band) > own);
    let stronger: Vec<f64> =
        stronger.map(|band| band.frequency_over(band.looks(phase.span))[0]).collect();
    let allowed = 1.0 / (phase.span[1] - phase.span[0]);
    for (i, &a) in stronger.iter().enumerate() {
        for &b in &stronger[i..] {
            for m in 0..=MOST_TERMS {
                for n in -MOST_TERMS..=MOST_TERMS {
                    let sum = (f64::from(m) * a + f64::from(n) * b).abs();
                    let is_few = (2..=MOST_TERMS).contains(&(m + n.abs()));
                    if is_few && (sum - phase.frequency).abs() < allowed {
                        return Some(Combination { frequencies: [a, b], factors: [m, n] });
                    }
                }
            }
        }
    }
    None
}
