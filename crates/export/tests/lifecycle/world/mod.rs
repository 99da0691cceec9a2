//! Sequences of calls are made, each on two instances alike, and held to the oracle.

mod arrays;
mod creation;
mod derivatives;
mod saved_states;
mod steps;
mod tally;
mod variables;
mod way;

use arrays::{Arrays, fit_of};
pub use tally::Tally;

use crate::draw::{Dice, Kind, Op, SLOTS};
use crate::library::{Callbacks, Fmi, Handle};
use crate::scenes::Scene;
use crate::standard::{ERROR, Fit, Life, OK, Phase, Standard, WARNING};
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;

/// Limit of the number of saved states in a sequence.
const STATES: usize = 6;
const UNKNOWN: &[u32] = &[1_000_000, 1 << 31, u32::MAX];
/// More than any array can have.
const HUGE: &[usize] = &[1 << 61, 1 << 63, usize::MAX];

/// Value of places to which a call has not written.
const CANARY: f64 = -12_345.678;

pub type Check<T = ()> = Result<T, String>;

/// Counts of the messages to an instance's logger.
#[derive(Default)]
struct Heard {
    errors: Cell<usize>,
    warnings: Cell<usize>,
}

unsafe extern "C" fn log(
    environment: *mut c_void,
    _name: *const c_char,
    status: c_int,
    category: *const c_char,
    format: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is the one that the instance was given, and outlives it; the strings are terminated.
    let (heard, category, format, message) = unsafe {
        (
            &*environment.cast::<Heard>(),
            CStr::from_ptr(category),
            CStr::from_ptr(format),
            CStr::from_ptr(message),
        )
    };
    assert_eq!(format, c"%s");
    assert!(!message.is_empty());
    let (count, expected) = match category.to_bytes() {
        b"logStatusError" => (&heard.errors, ERROR),
        b"logStatusWarning" => (&heard.warnings, WARNING),
        _ => return,
    };
    assert_eq!(status, expected);
    count.set(count.get() + 1);
}

/// Two instances that get the same calls, and what they are by them.
struct Twins {
    handles: [Handle; 2],
    heard: [Box<Heard>; 2],
    life: Life,
}

/// A state that both twins saved, and what they read then.
struct State {
    handles: [Handle; 2],
    saved: Saved,
}

#[derive(Clone)]
struct Saved {
    scene: usize,
    life: Life,
    read: Option<Vec<u64>>,
}

pub struct World<'a> {
    fmi: &'a Fmi,
    standard: &'a Standard,
    scenes: &'a [Scene],
    /// Indices of the scenes of all slots but the last, and of the last slot.
    of_slot: [usize; 2],
    slots: [Option<Twins>; SLOTS as usize],
    states: Vec<State>,
    tally: &'a mut Tally,
    /// Prints each call.
    pub is_traced: bool,
}

impl<'a> World<'a> {
    pub fn new(
        fmi: &'a Fmi,
        standard: &'a Standard,
        scenes: &'a [Scene],
        scene: usize,
        tally: &'a mut Tally,
    ) -> Self {
        let of_slot = [scene, scenes[scene].other];
        let slots = [(); SLOTS as usize].map(|()| None);
        Self { fmi, standard, scenes, of_slot, slots, states: Vec::new(), tally, is_traced: false }
    }

    pub fn run(&mut self, ops: &[Op]) -> Check {
        for op in ops {
            self.perform(op).map_err(|wrong| format!("{op:?}: {wrong}"))?;
        }
        self.end()
    }

    fn scene_of(&self, slot: usize) -> usize {
        self.of_slot[usize::from(slot + 1 == usize::from(SLOTS))]
    }

    fn scene(&self, slot: usize) -> &'a Scene {
        &self.scenes[self.scene_of(slot)]
    }

    fn twins(&mut self, slot: usize) -> &mut Twins {
        self.slots[slot].as_mut().expect("it was made")
    }

    fn life(&mut self, slot: usize) -> &mut Life {
        &mut self.twins(slot).life
    }

    /// Makes a call on both twins and holds status and messages to what is expected.
    fn call(
        &mut self,
        slot: usize,
        kind: Kind,
        rows: &[&'static str],
        fit: Fit,
        make: &mut dyn FnMut(usize, Handle) -> c_int,
    ) -> Check<i32> {
        let (standard, function) = (self.standard, rows[0]);
        let twins = self.slots[slot].as_mut().expect("it was made");
        let is_null = kind == Kind::NullInstance;
        let mut expected = twins.life.expect(standard, rows, fit);
        if is_null {
            (expected.status, expected.errors, expected.warnings) = (ERROR, 0, 0);
        }
        let mut heard = [0; 2];
        for (twin, heard) in heard.iter_mut().enumerate() {
            let ear = &twins.heard[twin];
            ear.errors.set(0);
            ear.warnings.set(0);
            let handle = if is_null { ptr::null_mut() } else { twins.handles[twin] };
            let status = make(twin, handle);
            self.tally.count(function, status);
            if self.is_traced {
                println!("[{slot}{}] {function} {kind:?} -> {status}", ["a", "b"][twin]);
            }
            if status != expected.status {
                return Err(format!(
                    "{function} gives {status}, not {}, of {:?}",
                    expected.status, twins.life
                ));
            }
            if ear.errors.get() != expected.errors {
                return Err(format!("{function}: {} errors are logged", ear.errors.get()));
            }
            *heard = ear.warnings.get();
            // A call that fails may do so before the condition for a warning is reached.
            let least = if status == ERROR { 0 } else { expected.warnings };
            if !(least..=expected.warnings).contains(heard) {
                return Err(format!("{function}: {heard} warnings, not {}", expected.warnings));
            }
        }
        if heard[0] != heard[1] {
            return Err(format!("{function}: the twins are told of different things"));
        }
        if heard[0] > 0 {
            twins.life.note(standard, rows);
        }
        if !is_null && expected.status == ERROR {
            twins.life.phase = Phase::Error;
        }
        Ok(expected.status)
    }

    /// A call without arguments.
    fn alone(&mut self, slot: usize, kind: Kind, rows: &[&'static str]) -> Check<i32> {
        let fmi = self.fmi;
        let function = match rows[0] {
            "fmi2EnterInitializationMode" => fmi.fmi2EnterInitializationMode,
            "fmi2ExitInitializationMode" => fmi.fmi2ExitInitializationMode,
            "fmi2Terminate" => fmi.fmi2Terminate,
            "fmi2Reset" => fmi.fmi2Reset,
            "fmi2CancelStep" => fmi.fmi2CancelStep,
            name => unreachable!("{name}"),
        };
        // SAFETY: the handle is NULL or alive.
        let status =
            self.call(slot, kind, rows, Fit::Good, &mut |_, handle| unsafe { function(handle) })?;
        if status != ERROR {
            let start = self.scene(slot).start.clone();
            let life = self.life(slot);
            match rows[0] {
                "fmi2EnterInitializationMode" => life.phase = Phase::Initialization,
                "fmi2ExitInitializationMode" => life.phase = Phase::StepComplete,
                "fmi2Terminate" => life.phase = Phase::Terminated,
                _ => life.reset(start),
            }
        }
        Ok(status)
    }

    // ---- The end ----

    /// Gives everything back.
    fn end(&mut self) -> Check {
        if self.slots[0].is_none() && !self.states.is_empty() {
            self.instantiate(0, Kind::Good, &mut Dice(0))?;
        }
        while !self.states.is_empty() {
            self.free_state(0, Kind::Good, &mut Dice(0))?;
        }
        (0..self.slots.len()).for_each(|slot| self.free_instance(slot, Kind::Good));
        Ok(())
    }
}
