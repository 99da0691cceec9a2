use super::*;
use crate::assign::assign;
use amontons::contact::ContactState::{ReverseSlide, Slide, Stick};
use amontons::scene::{
    Freedom, NodeAt, Point, Scene, Structure, Superelement, SuperelementMatrices, builtin, parse,
};
use amontons::stability::Spectrum;

const ALL: [f64; 2] = [0.0, f64::INFINITY];

/// Two masses with turned axes on the slider, friction that falls with the slip velocity, preloads, forces and dampers.
const FALLING: &str = r#"
slider = { velocity = 0.1, angle = 0.3 }
friction = { coefficient = 0.2, static = 0.4, stribeck_velocity = 0.1 }
damping = { alpha = 0.5, beta = 1e-5 }
integrator = { step = 1e-5 }
inputs = { forces = "parameter" }
mass = [
    { name = "a", mass = 1.0, angle = 0.2, force = [3.0, -20.0] },
    { name = "b", mass = 0.5, force = [0.0, -9.0] },
]
spring = [
    { name = "ax", between = ["a", "ground"], direction = "x", stiffness = 1e4 },
    { name = "ay", between = ["a", "ground"], direction = "y", stiffness = 3e4, preload = 1e-4 },
    { name = "bx", between = ["b", "ground"], direction = 0.7, stiffness = 2e4 },
    { name = "by", between = ["b", "ground"], direction = 2.0, stiffness = 1.5e4 },
    { name = "ab", between = ["a", "b"], direction = 1.0, stiffness = 8e3, preload = 2e-4 },
]
damper = [{ name = "d", between = ["a", "b"], direction = "x", damping = 3.0 }]
contact = [
    { name = "first", mass = "a" },
    { name = "second", mass = "b", friction = 0.25, static_friction = 0.5, velocity = 0.07 },
]
"#;

/// The falling scene, whose second contact is at a node in space, with friction across the sliding.
fn in_space() -> Scene {
    let mut scene = parse("falling", FALLING).unwrap();
    scene.transverse_damping = true;
    let Structure::Network(network) = &mut scene.structure else { panic!() };
    let freedoms = (1..=3).map(|direction| Freedom { node: 17, direction }).collect();
    let mass = vec![0.4, 0.01, 0.0, 0.01, 0.5, 0.02, 0.0, 0.02, 0.45];
    let stiffness = vec![9e3, 1e3, 0.0, 1e3, 8e3, -2e3, 0.0, -2e3, 7e3];
    let matrices = SuperelementMatrices::new(freedoms, mass, stiffness, vec![]).unwrap();
    let mut node = Superelement::new("node", matrices);
    node.load = vec![1.0, -12.0, 0.5];
    network.superelements.push(node);
    let contact = &mut network.contacts[1];
    contact.mass = Point::Node(NodeAt { superelement: 0, node: 17 });
    contact.axes = Some([[0.1, 1.0, 0.2], [1.0, -0.1, 0.0]]);
    scene
}

fn eigenvalues_of(scene: &Scene, states: &[ContactState]) -> Vec<Complex<f64>> {
    let here = Linearised::of(scene);
    let Spectrum { oscillating, real } = Spectrum::of(here.linear().unwrap(), states).unwrap();
    oscillating.into_iter().chain(real.into_iter().map(Complex::from)).collect()
}

/// Compares all derivatives with differences of the fourth order.
fn compare(scene: &Scene, states: &[ContactState]) {
    let here = Linearised::of(scene);
    let found = sensitivities(&here, states, ALL, &|_, _| {}).unwrap();
    assert!(!found.modes.is_empty() && found.parameters.len() > 5);
    let relative = |mode: &ModeSensitivity, i: usize| {
        mode.derivatives.as_ref().unwrap()[i][0].norm() * found.parameters[i].value.abs()
    };
    for mode in &found.modes {
        let largest =
            (0..found.parameters.len()).map(|i| relative(mode, i)).fold(0.0_f64, f64::max);
        for (i, Parameter { name, value, .. }) in found.parameters.iter().enumerate() {
            let h = 1e-3 * value.abs().max(1e-3);
            let at = |by: f64| {
                let mut scene = scene.clone();
                assign(&mut scene, name, value + by).unwrap();
                let all = eigenvalues_of(&scene, states);
                let apart = |it: &Complex<f64>| (it - mode.eigenvalue).norm();
                all.into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap()
            };
            let central = |h: f64| (at(h) - at(-h)) / (2.0 * h);
            let exact = (central(0.5 * h) * 4.0 - central(h)) / 3.0;
            let found = mode.derivatives.as_ref().unwrap()[i][0];
            let floor = 1e-8 * largest / value.abs().max(1e-3);
            assert!(
                (found - exact).norm() < 1e-6 * exact.norm() + floor,
                "{} by {name}: {found}, {exact} by differences",
                mode.eigenvalue
            );
        }
    }
}

#[test]
fn derivatives_of_falling_friction_follow_the_forces_of_the_equilibrium() {
    let scene = parse("falling", FALLING).unwrap();
    for states in [[Slide, Slide], [Slide, Stick], [ReverseSlide, Slide]] {
        compare(&scene, &states);
    }
    let here = Linearised::of(&scene);
    let found = sensitivities(&here, &[Slide, Slide], ALL, &|_, _| {}).unwrap();
    for name in ["spring.ab.preload", "slider.velocity", "friction.stribeck_velocity", "mass.a.fy"]
    {
        assert!(found.parameters.iter().any(|it| it.name == name), "{name} has an effect");
    }
}

#[test]
fn derivatives_include_friction_across_the_sliding_in_space() {
    compare(&in_space(), &[Slide, Slide]);
}

#[test]
fn a_chain_of_equal_modules_has_two_derivatives_of_a_double_eigenvalue() {
    let scene = builtin("ring12").unwrap().scene();
    let here = Linearised::of(&scene);
    let found = sensitivities(&here, &[Slide; 12], [190.0, 200.0], &|_, _| {}).unwrap();
    let place = |name: &str| found.parameters.iter().position(|it| it.name == name).unwrap();
    let [first, second, beta] = ["module[1].k5", "module[4].k5", "damping.beta"].map(place);
    for mode in &found.modes {
        assert_eq!(mode.copies, 2);
        let derivatives = mode.derivatives.as_ref().unwrap();
        // One of the two waves has a node at the module that changes.
        let least = derivatives[first].iter().map(|by| by.norm()).fold(f64::MAX, f64::min);
        assert!(least < 1e-12 * derivatives[first][0].norm().max(derivatives[first][1].norm()));
        // Every module stands for all, and damping acts on both waves.
        assert!((derivatives[first][0] - derivatives[second][0]).norm() < 1e-15);
        let [a, b] = derivatives[beta][..] else { panic!() };
        assert!((a - b).norm() < 1e-9 * a.norm());
    }
}

/// Set 1 with damping left out: two modes merge exactly, with a derivative that is unbounded on both sides.
#[test]
fn at_a_merging_there_is_no_derivative_but_that_of_its_place() {
    let mut scene = builtin("set1").unwrap().scene();
    assign(&mut scene, "damping.beta", 0.0).unwrap();
    let all = critical_friction(&scene, &[Slide; 2], [0.5, 1.0], ALL, &|_, _| {}).unwrap();
    let [critical] = &all[..] else { panic!("{all:?}") };
    assert!(critical.is_merging);
    for off in [0.0, 1e-13, -1e-12, 1e-9, -1e-6, 1e-3] {
        assign(&mut scene, FRICTION, critical.value + off).unwrap();
        let here = Linearised::of(&scene);
        let hz = critical.frequency_hz;
        let range = [hz - 1.5, hz + 1.5];
        let found = sensitivities(&here, &[Slide; 2], range, &|_, _| {}).unwrap();
        for mode in &found.modes {
            let merging = mode.merging.as_ref().unwrap();
            assert!((merging.friction - critical.value).abs() < 1e-11, "{off}: {merging:?}");
            assert!((merging.distance - off.abs()).abs() < 1e-11, "{off}: {merging:?}");
            for (Parameter { name, value, .. }, by) in critical.derivatives.as_ref().unwrap() {
                let place = found.parameters.iter().position(|it| it.name == *name).unwrap();
                let other = merging.derivatives[place][0];
                assert!(
                    (by[0] - other).abs() * value.abs() < 1e-9,
                    "{off}, {name}: {by:?} {other}"
                );
            }
            let derivatives = mode.derivatives.iter().flatten().flatten();
            assert!(derivatives.into_iter().all(|by| by.is_finite()));
        }
    }
}

#[test]
fn contacts_that_hold_one_motion_twice_have_no_derivatives() {
    let second = "contact = [{ name = \"again\", mass = \"a\", friction = 0.2, velocity = 0.1 },";
    let text = FALLING
        .replace(
            "friction = { coefficient = 0.2, static = 0.4, stribeck_velocity = 0.1 }",
            "friction = { coefficient = 0.2 }",
        )
        .replace(", static_friction = 0.5", "")
        .replace("contact = [", second);
    let scene = parse("twice", &text).unwrap();
    let here = Linearised::of(&scene);
    let error = sensitivities(&here, &[Slide; 3], ALL, &|_, _| {}).unwrap_err();
    assert!(error.to_string().contains("hold one motion"), "{error}");
}

/// Two double eigenvalues of a ring without damping merge: one of the two waves does not feel a change of one module.
#[test]
fn where_double_modes_of_a_ring_merge_the_place_has_two_derivatives() {
    let mut scene = builtin("ring12").unwrap().scene();
    assign(&mut scene, "damping.beta", 0.0).unwrap();
    let all = critical_friction(&scene, &[Slide; 12], [0.65, 1.2], [185.0, 260.0], &|_, _| {});
    let all = all.unwrap();
    let doubles: Vec<&CriticalFriction> = all.iter().filter(|it| it.copies == 2).collect();
    assert!(doubles.len() >= 3, "{all:?}");
    for critical in doubles {
        assert!(critical.is_merging);
        let of = |module: usize| {
            let name = format!("module[{module}].k5");
            let (parameter, by) =
                critical.derivatives.as_ref().unwrap().iter().find(|it| it.0.name == name).unwrap();
            [by[0] * parameter.value, by[1] * parameter.value]
        };
        let first = of(1);
        assert!(first[0].abs() < 1e-7 && first[1] < -0.1, "{first:?}");
        for module in 2..=12 {
            let other = of(module);
            assert!((first[1] - other[1]).abs() < 1e-8, "{module}: {first:?} {other:?}");
        }
    }
    // By differences of the place itself, found anew with another module.
    let place = |part: f64| {
        let mut scene = scene.clone();
        assign(&mut scene, "module[1].k5", 300e3 * (1.0 + part)).unwrap();
        let range = [0.705, 0.7125];
        let all = critical_friction(&scene, &[Slide; 12], range, [185.0, 260.0], &|_, _| {});
        all.unwrap().iter().map(|it| it.value).fold(f64::MAX, f64::min)
    };
    let difference = (place(1e-5) - place(-1e-5)) / 1e-5;
    let critical = all.iter().find(|it| (it.value - 0.708_211).abs() < 1e-5).unwrap();
    let (parameter, by) = critical
        .derivatives
        .as_ref()
        .unwrap()
        .iter()
        .find(|it| it.0.name == "module[1].k5")
        .unwrap();
    // One of the two places moves; the least is that of the moved one for a stiffer module alone.
    assert!((by[1] * parameter.value - difference).abs() < 1e-3, "{by:?} {difference}");
}

/// Modes beside a pair that merges once claimed its merging as theirs.
#[test]
fn only_the_two_modes_that_merge_claim_their_merging() {
    let scene = builtin("ring12").unwrap().scene();
    for friction in [1.0, 1.2, 1.5, 1.93, 1.96] {
        let mut scene = scene.clone();
        assign(&mut scene, FRICTION, friction).unwrap();
        let here = Linearised::of(&scene);
        let found = sensitivities(&here, &[Slide; 12], ALL, &|_, _| {}).unwrap();
        let claims = found.modes.iter().filter_map(|mode| mode.merging.as_ref());
        let claims: Vec<&Merging> = claims.collect();
        for one in &claims {
            let same = |it: &&&Merging| {
                (it.eigenvalue - one.eigenvalue).norm() < 1e-6 * one.eigenvalue.norm()
                    && (it.friction - one.friction).abs() < 1e-9
            };
            assert_eq!(claims.iter().filter(same).count(), 2, "µ = {friction}: {one:?}");
        }
    }
}

/// The place of a merging moves with the slider's angle as it does at the merging, also next to it.
#[test]
fn the_place_of_a_merging_moves_alike_from_wherever_it_is_seen() {
    let of = |friction: f64| {
        let mut scene = builtin("hoffmann").unwrap().scene();
        assign(&mut scene, FRICTION, friction).unwrap();
        let here = Linearised::of(&scene);
        let found = sensitivities(&here, &[Slide], ALL, &|_, _| {}).unwrap();
        let place = found.parameters.iter().position(|it| it.name == "slider.angle").unwrap();
        found.modes[0].merging.as_ref().unwrap().derivatives[place][0]
    };
    for friction in [0.2565, 0.2575, 0.2584] {
        assert!((of(friction) - of(0.255_94)).abs() < 1e-8, "{friction}");
    }
}

/// Soft modes that differ less than the rounding of stiff springs were given shapes that mix both.
#[test]
fn modes_that_rounding_mixes_are_taken_together() {
    let part = |name: &str, soft: f64| {
        format!(
            "mass = [{{ name = \"{name}a\", mass = 1.0, locked = [\"y\"] }}, {{ name = \"{name}b\", mass = 1.0, \
             locked = [\"y\"] }}]\nspring = [{{ name = \"g{name}\", between = [\"{name}a\", \"ground\"], direction = \
             \"x\", stiffness = {soft:?} }}, {{ name = \"k{name}\", between = [\"{name}a\", \"{name}b\"], direction = \
             \"x\", stiffness = 1e10 }}]\n"
        )
    };
    let (first, second) = (part("p", 100.0), part("q", 100.0 * (1.0 + 1e-9)));
    let lists = |key: &str| {
        let of = |text: &str| {
            let after = text.split(&format!("{key} = [")).nth(1).unwrap().to_owned();
            after.split("]\n").next().unwrap().to_owned()
        };
        format!("{key} = [{}, {}]\n", of(&first), of(&second))
    };
    let text = format!(
        "slider = {{ velocity = 0.1, angle = 0.0 }}\nfriction = {{ coefficient = 0.0 }}\nintegrator = {{ step = 1e-6 }}\n{}{}",
        lists("mass"),
        lists("spring")
    );
    let scene = parse("soft", &text).unwrap();
    let here = Linearised::of(&scene);
    let found = sensitivities(&here, &[], [0.0, 10.0], &|_, _| {}).unwrap();
    let [both] = &found.modes[..] else { panic!("{:?}", found.modes) };
    assert_eq!(both.copies, 2);
    let place = found.parameters.iter().position(|it| it.name == "spring.gp.stiffness").unwrap();
    let mut by: Vec<f64> =
        both.derivatives.as_ref().unwrap()[place].iter().map(|by| by.im / TAU).collect();
    by.sort_by(f64::total_cmp);
    // f = √(g / 2m) / 2π of one of them.
    let expected = (100.0_f64 / 2.0).sqrt() / TAU / 200.0;
    assert!(by[0].abs() < 1e-6 * expected && (by[1] / expected - 1.0).abs() < 1e-6, "{by:?}");
}

#[test]
fn a_large_ring_has_derivatives_too() {
    let mut scene = builtin("ring12").unwrap().scene();
    let module = scene.modules()[0];
    *scene.modules_mut() = vec![module; 60];
    let here = Linearised::of(&scene);
    let found = sensitivities(&here, &[Slide; 60], [197.0, 197.5], &|_, _| {}).unwrap();
    assert!(!found.modes.is_empty());
}
