//! Hard cases of contact: grazing, landings of many at once, several contacts on one mass; with the law of
//! contact judged after every step.

use crate::judge::blocks::{STIFFNESS, block, pads, start};
use crate::judge::{METHODS, Run, assert_near, off, scene, with};
use amontons::contact::ContactState::{Detached, Slide, Stick};
use amontons::integrator::{Inputs, Motion, choose};
use amontons::model::LumpedModel;
use amontons::scene::{Method, Module, Ramp, Scene, Shape, Signal, Structure, builtin, parse};
use amontons::simulation::Simulation;
use amontons::stability::critical_step;
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::sync::Arc;

#[test]
fn a_flight_that_just_touches_the_slider_touches_and_one_that_just_misses_does_not() {
    // Pulled up with 8 N more than presses it on, it swings on ω = 20 rad/s about 20 mm, from rest at
    // twice that and a millionth more or less.
    let (omega, middle, h) = (20.0_f64, 8.0 / 400.0, 5e-5);
    let more = |from: f64| {
        format!(
            "[[spring]]\nname = \"up\"\nbetween = [\"block\", \"ground\"]\ndirection = \"y\"\n\
             stiffness = 400.0\n[[signal]]\ninput = \"mass.block.fy\"\nconstant = {{ value = 18.0 }}\n{}",
            start(&format!("y = {from:?}"))
        )
    };
    for method in METHODS {
        // The ellipse and the grid, (ωh)²/8 each, are an eighth of the millionth.
        // Exact motion has its lowest point between two steps.
        let low = off(method, 0.13, 0.125) * (omega * h).powi(2) * middle;
        for (part, touches) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
            let text = block(0.5, 0.1, h, &more(2.0 * middle * part));
            let mut run = Run::new(scene(&text), method);
            let [mut least, mut most] = [f64::MAX, 0.0_f64];
            while run.time() < TAU / omega {
                run.step();
                run.judge_step();
                run.judge_report();
                let [y, _] = run.of_dof("mass.block.y");
                least = least.min(y);
                let is_before = run.simulation.statistics().touch_downs == 0;
                if method == Method::EventDriven && is_before {
                    let expected = middle * (1.0 + (2.0 * part - 1.0) * (omega * run.time()).cos());
                    assert_near(y, expected, 1e-15);
                }
                if run.time() > 0.75 * TAU / omega {
                    most = most.max(y);
                }
            }
            let statistics = run.simulation.statistics();
            // Exact motion leaves the slider again at the instant at which it lands.
            let changes = if method == Method::EventDriven { 0 } else { 2 };
            let expected = if touches { (1, changes) } else { (0, 0) };
            assert_eq!((statistics.touch_downs, statistics.state_changes()), expected, "{part}");
            let highest = if touches { 2.0 * middle } else { 2.0 * middle * part };
            assert_near(least, (2.0 * middle * (1.0 - part)).max(0.0), low);
            // A contact of one step takes it up to a step's acceleration: second order again.
            assert_near(most, highest, 2.0 * low + off(method, (omega * h).powi(2) * middle, 0.0));
        }
    }
}

/// Asserts that the degrees of freedom are copies of the first ones: to the last bit with the paper's
/// scheme, to rounding with exact motion, which solves contacts that share nothing one after the other.
#[track_caller]
fn assert_copies(run: &Run, copies: usize) {
    for values in &run.now {
        let (first, rest) = values.as_slice().split_at(values.len() / copies);
        let tolerance = off(run.method, 0.0, 1e-12 * values.amax());
        for copy in rest.chunks_exact(first.len()) {
            for (a, b) in copy.iter().zip(first) {
                assert!((a - b).abs() <= tolerance, "at {} s: {copy:?} {first:?}", run.time());
            }
        }
    }
}

#[test]
fn equal_modules_that_lift_off_and_land_together_stay_equal() {
    for method in METHODS {
        let mut scene = builtin("set1").unwrap().scene();
        scene.step = 1e-5;
        let module = Module { velocity: [0.3, 0.2, 0.1, 0.5], ..scene.modules()[0] };
        *scene.modules_mut() = vec![module; 4];
        let mut run = Run::new(scene, method);
        for _ in 0..20_000 {
            run.step();
            run.judge_step();
            assert_copies(&run, 4);
        }
        let statistics = run.simulation.statistics();
        assert!(
            statistics.touch_downs >= 4 && statistics.touch_downs.is_multiple_of(4),
            "{statistics:?}"
        );
        assert_eq!(statistics.state_changes() % 4, 0);
    }
}

#[test]
fn copies_in_one_network_stay_equal_and_move_as_one_alone() {
    for method in METHODS {
        let mut three = Run::new(scene(&pads(3, 2.0, 1e-5)), method);
        let mut one = Run::new(scene(&pads(1, 2.0, 1e-5)), method);
        for _ in 0..20_000 {
            for run in [&mut three, &mut one] {
                run.step();
                run.judge_step();
            }
            assert_copies(&three, 3);
        }
        assert!(one.simulation.statistics().touch_downs > 2);
        // A network of its own may be solved in another order.
        for (a, b) in three.now.iter().zip(&one.now) {
            assert!((a.rows(0, b.len()) - b).amax() <= 1e-9 * b.amax());
        }
    }
}

#[test]
fn a_shaft_that_is_knocked_about_in_its_corner_obeys_the_law_in_both_places() {
    // Two contacts on one mass: their four forces do not follow from its two accelerations, so those
    // that are reported are judged, and together they must move the mass as it moves.
    for method in METHODS {
        for mu in [0.0, 0.3, 0.59] {
            for [vx, vy] in [[0.5, 0.0], [0.0, 0.5], [0.4, 0.7], [0.0, 3.0], [1.0, -0.0]] {
                let values = [
                    ("friction.coefficient", mu),
                    ("initial.mass.shaft.vx", vx),
                    ("initial.mass.shaft.vy", vy),
                ];
                let mut run = Run::new(with(builtin("corner").unwrap().scene(), &values), method);
                run.judge_report();
                run.judged_until(0.3);
                assert!(run.simulation.statistics().touch_downs > 0, "{mu} {vx} {vy}");
            }
        }
    }
}

#[test]
fn a_contact_that_stands_twice_changes_no_motion() {
    // Redundant: what the two carry is not determined one by one, but their sum is.
    let mut single = LumpedModel::from(&parse("one", &block(0.4, 0.1, 1e-4, "")).unwrap());
    single.stiffness = amontons::model::SparseMatrix::diagonal(&[STIFFNESS, 50.0]);
    let mut twice = single.clone();
    twice.contacts.push(single.contacts[0].clone());
    for method in METHODS {
        let motions = [&single, &twice].map(|model| {
            let contacts = model.contacts.len();
            let drive = Inputs::uniform(model.load.clone(), contacts, 0.1, 0.4);
            let mut integrator = choose(model, method).unwrap();
            let mut motion =
                Motion::new(vec![-0.05, 1e-3], vec![0.0, 0.3], vec![Detached; contacts]);
            let mut states = Vec::new();
            for _ in 0..20_000 {
                integrator.advance(&mut motion, &drive, 1e-4, 1).unwrap();
                states.push(motion.contacts[0]);
            }
            states.dedup();
            (motion, states)
        });
        let [(one, states), (two, _)] = motions;
        for state in [Slide, Stick, Detached] {
            assert!(states.contains(&state), "{states:?}");
        }
        let values = |motion: &Motion| [&motion.displacement[..], &motion.velocity].concat();
        for (a, b) in values(&one).into_iter().zip(values(&two)) {
            assert_near(a, b, 1e-12);
        }
    }
}

#[test]
fn pads_on_a_disc_ten_thousand_times_lighter_obey_the_law() {
    // Gauss–Seidel leaves (1 + m/M)⁻² of an error in a sweep, for pads m on a disc M: it would take 15 m/M sweeps.
    for mass in [0.3e-2, 0.3e-4] {
        let scene = with(builtin("disc_brake").unwrap().scene(), &[("mass.disc.mass", mass)]);
        let step = 0.1 * critical_step(&LumpedModel::from(&scene).with_friction(0.6)).unwrap().step;
        for method in METHODS {
            let mut run = Run::new(Scene { step, ..scene.clone() }, method);
            for _ in 0..100 {
                run.step();
                run.judge_step();
                run.judge_report();
            }
        }
    }
}

/// Two blocks in space, the upper on the lower along an oblique line, far from anything that stops them.
fn oblique_pair(angle: f64, rest: f64, step: f64) -> String {
    format!(
        "[slider]\nvelocity = 0.2\nangle = {angle:?}\n[friction]\ncoefficient = 0.4\n\
         [integrator]\nstep = {step:?}\n{}[[mass]]\nname = \"upper\"\nmass = 1.0\n\
         force = [{:?}, {:?}]\n[[mass]]\nname = \"lower\"\nmass = 4.0\n\
         [[contact]]\nname = \"c\"\nmass = \"upper\"\non = \"lower\"\n\
         [[signal]]\ninput = \"mass.upper.fx\"\nconstant = {{ value = {:?} }}\n\
         [[signal]]\ninput = \"mass.upper.fy\"\nconstant = {{ value = {:?} }}\n\
         [[initial]]\nmass = \"upper\"\nx = {:?}\ny = {:?}\n",
        ["upper", "lower"]
            .map(|mass| ["x", "y"]
                .map(|way| {
                    let stiffness = if mass == "upper" { 400.0 } else { 1600.0 };
                    format!(
                        "[[spring]]\nname = \"{mass}_{way}\"\nbetween = [\"{mass}\", \"ground\"]\n\
                     direction = \"{way}\"\nstiffness = {stiffness:?}\n"
                    )
                })
                .concat())
            .concat(),
        10.0 * angle.sin(),
        -10.0 * angle.cos(),
        -18.0 * angle.sin(),
        18.0 * angle.cos(),
        -rest * angle.sin(),
        rest * angle.cos(),
    )
}

#[test]
fn two_masses_that_just_touch_each_other_along_an_oblique_line_touch_and_those_that_just_miss_do_not()
 {
    // At rest the contact carries 8 N, which leave 2 N to each of the springs' 400 and 1600 N/m. Both swing
    // on ω = 20 rad/s, so their distance does, about (18 − 8)/400 m less the 8/1600 m by which the lower one
    // rises.
    let (omega, h) = (20.0_f64, 5e-5);
    let middle = 10.0 / 400.0 - 8.0 / 1600.0;
    for method in METHODS {
        for angle in [0.3, -1.1, 2.5] {
            for (part, touches) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
                let text = oblique_pair(angle, 2.0 * middle * part, h);
                let mut run = Run::new(scene(&text), method);
                let normal = [-angle.sin(), angle.cos()];
                let mut least = f64::MAX;
                while run.time() < 0.9 * TAU / omega {
                    run.step();
                    run.judge_step();
                    run.judge_report();
                    let gap: f64 = ["x", "y"]
                        .iter()
                        .zip(normal)
                        .map(|(way, n)| {
                            let at = |mass| run.of_dof(&format!("mass.{mass}.{way}"))[0];
                            n * (at("upper") - at("lower"))
                        })
                        .sum();
                    least = least.min(gap);
                    if method == Method::EventDriven && run.simulation.statistics().touch_downs == 0
                    {
                        let swing = (2.0 * part - 1.0) * (omega * run.time()).cos();
                        assert_near(gap, middle * (1.0 + swing), 1e-14);
                    }
                }
                let touch_downs = run.simulation.statistics().touch_downs;
                assert_eq!(touch_downs, u64::from(touches), "{method:?} {angle} {part} {least:e}");
                let low = off(method, 0.13, 0.125) * (omega * h).powi(2) * middle;
                assert_near(least, (2.0 * middle * (1.0 - part)).max(0.0), 2.0 * low);
            }
        }
    }
}

#[test]
fn a_start_with_closed_contacts_that_approach_each_other_is_an_impact() {
    // 1 kg meets 4 kg: along the normal both go on with a fifth of its velocity. No spring and no load,
    // 30 N at the most, adds more than 3e-8 m/s within a nanosecond.
    let speed: f64 = 0.7;
    for method in METHODS {
        for angle in [0.3_f64, -1.1, 2.5] {
            let velocity = [speed * angle.sin(), -speed * angle.cos()];
            let values =
                [("initial.mass.upper.vx", velocity[0]), ("initial.mass.upper.vy", velocity[1])];
            let scene = with(scene(&oblique_pair(angle, 0.0, 1e-9)), &values);
            let mut run = Run::new(scene, method);
            run.step();
            run.judge_step();
            let at =
                |mass: &str| ["x", "y"].map(|way| run.of_dof(&format!("mass.{mass}.{way}"))[1]);
            let (upper, lower) = (at("upper"), at("lower"));
            let along = |v: [f64; 2]| -v[0] * angle.sin() + v[1] * angle.cos();
            assert_near(along(upper), -speed / 5.0, 3e-8);
            assert_near(along(lower), -speed / 5.0, 3e-8);
            for (i, before) in velocity.into_iter().enumerate() {
                assert_near(upper[i] + 4.0 * lower[i], before, 1e-7);
            }
        }
    }
}

#[test]
fn what_an_impact_throws_off_another_contact_stays_off() {
    // On a floor and against a wall whose normal points half upwards, into which it is thrown: half of the
    // velocity is left along either axis, so it leaves the floor. It climbs the wall, without friction,
    // against k s and (fx − fy)/√2 of its load.
    let (m, k, thrown, h) = (2.0_f64, 5e3, 0.4, 1e-5);
    let text = format!(
        "[slider]\nvelocity = 0.5\nangle = 0.0\n[friction]\ncoefficient = 0.0\n\
         [integrator]\nstep = {h:?}\n[[mass]]\nname = \"shaft\"\nmass = {m:?}\n\
         force = [-10.0, -50.0]\n\
         [[spring]]\nname = \"x\"\nbetween = [\"shaft\", \"ground\"]\ndirection = \"x\"\n\
         stiffness = {k:?}\n\
         [[spring]]\nname = \"y\"\nbetween = [\"shaft\", \"ground\"]\ndirection = \"y\"\n\
         stiffness = {k:?}\n[[contact]]\nname = \"floor\"\nmass = \"shaft\"\n\
         [[contact]]\nname = \"wall\"\nmass = \"shaft\"\nangle = -0.7853981633974483\n\
         [[initial]]\nmass = \"shaft\"\nvx = {:?}\n",
        -thrown
    );
    let omega = (k / m).sqrt();
    let (speed, pressed) = (thrown * 0.5_f64.sqrt(), 40.0 * 0.5_f64.sqrt() / k);
    for method in METHODS {
        let mut run = Run::new(scene(&text), method);
        for _ in 0..1500 {
            run.step();
            run.judge_step();
            let phase = omega * run.time();
            let climbed = speed / omega * phase.sin() - pressed * (1.0 - phase.cos());
            let expected = climbed * 0.5_f64.sqrt();
            // The error of the scheme: half a step of the fastest motion at the start, and once more for its change.
            let tolerance = off(method, 2.0 * h * thrown, 1e-14);
            assert_near(run.of_dof("mass.shaft.y")[0], expected, tolerance);
            assert_near(run.of_dof("mass.shaft.x")[0], -expected, tolerance);
            assert_eq!(run.states(), [Detached, Slide]);
        }
    }
}

#[test]
fn a_contact_that_opens_just_before_a_step_ends_opens_once() {
    // Both ends of a spring of 8 MN/m are a centimetre away: the rounding of 1e5 N at each is more than the
    // gap's acceleration when a normal force has just become nothing. Where little was left of a step it used
    // to say that the contact closes at once, and opens, without an end.
    let module = Module {
        mass: [0.1671094061218659, 0.2877908515282548],
        stiffness: [1e3, 1e3, 5024.586132672292, 3738.1191846627753, 1e3, 7917720.030495536],
        preload: 0.0010113871721130572,
        force: [0.0; 4],
        displacement: [0.0; 4],
        velocity: [0.0; 4],
    };
    let mut scene = builtin("set1").unwrap().scene();
    *scene.modules_mut() = vec![module];
    (scene.friction_coefficient, scene.slider.angle) = (4.344620449356089, -1.0293618886673346);
    (scene.slider.velocity, scene.damping.beta) = (1.0, 0.0);
    let step = 8.731529129012253
        * critical_step(&LumpedModel::from(&scene).with_friction(4.4)).unwrap().step;
    let ramp = Ramp { from: -1.0, to: 0.0, start: step, end: 2.0 * step };
    let input = "slider.velocity".to_owned();
    scene.signals = Arc::new([Signal { input, shape: Shape::Ramp(ramp) }]);
    let scene = Scene { method: Method::EventDriven, step, ..scene };
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    simulation.advance_to(8.0 * step).unwrap();
    let start = simulation.save();
    let (mut last, mut opened) = (simulation.contact_forces().unwrap()[0].state, 0);
    for part in 1..20_000 {
        simulation.restore(&start).unwrap();
        simulation.advance_to((8.0 + f64::from(part) / 20_000.0) * step).unwrap();
        let state = simulation.contact_forces().unwrap()[0].state;
        opened += u32::from(state == Detached && last != Detached);
        last = state;
    }
    assert_eq!(opened, 1);
}

/// Two states each led to the other without an end: a slip that had stopped was left with a rounding error
/// of some direction, since only contacts along a degree of freedom were put to rest.
#[test]
fn pads_that_bind_at_a_friction_of_seven_obey_the_law() {
    let mut disc_brake = builtin("disc_brake").unwrap().scene();
    let Structure::Network(network) = &mut disc_brake.structure else { unreachable!() };
    let stiffness = [3076.5535201977814, 1e3, 1e3, 7650466.184260128, 461115.1138640625, 1e3];
    for (spring, stiffness) in network.springs.iter_mut().zip(stiffness.iter().cycle()) {
        spring.stiffness = *stiffness;
        if spring.name.ends_with("strut") {
            spring.direction = amontons::scene::Line::Angle(-0.238545754358139);
        }
    }
    let [mass, load] = [
        [0.183305856563989, 1.8175562864327168, 1.8627616087772376],
        [1.0, 276.2164318399124, 0.0],
    ];
    for (i, part) in network.masses.iter_mut().enumerate() {
        part.mass = mass[i];
        if part.name != "disc" {
            part.load[1] = load[i].copysign(part.load[1]);
            part.velocity = [0.0, -f64::from(u8::from(i == 1))];
        }
    }
    network.contacts.iter_mut().for_each(|contact| contact.velocity = None);
    (disc_brake.friction_coefficient, disc_brake.slider.velocity) = (7.0398013464884714, 0.0);
    let critical = critical_step(&LumpedModel::from(&disc_brake)).unwrap();
    disc_brake.step = 9.5 * critical.step;
    // At its limit all the way, a contact sticks and slips for no longer than rounding says: the parts of a
    // step that the judge of motions takes again are others each time. The law holds at the end of each.
    let mut run = Run::new(disc_brake, Method::EventDriven);
    for _ in 0..2000 {
        run.step();
        run.judge_report();
    }
}

#[test]
fn damping_by_the_mass_and_a_force_that_rises_within_a_step_follow_the_closed_form() {
    // ẍ + α ẋ + ω² x = r t from rest, without friction.
    let (alpha, omega, rate): (f64, f64, f64) = (4.0, 10.0, 30.0);
    let damped = (omega * omega - alpha * alpha / 4.0).sqrt();
    let cosine = rate * alpha / omega.powi(4);
    let sine = (alpha / 2.0 * cosine - rate / omega.powi(2)) / damped;
    for method in METHODS {
        for h in [1e-3, off(method, 1e-4, 1e-2)] {
            let more = format!(
                "[damping]\nalpha = {alpha:?}\n[[signal]]\ninput = \"mass.block.fx\"\n\
                 ramp = {{ to = {:?}, end = 2.0 }}",
                2.0 * rate
            );
            let mut run = Run::new(scene(&block(0.0, 0.1, h, &more)), method);
            while run.time() < 1.0 {
                run.step();
                run.judge_step();
                let t = run.time();
                let swing = cosine * (damped * t).cos() + sine * (damped * t).sin();
                let drift = rate / omega.powi(2) * (t - alpha / omega.powi(2));
                let expected = drift + (-alpha * t / 2.0).exp() * swing;
                // The scheme is late by up to a step, at twice the velocity r/ω² at the most.
                let tolerance = off(method, 2.0 * h * rate / omega.powi(2), 1e-14);
                assert_near(run.of_dof("mass.block.x")[0], expected, tolerance);
            }
        }
    }
}

/// Masses of which each rests on the slider by several contacts, all in one place or in two directions.
fn many_holds(copies: [usize; 2], wedged: bool) -> LumpedModel {
    let mut model = LumpedModel::from(&parse("pads", &pads(2, 2.0, 1e-5)).unwrap());
    let places = model.contacts.clone();
    model.contacts.clear();
    for (place, copies) in places.iter().zip(copies) {
        model.contacts.extend(std::iter::repeat_n(place.clone(), copies));
    }
    if wedged {
        // And in an order in which those of one mass do not stand together.
        model.contacts.reverse();
        let last = model.contacts.len() - 1;
        model.contacts.swap(0, last);
    }
    model
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn however_many_contacts_hold_a_mass_in_one_place_it_moves_the_same(
        copies in prop::array::uniform2(1_usize..=4),
        wedged in any::<bool>(),
        mu in 0.0..2.0,
        slider in -0.5..0.5,
        velocity in prop::array::uniform8(-0.5..0.5),
    ) {
        for method in METHODS {
            // Impacts of the scheme come a step late.
            let step = off(method, 1e-5, 1e-3);
            let [one, many] = [([1, 1], false), (copies, wedged)].map(|(copies, wedged)| {
                let model = many_holds(copies, wedged);
                let contacts = model.contacts.len();
                let drive = Inputs::uniform(model.load.clone(), contacts, slider, mu);
                let mut motion = Motion::new(vec![0.0; model.dofs()], velocity.to_vec(), vec![Detached; contacts]);
                for contact in &model.contacts {
                    motion.displacement[contact.normal.as_unit().unwrap()] = 1e-4;
                }
                let mut integrator = choose(&model, method).unwrap();
                for _ in 0..(0.03 / step).round() as u32 {
                    integrator.advance(&mut motion, &drive, step, 1).unwrap();
                }
                motion
            });
            for (a, b) in one.displacement.iter().zip(&many.displacement) {
                prop_assert!((a - b).abs() <= 1e-11, "{:?} {:?}", one, many);
            }
            for (a, b) in one.velocity.iter().zip(&many.velocity) {
                prop_assert!((a - b).abs() <= 1e-8, "{:?} {:?}", one, many);
            }
        }
    }
}
