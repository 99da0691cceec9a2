//! The amplitude of one line over time.

use super::transform::power;
use super::window::{Window, sum, weighted};

/// The amplitude of what a history, in steps of `interval` (s), has at a `frequency` (Hz): the values turned back
/// at that frequency and averaged through a Blackman–Harris window of `count` values, which leaves out what is
/// more than 4 cycles over the window away to 2.5e-5. One amplitude for each window that fits, `hop` values
/// apart: the first is that at the middle of the first window, 0.5 (count − 1) intervals from the start.
///
/// A line that grows as exp(σ t) comes out with a factor that does not depend on the time: its rate is exact.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn amplitudes(
    history: &[f64],
    interval: f64,
    frequency: f64,
    count: usize,
    hop: usize,
) -> Vec<f64> {
    let weights = Window::BlackmanHarris.weights(count);
    let sum = sum(&weights);
    let amplitude =
        |piece: &[f64]| 2.0 * power(&weighted(piece, &weights), frequency * interval).sqrt() / sum;
    history.windows(count.max(1)).step_by(hop.max(1)).map(amplitude).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_growing_line_under_a_thousand_times_larger_one_has_its_rate() {
        let (dt, rate) = (2e-4, 5.0);
        let value = |i: i32| {
            let t = dt * f64::from(i);
            40.0 + (TAU * 219.0 * t).sin() + 1e-3 * (rate * t).exp() * (TAU * 168.0 * t).sin()
        };
        let history: Vec<f64> = (0..5000).map(value).collect();
        // 40 Hz from its middle on, the window lets through 2.5e-5 of the large line: here, 51 Hz away.
        let found = amplitudes(&history, dt, 168.0, 500, 100);
        assert_eq!(found.len(), 46);
        let (first, last) = (found[10], found[45]);
        let fitted = (last / first).ln() / (35.0 * 100.0 * dt);
        // 2.5e-5 of the large line is at most 1e-2 of the first value.
        assert!((fitted / rate - 1.0).abs() < 1e-2 / (rate * 0.7), "{fitted}");
        let middle = dt * (0.5 * 499.0 + 4500.0);
        assert!((last / (1e-3 * (rate * middle).exp()) - 1.0).abs() < 5e-3, "{last}");
    }
}
