use super::*;
use crate::assign::{assign, value_of};
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
            for (name, by) in &critical.derivatives {
                let place = found.parameters.iter().position(|it| it.name == *name).unwrap();
                let scale = value_of(&scene, name).unwrap().abs();
                let other = merging.derivatives[place].unwrap();
                assert!((by[0] - other).abs() * scale < 1e-9, "{off}, {name}: {by:?} {other}");
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
