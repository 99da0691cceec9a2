//! Intervals of 95 % for means of independent estimates, and for shares.

use crate::statistics::{mean, variance};
use amontons::numerics::bisect;
use serde::Serialize;
use std::f64::consts::PI;

/// The part of intervals that hold the true value.
const CONFIDENCE: f64 = 0.95;
/// With fewer draws of one kind than these, the estimates are too skew for Student's t.
pub(super) const FEW: u64 = 32;
/// A rule of three: what did not occur in n independent trials has, with 95 %, a probability below 3/n.
const THREE: f64 = 3.0;

/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimated value.
    pub value: f64,
    /// The lower end of the interval of 95 %.
    pub low: f64,
    /// The upper end of the interval of 95 %.
    pub high: f64,
}

impl Estimate {
    /// `true` if the interval holds this value.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// The mean of independent estimates, at least two, with its interval by Student's t.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn of_estimates(estimates: &[f64]) -> Estimate {
    let freedoms = estimates.len() - 1;
    let value = mean(estimates);
    // The variance of the estimates is that about their mean, and that of the mean is its part.
    let half = student(freedoms) * (variance(estimates) / freedoms as f64).sqrt();
    Estimate { value, low: value - half, high: value + half }
}

/// A probability from the numbers of draws, of `points` in each of several independent scramblings, for which something
/// is true.
///
/// The interval is that of the scramblings' estimates by Student's t; it reaches at least 3/n to both sides, n being the number
/// of all draws: estimates that are all alike leave as much open. If it is true, or not true, for fewer than 32 draws,
/// the interval is Clopper and Pearson's for n independent draws, which scrambled ones surpass.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn of_counts(counts: &[u64], points: u64) -> Estimate {
    let (all, hits) = (points * counts.len() as u64, counts.iter().sum::<u64>());
    if hits < FEW || all - hits < FEW {
        return of_share(hits, all);
    }
    let estimates: Vec<f64> = counts.iter().map(|count| *count as f64 / points as f64).collect();
    let Estimate { value, low, high } = of_estimates(&estimates);
    let least = THREE / all as f64;
    Estimate { value, low: low.min(value - least).max(0.0), high: high.max(value + least).min(1.0) }
}

/// A probability from independent draws, with Clopper and Pearson's interval (Biometrika 26, 1934, 404–413), which holds the
/// true value with at least 95 %.
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn of_share(hits: u64, draws: u64) -> Estimate {
    let value = hits as f64 / draws as f64;
    let high = upper_bound(hits, draws);
    let low = 1.0 - upper_bound(draws - hits, draws);
    Estimate { value, low, high }
}

/// The probability with which no more than `hits` of `draws` occur with 2.5 %; 1 if all are hits.
fn upper_bound(hits: u64, draws: u64) -> f64 {
    if hits == draws {
        return 1.0;
    }
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let [_, found] = bisect(0.0, 1.0, |p| at_most(hits, draws, p) >= tail);
    found
}

/// The probability of at most `hits`, fewer than `draws`, in independent draws of probability p, above 0 and below 1.
#[allow(clippy::cast_precision_loss)]
fn at_most(hits: u64, draws: u64, p: f64) -> f64 {
    // The shorter of the two tails is summed.
    if 2 * hits > draws {
        return 1.0 - at_most(draws - hits - 1, draws, 1.0 - p);
    }
    let n = draws as f64;
    let [yes, no] = [libm::log(p), libm::log1p(-p)];
    let choices = libm::lgamma(n + 1.0);
    let of = |k: u64| {
        let k = k as f64;
        let ways = choices - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
        libm::exp(ways + k * yes + (n - k) * no)
    };
    // The largest terms are added last.
    (0..=hits).map(of).sum()
}

/// Student's t for a two-sided interval of 95 %.
#[must_use]
pub fn student(freedoms: usize) -> f64 {
    let [_, found] = bisect(0.0, 100.0, |t| within(t, freedoms) <= CONFIDENCE);
    found
}

/// The probability of a value between −t and t: Abramowitz and Stegun, 26.7.3 and 26.7.4.
#[allow(clippy::cast_precision_loss)]
fn within(t: f64, freedoms: usize) -> f64 {
    let angle = libm::atan(t / (freedoms as f64).sqrt());
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let is_odd = freedoms % 2 == 1;
    let mut term = if is_odd { cos } else { 1.0 };
    let mut sum = 0.0;
    for power in (if is_odd { 1 } else { 0 }..freedoms.saturating_sub(1)).step_by(2) {
        sum += term;
        term *= cos * cos * (power + 1) as f64 / (power + 2) as f64;
    }
    if is_odd { 2.0 / PI * (angle + sin * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_students_t_are_those_of_printed_tables() {
        for (freedoms, printed) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (15, 2.131),
            (30, 2.042),
            (120, 1.980),
        ] {
            assert!((student(freedoms) - printed).abs() < 5e-4, "{freedoms}");
        }
    }

    #[test]
    fn clopper_and_pearsons_interval_has_its_closed_forms_at_the_ends() {
        let none = of_share(0, 1000);
        assert!(none.low.abs() < 1e-12 && (none.high - (1.0 - 0.025_f64.powf(1e-3))).abs() < 1e-12);
        let all = of_share(50, 50);
        assert!(all.high == 1.0 && (all.low - 0.025_f64.powf(0.02)).abs() < 1e-12);
        // Clopper and Pearson's own kind of example: 3 of 10, from a table of beta quantiles.
        let some = of_share(3, 10);
        assert!((some.low - 0.066_74).abs() < 1e-5 && (some.high - 0.652_45).abs() < 1e-5);
    }

    #[test]
    fn estimates_that_are_all_alike_leave_open_what_their_number_cannot_show() {
        let found = of_counts(&[500; 16], 1000);
        assert_eq!(found.value, 0.5);
        assert!((found.high - 0.5 - 3.0 / 16_000.0).abs() < 1e-15);
        // None at all: no more than the bound for independent draws.
        let none = of_counts(&[0; 16], 1000);
        assert!(none.low.abs() < 1e-12 && none.high > 3.0 / 16_000.0 && none.high < 4.0 / 16_000.0);
    }
}
