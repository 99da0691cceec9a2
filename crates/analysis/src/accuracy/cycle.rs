//! The cycle in which a run ends: amplitude and frequency of one displacement over the last half.

use crate::spectral::cycles;
use amontons::numerics::range;

/// Accuracy with which the search locates a peak, in cycles: the peak is flat to rounding over the square root of the
/// rounding.
const FLAT: f64 = 1e-7;

/// The cycle of a displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Half of the difference between the largest and the smallest value, m; `None` if the displacement does not
    /// move.
    pub amplitude: Option<f64>,
    /// Bound on the relative error of the amplitude, because a run is sampled at intervals only.
    pub amplitude_error: f64,
    /// Frequency at which the spectrum is largest, Hz; `None` if the displacement does not oscillate.
    pub frequency: Option<f64>,
    /// Bound on the relative error of the frequency from the search.
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

/// Half of the difference between the largest and the smallest value, turning points between the values included.
pub(crate) fn half_range(values: &[f64]) -> f64 {
    let turns = values.windows(5).filter_map(turn);
    let [least, most] = range(values.iter().copied().chain(turns));
    0.5 * (most - least)
}

/// The value at which the polynomial through five values has its turning point, next to the middle one.
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
    // If Newton's method leads elsewhere, the values themselves are used.
    let value = c + s * (slope + s * (second + s * (third + s * fourth)));
    (s.abs() <= 1.0).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

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
}
