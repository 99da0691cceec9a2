//! A step, a read and a write allocate nothing.
#![allow(unsafe_code)]

use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::{Simulation, variables};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on unchanged to the system's allocator; the counter is a plain cell.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's contract is the one of this function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract is the one of this function.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A network that rubs on the slider, with what a ring has not.
const NETWORK: &str = r#"
[slider]
velocity = 0.1
angle = 0.0
[friction]
coefficient = 0.5
[integrator]
step = 1e-6
[[mass]]
name = "pad"
mass = 0.3
force = [0.0, -20.0]
[[spring]]
name = "x"
between = ["pad", "ground"]
direction = 0.2
stiffness = 1e5
preload = 1e-5
[[damper]]
name = "d"
between = ["pad", "ground"]
direction = "x"
damping = 3.0
[[contact]]
name = "c"
mass = "pad"
angle = 0.1
friction = 0.4
velocity = 0.2
"#;

/// Signals that change in every step, and one that does so now and then.
const SIGNALS: &str = r#"
[[signal]]
input = "mass.pad.fx"
sine = { amplitude = 3.0, frequency = 100.0 }
[[signal]]
input = "contact.c.friction"
ramp = { to = 1e-3, end = 1.0 }
[[signal]]
input = "contact.c.velocity"
table = { points = [[0.0, 0.0], [0.003, 0.01], [0.005, -0.2]], between = "constant" }
"#;

#[test]
fn steps_reads_and_writes_allocate_nothing() {
    let network = parse("network", NETWORK).unwrap();
    let driven = parse("driven", &format!("{NETWORK}{SIGNALS}")).unwrap();
    let rings = ["set1", "ring12"].map(|name| builtin(name).unwrap().scene());
    let exact = |scene: &Scene| Scene { method: Method::EventDriven, ..scene.clone() };
    let exactly: Vec<Scene> = rings.iter().chain([&network, &driven]).map(exact).collect();
    let mut scenes: Vec<Scene> =
        rings.into_iter().chain([network, driven]).chain(exactly).collect();
    let mut with_ledgers = scenes.clone();
    with_ledgers.iter_mut().for_each(|scene| scene.effects.energy = true);
    scenes.append(&mut with_ledgers);
    for scene in scenes {
        let name = format!("{}, {}, {:?}", scene.name, scene.method, scene.effects);
        let all = variables(&scene);
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        let before = ALLOCATIONS.get();
        assert!(before > 0, "the counter does not count");
        for row in 1..=100_u32 {
            for variable in all.iter().filter(|variable| variable.is_tunable()) {
                let value = simulation.read(variable).unwrap();
                // Preload and µ do change; within the bound of the critical step nothing is solved.
                simulation.write(variable, value * (1.0 + 1e-9)).unwrap();
            }
            simulation.advance_to(f64::from(row) * 1e-4).unwrap();
            for variable in &all {
                simulation.read(variable).unwrap();
            }
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    }
}

#[cfg(feature = "tools")]
#[test]
fn steps_of_a_batch_allocate_nothing() {
    use amontons::integrator::Width;
    use amontons::simulation::Batch;

    let simulation = |friction: f64| {
        let mut scene = builtin("set1").unwrap().scene();
        scene.friction_coefficient = friction;
        Simulation::new(scene, 0.0).unwrap()
    };
    for width in Width::available().into_iter().map(Some).chain([None]) {
        let mut batch = Batch::new([1.0, 1.5, 1.9].map(simulation).into(), width);
        let before = ALLOCATIONS.get();
        for row in 1..=100_u32 {
            batch.advance_to(f64::from(row) * 1e-4);
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{width:?}");
        assert!(
            batch.simulations().iter().all(|s| s.as_ref().unwrap().statistics().steps == 10_000)
        );
    }
}
