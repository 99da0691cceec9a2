//! No misuse of the C functions crashes the FMU, and every call has the status that the standard gives it.
//!
//! Random sequences of all functions, with arguments that are good or wrong in every way that C allows, are held to an
//! oracle of the standard (`standard`): each status, what the logger is told, whether there is an instance, what was
//! set is read back. Each call is made on two instances, which must agree to the bit. What cannot be tried is a
//! handle that is none, or an array that is shorter than said: C gives no means to see that.
//!
//! It is a program of its own: its allocator counts what the whole process holds.
#![allow(unsafe_code)] // The FMU's functions are C's.

mod draw;
mod library;
mod memory;
mod scenes;
mod standard;
mod world;

use draw::{CALLS, Op, any_op, every_cell, pairs};
use library::Fmi;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestError, TestRunner};
use standard::{PHASES, Standard};
use std::cell::RefCell;
use std::ptr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicPtr, Ordering};
use world::{Tally, World};

#[global_allocator]
static ALLOCATOR: memory::Counting = memory::Counting;

/// One after the other: they share the heap.
static ALONE: Mutex<()> = Mutex::new(());

/// By how many bytes the library's part of the heap may grow over a run of any length. The smallest thing that it
/// could lose, an instance, a saved state or their lists, it would lose thousands of times.
const GROWTH: isize = 32 << 10;

/// The sequence that is being made, for [`crashed`].
static PRESENT: AtomicPtr<Vec<Op>> = AtomicPtr::new(ptr::null_mut());

/// Says what a crash came of: nothing else would.
extern "C" fn crashed(signal: i32) {
    // SAFETY: the process ends here. The sequence stays as it is while it is made.
    unsafe {
        libc::signal(signal, libc::SIG_DFL);
        let ops = PRESENT.load(Ordering::Relaxed).as_ref();
        // Not by way of what the test's output is caught with.
        let text = format!("signal {signal} in {ops:#?}\n");
        libc::write(2, text.as_ptr().cast(), text.len());
        libc::raise(signal);
    }
}

struct Bench {
    fmi: Fmi,
    standard: Standard,
    scenes: Vec<scenes::Scene>,
    tally: RefCell<Tally>,
}

impl Bench {
    fn new() -> Self {
        for signal in [libc::SIGSEGV, libc::SIGBUS, libc::SIGABRT, libc::SIGILL, libc::SIGFPE] {
            // SAFETY: the handler is one that ends the process.
            unsafe { libc::signal(signal, crashed as *const () as usize) };
        }
        Self {
            fmi: Fmi::load(env!("AMONTONS_FMU_LIBRARY")),
            standard: Standard::read(),
            scenes: scenes::all(),
            tally: RefCell::default(),
        }
    }

    fn run(&self, scene: usize, ops: &mut Vec<Op>, is_traced: bool) -> Result<(), String> {
        PRESENT.store(ops, Ordering::Relaxed);
        let mut tally = self.tally.borrow_mut();
        let mut world = World::new(&self.fmi, &self.standard, &self.scenes, scene, &mut tally);
        world.is_traced = is_traced;
        let result = world.run(ops);
        PRESENT.store(ptr::null_mut(), Ordering::Relaxed);
        result
    }

    fn calls(&self) -> u64 {
        self.tally.borrow().calls
    }

    /// Sequences at random until so many calls are made.
    fn random_sequences(&self, calls: u64) {
        let sequences = (any_scene(), prop::collection::vec(any_op(), 1..100));
        let first = seed();
        while self.calls() < calls {
            // One that has run its cases runs no others.
            let mut runner = TestRunner::new(Config {
                cases: 64,
                failure_persistence: None,
                rng_seed: RngSeed::Fixed(first.wrapping_add(self.calls())),
                ..Config::default()
            });
            let result = runner.run(&sequences, |(scene, mut ops)| {
                self.run(scene, &mut ops, false).map_err(TestCaseError::fail)
            });
            if let Err(TestError::Fail(reason, (scene, mut ops))) = result {
                let _ = self.run(scene, &mut ops, true);
                panic!("scene {scene}: {reason}\nshortest sequence: {ops:#?}");
            }
            result.expect("no case is given up");
        }
    }

    /// Was each function given each kind of argument in each phase, strict and not?
    fn assert_all_met(&self) {
        let tally = self.tally.borrow();
        for (function, kind) in pairs() {
            for phase in PHASES {
                for strict in [false, true] {
                    let cell = (function, kind, phase, strict);
                    assert!(tally.met.contains(&cell), "{cell:?} was never met");
                }
            }
        }
    }
}

fn any_scene() -> impl Strategy<Value = usize> {
    let weighted =
        scenes::WEIGHTS.into_iter().zip(0..).map(|(weight, scene)| (weight, Just(scene)));
    prop::strategy::Union::new_weighted(weighted.collect())
}

/// The seed of the first sequences (`.cargo/config.toml`, or the environment).
fn seed() -> u64 {
    match Config::default().rng_seed {
        RngSeed::Fixed(seed) => {
            println!("PROPTEST_RNG_SEED={seed}");
            seed
        }
        RngSeed::Random => panic!("PROPTEST_RNG_SEED is set by cargo; it is not here"),
    }
}

#[test]
fn the_oracle_knows_every_function_that_there_is() {
    let standard = Standard::read();
    let drawn: Vec<&str> = CALLS.iter().map(|(function, _)| *function).collect();
    assert_eq!(drawn.len(), 34);
    for name in library::NAMES {
        assert!(drawn.contains(name), "{name} is not drawn");
        // Those without an instance, and the one without a status, have no row.
        let has_row = standard.rows().any(|row| row == *name);
        let has_none = ["Platform", "Version", "Instantiate", "FreeInstance"];
        assert_eq!(has_row, !has_none.iter().any(|end| name.ends_with(end)), "{name}");
    }
}

#[test]
fn every_call_in_every_phase_has_the_status_that_the_standard_gives_it() {
    let _alone = ALONE.lock();
    let bench = Bench::new();
    for scene in 0..bench.scenes.len() {
        let ops = every_cell();
        for part in ops.chunks(40) {
            if let Err(wrong) = bench.run(scene, &mut part.to_vec(), false) {
                panic!("scene {scene}: {wrong}\nin {part:#?}");
            }
        }
        if scene == 0 {
            bench.assert_all_met();
        }
    }
    bench.tally.borrow().print();
    println!("{} combinations of function, kind of argument, phase and strict", every_cell().len());
}

#[test]
fn random_calls_are_answered_as_the_standard_has_it_and_nothing_leaks() {
    let _alone = ALONE.lock();
    random_calls(20_000);
}

#[test]
#[ignore = "long"]
fn a_million_random_calls_are_answered_as_the_standard_has_it_and_nothing_leaks() {
    let _alone = ALONE.lock();
    random_calls(1_000_000).assert_all_met();
}

fn random_calls(calls: u64) -> Bench {
    let bench = Bench::new();
    // Memory that the library and the C library allocate once is allocated by the first calls.
    bench.random_sequences(calls / 10);
    let before = memory::foreign_bytes();
    bench.random_sequences(calls);
    let growth = memory::foreign_bytes() - before;
    bench.tally.borrow().print();
    println!("bytes of the heap that came and stayed: {growth}");
    assert!(growth < GROWTH, "{growth} bytes more are in use");
    bench
}
