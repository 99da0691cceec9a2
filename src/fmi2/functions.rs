//! The functions of FMI 2.0 for co-simulation, as C sees them.
//!
//! Every one only turns its arguments into safe ones and leaves the work to [`Instance`].
#![allow(non_snake_case, unsafe_code, clippy::missing_safety_doc)]

use super::boundary::{self, OK, Outcome, array, array_mut, call, single, string};
use super::instance::{Instance, Number, SavedInstance};
use super::lifecycle::Call;
use super::logger::{Category, Logger};
use super::resources;
use super::types::*;
use crate::Error;
use libc::{c_int, size_t};
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;

// Each function below is called by an importer, which keeps FMI's contract: handles come from
// fmi2Instantiate and are live, arrays have the length given with them, strings are terminated.
// That contract is the safety condition of all of them and the reason given in each block.

// ---- Inquiry ----

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> fmi2String {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> fmi2String {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetDebugLogging(
    component: fmi2Component,
    logging_on: fmi2Boolean,
    count: size_t,
    categories: *const fmi2String,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let pointers = unsafe { array(categories, count) }?;
        let names: Option<Vec<&CStr>> =
            // SAFETY: the importer's contract.
            pointers.iter().map(|&pointer| unsafe { string(pointer) }).collect();
        let names = names.ok_or_else(|| Error::variable("a logging category is NULL"))?;
        if let Err(unknown) = instance.logger.enable(logging_on != fmi2False, &names) {
            instance.warn(&format!("there is no logging category {unknown:?}"));
            return Ok(fmi2Status::fmi2Warning);
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::SetDebugLogging, body) }
}

// ---- Creation and destruction ----

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Instantiate(
    instance_name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    resource_location: fmi2String,
    callbacks: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    let make = || {
        // SAFETY: the importer's contract; NULL is allowed for each of these.
        let (name, guid, location, callbacks) = unsafe {
            (string(instance_name), string(guid), string(resource_location), callbacks.as_ref())
        };
        let logger = Logger::new(callbacks, name.unwrap_or(c""), logging_on != fmi2False);
        let refuse = |logger: &Logger, message: &str| {
            logger.log(fmi2Status::fmi2Error, Category::Error, message);
            ptr::null_mut()
        };
        if name.is_none_or(CStr::is_empty) {
            return refuse(&logger, "the instance needs a name");
        }
        if kind != fmi2CoSimulation {
            return refuse(&logger, "this FMU is for co-simulation only");
        }
        let Some(guid) = guid.and_then(|guid| guid.to_str().ok()) else {
            return refuse(&logger, "the GUID is missing");
        };
        let Some(resources) = resources::folder(location) else {
            return refuse(&logger, "the resource location is not a local folder (file:///…)");
        };
        match Instance::new(&resources, guid, logger) {
            Ok(instance) => boundary::handle(instance),
            Err((error, logger)) => refuse(&logger, &error.to_string()),
        }
    };
    catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|panic| {
        let message = format!("internal error: {}", boundary::panic_message(&*panic));
        // SAFETY: the importer's contract; NULL is allowed for both.
        let (name, callbacks) = unsafe { (string(instance_name), callbacks.as_ref()) };
        let logger = Logger::new(callbacks, name.unwrap_or(c""), true);
        logger.log(fmi2Status::fmi2Error, Category::Error, &message);
        ptr::null_mut()
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeInstance(component: fmi2Component) {
    // SAFETY: the importer's contract.
    unsafe { boundary::free(component) }
}

// ---- Initialization, termination, reset ----

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetupExperiment(
    component: fmi2Component,
    tolerance_defined: fmi2Boolean,
    tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    let tolerance = (tolerance_defined != fmi2False).then_some(tolerance);
    let stop = (stop_time_defined != fmi2False).then_some(stop_time);
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::SetupExperiment, |instance| {
            instance.setup_experiment(tolerance, start_time, stop)?;
            OK
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2EnterInitializationMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::EnterInitializationMode, |instance| {
            instance.enter_initialization_mode();
            OK
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2ExitInitializationMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::ExitInitializationMode, |instance| {
            instance.exit_initialization_mode()?;
            OK
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Terminate(component: fmi2Component) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::Terminate, |instance| {
            instance.terminate();
            OK
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Reset(component: fmi2Component) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::Reset, |instance| {
            instance.reset();
            OK
        })
    }
}

// ---- Variables ----

/// Reads variables of one type.
///
/// # Safety
/// The importer's contract.
unsafe fn get<T>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut T,
    number: Number,
    convert: impl Fn(f64) -> T,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: this function's contract.
        let (references, values) =
            unsafe { (array(references, count)?, array_mut(values, count)?) };
        for (&reference, value) in references.iter().zip(values) {
            value.write(convert(instance.get(reference, number)?));
        }
        OK
    };
    // SAFETY: this function's contract.
    unsafe { call(component, Call::Get, body) }
}

/// Writes variables of one type, all or none.
///
/// # Safety
/// The importer's contract.
unsafe fn set<T: Copy + Into<f64>>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const T,
    number: Number,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: this function's contract.
        let (references, values) = unsafe { (array(references, count)?, array(values, count)?) };
        let pairs = || references.iter().copied().zip(values.iter().map(|&value| value.into()));
        for (reference, value) in pairs() {
            instance.check_set(reference, value, number)?;
        }
        for (reference, value) in pairs() {
            instance.set(reference, value, number)?;
        }
        OK
    };
    // SAFETY: this function's contract.
    unsafe { call(component, Call::Set, body) }
}

/// Answers for a type of which there is no variable.
///
/// # Safety
/// The importer's contract.
unsafe fn no_such_type(
    component: fmi2Component,
    count: size_t,
    what: Call,
    kind: &str,
) -> fmi2Status {
    let body = |_: &mut Instance| match count {
        0 => OK,
        _ => Err(Error::variable(format!("this FMU has no {kind} variables"))),
    };
    // SAFETY: this function's contract.
    unsafe { call(component, what, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { get(component, references, count, values, Number::Real, |value| value) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut fmi2Integer,
) -> fmi2Status {
    // All integers are small whole numbers, which the conversion keeps.
    #[allow(clippy::cast_possible_truncation)]
    let convert = |value: f64| value as fmi2Integer;
    // SAFETY: the importer's contract.
    unsafe { get(component, references, count, values, Number::Integer, convert) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBoolean(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Get, "Boolean") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetString(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Get, "String") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { set(component, references, count, values, Number::Real) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { set(component, references, count, values, Number::Integer) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetBoolean(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Set, "Boolean") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetString(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Set, "String") }
}

// ---- Saved states ----

/// The saved state behind a handle of ours.
///
/// # Safety
/// `state` is NULL or comes from this library and has not been freed.
unsafe fn saved<'a>(state: fmi2FMUstate) -> Result<&'a SavedInstance, Error> {
    // SAFETY: this function's contract.
    unsafe { state.cast::<SavedInstance>().as_ref() }
        .ok_or_else(|| Error::saved_state("the saved state is NULL"))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract: what stands there is NULL or a saved state of ours, which
        // is then written over.
        unsafe {
            single(state)?;
            match (*state).cast::<SavedInstance>().as_mut() {
                Some(old) => *old = instance.save(),
                None => state.write(Box::into_raw(Box::new(instance.save())).cast()),
            }
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::GetFmuState, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetFMUstate(component: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        instance.restore(unsafe { saved(state) }?)?;
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::SetFmuState, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let body = |_: &mut Instance| {
        if state.is_null() {
            return OK;
        }
        // SAFETY: the importer's contract.
        let state = unsafe { state.replace(ptr::null_mut()) };
        if !state.is_null() {
            // SAFETY: the importer's contract: the handle is ours and is given up here.
            drop(unsafe { Box::from_raw(state.cast::<SavedInstance>()) });
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::FreeFmuState, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: fmi2Component,
    state: fmi2FMUstate,
    size: *mut size_t,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let (state, size) = unsafe { (saved(state)?, single(size)?) };
        size.write(instance.serialize(state)?.len());
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::HeldFmuState, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SerializeFMUstate(
    component: fmi2Component,
    state: fmi2FMUstate,
    serialized: *mut fmi2Byte,
    size: size_t,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let bytes = instance.serialize(unsafe { saved(state) }?)?;
        // SAFETY: the importer's contract.
        let room = unsafe { array_mut(serialized.cast::<u8>(), size) }?;
        let room = room.get_mut(..bytes.len()).ok_or_else(|| {
            Error::saved_state(format!("the state needs {} bytes, not {size}", bytes.len()))
        })?;
        for (place, byte) in room.iter_mut().zip(bytes) {
            place.write(byte);
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::HeldFmuState, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: fmi2Component,
    serialized: *const fmi2Byte,
    size: size_t,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let bytes = unsafe { array(serialized.cast::<u8>(), size) }?;
        let read = instance.deserialize(bytes)?;
        // SAFETY: the importer's contract.
        unsafe { single(state) }?.write(Box::into_raw(Box::new(read)).cast());
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::HeldFmuState, body) }
}

// ---- Co-simulation ----

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DoStep(
    component: fmi2Component,
    current: fmi2Real,
    size: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::DoStep, |instance| instance.do_step(current, size)) }
}

/// Steps are done when `fmi2DoStep` returns: there is none to cancel.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2CancelStep(component: fmi2Component) -> fmi2Status {
    let body = |_: &mut Instance| -> Outcome { Err(Error::call("there is no step to cancel")) };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::CancelStep, body) }
}

// ---- What this FMU does not do, as its model description says ----

/// Refuses a capability that the model description does not declare.
///
/// # Safety
/// The importer's contract.
unsafe fn unsupported(
    component: fmi2Component,
    count: size_t,
    kind: Call,
    what: &str,
) -> fmi2Status {
    let body = |_: &mut Instance| match count {
        0 => OK,
        _ => Err(Error::variable(format!("this FMU gives no {what}"))),
    };
    // SAFETY: this function's contract.
    unsafe { call(component, kind, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: fmi2Component,
    _unknowns: *const fmi2ValueReference,
    unknown_count: size_t,
    _knowns: *const fmi2ValueReference,
    _known_count: size_t,
    _seed: *const fmi2Real,
    _sensitivity: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { unsupported(component, unknown_count, Call::Derivatives, "directional derivatives") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _order: *const fmi2Integer,
    _values: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { unsupported(component, count, Call::Set, "input derivatives") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _order: *const fmi2Integer,
    _values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { unsupported(component, count, Call::Derivatives, "output derivatives") }
}

// ---- Status ----

/// Answers a status query, or discards one that has no answer.
///
/// # Safety
/// The importer's contract.
unsafe fn status<T>(
    component: fmi2Component,
    value: *mut T,
    answer: impl FnOnce(&Instance) -> Option<T>,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: this function's contract.
        let value = unsafe { single(value) }?;
        match answer(instance) {
            Some(answer) => value.write(answer),
            None => return Ok(fmi2Status::fmi2Discard),
        };
        OK
    };
    // SAFETY: this function's contract.
    unsafe { call(component, Call::Status, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStatus(
    component: fmi2Component,
    _kind: fmi2StatusKind,
    value: *mut c_int,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { status(component, value, |_| None) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        status(component, value, |instance| {
            (kind == fmi2LastSuccessfulTime).then(|| instance.last_successful_time())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetIntegerStatus(
    component: fmi2Component,
    _kind: fmi2StatusKind,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { status(component, value, |_| None) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBooleanStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { status(component, value, |_| (kind == fmi2Terminated).then_some(fmi2False)) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetStringStatus(
    component: fmi2Component,
    _kind: fmi2StatusKind,
    value: *mut *const c_char,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { status(component, value, |_| None) }
}
