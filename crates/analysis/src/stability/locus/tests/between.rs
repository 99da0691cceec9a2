//! Tests of events that show at none of the values of a grid, of splits, and of growth that is rounding.

use super::*;

/// Two modes, σ = 4 + p/10 ± 2 √((p − p₀)² − (w/2)²), which merge over a range of this width; λ = √(−σ) less a damping.
fn merging_within(
    place: f64,
    width: f64,
    damping: f64,
) -> impl Fn(f64) -> Result<Vec<Root>, Error> {
    two_modes(place, width, damping, 1.0)
}

/// With the sign −1 the two are merged everywhere but in the range.
fn two_modes(
    place: f64,
    width: f64,
    damping: f64,
    sign: f64,
) -> impl Fn(f64) -> Result<Vec<Root>, Error> {
    move |p: f64| {
        let (from, half) = (p - place, 0.5 * width);
        // As a product this keeps its digits next to the ends of the range.
        let d = sign * (4.0 * (from - half) * (from + half));
        let apart = Complex::from(d).sqrt();
        let mut roots: Vec<Root> = [apart, -apart]
            .into_iter()
            .map(|apart| {
                let sigma = apart + (4.0 + 0.1 * p);
                let lambda = (-sigma).sqrt();
                let lambda = if lambda.im < 0.0 { -lambda } else { lambda };
                Root { sigma, lambda: lambda - damping }
            })
            .collect();
        roots.sort_by(by_number);
        Ok(roots)
    }
}

/// Where the range lies among the values must not matter.
#[test]
fn modes_that_merge_and_part_between_two_values_are_found_however_narrow_the_range_is() {
    for place in 0..60 {
        // The golden ratio spreads the places over the steps of 0.05 and of a two-hundredth of the range.
        let place = 0.04 + 0.92 * (0.618_033_988_749_895 * f64::from(place)).fract();
        for part in [1e-3, 1e-6, 1e-9] {
            let width = part * 0.005;
            let evaluate = merging_within(place, width, 0.0);
            let found = of_roots(&evaluate, &grid(1.0, 0.05));
            let ends = [place - 0.5 * width, place + 0.5 * width];
            let [merge, part_again] = found.coalescences[..] else {
                panic!("{place} {width}: {:?}", found.coalescences)
            };
            assert!(merge.merge && !part_again.merge);
            let [begins, ceases] = found.crossings[..] else {
                panic!("{place} {width}: {:?}", found.crossings)
            };
            assert!(begins.becomes_unstable && !ceases.becomes_unstable);
            for (found, end) in [merge.value, part_again.value].into_iter().zip(ends) {
                assert!((found - end).abs() < 1e-3 * width + 1e-15, "{found} {end}");
            }
            for (found, end) in [begins.value, ceases.value].into_iter().zip(ends) {
                assert!((found - end).abs() < 1e-3 * width + 1e-15, "{found} {end}");
            }
        }
    }
}

/// Re λ = √((w/2)² − (p − p₀)²) / √(4 + p/10) − γ, nearly: with half of the largest growth as γ a mode grows over √3/2 of the range.
#[test]
fn damping_leaves_the_middle_of_a_narrow_range_of_growth_or_nothing() {
    for place in 0..40 {
        let place = 0.04 + 0.92 * (0.618_033_988_749_895 * f64::from(place)).fract();
        for part in [1e-3, 1e-6, 1e-9] {
            let width = part * 0.005;
            let most = 0.5 * width / f64::sqrt(4.0 + 0.1 * place);
            for (damping, count) in [(0.5 * most, 2), (1.01 * most, 0)] {
                let evaluate = merging_within(place, width, damping);
                // Of λ alone growth by less than 1e-9 of them is not sought.
                for merge in [true, false].into_iter().filter(|merge| *merge || part > 1e-6) {
                    let watched = Watched { frequencies: ALL_FREQUENCIES, merge };
                    let values = grid(1.0, 0.05);
                    let found = follow(&evaluate, &values, watched, &|| {}).unwrap();
                    assert_eq!(found.crossings.len(), count, "{place} {width} {merge} {found:?}");
                    let half = 0.5 * width * f64::sqrt(0.75);
                    let ends = [place - half, place + half];
                    for (crossing, end) in found.crossings.iter().zip(ends) {
                        let off = (crossing.value - end).abs();
                        assert!(off < 2e-3 * width + 2e-15, "{crossing:?} {end}");
                    }
                }
            }
        }
    }
}

/// An undamped structure is stable only where its two modes have parted.
#[test]
fn modes_that_part_and_merge_again_between_two_values_are_found() {
    for place in 0..40 {
        let place = 0.04 + 0.92 * (0.618_033_988_749_895 * f64::from(place)).fract();
        for width in [5e-6, 5e-9] {
            let evaluate = two_modes(place, width, 0.0, -1.0);
            let found = of_roots(&evaluate, &grid(1.0, 0.05));
            let kinds: Vec<bool> = found.coalescences.iter().map(|it| it.merge).collect();
            assert_eq!(kinds, [false, true], "{place} {width}: {:?}", found.coalescences);
        }
    }
}

/// σ = (p − p₀)² − (w/2)² is negative over a narrow range: there the mode diverges.
#[test]
fn a_mode_that_diverges_between_two_values_alone_is_found() {
    for place in 0..40 {
        let place = 0.04 + 0.92 * (0.618_033_988_749_895 * f64::from(place)).fract();
        for width in [5e-6, 5e-9, 5e-12] {
            let evaluate = |p: f64| {
                let sigma = (p - place - 0.5 * width) * (p - place + 0.5 * width);
                let lambda = Complex::from(-sigma).sqrt();
                Ok(vec![Root { sigma: sigma.into(), lambda }])
            };
            let found = of_roots(&evaluate, &grid(1.0, 0.05)).crossings;
            let [begins, ceases] = found[..] else { panic!("{place} {width} {found:?}") };
            assert!(begins.frequency_hz == 0.0 && ceases.frequency_hz == 0.0);
            assert!((begins.value - place + 0.5 * width).abs() < 1e-3 * width + 1e-15);
            assert!((ceases.value - place - 0.5 * width).abs() < 1e-3 * width + 1e-15);
        }
    }
}

#[test]
fn a_growing_mode_that_splits_into_two_that_diverge_begins_to_grow_once() {
    // σ = −1 ± √(p − ½): conjugates up to ½, and two negative ones from there on.
    let evaluate = |p: f64| {
        let apart = Complex::from(p - 0.5).sqrt();
        let roots = [-apart, apart].map(|apart| {
            let sigma = apart - 1.0;
            let both = [(-sigma).sqrt(), -(-sigma).sqrt()];
            Root { sigma, lambda: upper(both) }
        });
        Ok(roots.to_vec())
    };
    for turned in [false, true] {
        let there = |p: f64| evaluate(if turned { 1.0 - p } else { p });
        let found = of_roots(&there, &grid(1.0, 0.1));
        assert!(found.crossings.is_empty(), "{:?}", found.crossings);
        let [split] = found.splits[..] else { panic!("{:?}", found.splits) };
        assert!((split.value - 0.5).abs() < 1e-15 && split.becomes_unstable != turned);
        assert_eq!(found.coalescences.len(), 1);
        assert!(crate::stability::candidates::stable_ranges(&found).is_empty());
    }
}

/// Values between 0 and 1, the same ones at each run.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }
}

/// Two masses, the first one in contact: x of it, x and y of the other move. Each mass has two springs to the ground; the one
/// between the masses is soft or stiff, so that ranges are narrow or wide.
struct RandomScene {
    mass: [f64; 2],
    /// Rows and columns x1, y1, x2, y2.
    stiffness: [[f64; 4]; 4],
}

impl RandomScene {
    fn draw(draws: &mut Draws) -> Self {
        let mut stiffness = [[0.0; 4]; 4];
        let mut spring = |ends: [f64; 4], value: f64| {
            for (i, a) in ends.iter().enumerate() {
                for (j, b) in ends.iter().enumerate() {
                    stiffness[i][j] += value * a * b;
                }
            }
        };
        for (sin, cos, first) in [0, 0, 1, 1].map(|mass| {
            let (sin, cos) = draws.between(0.0, std::f64::consts::PI).sin_cos();
            (sin, cos, mass == 0)
        }) {
            let value = f64::powf(10.0, draws.between(3.0, 4.5));
            spring(if first { [cos, sin, 0.0, 0.0] } else { [0.0, 0.0, cos, sin] }, value);
        }
        let (sin, cos) = draws.between(0.0, std::f64::consts::PI).sin_cos();
        spring([cos, sin, -cos, -sin], f64::powf(10.0, draws.between(-1.0, 4.0)));
        Self { mass: [0, 0].map(|_| draws.between(0.3, 2.0)), stiffness }
    }

    fn model(&self) -> LumpedModel {
        let text = format!(
            "slider = {{ velocity = 0.5, angle = 0.0 }}\nfriction = {{ coefficient = 0.3 }}\n\
             mass = [{{ name = \"a\", mass = {}, force = [0.0, -9.0] }}, {{ name = \"b\", mass = {} }}]\n\
             spring = [{{ name = \"s\", between = [\"a\", \"b\"], direction = \"x\", stiffness = 1.0 }}]\n\
             contact = [{{ name = \"c\", mass = \"a\" }}]\nintegrator = {{ step = 1e-6 }}\n",
            self.mass[0], self.mass[1]
        );
        let mut model = LumpedModel::from(&amontons::scene::parse("random", &text).unwrap());
        let entries = (0..16).map(|at| (at / 4, at % 4, self.stiffness[at / 4][at % 4]));
        model.stiffness = SparseMatrix::from_entries(4, entries.collect());
        model
    }

    /// The discriminant of det(M⁻¹ K − σ), a cubic in σ, in a unit of σ that makes its coefficients about 1.
    fn discriminant(&self, model: &LumpedModel, mu: f64) -> f64 {
        let contact = &model.contacts[0];
        let [normal, tangent] = [&contact.normal, &contact.tangent].map(|row| {
            let mut all = [0.0; 4];
            row.0.iter().for_each(|(place, value)| all[*place] = *value);
            all
        });
        // The force on the mass is N (n + µ t) with the signs of the law; tests do no work on it.
        let sign = (normal[1] * tangent[0]).signum();
        let k = &self.stiffness;
        let unit = 1e4;
        let row = |i: usize| match i {
            0 => std::array::from_fn(|j| (k[0][j] - sign * mu * k[1][j]) / self.mass[0] / unit),
            _ => std::array::from_fn::<f64, 4, _>(|j| k[i + 1][j] / self.mass[1] / unit),
        };
        let a: [[f64; 3]; 3] = [0, 1, 2].map(|i| {
            let all = row(i);
            [all[0], all[2], all[3]]
        });
        let minor = |i: usize, j: usize| a[i][i] * a[j][j] - a[i][j] * a[j][i];
        let b = -(a[0][0] + a[1][1] + a[2][2]);
        let c = minor(0, 1) + minor(0, 2) + minor(1, 2);
        let d = -(a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
            - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
            + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]));
        18.0 * b * c * d - 4.0 * b.powi(3) * d + b * b * c * c - 4.0 * c.powi(3) - 27.0 * d * d
    }
}

/// The changes of the sign of a function, by a fine scan and beside its extrema.
fn changes_of_sign(function: &dyn Fn(f64) -> f64, end: f64) -> Vec<f64> {
    const STEPS: u32 = 20_000;
    let mut values: Vec<f64> = (0..=STEPS).map(|i| end * f64::from(i) / f64::from(STEPS)).collect();
    let known: Vec<f64> = values.iter().map(|&it| function(it)).collect();
    for (three, at) in known.windows(3).zip(1..) {
        let sign = three[1].signum();
        if three.iter().all(|it| it.signum() == sign && it.abs() >= three[1].abs()) {
            let size = |value: f64| -sign * function(value);
            values.push(crate::spectral::largest(&size, [values[at - 1], values[at + 1]]));
        }
    }
    values.sort_by(f64::total_cmp);
    let changes =
        values.windows(2).filter(|two| (function(two[0]) > 0.0) != (function(two[1]) > 0.0));
    changes
        .map(|two| bisect(two[0], two[1], |it| (function(it) > 0.0) == (function(two[0]) > 0.0))[0])
        .collect()
}

#[test]
fn modes_of_random_scenes_merge_and_part_where_the_discriminant_changes_its_sign() {
    let mut draws = Draws(7);
    let (mut all, mut narrow) = (0, 0);
    for scene in 0..150 {
        let random = RandomScene::draw(&mut draws);
        let model = random.model();
        let expected = changes_of_sign(&|mu| random.discriminant(&model, mu), 2.0);
        let found = over_friction(&model, &grid(2.0, 0.1)).coalescences;
        let values: Vec<f64> = found.iter().map(|it| it.value).collect();
        // What merges by less than 1e-7 of σ is one double σ, and two places that near are one.
        let is_resolved = |two: &[f64]| two[1] - two[0] > 1e-6;
        if expected.windows(2).all(is_resolved) {
            assert_eq!(values.len(), expected.len(), "{scene}: {values:?} {expected:?}");
            for (value, expected) in values.iter().zip(&expected) {
                assert!((value - expected).abs() < 1e-7, "{scene}: {values:?} {expected:?}");
            }
            narrow += expected.windows(2).filter(|two| two[1] - two[0] < 0.01).count();
            all += expected.len();
        }
    }
    assert!(all > 30 && narrow > 3, "{all} {narrow}");
}

#[test]
#[ignore = "long: eigenvalues of a hundred scenes at twenty thousand values each"]
fn verdicts_of_random_damped_scenes_are_those_of_a_fine_scan() {
    let mut draws = Draws(11);
    let mut narrow = 0;
    for scene in 0..120 {
        let random = RandomScene::draw(&mut draws);
        let mut model = random.model();
        if scene % 2 == 0 {
            model.damping.alpha = f64::powf(10.0, draws.between(-4.0, 0.0));
            model.damping.beta = f64::powf(10.0, draws.between(-9.0, -5.0));
        } else {
            let damper = |draws: &mut Draws| f64::powf(10.0, draws.between(-4.0, 0.0));
            let all = [0, 2, 3].map(|place| (place, place, damper(&mut draws)));
            model.dampers = SparseMatrix::from_entries(4, all.to_vec());
        }
        let found = over_friction(&model, &grid(2.0, 0.1));
        let stable = crate::stability::candidates::stable_ranges(&found);
        narrow +=
            found.crossings.windows(2).filter(|two| two[1].value - two[0].value < 0.01).count();
        for step in 0..=20_000 {
            let mu = 2.0 * f64::from(step) / 20_000.0;
            let here = model.clone().with_friction(mu);
            let spectrum = Spectrum::of(here.linear().unwrap(), &[ContactState::Slide]).unwrap();
            let is_stable = stable.iter().any(|[from, to]| (*from..=*to).contains(&mu));
            let is_beside = found.turns().any(|turn| (turn.value - mu).abs() < 1e-9);
            assert!(
                is_stable != spectrum.unstable() || is_beside,
                "{scene} {mu}: {} {stable:?} {:?}",
                spectrum.growth_rate(),
                found.crossings
            );
        }
    }
    assert!(narrow > 3, "{narrow}");
}

#[test]
fn growth_that_is_rounding_begins_nowhere() {
    // A mode that dampers do not reach has rates of rounding; another one grows from 0.3 on.
    let evaluate = |p: f64| {
        let lambdas = [Complex::new(1e-12 * (20.0 * p).sin(), 10.0), Complex::new(p - 0.3, 20.0)];
        Ok(lambdas.map(|lambda| Root { sigma: -lambda * lambda, lambda }).to_vec())
    };
    let watched = Watched { frequencies: ALL_FREQUENCIES, merge: false };
    let values = grid(1.0, 0.05);
    let found = follow(&evaluate, &values, watched, &|| {}).unwrap().crossings;
    let [begins] = found[..] else { panic!("{found:?}") };
    assert!(begins.mode == 1 && (begins.value - 0.3).abs() < 1e-15, "{begins:?}");
}

/// The end of growth was once left out where a mode neither grows nor decays before and after it.
#[test]
fn growth_ends_where_a_mode_that_nothing_damps_ceases_to_grow() {
    // Signs of rounding change from point to point, and a third mode has them over the whole range.
    let noise = |p: f64| 1e-13 * (1e7 * p).sin();
    let hump = |p: f64| f64::sqrt(((p - 0.3) * (0.4 - p)).max(0.0));
    let evaluate = |p: f64| {
        let rates = [hump(p) + noise(p), noise(p + 0.1), -1.0];
        let lambda = [10.0, 20.0, 30.0].into_iter().zip(rates);
        let lambda = lambda.map(|(frequency, rate)| Complex::new(rate, frequency));
        Ok(lambda.map(|lambda| Root { sigma: -lambda * lambda, lambda }).collect())
    };
    let watched = Watched { frequencies: ALL_FREQUENCIES, merge: false };
    for step in [0.05, 0.0061] {
        let found = follow(&evaluate, &grid(1.0, step), watched, &|| {}).unwrap().crossings;
        let [begins, ends] = &found[..] else { panic!("{found:?}") };
        assert!(begins.becomes_unstable && !ends.becomes_unstable, "{found:?}");
        assert!((begins.value - 0.3).abs() < 0.01 && (ends.value - 0.4).abs() < 0.01, "{found:?}");
    }
}

/// Of two blocks that diverged, the locus once saw one: it took both of their slow eigenvalues for one mode.
#[test]
fn each_of_two_damped_blocks_diverges_at_its_own_friction() {
    // A block whose spring of stiffness k lies at 45° falls over it from k (1 − µ) / 2 + k0 = 0 on.
    let block = |name: &str, guide: f64| {
        format!(
            "[[mass]]\nname = \"{name}\"\nmass = 1.0\nforce = [0.0, -200.0]\n\
             [[spring]]\nname = \"strut_{name}\"\nbetween = [\"{name}\", \"ground\"]\n\
             direction = {}\nstiffness = 1e4\n\
             [[spring]]\nname = \"guide_{name}\"\nbetween = [\"{name}\", \"ground\"]\n\
             direction = \"x\"\nstiffness = {guide}\n\
             [[damper]]\nname = \"damper_{name}\"\nbetween = [\"{name}\", \"ground\"]\n\
             direction = \"x\"\ndamping = 1.0\n[[contact]]\nname = \"pad_{name}\"\nmass = \"{name}\"\n",
            std::f64::consts::FRAC_PI_4
        )
    };
    let text = format!(
        "slider = {{ velocity = 0.1, angle = 0.0 }}\nfriction = {{ coefficient = 0.3 }}\n\
         integrator = {{ step = 1e-6 }}\n{}{}",
        block("a", 1000.0),
        block("b", 3000.0)
    );
    let model = LumpedModel::from(&amontons::scene::parse("two blocks", &text).unwrap());
    for step in [0.5, 0.01] {
        let found = over_friction(&model, &grid(3.0, step)).crossings;
        let begins: Vec<f64> = found.iter().map(|it| it.value).collect();
        let [first, second] = begins[..] else { panic!("{found:?}") };
        assert!((first - 1.2).abs() < 1e-9 && (second - 1.6).abs() < 1e-9, "{found:?}");
        assert!(found.iter().all(|it| it.becomes_unstable && it.frequency_hz == 0.0));
    }
}
