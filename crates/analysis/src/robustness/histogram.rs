//! The histogram of the largest growth rate, and families of frequencies.

use amontons::decimal::one_two_five;
use serde::Serialize;

/// The most classes of a histogram between its least and its largest value, about.
const CLASSES: f64 = 40.0;
/// Neighbouring frequencies that are farther apart than by this factor are of two families.
const APART: f64 = 1.1;

/// A class of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Class {
    /// Its ends; a value at the lower end belongs to the class before, so that a growth rate of zero is with the stable ones.
    pub ends: [f64; 2],
    /// The number of values.
    pub count: u64,
}

/// The classes of values, all of one width, from the least value to the largest; zero is an end of a class, if it is between
/// these. None without values.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
#[must_use]
pub fn histogram(values: &[f64]) -> Vec<Class> {
    let [low, high] = amontons::numerics::range(values.iter().copied());
    if values.is_empty() {
        return Vec::new();
    }
    let width = width(high - low, low.abs().max(high.abs()));
    let place = |value: f64| (value / width).ceil() - 1.0;
    let first = place(low);
    let count = place(high) - first + 1.0;
    let end = |place: f64| (first + place) * width;
    let mut classes: Vec<Class> = (0..count as u64)
        .map(|place| Class { ends: [place as f64, place as f64 + 1.0].map(end), count: 0 })
        .collect();
    let last = classes.len() - 1;
    for value in values {
        let place = (place(*value) - first) as usize;
        classes[place.min(last)].count += 1;
    }
    classes
}

/// The width of a class: 1, 2 or 5 times a power of ten.
fn width(range: f64, largest: f64) -> f64 {
    // Values that are all alike are one class.
    let least = (range / CLASSES).max(1e-12 * largest);
    if least <= 0.0 {
        return 1.0;
    }
    let power = 10_f64.powi(exponent(least));
    let factor = one_two_five().find(|factor| factor * power >= least * (1.0 - 1e-12));
    factor.unwrap_or(1.0) * power
}

/// The largest n for which 10^n is not above a value.
#[allow(clippy::cast_possible_truncation)]
fn exponent(value: f64) -> i32 {
    libm::log10(value).floor() as i32
}

/// Ranges of frequencies, ascending, such that all lie in one and neighbours are apart: each from its least to its largest
/// frequency.
#[must_use]
pub fn families(frequencies: &[f64]) -> Vec<[f64; 2]> {
    let mut sorted = frequencies.to_vec();
    sorted.sort_by(f64::total_cmp);
    let families = sorted.chunk_by(|a, b| *b <= APART * a);
    families.map(|family| [family[0], family[family.len() - 1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_one_class_and_zero_divides_two() {
        let values: Vec<f64> = (0..1000).map(|i| -3.1 + 0.0077 * f64::from(i)).collect();
        let classes = histogram(&values);
        assert_eq!(classes.iter().map(|class| class.count).sum::<u64>(), 1000);
        assert!(classes.iter().any(|class| class.ends[0] == 0.0));
        let negative: u64 =
            classes.iter().filter(|class| class.ends[1] <= 0.0).map(|class| class.count).sum();
        assert_eq!(negative, values.iter().filter(|value| **value <= 0.0).count() as u64);
        // Without damping, stable draws have growth rates of exactly zero.
        let undamped = histogram(&[0.0, 0.0, 0.0, 1.0]);
        let stable = undamped.iter().filter(|class| class.ends[1] <= 0.0);
        assert_eq!(stable.map(|class| class.count).sum::<u64>(), 3);
        assert!((20..=45).contains(&classes.len()), "{}", classes.len());
        assert_eq!(histogram(&[2.5; 7]).iter().map(|class| class.count).sum::<u64>(), 7);
        assert_eq!(histogram(&[0.0]).len(), 1);
        assert!(histogram(&[]).is_empty());
    }

    #[test]
    fn frequencies_apart_are_of_two_families() {
        let found = families(&[310.0, 100.0, 0.0, 104.0, 109.0, 0.0, 300.0]);
        assert_eq!(found, [[0.0, 0.0], [100.0, 109.0], [300.0, 310.0]]);
    }
}
