//! Hard cases of dry friction: stick, slip, turn round, stand, jam; against closed forms, with the law of
//! contact judged after every step.
//!
//! Each runs with every integrator. An integrator of first order may be off by a multiple of its step
//! h that is derived beside the case; with ω the frequency, the paper's scheme moves along
//! x² + ẋ²/ω² − h x ẋ = A², so amplitudes are off in second order, by the part (ωh)²/8, and velocities
//! belong to times half a step earlier. The event-driven integrator may be off by rounding.

use crate::judge::blocks::{OMEGA, PRESSING, STIFFNESS, block, changes, start, wedge};
use crate::judge::{METHODS, Run, assert_near, off, scene};
use amontons::contact::ContactState::{ReverseSlide, Slide, Stick};
use amontons::scene::{Method, Scene};
use amontons::simulation::Simulation;
use std::f64::consts::{PI, TAU};

#[test]
fn with_one_coefficient_of_friction_no_oscillation_on_a_belt_grows() {
    for method in METHODS {
        // Exact motion has no need of small steps.
        let h = off(method, 2.5e-4, 2.5e-3);
        // On a belt as slow as 1e-9 m/s the bits of µN decide at which sign of a slip of 1e-18 m/s exact
        // motion stands.
        for velocity in [0.1, -0.1, off(method, 1e-9, 1e-4)] {
            let reach = f64::abs(velocity) / OMEGA;
            for part in [0.3, 0.99, 1.5, 6.0] {
                let from = -part * velocity / OMEGA;
                let text = block(0.4, velocity, h, &start(&format!("x = {from:?}")));
                let mut run = Run::new(scene(&text), method);
                let amplitude = |run: &Run| {
                    let [x, v] = run.of_dof("mass.block.x");
                    x.hypot(v / OMEGA)
                };
                // While the block slips, h x ẋ of the ellipse is at most ωh/2 of its square. The difference of spring
                // force and friction is some bits of µN.
                let bits = 4.0 * f64::EPSILON * 0.4 * PRESSING / STIFFNESS;
                let swing = off(method, 0.25 * OMEGA * h, 1e-12 + bits / reach);
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
            let mut run = Run::new(scene(&text), method);
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
                    let turn = run.changes.first().map(|change| (change.time, change.after[0][0]));
                    turns.push(turn.unwrap_or((run.time(), last)));
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
                let tolerance = off(method, n * 2.0 * (OMEGA * h).powi(2) * from, 1e-14);
                assert_near(x, expected, tolerance);
                if !time.is_nan() {
                    assert_near(time, n * PI / OMEGA, off(method, (1.0 + n) * h, 1e-11));
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
fn a_swing_that_just_reaches_the_belts_velocity_sticks_and_one_that_just_does_not_slips_on() {
    let (velocity, h) = (0.1, 1e-4);
    for method in METHODS {
        for (part, sticks) in [(1.0 + 1e-6, true), (1.0 - 1e-6, false)] {
            let from = -part * velocity / OMEGA;
            let text = block(0.4, velocity, h, &start(&format!("x = {from:?}")));
            let mut run = Run::new(scene(&text), method);
            let found = changes(&mut run, TAU / OMEGA);
            assert_eq!(found.iter().any(|change| change.1 == Stick), sticks, "{found:?}");
            if let [(caught, _), (free, _)] = found[..] {
                // It is as fast as the belt from ωt = asin(1/part) on, which carries it to x = 0.
                let early = f64::acos(1.0 / part);
                let carried = early.tan();
                let middle = 0.5 * PI / OMEGA;
                // The ellipse shifts the first by √(2 (ωh)²/4) / ω at most, the grid both.
                assert_near(caught, middle - early / OMEGA, off(method, 2.0 * h, 1e-11));
                assert_near(free, middle + (carried - early) / OMEGA, off(method, 4.0 * h, 1e-11));
            } else {
                assert!(found.is_empty(), "{found:?}");
            }
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
            let mut run = Run::new(scene(&block(mu, velocity, h, &ramp)), method);
            let found = changes(&mut run, 2.0 * tau);
            let [(stuck, Stick), (slipped, ReverseSlide)] = found[..] else { panic!("{found:?}") };
            assert_near(stuck, tau, off(method, 2.0 * h, 1e-11));
            let speed = velocity / tau * (slips - tau);
            // The slider's velocity is that of a step's beginning, its way up to ½ h V off.
            assert_near(slipped, slips, off(method, h * (2.0 + 0.5 * velocity / speed), 1e-12));
            // From there on it swings about −µN/k.
            let phase = OMEGA * (2.0 * tau - slips);
            let [x, _] = run.of_dof("mass.block.x");
            let expected = -2.0 * offset + inertia * phase.cos() - speed / OMEGA * phase.sin();
            let fastest = speed.hypot(OMEGA * inertia);
            assert_near(x, expected, off(method, h * (4.0 * fastest + velocity), 1e-13));
        }
    }
}

#[test]
fn a_block_does_not_move_by_a_bit_while_its_slider_stops_stands_and_starts_again() {
    let stop = "[[signal]]\ninput = \"slider.velocity\"\n\
        table = { points = [[0.2, 0.0], [0.3, -0.1], [1.0, -0.1], [1.1, 0.0]] }";
    for method in METHODS {
        let mut run = Run::new(scene(&block(0.4, 0.1, 1e-4, stop)), method);
        let found = changes(&mut run, 1.3);
        let [(stands, Stick), (goes, Slide)] = found[..] else { panic!("{found:?}") };
        assert_near(stands, 0.3, 2.0 * run.h());
        assert_near(goes, 1.0, 2.0 * run.h());
        assert!(run.now.iter().all(|values| values.iter().all(|&value| value == 0.0)));
    }
}

#[test]
fn where_sliding_jams_a_block_is_refused_and_brought_up_from_rest_it_never_slides() {
    // Drawn along by x it carries T = 400 x and N = 10 + 100 x: T reaches µN only where µ < 4.
    let (along, across) = (400.0, 100.0);
    for method in METHODS {
        let error =
            Simulation::new(Scene { method, ..scene(&wedge(4.1, 0.1, "")) }, 0.0).err().unwrap();
        assert!(error.is_equilibrium(), "{error}");
        assert!(error.to_string().contains("contact.c jams from 4.000000 on"), "{error}");

        let up =
            "[[signal]]\ninput = \"slider.velocity\"\nramp = { from = -0.1, to = 0.0, end = 0.1 }";
        let mut run = Run::new(scene(&wedge(4.1, 0.1, up)), method);
        let h = run.h();
        assert_eq!(changes(&mut run, 9.0), []);
        let [x, _] = run.of_dof("mass.block.x");
        // The way of the slider, whose velocity is that of a step's beginning.
        assert_near(x, 0.1 * (9.0 - 0.05), off(method, 0.5 * 0.1 * h, 0.0) + 1e-12);
        let force = run.forces()[0];
        assert_near(force.normal_force, PRESSING + across * x, 1e-9);
        assert_near(force.friction_force, along * x, 1e-9);

        let mut run = Run::new(scene(&wedge(3.5, 0.1, up)), method);
        let found = changes(&mut run, 7.2);
        let [(slips, Slide), ..] = found[..] else { panic!("{found:?}") };
        let way = 3.5 * PRESSING / (along - 3.5 * across);
        assert_near(slips, way / 0.1 + 0.05, off(method, 3.0 * h, 2e-6 * h));
    }
}

#[test]
fn on_a_belt_that_hardly_moves_a_block_does_not_change_between_stick_and_slip_without_an_end() {
    // Friction once counted a velocity as zero that was not zero for the slip that it causes.
    let (velocity, h) = (1e-9, 2.5e-3);
    for part in [1.5, 6.0] {
        let text = block(0.4, velocity, h, &start(&format!("x = {:?}", -part * velocity / OMEGA)));
        let mut run = Run::new(scene(&text), Method::EventDriven);
        run.jump(10_000);
        let [x, v] = run.of_dof("mass.block.x");
        assert_near(x.hypot(v / OMEGA), velocity / OMEGA, 0.1 * velocity / OMEGA);
    }
}
