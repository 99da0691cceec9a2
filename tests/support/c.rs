//! The functions of the FMU's library, for tests that link it.
#![allow(dead_code, unsafe_code)] // No test needs all, and they are C's.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// An instance, or a state of one.
pub type Handle = *mut c_void;

unsafe extern "C" {
    pub fn fmi2Instantiate(
        name: *const c_char,
        kind: c_int,
        guid: *const c_char,
        resources: *const c_char,
        callbacks: *const c_void,
        visible: c_int,
        logging_on: c_int,
    ) -> Handle;
    pub fn fmi2SetupExperiment(
        it: Handle,
        tolerance_defined: c_int,
        tolerance: f64,
        start: f64,
        stop_defined: c_int,
        stop: f64,
    ) -> c_int;
    pub fn fmi2EnterInitializationMode(it: Handle) -> c_int;
    pub fn fmi2ExitInitializationMode(it: Handle) -> c_int;
    pub fn fmi2DoStep(it: Handle, now: f64, size: f64, no_return: c_int) -> c_int;
    pub fn fmi2GetReal(
        it: Handle,
        references: *const c_uint,
        count: usize,
        values: *mut f64,
    ) -> c_int;
    pub fn fmi2GetInteger(
        it: Handle,
        references: *const c_uint,
        count: usize,
        values: *mut c_int,
    ) -> c_int;
    pub fn fmi2SetReal(
        it: Handle,
        references: *const c_uint,
        count: usize,
        values: *const f64,
    ) -> c_int;
    pub fn fmi2GetFMUstate(it: Handle, state: *mut Handle) -> c_int;
    pub fn fmi2SetFMUstate(it: Handle, state: Handle) -> c_int;
    pub fn fmi2FreeFMUstate(it: Handle, state: *mut Handle) -> c_int;
    pub fn fmi2SerializedFMUstateSize(it: Handle, state: Handle, size: *mut usize) -> c_int;
    pub fn fmi2SerializeFMUstate(it: Handle, state: Handle, bytes: *mut u8, size: usize) -> c_int;
    pub fn fmi2DeSerializeFMUstate(
        it: Handle,
        bytes: *const u8,
        size: usize,
        state: *mut Handle,
    ) -> c_int;
    pub fn fmi2FreeInstance(it: Handle);
}
