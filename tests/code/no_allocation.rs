//! A step, a read and a write allocate nothing.
#![allow(unsafe_code)]

use crate::brake_pad::{self, Size};
use crate::c;
use amontons::integrator::Statistics;
use amontons::scene::{Method, Scene, Structure, builtin, parse};
use amontons::simulation::catalogue::Kind;
use amontons::simulation::{Simulation, Variable, fingerprint, variables};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::CString;

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
        assert_allocates_nothing(scene, 1e-4);
    }
}

#[test]
fn full_matrices_with_contacts_that_stick_and_open_allocate_nothing() {
    let size = Size::SMALL;
    for (method, step) in [(Method::ForwardIncrement, 1e-7), (Method::EventDriven, 1e-5)] {
        let mut scene = Scene { method, step, ..brake_pad::scene(size, 0.4) };
        if let Structure::Network(network) = &mut scene.structure {
            network.superelements[0].velocity[3 * size.contacts()..].fill(0.03);
        }
        for energy in [false, true] {
            scene.effects.energy = energy;
            let [_, _, sticks, opens] = assert_allocates_nothing(scene.clone(), 1e-5).entered;
            assert!(sticks > 10 && opens > 10, "{method}: {sticks} {opens}");
        }
    }
}

/// Takes 100 steps of this length (s), each with all writes and reads. The counters at the end.
#[track_caller]
fn assert_allocates_nothing(scene: Scene, length: f64) -> Statistics {
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
        simulation.advance_to(f64::from(row) * length).unwrap();
        for variable in &all {
            simulation.read(variable).unwrap();
        }
    }
    assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    simulation.statistics()
}

#[test]
fn a_contact_state_that_was_met_is_watched_without_allocating() {
    let mut scene = builtin("set1").unwrap().scene();
    scene.effects.stability = true;
    let all = variables(&scene);
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let read = |simulation: &mut Simulation| {
        let before = ALLOCATIONS.get();
        for variable in &all {
            simulation.read(variable).unwrap();
        }
        ALLOCATIONS.get() - before
    };
    assert!(read(&mut simulation) > 0, "a state that is new is solved");
    for row in 1..=100_u32 {
        simulation.advance_to(f64::from(row) * 1e-4).unwrap();
        assert_eq!(read(&mut simulation), 0);
    }
}

fn is_real(variable: &Variable) -> bool {
    matches!(variable.template.kind, Kind::Real { .. })
}

/// The calls of an importer between communication points: it sets all variables that may be set, steps, and reads all.
#[test]
fn a_run_across_the_c_interface_allocates_nothing() {
    let set1 = builtin("set1").unwrap().text.to_owned();
    let ring = builtin("ring12").unwrap().text.to_owned();
    let exactly =
        |text: &str| text.replacen("[integrator]", "[integrator]\nmethod = \"event-driven\"", 1);
    let driven = format!("{NETWORK}{SIGNALS}");
    for text in [exactly(&set1), exactly(NETWORK), set1, ring, NETWORK.to_owned(), driven] {
        let scene = parse("scene", &text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), &text).unwrap();
        let location = CString::new(format!("file://{}", folder.path().display())).unwrap();
        let guid = CString::new(fingerprint(&(&*text).into())).unwrap();
        let all = variables(&scene);
        let of = |wanted: fn(&Variable) -> bool| -> Vec<u32> {
            let numbers = (0..).zip(&all).filter(|(_, variable)| wanted(variable));
            numbers.map(|(number, _)| number).collect()
        };
        let [reals, integers, inputs] =
            [of(is_real), of(|v| !is_real(v)), of(Variable::is_tunable)];
        let mut values = vec![0.0; reals.len()];
        let mut numbers = vec![0; integers.len()];
        let mut given = vec![0.0; inputs.len()];
        // SAFETY: FMI's calls in FMI's order; every array is as long as said, every string is terminated.
        unsafe {
            let null = std::ptr::null();
            let (guid, location) = (guid.as_ptr(), location.as_ptr());
            let it = c::fmi2Instantiate(c"one".as_ptr(), 1, guid, location, null, 0, 0);
            assert!(!it.is_null());
            assert_eq!(c::fmi2SetupExperiment(it, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!(c::fmi2EnterInitializationMode(it), 0);
            assert_eq!(c::fmi2ExitInitializationMode(it), 0);
            let count = inputs.len();
            assert_eq!(c::fmi2GetReal(it, inputs.as_ptr(), count, given.as_mut_ptr()), 0);
            let before = ALLOCATIONS.get();
            let mut steps = 0;
            for size in [1_u32, 1, 100, 1].into_iter().cycle().take(400) {
                // Preload and µ do change; within the bound of the critical step nothing is solved.
                given.iter_mut().for_each(|value| *value *= 1.0 + 1e-9);
                assert_eq!(c::fmi2SetReal(it, inputs.as_ptr(), count, given.as_ptr()), 0);
                let [now, size_s] = [steps, size].map(|steps| f64::from(steps) * scene.step);
                assert_eq!(c::fmi2DoStep(it, now, size_s, 1), 0);
                steps += size;
                assert_eq!(c::fmi2GetReal(it, reals.as_ptr(), reals.len(), values.as_mut_ptr()), 0);
                assert_eq!(
                    c::fmi2GetInteger(it, integers.as_ptr(), integers.len(), numbers.as_mut_ptr()),
                    0
                );
            }
            assert_eq!(ALLOCATIONS.get() - before, 0, "{:?}", scene.method);
            c::fmi2FreeInstance(it);
        }
    }
}
