//! Numbers and names formatted for output.

use amontons_analysis::stability::locus::Crossing;
pub use amontons_pictures::picture::significant;

/// Digits to which parameters are located and printed.
pub const LOCATED: usize = 10;

/// Describes the motion of a mode at a frequency (Hz); zero is a real eigenvalue.
pub fn at_frequency(frequency_hz: f64) -> String {
    if frequency_hz == 0.0 {
        "without oscillating (real, divergence)".into()
    } else {
        format!("at {frequency_hz:.3} Hz")
    }
}

/// Describes the change of a mode at a crossing, where its growth rate changes sign.
pub fn turn(crossing: &Crossing) -> String {
    format!(
        "mode {} {} {}",
        crossing.mode + 1,
        if crossing.becomes_unstable { "begins to grow" } else { "ceases to grow" },
        at_frequency(crossing.frequency_hz)
    )
}
