//! Attractors as tables and legends have them.

use crate::say::say;
use amontons::decimal::to_significant;
use amontons::scene::Scene;
use amontons::simulation::variables;
use amontons_analysis::study::{Ending, Kind, unit};
use amontons_pictures::picture::prefixed;

/// "quasi-periodic, 0.12 mm, 167.3 Hz"; "rest".
pub fn words(ending: &Ending, unit: &str) -> String {
    if ending.kind == Kind::Equilibrium {
        return "rest".to_owned();
    }
    let frequency = ending.frequency.map_or_else(String::new, |f| format!(", {f:.2} Hz"));
    format!("{}, {}{frequency}", ending.kind.name(), four_digits(ending.amplitude, unit))
}

/// A number of an attractor, from 1; empty without one.
pub fn number(attractor: Option<usize>) -> String {
    attractor.map_or_else(String::new, |place| (place + 1).to_string())
}

/// Prints the attractors, one a line.
pub fn print(attractors: &[Ending], of: &str, unit: &str) {
    say!(
        "\nattractors (amplitude and strongest frequency of {of}; motions that differ in their place alone, or are mirror \
         images of each other, are one)"
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

/// A value with its unit to four digits.
pub fn four_digits(value: f64, unit: &str) -> String {
    prefixed(to_significant(value, 4), unit)
}

/// The unit of a variable of a scene.
pub fn unit_of(scene: &Scene, name: &str) -> &'static str {
    variables(scene).iter().find(|variable| variable.name == name).map_or("1", unit)
}
