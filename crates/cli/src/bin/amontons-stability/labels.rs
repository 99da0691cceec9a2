//! Numbers and names as a person reads them.

use amontons_analysis::stability::locus::Crossing;
pub use amontons_pictures::picture::significant;

/// Digits to which parameters are located and printed.
pub const LOCATED: usize = 10;

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
