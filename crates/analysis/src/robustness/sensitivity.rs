//! Sobol indices: which parameter a scattering result is due to.
//!
//! Points A and B are the two halves of the coordinates of one scrambled net; A_B(i) is A with coordinate i of B. First-order
//! indices are Saltelli's of 2010, S_i = mean(f(B) (f(A_B(i)) − f(A))) / V with f from its mean (Saltelli et al., Comput.
//! Phys. Commun. 181, 259–270, table 2b); total ones are Jansen's, T_i = mean((f(A) − f(A_B(i)))²) / 2V (Jansen, Comput. Phys.
//! Commun. 117 (1999), 35–43).

use super::interval::{Estimate, FEW, of_estimates, of_share};
use super::sobol::Scrambled;
use amontons::Error;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The indices of one parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Index {
    /// The part of the variance that the parameter causes by itself.
    pub first: Estimate,
    /// The part of the variance that is left if all other parameters are known.
    pub total: Estimate,
}

/// Sums over points, from which indices follow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    count: u64,
    /// Sums of f(A), f(B), f(A)² + f(B)² and f(A) f(B).
    a: f64,
    b: f64,
    squares: f64,
    product: f64,
    /// For each parameter the sums of f(A_B), f(B) f(A_B) and (f(A) − f(A_B))².
    exchanged: Vec<[f64; 3]>,
}

impl Sums {
    fn add(&mut self, a: f64, b: f64, exchanged: &[f64]) {
        self.count += 1;
        self.a += a;
        self.b += b;
        self.squares += a * a + b * b;
        self.product += a * b;
        self.exchanged.resize(exchanged.len(), [0.0; 3]);
        for (sums, &x) in self.exchanged.iter_mut().zip(exchanged) {
            for (sum, value) in sums.iter_mut().zip([x, b * x, (a - x) * (a - x)]) {
                *sum += value;
            }
        }
    }

    /// Adds the sums over other points.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.a += other.a;
        self.b += other.b;
        self.squares += other.squares;
        self.product += other.product;
        self.exchanged.resize(other.exchanged.len(), [0.0; 3]);
        for (sums, others) in self.exchanged.iter_mut().zip(&other.exchanged) {
            sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other);
        }
    }

    /// First-order and total index of each parameter; `None` if f does not vary.
    #[allow(clippy::cast_precision_loss)]
    fn indices(&self) -> Option<Vec<[f64; 2]>> {
        let n = self.count as f64;
        let mean = (self.a + self.b) / (2.0 * n);
        let variance = self.squares / (2.0 * n) - mean * mean;
        // What is left of a constant is its rounding.
        if variance <= 1e-12 * self.squares / (2.0 * n) {
            return None;
        }
        let of = |[x, b_x, apart]: &[f64; 3]| {
            let first = (b_x - self.product - mean * (x - self.a)) / n;
            [first / variance, apart / (2.0 * n) / variance]
        };
        Some(self.exchanged.iter().map(of).collect())
    }
}

/// Which of the points of a design a function is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A draw of all parameters.
    Draw,
    /// A point that the indices alone need.
    Exchange,
}

/// Several results at a point, each of which may be undefined there.
type Results<const N: usize> = Result<[Option<f64>; N], Error>;

/// The sums of several results of `f` over the points of these numbers; a result's sums are `None` if it is not defined at
/// one of the points. `points` have twice as many coordinates as f.
///
/// # Errors
/// Returns an error if `f` does.
pub fn sums_over<const N: usize>(
    points: &Scrambled<'_>,
    dimensions: usize,
    numbers: Range<u64>,
    f: &mut dyn FnMut(Role, &[f64]) -> Results<N>,
) -> Result<[Option<Sums>; N], Error> {
    let mut sums: [Option<Sums>; N] = std::array::from_fn(|_| Some(Sums::default()));
    let mut exchanged = vec![[None; N]; dimensions];
    for number in numbers {
        let half = |from: usize| {
            (from..from + dimensions).map(|d| points.coordinate(number, d)).collect::<Vec<_>>()
        };
        let (mut a, b) = (half(0), half(dimensions));
        let of_a = f(Role::Draw, &a)?;
        let of_b = f(Role::Exchange, &b)?;
        for (place, found) in exchanged.iter_mut().enumerate() {
            let own = std::mem::replace(&mut a[place], b[place]);
            *found = f(Role::Exchange, &a)?;
            a[place] = own;
        }
        for (result, sums) in sums.iter_mut().enumerate() {
            let exchanged: Option<Vec<f64>> = exchanged.iter().map(|of| of[result]).collect();
            match (of_a[result], of_b[result], exchanged, &mut *sums) {
                (Some(a), Some(b), Some(exchanged), Some(sums)) => sums.add(a, b, &exchanged),
                _ => *sums = None,
            }
        }
    }
    Ok(sums)
}

/// The indices from the sums of each scrambling, at least two; `None` if the function does not vary without one of them.
///
/// An index is a ratio of means over all scramblings. Pseudo-values of the jackknife, R θ − (R − 1) θ₋ᵣ with θ₋ᵣ from all scramblings
/// but one, take out most of the ratio's bias, and are nearly independent estimates of the index (Efron and Stein, Ann. Statist. 9
/// (1981), 586–596).
#[must_use]
#[allow(clippy::cast_precision_loss)]
pub fn indices(scramblings: &[Sums]) -> Option<Vec<Index>> {
    let all = merged(scramblings.iter()).indices()?;
    let without = |left: usize| {
        let others = scramblings.iter().enumerate().filter(|(place, _)| *place != left);
        merged(others.map(|(_, sums)| sums)).indices()
    };
    let without: Vec<Vec<[f64; 2]>> = (0..scramblings.len()).map(without).collect::<Option<_>>()?;
    let count = scramblings.len() as f64;
    let of = |parameter: usize, kind: usize| {
        let all = all[parameter][kind];
        let pseudo = without.iter().map(|one| count * all - (count - 1.0) * one[parameter][kind]);
        of_estimates(&pseudo.collect::<Vec<f64>>())
    };
    Some((0..all.len()).map(|i| Index { first: of(i, 0), total: of(i, 1) }).collect())
}

/// The indices of a function that is 0 or 1, from the sums of each scrambling; `None` if fewer than 32 of all points A and B are
/// 0, or 1.
///
/// A first-order index counts pairs of B and A_B that are both of the rarer kind, a total one pairs of A and A_B that differ. With fewer
/// than 32 pairs the estimates of scramblings are skew, and the interval is Clopper and Pearson's for the number of pairs.
#[must_use]
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn indices_of_share(scramblings: &[Sums]) -> Option<Vec<Index>> {
    let all = merged(scramblings.iter());
    let (count, ones) = (all.count as f64, all.a + all.b);
    if ones < FEW as f64 || 2.0 * count - ones < FEW as f64 {
        return None;
    }
    let mut found = indices(scramblings)?;
    let mean = ones / (2.0 * count);
    let variance = mean * (1.0 - mean);
    let rare = mean.min(1.0 - mean);
    let pairs = |hits: f64, of: &dyn Fn(f64) -> f64| {
        let Estimate { value, low, high } = of_share(hits as u64, all.count);
        (hits < FEW as f64).then(|| Estimate { value: of(value), low: of(low), high: of(high) })
    };
    for (index, [x, both, apart]) in found.iter_mut().zip(&all.exchanged) {
        let both = if mean > 0.5 { count - all.b - x + both } else { *both };
        let first = pairs(both, &|share| (share - rare * rare) / variance);
        let total = pairs(*apart, &|share| share / (2.0 * variance));
        (index.first, index.total) = (first.unwrap_or(index.first), total.unwrap_or(index.total));
    }
    Some(found)
}

fn merged<'a>(sums: impl Iterator<Item = &'a Sums>) -> Sums {
    let mut merged = Sums::default();
    sums.for_each(|sums| merged.merge(sums));
    merged
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::sobol::Sobol;
    use super::*;
    use std::f64::consts::PI;

    /// The sums of each scrambling of a function on the unit cube.
    fn sums(
        (scramblings, points, seed): (u64, u64, u64),
        dimensions: usize,
        f: impl Fn(&[f64]) -> f64,
    ) -> Vec<Sums> {
        let sobol = Sobol::new(2 * dimensions);
        let sums = |scrambling| {
            let net = Scrambled::new(&sobol, seed, scrambling);
            let [sums] =
                sums_over(&net, dimensions, 0..points, &mut |_, x| Ok([Some(f(x))])).unwrap();
            sums.unwrap()
        };
        (0..scramblings).map(sums).collect()
    }

    /// The indices of a function on the unit cube.
    fn found(size: (u64, u64, u64), dimensions: usize, f: impl Fn(&[f64]) -> f64) -> Vec<Index> {
        indices(&sums(size, dimensions, f)).unwrap()
    }

    const FACTORS: [f64; 4] = [1.0, 2.0, 0.5, 0.0];

    fn linear(x: &[f64]) -> f64 {
        x.iter().zip(FACTORS).map(|(x, a)| a * x).sum::<f64>() + 1e3
    }

    /// Ishigami's function with a = 7 and b = 0.1, and its indices in closed form.
    fn ishigami(x: &[f64]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| PI * (2.0 * x[i] - 1.0));
        x.sin() + 7.0 * y.sin().powi(2) + 0.1 * z.powi(4) * x.sin()
    }

    fn of_ishigami() -> [[f64; 2]; 3] {
        let (a, b) = (7.0, 0.1);
        let x = 0.5 * (1.0 + b * PI.powi(4) / 5.0_f64).powi(2);
        let y = a * a / 8.0;
        let xz = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let all = x + y + xz;
        [[x / all, (x + xz) / all], [y / all, y / all], [0.0, xz / all]]
    }

    #[test]
    fn indices_of_a_sum_are_the_parts_of_its_variance() {
        let all: f64 = FACTORS.iter().map(|a| a * a).sum();
        let found = found((16, 1024, 1), 4, linear);
        for (index, a) in found.iter().zip(FACTORS) {
            let part = a * a / all;
            assert!((index.first.value - part).abs() < 2e-3, "{index:?} {part}");
            assert!((index.total.value - part).abs() < 2e-3, "{index:?} {part}");
        }
        // A parameter without effect has a total index of exactly zero.
        assert_eq!(found[3].total.high, 0.0);
    }

    #[test]
    fn indices_of_ishigamis_function_are_its_closed_form() {
        let found = found((16, 4096, 1), 3, ishigami);
        for (index, [first, total]) in found.iter().zip(of_ishigami()) {
            assert!((index.first.value - first).abs() < 5e-3, "{index:?} {first}");
            assert!((index.total.value - total).abs() < 5e-3, "{index:?} {total}");
            assert!(index.first.high - index.first.low < 0.02);
        }
    }

    /// f is 1 if three coordinates are below their bounds, two of which are alike; a fourth has no effect. With p the probability of
    /// 1, the indices of a coordinate with the bound w are p (1/w − 1) and 1 − w, both over 1 − p.
    fn rare(p: f64) -> (impl Fn(&[f64]) -> f64, [[f64; 2]; 4]) {
        let bounds = [p.powf(0.25), p.powf(0.25), p.sqrt()];
        let f = move |x: &[f64]| f64::from(u8::from(x.iter().zip(bounds).all(|(x, w)| *x < w)));
        let of = |w: f64| [p * (1.0 / w - 1.0) / (1.0 - p), (1.0 - w) / (1.0 - p)];
        (f, [of(bounds[0]), of(bounds[1]), of(bounds[2]), [0.0; 2]])
    }

    #[test]
    fn indices_of_rare_ones_and_of_rare_zeros_are_those_of_the_closed_form() {
        let (f, expected) = rare(0.01);
        let ones = indices_of_share(&sums((16, 1024, 1), 4, &f)).unwrap();
        let zeros = indices_of_share(&sums((16, 1024, 1), 4, |x| 1.0 - f(x))).unwrap();
        for ((one, zero), [first, total]) in ones.iter().zip(&zeros).zip(expected) {
            for (found, expected) in [(one.first, first), (one.total, total)] {
                // Twice the interval holds nearly all estimates.
                let Estimate { value, low, high } = found;
                let twice = 2.0 * low - value..=2.0 * high - value;
                assert!(twice.contains(&expected), "{found:?} {expected}");
            }
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
            assert!(near(one.first.low, zero.first.low) && near(one.first.high, zero.first.high));
            assert!(near(one.total.low, zero.total.low) && near(one.total.high, zero.total.high));
        }
        // Some ten of them in all.
        let (f, _) = rare(0.0003);
        assert_eq!(indices_of_share(&sums((16, 1024, 1), 4, f)), None);
    }

    /// Repetitions of a study with other seeds. The part of them whose intervals of 95 % hold the truth scatters by a standard deviation
    /// of 0.7 %.
    const REPETITIONS: u64 = 1000;

    /// The number of repetitions in which the interval of each index, first-order and total, holds the closed form.
    fn held(expected: &[[f64; 2]], found: impl Fn(u64) -> Vec<Index>) -> Vec<[u32; 2]> {
        let mut held = vec![[0; 2]; expected.len()];
        for seed in 1..=REPETITIONS {
            for ((index, [first, total]), held) in found(seed).iter().zip(expected).zip(&mut held) {
                held[0] += u32::from(index.first.holds(*first));
                held[1] += u32::from(index.total.holds(*total));
            }
        }
        held
    }

    /// With 2, 5 and 10 ones in each half of a scrambling. Intervals of few pairs are exact ones, which hold more than 95 %.
    #[test]
    #[ignore = "long: 1000 studies of each probability"]
    fn intervals_of_indices_of_what_is_rare_hold_the_closed_form_in_95_percent_of_repetitions() {
        for (points, hits) in
            [(256_u32, 2.0), (256, 5.0), (256, 10.0), (1024, 2.0), (1024, 5.0), (1024, 10.0)]
        {
            let (f, expected) = rare(hits / f64::from(points));
            let size = |seed| (16, u64::from(points), seed);
            let held = held(&expected, |seed| indices_of_share(&sums(size(seed), 4, &f)).unwrap());
            println!("{hits} of {points}: {held:?} of {REPETITIONS}");
            assert!(held.iter().flatten().all(|held| *held >= 920), "{hits} of {points}: {held:?}");
        }
    }

    #[test]
    #[ignore = "long: 1000 studies of each function"]
    fn intervals_of_indices_hold_the_closed_form_in_95_percent_of_repetitions() {
        let all: f64 = FACTORS.iter().map(|a| a * a).sum();
        let of_sum = FACTORS[..3].iter().map(|a| [a * a / all; 2]).collect::<Vec<_>>();
        type Case<'a> = (&'a str, usize, fn(&[f64]) -> f64, Vec<[f64; 2]>);
        let cases: [Case<'_>; 2] =
            [("sum", 4, linear, of_sum), ("ishigami", 3, ishigami, of_ishigami().to_vec())];
        for (name, dimensions, f, expected) in cases {
            let held = held(&expected, |seed| found((16, 512, seed), dimensions, f));
            println!("{name}: {held:?} of {REPETITIONS}");
            for held in held.iter().flatten() {
                assert!((920..=980).contains(held), "{name}: {held} of {REPETITIONS}");
            }
        }
    }
}
