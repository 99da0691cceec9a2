//! The callbacks that a library may use: a logger and memory functions.

use super::{Status, Text};
use libc::{c_void, size_t};
use std::ffi::CStr;
use std::ptr;
use std::sync::Mutex;

type Logger = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, Text);

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub(super) struct Callbacks {
    logger: Option<Logger>,
    allocate: Option<unsafe extern "C" fn(size_t, size_t) -> *mut c_void>,
    free: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    environment: *mut c_void,
}

impl Callbacks {
    /// Callbacks with a logger that keeps the last message; with `memory`, the C library's memory functions, otherwise
    /// NULL.
    pub(super) fn new(memory: bool) -> Self {
        Self {
            logger: Some(logger),
            allocate: memory.then_some(libc::calloc as _),
            free: memory.then_some(libc::free as _),
            step_finished: None,
            environment: ptr::null_mut(),
        }
    }
}

/// The last message to the logger.
static HEARD: Mutex<String> = Mutex::new(String::new());

extern "C" fn logger(_: *mut c_void, _: Text, _: Status, _: Text, message: Text, first: Text) {
    if message.is_null() {
        return;
    }
    // SAFETY: the library's contract: a string that is valid during this call.
    let message = unsafe { CStr::from_ptr(message) };
    let text = if message == c"%s" && cfg!(target_arch = "x86_64") && !first.is_null() {
        // SAFETY: such a message has one variadic argument, a string, which x86_64 passes like any other.
        unsafe { CStr::from_ptr(first) }.to_string_lossy()
    } else {
        // Other arguments are not read: a format is quoted as it is.
        message.to_string_lossy()
    };
    if let Ok(mut heard) = HEARD.lock() {
        text.chars().take(300).collect::<String>().clone_into(&mut heard);
    }
}

/// Takes the last message to the logger; empty if there is none.
pub(crate) fn heard() -> String {
    HEARD.lock().map(|mut heard| std::mem::take(&mut *heard)).unwrap_or_default()
}
