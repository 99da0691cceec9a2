//! Inquiry, creation, initialization, reset and termination.

use crate::Error;
use crate::fmi2::boundary::{self, OK, array, call, string};
use crate::fmi2::instance::Instance;
use crate::fmi2::lifecycle::Call;
use crate::fmi2::logger::{Category, Logger};
use crate::fmi2::resources;
use crate::fmi2::types::*;
use libc::size_t;
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;

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
        instance.set_debug_logging(logging_on != fmi2False, &names)?;
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
            return refuse(&logger, "the name of the instance is missing");
        }
        if kind != fmi2CoSimulation {
            return refuse(&logger, "this FMU is for co-simulation only");
        }
        let Some(guid) = guid.and_then(|guid| guid.to_str().ok()) else {
            return refuse(&logger, "the GUID is missing or is not UTF-8");
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
            instance.enter_initialization_mode()?;
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
