//! Lines of a spectrum, and the part of the power that they have.

use super::transform::powers;
use super::window::{Window, sum, weighted};
use amontons::numerics::max_norm;
use serde::Serialize;

/// The window of spectra. Low side lobes matter more than narrow lines, because faint lines beside strong ones are
/// looked for.
const WINDOW: Window = Window::BlackmanHarris;
/// Least number of spectrum values for each cycle over the history, reached by zero padding behind the history.
const FINENESS: usize = 4;
/// A history that varies about its mean by less than this part of its largest value is at rest: rounding.
const REST: f64 = 1e-14;

/// One line of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Frequency of the line, Hz.
    pub frequency: f64,
    /// Half of the difference between the largest and the smallest value of this line alone, in the history's unit.
    pub amplitude: f64,
}

/// The lines of a spectrum.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Lines {
    /// Lines of the spectrum, strongest first.
    pub lines: Vec<Line>,
    /// The part of the power, without the mean, that lies within [`resolution`](Self::resolution) of one of the
    /// lines: near 1 for a motion of few frequencies, less for a chaotic one. 0 where nothing moves.
    pub share: f64,
    /// Two lines nearer than this are not told apart, Hz: half the width of a line.
    pub resolution: f64,
}

/// The lines of a history in steps of `interval` (s): the local maxima of its spectrum, through a Blackman–Harris
/// window, above `floor` times its largest value (of amplitudes, from 1e-4 on: side lobes are at 2.5e-5). The mean is
/// left out, and what fits in less than four times is no line: it cannot be told from a drift. Frequencies and
/// amplitudes are those of the parabola through the logarithms of a maximum and its neighbours: for a steady line
/// alone to 1e-3 of [`resolution`](Lines::resolution) and 1e-3 of itself.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn lines(history: &[f64], interval: f64, floor: f64) -> Lines {
    let count = history.len();
    let resolution = WINDOW.half_width() / (count as f64 * interval);
    let size = (FINENESS * count).next_power_of_two();
    let weights = WINDOW.weights(count);
    let values = weighted(history, &weights);
    let largest = max_norm(history);
    let moving = max_norm(&values);
    // The condition is written so that values that are not numbers rest too.
    if !(moving > REST * largest && moving.is_finite()) {
        return Lines { resolution, ..Lines::default() };
    }
    let spectrum = powers(&values, size);
    let width = WINDOW.half_width() * size as f64 / count as f64;
    let is_peak = |&line: &usize| {
        line as f64 >= width
            && spectrum[line] > spectrum[line - 1]
            && spectrum[line] >= spectrum[line + 1]
    };
    let highest = spectrum.iter().fold(0.0, |most, &power| f64::max(most, power));
    let peaks = (1..size / 2).filter(is_peak);
    let peaks = peaks.filter(|&line| spectrum[line] >= floor * floor * highest);
    let mut found = Vec::new();
    let mut is_in_line = vec![false; spectrum.len()];
    for peak in peaks {
        let (place, power) = vertex(peak, &spectrum);
        let frequency = place / (size as f64 * interval);
        found.push(Line { frequency, amplitude: 2.0 * power.sqrt() / sum(&weights) });
        let near = |line: &usize| (*line as f64 - place).abs() <= width;
        let reach = width as usize + 1;
        let around = peak.saturating_sub(reach)..=(peak + reach).min(size / 2);
        around.filter(near).for_each(|line| is_in_line[line] = true);
    }
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let (mut within, mut all) = (0.0, 0.0);
    for (line, power) in spectrum.iter().enumerate() {
        // The two ends have no mirror images.
        let power = if line == 0 || line == size / 2 { 0.5 * power } else { *power };
        all += power;
        within += if is_in_line[line] { power } else { 0.0 };
    }
    Lines { lines: found, share: if all > 0.0 { within / all } else { 0.0 }, resolution }
}

/// Place and value of the top of the parabola through the logarithms of three neighbours.
#[allow(clippy::cast_precision_loss)]
fn vertex(peak: usize, spectrum: &[f64]) -> (f64, f64) {
    let [left, top, right] =
        [peak - 1, peak, peak + 1].map(|i| libm::log(spectrum[i].max(f64::MIN_POSITIVE)));
    let bend = left - 2.0 * top + right;
    let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
    (peak as f64 + shift, libm::exp(top - 0.25 * (left - right) * shift))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn history(count: i32, interval: f64, parts: &[[f64; 3]]) -> Vec<f64> {
        let part = |t: f64| move |[f, a, phase]: &[f64; 3]| a * (TAU * f * t + phase).sin();
        let value = |i| parts.iter().map(part(interval * f64::from(i))).sum();
        (0..count).map(value).collect()
    }

    #[test]
    fn a_faint_line_beside_a_strong_one_is_found_with_its_amplitude() {
        let parts = [[219.38, 2e-3, 0.3], [167.81, 5e-6, 1.1], [438.76, 1e-4, 0.0]];
        let mut values = history(4000, 2e-4, &parts);
        values.iter_mut().for_each(|value| *value += 7.0);
        let found = lines(&values, 2e-4, 1e-3);
        assert_eq!(found.lines.len(), 3, "{found:?}");
        for (line, [frequency, amplitude, _]) in found.lines.iter().zip([0, 2, 1].map(|i| parts[i]))
        {
            // Leakage of the strong line at the faint one: 2.5e-5 of 2e-3, 1e-2 of 5e-6.
            let allowed = if amplitude < 1e-5 { 1.1e-2 } else { 1e-3 };
            assert!((line.amplitude / amplitude - 1.0).abs() < allowed, "{line:?}");
            let off = (line.frequency - frequency).abs() / found.resolution;
            assert!(off < 1e-3, "{line:?}: {off}");
        }
        assert!((found.share - 1.0).abs() < 1e-6, "{}", found.share);
    }

    #[test]
    fn noise_has_its_power_outside_of_the_lines() {
        // A line of power ½ and white noise of power 1/12 · 6 = ½: half of the power is in no line, but for
        // the noise within the lines' widths.
        let mut seed = 1_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 6.0_f64.sqrt()
        };
        let mut values = history(8000, 1e-3, &[[40.0, 1.0, 0.0]]);
        values.iter_mut().for_each(|value| *value += noise());
        let found = lines(&values, 1e-3, 0.5);
        assert_eq!(found.lines.len(), 1);
        // The noise's own power is known to 1/√8000 times a few.
        assert!((found.share - 0.5).abs() < 0.03, "{}", found.share);
    }

    #[test]
    fn what_rests_drifts_or_is_no_number_has_no_lines() {
        let drift: Vec<f64> = (0..500).map(f64::from).collect();
        let rest = (0..500).map(|i| 1.0 + f64::EPSILON * f64::from(i * i % 7)).collect();
        for values in [Vec::new(), vec![3.0], vec![0.0; 500], rest, vec![f64::NAN; 100], drift] {
            assert_eq!(
                lines(&values, 1e-3, 1e-2).lines,
                [],
                "{:?}",
                &values[..values.len().min(3)]
            );
        }
    }
}
