//! The discrete Fourier transform, fast and at one frequency.

use std::f64::consts::TAU;

/// Σ x exp(−2πi f j) of values x, at `f` cycles a value: real and imaginary part.
pub(super) fn at(values: &[f64], f: f64) -> [f64; 2] {
    let (turn_sin, turn_cos) = libm::sincos(-TAU * f);
    let (mut cos, mut sin) = (1.0, 0.0);
    let mut sum = [0.0, 0.0];
    for value in values {
        sum = [sum[0] + value * cos, sum[1] + value * sin];
        (cos, sin) = (cos * turn_cos - sin * turn_sin, cos * turn_sin + sin * turn_cos);
    }
    sum
}

/// |Σ x exp(−2πi f j)|².
pub(super) fn power(values: &[f64], f: f64) -> f64 {
    let [re, im] = at(values, f);
    re * re + im * im
}

/// The squares of the lines of the Fourier transform of values with zeros behind them, up to half of
/// `size`, a power of two: Cooley and Tukey's, in place.
pub(super) fn powers(values: &[f64], size: usize) -> Vec<f64> {
    Transform::of_size(size).powers(values)
}

/// The fast transform of one size, for many histories.
pub(super) struct Transform {
    size: usize,
    /// (sin, cos) of −2π i / size.
    turns: Vec<(f64, f64)>,
}

impl Transform {
    /// Transform of a size that is a power of two.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn of_size(size: usize) -> Self {
        let turns = (0..size / 2).map(|i| libm::sincos(-TAU * i as f64 / size as f64)).collect();
        Self { size, turns }
    }

    /// The power of each line of values, as many as the transform's size ([`powers`]).
    pub(super) fn powers(&self, values: &[f64]) -> Vec<f64> {
        let size = self.size;
        let mut lines = vec![[0.0, 0.0]; size];
        let bits = size.trailing_zeros();
        for (i, &value) in values.iter().enumerate() {
            lines[i.reverse_bits() >> (usize::BITS - bits)] = [value, 0.0];
        }
        let mut length = 2;
        while length <= size {
            for block in lines.chunks_exact_mut(length) {
                let (even, odd) = block.split_at_mut(length / 2);
                for (i, (a, b)) in even.iter_mut().zip(odd).enumerate() {
                    let (sin, cos) = self.turns[i * (size / length)];
                    let turned = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                    *b = [a[0] - turned[0], a[1] - turned[1]];
                    *a = [a[0] + turned[0], a[1] + turned[1]];
                }
            }
            length *= 2;
        }
        lines[..=size / 2].iter().map(|[re, im]| re * re + im * im).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_transform_is_the_slow_one() {
        let values: Vec<f64> = (0..11).map(|i| f64::from(i * i % 7)).collect();
        for (line, fast) in powers(&values, 16).into_iter().enumerate() {
            let slow = power(&values, line as f64 / 16.0);
            assert!((fast - slow).abs() < 1e-10, "{line}: {fast} {slow}");
        }
    }
}
