//! First root of a polynomial that must not become negative.
//!
//! 1. The leading coefficients that are rounding, one after the other from c_0 on, are dropped, and the rest is
//!    divided by s as often. All that follows is about this rest p. If none is left there is no root; if p(0) < 0 the
//!    root is at 0.
//! 2. If the lower bound of p on [0, 1] is positive, there is no root. The bound comes from Horner's scheme with
//!    s g(s) ≥ min(0, min g): b_k = c_k + min(0, b_{k+1}), begun with −Σ |c_k| of the powers from [`BOUNDED`] on.
//! 3. With −b ≤ p″ on [0, 1] from the same scheme on the coefficients k (k − 1) c_k, p(s) is not below the parabola
//!    p(a) + p′(a) d − b d²/2, d = s − a ≥ 0. So p has no root before that of the parabola, which is the next a:
//!
//!    ```text
//!    d = (p′ + √(p′² + 2 b p)) / b,   which is 2 p / (√(p′² + 2 b p) − p′) for p′ ≤ 0.
//!    ```
//!
//!    It ends with no root beyond 1, and with the root where d ≤ ε a or p(a) ≤ 0. The iteration cannot pass a root,
//!    two close ones included. It converges quadratically to a simple root, as Newton's method, and slower to
//!    multiple ones: [`MOST_STEPS`] end 2e-4 before a root of multiplicity four at 0.5, where p is 2e-15 of its
//!    terms.
//!
//! A function that becomes negative by less than its dropped terms, Σ noise_k s^k, is not seen to do so. Bounds and
//! values of p have the rounding of a sum of its terms, some ε Σ |c_k|.

use super::series::index;

/// Largest number of steps towards a root. Beyond it the present place, where p is still positive, is taken as the
/// root, and the law of contact decides there.
const MOST_STEPS: usize = 10_000;
/// Number of coefficients that enter the lower bound one by one; the others enter by the sum of their magnitudes.
const BOUNDED: usize = 4;

/// Returns the first s in [0, 1] from which on p(s) = Σ c_k s^k is negative; `None` if there is none.
///
/// Leading coefficients count as zero as long as the value is up to the first `noise`, the slope up to the second,
/// and a further coefficient up to the third: the polynomial then goes where the first larger coefficient leads.
pub(super) fn first_negative(coefficients: &[f64], noise: [f64; 3]) -> Option<f64> {
    let noises = noise.into_iter().chain(std::iter::repeat(noise[2]));
    let leading =
        coefficients.iter().zip(noises).take_while(|(c, noise)| c.abs() <= *noise).count();
    // Without negligible coefficients, and divided by s as often: the sign stays.
    let p = &coefficients[leading..];
    let &first = p.first()?;
    if first < 0.0 {
        return Some(0.0);
    }
    if lower_bound(p) > 0.0 {
        return None;
    }
    first_root(p)
}

/// Lower bound of p on [0, 1], since s g(s) is not below min(0, min g).
fn lower_bound(p: &[f64]) -> f64 {
    let (first, rest) = p.split_at(p.len().min(BOUNDED));
    first.iter().rev().fold(-sum_of_sizes(rest), |bound, c| c + bound.min(0.0))
}

/// Σ |c_k|, in four sums that do not wait for each other.
pub(super) fn sum_of_sizes(p: &[f64]) -> f64 {
    let (fours, rest) = p.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for four in fours {
        for (sum, c) in sums.iter_mut().zip(four) {
            *sum += c.abs();
        }
    }
    let rest = rest.iter().fold(0.0, |sum, c| sum + c.abs());
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Lower bound of p'' on [0, 1].
fn least_curvature(p: &[f64]) -> f64 {
    let mut bound = 0.0;
    let mut k = index(p.len());
    for c in p[p.len().min(2)..].iter().rev() {
        k -= 1.0;
        bound = k * (k - 1.0) * c + f64::min(bound, 0.0);
    }
    bound
}

/// Returns the first root of p in [0, 1], where p(0) > 0, by parabolas below p (step 3 of the [module](self)).
fn first_root(p: &[f64]) -> Option<f64> {
    let b = (-least_curvature(p)).max(0.0);
    let mut at = 0.0;
    let [mut value, mut slope] = [p[0], p.get(1).copied().unwrap_or(0.0)];
    for _ in 0..MOST_STEPS {
        let root = (slope * slope + 2.0 * b * value).sqrt();
        let step = if slope > 0.0 { (slope + root) / b } else { 2.0 * value / (root - slope) };
        let next = at + step;
        // Not a number where value, slope and b are zero: p is zero from here on.
        if next.is_nan() || next > 1.0 {
            return None;
        }
        if step <= f64::EPSILON * next {
            return Some(next);
        }
        at = next;
        [value, slope] = value_and_slope(p, at);
        if value <= 0.0 {
            return Some(at);
        }
    }
    Some(at)
}

/// Returns p and p' by Horner's scheme for even and odd powers at once.
fn value_and_slope(p: &[f64], t: f64) -> [f64; 2] {
    let square = t * t;
    let (pairs, last) = p.as_chunks::<2>();
    let (mut value, mut slope) = ([last.first().copied().unwrap_or(0.0), 0.0], [0.0; 2]);
    for pair in pairs.iter().rev() {
        for i in 0..2 {
            slope[i] = slope[i] * square + value[i];
            value[i] = value[i] * square + pair[i];
        }
    }
    // p = e(t²) + t o(t²).
    let [even, odd] = value;
    [even + t * odd, odd + 2.0 * t * (slope[0] + t * slope[1])]
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
            let found = first_negative(&p, [0.0; 3]).unwrap();
            assert!((found - 0.5).abs() < 1e-9 / gap * 1e-6, "{found}");
        }
    }

    #[test]
    fn what_just_does_not_reach_zero_is_not_an_event() {
        let mut p = with_roots(1.0, &[0.5, 0.5]);
        p[0] += 1e-12;
        assert_eq!(first_negative(&p, [0.0; 3]), None);
    }

    #[test]
    fn a_start_at_zero_goes_where_the_next_coefficient_leads() {
        assert_eq!(first_negative(&[0.0, 1.0], [0.0; 3]), None);
        assert_eq!(first_negative(&[0.0, -1.0], [0.0; 3]), Some(0.0));
        assert_eq!(first_negative(&[1e-15, -1e-15, 1.0], [1e-14; 3]), None);
        assert_eq!(first_negative(&[0.0; 5], [0.0; 3]), None);
        // A slope may be nothing where a value or a curvature of that size is not.
        assert_eq!(first_negative(&[0.0, -1e-12, 1.0], [0.0, 1e-11, 0.0]), None);
        assert_eq!(first_negative(&[0.0, 1e-12, -1e-12], [0.0, 1e-11, 1e-13]), Some(0.0));
        assert_eq!(first_negative(&[0.0, -1e-12, 1.0], [1e-11, 0.0, 1e-11]), Some(0.0));
        // Up and back again.
        let found = first_negative(&[0.0, 1.0, -4.0], [0.0; 3]).unwrap();
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
            let found = first_negative(&p, [0.0; 3]);
            if roots[0] > 1.0 {
                prop_assert_eq!(found, None);
            } else {
                prop_assert!((found.unwrap() - roots[0]).abs() < 1e-9, "{:?} {:?}", found, roots);
            }
        }
    }
}
