//! Steps, and queries of their status.

use crate::fmi2::boundary::{OK, call, single};
use crate::fmi2::instance::Instance;
use crate::fmi2::lifecycle::Call;
use crate::fmi2::types::*;
use libc::c_int;
use std::ffi::c_char;

// ---- Co-simulation ----

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DoStep(
    component: fmi2Component,
    current: fmi2Real,
    size: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe {
        call(component, Call::DoStep, |instance| {
            instance.do_step(current, size)?;
            OK
        })
    }
}

/// Steps are complete when `fmi2DoStep` returns, so that there is none to cancel.
#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2CancelStep(component: fmi2Component) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::CancelStep, |_| OK) }
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
