//! Numbers and names formatted for output.

use amontons_analysis::stability::locus::Crossing;
pub use amontons_cli::words::{at_frequency, significant};

/// Digits to which parameters are located and printed.
pub const LOCATED: usize = 10;

/// Describes the change of a mode at a crossing, where its growth rate changes sign.
pub fn turn(crossing: &Crossing) -> String {
    format!(
        "mode {} {} {}",
        crossing.mode + 1,
        if crossing.becomes_unstable { "begins to grow" } else { "ceases to grow" },
        at_frequency(crossing.frequency_hz)
    )
}
