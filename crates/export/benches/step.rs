//! What a step costs: `cargo bench --bench step` prints four small tables, all from one run.
//!
//! * Set 1 at µ = 1.96 and h = 1 µs, on its limit cycle, against the same scheme written down
//!   plainly in C with full matrices (`dense_loop.c`, compiled here with `cc -O3`): once with C and K as the
//!   paper has them, once with K alone on x + β ẋ, as C = β K allows. All take model and motion from the same place
//!   and must arrive at the same motion, or the run fails.
//! * Longer rings: time and memory of a module should hardly grow with the ring, until it is too large for the
//!   processor's caches.
//! * Event by event, with steps of 1 ms: a second of motion against the paper's scheme at the scene's
//!   own step.
//! * What is paid once: a simulation (what initializing an FMU costs) and an FMU.
//!
//! Other work on the machine makes a time longer, never shorter. So each run is cut into many short
//! slices, which take turns with those that they are compared to, and the shortest counts. Read the
//! ratio first: it carries over to another machine better than the times do.

#![allow(unsafe_code)] // The C loop comes from a shared library, and allocations are counted.

use amontons::assembly;
use amontons::contact::ContactState;
use amontons::integrator::{self, Inputs, Integrator, Motion, Statistics};
use amontons::model::LumpedModel;
use amontons::scene::{Builtin, Method, Scene, builtin};
use amontons::simulation::Simulation;
use amontons_export::package;
use libloading::Library;
use std::alloc::{GlobalAlloc, Layout, System};
use std::array::from_fn;
use std::env::consts::DLL_SUFFIX;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Slices of a run, and what is in one: steps of Set 1, steps times modules of a ring. A slice of
/// either loop is a few milliseconds at most, so that many run undisturbed on a busy machine.
const SLICES: usize = 250;
const STEPS: u64 = 40_000;
const MODULE_STEPS: u64 = 100_000;
/// Steps after which the two loops are compared number by number.
const SHORT_RUN: u32 = 20_000;

/// Bytes that are allocated now.
static LIVE: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's contract is the one of this function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's contract is the one of this function.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() {
    against_c();
    rings();
    event_by_event();
    paid_once();
}

fn against_c() {
    let mut scene = set("set1").scene();
    scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
    let [mut ours, mut theirs, mut once] = [(); 3].map(|()| Ring::new(&scene));
    assert!(ours.model.damping.alpha == 0.0, "the second loop has C = β K");
    ours.advance(5_000_000); // Five seconds: up to the fourth its amplitude still changes.
    ours.motion.statistics = Statistics::default();
    theirs.motion = ours.motion.clone();
    once.motion = ours.motion.clone();

    println!("Set 1 on its limit cycle      ns a step   million steps/s   state changes");
    let row = |name: &str, time: Duration, ring: &Ring| {
        let time = nanoseconds(time, STEPS);
        let changes = ring.motion.statistics.state_changes();
        println!("{name:26} {time:12.2} {:17.1} {changes:15}", 1e3 / time);
    };
    let Some(plain) = PlainLoops::compile() else {
        let times = shortest(SLICES, &mut [&mut || ours.advance(STEPS)]);
        row("Amontons", times[0], &ours);
        println!("no C compiler (cc) here, so nothing to compare with\n");
        return;
    };
    ours.advance(SHORT_RUN.into());
    plain.advance("dense_loop", &mut theirs, SHORT_RUN.into());
    plain.advance("effective_loop", &mut once, SHORT_RUN.into());
    check_agreement(&ours, &theirs);
    check_agreement(&ours, &once);
    let times = shortest(
        SLICES,
        &mut [
            &mut || ours.advance(STEPS),
            &mut || plain.advance("dense_loop", &mut theirs, STEPS),
            &mut || plain.advance("effective_loop", &mut once, STEPS),
        ],
    );
    row("Amontons", times[0], &ours);
    row("plain C loop, cc -O3", times[1], &theirs);
    row("the same, K on x + β ẋ", times[2], &once);
    let [first, second] = [1, 2].map(|i| times[i].as_secs_f64() / times[0].as_secs_f64());
    println!("C loops / Amontons {first:20.2} {second:17.2}\n");
    // Rounding may push the last event over the end of the run.
    let [ours, theirs, once] =
        [ours, theirs, once].map(|ring| ring.motion.statistics.state_changes());
    let alike = ours.abs_diff(theirs) <= 1 && ours.abs_diff(once) <= 1;
    assert!(alike, "the loops do not change state equally often");
}

/// Are the two motions the same, but for rounding?
fn check_agreement(ours: &Ring, theirs: &Ring) {
    let (a, b) = (&ours.motion, &theirs.motion);
    assert_eq!(a.contacts, b.contacts, "the two loops end in different contact states");
    // A step rounds a velocity a few times, and displacements add the velocities up.
    let largest = a.velocity.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let velocity = f64::from(SHORT_RUN) * 4.0 * f64::EPSILON * largest;
    let displacement = f64::from(SHORT_RUN) * ours.step * velocity;
    let check = |a: &[f64], b: &[f64], tolerance: f64| {
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance),
            "the two loops differ by more than {tolerance:e}:\n{a:?}\n{b:?}"
        );
    };
    check(&a.velocity, &b.velocity, velocity);
    check(&a.displacement, &b.displacement, displacement);
}

fn rings() {
    println!("Rings    ns a module and step   bytes a module   state changes");
    let mut rings = [2, 12, 64, 1024, 10_000, 100_000].map(|modules| {
        let mut scene = set("ring12").scene();
        let module = scene.modules()[0];
        scene.modules_mut().resize(modules, module);
        for (i, module) in scene.modules_mut().iter_mut().enumerate() {
            module.velocity[1] = 0.1 * (i as f64).sin();
        }
        let before = LIVE.load(Ordering::Relaxed);
        let mut ring = Ring::new(&scene);
        let bytes = LIVE.load(Ordering::Relaxed) - before;
        ring.advance(100_000.min(10_000_000 / ring.modules()));
        ring.motion.statistics = Statistics::default();
        (ring, bytes)
    });
    // A few steps at least, as a call does something before the first.
    let steps = |ring: &Ring| (MODULE_STEPS / ring.modules()).max(10);
    let mut turns = rings.each_mut().map(|(ring, _)| || ring.advance(steps(ring)));
    let mut turns = turns.each_mut().map(|turn| turn as &mut dyn FnMut());
    let times = shortest(SLICES, &mut turns);
    for ((ring, bytes), time) in rings.iter().zip(times) {
        let modules = ring.modules();
        let time = nanoseconds(time, steps(ring) * modules);
        let bytes = *bytes as f64 / modules as f64;
        let changes = ring.motion.statistics.state_changes();
        println!("{modules:6} {time:22.2} {bytes:16.0} {changes:15}");
    }
    println!();
}

fn event_by_event() {
    println!("Event by event    ms a second   state changes   the scheme / it");
    let pushed = |friction, velocity| {
        let mut scene = set("set1").scene();
        (scene.friction_coefficient, scene.slider.velocity) = (friction, velocity);
        scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
        scene
    };
    let mut waves = set("ring12").scene();
    for (i, module) in waves.modules_mut().iter_mut().enumerate() {
        module.velocity[1] = 0.1 * (i as f64).sin();
    }
    for (name, scheme, milliseconds) in [
        ("set1", pushed(1.96, 0.025), 1000_u32),
        ("set1, touching", pushed(1.5, 0.15), 1000),
        ("set2", set("set2").scene(), 1000),
        ("ring12", waves, 100),
        ("disc_brake", set("disc_brake").scene(), 100),
    ] {
        let exact = Scene { method: Method::EventDriven, step: 1e-3, ..scheme.clone() };
        let seconds = 1e-3 * f64::from(milliseconds);
        let run = |scene: &Scene| {
            let mut simulation = Simulation::new(scene.clone(), 0.0).expect("it is possible");
            simulation.advance_to(seconds).expect("it has a solution");
            simulation.statistics().state_changes()
        };
        let mut changes = 0;
        let mut slow = || {
            black_box(run(&scheme));
        };
        let times = shortest(10, &mut [&mut slow, &mut || changes = run(&exact)]);
        let [slow, fast] = [times[0], times[1]].map(|time| time.as_secs_f64());
        println!("{name:14} {:14.2} {changes:15} {:17.1}", 1e3 * fast / seconds, slow / fast);
    }
    println!();
}

fn paid_once() {
    println!("Paid once    a simulation        an FMU      its size");
    for name in ["set1", "ring12"] {
        let set = set(name);
        let scene = set.scene();
        let mut size = 0;
        let mut simulate = || {
            black_box(Simulation::new(scene.clone(), 0.0).expect("it is possible"));
        };
        let mut package = || {
            size = package::fmu(&scene, &set.text.into(), None, package::Library::carried())
                .expect("it can be packaged")
                .len();
        };
        let times = shortest(20, &mut [&mut simulate, &mut package]);
        let [simulation, fmu] = [0, 1].map(|i| nanoseconds(times[i], 1));
        let size = size as f64 / 1e3;
        println!("{name:9} {:12.1} µs {:10.1} ms {size:10.1} kB", simulation / 1e3, fmu / 1e6);
    }
}

fn set(name: &str) -> Builtin {
    builtin(name).expect("it is built in")
}

/// The shortest time of each candidate, who take so many turns.
fn shortest(turns: usize, candidates: &mut [&mut dyn FnMut()]) -> Vec<Duration> {
    let mut shortest = vec![Duration::MAX; candidates.len()];
    for _ in 0..turns {
        for (candidate, shortest) in candidates.iter_mut().zip(&mut shortest) {
            let start = Instant::now();
            candidate();
            *shortest = start.elapsed().min(*shortest);
        }
    }
    shortest
}

fn nanoseconds(time: Duration, count: u64) -> f64 {
    1e9 * time.as_secs_f64() / count as f64
}

/// A ring and its motion. A `Simulation` keeps these to itself; here the C loop needs them too.
struct Ring {
    model: LumpedModel,
    inputs: Inputs,
    step: f64,
    motion: Motion,
    integrator: Box<dyn Integrator>,
}

impl Ring {
    fn new(scene: &Scene) -> Self {
        let model = LumpedModel::from(scene);
        // Measured from the equilibrium, the contact forces that balance the load are left of it.
        let equilibrium = assembly::equilibrium(scene, &model).expect("it has an equilibrium");
        let mut force = vec![0.0; model.dofs()];
        for (i, contact) in model.contacts.iter().enumerate() {
            contact.normal.add_to(&mut force, -equilibrium.normal_force[i]);
            contact.tangent.add_to(&mut force, -equilibrium.friction_force[i]);
        }
        Self {
            inputs: Inputs::uniform(
                force,
                model.contacts.len(),
                scene.slider.velocity,
                scene.friction_coefficient,
            ),
            step: scene.step,
            motion: Motion::new(
                vec![0.0; model.dofs()],
                scene.initial_velocities().collect(),
                vec![ContactState::Slide; model.contacts.len()],
            ),
            integrator: integrator::choose(&model, scene.method).expect("its masses are positive"),
            model,
        }
    }

    fn modules(&self) -> u64 {
        self.model.contacts.len() as u64
    }

    fn advance(&mut self, steps: u64) {
        self.integrator
            .advance(&mut self.motion, &self.inputs, self.step, steps)
            .expect("the contacts of a ring can be solved");
    }
}

/// `struct problem` of `dense_loop.c`.
#[repr(C)]
struct Problem {
    mass: [f64; 8],
    stiffness: [[f64; 8]; 8],
    damping: [[f64; 8]; 8],
    force: [f64; 8],
    slider_velocity: f64,
    friction: f64,
    step: f64,
    beta: f64,
}

impl From<&Ring> for Problem {
    fn from(ring: &Ring) -> Self {
        let LumpedModel { mass, stiffness, damping, .. } = &ring.model;
        let c = |i, j| damping.alpha * mass.get(i, j) + damping.beta * stiffness.get(i, j);
        Self {
            mass: from_fn(|i| mass.get(i, i)),
            stiffness: from_fn(|i| from_fn(|j| stiffness.get(i, j))),
            damping: from_fn(|i| from_fn(|j| c(i, j))),
            force: from_fn(|i| ring.inputs.force[i]),
            slider_velocity: ring.inputs.slider_velocity[0],
            friction: ring.inputs.friction[0].kinetic,
            step: ring.step,
            beta: damping.beta,
        }
    }
}

/// The loops of `dense_loop.c`.
struct PlainLoops(Library);

impl PlainLoops {
    /// `None` where there is no C compiler.
    fn compile() -> Option<Self> {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/dense_loop.c");
        let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join("dense_loop");
        let library = library.with_extension(&DLL_SUFFIX[1..]);
        let mut compiler = Command::new("cc");
        compiler.args(["-O3", "-fPIC", "-shared", "-o"]).args([&library, &source]);
        assert!(compiler.status().ok()?.success(), "cc does not compile {}", source.display());
        // SAFETY: loading it runs no code of its own.
        Some(Self(unsafe { Library::new(&library) }.expect("it was just made")))
    }

    /// Takes as many steps of a ring with the loop of this name; of the statistics it counts the state changes alone.
    fn advance(&self, name: &str, ring: &mut Ring, steps: u64) {
        type Function =
            unsafe extern "C" fn(&Problem, *mut f64, *mut f64, &mut [i32; 2], u64) -> u64;
        let problem = Problem::from(&*ring);
        // SAFETY: this is the type of both functions in the C file.
        let function = unsafe { self.0.get::<Function>(name) }.expect("it is in there");
        let Motion { displacement: x, velocity: v, contacts, statistics, .. } = &mut ring.motion;
        assert!(x.len() == 8 && v.len() == 8);
        let mut states: [i32; 2] = from_fn(|i| contacts[i] as i32);
        let (x, v) = (x.as_mut_ptr(), v.as_mut_ptr());
        // It does not tell which states; only the sum is looked at.
        // SAFETY: it reads and writes the problem, eight numbers of each vector, and two states.
        statistics.entered[0] += unsafe { function(&problem, x, v, &mut states, steps) };
        *contacts = states.map(|state| ContactState::ALL[state as usize - 1]).to_vec();
    }
}
