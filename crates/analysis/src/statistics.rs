//! Statistics of values.

/// The mean of values, in their unit; 0 without values.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, x| sum + x) / values.len().max(1) as f64
}

/// The mean square deviation of values from their mean, in their unit squared; 0 without values.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().fold(0.0, |sum, x| sum + (x - mean) * (x - mean)) / values.len().max(1) as f64
}

/// The place of the largest value, of equal ones the first; `None` without values.
pub(crate) fn place_of_largest(values: &[f64]) -> Option<usize> {
    (0..values.len()).rev().max_by(|&a, &b| values[a].total_cmp(&values[b]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variance_is_about_the_mean() {
        assert_eq!(variance(&[1.0, 3.0, 5.0, 7.0]), 5.0);
        assert_eq!((variance(&[2.0]), variance(&[])), (0.0, 0.0));
    }

    #[test]
    fn of_equal_largest_values_the_first_is_found() {
        assert_eq!(place_of_largest(&[1.0, 4.0, 4.0, 2.0]), Some(1));
        assert_eq!(place_of_largest(&[]), None);
    }
}
