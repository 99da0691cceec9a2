//! Amplitude and phase of one line over time.

use super::transform::at;
use super::window::{Window, sum, weighted};
use serde::Serialize;
use std::f64::consts::TAU;

/// Amplitude and phase of a line at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Phasor {
    /// The amplitude a of a cos(2π f t + φ); the history's unit.
    pub amplitude: f64,
    /// The phase φ against the frequency f that was asked for, rad, from −π to π.
    pub phase: f64,
}

/// Demodulates a history, in steps of `interval` (s), at a `frequency` f (Hz): the values are turned back at that
/// frequency and averaged through a Blackman–Harris window of `count` values, which suppresses all that is more than
/// 4 cycles over the window away to 2.5e-5. Returns one phasor for each window that fits, `hop` values apart; its
/// time is the window's middle, for the first 0.5 (count − 1) intervals from the start.
///
/// A line at f + δ that grows as exp(σ t) is multiplied by a factor that does not depend on the time: the slopes of
/// logarithm and phase are σ and 2π δ exactly.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn demodulate(
    history: &[f64],
    interval: f64,
    frequency: f64,
    count: usize,
    hop: usize,
) -> Vec<Phasor> {
    let weights = Window::BlackmanHarris.weights(count);
    let sum = sum(&weights);
    let cycles = frequency * interval;
    let phasor = |(start, piece): (usize, &[f64])| {
        let [re, im] = at(&weighted(piece, &weights), cycles);
        let passed = (cycles * start as f64).fract();
        let phase = libm::atan2(im, re) / TAU - passed;
        Phasor {
            amplitude: 2.0 * libm::hypot(re, im) / sum,
            phase: TAU * (phase - libm::floor(phase + 0.5)),
        }
    };
    history.windows(count.max(1)).enumerate().step_by(hop.max(1)).map(phasor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_growing_line_under_a_large_one_has_its_rate_and_frequency() {
        let (dt, rate, offset) = (2e-4, 5.0, 1.3);
        let value = |i: i32| {
            let t = dt * f64::from(i);
            let faint = 1e-3 * (rate * t).exp() * (TAU * (168.0 + offset) * t + 0.5).cos();
            40.0 + (TAU * 219.0 * t).sin() + faint
        };
        let history: Vec<f64> = (0..5000).map(value).collect();
        // 40 Hz from its middle on, the window lets through 2.5e-5 of the large line: here, 51 Hz away.
        let found = demodulate(&history, dt, 168.0, 500, 100);
        assert_eq!(found.len(), 46);
        let (first, last) = (found[10], found[45]);
        let span = 35.0 * 100.0 * dt;
        // 2.5e-5 of the large line is 1e-2 of the first value, 5e-4 of the last.
        let fitted = (last.amplitude / first.amplitude).ln() / span;
        assert!((fitted - rate).abs() < 1.1e-2 / span, "{fitted}");
        let turned = (last.phase - first.phase) / TAU - offset * span;
        assert!((turned - turned.round()).abs() < 1.1e-2 / TAU, "{turned}");
        let middle = dt * (0.5 * 499.0 + 4500.0);
        let expected = 1e-3 * (rate * middle).exp();
        // A window of 0.1 s sees more of a line that grows by e^0.5 over it, and less of one 1.3 Hz away: 1 %.
        assert!((last.amplitude / expected - 1.0).abs() < 1e-2, "{last:?} {expected}");
        let phase = 0.5 + TAU * offset * middle;
        assert!(libm::remainder(last.phase - phase, TAU).abs() < 1e-2, "{last:?} {phase}");
    }
}
