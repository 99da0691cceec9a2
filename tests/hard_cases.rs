//! The hard cases of dry friction and impact, against closed forms and invariants, with the law of
//! contact judged after every step.
//!
//! Each runs with every integrator. An integrator of first order may be off by a multiple of its step
//! h that is derived beside the case; with ω the frequency, the paper's scheme moves along
//! x² + ẋ²/ω² − h x ẋ = A², so amplitudes are off in second order, by the part (ωh)²/8, and velocities
//! belong to times half a step earlier.
#![cfg(feature = "tools")]

mod judge;

use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::integrator::{Drive, Motion, Statistics};
use amontons::model::LumpedModel;
use amontons::scene::{BUILTIN, Module, Pulse, Scene, Shape, Signal, Structure, builtin, parse};
use amontons::simulation::Simulation;
use amontons::stability::critical_step;
use judge::{METHODS, Method, Run, assert_near, with};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::sync::Arc;

/// A block of 1 kg on a spring of 100 N/m along the slider, ω = 10 rad/s, pressed with 10 N.
fn block(mu: f64, velocity: f64, step: f64, more: &str) -> String {
    format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = {mu:?}\n\
         [integrator]\nstep = {step:?}\n[[mass]]\nname = \"block\"\nmass = 1.0\n\
         force = [0.0, -10.0]\n[[spring]]\nname = \"hold\"\nbetween = [\"block\", \"ground\"]\n\
         direction = \"x\"\nstiffness = 100.0\n[[contact]]\nname = \"c\"\nmass = \"block\"\n{more}"
    )
}

const OMEGA: f64 = 10.0;
const PRESSING: f64 = 10.0;
const STIFFNESS: f64 = 100.0;

/// `[[initial]]` of the block, from the equilibrium.
fn start(values: &str) -> String {
    format!("[[initial]]\nmass = \"block\"\n{values}\n")
}

/// Judged steps up to `end` (s); the times at which the only contact takes another state, and which.
fn changes(run: &mut Run, end: f64) -> Vec<(f64, ContactState)> {
    let mut now = run.states()[0];
    let mut found = Vec::new();
    while run.time() < end - 0.5 * run.h() {
        run.step();
        run.judge_step();
        run.judge_report();
        let state = run.states()[0];
        if state != now {
            found.push((run.time(), state));
        }
        now = state;
    }
    found
}

#[test]
fn every_shipped_scene_obeys_the_law_after_every_step() {
    for builtin in BUILTIN {
        for method in METHODS {
            let scene = builtin.scene();
            let late = 0.6 * scene.experiment.stop_time / scene.step;
            let mut run = Run::new(scene, method);
            // As it starts, and when it does what it is there to show.
            run.judged_until(5_000.0 * run.h());
            run.jump(late as u64);
            run.judged_until(run.time() + 15_000.0 * run.h());
        }
    }
}

#[test]
fn with_one_coefficient_of_friction_no_oscillation_on_a_belt_grows() {
    let h = 2.5e-4;
    for method in METHODS {
        for velocity in [0.1, -0.1, 1e-9] {
            let reach = f64::abs(velocity) / OMEGA;
            for part in [0.3, 0.99, 1.5, 6.0] {
                let from = -part * velocity / OMEGA;
                let text = block(0.4, velocity, h, &start(&format!("x = {from:?}")));
                let mut run = Run::new(method.scene(&text), method);
                let amplitude = |run: &Run| {
                    let [x, v] = run.of_dof("mass.block.x");
                    x.hypot(v / OMEGA)
                };
                // Where it slips, h x ẋ of the ellipse is at most ωh/2 of its square.
                let swing = method.off(0.25 * OMEGA * h);
                let mut largest = part * reach;
                for _ in 0..40 {
                    let [mut least, mut most] = [f64::MAX, 0.0_f64];
                    run.judged_until(run.time() + TAU / OMEGA);
                    for _ in 0..10 {
                        run.judged_until(run.time() + 0.1 * TAU / OMEGA);
                        if run.states()[0] != Stick {
                            least = least.min(amplitude(&run));
                            most = most.max(amplitude(&run));
                        }
                    }
                    assert!(most <= largest * (1.0 + 2.0 * swing), "{part} at {}", run.time());
                    if part < 1.0 {
                        assert!(least >= part * reach * (1.0 - 2.0 * swing), "{part}: {least}");
                    }
                    largest = f64::max(most, part.min(1.0) * reach);
                }
                // The belt lets it go up to a step late, V h further on: √(1 + (ωh)²) of V/ω.
                assert_near(largest, part.min(1.0) * reach, reach * 2.0 * swing);
            }
        }
    }
}

#[test]
fn a_free_oscillation_loses_twice_the_friction_offset_each_half_period_and_stops_inside_it() {
    let (mu, from) = (0.04, 0.1037);
    let offset = mu * PRESSING / STIFFNESS;
    // The first turning point inside ±µN/k is where it stays.
    let halves = (0..).find(|&n| f64::abs(from - 2.0 * offset * f64::from(n)) <= offset).unwrap();
    assert_eq!(halves, 13);
    for method in METHODS {
        for h in [1e-3, 1e-4] {
            let text = block(mu, 0.0, h, &start(&format!("x = {from:?}")));
            let mut run = Run::new(method.scene(&text), method);
            let mut turns = Vec::new();
            let mut way = -1.0;
            let mut last = from;
            // The last turn is a stop, found by the velocity that stays zero.
            while run.time() < 14.0 * PI / OMEGA {
                run.step();
                run.judge_step();
                run.judge_report();
                let [x, v] = run.of_dof("mass.block.x");
                if v * way < 0.0 {
                    turns.push((run.time(), last));
                    way = v.signum();
                }
                last = x;
            }
            turns.push((f64::NAN, last));
            assert_eq!(turns.len(), halves as usize);
            for (n, (time, x)) in (1_i32..).zip(turns) {
                let n = f64::from(n);
                let sense = if n % 2.0 == 0.0 { 1.0 } else { -1.0 };
                let expected = sense * (from - 2.0 * n * offset);
                // Friction turns round up to a step late, where the velocity is below ω² A h: that is
                // (ωh)² of the amplitude a half period; as much again for where the grid lies.
                let tolerance = method.off(n * 2.0 * (OMEGA * h).powi(2) * from);
                assert_near(x, expected, tolerance);
                if !time.is_nan() {
                    assert_near(time, n * PI / OMEGA, method.off((1.0 + n) * h));
                }
            }
            assert!(last.abs() <= offset);
            let stopped = run.now.clone();
            run.jump(100_000);
            assert_eq!(run.now, stopped, "it creeps");
            assert_eq!(run.states(), [Stick]);
        }
    }
}

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
        let off = method.off(0.13 * (omega * h).powi(2) * middle);
        for (part, touches) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
            let text = block(0.5, 0.1, h, &more(2.0 * middle * part));
            let mut run = Run::new(method.scene(&text), method);
            let [mut least, mut most] = [f64::MAX, 0.0_f64];
            while run.time() < TAU / omega {
                run.step();
                run.judge_step();
                run.judge_report();
                let [y, _] = run.of_dof("mass.block.y");
                least = least.min(y);
                if run.time() > 0.75 * TAU / omega {
                    most = most.max(y);
                }
            }
            let statistics = run.simulation.statistics();
            let expected = if touches { (1, 2) } else { (0, 0) };
            assert_eq!((statistics.touch_downs, statistics.state_changes), expected, "{part}");
            let highest = if touches { 2.0 * middle } else { 2.0 * middle * part };
            assert_near(least, (2.0 * middle * (1.0 - part)).max(0.0), off);
            // A contact of one step takes it up to a step's acceleration: second order again.
            assert_near(most, highest, 2.0 * off + method.off((omega * h).powi(2) * middle));
        }
    }
}

#[test]
fn a_swing_that_just_reaches_the_belts_velocity_sticks_and_one_that_just_does_not_slips_on() {
    let (velocity, h) = (0.1, 1e-4);
    for method in METHODS {
        for (part, sticks) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
            let from = -part * velocity / OMEGA;
            let text = block(0.4, velocity, h, &start(&format!("x = {from:?}")));
            let mut run = Run::new(method.scene(&text), method);
            let found = changes(&mut run, TAU / OMEGA);
            assert_eq!(found.iter().any(|change| change.1 == Stick), sticks, "{found:?}");
            if let [(caught, _), (free, _)] = found[..] {
                // It is as fast as the belt from ωt = asin(1/part) to its mirror image.
                let early = f64::acos(1.0 / part) / OMEGA;
                let middle = 0.5 * PI / OMEGA;
                // The ellipse shifts the first by √(2 (ωh)²/4) / ω at most, the grid both.
                assert_near(caught, middle - early, method.off(2.0 * h));
                assert_near(free, middle + early, method.off(4.0 * h));
            } else {
                assert!(found.is_empty(), "{found:?}");
            }
        }
    }
}

/// Asserts that the degrees of freedom are copies of the first ones, to the last bit.
#[track_caller]
fn assert_copies(run: &Run, copies: usize) {
    for values in &run.now {
        let (first, rest) = values.as_slice().split_at(values.len() / copies);
        for copy in rest.chunks_exact(first.len()) {
            assert_eq!(copy, first, "at {} s", run.time());
        }
    }
}

#[test]
fn equal_modules_that_lift_off_and_land_together_stay_equal_to_the_last_bit() {
    for method in METHODS {
        let Method::ForwardIncrement = method;
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
        assert_eq!(statistics.state_changes % 4, 0);
    }
}

/// Pads on links, each with its own contact, and a damper, which no ring has.
fn pads(copies: usize, damping: f64, step: f64) -> String {
    let mut text = format!(
        "[slider]\nvelocity = 0.2\nangle = 0.3\n[friction]\ncoefficient = 0.7\n\
         [damping]\nbeta = 1e-5\n[integrator]\nstep = {step:?}\n"
    );
    for i in 0..copies {
        let _ = write!(
            text,
            "[[mass]]\nname = \"arm{i}\"\nmass = 0.4\nforce = [3.0, -60.0]\n\
             [[mass]]\nname = \"pad{i}\"\nmass = 0.2\nangle = 0.3\n\
             [[contact]]\nname = \"c{i}\"\nmass = \"pad{i}\"\n\
             [[initial]]\nmass = \"pad{i}\"\ny = 1e-4\nvx = 0.4\nvy = 0.6\n"
        );
        let _ = write!(
            text,
            "[[damper]]\nname = \"e{i}\"\nbetween = [\"arm{i}\", \"ground\"]\n\
             direction = \"x\"\ndamping = {damping:?}\n"
        );
        for (name, other, direction, k) in [
            ("a", "ground".to_owned(), 0.2, 4e4),
            ("b", "ground".to_owned(), 1.4, 2e4),
            ("c", format!("pad{i}"), 0.1, 1e5),
            ("d", format!("pad{i}"), 1.7, 2e5),
        ] {
            let _ = write!(
                text,
                "[[spring]]\nname = \"{name}{i}\"\nbetween = [\"arm{i}\", \"{other}\"]\n\
                 direction = {direction:?}\nstiffness = {k:?}\n"
            );
        }
    }
    text
}

#[test]
fn copies_in_one_network_stay_equal_to_the_last_bit_and_move_as_one_alone() {
    for method in METHODS {
        let mut three = Run::new(method.scene(&pads(3, 2.0, 1e-5)), method);
        let mut one = Run::new(method.scene(&pads(1, 2.0, 1e-5)), method);
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
fn a_slider_that_stops_and_goes_back_takes_the_block_along_and_then_slips_the_other_way() {
    // v = V (1 − t/τ). At rest at +µN/k the block sticks when the slider stops, goes back with it, and
    // slips where k x + m v̇ = −µN.
    let (mu, velocity, tau) = (0.04, 0.1, 1.0);
    let offset = mu * PRESSING / STIFFNESS;
    let inertia = velocity / tau / STIFFNESS;
    let slips = tau + (2.0 * tau * (2.0 * offset - inertia) / velocity).sqrt();
    for method in METHODS {
        for h in [1e-3, 1e-4] {
            let ramp = format!(
                "[[signal]]\ninput = \"slider.velocity\"\n\
                 ramp = {{ to = {:?}, end = {:?} }}",
                -2.0 * velocity,
                2.0 * tau
            );
            let mut run = Run::new(method.scene(&block(mu, velocity, h, &ramp)), method);
            let found = changes(&mut run, 2.0 * tau);
            let [(stuck, Stick), (slipped, ReverseSlide)] = found[..] else { panic!("{found:?}") };
            assert_near(stuck, tau, method.off(2.0 * h));
            let speed = velocity / tau * (slips - tau);
            // The slider's velocity is that of a step's beginning, its way up to ½ h V off.
            assert_near(slipped, slips, method.off(h * (2.0 + 0.5 * velocity / speed)));
            // From there on it swings about −µN/k.
            let phase = OMEGA * (2.0 * tau - slips);
            let [x, _] = run.of_dof("mass.block.x");
            let expected = -2.0 * offset + inertia * phase.cos() - speed / OMEGA * phase.sin();
            let fastest = speed.hypot(OMEGA * inertia);
            assert_near(x, expected, method.off(h * (4.0 * fastest + velocity)));
        }
    }
}

#[test]
fn a_block_does_not_move_by_a_bit_while_its_slider_stops_stands_and_starts_again() {
    let stop = "[[signal]]\ninput = \"slider.velocity\"\n\
        table = { points = [[0.2, 0.0], [0.3, -0.1], [1.0, -0.1], [1.1, 0.0]] }";
    for method in METHODS {
        let mut run = Run::new(method.scene(&block(0.4, 0.1, 1e-4, stop)), method);
        let found = changes(&mut run, 1.3);
        let [(stands, Stick), (goes, Slide)] = found[..] else { panic!("{found:?}") };
        assert_near(stands, 0.3, 2.0 * run.h());
        assert_near(goes, 1.0, 2.0 * run.h());
        assert!(run.now.iter().all(|values| values.iter().all(|&value| value == 0.0)));
    }
}

/// A block on an oblique spring that friction draws into the slider: K = [[400, 100], [100, 100]].
fn wedge(mu: f64, velocity: f64, more: &str) -> String {
    let springs = "[[spring]]\nname = \"oblique\"\nbetween = [\"block\", \"ground\"]\n\
        direction = 0.7853981633974483\nstiffness = 200.0\n[[spring]]\nname = \"along\"\n\
        between = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n";
    block(mu, velocity, 1e-3, &format!("{springs}{more}"))
}

#[test]
fn where_sliding_jams_a_block_is_refused_and_brought_up_from_rest_it_never_slides() {
    // Drawn along by x it carries T = 400 x and N = 10 + 100 x: T reaches µN only where µ < 4.
    let (along, across) = (400.0, 100.0);
    for method in METHODS {
        let error = Simulation::new(method.scene(&wedge(4.1, 0.1, "")), 0.0).err().unwrap();
        assert!(error.is_equilibrium(), "{error}");
        assert!(error.to_string().contains("contact.c jams from 4.000000 on"), "{error}");

        let up =
            "[[signal]]\ninput = \"slider.velocity\"\nramp = { from = -0.1, to = 0.0, end = 0.1 }";
        let mut run = Run::new(method.scene(&wedge(4.1, 0.1, up)), method);
        let h = run.h();
        assert_eq!(changes(&mut run, 9.0), []);
        let [x, _] = run.of_dof("mass.block.x");
        // The way of the slider, whose velocity is that of a step's beginning.
        assert_near(x, 0.1 * (9.0 - 0.05), method.off(0.5 * 0.1 * h) + 1e-12);
        let force = run.forces()[0];
        assert_near(force.normal_force, PRESSING + across * x, 1e-9);
        assert_near(force.friction_force, along * x, 1e-9);

        let mut run = Run::new(method.scene(&wedge(3.5, 0.1, up)), method);
        let found = changes(&mut run, 7.2);
        let [(slips, Slide), ..] = found[..] else { panic!("{found:?}") };
        let way = 3.5 * PRESSING / (along - 3.5 * across);
        assert_near(slips, way / 0.1 + 0.05, method.off(3.0 * h));
    }
}

#[test]
fn a_block_that_slides_at_99_hundredths_of_the_critical_step_stays_bounded_and_at_101_is_refused() {
    let far = 1e-3;
    for (alpha, beta) in [(0.0, 0.0), (1.5, 0.02)] {
        let ratio = 0.5 * (alpha / OMEGA + beta * OMEGA);
        let critical = 2.0 / OMEGA * (ratio.hypot(1.0) - ratio);
        let text = |part: f64| {
            let more = format!(
                "[damping]\nalpha = {alpha:?}\nbeta = {beta:?}\n{}",
                start(&format!("x = {far:?}"))
            );
            block(0.4, 1.0, part * critical, &more)
        };
        let Err(error) = Simulation::new(parse("above", &text(1.01)).unwrap(), 0.0) else {
            panic!("taken")
        };
        assert!(error.is_step_too_large(), "{error}");
        let mut run = Run::new(parse("below", &text(0.99)).unwrap(), Method::ForwardIncrement);
        let mut largest = 0.0_f64;
        for _ in 0..20_000 {
            run.step();
            run.judge_step();
            largest = largest.max(run.of_dof("mass.block.x")[0].abs());
        }
        if ratio == 0.0 {
            // The widest point of the ellipse, seven times as far.
            let widest = far / (1.0 - (0.5 * OMEGA * run.h()).powi(2)).sqrt();
            assert!(largest <= widest * (1.0 + 1e-9), "{largest} {widest}");
            assert!(largest > 0.99 * widest, "the bound proves nothing: {largest} {widest}");
        } else {
            // Its roots are inside the unit circle: it decays.
            assert!(largest < 10.0 * far && run.of_dof("mass.block.x")[0].abs() < 1e-9);
        }
        assert_eq!(run.simulation.statistics().state_changes, 0);
    }
}

#[test]
fn without_damping_the_scheme_keeps_its_own_energy_but_for_slip_and_impact() {
    // U − ½ h ẋ·∇U in place of U; what contact forces f add in a step is ½ h f·(ẋ + ẋ'). At rest the
    // slider does no work, so slip and impact only take.
    let text =
        pads(2, 0.0, 1e-5).replace("velocity = 0.2", "velocity = 0.0").replace("beta = 1e-5", "");
    let mut run = Run::new(parse("undamped", &text).unwrap(), Method::ForwardIncrement);
    let load = DVector::from_column_slice(&run.model.load);
    let energy = |run: &Run| {
        let gradient = &run.stiffness * run.total(&run.now[0]) - &load;
        run.energy() - load.dot(&run.total(&run.now[0])) - 0.5 * run.h() * run.now[1].dot(&gradient)
    };
    let first = energy(&run);
    let [mut last, mut old] = [(); 2].map(|()| (first, run.states()));
    let (mut quiet, mut slips, mut landed) = (0, 0, false);
    for _ in 0..40_000 {
        run.step();
        last = (energy(&run), run.states());
        let forces = run.judge_step().unwrap();
        let is_quiet = |state: &ContactState| matches!(state, Stick | Detached);
        // A landing takes two steps, of which the first leads to the slider.
        let lands = std::mem::replace(&mut landed, run.has_landed()) || landed;
        if last.1 == old.1 && last.1.iter().all(is_quiet) && !lands {
            quiet += 1;
            // Rounding of the elastic energy of the load.
            assert!((last.0 - old.0).abs() < 1e-14, "{} {}", last.0, old.0);
        } else {
            slips += 1;
            // In the step in which a slip turns round friction acts for a part of it along the old
            // velocity, which it stops within the step.
            let turned: f64 = forces
                .iter()
                .zip(&run.model.contacts)
                .map(|(force, contact)| {
                    let [old, new] =
                        [&run.before, &run.now].map(|m| contact.tangent.dot(m[1].as_slice()));
                    if old * new < 0.0 { 0.5 * run.h() * force[1].abs() * old.abs() } else { 0.0 }
                })
                .sum();
            assert!(last.0 <= old.0 + turned + 1e-14, "{} {} at {}", last.0, old.0, run.time());
        }
        old = last.clone();
    }
    assert!(quiet > 1000 && slips > 1000, "{quiet} {slips}");
    assert!(last.0 < first - 0.01, "{} {first}", last.0);
}

#[test]
fn masses_and_springs_a_million_times_apart_move_as_their_modes() {
    // A slow mass of 1 kg on 1 N/m drags a fast one by a stiff spring over a slider; both slide, so
    // friction is constant and the motion that of two modes.
    let pairs: [(f64, f64, f64); 4] =
        [(1.0, 1e6, 1e-4), (1e-3, 1e3, 2e-4), (1e-6, 1e-3, 1e-3), (1e-6, 1.0, 1e-4)];
    for (mass, stiffness, h) in pairs {
        let text = format!(
            "[slider]\nvelocity = 100.0\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
             [integrator]\nstep = {h:?}\n\
             [[mass]]\nname = \"slow\"\nmass = 1.0\nforce = [0.0, -1.0]\n\
             [[mass]]\nname = \"fast\"\nmass = {mass:?}\nforce = [0.0, {:?}]\n\
             [[spring]]\nname = \"soft\"\nbetween = [\"slow\", \"ground\"]\ndirection = \"x\"\n\
             stiffness = 1.0\n[[spring]]\nname = \"stiff\"\nbetween = [\"slow\", \"fast\"]\n\
             direction = \"x\"\nstiffness = {stiffness:?}\n\
             [[contact]]\nname = \"a\"\nmass = \"slow\"\n[[contact]]\nname = \"b\"\nmass = \"fast\"\n\
             [[initial]]\nmass = \"slow\"\nx = 0.1\n[[initial]]\nmass = \"fast\"\nx = 0.1\n",
            -mass
        );
        for method in METHODS {
            let mut run = Run::new(method.scene(&text), method);
            // M^-½ K M^-½ = Q Ω² Qᵀ.
            let root = [1.0, mass.sqrt()];
            let k = [[1.0 + stiffness, -stiffness], [-stiffness, stiffness]];
            let scaled = DMatrix::from_fn(2, 2, |i, j| k[i][j] / (root[i] * root[j]));
            let modes = SymmetricEigen::new(scaled);
            let fastest = modes.eigenvalues.amax().sqrt();
            if method == Method::ForwardIncrement {
                let critical = critical_step(&run.model, 0.5).unwrap().step;
                assert_near(critical * fastest, 2.0, 1e-6);
            }
            run.judged_until(1000.0 * h);
            run.jump((2.0 / h) as u64 - run.steps);
            run.judged_until(run.time() + 1000.0 * h);
            let time = run.time();
            let start = DVector::from_fn(2, |i, _| 0.1 * root[i]);
            let amplitudes = modes.eigenvectors.transpose() * start;
            let (mut slow, mut off) = (0.0, 0.0);
            for (i, amplitude) in amplitudes.iter().enumerate() {
                let omega = modes.eigenvalues[i].max(0.0).sqrt();
                let part: f64 = modes.eigenvectors[(0, i)] * amplitude;
                slow += part * (omega * time).cos();
                // Half a step of phase, and the frequency of the scheme, (ωh)²/24 too high.
                let phase = omega * h + (omega * h).powi(2) / 12.0 * omega * time;
                off += part.abs() * phase.min(2.0);
            }
            // What rounding of λ leaves of a mode whose frequency is a thousandth of the largest.
            let [x, _] = run.of_dof("mass.slow.x");
            assert_near(x, slow, method.off(off) + 1e-9);
            assert_eq!(run.simulation.statistics().state_changes, 0);
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
            let drive = Drive::uniform(model.load.clone(), contacts, 0.1, 0.4);
            let mut integrator = method.integrator(model);
            let mut motion = Motion {
                displacement: vec![-0.05, 1e-3],
                velocity: vec![0.0, 0.3],
                contacts: vec![Detached; contacts],
                statistics: Statistics::default(),
            };
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

/// Values over some orders of magnitude, each order as often.
fn wide(from: f64, to: f64) -> impl Strategy<Value = f64> + Clone {
    (from.ln()..to.ln()).prop_map(f64::exp)
}

/// 0, or a value of either sign.
fn signed(from: f64, to: f64) -> impl Strategy<Value = f64> + Clone {
    (-3_i32..=3, wide(from, to)).prop_map(|(sign, value)| f64::from(sign.signum()) * value)
}

fn any_module() -> impl Strategy<Value = Module> {
    (
        prop::array::uniform2(wide(1e-2, 10.0)),
        prop::array::uniform6(wide(1e3, 1e7)),
        wide(1e-4, 1e-2),
        prop::array::uniform4(signed(1e-4, 3.0)),
        wide(1e-6, 1e-3),
        any::<bool>(),
    )
        .prop_map(|(mass, stiffness, preload, velocity, gap, open)| Module {
            mass,
            stiffness,
            preload,
            force: [0.0; 4],
            displacement: [0.0, 0.0, 0.0, if open { gap } else { 0.0 }],
            velocity,
        })
}

/// Runs a scene from rest under a slider that starts at once, which needs no equilibrium in sliding,
/// and judges every step.
fn judged_from_rest(scene: &Scene, part: f64) -> Result<(), TestCaseError> {
    let mut scene = scene.clone();
    let model = LumpedModel::from(&scene);
    let Ok(critical) = critical_step(&model, scene.friction_coefficient) else {
        return Err(TestCaseError::reject("no critical step"));
    };
    scene.step = part * critical.step;
    let pulse = Pulse { value: -scene.slider.velocity, start: 0.0, end: Some(1.5 * scene.step) };
    let input = "slider.velocity".to_owned();
    scene.signals = Arc::new([Signal { input, shape: Shape::Pulse(pulse) }]);
    let Ok(simulation) = Simulation::new(scene, 0.0) else {
        return Err(TestCaseError::reject("it does not lie on the slider"));
    };
    let mut run = Run::of(simulation, Method::ForwardIncrement);
    for _ in 0..200 {
        run.step();
        run.judge_step();
        run.judge_report();
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 4000,
        max_global_rejects: 1_000_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_ring_obeys_the_law_at_any_friction(
        modules in prop::collection::vec(any_module(), 1..=2),
        mu in 0.0..10.0,
        velocity in signed(1e-4, 3.0),
        angle in -1.4..1.4,
        (alpha, beta) in (0.0..50.0, signed(1e-7, 1e-3)),
        part in wide(1e-3, 0.95),
    ) {
        let mut scene = builtin("set1").unwrap().scene();
        *scene.modules_mut() = modules;
        scene.friction_coefficient = mu;
        (scene.slider.velocity, scene.slider.angle) = (velocity, angle);
        (scene.damping.alpha, scene.damping.beta) = (alpha, f64::max(beta, 0.0));
        judged_from_rest(&scene, part)?;
    }

}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        max_global_rejects: 20,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    // Up to a hundred times heavier than the disc that they share: see below for more.
    #[test]
    fn any_pads_on_a_disc_obey_the_law_at_any_friction(
        mass in prop::array::uniform3(wide(0.1, 10.0)),
        stiffness in prop::array::uniform6(wide(1e3, 1e7)),
        load in prop::array::uniform2(wide(1.0, 1e3)),
        start in prop::array::uniform4(signed(1e-4, 3.0)),
        oblique in -1.5..1.5,
        mu in 0.0..10.0,
        velocity in signed(1e-4, 3.0),
        part in wide(1e-3, 0.95),
    ) {
        let mut scene = builtin("disc_brake").unwrap().scene();
        let Structure::Network(network) = &mut scene.structure else { unreachable!() };
        for (i, spring) in network.springs.iter_mut().enumerate() {
            spring.stiffness = stiffness[i % 6];
            if spring.name.ends_with("strut") {
                spring.direction = oblique;
            }
        }
        for (i, part) in network.masses.iter_mut().enumerate() {
            part.mass = mass[i];
            if part.name != "disc" {
                part.load[1] = load[i].copysign(part.load[1]);
                part.velocity = [start[2 * i], start[2 * i + 1]];
            }
        }
        network.contacts.iter_mut().for_each(|contact| contact.velocity = None);
        scene.friction_coefficient = mu;
        scene.slider.velocity = velocity;
        judged_from_rest(&scene, part)?;
    }
}

#[test]
fn pads_on_a_disc_ten_thousand_times_lighter_are_solved_or_it_is_said_that_they_are_not() {
    // Gauss–Seidel leaves (1 + m/M)⁻² of an error in a sweep, for pads m on a disc M: 1e-13 is reached
    // after 15 m/M sweeps, of which there may be 10,000.
    let run = |mass: f64| {
        let scene = with(builtin("disc_brake").unwrap().scene(), &[("mass.disc.mass", mass)]);
        let step = 0.1 * critical_step(&LumpedModel::from(&scene), 0.6).unwrap().step;
        let mut simulation = Simulation::new(Scene { step, ..scene }, 0.0).unwrap();
        simulation.advance_to(100.0 * step).map(|()| simulation.statistics().most_sweeps)
    };
    let sweeps = run(0.3e-2).unwrap();
    assert!((500..1700).contains(&sweeps), "{sweeps}");
    let error = run(0.3e-4).unwrap_err();
    assert!(error.is_step() && error.to_string().contains("did not converge in 10000 sweeps"));
}

/// Where the energy of a run went, J. Quadratures are of what is reported at both ends of a step, and
/// impacts follow their law from the velocities before them: nothing here is what the masses got.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    slider: f64,
    damping: f64,
    friction: f64,
    impact: f64,
}

/// The largest amount of energy, J, that a run up to `end` (s) has won or lost unaccounted for, and the
/// energy turned over.
fn imbalance(run: &mut Run, end: f64) -> (f64, Work, bool) {
    let load = DVector::from_column_slice(&run.model.load);
    let stored = |run: &Run| run.energy() - load.dot(&run.total(&run.now[0]));
    let contacts = run.model.contacts.clone();
    let first = stored(run);
    let mut work = Work::default();
    let (mut worst, mut all_open) = (0.0_f64, false);
    let mut old = (run.forces(), run.damping_power());
    while run.time() < end - 0.5 * run.h() {
        run.step();
        run.judge_step();
        let new = (run.forces(), run.damping_power());
        let h = run.h();
        let v = run.acting(run.time()).slider_velocity;
        let mu = run.acting(run.time()).friction;
        work.damping += 0.5 * h * (old.1 + new.1);
        for (i, contact) in contacts.iter().enumerate() {
            let (a, b) = (old.0[i], new.0[i]);
            let gap = |x: &DVector<f64>| contact.normal.dot(x.as_slice());
            if gap(&run.before[0]) > 0.0 && gap(&run.now[0]) <= 0.0 {
                let mass = run
                    .model
                    .mass
                    .get(contact.normal.as_unit().unwrap(), contact.normal.as_unit().unwrap());
                // Perfectly inelastic, with friction as long as it lasts.
                let approach = contact.normal.dot(run.before[1].as_slice()).abs();
                let slip = v[i] - contact.tangent.dot(run.before[1].as_slice());
                let limit = mu[i].kinetic * mass * approach;
                let impulse = (mass * slip).clamp(-limit, limit);
                work.impact += 0.5 * mass * approach * approach;
                work.friction += impulse * slip - 0.5 * impulse * impulse / mass;
                work.slider += impulse * v[i];
            } else {
                let power = |force: f64, velocity: f64| force * velocity;
                work.slider += 0.5 * h * v[i] * (a.friction_force + b.friction_force);
                work.friction += 0.5
                    * h
                    * (power(a.friction_force, a.slip_velocity)
                        + power(b.friction_force, b.slip_velocity));
            }
        }
        all_open |= new.0.iter().all(|force| force.state == Detached);
        old = new;
        let missing =
            stored(run) - first - work.slider + work.damping + work.friction + work.impact;
        // A landing takes two steps, of which the first leads to the slider.
        if !run.has_landed() {
            worst = worst.max(missing.abs());
        }
    }
    (worst, work, all_open)
}

#[test]
fn the_work_balance_closes_when_all_contacts_are_thrown_off_and_land_again() {
    let end = 0.05;
    let set1 = || builtin("set1").unwrap().scene();
    let thrown = |velocities: &[[f64; 4]]| {
        let mut scene = set1();
        let module = scene.modules()[0];
        *scene.modules_mut() =
            velocities.iter().map(|&velocity| Module { velocity, ..module }).collect();
        scene
    };
    let together = thrown(&[[0.5, 0.2, 0.4, 1.5]; 3]);
    let apart = thrown(&[[0.5, 0.2, -0.4, 1.5], [-0.3, 0.0, 1.4, 0.7], [0.0, -0.8, 0.2, 2.0]]);
    let mut frictionless = apart.clone();
    frictionless.friction_coefficient = 0.0;
    let mut backwards = apart.clone();
    (backwards.slider.velocity, backwards.friction_coefficient) = (-0.6, 0.7);
    // Through the integrator for any structure.
    let network = parse("pads", &pads(3, 2.0, 1e-5)).unwrap();
    for scene in [together, apart, frictionless, backwards, network] {
        for method in METHODS {
            for h in [1e-5, 1e-6] {
                let scene = Scene { step: h, ..scene.clone() };
                let limit = critical_step(&LumpedModel::from(&scene), 0.0).unwrap().step;
                let mut run = Run::new(scene, method);
                let given = 0.5
                    * run.now[1]
                        .iter()
                        .enumerate()
                        .map(|(i, v)| run.model.mass.get(i, i) * v * v)
                        .sum::<f64>();
                let (worst, work, all_open) = imbalance(&mut run, end);
                let statistics = run.simulation.statistics();
                assert!(all_open && statistics.touch_downs >= 3, "{statistics:?}");
                assert!(
                    work.friction >= 0.0 && work.impact > 0.0 && work.damping > 0.0,
                    "{work:?}"
                );
                // Of all energy E the scheme's own differs by up to ½ ωh E, with ωh = 2 h/h_c of its
                // fastest mode; each quadrature and each event adds up to as much of what it counts.
                let turned = given + work.slider.abs() + work.friction + work.damping;
                let allowed = method.off(2.0 * h / limit * turned);
                assert!(worst <= allowed, "{worst} J of {work:?}, allowed {allowed} J");
            }
        }
    }
}
