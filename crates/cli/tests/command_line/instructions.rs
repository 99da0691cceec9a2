//! Tests that effects that are off cost no instruction.

use crate::callgrind::{instructions_per_step, task};
use crate::oscillator;
use std::hint::black_box;

#[test]
#[cfg_attr(not(has_valgrind), ignore = "valgrind is not installed (Debian: apt install valgrind)")]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: cargo test --release")]
fn with_all_effects_off_a_step_has_the_instructions_of_a_plain_oscillator() {
    // The name by which the restarted program knows the test.
    const NAME: &str =
        "instructions::with_all_effects_off_a_step_has_the_instructions_of_a_plain_oscillator";
    const STEPS: u64 = 1_000_000;
    match task() {
        Some((name, steps)) if name == "scene" => {
            black_box(oscillator::simulated(oscillator::SCENE, steps));
        }
        Some((_, steps)) => {
            black_box(oscillator::by_hand(steps));
        }
        None => {
            // It is the same scheme, to the last bit.
            assert_eq!(oscillator::simulated(oscillator::SCENE, 999), oscillator::by_hand(999));
            let arguments = ["--exact", NAME, "--test-threads=1"];
            let [scene, plain] =
                ["scene", "by hand"].map(|name| instructions_per_step(name, STEPS, &arguments));
            println!("{scene} instructions a step, {plain} by hand");
            assert!((scene / plain - 1.0).abs() <= 0.05, "{scene} instead of {plain}");
        }
    }
}
