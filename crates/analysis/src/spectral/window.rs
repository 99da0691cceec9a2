//! The weights that keep one line's power out of the others'.

use std::f64::consts::TAU;

/// Weights of the values of a history before its spectrum is taken: sums of cosines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// Two terms: a narrow line, side lobes 31 dB below it, falling off fast.
    Hann,
    /// Four terms (F. J. Harris, Proc. IEEE 66, 1978, "minimum 4-term"): a line twice as wide, side lobes 92 dB
    /// below it.
    BlackmanHarris,
}

impl Window {
    /// Half the width of a line, from its middle to its first zero, in cycles over the window.
    #[must_use]
    pub fn half_width(self) -> f64 {
        match self {
            Self::Hann => 2.0,
            Self::BlackmanHarris => 4.0,
        }
    }

    /// The weights of `count` values, each in the middle of its interval.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn weights(self, count: usize) -> Vec<f64> {
        let turn = |i| TAU * (i as f64 + 0.5) / count as f64;
        let weight = |turn: f64| match self {
            Self::Hann => 0.5 - 0.5 * libm::cos(turn),
            Self::BlackmanHarris => {
                0.35875 - 0.48829 * libm::cos(turn) + 0.14128 * libm::cos(2.0 * turn)
                    - 0.01168 * libm::cos(3.0 * turn)
            }
        };
        (0..count).map(turn).map(weight).collect()
    }
}

/// A history without its mean, the weighted one, times the weights.
pub(super) fn weighted(history: &[f64], weights: &[f64]) -> Vec<f64> {
    let sum = sum(weights);
    let pairs = || history.iter().zip(weights);
    let mean = pairs().fold(0.0, |sum, (value, weight)| sum + weight * value) / sum;
    pairs().map(|(value, weight)| weight * (value - mean)).collect()
}

pub(super) fn sum(weights: &[f64]) -> f64 {
    weights.iter().fold(0.0, |sum, weight| sum + weight)
}

#[cfg(test)]
mod tests {
    use super::super::transform::power;
    use super::*;

    #[test]
    fn side_lobes_are_as_low_as_published() {
        for (window, published) in [(Window::Hann, -31.5), (Window::BlackmanHarris, -92.0)] {
            let weights = window.weights(256);
            let level = |f: f64| 10.0 * (power(&weights, f / 256.0) / power(&weights, 0.0)).log10();
            let half_width = window.half_width();
            assert!(level(half_width) < -110.0, "{window:?}: not zero at {half_width}");
            let beyond = (0..400).map(|i| level(half_width + 0.05 * f64::from(i)));
            let highest = beyond.fold(f64::NEG_INFINITY, f64::max);
            assert!((highest - published).abs() < 0.1, "{window:?}: {highest} dB");
        }
    }
}
