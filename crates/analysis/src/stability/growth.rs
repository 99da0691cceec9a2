//! Ranges of a parameter in which modes of a contact state grow.
//!
//! Only modes that grow are followed, from one value to the next by their eigenvalues: the many that decay may cross
//! each other unseen, which makes this a hundred times as quick as a root locus for a ring of eight modules.

use super::locus::{Between, Root, in_branches};
use amontons::Error;
use amontons::numerics::middle;
use std::f64::consts::TAU;

/// Eigenvalues whose frequencies differ by less than this part of their size from one value to the next are one mode's.
const SAME: f64 = 0.05;

/// A range in which one mode grows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GrowthRange {
    /// Range from the first value at which the mode grows to the last.
    pub(super) range: [f64; 2],
    /// `true` if it does not grow below the range; `false` if the values begin inside it.
    pub(super) begins: bool,
    /// The mode at both ends.
    pub(super) ends: [Root; 2],
}

/// All modes at a value of the parameter.
type Modes<'a> = dyn Fn(f64) -> Result<Vec<Root>, Error> + 'a;

/// The ranges in which modes grow, over ascending values; by their starts. One that lies between two neighbouring values
/// is found where two modes come near each other, or σ near zero; else it is missed.
pub(super) fn growth(modes: &Modes<'_>, values: &[f64]) -> Result<Vec<GrowthRange>, Error> {
    let Some(&first) = values.first() else { return Ok(Vec::new()) };
    let all: Result<Vec<_>, Error> = values.iter().map(|&it| Ok((it, modes(it)?))).collect();
    let all = all?;
    let growing = |roots: &[Root]| roots.iter().copied().filter(|root| root.grows()).collect();
    let mut points: Vec<(f64, Vec<Root>)> =
        all.iter().map(|(value, roots)| (*value, growing(roots))).collect();
    let between = Between { evaluate: modes, merge: false, level: 0.0, is_watched: &|_| true };
    for branches in in_branches(all) {
        for value in between.values(&branches)? {
            points.push((value, growing(&modes(value)?)));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let open = |root: Root| GrowthRange { range: [first; 2], begins: false, ends: [root; 2] };
    let now = points[0].1.iter().copied().map(open).collect();
    let mut follower = GrowthFollower { modes, value: first, now, over: Vec::new() };
    for (value, next) in &points[1..] {
        follower.follow_to(*value, next)?;
    }
    let mut found = follower.over;
    found.extend(follower.now);
    found.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]));
    Ok(found)
}

struct GrowthFollower<'a> {
    modes: &'a Modes<'a>,
    value: f64,
    /// Modes that grow at `value`.
    now: Vec<GrowthRange>,
    /// Modes that have ceased to grow.
    over: Vec<GrowthRange>,
}

impl GrowthFollower<'_> {
    /// Moves on to a value with these growing modes, in halves as long as they are not those of before.
    fn follow_to(&mut self, value: f64, next: &[Root]) -> Result<(), Error> {
        let pairs = self.pairs(next);
        let is_whole = pairs.len() == self.now.len() && pairs.len() == next.len();
        if !is_whole && let Some(middle) = middle(self.value, value) {
            let mut found = (self.modes)(middle)?;
            found.retain(|root| root.grows());
            self.follow_to(middle, &found)?;
            return self.follow_to(value, next);
        }
        let mut before: Vec<Option<GrowthRange>> =
            std::mem::take(&mut self.now).into_iter().map(Some).collect();
        for (place, root) in next.iter().enumerate() {
            let from = pairs.iter().find(|(_, to)| *to == place);
            let going = from.and_then(|(from, _)| before[*from].take());
            self.now.push(match going {
                Some(growth) => GrowthRange {
                    range: [growth.range[0], value],
                    ends: [growth.ends[0], *root],
                    ..growth
                },
                None => GrowthRange { range: [value; 2], begins: true, ends: [*root; 2] },
            });
        }
        self.over.extend(before.into_iter().flatten());
        self.value = value;
        Ok(())
    }

    /// Pairs of growing modes that continue each other, the nearest first.
    fn pairs(&self, next: &[Root]) -> Vec<(usize, usize)> {
        let mut all: Vec<(f64, usize, usize)> = Vec::new();
        for (i, before) in self.now.iter().enumerate() {
            for (j, after) in next.iter().enumerate() {
                let [a, b] = [before.ends[1].lambda, after.lambda];
                let apart = (a.im - b.im).abs();
                // Rates of divergence may change by any part of themselves.
                if apart <= SAME * a.norm().max(b.norm()) {
                    all.push(((a - b).norm(), i, j));
                }
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (_, i, j) in all {
            if found.iter().all(|(from, to)| *from != i && *to != j) {
                found.push((i, j));
            }
        }
        found
    }
}

impl GrowthRange {
    /// The mode's frequency, Hz, at the start (0) or the end (1) of its range.
    pub(super) fn frequency_hz(&self, end: usize) -> f64 {
        // A mode that does not oscillate may have a negative zero.
        self.ends[end].lambda.im.abs() / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    fn root(growth: f64, frequency: f64) -> Root {
        let lambda = Complex::new(growth, frequency);
        Root { sigma: -lambda * lambda, lambda }
    }

    fn over(modes: &dyn Fn(f64) -> Vec<Root>, steps: u32) -> Vec<GrowthRange> {
        let values: Vec<f64> = (0..=steps).map(|i| f64::from(i) / f64::from(steps)).collect();
        growth(&|value: f64| Ok(modes(value)), &values).unwrap()
    }

    #[test]
    fn a_range_ends_at_the_last_digit_where_the_growth_rate_changes_its_sign() {
        // One grows from 0.3 to 0.7, one of another frequency up to 0.7 and one from there on.
        let modes = |p: f64| {
            vec![root((p - 0.3) * (0.7 - p), 10.0), root(0.7 - p, 20.0), root(p - 0.7, 30.0)]
        };
        for steps in [4, 9, 200] {
            let found = over(&modes, steps);
            let ranges: Vec<([f64; 2], bool)> =
                found.iter().map(|growth| (growth.range, growth.begins)).collect();
            assert_eq!(ranges.len(), 3, "{found:?}");
            let is_near = |range: [f64; 2], expected: [f64; 2]| {
                (range[0] - expected[0]).abs() < 1e-15 && (range[1] - expected[1]).abs() < 1e-15
            };
            assert!(is_near(ranges[0].0, [0.0, 0.7]) && !ranges[0].1, "{found:?}");
            assert!(is_near(ranges[1].0, [0.3, 0.7]) && ranges[1].1, "{found:?}");
            assert!(is_near(ranges[2].0, [0.7, 1.0]) && ranges[2].1, "{found:?}");
            assert_eq!([0, 1, 2].map(|i| found[i].ends[1].lambda.im), [20.0, 10.0, 30.0]);
        }
    }

    #[test]
    fn modes_that_grow_keep_their_frequencies_where_their_growth_rates_cross() {
        let modes = |p: f64| vec![root(1.0 + p, 10.0 + p), root(2.0 - p, 15.0 - p)];
        let found = over(&modes, 3);
        assert_eq!(found.len(), 2);
        let mut ends: Vec<[f64; 2]> =
            found.iter().map(|growth| growth.ends.map(|root| root.lambda.im)).collect();
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert_eq!(ends, [[10.0, 11.0], [15.0, 14.0]]);
    }

    #[test]
    fn a_mode_that_ceases_to_oscillate_is_still_one_mode() {
        // Im λ falls as a root to zero at 0.5, from where on it is real.
        let modes = |p: f64| {
            let d = 0.5 - p;
            vec![if d > 0.0 { root(1.0, 10.0 * d.sqrt()) } else { root(1.0 + (-d).sqrt(), 0.0) }]
        };
        let found = over(&modes, 8);
        let [one] = &found[..] else { panic!("{found:?}") };
        assert_eq!((one.range, one.begins), ([0.0, 1.0], false));
    }

    #[test]
    fn modes_that_grow_between_two_values_alone_are_found_where_they_come_near_each_other() {
        // λ = 10 i − 1e-7 ± √((w/2)² − (p − p₀)²), which grows over less than a millionth of a step.
        for place in 0..20 {
            let place = (0.1 + 0.618_033_988_749_895 * f64::from(place)).fract().clamp(0.01, 0.99);
            let half = 2e-7;
            let modes = |p: f64| {
                let apart = Complex::from((half - p + place) * (half + p - place)).sqrt();
                [apart, -apart]
                    .map(|apart| {
                        let lambda = Complex::new(-1e-7, 10.0) + apart;
                        Root { sigma: -lambda * lambda, lambda }
                    })
                    .to_vec()
            };
            for steps in [8, 40, 200] {
                let found = over(&modes, steps);
                let [one] = &found[..] else { panic!("{place} {steps}: {found:?}") };
                let end = f64::sqrt(half * half - 1e-14);
                let off = [one.range[0] - place + end, one.range[1] - place - end];
                assert!(one.begins && off.iter().all(|off| off.abs() < 1e-12), "{place} {one:?}");
            }
        }
    }
}
