//! Root loci: the modes of a contact state followed while a parameter changes.
//!
//! What is followed are the eigenvalues σ of M̃⁻¹ K̃, whose number never changes; each has one
//! eigenvalue λ with Im λ ≥ 0. Real σ may cross (symmetric structures) or merge into a pair; the
//! merging is exact, damped or not, because C̃ = α M̃ + β K̃ has the same eigenvectors.

use super::modes::quadratic_roots;
use super::symmetry::all_stiffness_eigenvalues;
use crate::Error;
use crate::contact::ContactState;
use crate::model::LumpedModel;
use nalgebra::Complex;
use std::cmp::Ordering;
use std::f64::consts::TAU;

/// Halvings of a step at most, where modes cannot be told apart by continuity.
const MAX_HALVINGS: u32 = 24;
/// σ closer than this part of themselves are a double one, whichever is which.
const DOUBLE: f64 = 1e-8;

/// One eigenvalue of a contact state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// σ, 1/s².
    pub sigma: Complex<f64>,
    /// λ, 1/s: the one of σ's two with the larger imaginary or, if both are real, real part.
    pub lambda: Complex<f64>,
}

impl Root {
    /// Re λ > 0.
    fn grows(self) -> bool {
        self.lambda.re > 0.0
    }

    fn is_real(self) -> bool {
        self.sigma.im == 0.0
    }
}

/// All roots of a contact state, by σ.
///
/// # Errors
/// As [`modes`](super::modes()).
pub fn roots(model: &LumpedModel, states: &[ContactState], mu: f64) -> Result<Vec<Root>, Error> {
    let upper = |sigma| {
        let [a, b] = quadratic_roots(model, sigma);
        if (a.im, a.re) >= (b.im, b.re) { a } else { b }
    };
    let sigmas = all_stiffness_eigenvalues(model, states, mu)?;
    let mut roots: Vec<Root> =
        sigmas.into_iter().map(|sigma| Root { sigma, lambda: upper(sigma) }).collect();
    roots.sort_by(|a, b| {
        let pair = a.sigma == b.sigma.conj();
        let apart = a.sigma.re.total_cmp(&b.sigma.re);
        if pair { order_of_merged(a, b) } else { apart }
    });
    Ok(roots)
}

/// Which of a pair that has merged comes first: the one with the lower frequency or, without
/// damping, where both have the same, the one that decays. So the higher of them is the one that
/// grows, as the paper numbers them.
fn order_of_merged(a: &Root, b: &Root) -> Ordering {
    let apart = (a.lambda.im - b.lambda.im).abs() > 1e-12 * a.lambda.norm();
    let frequency = a.lambda.im.total_cmp(&b.lambda.im);
    if apart { frequency } else { a.lambda.re.total_cmp(&b.lambda.re) }
}

/// The modes of a contact state over the values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Locus {
    /// The values of the parameter, ascending.
    pub values: Vec<f64>,
    /// One branch a mode, numbered by σ at the first value; one root a value of the parameter.
    pub branches: Vec<Vec<Root>>,
    /// Where two modes merge or part.
    pub coalescences: Vec<Coalescence>,
    /// Where a mode begins or ceases to grow.
    pub crossings: Vec<Crossing>,
}

/// Two modes with one eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coalescence {
    /// The value of the parameter.
    pub value: f64,
    /// The two modes, from 0.
    pub modes: [usize; 2],
    /// Their common frequency, Hz.
    pub frequency_hz: f64,
    /// Do they merge (or part) as the parameter grows?
    pub merge: bool,
}

/// A mode whose growth rate changes its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The value of the parameter: with Re λ ≤ 0 to its stable side.
    pub value: f64,
    /// The mode, from 0.
    pub mode: usize,
    /// Its frequency there, Hz.
    pub frequency_hz: f64,
    /// Does it grow above the value (or below)?
    pub becomes_unstable: bool,
}

/// Gives the roots at a value of the parameter; always the same number of them.
pub type Evaluate<'a> = dyn Fn(f64) -> Result<Vec<Root>, Error> + Sync + 'a;

/// Follows all modes over ascending values of a parameter; `done` hears how many are done. A mode
/// that grows only between two neighbouring values, without a sign of it at its neighbours, is
/// missed: choose the step accordingly.
///
/// # Errors
/// What `evaluate` fails with.
pub fn locus(
    evaluate: &Evaluate<'_>,
    values: &[f64],
    done: &dyn Fn(usize),
) -> Result<Locus, Error> {
    let Some(&start) = values.first() else {
        return Err(Error::analysis("a root locus needs at least one value of its parameter"));
    };
    let first = evaluate(start)?;
    let mut tracker = Tracker {
        evaluate,
        value: start,
        rates: vec![Complex::new(0.0, 0.0); first.len()],
        roots: first,
        coalescences: Vec::new(),
        crossings: Vec::new(),
    };
    let mut branches: Vec<Vec<Root>> = tracker.roots.iter().map(|&root| vec![root]).collect();
    for (i, &value) in values.iter().enumerate().skip(1) {
        tracker.follow_to(value, 0)?;
        done(i + 1);
        for (branch, &root) in branches.iter_mut().zip(&tracker.roots) {
            branch.push(root);
        }
    }
    let Tracker { mut coalescences, mut crossings, .. } = tracker;
    for (mode, branch) in branches.iter().enumerate() {
        crossings.extend(hidden_crossings(evaluate, values, branch, mode)?);
    }
    coalescences.sort_by(|a, b| a.value.total_cmp(&b.value));
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(Locus { values: values.to_vec(), branches, coalescences, crossings })
}

struct Tracker<'a> {
    evaluate: &'a Evaluate<'a>,
    value: f64,
    roots: Vec<Root>,
    /// dσ/dp of each branch over the last step.
    rates: Vec<Complex<f64>>,
    coalescences: Vec<Coalescence>,
    crossings: Vec<Crossing>,
}

impl Tracker<'_> {
    /// Moves to another value, in halves where the modes there cannot be told apart.
    fn follow_to(&mut self, value: f64, halvings: u32) -> Result<(), Error> {
        let found = (self.evaluate)(value)?;
        if found.len() != self.roots.len() {
            return Err(Error::analysis("the number of modes changes with the parameter"));
        }
        let step = value - self.value;
        let predicted: Vec<Complex<f64>> = self
            .roots
            .iter()
            .zip(&self.rates)
            .map(|(root, rate)| root.sigma + rate * step)
            .collect();
        let mut order = assign(&predicted, &found);
        self.number_merged(&found, &mut order);
        if halvings < MAX_HALVINGS && is_ambiguous(&predicted, &found, &order) {
            self.follow_to(self.value + 0.5 * step, halvings + 1)?;
            return self.follow_to(value, halvings + 1);
        }
        let next: Vec<Root> = order.iter().map(|&place| found[place]).collect();
        self.note_events(value, &next)?;
        for (rate, (now, next)) in self.rates.iter_mut().zip(self.roots.iter().zip(&next)) {
            // Across a merging the rate is that of a root: it foretells nothing.
            let smooth = now.is_real() == next.is_real();
            *rate = if smooth { (next.sigma - now.sigma) / step } else { Complex::new(0.0, 0.0) };
        }
        self.roots = next;
        self.value = value;
        Ok(())
    }

    /// Two modes that have just merged are alike: they are numbered by [`order_of_merged`].
    fn number_merged(&self, found: &[Root], order: &mut [usize]) {
        for i in 0..order.len() {
            for j in i + 1..order.len() {
                let (a, b) = (found[order[i]], found[order[j]]);
                let merged = self.roots[i].is_real()
                    && self.roots[j].is_real()
                    && !a.is_real()
                    && a.sigma == b.sigma.conj();
                if merged && order_of_merged(&a, &b) == Ordering::Greater {
                    order.swap(i, j);
                }
            }
        }
    }

    fn note_events(&mut self, value: f64, next: &[Root]) -> Result<(), Error> {
        for i in 0..next.len() {
            let changed = self.roots[i].is_real() != next[i].is_real();
            let merge = self.roots[i].is_real();
            let pair = if merge { next } else { &self.roots };
            let partner =
                (0..next.len()).find(|&j| j != i && pair[j].sigma == pair[i].sigma.conj());
            if let Some(j) = partner.filter(|&j| changed && i < j) {
                let sum = |roots: &[Root]| 0.5 * (roots[i].sigma + roots[j].sigma);
                let centre = [sum(&self.roots), sum(next)];
                let at = self.locate_coalescence([self.value, value], centre, merge)?;
                let lambda = nearest((self.evaluate)(at)?, centre[0]).lambda;
                self.coalescences.push(Coalescence {
                    value: at,
                    modes: [i, j],
                    frequency_hz: lambda.im / TAU,
                    merge,
                });
            }
            if self.roots[i].grows() != next[i].grows() {
                let ends = [(self.value, self.roots[i]), (value, next[i])];
                self.crossings.push(locate_crossing(self.evaluate, i, ends)?);
            }
        }
        Ok(())
    }

    /// Bisects on the sign of (σ_i − σ_j)², which is smooth through a merging where the σ are not.
    fn locate_coalescence(
        &self,
        [mut low, mut high]: [f64; 2],
        centre: [Complex<f64>; 2],
        merge: bool,
    ) -> Result<f64, Error> {
        let width = high - low;
        let start = low;
        while let Some(middle) = between(low, high) {
            let part = (middle - start) / width;
            let expected = centre[0] + (centre[1] - centre[0]) * part;
            let mut roots = (self.evaluate)(middle)?;
            roots.sort_by(|a, b| {
                (a.sigma - expected).norm().total_cmp(&(b.sigma - expected).norm())
            });
            let difference = roots[0].sigma - roots[1].sigma;
            let real = (difference * difference).re > 0.0;
            if real == merge { low = middle } else { high = middle }
        }
        Ok(0.5 * (low + high))
    }
}

/// A value of the parameter and the root of a branch there.
type Point = (f64, Root);

/// Bisects on the sign of Re λ along one branch, between two points that differ in it.
fn locate_crossing(
    evaluate: &Evaluate<'_>,
    mode: usize,
    [from, to]: [Point; 2],
) -> Result<Crossing, Error> {
    let (mut low, mut high) = (from, to);
    while let Some(middle) = between(low.0, high.0) {
        let point = on_branch(evaluate, [low, high], middle)?;
        let side = if point.1.grows() == from.1.grows() { &mut low } else { &mut high };
        *side = point;
    }
    let (value, root) = if from.1.grows() { high } else { low };
    Ok(Crossing { value, mode, frequency_hz: root.lambda.im / TAU, becomes_unstable: to.1.grows() })
}

/// The root at `value` of a branch that is known at two points: the nearest to the line between.
fn on_branch(evaluate: &Evaluate<'_>, [low, high]: [Point; 2], value: f64) -> Result<Point, Error> {
    let part = (value - low.0) / (high.0 - low.0);
    let expected = low.1.sigma + (high.1.sigma - low.1.sigma) * part;
    Ok((value, nearest(evaluate(value)?, expected)))
}

/// Pairs of crossings between two neighbouring values at which a branch is on the same side. Where
/// Re λ comes nearest to zero among the values, its extremum is sought beside that place.
fn hidden_crossings(
    evaluate: &Evaluate<'_>,
    values: &[f64],
    branch: &[Root],
    mode: usize,
) -> Result<Vec<Crossing>, Error> {
    let points: Vec<Point> = values.iter().copied().zip(branch.iter().copied()).collect();
    let mut found = Vec::new();
    for three in points.windows(3) {
        let [left, middle, right] = *three else { unreachable!("windows of three") };
        let grows = middle.1.grows();
        let below = |point: &Point| -point.1.lambda.re.abs();
        let rise = [left, right].map(|side| below(&middle) - below(&side));
        let is_peak =
            rise[0] >= 0.0 && rise[1] > 0.0 && [left, right].iter().all(|p| p.1.grows() == grows);
        // A smooth curve rises between values by no more than it fell to the next.
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

/// A point beside the middle one where Re λ has the other sign, if there is one: golden-section
/// search of the extremum.
fn other_side(
    evaluate: &Evaluate<'_>,
    [mut left, mut middle, mut right]: [Point; 3],
) -> Result<Option<Point>, Error> {
    const GOLDEN: f64 = 0.381_966_011_250_105;
    let grows = middle.1.grows();
    let resolution = 1e-9 * (right.0 - left.0);
    while right.0 - left.0 > resolution {
        let leftwards = middle.0 - left.0 > right.0 - middle.0;
        let side = if leftwards { left } else { right };
        let at = middle.0 + GOLDEN * (side.0 - middle.0);
        let point = on_branch(evaluate, [middle, side], at)?;
        if point.1.grows() != grows {
            return Ok(Some(point));
        }
        let better = point.1.lambda.re.abs() < middle.1.lambda.re.abs();
        match (better, leftwards) {
            (true, true) => (middle, right) = (point, middle),
            (true, false) => (middle, left) = (point, middle),
            (false, true) => left = point,
            (false, false) => right = point,
        }
    }
    Ok(None)
}

/// The middle of an interval, until none is left.
pub(super) fn between(low: f64, high: f64) -> Option<f64> {
    let middle = 0.5 * (low + high);
    (low < middle && middle < high).then_some(middle)
}

fn nearest(roots: Vec<Root>, expected: Complex<f64>) -> Root {
    let distance = |root: &Root| (root.sigma - expected).norm();
    roots.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("there are roots")
}

/// Which found root continues which branch: the assignment that a swap of no two improves.
fn assign(predicted: &[Complex<f64>], found: &[Root]) -> Vec<usize> {
    let cost = |branch: usize, place: usize| (predicted[branch] - found[place].sigma).norm_sqr();
    let mut order: Vec<usize> = (0..found.len()).collect();
    let mut improved = true;
    while improved {
        improved = false;
        for i in 0..order.len() {
            for j in i + 1..order.len() {
                let kept = cost(i, order[i]) + cost(j, order[j]);
                let swapped = cost(i, order[j]) + cost(j, order[i]);
                if swapped < kept * (1.0 - 1e-12) {
                    order.swap(i, j);
                    improved = true;
                }
            }
        }
    }
    order
}

/// Might a branch as well continue in another root? Roots that are double are one.
fn is_ambiguous(predicted: &[Complex<f64>], found: &[Root], order: &[usize]) -> bool {
    predicted.iter().zip(order).any(|(predicted, &place)| {
        let own = found[place].sigma;
        let miss = (predicted - own).norm();
        found.iter().any(|other| {
            let apart = (other.sigma - own).norm();
            apart > DOUBLE * own.norm() && miss > 0.2 * apart
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn sliding(name: &'static str) -> impl Fn(f64) -> Result<Vec<Root>, Error> + Sync {
        let model = LumpedModel::from(&builtin(name).unwrap().scene());
        move |mu| roots(&model, &[ContactState::Slide; 2], mu)
    }

    fn grid(end: f64, step: f64) -> Vec<f64> {
        (0..).map(|i| f64::from(i) * step).take_while(|value| *value <= end).collect()
    }

    #[test]
    fn set_1_has_two_coalescences_5_6_before_3_4_and_set_2_the_other_order() {
        for (name, order) in [("set1", [[4, 5], [2, 3]]), ("set2", [[2, 3], [4, 5]])] {
            let found = locus(&sliding(name), &grid(3.5, 0.005), &|_| {}).unwrap();
            let modes: Vec<[usize; 2]> = found.coalescences.iter().map(|c| c.modes).collect();
            assert_eq!(modes, order, "{name}");
            assert!(found.coalescences.iter().all(|c| c.merge));
            // "The real part of the mode 6 is positive": the higher of the merged modes grows.
            let growing: Vec<usize> = found.crossings.iter().map(|c| c.mode).collect();
            assert_eq!(growing, if name == "set1" { [5, 3] } else { [3, 5] }, "{name}");
        }
    }

    #[test]
    fn coalescences_are_where_the_discriminant_of_the_symmetric_halves_vanishes() {
        // Two equal modules move in phase or out of phase: K_± of one module with its links as
        // ground springs (none in phase, four times k1 and k2 out of phase). In uniform sliding x4 = 0,
        // so σ are the roots of a cubic whose discriminant changes sign where two of them merge.
        let scene = builtin("set1").unwrap().scene();
        let [k1, k2, k3, k4, k5, k6] = scene.modules()[0].stiffness;
        let [m1, m2] = scene.modules()[0].mass;
        let (s, c) = scene.slider.angle.sin_cos();
        let discriminant = |links: f64, mu: f64| {
            let (kx, ky) = (k4 + k6 + links * k1, k3 + k5 + links * k2);
            // Rows x1, x2 and x3 − µ x4 of M⁻¹ K, columns x1, x2, x3.
            let a = [
                [kx / m1, 0.0, -k6 * c / m1],
                [0.0, ky / m1, -k5 * s / m1],
                [
                    (-k6 * c - mu * k6 * s) / m2,
                    (-k5 * s + mu * k5 * c) / m2,
                    (k6 * c * c + k5 * s * s - mu * (k5 - k6) * s * c) / m2,
                ],
            ];
            let trace = a[0][0] + a[1][1] + a[2][2];
            let minor = |i: usize, j: usize| a[i][i] * a[j][j] - a[i][j] * a[j][i];
            let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
            let determinant = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
                + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
            let (b, c, d) = (-trace, minors, -determinant);
            18.0 * b * c * d - 4.0 * b.powi(3) * d + b * b * c * c - 4.0 * c.powi(3) - 27.0 * d * d
        };
        let found = locus(&sliding("set1"), &grid(3.5, 0.005), &|_| {}).unwrap();
        // Modes 5 and 6 move the modules out of phase, modes 3 and 4 in phase (Fig. 2c).
        for (coalescence, links) in found.coalescences.iter().zip([4.0, 0.0]) {
            let (mut low, mut high) = (coalescence.value - 0.01, coalescence.value + 0.01);
            assert!(discriminant(links, low) > 0.0 && discriminant(links, high) < 0.0);
            while high - low > 1e-12 {
                let middle = 0.5 * (low + high);
                if discriminant(links, middle) > 0.0 { low = middle } else { high = middle }
            }
            assert!((coalescence.value - low).abs() < 1e-9, "{coalescence:?} {low}");
        }
    }

    #[test]
    fn the_locus_does_not_depend_on_its_grid() {
        let fine = locus(&sliding("set1"), &grid(3.5, 0.005), &|_| {}).unwrap();
        let coarse = locus(&sliding("set1"), &grid(3.5, 0.25), &|_| {}).unwrap();
        for (a, b) in fine.crossings.iter().zip(&coarse.crossings) {
            assert_eq!((a.mode, a.becomes_unstable), (b.mode, b.becomes_unstable));
            assert!((a.value - b.value).abs() < 1e-9);
        }
        assert_eq!(fine.crossings.len(), coarse.crossings.len());
        for (a, b) in fine.branches.iter().zip(&coarse.branches) {
            let (a, b) = (a.last().unwrap(), b.last().unwrap());
            assert!((a.sigma - b.sigma).norm() < 1e-9 * a.sigma.norm());
        }
    }

    #[test]
    fn double_modes_of_a_ring_of_five_merge_in_pairs_and_never_part() {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        *scene.modules_mut() = vec![module; 5];
        let model = LumpedModel::from(&scene);
        let evaluate = |mu| roots(&model, &[ContactState::Slide; 5], mu);
        let found = locus(&evaluate, &grid(3.5, 0.02), &|_| {}).unwrap();
        // Waves 0, 1 and 2 around the ring; waves 1 and 2 come twice. Each family of three modes
        // has at most one merging below µ = 3.5 and a double family merges twice at one place.
        assert!((1..=5).contains(&found.coalescences.len()), "{:?}", found.coalescences);
        assert!(found.coalescences.iter().all(|event| event.merge));
    }

    #[test]
    fn modes_that_cross_without_merging_keep_their_numbers() {
        // σ = 1 + p and 2 − p cross at p = ½.
        let crossing = |p: f64| {
            let root = |sigma: f64| Root {
                sigma: Complex::new(sigma, 0.0),
                lambda: Complex::new(0.0, sigma.sqrt()),
            };
            let mut roots = vec![root(1.0 + p), root(2.0 - p)];
            roots.sort_by(|a, b| a.sigma.re.total_cmp(&b.sigma.re));
            Ok(roots)
        };
        let found = locus(&crossing, &grid(1.0, 0.07), &|_| {}).unwrap();
        assert!(found.coalescences.is_empty());
        for (value, root) in found.values.iter().zip(&found.branches[0]) {
            assert!((root.sigma.re - (1.0 + value)).abs() < 1e-15);
        }
    }

    /// A single root with this growth rate over the parameter.
    fn growing_as(growth: fn(f64) -> f64) -> impl Fn(f64) -> Result<Vec<Root>, Error> + Sync {
        move |p| {
            let lambda = Complex::new(growth(p), 10.0);
            Ok(vec![Root { sigma: -lambda * lambda, lambda }])
        }
    }

    #[test]
    fn a_mode_that_grows_only_between_two_values_is_found() {
        // Above zero from 0.505 to 0.515 only, or below zero there only, on a grid of 0.02.
        for sign in [1.0, -1.0] {
            let hump = growing_as(|p| 2.5e-5 - (p - 0.51).powi(2));
            let evaluate = move |p: f64| {
                let mut roots = hump(p)?;
                roots[0].lambda.re *= sign;
                Ok(roots)
            };
            let found = locus(&evaluate, &grid(1.0, 0.02), &|_| {}).unwrap().crossings;
            let values: Vec<f64> = found.iter().map(|crossing| crossing.value).collect();
            assert_eq!(values.len(), 2, "{values:?}");
            assert!((values[0] - 0.505).abs() < 1e-12 && (values[1] - 0.515).abs() < 1e-12);
            assert_eq!(
                [found[0].becomes_unstable, found[1].becomes_unstable],
                [sign > 0.0, sign < 0.0]
            );
        }
    }

    #[test]
    fn a_mode_that_comes_near_growing_and_does_not_has_no_crossing() {
        let near = growing_as(|p| -1e-9 - (p - 0.51).powi(2));
        assert!(locus(&near, &grid(1.0, 0.02), &|_| {}).unwrap().crossings.is_empty());
    }

    #[test]
    fn without_damping_and_past_a_merging_the_higher_of_a_pair_is_the_one_that_grows() {
        let mut model = LumpedModel::from(&builtin("set1").unwrap().scene());
        model.damping.beta = 0.0;
        let evaluate = |mu| roots(&model, &[ContactState::Slide; 2], mu);
        for start in [0.0, 1.5] {
            let values: Vec<f64> =
                (0..=50).map(|i| start + 0.01 * f64::from(i) * (1.6 - start) / 0.5).collect();
            let found = locus(&evaluate, &values, &|_| {}).unwrap();
            let growth = |mode: usize| found.branches[mode].last().unwrap().lambda.re;
            assert!(growth(5) > 0.0 && growth(4) < 0.0, "from {start}");
        }
    }
}
