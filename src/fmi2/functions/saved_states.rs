//! Saved states, in memory and as bytes.

use crate::Error;
use crate::fmi2::boundary::{OK, array, array_mut, call, single};
use crate::fmi2::instance::{Instance, SavedInstance};
use crate::fmi2::lifecycle::Call;
use crate::fmi2::types::*;
use libc::size_t;
use std::ptr;

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
        // SAFETY: the importer's contract: the pointer holds NULL or a saved state of ours, which is then overwritten.
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
            Error::saved_state(format!(
                "the saved state needs {} bytes, but the buffer has only {size}",
                bytes.len()
            ))
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
