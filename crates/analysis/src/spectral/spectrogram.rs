//! Spectra of a history piece by piece.

use super::transform::Transform;
use super::window::{Window, weighted};
use serde::Serialize;

/// Lower bound of a spectrogram, dB: smaller values, and zero, are given as this.
pub const LEAST_DB: f64 = -200.0;

/// Power over time and frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Spectrogram {
    /// The middle of each window, s from the first value.
    pub times: Vec<f64>,
    /// Frequencies, Hz, ascending from 0.
    pub frequencies: Vec<f64>,
    /// Power in dB below the largest of all, from [`LEAST_DB`] to 0: for each frequency one for each time.
    pub power: Vec<Vec<f64>>,
    /// The largest power density, one-sided: the history's unit squared for each Hz.
    pub largest: f64,
    /// Half the width of a line, Hz.
    pub resolution: f64,
}

impl Spectrogram {
    /// The spectra of windows of `count` values, `hop` values apart, of a history in steps of `interval` (s), up
    /// to the frequency `highest` (Hz), through Blackman–Harris windows, the mean of each left out. Nothing at all
    /// of a history shorter than a window.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn of(history: &[f64], interval: f64, count: usize, hop: usize, highest: f64) -> Self {
        const WINDOW: Window = Window::BlackmanHarris;
        let (count, hop) = (count.max(1), hop.max(1));
        // Twice as many frequencies as needed, with zeros, for a smooth picture.
        let size = (2 * count).next_power_of_two();
        let frequency = |line: usize| line as f64 / (size as f64 * interval);
        let frequencies: Vec<f64> =
            (0..=size / 2).map(frequency).take_while(|f| *f <= highest).collect();
        let weights = WINDOW.weights(count);
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        let transform = Transform::of_size(size);
        let mut power = vec![Vec::new(); frequencies.len()];
        let mut times = Vec::new();
        for (place, piece) in history.windows(count).enumerate().step_by(hop) {
            times.push((place as f64 + 0.5 * (count - 1) as f64) * interval);
            let spectrum = transform.powers(&weighted(piece, &weights));
            for (row, value) in power.iter_mut().zip(spectrum) {
                row.push(2.0 * value * interval / squares);
            }
        }
        let largest = power.iter().flatten().fold(0.0, |most, &value| f64::max(most, value));
        for value in power.iter_mut().flatten() {
            let level = 10.0 * libm::log10(*value / largest);
            // Nothing divided by nothing is the least too.
            *value = if level > LEAST_DB { level } else { LEAST_DB };
        }
        let resolution = WINDOW.half_width() / (count as f64 * interval);
        Self { times, frequencies, power, largest, resolution }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_line_is_seen_while_it_lasts_with_its_power() {
        let dt = 1e-3;
        let value = |i: i32| {
            let t = dt * f64::from(i);
            let late = if i >= 4000 { 0.1 * (TAU * 125.0 * t).sin() } else { 0.0 };
            3.0 + (TAU * 50.0 * t).sin() + late
        };
        let history: Vec<f64> = (0..8000).map(value).collect();
        let found = Spectrogram::of(&history, dt, 500, 250, 200.0);
        let row = |f: f64| found.frequencies.iter().position(|g| *g >= f).unwrap();
        assert_eq!(found.times.len(), found.power[0].len());
        assert!((found.times[1] - 0.4995).abs() < 1e-12);
        assert!(*found.frequencies.last().unwrap() <= 200.0 && found.frequencies[0] == 0.0);
        for (place, time) in found.times.iter().enumerate() {
            let level = |f: f64| {
                let near = &found.power[row(f - 4.0)..row(f + 4.0)];
                near.iter().map(|row| row[place]).fold(LEAST_DB, f64::max)
            };
            // Frequencies of the transform are 1/4 of half a line apart at most: 0.3 dB.
            assert!(level(50.0) > -0.3, "{time}: {}", level(50.0));
            let faint = level(125.0);
            match time {
                t if *t < 3.7 => assert!(faint < -85.0, "{time}: {faint}"),
                t if *t > 4.3 => assert!((faint + 20.0).abs() < 0.3, "{time}: {faint}"),
                _ => {}
            }
        }
        // Parseval: the density over all frequencies is the power, ½ here and the faint line's 5e-3.
        let last = found.times.len() - 1;
        let step = found.frequencies[1];
        let sum: f64 = found.power.iter().map(|row| 10_f64.powf(0.1 * row[last])).sum();
        assert!((sum * step * found.largest / 0.505 - 1.0).abs() < 1e-3);
        assert!(Spectrogram::of(&history[..400], dt, 500, 250, 200.0).times.is_empty());
        assert!(
            Spectrogram::of(&[0.0; 600], dt, 500, 250, 200.0)
                .power
                .iter()
                .flatten()
                .all(|p| *p == LEAST_DB)
        );
    }
}
