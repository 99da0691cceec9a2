//! Runs of 10⁴ seconds and of 10⁷ steps: no creep, no drift, no slow growth.
//!
//! Only where they are asked for: `cargo test --release -- --ignored`.

use crate::judge::{METHODS, Run, assert_near, off, scene, with};
use amontons::contact::ContactState::{Slide, Stick};
use amontons::scene::builtin;

/// A block of 1 kg on a spring of 100 N/m, pressed with 10 N: µN/k = 40 mm.
fn block(velocity: f64, step: f64, more: &str) -> String {
    format!(
        "[slider]\nvelocity = {velocity:?}\nangle = 0.0\n[friction]\ncoefficient = 0.4\n\
         [damping]\nalpha = 1.0\n[integrator]\nstep = {step:?}\n[[mass]]\nname = \"block\"\n\
         mass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\nname = \"hold\"\n\
         between = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 100.0\n\
         [[contact]]\nname = \"c\"\nmass = \"block\"\n{more}"
    )
}

#[test]
#[ignore = "long"]
fn a_block_that_is_shaken_inside_its_friction_cone_does_not_creep_in_ten_thousand_seconds() {
    // The spring takes three quarters of µN, the shaking up to nine tenths of the rest.
    let more = "[[initial]]\nmass = \"block\"\nx = 0.03\n[[signal]]\ninput = \"mass.block.fx\"\n\
        sine = { amplitude = 0.9, frequency = 3.7 }";
    for method in METHODS {
        let mut run = Run::new(scene(&block(0.0, 1e-3, more)), method);
        let start = run.now.clone();
        while run.time() < 1e4 {
            run.jump(99_991);
            run.judge_step();
            run.judge_report();
            assert_eq!(run.now, start, "at {} s", run.time());
        }
        assert_eq!(run.states(), [Stick]);
        assert_eq!(run.simulation.statistics().state_changes(), 0);
    }
}

#[test]
#[ignore = "long"]
fn a_stuck_module_that_is_pulled_stays_where_it_is_for_ten_thousand_seconds() {
    let values = [
        ("slider.velocity", 0.0),
        ("integrator.step", 2e-4),
        ("friction.coefficient", 0.5),
        ("module[1].f1", 20.0),
        ("damping.beta", 1e-4),
    ];
    for method in METHODS {
        let mut run = Run::new(with(builtin("set1").unwrap().scene(), &values), method);
        run.jump(5_000_000);
        let settled = run.now[0].clone();
        assert!(settled[0] > 1e-5, "nothing pulls");
        while run.time() < 1e4 {
            run.jump(1_000_000);
            run.judge_step();
            run.judge_report();
            for contact in [2, 3, 6, 7] {
                assert_eq!((run.now[0][contact], run.now[1][contact]), (0.0, 0.0));
            }
            // The last bits of what is not in contact may go round.
            assert!((&run.now[0] - &settled).amax() <= 1e-14 * settled.amax());
        }
        assert_eq!(run.states(), [Stick, Stick]);
    }
}

#[test]
#[ignore = "long"]
fn a_block_that_slides_stays_where_it_has_settled_for_ten_thousand_seconds() {
    let more = "[[signal]]\ninput = \"mass.block.fx\"\nconstant = { value = 1.0 }";
    for method in METHODS {
        let mut run = Run::new(scene(&block(0.1, 1e-3, more)), method);
        // From rest it swings 10 mm to either side, up to the belt's velocity; α = 1/s.
        run.jump(100_000);
        while run.time() < 1e4 {
            run.jump(100_000);
            run.judge_step();
            run.judge_report();
            // 1 N on 100 N/m; a bit of the force is what friction and load leave.
            assert_near(run.of_dof("mass.block.x")[0], 0.01, 1e-16);
        }
        assert_eq!(run.states(), [Slide]);
    }
}

#[test]
#[ignore = "long"]
fn modules_that_slide_stay_where_they_have_settled_for_ten_thousand_seconds() {
    let values = [
        ("integrator.step", 2e-4),
        ("friction.coefficient", 0.5),
        ("damping.beta", 1e-4),
        ("module[1].f1", 2.0),
        ("initial.module[1].v1", 0.0),
    ];
    for method in METHODS {
        let mut run = Run::new(with(builtin("set1").unwrap().scene(), &values), method);
        run.jump(5_000_000);
        let settled = run.now[0].clone();
        while run.time() < 1e4 {
            run.jump(1_000_000);
            run.judge_step();
            run.judge_report();
            assert!((&run.now[0] - &settled).amax() <= 1e-14 * settled.amax());
        }
        assert_eq!(run.states(), [Slide, Slide]);
    }
}

/// Looks at every `stride`th step of ten million; the largest value of a degree of freedom in each
/// tenth.
fn tenths(run: &mut Run, dof: &str, stride: u64) -> Vec<f64> {
    let mut largest = vec![0.0_f64; 10];
    for (part, largest) in largest.iter_mut().enumerate() {
        while run.steps < 1_000_000 * (part as u64 + 1) {
            run.jump(stride);
            run.judge_step();
            run.judge_report();
            *largest = largest.max(run.of_dof(dof)[0].abs());
        }
    }
    largest
}

#[test]
#[ignore = "long"]
fn a_squealing_brake_keeps_its_cycle_and_the_law_over_ten_million_steps() {
    for method in METHODS {
        let mut run = Run::new(builtin("disc_brake").unwrap().scene(), method);
        let largest = tenths(&mut run, "mass.disc.y", 97);
        // In the first tenth it has grown to its size.
        for later in &largest[1..] {
            assert_near(*later, largest[0], 0.02 * largest[0]);
        }
    }
}

#[test]
#[ignore = "long"]
fn the_papers_set_1_squeals_within_its_size_and_the_law_over_ten_million_steps() {
    for method in METHODS {
        let mut run = Run::new(builtin("set1").unwrap().scene(), method);
        let largest = tenths(&mut run, "module[1].x1", 997);
        // Two frequencies that beat, from the fifth second on.
        for later in &largest[5..] {
            assert_near(*later, largest[5], 0.05 * largest[5]);
        }
        assert!(run.simulation.statistics().touch_downs > 100);
    }
}

#[test]
#[ignore = "long"]
fn a_block_on_a_belt_swings_no_further_after_ten_million_steps() {
    for method in METHODS {
        let mut run = Run::new(builtin("belt").unwrap().scene(), method);
        let h = run.h();
        let largest = tenths(&mut run, "mass.block.x", 97);
        // V/ω = 10 mm; ωh of it is where it slips and how the scheme's ellipse swings.
        for later in &largest[1..] {
            assert_near(*later, 0.01, off(method, 10.0 * h * 0.01, 1e-10));
            assert_near(*later, largest[1], 1e-6 * 0.01);
        }
    }
}
