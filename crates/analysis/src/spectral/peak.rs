//! The peak of a spectrum.

use super::transform::{power, powers};
use super::window::{Window, weighted};

/// The cycle must fit into the values at least this many times.
const FEWEST_CYCLES: f64 = 1.5;
/// A peak of less than this part of the spectrum's largest power is a side lobe of a drift.
const SIDE_LOBE: f64 = 1e-2;

/// Number of cycles in the values: the position of the largest peak of their spectrum through a Hann window. The
/// search is flat to rounding over some 1e-7 of a cycle. `None` where nothing oscillates.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn cycles(values: &[f64]) -> Option<f64> {
    let count = values.len();
    let weighted = weighted(values, &Window::Hann.weights(count));
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

/// Position of the maximum of a function that has one maximum between two places, by golden-section search.
pub(crate) fn largest(function: &impl Fn(f64) -> f64, [mut from, mut to]: [f64; 2]) -> f64 {
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
