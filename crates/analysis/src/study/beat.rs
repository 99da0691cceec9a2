//! The lines of a motion that are no multiples of its strongest one: whether a second frequency makes them, and
//! whether they fade.

use crate::spectral::{Line, Lines};
use crate::statistics::mean;

/// Lines of more than this part of the strongest one tell the kinds of motion apart. Weaker ones may be high
/// multiples, as kinks have them, which rows this far apart show at another frequency.
const TELLING: f64 = 1e-2;
/// A beat that falls by less than this part, from the mean of the second quarter of the windows to that of the last,
/// stays.
const FADED: f64 = 0.01;
/// The highest order of a combination of two frequencies.
const HIGHEST_ORDER: i32 = 12;
/// Tolerance with which a frequency meets a multiple or a combination, in parts of the lines' resolution, times 1 + its
/// order.
const MEETS: f64 = 0.01;

/// `true` if all telling lines, the strongest first, are combinations of two frequencies.
pub(super) fn has_two_frequencies(found: &Lines) -> bool {
    let Some(strongest) = found.lines.first() else { return false };
    let main = strongest.frequency;
    let meets = MEETS * found.resolution;
    let is_multiple =
        |of: f64| (of - (of / main).round() * main).abs() <= meets * (1.0 + of / main);
    // A second frequency that has only just set in may be fainter than the lines that must combine.
    let mut frequencies = found.lines.iter().map(|line| line.frequency);
    let Some(second) = frequencies.find(|of| !is_multiple(*of)) else { return false };
    let combines = |of: f64| {
        (-HIGHEST_ORDER..=HIGHEST_ORDER).any(|n| {
            let rest = of - f64::from(n) * main;
            let m = (rest / second).round();
            let order = f64::from(n.abs()) + m.abs();
            order <= f64::from(HIGHEST_ORDER) && (rest - m * second).abs() <= meets * (1.0 + order)
        })
    };
    let is_telling = |line: &&Line| line.amplitude >= TELLING * strongest.amplitude;
    found.lines.iter().filter(is_telling).all(|line| combines(line.frequency))
}

/// The root mean square of all lines that are no multiples of the strongest one, in parts of it.
pub(super) fn beat(found: &Lines) -> f64 {
    let Some(strongest) = found.lines.first() else { return 0.0 };
    let meets = MEETS * found.resolution;
    let is_other = |line: &&Line| {
        let order = line.frequency / strongest.frequency;
        (order - order.round()).abs() * strongest.frequency > meets * (1.0 + order)
    };
    let squares = found.lines.iter().filter(is_other).map(|line| line.amplitude * line.amplitude);
    squares.sum::<f64>().sqrt() / strongest.amplitude
}

/// `true` if the [`beat`] of a motion has fallen through the last three of four equal parts of the windows that were
/// observed. Such a motion may end in one with a period, however slowly.
pub(super) fn is_fading(beats: &[f64]) -> bool {
    let part = beats.len() / 4;
    let means: Vec<f64> = beats.rchunks_exact(part.max(1)).take(3).map(mean).collect();
    let [last, middle, first] = means[..] else { return false };
    part > 0 && last < middle && middle < first && last < (1.0 - FADED) * first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beat_that_goes_on_fading_is_told_from_one_that_stays() {
        // By 2 % from window to window, or by 0.1 %, with some scatter; and one that has come to stay.
        let fading = |rate: f64| -> Vec<f64> {
            let beat = |i: i32| (-rate * f64::from(i)).exp() + 1e-3 * f64::from(i * i % 7);
            (0..60).map(beat).collect()
        };
        assert!(is_fading(&fading(0.02)) && is_fading(&fading(1e-3)));
        let stays: Vec<f64> = fading(0.3).iter().map(|beat| 0.5 + beat).collect();
        assert!(!is_fading(&stays) && !is_fading(&fading(0.0)) && !is_fading(&[]));
        let lines = [(100.0, 2.0), (200.0, 1.0), (130.0, 0.3), (70.0, 0.4)];
        let line = |(frequency, amplitude)| Line { frequency, amplitude };
        let found = Lines { lines: lines.map(line).to_vec(), share: 1.0, resolution: 0.5 };
        assert!((beat(&found) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn frequencies_are_combinations_of_two_or_not() {
        let difference = 219.38 - 167.81;
        let has_two = |lines: &[(f64, f64)]| {
            let line = |&(frequency, amplitude)| Line { frequency, amplitude };
            let lines = lines.iter().map(line).collect();
            has_two_frequencies(&Lines { lines, share: 1.0, resolution: 1.0 })
        };
        assert!(has_two(&[(219.38, 1.0), (167.81, 0.3), (difference, 0.1)]));
        assert!(!has_two(&[(219.38, 1.0), (167.81, 0.3), (difference, 0.1), (91.237, 0.1)]));
        // The second one may be faint, and so may be others that are no combinations.
        assert!(has_two(&[(219.38, 1.0), (438.76, 0.1), (167.81, 3e-3), (91.237, 2e-3)]));
        // One frequency is no combination of two.
        assert!(!has_two(&[(219.38, 1.0), (438.76, 0.1)]) && !has_two(&[]));
    }
}
