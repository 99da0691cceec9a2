//! Robustness in words: probabilities, indices, and the ends of runs after pushes.

use amontons_analysis::robustness::{Band, End, Estimate, Robustness, Squeals};

/// A probability and its interval in per cent.
#[must_use]
pub fn percent(estimate: &Estimate) -> String {
    let [value, low, high] =
        [estimate.value, estimate.low, estimate.high].map(|value| 100.0 * value);
    format!("{value:.4} %  ({low:.4} to {high:.4})")
}

/// A part and its interval.
#[must_use]
pub fn part(estimate: &Estimate) -> String {
    format!("{:.4}  ({:.4} to {:.4})", estimate.value, estimate.low, estimate.high)
}

/// The probabilities by their names.
#[must_use]
pub fn probabilities(found: &Robustness) -> Vec<(String, Estimate)> {
    let mut all = vec![
        ("P(unstable)".to_owned(), found.unstable),
        ("P(stable)".to_owned(), found.stable),
        ("P(no equilibrium)".to_owned(), found.no_equilibrium),
    ];
    all.extend(
        found.bands.iter().map(|band| (format!("P(growth {})", range(band)), band.unstable)),
    );
    all
}

/// The frequencies of a band.
fn range(band: &Band) -> String {
    let [from, to] = band.frequencies;
    match to {
        0.0 => "without oscillation".to_owned(),
        _ => format!("from {from:.1} to {to:.1} Hz"),
    }
}

/// The reason why the largest growth rate has no indices.
#[must_use]
pub fn growth_without_indices(found: &Robustness) -> &'static str {
    if found.no_equilibrium.value > 0.0 {
        "draws without equilibrium have none"
    } else {
        "it does not vary, or one of the points that indices need besides the draws has no equilibrium"
    }
}

/// The reason why instability has no indices.
pub const INSTABILITY_WITHOUT_INDICES: &str =
    "fewer than 32 points are unstable, or stable; more --points may have more";

/// The ends of runs with their numbers; ends that are rare are left out where no run has them.
#[must_use]
pub fn ends(runs: &Squeals) -> Vec<(u64, &'static str)> {
    let all = [End::Rests, End::Squeals, End::NotSettled, End::NoEquilibrium, End::Failed];
    let told = all.into_iter().filter(|end| {
        runs.count(*end) > 0 || matches!(end, End::Rests | End::Squeals | End::NotSettled)
    });
    told.map(|end| (runs.count(end), end.name())).collect()
}

/// The probability of squeal, per cent, and its interval.
#[must_use]
pub fn squeal(runs: &Squeals) -> String {
    let Estimate { value, low, high } = runs.probability;
    let value = if runs.at_most > value {
        format!("{:.2} to {:.2}", 100.0 * value, 100.0 * runs.at_most)
    } else {
        format!("{:.2}", 100.0 * value)
    };
    format!("{value} %  ({:.2} to {:.2})", 100.0 * low, 100.0 * high)
}
