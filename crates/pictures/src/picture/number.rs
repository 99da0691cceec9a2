//! Numbers as a person reads them.

/// A number with `digits` significant digits, whatever its size.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    // A zero has no sign.
    let value = value + 0.0;
    let last = digits.saturating_sub(1);
    let scientific = format!("{value:.last$e}");
    let exponent = scientific.split_once('e').and_then(|(_, text)| text.parse::<i32>().ok());
    match exponent {
        Some(exponent @ -4..=9) => {
            let decimals = (i32::try_from(last).unwrap_or(0) - exponent).max(0);
            format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
        }
        _ => scientific,
    }
}

/// A number with a minus sign that is one and, unless it is written in full, a power of ten: "0.3", "−2.5e−7".
pub(crate) fn typeset(value: f64, in_full: bool) -> String {
    let text = if in_full { format!("{}", value + 0.0) } else { format!("{value:e}") };
    text.replace('-', "−")
}

/// A value to six digits, as "55 kN/m"; tenths of a unit as "0.3 kg".
#[must_use]
pub fn prefixed(value: f64, unit: &str) -> String {
    let digits = format!("{value:.5e}");
    let (mantissa, power) = digits.split_once('e').unwrap_or((&digits, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    let group = if power == -1 { 0 } else { power.div_euclid(3) };
    let place = usize::try_from(group + 3).ok();
    let text = match place.and_then(|place| ["n", "µ", "m", "", "k", "M", "G"].get(place)) {
        // Read as a decimal, the number has no digits of a division.
        Some(prefix) => {
            let number = format!("{mantissa}e{}", power - 3 * group).parse().unwrap_or(value);
            format!("{number} {prefix}{unit}")
        }
        None => format!("{value:e} {unit}"),
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_whatever_their_size() {
        assert_eq!(significant(0.674_982_168_01, 10), "0.6749821680");
        assert_eq!(significant(-60_000.0, 10), "-60000.00000");
        assert_eq!(significant(3.123_456_789_012e-7, 4), "3.123e-7");
        assert_eq!(significant(2.5e12, 3), "2.50e12");
        assert_eq!(significant(123_456.0, 3), "123456");
        assert_eq!(significant(0.0, 3), "0.00");
    }
}
