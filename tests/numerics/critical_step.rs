//! The critical step of random scenes against the spectral radius of one step of the scheme, built
//! here from the printed equations for each contact state.

use amontons::contact::{ContactLaw, ContactState, all_states};
use amontons::model::LumpedModel;
use amontons::scene::{Module, builtin};
use amontons::stability::{Origin, critical_step};
use nalgebra::DMatrix;
use proptest::prelude::*;

/// Limit by which a mode may grow faster than in the model, in parts of |λ|.
const INVENTED_GROWTH: f64 = 1e-3;

fn any_module() -> impl Strategy<Value = Module> {
    (prop::array::uniform2(0.1..2.0), prop::array::uniform6(1e4..5e5)).prop_map(
        |(mass, stiffness)| {
            let scene = builtin("set1").unwrap().scene();
            Module { mass, stiffness, ..scene.modules()[0] }
        },
    )
}

fn any_model(modules: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = LumpedModel> {
    (prop::collection::vec(any_module(), modules), -1.0..1.0, 0.0..1e-4, 0.0..20.0).prop_map(
        |(modules, angle, beta, alpha)| {
            let mut scene = builtin("set1").unwrap().scene();
            *scene.modules_mut() = modules;
            scene.slider.angle = angle;
            (scene.damping.alpha, scene.damping.beta) = (alpha, beta);
            LumpedModel::from(&scene)
        },
    )
}

/// ln ρ / h of the scheme's step, and what the physics and the tolerance allow. `None` for a state that
/// diverges: it sets no limit, because its growth is the physics' own, if not to a thousandth.
fn growth(model: &LumpedModel, states: &[ContactState], h: f64) -> Option<(f64, f64)> {
    let reduced = model.linear().unwrap().reduced(states).unwrap();
    let n = reduced.mass.nrows();
    let inverse = reduced.mass.try_inverse().unwrap();
    let (k, c) = (&inverse * reduced.stiffness, &inverse * reduced.damping);
    // ẋ⁺ = ẋ − h (C ẋ + K x), x⁺ = x + h ẋ⁺.
    let one = DMatrix::identity(n, n);
    let mut step = DMatrix::zeros(2 * n, 2 * n);
    step.view_mut((0, 0), (n, n)).copy_from(&(&one - &k * (h * h)));
    step.view_mut((0, n), (n, n)).copy_from(&(&one * h - &c * (h * h)));
    step.view_mut((n, 0), (n, n)).copy_from(&(&k * -h));
    step.view_mut((n, n), (n, n)).copy_from(&(&one - &c * h));
    let mut flow = DMatrix::zeros(2 * n, 2 * n);
    flow.view_mut((0, n), (n, n)).copy_from(&one);
    flow.view_mut((n, 0), (n, n)).copy_from(&-k);
    flow.view_mut((n, n), (n, n)).copy_from(&-c);
    let radius = step.complex_eigenvalues().iter().fold(0.0, |r, z| f64::max(r, z.norm()));
    let (mut rate, mut size) = (0.0_f64, 0.0_f64);
    for lambda in flow.complex_eigenvalues().iter() {
        if lambda.re > 0.0 && lambda.im.abs() <= 1e-9 * lambda.re {
            return None;
        }
        rate = rate.max(lambda.re);
        size = size.max(lambda.norm());
    }
    Some((radius.ln() / h, rate + INVENTED_GROWTH * size))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn below_the_critical_step_no_state_grows_that_does_not(
        model in any_model(1..=2),
        mu in 0.0..4.0,
    ) {
        let model = model.with_friction(mu);
        let critical = critical_step(&model).unwrap();
        for part in [0.3, 0.7, 0.999] {
            for states in all_states(u32::try_from(model.contacts.len()).unwrap()) {
                let growth = growth(&model, &states, part * critical.step);
                let Some((found, allowed)) = growth else { continue };
                // Eigenvalues that are nearly double are found to half of the digits.
                prop_assert!(found <= allowed + 1e-6 * allowed.abs() + 1e-4, "{states:?} {found} {allowed}");
            }
        }
        if let Origin::State { states, coalesced: false } = critical.origin
            && let Some((found, _)) = growth(&model, &states, 1.01 * critical.step)
        {
            prop_assert!(found > 0.0, "the limit is not sharp: {found}");
        }
    }

    #[test]
    fn the_bound_for_many_contacts_is_never_above_the_limit(
        model in any_model(1..=1),
        mu in 0.0..4.0,
    ) {
        // Seven modules that are not linked have the critical step of one.
        let model = model.with_friction(mu);
        let exact = critical_step(&model).unwrap();
        let mut entries = Vec::new();
        for copy in 0..7 {
            entries.extend(model.stiffness.entries().map(|(i, j, k)| (4 * copy + i, 4 * copy + j, k)));
        }
        let mass: Vec<f64> = (0..4).map(|i| model.mass.get(i, i)).collect();
        let contacts = (0..7).map(|copy| {
            let unit = amontons::model::Direction::unit;
            amontons::model::Contact::new(unit(4 * copy + 3), unit(4 * copy + 2))
        });
        let seven = LumpedModel {
            mass: amontons::model::SparseMatrix::diagonal(&mass.repeat(7)),
            stiffness: amontons::model::SparseMatrix::from_entries(28, entries),
            damping: model.damping,
            dampers: amontons::model::SparseMatrix::zero(28),
            load: vec![0.0; 28],
            contacts: contacts.collect(),
            law: ContactLaw::default(),
        };
        let bound = critical_step(&seven.with_friction(mu)).unwrap();
        prop_assert_eq!(&bound.origin, &Origin::Bound);
        prop_assert!(bound.step <= exact.step, "{} {}", bound, exact);
        prop_assert!(bound.step > 0.002 * exact.step, "the bound is useless: {} {}", bound, exact);
    }
}
