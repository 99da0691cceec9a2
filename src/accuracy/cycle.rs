//! The cycle in which a run ends: amplitude and frequency of one displacement over the last half.

use std::f64::consts::TAU;

/// A cycle must fit in so many times.
const FEWEST_CYCLES: f64 = 1.5;
/// A peak of less than this part of the spectrum's largest power is a side lobe of a drift.
const SIDE_LOBE: f64 = 1e-2;
/// How well the search finds a peak, in cycles: it is flat to rounding over the root of that.
const FLAT: f64 = 1e-7;

/// The cycle of a displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Half of what lies between its smallest and largest value, m; `None` if it does not move.
    pub amplitude: Option<f64>,
    /// How far the amplitude may be off, relative, since a run is looked at now and then only.
    pub amplitude_error: f64,
    /// Where its spectrum is largest, Hz; `None` if it does not oscillate.
    pub frequency: Option<f64>,
    /// How far the search for the frequency may be off, relative.
    pub frequency_error: f64,
}

impl Cycle {
    /// The cycle in the last half of a history, in steps of `interval` (s).
    pub(super) fn of(history: &[f64], interval: f64) -> Self {
        Self::over(&history[history.len() / 2..], interval)
    }

    /// The cycle in a whole history.
    #[allow(clippy::cast_precision_loss)]
    pub(crate) fn over(last: &[f64], interval: f64) -> Self {
        let fine = half_range(last);
        if fine <= 0.0 {
            return Self::default();
        }
        // The polynomial's error is of sixth order, at twice the interval 64 times as large; by luck, where a
        // value stands next to a turn, less.
        let every_other: Vec<f64> = last.iter().step_by(2).copied().collect();
        let amplitude_error = (half_range(&every_other) / fine - 1.0).abs() / 4.0;
        let cycles = cycles(last);
        let window = last.len() as f64 * interval;
        Self {
            amplitude: Some(fine),
            amplitude_error,
            frequency: cycles.map(|cycles| cycles / window),
            frequency_error: cycles.map_or(0.0, |cycles| FLAT / cycles),
        }
    }
}

/// Half of what lies between the smallest and the largest value, turns between the values included.
pub(crate) fn half_range(values: &[f64]) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in values {
        (least, most) = (least.min(value), most.max(value));
    }
    for turn in values.windows(5).filter_map(turn) {
        (least, most) = (least.min(turn), most.max(turn));
    }
    0.5 * (most - least)
}

/// Where the polynomial through five values turns, next to the middle one.
fn turn(five: &[f64]) -> Option<f64> {
    let &[a, b, c, d, e] = five else { return None };
    if (c - b) * (d - c) >= 0.0 {
        return None;
    }
    let slope = (a - 8.0 * b + 8.0 * d - e) / 12.0;
    let second = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 24.0;
    let third = (-a + 2.0 * b - 2.0 * d + e) / 12.0;
    let fourth = (a - 4.0 * b + 6.0 * c - 4.0 * d + e) / 24.0;
    let mut s = 0.0;
    for _ in 0..6 {
        let rise = slope + s * (2.0 * second + s * (3.0 * third + s * 4.0 * fourth));
        let bend = 2.0 * second + s * (6.0 * third + s * 12.0 * fourth);
        s -= rise / bend;
    }
    // Where Newton's method leads elsewhere, the values themselves have to do.
    let value = c + s * (slope + s * (second + s * (third + s * fourth)));
    (s.abs() <= 1.0).then_some(value)
}

/// How often the cycle fits in the values: where their spectrum, through a Hann window, has its largest peak.
#[allow(clippy::cast_precision_loss)]
fn cycles(values: &[f64]) -> Option<f64> {
    let count = values.len();
    let window = |i: usize| 0.5 - 0.5 * libm::cos(TAU * (i as f64 + 0.5) / count as f64);
    let weight = (0..count).fold(0.0, |sum, i| sum + window(i));
    let sum = values.iter().enumerate().fold(0.0, |sum, (i, value)| sum + window(i) * value);
    let mean = sum / weight;
    let weighted: Vec<f64> =
        values.iter().enumerate().map(|(i, value)| window(i) * (value - mean)).collect();
    // Twice as long as needed, with zeros: so the largest line is next to the peak.
    let size = (2 * count).next_power_of_two();
    let lines = powers(&weighted, size);
    let of_line = count as f64 / size as f64;
    let is_peak = |line: &usize| {
        *line as f64 * of_line >= FEWEST_CYCLES
            && lines[*line] > lines[line - 1]
            && lines[*line] >= lines[line + 1]
    };
    let peak = (1..size / 2).filter(is_peak).max_by(|&a, &b| lines[a].total_cmp(&lines[b]))?;
    if lines[peak] < SIDE_LOBE * lines.iter().fold(0.0, |most, &power| f64::max(most, power)) {
        return None;
    }
    let power = |line: f64| power(&weighted, line / size as f64);
    Some(largest(&power, [peak as f64 - 1.0, peak as f64 + 1.0]) * of_line)
}

/// |Σ x exp(−2πi f j)|² of values x, at `f` cycles a value.
#[allow(clippy::cast_precision_loss)]
fn power(values: &[f64], f: f64) -> f64 {
    let (turn_sin, turn_cos) = libm::sincos(-TAU * f);
    let (mut cos, mut sin) = (1.0, 0.0);
    let mut sum = [0.0, 0.0];
    for value in values {
        sum = [sum[0] + value * cos, sum[1] + value * sin];
        (cos, sin) = (cos * turn_cos - sin * turn_sin, cos * turn_sin + sin * turn_cos);
    }
    sum[0] * sum[0] + sum[1] * sum[1]
}

/// Where a function with one maximum between two places has it, by golden sections.
fn largest(function: &impl Fn(f64) -> f64, [mut from, mut to]: [f64; 2]) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let mut inner = [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
    let mut values = inner.map(function);
    for _ in 0..40 {
        if values[0] > values[1] {
            (to, inner[1], values[1]) = (inner[1], inner[0], values[0]);
            inner[0] = to - GOLDEN * (to - from);
            values[0] = function(inner[0]);
        } else {
            (from, inner[0], values[0]) = (inner[0], inner[1], values[1]);
            inner[1] = from + GOLDEN * (to - from);
            values[1] = function(inner[1]);
        }
    }
    0.5 * (from + to)
}

/// The squares of the lines of the Fourier transform of values with zeros behind them, up to half of
/// `size`, a power of two: Cooley and Tukey's, in place.
#[allow(clippy::cast_precision_loss)]
fn powers(values: &[f64], size: usize) -> Vec<f64> {
    let mut lines = vec![[0.0, 0.0]; size];
    let bits = size.trailing_zeros();
    for (i, &value) in values.iter().enumerate() {
        lines[i.reverse_bits() >> (usize::BITS - bits)] = [value, 0.0];
    }
    let turns: Vec<(f64, f64)> =
        (0..size / 2).map(|i| libm::sincos(-TAU * i as f64 / size as f64)).collect();
    let mut length = 2;
    while length <= size {
        for block in lines.chunks_exact_mut(length) {
            let (even, odd) = block.split_at_mut(length / 2);
            for (i, (a, b)) in even.iter_mut().zip(odd).enumerate() {
                let (sin, cos) = turns[i * (size / length)];
                let turned = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
        length *= 2;
    }
    lines[..=size / 2].iter().map(|[re, im]| re * re + im * im).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_beside_a_smaller_one_has_its_amplitude_and_frequency() {
        let dt = 2e-4;
        let value = |i: i32| {
            let t = dt * f64::from(i);
            3.0 + 0.02 * (TAU * 219.38 * t + 0.3).sin() + 0.004 * (TAU * 43.5 * t).sin()
        };
        let history: Vec<f64> = (0..=5000).map(value).collect();
        let found = Cycle::of(&history, dt);
        let frequency = found.frequency.unwrap();
        assert!((frequency / 219.38 - 1.0).abs() < 1e-7, "{frequency}");
        let amplitude = found.amplitude.unwrap();
        assert!((amplitude / 0.024 - 1.0).abs() < 1e-3, "{amplitude}");
    }

    #[test]
    fn the_amplitude_of_a_sine_is_known_as_well_as_it_says() {
        for dt in [1.01e-2, 2.03e-2, 4.47e-2] {
            let history: Vec<f64> =
                (0..2000).map(|i| 0.7 * (TAU * dt * f64::from(i) + 0.1).cos()).collect();
            let found = Cycle::of(&history, dt);
            let error = (found.amplitude.unwrap() / 0.7 - 1.0).abs();
            assert!(
                error <= found.amplitude_error + 1e-13 && error < 1e-5,
                "{dt}: {error} {found:?}"
            );
        }
    }

    #[test]
    fn what_rests_has_no_cycle_and_what_drifts_no_frequency() {
        assert_eq!(Cycle::of(&[0.1; 300], 1e-3), Cycle::default());
        let drifting: Vec<f64> = (0..300).map(f64::from).collect();
        let found = Cycle::of(&drifting, 1e-3);
        assert_eq!((found.amplitude, found.frequency), (Some(74.5), None));
    }

    #[test]
    fn the_fast_transform_is_the_slow_one() {
        let values: Vec<f64> = (0..11).map(|i| f64::from(i * i % 7)).collect();
        for (line, fast) in powers(&values, 16).into_iter().enumerate() {
            let slow = power(&values, line as f64 / 16.0);
            assert!((fast - slow).abs() < 1e-10, "{line}: {fast} {slow}");
        }
    }
}
