//! The key numbers of the report as rows.

use super::Report;
use super::answers::loudest;
use super::changes::Onset;
use crate::study::folder::quoted;
use amontons_analysis::robustness::Estimate;
use amontons_cli::words::robustness::probabilities;

pub const HEAD: [&str; 5] = ["quantity", "value", "low", "high", "unit"];

/// Rows of results.csv; only estimates have an interval of 95 %.
pub fn rows(report: &Report<'_>) -> Vec<[String; 5]> {
    let mut rows = Vec::new();
    let mut plain = |quantity: &str, value: f64, unit: &str| {
        let [quantity, unit] = [quantity, unit].map(quoted);
        rows.push([quantity, format!("{value:?}"), String::new(), String::new(), unit]);
    };
    if let Ok(found) = &report.sliding.found {
        for (number, mode) in found.numbered() {
            plain(&format!("mode {number}: frequency"), mode.frequency_hz(), "Hz");
            plain(&format!("mode {number}: growth rate"), mode.growth_rate(), "1/s");
        }
        for change in found.changes.iter().flatten() {
            if let Some(rate) = change.computed {
                plain(&format!("largest growth rate with {}", change.name()), rate, "1/s");
            }
            if let Onset::At(value) = change.onset {
                plain(&format!("critical µ with {}", change.name()), value, "1");
            }
        }
    }
    if let Ok(over) = &report.sliding.over_friction {
        for one in &over.critical {
            let turns = if one.becomes_unstable { "begins" } else { "ceases" };
            plain(&format!("critical µ, a mode {turns} to grow"), one.value, "1");
        }
    }
    if let Some((motion, measured)) =
        report.loudness.as_ref().ok().and_then(|loud| loudest(&loud.found))
    {
        if let Some(frequency) = motion.ending.frequency {
            plain("loudest motion: frequency", frequency, "Hz");
        }
        let point = measured.loudest();
        plain("loudest motion: speed of the fastest point, rms", point.rms, "m/s");
        plain("loudest motion: speed of the fastest point, at most", point.peak, "m/s");
        plain("loudest motion: amplitude of the fastest point", point.amplitude, "m");
        if let Some(power) = &measured.power {
            plain("loudest motion: power of friction", power.friction, "W");
        }
    }
    let mut estimate = |quantity: &str, Estimate { value, low, high }: Estimate| {
        let [value, low, high] = [value, low, high].map(|value| format!("{value:?}"));
        rows.push([quoted(quantity), value, low, high, quoted("1")]);
    };
    for (place, unstable) in &report.after.unstable {
        if let Ok(found) = unstable {
            let name = super::changes(&report.sliding)[*place].name();
            estimate(&format!("P(unstable) with {name}"), *found);
        }
    }
    if let Some(found) = report.probabilities().and_then(|both| both.eigenvalues.as_ref()) {
        for (name, probability) in probabilities(found) {
            estimate(&name, probability);
        }
    }
    if let Some(runs) = report.probabilities().and_then(|both| both.runs.as_ref()) {
        estimate("P(squeals)", runs.probability);
    }
    rows
}
