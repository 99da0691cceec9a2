//! Numbers and names as a person reads them.

use amontons::stability::locus::Crossing;

/// Digits to which parameters are located and printed.
pub const LOCATED: usize = 10;

/// A number with so many significant digits, whatever its size.
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

/// What a mode does at a frequency (Hz), zero being a real eigenvalue.
pub fn at_frequency(frequency_hz: f64) -> String {
    if frequency_hz == 0.0 {
        "without oscillating (real, divergence)".into()
    } else {
        format!("at {frequency_hz:.3} Hz")
    }
}

/// What a mode does where its growth rate changes its sign.
pub fn turn(crossing: &Crossing) -> String {
    format!(
        "mode {} {} {}",
        crossing.mode + 1,
        if crossing.becomes_unstable { "begins to grow" } else { "ceases to grow" },
        at_frequency(crossing.frequency_hz)
    )
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
