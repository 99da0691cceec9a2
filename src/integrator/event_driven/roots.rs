//! Where a polynomial that must not be negative becomes so.

use super::series::index;

/// Halvings after which an interval holds no more doubles.
const MOST_HALVINGS: u32 = 60;
/// Newton steps before bisection alone goes on.
const MOST_NEWTON: u32 = 50;

/// The first τ in [0, h] from which on p(τ) = Σ c_k τ^k is negative; `None` if it is not.
///
/// A value up to `noise` counts as zero: the polynomial then goes where its next coefficient
/// leads. No root is missed, two in one interval included: an interval is passed over only if bounds of
/// the polynomial or of its derivative say that it may be, and halved until one of them does.
pub(super) fn first_negative(coefficients: &[f64], h: f64, noise: f64) -> Option<f64> {
    let mut powers = 1.0;
    let mut leading = 0;
    for &c in coefficients {
        if (c * powers).abs() > noise {
            break;
        }
        leading += 1;
        powers *= h;
    }
    // Without what is nothing, and divided by τ as often: the sign stays.
    let p = &coefficients[leading..];
    let &first = p.first()?;
    if first < 0.0 {
        return Some(0.0);
    }
    // |p(τ) − p(0)| on the whole interval.
    let swing = p[1..].iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * h);
    if swing < first {
        return None;
    }
    let curvature = bend(p, h);
    let mut search = Search { p, curvature };
    search.first(0.0, h, 0)
}

/// Σ k (k − 1) |c_k| h^(k−2) ≥ |p''| on [0, h].
fn bend(p: &[f64], h: f64) -> f64 {
    let terms = p.iter().enumerate().skip(2).rev();
    terms.fold(0.0, |sum, (k, c)| {
        let k = index(k);
        sum * h + k * (k - 1.0) * c.abs()
    })
}

struct Search<'a> {
    p: &'a [f64],
    curvature: f64,
}

impl Search<'_> {
    /// The first root with a change of sign from above in [from, to], where p(from) ≥ 0.
    fn first(&mut self, from: f64, to: f64, halvings: u32) -> Option<f64> {
        let middle = from + 0.5 * (to - from);
        let radius = to - middle;
        let [value, slope] = value_and_slope(self.p, middle);
        let bend = self.curvature * radius;
        if value > (slope.abs() + 0.5 * bend) * radius {
            return None;
        }
        if slope > bend {
            // It rises throughout, and does not begin below zero.
            return None;
        }
        if -slope > bend || halvings >= MOST_HALVINGS {
            return (value_and_slope(self.p, to)[0] < 0.0).then(|| self.crossing(from, to));
        }
        self.first(from, middle, halvings + 1).or_else(|| {
            if value < 0.0 { Some(middle) } else { self.first(middle, to, halvings + 1) }
        })
    }

    /// Where the polynomial, falling from `from` to `to`, crosses zero: Newton's method, kept between
    /// bounds that close in. The result is the last double that is known not to be below zero, or a
    /// neighbour of it.
    fn crossing(&self, mut from: f64, mut to: f64) -> f64 {
        let mut at = from + 0.5 * (to - from);
        for step in 0..MOST_NEWTON + MOST_HALVINGS {
            let [value, slope] = value_and_slope(self.p, at);
            if value >= 0.0 {
                from = at;
            } else {
                to = at;
            }
            if value == 0.0 {
                return at;
            }
            let newton = at - value / slope;
            let is_inside = newton >= from && newton <= to && step < MOST_NEWTON;
            let next = if is_inside { newton } else { from + 0.5 * (to - from) };
            if (next - at).abs() <= f64::EPSILON * at {
                return next;
            }
            at = next;
        }
        at
    }
}

/// p and p' by Horner's scheme.
fn value_and_slope(p: &[f64], t: f64) -> [f64; 2] {
    p.iter().rev().fold([0.0, 0.0], |[value, slope], c| [value * t + c, slope * t + value])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The coefficients of s · Π (τ − root).
    fn with_roots(scale: f64, roots: &[f64]) -> Vec<f64> {
        let mut p = vec![scale];
        for root in roots {
            let mut next = vec![0.0; p.len() + 1];
            for (k, c) in p.iter().enumerate() {
                next[k + 1] += c;
                next[k] -= root * c;
            }
            p = next;
        }
        p
    }

    #[test]
    fn two_roots_in_one_interval_are_both_seen() {
        for gap in [1e-3, 1e-6] {
            let p = with_roots(1.0, &[0.5, 0.5 + gap]);
            let found = first_negative(&p, 1.0, 0.0).unwrap();
            assert!((found - 0.5).abs() < 1e-9 / gap * 1e-6, "{found}");
        }
    }

    #[test]
    fn what_just_does_not_reach_zero_is_not_an_event() {
        let mut p = with_roots(1.0, &[0.5, 0.5]);
        p[0] += 1e-12;
        assert_eq!(first_negative(&p, 1.0, 0.0), None);
    }

    #[test]
    fn a_start_at_zero_goes_where_the_next_coefficient_leads() {
        assert_eq!(first_negative(&[0.0, 1.0], 1.0, 0.0), None);
        assert_eq!(first_negative(&[0.0, -1.0], 1.0, 0.0), Some(0.0));
        assert_eq!(first_negative(&[1e-15, -1e-15, 1.0], 1.0, 1e-14), None);
        assert_eq!(first_negative(&[0.0; 5], 1.0, 0.0), None);
        // Up and back again.
        let found = first_negative(&[0.0, 1.0, -4.0], 1.0, 0.0).unwrap();
        assert!((found - 0.25).abs() < 1e-15);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_first_change_of_sign_is_found_to_the_last_digits(
            mut roots in prop::collection::vec(0.05_f64..3.0, 1..7),
        ) {
            roots.sort_by(f64::total_cmp);
            let apart = roots.windows(2).all(|two| two[1] - two[0] > 0.02);
            prop_assume!(apart);
            let sign = if roots.len().is_multiple_of(2) { 1.0 } else { -1.0 };
            let p = with_roots(sign, &roots);
            let found = first_negative(&p, 1.0, 0.0);
            if roots[0] > 1.0 {
                prop_assert_eq!(found, None);
            } else {
                prop_assert!((found.unwrap() - roots[0]).abs() < 1e-9, "{:?} {:?}", found, roots);
            }
        }
    }
}
