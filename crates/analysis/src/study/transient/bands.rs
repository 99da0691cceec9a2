//! The strongest lines of a history, each followed over time by itself.

use super::growth::{Phase, straight_pieces};
use super::straight::Fit;
use crate::spectral::{Lines, demodulate, lines};
use serde::Serialize;
use std::f64::consts::TAU;
use std::ops::Range;

/// Number of instants within a window at which a band is evaluated. Its phase is then followed without ambiguity: the
/// frequencies that the window passes turn by a quarter of a turn at most.
const LOOKS: usize = 16;
/// Length of the pieces in which the strongest lines are looked for, in periods of the strongest line of all.
const PIECE_PERIODS: f64 = 60.0;
/// The most bands.
const MOST_BANDS: usize = 6;
/// A line that is nowhere this part of the largest is not followed.
const FAINT: f64 = 3e-2;
/// A band below this part of the strongest band at its time may be leakage of that band through the window.
const LEAK: f64 = 2e-4;
/// Relative accuracy of frequencies whose phases are straight to rounding.
const FINEST: f64 = 1e-9;
/// The most terms of the sums and differences of the frequencies of two lines that are looked for.
const MOST_TERMS: i32 = 3;
/// A frequency must be known to this part of itself to count as such a sum: near any frequency there is one by
/// chance.
const CHANCE: f64 = 1e-3;
/// A frequency that is known to this part of itself is enough if the rate is the sum of their rates and is known to
/// `SAME_RATE` of itself.
const CHANCE_WITH_RATE: f64 = 5e-3;
const SAME_RATE: f64 = 0.2;

/// The amplitude of a line over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// The middle of the band, Hz.
    pub frequency: f64,
    /// (time, amplitude): s and the history's unit. None where the band is hidden by a stronger one.
    pub amplitude: Vec<[f64; 2]>,
}

/// A frequency as a sum of multiples of others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Combination {
    /// Two stronger lines, Hz.
    pub frequencies: [f64; 2],
    /// The multiple of each frequency in the sum.
    pub factors: [i32; 2],
}

/// The bands of a history through windows of one length.
pub(super) struct Bands {
    /// Length of the windows, s.
    pub(super) window: f64,
    all: Vec<FollowedBand>,
    /// `true`, for each band at each instant, if it is neither rounding nor hidden by a stronger one.
    seen: Vec<Vec<bool>>,
}

impl Bands {
    /// The bands of a history in steps of `interval` (s) whose strongest line has a `frequency` (Hz), through windows
    /// of some length (s); values at or below `floor` are rounding.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn of(
        history: &[f64],
        interval: f64,
        frequency: f64,
        window: f64,
        floor: f64,
    ) -> Self {
        let hop = (window / interval / LOOKS as f64).round().max(1.0) as usize;
        let count = hop * LOOKS;
        let window = count as f64 * interval;
        let piece = (PIECE_PERIODS / (frequency * interval)).ceil() as usize;
        let all: Vec<FollowedBand> = frequencies(history, interval, piece, 4.0 / window)
            .into_iter()
            .map(|frequency| FollowedBand::of(history, interval, frequency, [count, hop]))
            .collect();
        let looks = all.first().map_or(0, |band| band.amplitude.len());
        let strongest =
            |i: usize| all.iter().fold(0.0, |most, band| f64::max(most, band.amplitude[i]));
        let strongest: Vec<f64> = (0..looks).map(strongest).collect();
        let is_seen =
            |(amplitude, strongest): (&f64, &f64)| *amplitude > f64::max(LEAK * strongest, floor);
        let seen =
            |band: &FollowedBand| band.amplitude.iter().zip(&strongest).map(is_seen).collect();
        Self { window, seen: all.iter().map(seen).collect(), all }
    }

    /// The least distance of lines that are told from each other, Hz.
    pub(super) fn width(&self) -> f64 {
        4.0 / self.window
    }

    /// The bands, strongest first.
    pub(super) fn shown(&self) -> Vec<Band> {
        let band = |(band, seen): (&FollowedBand, &Vec<bool>)| Band {
            frequency: band.frequency,
            amplitude: (0..seen.len())
                .filter(|&i| seen[i])
                .map(|i| [band.time(i), band.amplitude[i]])
                .collect(),
        };
        self.all.iter().zip(&self.seen).map(band).collect()
    }

    /// Growth and decay seen by windows that lie within a span, s.
    pub(super) fn phases(&self, [from, to]: [f64; 2]) -> Vec<Phase> {
        let mut phases: Vec<Phase> = Vec::new();
        for (place, (band, is_seen)) in self.all.iter().zip(&self.seen).enumerate() {
            let is_within = |i: usize| {
                band.time(i) - 0.5 * self.window >= from && band.time(i) + 0.5 * self.window <= to
            };
            let seen: Vec<usize> =
                (0..is_seen.len()).filter(|&i| is_seen[i] && is_within(i)).collect();
            for run in seen.chunk_by(|a, b| a + 1 == *b) {
                phases.extend(band.phases(place, run[0]..run[0] + run.len()));
            }
        }
        for phase in &mut phases {
            phase.combination = combination(phase, &self.all);
        }
        phases
    }
}

/// The strongest lines of pieces of a history of about `piece` values, each by its part of the piece's largest line,
/// no two within `width` (Hz).
fn frequencies(history: &[f64], interval: f64, piece: usize, width: f64) -> Vec<f64> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    let pieces = (history.len() / piece.max(1)).max(1);
    for part in history.chunks(history.len().div_ceil(pieces).max(1)) {
        let Lines { lines, .. } = lines(part, interval, FAINT);
        let Some(largest) = lines.first().map(|line| line.amplitude) else { continue };
        found.extend(lines.iter().map(|line| (line.amplitude / largest, line.frequency)));
    }
    // The first of equal lines comes first.
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
struct FollowedBand {
    frequency: f64,
    amplitude: Vec<f64>,
    /// Phase without jumps, rad.
    phase: Vec<f64>,
    /// Time of the first value, and between two values, s.
    begin: f64,
    hop: f64,
}

impl FollowedBand {
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

    /// The growth rate over some looks, and how far it may be off, 1/s.
    fn rate_over(&self, looks: Range<usize>) -> [f64; 2] {
        let tiny = f64::MIN_POSITIVE;
        let point = |i: usize| [self.time(i), libm::log(self.amplitude[i].max(tiny))];
        let points: Vec<[f64; 2]> = looks.map(point).collect();
        let fit = Fit::of(&points);
        let length = points[points.len() - 1][0] - points[0][0];
        [fit.slope, fit.slope_error(length)]
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

/// The frequency of a phase as a combination of those of stronger bands over the same time, as the kinks of the law
/// of contact make them; `None` if it is not one.
fn combination(phase: &Phase, all: &[FollowedBand]) -> Option<Combination> {
    let level = |band: &FollowedBand| {
        let looks = band.looks(phase.span);
        looks.fold(0.0, |sum, i| sum + libm::log(band.amplitude[i].max(f64::MIN_POSITIVE)))
    };
    let own = level(&all[phase.band?]);
    let stronger = all.iter().filter(|band| level(band) > own);
    let stronger: Vec<_> = stronger
        .map(|band| {
            (band.frequency_over(band.looks(phase.span)), band.rate_over(band.looks(phase.span)))
        })
        .collect();
    for (i, (a, rate_a)) in stronger.iter().enumerate() {
        for (j, (b, rate_b)) in stronger.iter().enumerate().skip(i) {
            // One line has multiples, but no differences.
            let least = if i == j { 0 } else { -MOST_TERMS };
            for m in 0..=MOST_TERMS {
                for n in least..=MOST_TERMS {
                    let [times_a, times_b] = [m, n].map(f64::from);
                    let sum = (times_a * a[0] + times_b * b[0]).abs();
                    let error = times_a * a[1] + times_b.abs() * b[1] + phase.frequency_error;
                    // Amplitudes multiply, so rates add.
                    let rate = times_a * rate_a[0] + times_b.abs() * rate_b[0];
                    let rate_error =
                        times_a * rate_a[1] + times_b.abs() * rate_b[1] + phase.rate_error;
                    let has_rate = (rate - phase.rate).abs() <= rate_error
                        && rate_error <= SAME_RATE * phase.rate.abs();
                    let allowed = if has_rate { CHANCE_WITH_RATE } else { CHANCE };
                    let is_few = (2..=MOST_TERMS).contains(&(m + n.abs()));
                    let is_known = error <= allowed * phase.frequency;
                    let apart = (sum - phase.frequency).abs();
                    if is_few && is_known && apart <= error + FINEST * sum {
                        let frequencies = [a[0], b[0]];
                        return Some(Combination { frequencies, factors: [m, n] });
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

    /// A line of 100 Hz of this amplitude, steady, seen in the band about `frequency` (Hz) over ten seconds.
    fn seen_in(frequency: f64, amplitude: f64) -> FollowedBand {
        let turned = |i: i32| TAU * (100.0 - frequency) * 0.1 * f64::from(i);
        FollowedBand {
            frequency,
            amplitude: vec![amplitude; 100],
            phase: (0..100).map(turned).collect(),
            begin: 0.0,
            hop: 0.1,
        }
    }

    /// The stronger lines whose sum is a line of some frequency, with the uncertainty of that frequency (Hz).
    fn sum(frequency: [f64; 2]) -> Option<[i32; 2]> {
        let fit = Fit::of(&[[0.0, 0.0], [9.0, 3.0]]);
        let phase = Phase::of(Some(1), [0.0, 9.0], &fit, frequency);
        combination(&phase, &[seen_in(100.0, 1.0), seen_in(104.0, 0.1)]).map(|found| found.factors)
    }

    #[test]
    fn a_line_is_no_combination_of_itself_and_by_chance_nothing_is_one() {
        // 100 = |100 − 2 · 100|.
        assert_eq!(sum([100.01, 0.05]), None);
        assert_eq!(sum([200.01, 0.05]).map(|[m, n]| m + n), Some(2));
        assert_eq!(sum([303.0, 5.0]), None);
    }
}
