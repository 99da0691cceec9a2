//! The interface to the examined library, called as the standard defines it; the only module with these calls.
//!
//! The code relies on the contract of the standard. A library that breaks the contract ends only the worker, a process
//! of its own (see `run`).
#![allow(unsafe_code)]

mod callbacks;
mod derivatives;
#[cfg(unix)]
mod guarded;
mod heap;
mod host;
mod instance;
mod random;
mod status;
mod values;

pub(super) use callbacks::heard;
#[cfg(unix)]
pub(super) use guarded::Side;
pub(super) use heap::heap;
pub(super) use host::HostSettings;
pub(super) use instance::{Instance, SavedState};
pub(super) use random::seed;
pub(super) use status::Refused;
pub(super) use values::{Value, function};

use callbacks::Callbacks;
use libc::{c_char, c_int, c_void};
use std::ffi::{CStr, CString};
use std::path::Path;
use std::ptr;

type Component = *mut c_void;
type Status = c_int;
type Text = *const c_char;
type Instantiate =
    unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks, c_int, c_int) -> Component;
type FreeInstance = unsafe extern "C" fn(Component);

/// A loaded library.
pub(super) struct Library(libloading::Library);

impl Library {
    /// Loads a library with all libraries that it needs.
    ///
    /// # Errors
    /// Returns the message of the system's loader if the library cannot be loaded.
    pub(super) fn load(path: &Path) -> Result<Self, String> {
        // SAFETY: this runs the library's initializers, in a process that exists for this purpose only.
        #[cfg(unix)]
        let library = unsafe {
            use libloading::os::unix;
            unix::Library::open(Some(path), unix::RTLD_NOW | unix::RTLD_LOCAL).map(Into::into)
        };
        // SAFETY: as above.
        #[cfg(not(unix))]
        let library = unsafe { libloading::Library::new(path) };
        library.map(Self).map_err(|error| {
            // The cause of the error is the loader's own message.
            std::error::Error::source(&error).map_or(error.to_string(), ToString::to_string)
        })
    }

    /// Returns a function of the library; `T` is the type that the standard gives it.
    fn function<T: Copy>(&self, name: &str) -> Result<T, Refused> {
        // SAFETY: `T` is the type of the function of this name.
        unsafe { self.0.get::<T>(name.as_bytes()) }
            .map(|symbol| *symbol)
            .map_err(|_| Refused::Missing)
    }

    /// Returns the answer of `fmi2GetTypesPlatform` or `fmi2GetVersion`.
    pub(super) fn answer(&self, name: &str) -> String {
        let Ok(function) = self.function::<unsafe extern "C" fn() -> Text>(name) else {
            return "nothing (it is not exported)".to_owned();
        };
        // SAFETY: the function takes nothing and returns a string that stays.
        let text = unsafe { function() };
        if text.is_null() {
            return "NULL".to_owned();
        }
        // SAFETY: as above.
        unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
    }

    /// Calls `fmi2FreeInstance(NULL)`.
    pub(super) fn free_null(&self) {
        if let Ok(free) = self.function::<FreeInstance>("fmi2FreeInstance") {
            // SAFETY: the standard requires that this call is ignored.
            unsafe { free(ptr::null_mut()) }
        }
    }

    /// Makes an instance for co-simulation; `None` if the library returns NULL.
    pub(super) fn instantiate(&self, arguments: &Arguments<'_>) -> Option<Instance<'_>> {
        let Arguments { guid, location, memory_callbacks, logging } = *arguments;
        let make = self.function::<Instantiate>("fmi2Instantiate").ok()?;
        let texts = [c"check".to_owned(), CString::new(guid).ok()?, CString::new(location).ok()?];
        let callbacks = Box::new(Callbacks::new(memory_callbacks));
        let [name, guid, location] = texts.each_ref().map(|text| text.as_ptr());
        // SAFETY: strings and callbacks are as the standard wants them and outlive the instance.
        let component = unsafe {
            make(name, 1, guid, location, &raw const *callbacks, 0, c_int::from(logging))
        };
        (!component.is_null()).then(|| Instance::new(self, component, callbacks, texts))
    }
}

/// Arguments of `fmi2Instantiate`.
#[derive(Clone, Copy)]
pub(super) struct Arguments<'a> {
    pub(super) guid: &'a str,
    /// URI of the resources.
    pub(super) location: &'a str,
    /// `false` for NULL in their place.
    pub(super) memory_callbacks: bool,
    pub(super) logging: bool,
}
