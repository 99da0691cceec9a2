//! Tests of the loci of the paper's sets, of rings and of made-up roots.

mod between;

use super::*;
use amontons::model::SparseMatrix;
use amontons::numerics::bisect;
use amontons::scene::builtin;
use std::f64::consts::TAU;

/// The locus of uniform sliding over µ.
fn over_friction(model: &LumpedModel, values: &[f64]) -> Locus {
    let states = vec![ContactState::Slide; model.contacts.len()];
    let at = |mu: f64| Ok(Linearised::from(model.clone().with_friction(mu)));
    locus(&at, &states, values, ALL_FREQUENCIES, &|_, _| {}).unwrap()
}

fn of_set(name: &str) -> LumpedModel {
    LumpedModel::from(&builtin(name).unwrap().scene())
}

/// A locus of single roots.
fn of_roots(evaluate: &follow::Evaluate<'_>, values: &[f64]) -> Locus {
    let watched = Watched { frequencies: ALL_FREQUENCIES, merge: true };
    together(values, vec![(follow(evaluate, values, watched, &|| {}).unwrap(), 1)])
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
        let [low, high] = [-0.01, 0.01].map(|step| coalescence.value + step);
        assert!(discriminant(links, low) > 0.0 && discriminant(links, high) < 0.0);
        let [low, _] = bisect(low, high, |mu| discriminant(links, mu) > 0.0);
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
    let [one, two] = [1.0, 2.0].map(|k: f64| 4.0 * (std::f64::consts::PI * k / 5.0).sin().powi(2));
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
            assert!(event.merge && (event.value - expected).abs() < 1e-9, "{event:?} {expected}");
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
    let model_at = |mu: f64| Ok(Linearised::from(model.clone().with_friction(mu)));
    let found = locus(&model_at, &states, &grid(3.5, 0.5), ALL_FREQUENCIES, &|_, _| {}).unwrap();
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
        // Another method confirms the modes: the eigenvalues of eq. (6).
        let model = model.with_friction(near.value);
        let all = Spectrum::of(model.linear().unwrap(), &[ContactState::Slide; 2]).unwrap();
        let apart = all.oscillating.windows(2).map(|pair| (pair[0] - pair[1]).norm() / TAU);
        assert!((apart.fold(f64::MAX, f64::min) - near.distance_hz).abs() < 1e-6);
        assert_eq!(found.crossings.len(), 2);
    }
}

/// Only among the values that were asked for were modes once seen to come near each other.
#[test]
fn modes_come_nearest_at_the_same_places_on_every_grid_and_beside_the_ends_of_a_range() {
    let mut model = of_set("set1");
    model.dampers = SparseMatrix::from_entries(8, vec![(0, 0, 1.0)]);
    let fine = over_friction(&model, &grid(3.5, 0.0037)).approaches;
    assert!(fine.len() > 1, "{fine:?}");
    let places = |found: &[Approach]| -> Vec<([usize; 2], f64)> {
        found.iter().map(|a| (a.modes, a.value)).collect()
    };
    for step in [0.05, 0.7, 3.5] {
        let coarse = over_friction(&model, &grid(3.5, step)).approaches;
        assert_eq!(fine.len(), coarse.len(), "step {step}: {fine:?} {coarse:?}");
        for ((modes, a), (others, b)) in places(&fine).into_iter().zip(places(&coarse)) {
            assert!(modes == others && (a - b).abs() < 1e-6, "step {step}: {modes:?} {a} {b}");
        }
    }
    let first = fine[0];
    for range in [[first.value - 1e-4, 3.5], [0.0, first.value + 1e-4]] {
        let found = over_friction(&model, &range).approaches;
        let is_there = |a: &&Approach| (a.value - first.value).abs() < 1e-6;
        assert_eq!(found.iter().filter(is_there).count(), 1, "{range:?}: {found:?}");
    }
}

/// Bounds of the frequencies leave out events of other modes, and change nothing of those between them.
#[test]
fn modes_between_two_frequencies_have_the_events_that_they_have_among_all_modes() {
    let mut damped = of_set("set1");
    damped.dampers = SparseMatrix::from_entries(8, vec![(0, 0, 1.0)]);
    for model in [of_set("set1"), damped] {
        let states = vec![ContactState::Slide; model.contacts.len()];
        let at = |mu: f64| Ok(Linearised::from(model.clone().with_friction(mu)));
        let [all, some] = [ALL_FREQUENCIES, [150.0, 200.0]].map(|frequencies| {
            locus(&at, &states, &grid(3.5, 0.05), frequencies, &|_, _| {}).unwrap()
        });
        let is_between = |frequency: f64| (150.0..=200.0).contains(&frequency);
        let crossings = all.crossings.iter().filter(|c| is_between(c.frequency_hz)).copied();
        assert_eq!(crossings.collect::<Vec<_>>(), some.crossings);
        let merged = all.coalescences.iter().filter(|c| is_between(c.frequency_hz)).copied();
        assert_eq!(merged.collect::<Vec<_>>(), some.coalescences);
        let near = all.approaches.iter().filter(|a| is_between(a.frequency_hz)).copied();
        assert_eq!(near.collect::<Vec<_>>(), some.approaches);
        assert_eq!(some.crossings.len(), 1, "{:?}", some.crossings);
        assert!(all.crossings.len() == 2 && all.followed().count() > some.followed().count());
    }
}

/// A bisection alone takes some fifty evaluations of all modes.
#[test]
fn the_value_at_which_a_mode_begins_to_grow_takes_few_evaluations() {
    let count = std::sync::atomic::AtomicUsize::new(0);
    let zero = 1.0 / 3.0;
    for rate in [1.0, 1e-6, 1e6] {
        let evaluate = |value: f64| {
            count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let growth = rate * (libm::exp(value) - libm::exp(zero));
            Ok(vec![Root { sigma: Complex::new(1.0, 0.0), lambda: Complex::new(growth, 1.0) }])
        };
        let ends = [0.0, 1.0].map(|value| (value, evaluate(value).unwrap()[0]));
        count.store(0, std::sync::atomic::Ordering::Relaxed);
        let found = events::locate_crossing(&evaluate, 0, ends).unwrap().crossing;
        assert!((found.value - zero).abs() <= 2.0 * f64::EPSILON, "{found:?}");
        let count = count.load(std::sync::atomic::Ordering::Relaxed);
        assert!(count < 20, "{rate}: {count}");
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
