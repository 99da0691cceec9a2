//! Root loci: the modes of a contact state followed while a parameter changes.
//!
//! What is followed are the eigenvalues σ of M̃⁻¹ K̃, whose number never changes; each has one
//! eigenvalue λ with Im λ ≥ 0, or two real ones. Real σ may cross (symmetric structures) or merge
//! into a pair; the merging is exact, damped or not, because C̃ = α M̃ + β K̃ has the same
//! eigenvectors. With single dampers there are no such σ, and modes come near each other instead of
//! merging. Parts of a problem that do not couple, as the waves around a ring of equal modules,
//! are followed one by one: their roots cross without a trace.
//!
//! | file | what it does |
//! | --- | --- |
//! | `follow` | tells roots apart from value to value |
//! | `events` | locates where they merge and where they begin to grow |

mod events;
mod follow;

use super::modes::quadratic_roots;
use super::spectrum::Spectrum;
use super::symmetry::Part;
use crate::Error;
use crate::contact::ContactState;
use crate::model::LumpedModel;
use nalgebra::Complex;
use std::borrow::Cow;
use std::cmp::Ordering;

use events::closest_approaches;
pub(super) use events::{between, on_branch};
use follow::{Followed, follow};

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

/// All roots of a part of a contact state, by σ.
///
/// # Errors
/// As [`modes`](super::modes()).
pub(super) fn roots(
    model: &LumpedModel,
    states: &[ContactState],
    mu: f64,
    part: Part,
) -> Result<Vec<Root>, Error> {
    if !model.dampers.is_empty() {
        return damped_roots(model, states, mu);
    }
    let upper = |sigma| {
        let [a, b] = quadratic_roots(model, sigma);
        if (a.im, a.re) >= (b.im, b.re) { a } else { b }
    };
    let sigmas = part.stiffness_eigenvalues(model, states, mu)?;
    let mut roots: Vec<Root> =
        sigmas.into_iter().map(|sigma| Root { sigma, lambda: upper(sigma) }).collect();
    roots.sort_by(by_number);
    Ok(roots)
}

/// With single dampers: what stands for σ is made of the product and the sum of a mode's two λ, which
/// are smooth where a mode ceases to oscillate.
fn damped_roots(model: &LumpedModel, states: &[ContactState], mu: f64) -> Result<Vec<Root>, Error> {
    let root = |[a, b]: [Complex<f64>; 2]| {
        let product = (a * b).re;
        let sigma = Complex::new(product, (a + b).re * product.abs().sqrt());
        Root { sigma, lambda: if (a.im, a.re) >= (b.im, b.re) { a } else { b } }
    };
    let Spectrum { oscillating, real } = Spectrum::of(model, states, mu)?;
    let pairs = oscillating.into_iter().map(|value| root([value, value.conj()]));
    let real = real.chunks_exact(2).map(|pair| root([pair[0].into(), pair[1].into()]));
    let mut roots: Vec<Root> = pairs.chain(real).collect();
    roots.sort_by(by_number);
    Ok(roots)
}

/// The order in which modes are numbered.
fn by_number(a: &Root, b: &Root) -> Ordering {
    let pair = !a.is_real() && a.sigma == b.sigma.conj();
    if pair { order_of_merged(a, b) } else { a.sigma.re.total_cmp(&b.sigma.re) }
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
    /// Where single dampers keep two modes from merging: where they come nearest to each other.
    pub approaches: Vec<Approach>,
    /// Values near which modes could not be told apart: there they may have changed their numbers.
    pub undecided: Vec<f64>,
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

/// Two modes that come near each other without merging.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The value of the parameter.
    pub value: f64,
    /// The two modes, from 0.
    pub modes: [usize; 2],
    /// |λ_i − λ_j| / 2π, Hz.
    pub distance_hz: f64,
    /// The mean of their frequencies, Hz.
    pub frequency_hz: f64,
}

/// A mode whose growth rate changes its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The value of the parameter: with Re λ ≤ 0 to its stable side.
    pub value: f64,
    /// The mode, from 0.
    pub mode: usize,
    /// Its frequency where it grows, Hz; zero where it diverges.
    pub frequency_hz: f64,
    /// Does it grow above the value (or below)?
    pub becomes_unstable: bool,
}

/// The model, and the µ, that belong to a value of the parameter.
pub type ModelAt<'a> = dyn Fn(f64) -> Result<(Cow<'a, LumpedModel>, f64), Error> + 'a;

/// Follows all modes of a contact state over ascending values of a parameter, of which there are at
/// least two, in steps of at most a two-hundredth of the range; `done` hears of each value done in
/// each of the parts, whose number the first call of it has heard. A mode that grows only within a
/// narrower range, without a sign of it beside that, is missed.
///
/// # Errors
/// What `model_at` fails with, or a state that cannot be analysed.
pub fn locus(
    model_at: &ModelAt<'_>,
    states: &[ContactState],
    values: &[f64],
    done: &dyn Fn(usize, usize),
) -> Result<Locus, Error> {
    let [first, .., last] = values else {
        return Err(Error::analysis("a root locus needs at least two values of its parameter"));
    };
    let ends = [*first, 0.5 * (first + last), *last].map(|value| Ok(model_at(value)?.0));
    let ends: Vec<Cow<'_, LumpedModel>> = ends.into_iter().collect::<Result<_, Error>>()?;
    let parts = Part::all(ends.iter().map(AsRef::as_ref), states);
    let all = parts.len() * values.len();
    let count = std::cell::Cell::new(0);
    let mut followed = Vec::new();
    for &part in &parts {
        let evaluate = |value: f64| {
            let (model, mu) = model_at(value)?;
            roots(&model, states, mu, part)
        };
        let one_done = || {
            count.set(count.get() + 1);
            done(count.get(), all);
        };
        followed.push((follow(&evaluate, values, &one_done)?, part.copies()));
    }
    let mut found = together(values, followed);
    if ends.iter().any(|model| !model.dampers.is_empty()) {
        let evaluate = |value: f64| {
            let (model, mu) = model_at(value)?;
            roots(&model, states, mu, Part::Whole)
        };
        found.approaches = closest_approaches(&evaluate, values, &found.branches)?;
    }
    Ok(found)
}

/// Puts parts, each so many times, into one locus, and numbers its modes.
fn together(values: &[f64], parts: Vec<(Followed, usize)>) -> Locus {
    let mut branches = Vec::new();
    let (mut coalescences, mut crossings, mut undecided) = (Vec::new(), Vec::new(), Vec::new());
    for (part, copies) in parts {
        undecided.extend(part.undecided);
        for _ in 0..copies {
            let place = |mode: usize| branches.len() + mode;
            coalescences.extend(
                part.coalescences.iter().map(|c| Coalescence { modes: c.modes.map(place), ..*c }),
            );
            crossings.extend(part.crossings.iter().map(|c| Crossing { mode: place(c.mode), ..*c }));
            branches.extend(part.branches.iter().cloned());
        }
    }
    let mut order: Vec<usize> = (0..branches.len()).collect();
    order.sort_by(|&a: &usize, &b: &usize| by_number(&branches[a][0], &branches[b][0]));
    let mut number = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new;
    }
    for event in &mut coalescences {
        event.modes = event.modes.map(|mode| number[mode]);
        event.modes.sort_unstable();
    }
    for event in &mut crossings {
        event.mode = number[event.mode];
    }
    coalescences.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.modes.cmp(&b.modes)));
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.mode.cmp(&b.mode)));
    undecided.sort_by(f64::total_cmp);
    let branches = order.iter().map(|&old| branches[old].clone()).collect();
    let approaches = Vec::new();
    Locus { values: values.to_vec(), branches, coalescences, crossings, approaches, undecided }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SparseMatrix;
    use crate::scene::builtin;
    use std::f64::consts::TAU;

    /// The locus of uniform sliding over µ.
    fn over_friction(model: &LumpedModel, values: &[f64]) -> Locus {
        let states = vec![ContactState::Slide; model.contacts.len()];
        locus(&|mu| Ok((Cow::Borrowed(model), mu)), &states, values, &|_, _| {}).unwrap()
    }

    fn of_set(name: &str) -> LumpedModel {
        LumpedModel::from(&builtin(name).unwrap().scene())
    }

    /// A locus of single roots.
    fn of_roots(evaluate: &follow::Evaluate<'_>, values: &[f64]) -> Locus {
        together(values, vec![(follow(evaluate, values, &|| {}).unwrap(), 1)])
    }

    fn grid(end: f64, step: f64) -> Vec<f64> {
        (0..).map(|i| f64::from(i) * step).take_while(|value| *value <= end).collect()
    }

    #[test]
    fn set_1_has_two_coalescences_5_6_before_3_4_and_set_2_the_other_order() {
        for (name, order) in [("set1", [[4, 5], [2, 3]]), ("set2", [[2, 3], [4, 5]])] {
            let found = over_friction(&of_set(name), &grid(3.5, 0.005));
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
        let found = over_friction(&of_set("set1"), &grid(3.5, 0.005));
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
        let fine = over_friction(&of_set("set1"), &grid(3.5, 0.005));
        let coarse = over_friction(&of_set("set1"), &grid(3.5, 0.25));
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
    fn double_modes_of_a_ring_of_five_merge_one_to_one_at_one_place() {
        // Wave k moves like one module whose links to the next are 4 sin²(π k / 5) as stiff and fixed
        // at their other ends. Two modules out of phase are such a wave with the factor 4.
        let scene = builtin("set1").unwrap().scene();
        let mut ring = scene.clone();
        *ring.modules_mut() = vec![scene.modules()[0]; 5];
        let merging = |factor: f64| {
            let mut two = scene.clone();
            for module in two.modules_mut() {
                module.stiffness[0] *= 0.25 * factor;
                module.stiffness[1] *= 0.25 * factor;
            }
            let found = over_friction(&LumpedModel::from(&two), &grid(3.5, 0.1)).coalescences;
            let out_of_phase = found.iter().find(|c| (c.value - 1.9413737067).abs() > 1e-6);
            out_of_phase.unwrap().value
        };
        let [one, two] =
            [1.0, 2.0].map(|k: f64| 4.0 * (std::f64::consts::PI * k / 5.0).sin().powi(2));
        let expected = {
            let mut all = vec![merging(one), merging(one), merging(two), merging(two)];
            all.push(1.9413737067);
            all.sort_by(f64::total_cmp);
            all
        };
        for step in [0.02, 0.5] {
            let found = over_friction(&LumpedModel::from(&ring), &grid(3.5, step));
            assert_eq!(found.coalescences.len(), 5, "{:?}", found.coalescences);
            for (event, expected) in found.coalescences.iter().zip(&expected) {
                assert!(
                    event.merge && (event.value - expected).abs() < 1e-9,
                    "{event:?} {expected}"
                );
            }
            let mut modes: Vec<usize> = found.coalescences.iter().flat_map(|c| c.modes).collect();
            modes.sort_unstable();
            modes.dedup();
            assert_eq!(modes.len(), 10, "every mode merges once: {:?}", found.coalescences);
            assert!(found.crossings.iter().all(|c| modes.contains(&c.mode)));
        }
    }

    #[test]
    fn modules_that_nothing_joins_merge_each_on_its_own() {
        // Three copies of everything, in a state that is not uniform and so is followed as a whole.
        let mut scene = builtin("set1").unwrap().scene();
        *scene.modules_mut() = vec![scene.modules()[0]; 3];
        for module in scene.modules_mut() {
            module.stiffness[0] = 0.0;
            module.stiffness[1] = 0.0;
        }
        let model = LumpedModel::from(&scene);
        let states = [ContactState::Slide, ContactState::Slide, ContactState::Stick];
        let model_at = |mu| Ok((Cow::Borrowed(&model), mu));
        let found = locus(&model_at, &states, &grid(3.5, 0.5), &|_, _| {}).unwrap();
        let mut modes: Vec<usize> = found.coalescences.iter().flat_map(|c| c.modes).collect();
        modes.sort_unstable();
        modes.dedup();
        assert_eq!((found.coalescences.len(), modes.len()), (2, 4), "{:?}", found.coalescences);
        // One module alone merges where two that move in phase do.
        for event in &found.coalescences {
            assert!((event.value - 1.9413737067).abs() < 1e-9, "{event:?}");
        }
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
        let found = of_roots(&crossing, &grid(1.0, 0.07));
        assert!(found.coalescences.is_empty());
        for (value, root) in found.values.iter().zip(&found.branches[0]) {
            assert!((root.sigma.re - (1.0 + value)).abs() < 1e-15);
        }
    }

    /// A single root with this growth rate over the parameter.
    fn growing_as(growth: fn(f64) -> f64) -> impl Fn(f64) -> Result<Vec<Root>, Error> {
        move |p| {
            let lambda = Complex::new(growth(p), 10.0);
            Ok(vec![Root { sigma: -lambda * lambda, lambda }])
        }
    }

    #[test]
    fn a_mode_that_grows_only_between_two_values_is_found() {
        // Above zero from 0.5115 to 0.5135 only, or below zero there only, in steps of 0.005.
        for sign in [1.0, -1.0] {
            let hump = growing_as(|p| 1e-6 - (p - 0.5125).powi(2));
            let evaluate = move |p: f64| {
                let mut roots = hump(p)?;
                roots[0].lambda.re *= sign;
                Ok(roots)
            };
            let found = of_roots(&evaluate, &grid(1.0, 0.5)).crossings;
            let values: Vec<f64> = found.iter().map(|crossing| crossing.value).collect();
            assert_eq!(values.len(), 2, "{values:?}");
            assert!((values[0] - 0.5115).abs() < 1e-12 && (values[1] - 0.5135).abs() < 1e-12);
            assert_eq!(
                [found[0].becomes_unstable, found[1].becomes_unstable],
                [sign > 0.0, sign < 0.0]
            );
        }
    }

    #[test]
    fn a_mode_that_comes_near_growing_and_does_not_has_no_crossing() {
        let near = growing_as(|p| -1e-9 - (p - 0.5125).powi(2));
        assert!(of_roots(&near, &grid(1.0, 0.5)).crossings.is_empty());
    }

    #[test]
    fn without_damping_and_past_a_merging_the_higher_of_a_pair_is_the_one_that_grows() {
        let mut model = of_set("set1");
        model.damping.beta = 0.0;
        for start in [0.0, 1.5] {
            let values: Vec<f64> =
                (0..=50).map(|i| start + 0.01 * f64::from(i) * (1.6 - start) / 0.5).collect();
            let found = over_friction(&model, &values);
            let growth = |mode: usize| found.branches[mode].last().unwrap().lambda.re;
            assert!(growth(5) > 0.0 && growth(4) < 0.0, "from {start}");
        }
    }

    #[test]
    fn a_single_damper_keeps_modes_from_merging_and_a_weak_one_by_a_little() {
        let free = of_set("set1");
        let values = grid(3.5, 0.01);
        let merged = over_friction(&free, &values).coalescences;
        for damping in [0.1, 1.0] {
            let mut model = free.clone();
            // On x1 of the first module alone: no combination of M and K.
            model.dampers = SparseMatrix::from_entries(8, vec![(0, 0, damping)]);
            let found = over_friction(&model, &values);
            assert!(found.coalescences.is_empty());
            let near = found.approaches.iter().find(|a| a.modes == [4, 5]).unwrap();
            assert!((near.value - merged[0].value).abs() < 0.1 * damping, "{near:?}");
            assert!(near.distance_hz > 0.0 && near.distance_hz < 2.0, "{near:?}");
            // Where the modes are, another method says so too: the eigenvalues of eq. (6).
            let all = Spectrum::of(&model, &[ContactState::Slide; 2], near.value).unwrap();
            let apart = all.oscillating.windows(2).map(|pair| (pair[0] - pair[1]).norm() / TAU);
            assert!((apart.fold(f64::MAX, f64::min) - near.distance_hz).abs() < 1e-6);
            assert_eq!(found.crossings.len(), 2);
        }
    }

    #[test]
    fn dampers_that_are_rayleigh_damping_in_disguise_begin_to_grow_at_the_same_values() {
        let rayleigh = of_set("set2");
        let mut single = rayleigh.clone();
        let beta = std::mem::take(&mut single.damping).beta;
        let entries = rayleigh.stiffness.entries().map(|(i, j, k)| (i, j, beta * k)).collect();
        single.dampers = SparseMatrix::from_entries(8, entries);
        let [a, b] = [rayleigh, single].map(|model| over_friction(&model, &grid(3.5, 0.01)));
        assert_eq!(a.crossings.len(), b.crossings.len());
        for (a, b) in a.crossings.iter().zip(&b.crossings) {
            assert!((a.value - b.value).abs() < 1e-7, "{a:?} {b:?}");
        }
    }
}
