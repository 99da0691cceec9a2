//! C types of FMI 2.0 and the functions of an FMU, for programs that link the library of an FMU or load it.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// An instance, or a state of one.
pub type Handle = *mut c_void;
pub type References = *const c_uint;

/// The least of FMI's callbacks: a logger and what it is given first.
#[repr(C)]
pub struct Callbacks {
    pub logger: Option<Logger>,
    pub memory: [Option<unsafe extern "C" fn()>; 2],
    pub step_finished: Option<unsafe extern "C" fn()>,
    pub environment: *mut c_void,
}

/// FMI's logger, with the one variadic argument that this library gives it: on x86-64 Linux that is passed as any
/// other.
pub type Logger = unsafe extern "C" fn(
    *mut c_void,
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const c_char,
);

/// Gives a macro all functions, with the types of their arguments and results.
macro_rules! functions {
    ($declare:ident) => {
        $declare! {
            fmi2GetTypesPlatform() -> *const c_char;
            fmi2GetVersion() -> *const c_char;
            fmi2SetDebugLogging(Handle, c_int, usize, *const *const c_char) -> c_int;
            fmi2Instantiate(*const c_char, c_int, *const c_char, *const c_char, *const Callbacks, c_int, c_int)
                -> Handle;
            fmi2FreeInstance(Handle) -> ();
            fmi2SetupExperiment(Handle, c_int, f64, f64, c_int, f64) -> c_int;
            fmi2EnterInitializationMode(Handle) -> c_int;
            fmi2ExitInitializationMode(Handle) -> c_int;
            fmi2Terminate(Handle) -> c_int;
            fmi2Reset(Handle) -> c_int;
            fmi2GetReal(Handle, References, usize, *mut f64) -> c_int;
            fmi2GetInteger(Handle, References, usize, *mut c_int) -> c_int;
            fmi2GetBoolean(Handle, References, usize, *mut c_int) -> c_int;
            fmi2GetString(Handle, References, usize, *mut *const c_char) -> c_int;
            fmi2SetReal(Handle, References, usize, *const f64) -> c_int;
            fmi2SetInteger(Handle, References, usize, *const c_int) -> c_int;
            fmi2SetBoolean(Handle, References, usize, *const c_int) -> c_int;
            fmi2SetString(Handle, References, usize, *const *const c_char) -> c_int;
            fmi2GetFMUstate(Handle, *mut Handle) -> c_int;
            fmi2SetFMUstate(Handle, Handle) -> c_int;
            fmi2FreeFMUstate(Handle, *mut Handle) -> c_int;
            fmi2SerializedFMUstateSize(Handle, Handle, *mut usize) -> c_int;
            fmi2SerializeFMUstate(Handle, Handle, *mut u8, usize) -> c_int;
            fmi2DeSerializeFMUstate(Handle, *const u8, usize, *mut Handle) -> c_int;
            fmi2GetDirectionalDerivative(Handle, References, usize, References, usize, *const f64, *mut f64) -> c_int;
            fmi2SetRealInputDerivatives(Handle, References, usize, *const c_int, *const f64) -> c_int;
            fmi2GetRealOutputDerivatives(Handle, References, usize, *const c_int, *mut f64) -> c_int;
            fmi2DoStep(Handle, f64, f64, c_int) -> c_int;
            fmi2CancelStep(Handle) -> c_int;
            fmi2GetStatus(Handle, c_int, *mut c_int) -> c_int;
            fmi2GetRealStatus(Handle, c_int, *mut f64) -> c_int;
            fmi2GetIntegerStatus(Handle, c_int, *mut c_int) -> c_int;
            fmi2GetBooleanStatus(Handle, c_int, *mut c_int) -> c_int;
            fmi2GetStringStatus(Handle, c_int, *mut *const c_char) -> c_int;
        }
    };
}
pub(crate) use functions;
