//! Attractors formatted for tables.

use amontons_analysis::study::{Kind, LongTermMotion};
use amontons_cli::charts::attractor::words;
use amontons_cli::say;

/// Number of an attractor, from 1; empty if there is none.
pub fn number(attractor: Option<usize>) -> String {
    attractor.map_or_else(String::new, |place| (place + 1).to_string())
}

/// Prints the attractors, one per line.
pub fn print(attractors: &[LongTermMotion], of: &str, unit: &str) {
    say!(
        "\nattractors (amplitude and strongest frequency of {of}; motions that differ only in position, or are mirror \
         images of each other, count as one)"
    );
    for (place, ending) in attractors.iter().enumerate() {
        say!("  {}  {}", place + 1, words(ending, unit));
        if let Some(evidence) = ending.evidence().filter(|_| ending.kind == Kind::Undecided) {
            say!("     {evidence}");
        }
    }
    if !attractors.iter().any(|ending| ending.kind.is_cycle()) {
        say!("  no limit cycle was found");
    }
}
