//! Attractors formatted for legends.

use amontons::decimal::to_significant;
use amontons::scene::Scene;
use amontons::simulation::variables;
use amontons_analysis::study::{Kind, LongTermMotion, unit};
use amontons_pictures::picture::prefixed;

/// Describes a motion: "quasi-periodic, 0.12 mm, 167.3 Hz"; "rest".
#[must_use]
pub fn words(ending: &LongTermMotion, unit: &str) -> String {
    if ending.kind == Kind::Equilibrium {
        return "rest".to_owned();
    }
    let frequency = ending.frequency.map_or_else(String::new, |f| format!(", {f:.2} Hz"));
    format!("{}, {}{frequency}", ending.kind.name(), four_digits(ending.amplitude, unit))
}

/// A value with its unit to four digits.
#[must_use]
pub fn four_digits(value: f64, unit: &str) -> String {
    prefixed(to_significant(value, 4), unit)
}

/// The unit of a variable of a scene.
#[must_use]
pub fn unit_of(scene: &Scene, name: &str) -> &'static str {
    variables(scene).iter().find(|variable| variable.name == name).map_or("1", unit)
}
