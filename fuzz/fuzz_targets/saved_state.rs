//! Bytes that pose as a saved state, through the C functions: read, restored, looked at, stepped from, saved
//! again. What comes in is refused with a reason or runs; nothing panics, hangs or fills the memory, and a
//! refusal leaves the instance where it was.
//!
//! An input is a byte that picks scene, integrator, way of making the bytes ([`Made`]) and way of restoring,
//! one for the number of steps, and the rest.
#![no_main]
#![allow(unsafe_code)]

#[path = "../../tests/support/c.rs"]
mod c;

use amontons::scene::{Method, Source, builtin, parse};
use amontons::simulation::catalogue::Kind;
use amontons::simulation::{fingerprint, variables};
use amontons_export::scene::set_integrator;
use c::*;
use libfuzzer_sys::fuzz_target;
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr::null_mut;
use std::time::Duration;

const OK: c_int = 0;
const WARNING: c_int = 1;
const ERROR: c_int = 3;

/// The longest that a call may take, in processor time of its thread. An internal step that is refused after the most power
/// series (ring12 with energy) takes up to 80 s here, where each branch is watched and each sum checked, and up to 6 s in a
/// release.
const MOST_TIME: Duration = Duration::from_secs(240);

thread_local! {
    static SUBJECTS: RefCell<Vec<Subject>> = RefCell::new(subjects());
    /// How many errors were logged.
    static ERRORS: Cell<u32> = const { Cell::new(0) };
}

unsafe extern "C" fn log(
    _: *mut c_void,
    _: *const c_char,
    status: c_int,
    _: *const c_char,
    _: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the library hands terminated strings over.
    let message = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    if std::env::var_os("AMONTONS_FUZZ_SHOW").is_some() {
        eprintln!("{status}: {message}");
    }
    if message.starts_with("internal error") {
        // Out of a C function no panic may go.
        eprintln!("{message}");
        std::process::abort();
    }
    ERRORS.set(ERRORS.get() + u32::from(status == ERROR));
}

/// How the bytes of a state come about.
enum Made {
    /// They are the input.
    Raw,
    /// The input stands between mark, version, GUID and checksum of a real one.
    Framed,
    /// They are a real one's, changed as the input says, with a new checksum.
    Edited,
}

/// An instance that every input meets in the same state.
struct Subject {
    it: *mut c_void,
    reals: Vec<c_uint>,
    integers: Vec<c_uint>,
    /// Value reference of the internal step.
    step: c_uint,
    /// In the middle of a run, with its bytes.
    base: *mut c_void,
    bytes: Vec<u8>,
}

fuzz_target!(|data: &[u8]| {
    let &[choice, steps, ref rest @ ..] = data else { return };
    SUBJECTS.with_borrow(|subjects| {
        let mut choice = usize::from(choice);
        let mut pick = |count: usize| {
            let picked = choice % count;
            choice /= count;
            picked
        };
        let subject = &subjects[pick(subjects.len())];
        let made = match pick(4) {
            0 => Made::Raw,
            1 => Made::Framed,
            _ => Made::Edited,
        };
        let is_fresh = pick(2) == 1;
        subject.meet(&subject.state(&made, rest), is_fresh, steps);
    });
});

impl Subject {
    /// The bytes that pose as a state.
    fn state(&self, made: &Made, input: &[u8]) -> Vec<u8> {
        // Mark, version and GUID; in the end a CRC-32, of all before it.
        const HEADER: usize = 4 + 1 + 38;
        let (header, content) = self.bytes.split_at(HEADER);
        let content = &content[..content.len() - 4];
        let mut bytes = match made {
            Made::Raw => return input.to_vec(),
            Made::Framed => [header, input].concat(),
            Made::Edited => [header, &edited(content, input)].concat(),
        };
        bytes.extend_from_slice(&crc32(&bytes).to_le_bytes());
        bytes
    }

    fn meet(&self, bytes: &[u8], is_fresh: bool, steps: u8) {
        let it = self.it;
        // SAFETY: FMI's calls on a live instance, with arrays as long as said.
        unsafe {
            if is_fresh {
                assert_eq!(fmi2Reset(it), OK);
            } else {
                assert_eq!(fmi2SetFMUstate(it, self.base), OK);
            }
            let before = self.save();
            let mut state = null_mut();
            let mut status = refusable(|| {
                fmi2DeSerializeFMUstate(it, bytes.as_ptr(), bytes.len(), &raw mut state)
            });
            if status == OK {
                status = refusable(|| fmi2SetFMUstate(it, state));
                assert_eq!(fmi2FreeFMUstate(it, &raw mut state), OK);
            } else {
                assert!(state.is_null(), "what is refused leaves nothing to free");
            }
            if status != OK {
                // Nothing of the motion has changed, and a state that is one leads out.
                let Some(before) = before else { return };
                assert_eq!(fmi2SetFMUstate(it, self.base), OK);
                if !is_fresh {
                    assert_eq!(before, self.bytes);
                    assert_eq!(self.save().as_ref(), Some(&before));
                }
                return;
            }
            self.look();
            self.run(steps);
            self.look();
        }
        if let Some(own) = self.save() {
            self.take_back(&own);
        }
    }

    /// Reads all variables, and the size of the internal step.
    unsafe fn look(&self) -> f64 {
        let (mut value, mut number, mut step) = (0.0, 0, f64::NAN);
        // SAFETY: each call reads one value of a live instance.
        unsafe {
            refusable(|| fmi2GetReal(self.it, &raw const self.step, 1, &raw mut step));
            for reference in &self.reals {
                let status = refusable(|| fmi2GetReal(self.it, reference, 1, &raw mut value));
                assert!(status != OK || value.is_finite(), "no value is anything but a number");
            }
            for reference in &self.integers {
                refusable(|| fmi2GetInteger(self.it, reference, 1, &raw mut number));
            }
        }
        step
    }

    /// Goes on from the state, which may be one before the start of a run.
    unsafe fn run(&self, steps: u8) {
        let it = self.it;
        // SAFETY: FMI's calls on a live instance; those that it does not allow now it refuses.
        unsafe {
            let step = self.look();
            let mut now = self.time();
            let mut status = refusable(|| fmi2DoStep(it, now, step, 1));
            if status == ERROR && steps % 2 == 1 {
                refusable(|| fmi2EnterInitializationMode(it));
                refusable(|| fmi2ExitInitializationMode(it));
                status = refusable(|| fmi2DoStep(it, now, step, 1));
            }
            if status == OK {
                now = self.time();
                refusable(|| fmi2DoStep(it, now, f64::from(steps) * step, 1));
                // Off the grid, and nothing at all.
                now = self.time();
                refusable(|| fmi2DoStep(it, now, 0.3 * step, 1));
                refusable(|| fmi2DoStep(it, now + 0.3 * step, 0.0, 1));
            }
        }
    }

    /// Up to which all steps succeeded, s. It is known in every phase, in some with a warning.
    unsafe fn time(&self) -> f64 {
        let mut now = 0.0;
        // SAFETY: a live instance writes one value.
        let status = unsafe { fmi2GetRealStatus(self.it, 2, &raw mut now) };
        assert!([OK, WARNING].contains(&status), "status {status}");
        now
    }

    /// The instance's own bytes; `None` in a phase that has none.
    fn save(&self) -> Option<Vec<u8>> {
        let (mut state, mut size) = (null_mut(), 0);
        // SAFETY: FMI's calls on a live instance, with an array as long as said.
        unsafe {
            if refusable(|| fmi2GetFMUstate(self.it, &raw mut state)) != OK {
                return None;
            }
            assert_eq!(fmi2SerializedFMUstateSize(self.it, state, &raw mut size), OK);
            let mut bytes = vec![0_u8; size];
            let start = bytes.as_mut_ptr();
            assert_eq!(fmi2SerializeFMUstate(self.it, state, start, size), OK);
            assert_eq!(fmi2FreeFMUstate(self.it, &raw mut state), OK);
            Some(bytes)
        }
    }

    /// What an instance has written itself it reads again, to the last bit.
    fn take_back(&self, own: &[u8]) {
        let mut state = null_mut();
        // SAFETY: FMI's calls on a live instance, with an array as long as said.
        unsafe {
            let start = own.as_ptr();
            assert_eq!(fmi2DeSerializeFMUstate(self.it, start, own.len(), &raw mut state), OK);
            assert_eq!(fmi2SetFMUstate(self.it, state), OK);
            assert_eq!(fmi2FreeFMUstate(self.it, &raw mut state), OK);
        }
        assert_eq!(self.save().as_deref(), Some(own));
    }
}

/// A call that may be refused, with a reason, and in time.
fn refusable(call: impl FnOnce() -> c_int) -> c_int {
    let (start, told) = (processor_time(), ERRORS.get());
    let status = call();
    assert!([OK, WARNING, ERROR].contains(&status), "status {status}");
    assert_eq!(ERRORS.get() - told, u32::from(status == ERROR), "each refusal has one reason");
    let taken = processor_time() - start;
    assert!(taken < MOST_TIME, "a call took {taken:?}");
    status
}

/// The processor time that this thread has used.
fn processor_time() -> Duration {
    let mut used = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: it writes one value.
    let status = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut used) };
    assert_eq!(status, 0);
    Duration::new(used.tv_sec.unsigned_abs(), used.tv_nsec as u32)
}

/// Content with changes of eleven bytes each: where (two bytes), what, and a value of eight bytes.
fn edited(content: &[u8], input: &[u8]) -> Vec<u8> {
    const NUMBERS: [f64; 16] = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN,
        1e300,
        -1e300,
        1e150,
        -1e150,
        5e-324,
        0.0,
        -0.0,
        -1.0,
        1.0,
        1e-9,
        9e15,
    ];
    let mut bytes = content.to_vec();
    for &change in input.as_chunks::<11>().0.iter().take(16) {
        let [low, high, what, value @ ..] = change;
        let at = usize::from(u16::from_le_bytes([low, high])) % (bytes.len() + 1);
        let left = bytes.len() - at;
        match what % 8 {
            // A double at a place, of any value or of those that hurt.
            0 if left >= 8 => bytes[at..at + 8].copy_from_slice(&value),
            1 | 2 if left >= 8 => {
                let number = NUMBERS[usize::from(value[0]) % NUMBERS.len()];
                bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
            }
            3 if left >= 1 => bytes[at] = value[0],
            4 => bytes.insert(at, value[0]),
            5 if left >= 1 => drop(bytes.remove(at)),
            // The largest count that the format has.
            6 if left >= 1 => drop(bytes.splice(at..=at, [0xFF; 9].into_iter().chain([1]))),
            7 => bytes.truncate(at),
            _ => {}
        }
    }
    bytes
}

/// CRC-32 as in zip files, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let byte = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    };
    !bytes.iter().fold(!0, byte)
}

fn subjects() -> Vec<Subject> {
    let text = |name| builtin(name).expect("it is built in").text;
    let scenes = [
        (text("set1").to_owned(), 1e-5),
        (format!("{}\n[effects]\nenergy = true\n", text("ring12")), 1e-5),
        (include_str!("../../scenes/effects/static.toml").to_owned(), 1e-3),
    ];
    let folder = std::env::temp_dir().join(format!("amontons-fuzz-{}", std::process::id()));
    let mut subjects = Vec::new();
    for (text, step) in scenes {
        for method in [Method::ForwardIncrement, Method::EventDriven] {
            let mut source = Source::from(text.as_str());
            set_integrator(&mut source, method, step).expect("it has an integrator");
            let folder = folder.join(subjects.len().to_string());
            std::fs::create_dir_all(&folder).expect("there is a folder for temporary files");
            std::fs::write(folder.join("scene.toml"), &source.text).expect("it can be written to");
            subjects.push(subject(&source, &folder, step));
        }
    }
    std::fs::remove_dir_all(&folder).expect("it was made here");
    subjects
}

fn subject(source: &Source, folder: &std::path::Path, step: f64) -> Subject {
    static CALLBACKS: Shared = Shared(Callbacks {
        logger: Some(log),
        memory: [None; 2],
        step_finished: None,
        environment: null_mut(),
    });
    let all = variables(&parse("scene", &source.text).expect("the scene is right"));
    let is_real =
        |reference: &c_uint| matches!(all[*reference as usize].template.kind, Kind::Real { .. });
    let references = 0..c_uint::try_from(all.len()).expect("there are few");
    let (reals, integers) = references.partition(is_real);
    let step_at = all.iter().position(|variable| variable.name == "integrator.step");
    let location = CString::new(format!("file://{}", folder.display())).expect("no zeros");
    let guid = CString::new(fingerprint(source)).expect("no zeros");
    // SAFETY: FMI's calls in FMI's order; every string is terminated.
    unsafe {
        let (guid, location) = (guid.as_ptr(), location.as_ptr());
        let callbacks = &raw const CALLBACKS.0;
        let it = fmi2Instantiate(c"one".as_ptr(), 1, guid, location, callbacks, 0, 0);
        assert!(!it.is_null());
        assert_eq!(fmi2SetupExperiment(it, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(it), OK);
        assert_eq!(fmi2ExitInitializationMode(it), OK);
        assert_eq!(fmi2DoStep(it, 0.0, 100.0 * step, 1), OK);
        let mut base = null_mut();
        assert_eq!(fmi2GetFMUstate(it, &raw mut base), OK);
        let step = step_at.expect("every scene has it").try_into().expect("there are few");
        let mut subject = Subject { it, reals, integers, step, base, bytes: Vec::new() };
        subject.bytes = subject.save().expect("it runs");
        subject
    }
}

/// The callbacks, which nothing changes.
struct Shared(Callbacks);

// SAFETY: its pointers are NULL or a function.
unsafe impl Sync for Shared {}
