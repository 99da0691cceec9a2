//! Events of root loci, located to the last digits: roots that merge, and modes that begin to grow.

use super::follow::{Evaluate, Watched};
use super::{Approach, Coalescence, Crossing, Root};
use amontons::{Error, numerics};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Bisects on whether the root nearest to a merging pair's centre is real; the centre is known at two
/// values.
pub(super) fn locate_coalescence(
    evaluate: &Evaluate<'_>,
    modes: [usize; 2],
    [from, to]: [(f64, Complex<f64>); 2],
    merge: bool,
) -> Result<Coalescence, Error> {
    let at = |value: f64| -> Result<Root, Error> {
        let part = (value - from.0) / (to.0 - from.0);
        Ok(nearest(evaluate(value)?, from.1 + (to.1 - from.1) * part))
    };
    let (mut low, mut high) = (from.0, to.0);
    while let Some(middle) = numerics::middle(low, high) {
        if at(middle)?.is_real() == merge { low = middle } else { high = middle }
    }
    let value = 0.5 * (low + high);
    Ok(Coalescence { value, modes, frequency_hz: at(value)?.lambda.im / TAU, merge })
}

/// Number of points by regula falsi that may fail to halve an interval before its middle is taken.
const PATIENCE: u32 = 3;

/// A change of the sign of Re λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Located {
    pub(super) crossing: Crossing,
    /// `true` if the mode is one of a pair of which the other grows already: one growing mode that oscillates becomes two that
    /// do not.
    pub(super) is_split: bool,
}

/// A value of the parameter and the root of a branch there.
pub(super) type BranchPoint = (f64, Root);

/// Locates a change of the sign of Re λ along one branch, between two points that differ in it, to neighbouring doubles.
/// Points are chosen by regula falsi (with the weights of the Illinois algorithm), and in the middle where that narrows the
/// interval too slowly.
pub(super) fn locate_crossing(
    evaluate: &Evaluate<'_>,
    mode: usize,
    [from, to]: [BranchPoint; 2],
) -> Result<Located, Error> {
    let (mut low, mut high) = (from, to);
    let mut weights = [low, high].map(|(_, root)| root.lambda.re);
    let (mut last_side, mut patience) = (None, PATIENCE);
    let mut goal = 0.5 * (high.0 - low.0);
    while let Some(middle) = numerics::middle(low.0, high.0) {
        let falsi = low.0 - weights[0] * (high.0 - low.0) / (weights[1] - weights[0]);
        let is_inside = low.0 < falsi && falsi < high.0;
        let value = if is_inside && patience > 0 { falsi } else { middle };
        let point = on_branch(evaluate, [low, high], value)?;
        let side = usize::from(point.1.grows() != from.1.grows());
        *[&mut low, &mut high][side] = point;
        weights[side] = point.1.lambda.re;
        if last_side == Some(side) {
            weights[1 - side] *= 0.5;
        }
        last_side = Some(side);
        patience = patience.saturating_sub(1);
        if high.0 - low.0 <= goal {
            (goal, patience) = (0.5 * (high.0 - low.0), PATIENCE);
        }
    }
    // The frequency is that of the mode which grows: zero where it diverges.
    let (stable, growing) = if from.1.grows() { (high, low) } else { (low, high) };
    let frequency_hz = growing.1.lambda.im / TAU;
    let becomes_unstable = to.1.grows();
    let crossing = Crossing { value: stable.0, mode, frequency_hz, becomes_unstable };
    // Of two conjugate σ about a negative value one belongs to a mode that grows.
    let is_split = growing.1.is_real() && growing.1.sigma.re < 0.0 && !stable.1.is_real();
    Ok(Located { crossing, is_split: is_split && stable.1.sigma.re < 0.0 })
}

/// The root at `value` of a branch that is known at two points: the nearest to the line between.
pub(super) fn on_branch(
    evaluate: &Evaluate<'_>,
    [low, high]: [BranchPoint; 2],
    value: f64,
) -> Result<BranchPoint, Error> {
    let part = (value - low.0) / (high.0 - low.0);
    let expected = low.1.sigma + (high.1.sigma - low.1.sigma) * part;
    Ok((value, nearest(evaluate(value)?, expected)))
}

/// Pairs of crossings between two neighbouring points at which a branch is on the same side. Where
/// Re λ comes nearest to zero among the points, its extremum is sought beside that place.
pub(super) fn hidden_crossings(
    evaluate: &Evaluate<'_>,
    watched: Watched,
    trace: &[BranchPoint],
    mode: usize,
) -> Result<Vec<Located>, Error> {
    let mut found = Vec::new();
    for three in trace.windows(3) {
        let [left, middle, right] = *three else { unreachable!("windows of three") };
        let one_side = [left, right].iter().all(|point| point.1.grows() == middle.1.grows());
        let below = |point: &BranchPoint| -point.1.lambda.re.abs();
        let rise = [left, right].map(|side| below(&middle) - below(&side));
        let is_peak = watched.contains(middle.1) && one_side && rise[0] >= 0.0 && rise[1] > 0.0;
        // A smooth curve rises between points by no more than it fell to the next.
        if !is_peak || below(&middle) + 2.0 * rise[0].max(rise[1]) < 0.0 {
            continue;
        }
        if let Some(other) = other_side(evaluate, [left, middle, right])? {
            let [before, after] = if other.0 < middle.0 { [left, middle] } else { [middle, right] };
            found.push(locate_crossing(evaluate, mode, [before, other])?);
            found.push(locate_crossing(evaluate, mode, [other, after])?);
        }
    }
    Ok(found)
}

/// A point beside the middle one where Re λ has the other sign, if there is one.
fn other_side(
    evaluate: &Evaluate<'_>,
    points: [BranchPoint; 3],
) -> Result<Option<BranchPoint>, Error> {
    let is_other = |root: &Root| root.grows() != points[1].1.grows();
    let root = |known: [BranchPoint; 2], value: f64| Ok(on_branch(evaluate, known, value)?.1);
    let found = golden_section(points, &root, &|root| root.lambda.re.abs(), &is_other)?;
    Ok(is_other(&found.1).then_some(found))
}

/// Modes further apart than this part of their frequency do not come near each other.
const NEAR: f64 = 0.05;

/// Values at which watched modes come nearest to each other, by the points of all branches, which are at the same values.
pub(super) fn closest_approaches(
    evaluate: &Evaluate<'_>,
    watched: Watched,
    trace: &[Vec<BranchPoint>],
) -> Result<Vec<Approach>, Error> {
    let mut found = Vec::new();
    let is_watched = |pair: &[Root; 2]| pair.iter().all(|&root| watched.contains(root));
    for (i, a) in trace.iter().enumerate() {
        for (j, b) in trace.iter().enumerate().skip(i + 1) {
            for (a, b) in a.windows(3).zip(b.windows(3)) {
                let pair = |k: usize| (a[k].0, [a[k].1, b[k].1]);
                let around = [0, 1, 2].map(pair);
                let [left, middle, right] = around.map(|(_, pair)| distance(&pair));
                let is_near = middle < NEAR * a[1].1.lambda.norm() && is_watched(&around[1].1);
                if middle < left && middle <= right && is_near {
                    let (value, pair) = nearest_of_pair(evaluate, around)?;
                    found.push(Approach {
                        value,
                        modes: [i, j],
                        distance_hz: distance(&pair) / TAU,
                        frequency_hz: 0.5 * (pair[0].lambda.im + pair[1].lambda.im) / TAU,
                    });
                }
            }
        }
    }
    Ok(found)
}

/// Distance of two roots, 1/s.
fn distance([a, b]: &[Root; 2]) -> f64 {
    (a.lambda - b.lambda).norm()
}

/// The closest approach of two branches between three points, of which the middle one has them nearest.
fn nearest_of_pair(
    evaluate: &Evaluate<'_>,
    around: [(f64, [Root; 2]); 3],
) -> Result<(f64, [Root; 2]), Error> {
    let both = |[from, to]: [(f64, [Root; 2]); 2], value: f64| {
        let root = |which: usize| {
            let known = [(from.0, from.1[which]), (to.0, to.1[which])];
            Ok::<_, Error>(on_branch(evaluate, known, value)?.1)
        };
        Ok([root(0)?, root(1)?])
    };
    golden_section(around, &both, &distance, &|_| false)
}

/// Golden-section search of the least cost between three points, the middle one having the least of
/// them; ends early at a point that is good enough.
fn golden_section<P: Copy>(
    [mut left, mut middle, mut right]: [(f64, P); 3],
    point: &dyn Fn([(f64, P); 2], f64) -> Result<P, Error>,
    cost: &dyn Fn(&P) -> f64,
    is_enough: &dyn Fn(&P) -> bool,
) -> Result<(f64, P), Error> {
    const GOLDEN: f64 = 0.381_966_011_250_105;
    // At a minimum half of the digits are all that can be told.
    let resolution = 1e-9 * (right.0 - left.0);
    while right.0 - left.0 > resolution {
        let leftwards = middle.0 - left.0 > right.0 - middle.0;
        let side = if leftwards { left } else { right };
        let value = middle.0 + GOLDEN * (side.0 - middle.0);
        let found = (value, point([middle, side], value)?);
        if is_enough(&found.1) {
            return Ok(found);
        }
        match (cost(&found.1) < cost(&middle.1), leftwards) {
            (true, true) => (middle, right) = (found, middle),
            (true, false) => (middle, left) = (found, middle),
            (false, true) => left = found,
            (false, false) => right = found,
        }
    }
    Ok(middle)
}

fn nearest(roots: Vec<Root>, expected: Complex<f64>) -> Root {
    let distance = |root: &Root| (root.sigma - expected).norm();
    roots.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("there are roots")
}
