//! Decimal numbers: significant digits, and the series 1, 2, 5.

/// Rounds a value to `digits` significant decimal digits, at least one: the double nearest to that decimal. Zero and
/// values that are not finite stay.
#[must_use]
pub fn to_significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// The endless series 1, 2, 5, 10, 20, 50, ….
pub fn one_two_five() -> impl Iterator<Item = f64> {
    let powers = std::iter::successors(Some(1.0), |power| Some(10.0 * power));
    powers.flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * power))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_beyond_those_asked_for_are_rounded() {
        assert_eq!(to_significant(0.1 + 0.2, 14), 0.3);
        assert_eq!(to_significant(-12_345.678_9, 7), -12_345.68);
        assert_eq!(to_significant(0.055, 1), 0.06);
        assert_eq!(to_significant(0.0, 3), 0.0);
        assert_eq!(to_significant(f64::NEG_INFINITY, 3), f64::NEG_INFINITY);
        assert!(to_significant(f64::NAN, 3).is_nan());
    }

    #[test]
    fn steps_of_the_series_are_doubles_of_whole_numbers() {
        let first: Vec<f64> = one_two_five().take(7).collect();
        assert_eq!(first, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(one_two_five().nth(44), Some(5e14));
    }
}
