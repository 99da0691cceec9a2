//! What the FMU's boundary costs: `cargo bench --bench boundary` prints one table.
//!
//! Each scene is packaged, unpacked and loaded as an importer does it. Two instances then move alike, one in
//! communication steps of a single internal step, one in those of a thousand; the difference of a step in
//! either is what `fmi2DoStep` costs besides the step. Both must arrive at the same doubles, or the run
//! fails. Reads are of everything the model description calls an output, once of a state whose contact
//! forces are known and once after a step, when they have to be computed.
//!
//! Other work on the machine makes a time longer, never shorter: runs are cut into slices, which take turns,
//! and the shortest counts (see `step.rs`).

#![allow(unsafe_code)] // The FMU's functions are C's.

#[allow(dead_code)] // Not all of them are timed.
#[path = "../tests/lifecycle/library.rs"]
mod library;

use amontons::scene::{Builtin, builtin, parse};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Variable, fingerprint, variables};
use amontons_export::package;
use library::{Fmi, Handle};
use std::ffi::{CString, c_uint};
use std::io::Cursor;
use std::path::Path;
use std::ptr;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Slices of a run, and how many internal steps each has at least.
const SLICES: usize = 200;
const STEPS: u32 = 2000;
/// Internal steps in a long communication step.
const LONG: u32 = 1000;

fn main() {
    println!(
        "The boundary                    ns a step   alone, 1000 at once    doStep adds   outputs known, \
         computed   input and doStep add"
    );
    for (name, method, settle, push) in [
        ("set1", "forward-increment", 5_000_000, Some("initial.module[1].v1")),
        ("ring12", "forward-increment", 200_000, Some("initial.module[1].v1")),
        ("stick_slip", "forward-increment", 10_000, None),
        ("set1", "event-driven", 5_000_000, Some("initial.module[1].v1")),
        ("stick_slip", "event-driven", 10_000, None),
    ] {
        row(name, method, settle, push);
    }
}

fn row(name: &str, method: &str, settle: u32, push: Option<&str>) {
    let set = builtin(name).expect("it is built in");
    let text = with_method(set, method);
    let fmu = Fmu::new(name, &text);
    let mut instances = [(); 4].map(|()| fmu.instantiate(push));
    for instance in &mut instances {
        instance.do_step(settle);
    }
    let [one_by_one, at_once, read, driven] = &mut instances;
    let input = fmu.reference("slider.velocity");
    let velocity = fmu.scene_velocity;
    let outputs = fmu.outputs();
    let mut values = vec![0.0; outputs.len()];
    let times = shortest(
        SLICES,
        &mut [
            &mut || (0..STEPS).for_each(|_| one_by_one.do_step(1)),
            &mut || (0..STEPS / LONG).for_each(|_| at_once.do_step(LONG)),
            &mut || (0..STEPS).for_each(|_| read.get(&outputs, &mut values)),
            &mut || {
                for _ in 0..STEPS {
                    driven.set(&[input], &[velocity]);
                    driven.do_step(1);
                }
            },
        ],
    );
    let mut computed = vec![0.0; outputs.len()];
    let reading = shortest(
        SLICES,
        &mut [&mut || {
            for _ in 0..STEPS {
                read.do_step(1);
                read.get(&outputs, &mut computed);
            }
        }],
    );
    let bits = |instance: &mut Instance| {
        let mut values = vec![0.0; outputs.len()];
        instance.get(&outputs, &mut values);
        values.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let expected = bits(at_once);
    assert_eq!(bits(one_by_one), expected, "{name}: a run that is split has other doubles");
    assert_eq!(bits(driven), expected, "{name}: an input that stays as it is changes the motion");
    let [single, long, known, set] = [0, 1, 2, 3].map(|i| nanoseconds(times[i]));
    let computed = nanoseconds(reading[0]) - single;
    let label = format!("{name}, {method}");
    println!(
        "{label:30} {single:10.1} {long:13.1} {:21.1} {known:15.1} {computed:10.1} {:13.1}",
        single - long,
        set - single
    );
}

/// The text of a scene with another method, at its own step.
fn with_method(scene: Builtin, method: &str) -> String {
    scene.text.replacen("[integrator]", &format!("[integrator]\nmethod = \"{method}\""), 1)
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

/// One of [`STEPS`] in that time.
fn nanoseconds(time: Duration) -> f64 {
    1e9 * time.as_secs_f64() / f64::from(STEPS)
}

/// An FMU, unpacked and loaded.
struct Fmu {
    folder: TempDir,
    library: Fmi,
    guid: CString,
    variables: Vec<Variable>,
    step: f64,
    scene_velocity: f64,
}

impl Fmu {
    fn new(name: &str, text: &str) -> Self {
        let scene = parse(name, text).expect("it is a scene");
        let bytes = package::fmu(&scene, &text.into(), None, package::Library::carried())
            .expect("it can be packaged");
        let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("there is room");
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).expect("it is an archive");
        archive.extract(folder.path()).expect("there is room");
        let path = folder.path().join("binaries/linux64").join(format!("{name}.so"));
        let library = Fmi::load(path.to_str().expect("it is text"));
        let guid = CString::new(fingerprint(&text.into())).expect("it has no zeros");
        Self {
            folder,
            library,
            guid,
            variables: variables(&scene),
            step: scene.step,
            scene_velocity: scene.slider.velocity,
        }
    }

    fn reference(&self, name: &str) -> c_uint {
        let place = self.variables.iter().position(|variable| variable.name == name);
        c_uint::try_from(place.expect("it has that variable")).expect("there are not so many")
    }

    /// The value references of all outputs that are numbers with a unit.
    fn outputs(&self) -> Vec<c_uint> {
        let is_real_output = |variable: &&Variable| {
            let template = variable.template;
            template.causality == Causality::Output && matches!(template.kind, Kind::Real { .. })
        };
        let outputs = self.variables.iter().filter(is_real_output);
        outputs.map(|variable| self.reference(&variable.name)).collect()
    }

    /// An instance at time 0, after initialization; 0.01 m/s stand where it is pushed.
    fn instantiate(&self, push: Option<&str>) -> Instance<'_> {
        let location = |folder: &Path| format!("file://{}", folder.join("resources").display());
        let location = CString::new(location(self.folder.path())).expect("it has no zeros");
        let fmi = &self.library;
        let (guid, location, callbacks) = (self.guid.as_ptr(), location.as_ptr(), ptr::null());
        // SAFETY: all strings are terminated and outlive the call.
        let component =
            unsafe { (fmi.fmi2Instantiate)(c"one".as_ptr(), 1, guid, location, callbacks, 0, 0) };
        assert!(!component.is_null(), "the FMU cannot be instantiated");
        let mut instance = Instance { fmi, component, step: self.step, steps: 0 };
        // SAFETY: the instance lives.
        unsafe {
            assert_eq!((fmi.fmi2SetupExperiment)(component, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!((fmi.fmi2EnterInitializationMode)(component), 0);
        }
        if let Some(name) = push {
            instance.set(&[self.reference(name)], &[0.01]);
        }
        // SAFETY: the instance lives.
        assert_eq!(unsafe { (fmi.fmi2ExitInitializationMode)(component) }, 0);
        instance
    }
}

/// A running instance, and how many internal steps it has taken.
struct Instance<'a> {
    fmi: &'a Fmi,
    component: Handle,
    step: f64,
    steps: u32,
}

impl Instance<'_> {
    /// One communication step of so many internal ones.
    fn do_step(&mut self, steps: u32) {
        let now = f64::from(self.steps) * self.step;
        // SAFETY: the instance lives, and the function is FMI's.
        let status =
            unsafe { (self.fmi.fmi2DoStep)(self.component, now, f64::from(steps) * self.step, 1) };
        assert_eq!(status, 0, "the step failed");
        self.steps += steps;
    }

    fn get(&mut self, references: &[c_uint], values: &mut [f64]) {
        let (places, count) = (references.as_ptr(), references.len());
        assert_eq!(count, values.len());
        // SAFETY: as in a step; there is room for as many values.
        let status =
            unsafe { (self.fmi.fmi2GetReal)(self.component, places, count, values.as_mut_ptr()) };
        assert_eq!(status, 0, "the values cannot be read");
    }

    fn set(&mut self, references: &[c_uint], values: &[f64]) {
        let (places, count) = (references.as_ptr(), references.len());
        assert_eq!(count, values.len());
        // SAFETY: as in a step; there are as many values.
        let status =
            unsafe { (self.fmi.fmi2SetReal)(self.component, places, count, values.as_ptr()) };
        assert_eq!(status, 0, "the values cannot be set");
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: it is not used again.
        unsafe { (self.fmi.fmi2FreeInstance)(self.component) }
    }
}
