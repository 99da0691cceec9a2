//! A library of others, called as the standard says; the only place where it is.
//!
//! Whatever it does happens in a process of its own (see the module above): what is relied on here is
//! the standard's contract, and where a library breaks it that process ends.
#![allow(unsafe_code)]

use libc::{c_char, c_int, c_uint, c_void, size_t};
use std::ffi::{CStr, CString};
use std::path::Path;
use std::ptr;
use std::sync::Mutex;

type Component = *mut c_void;
type Status = c_int;
type Text = *const c_char;
type Logger = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, Text);
type Instantiate =
    unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks, c_int, c_int) -> Component;
type Of = unsafe extern "C" fn(Component) -> Status;
type Get<T> = unsafe extern "C" fn(Component, *const c_uint, size_t, *mut T) -> Status;

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: Option<Logger>,
    allocate: Option<unsafe extern "C" fn(size_t, size_t) -> *mut c_void>,
    free: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    environment: *mut c_void,
}

/// What the logger heard last.
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
    } else if message.to_bytes().contains(&b'%') {
        return;
    } else {
        message.to_string_lossy()
    };
    if let Ok(mut heard) = HEARD.lock() {
        text.chars().take(300).collect::<String>().clone_into(&mut heard);
    }
}

/// What the logger was told last, taken away.
pub(super) fn heard() -> String {
    HEARD.lock().map(|mut heard| std::mem::take(&mut *heard)).unwrap_or_default()
}

/// A call that did not succeed, by its status's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Refused(Status);

impl Refused {
    pub(super) fn is_discard(self) -> bool {
        self.0 == 2
    }

    pub(super) fn is_pending(self) -> bool {
        self.0 == 5
    }

    pub(super) fn name(self) -> String {
        match self.0 {
            2 => "fmi2Discard".to_owned(),
            3 => "fmi2Error".to_owned(),
            4 => "fmi2Fatal".to_owned(),
            5 => "fmi2Pending".to_owned(),
            other => format!("{other}, which is no status"),
        }
    }
}

fn succeeded(status: Status) -> Result<(), Refused> {
    if matches!(status, 0 | 1) { Ok(()) } else { Err(Refused(status)) }
}

/// A loaded library.
pub(super) struct Library(libloading::Library);

impl Library {
    /// Loads a library with all that it needs.
    ///
    /// # Errors
    /// What the system's loader says.
    pub(super) fn load(path: &Path) -> Result<Self, String> {
        // SAFETY: this runs the library's initializers, in a process that is there for nothing else.
        #[cfg(unix)]
        let library = unsafe {
            use libloading::os::unix;
            unix::Library::open(Some(path), unix::RTLD_NOW | unix::RTLD_LOCAL).map(Into::into)
        };
        // SAFETY: as above.
        #[cfg(not(unix))]
        let library = unsafe { libloading::Library::new(path) };
        library.map(Self).map_err(|error| {
            // The loader's own words are the cause.
            std::error::Error::source(&error).map_or(error.to_string(), ToString::to_string)
        })
    }

    /// A function of the type that the standard gives it.
    fn function<T: Copy>(&self, name: &str) -> Result<T, Refused> {
        // SAFETY: `T` is the type of the function of this name.
        unsafe { self.0.get::<T>(name.as_bytes()) }.map(|symbol| *symbol).map_err(|_| Refused(-1))
    }

    /// The answer of `fmi2GetTypesPlatform` or `fmi2GetVersion`.
    pub(super) fn answer(&self, name: &str) -> String {
        let Ok(function) = self.function::<unsafe extern "C" fn() -> Text>(name) else {
            return "nothing: it is not exported".to_owned();
        };
        // SAFETY: the function takes nothing and returns a string that stays.
        let text = unsafe { function() };
        if text.is_null() {
            return "NULL".to_owned();
        }
        // SAFETY: as above.
        unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
    }

    /// `fmi2FreeInstance(NULL)`.
    pub(super) fn free_null(&self) {
        if let Ok(free) = self.function::<unsafe extern "C" fn(Component)>("fmi2FreeInstance") {
            // SAFETY: the standard has this call ignored.
            unsafe { free(ptr::null_mut()) }
        }
    }

    /// An instance for co-simulation; none where the library makes none.
    pub(super) fn instantiate(
        &self,
        guid: &str,
        location: &str,
        memory_callbacks: bool,
    ) -> Option<Instance<'_>> {
        let make = self.function::<Instantiate>("fmi2Instantiate").ok()?;
        let texts = [c"check".to_owned(), CString::new(guid).ok()?, CString::new(location).ok()?];
        let callbacks = Box::new(Callbacks {
            logger: Some(logger),
            allocate: memory_callbacks.then_some(libc::calloc as _),
            free: memory_callbacks.then_some(libc::free as _),
            step_finished: None,
            environment: ptr::null_mut(),
        });
        let [name, guid, location] = texts.each_ref().map(|text| text.as_ptr());
        // SAFETY: strings and callbacks are as the standard wants them and outlive the instance.
        let component = unsafe { make(name, 1, guid, location, &raw const *callbacks, 0, 0) };
        (!component.is_null()).then_some(Instance {
            library: self,
            component,
            _callbacks: callbacks,
            _texts: texts,
        })
    }
}

/// An instance of a library, freed with its end.
pub(super) struct Instance<'a> {
    library: &'a Library,
    component: Component,
    // Some libraries keep the pointers.
    _callbacks: Box<Callbacks>,
    _texts: [CString; 3],
}

/// A state that a library has saved.
pub(super) struct State(*mut c_void);

impl Instance<'_> {
    fn call(&self, name: &str) -> Result<(), Refused> {
        let function = self.library.function::<Of>(name)?;
        // SAFETY: the component is alive.
        succeeded(unsafe { function(self.component) })
    }

    pub(super) fn setup(
        &self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Refused> {
        type Setup = unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> Status;
        let function = self.library.function::<Setup>("fmi2SetupExperiment")?;
        let given = |value: Option<f64>| (c_int::from(value.is_some()), value.unwrap_or(0.0));
        let ((has_tolerance, tolerance), (has_stop, stop)) = (given(tolerance), given(stop));
        // SAFETY: the component is alive.
        succeeded(unsafe {
            function(self.component, has_tolerance, tolerance, start, has_stop, stop)
        })
    }

    pub(super) fn enter_initialization(&self) -> Result<(), Refused> {
        self.call("fmi2EnterInitializationMode")
    }

    pub(super) fn exit_initialization(&self) -> Result<(), Refused> {
        self.call("fmi2ExitInitializationMode")
    }

    pub(super) fn terminate(&self) -> Result<(), Refused> {
        self.call("fmi2Terminate")
    }

    pub(super) fn reset(&self) -> Result<(), Refused> {
        self.call("fmi2Reset")
    }

    pub(super) fn step(&self, time: f64, step: f64) -> Result<(), Refused> {
        type Step = unsafe extern "C" fn(Component, f64, f64, c_int) -> Status;
        let function = self.library.function::<Step>("fmi2DoStep")?;
        // SAFETY: the component is alive.
        succeeded(unsafe { function(self.component, time, step, 0) })
    }

    fn get<T: Copy>(
        &self,
        name: &str,
        references: &[u32],
        values: &mut [T],
    ) -> Result<(), Refused> {
        let function = self.library.function::<Get<T>>(name)?;
        assert_eq!(references.len(), values.len());
        // SAFETY: the component is alive and the arrays are of the length that is stated.
        succeeded(unsafe {
            function(self.component, references.as_ptr(), references.len(), values.as_mut_ptr())
        })
    }

    pub(super) fn reals(&self, references: &[u32]) -> Result<Vec<f64>, Refused> {
        let mut values = vec![0.0_f64; references.len()];
        self.get("fmi2GetReal", references, &mut values).map(|()| values)
    }

    pub(super) fn integers(&self, references: &[u32]) -> Result<Vec<i32>, Refused> {
        let mut values = vec![0_i32; references.len()];
        self.get("fmi2GetInteger", references, &mut values).map(|()| values)
    }

    pub(super) fn booleans(&self, references: &[u32]) -> Result<Vec<i32>, Refused> {
        let mut values = vec![0_i32; references.len()];
        self.get("fmi2GetBoolean", references, &mut values).map(|()| values)
    }

    pub(super) fn strings(&self, references: &[u32]) -> Result<Vec<String>, Refused> {
        let mut values: Vec<Text> = vec![ptr::null(); references.len()];
        self.get("fmi2GetString", references, &mut values)?;
        // SAFETY: the strings are valid until the next call.
        let text = |value: &Text| unsafe { CStr::from_ptr(*value) }.to_string_lossy().into_owned();
        Ok(values
            .iter()
            .map(|value| if value.is_null() { String::new() } else { text(value) })
            .collect())
    }

    pub(super) fn save(&self) -> Result<State, Refused> {
        type Save = unsafe extern "C" fn(Component, *mut *mut c_void) -> Status;
        let function = self.library.function::<Save>("fmi2GetFMUstate")?;
        let mut state = State(ptr::null_mut());
        // SAFETY: the component is alive; NULL asks for a new state.
        succeeded(unsafe { function(self.component, &raw mut state.0) }).map(|()| state)
    }

    pub(super) fn restore(&self, state: &State) -> Result<(), Refused> {
        type Restore = unsafe extern "C" fn(Component, *mut c_void) -> Status;
        let function = self.library.function::<Restore>("fmi2SetFMUstate")?;
        // SAFETY: component and state are alive.
        succeeded(unsafe { function(self.component, state.0) })
    }

    pub(super) fn free(&self, mut state: State) -> Result<(), Refused> {
        type Free = unsafe extern "C" fn(Component, *mut *mut c_void) -> Status;
        let function = self.library.function::<Free>("fmi2FreeFMUstate")?;
        // SAFETY: component and state are alive, and the state is used no more.
        succeeded(unsafe { function(self.component, &raw mut state.0) })
    }

    pub(super) fn serialize(&self, state: &State) -> Result<Vec<u8>, Refused> {
        type Size = unsafe extern "C" fn(Component, *mut c_void, *mut size_t) -> Status;
        type Serialize = unsafe extern "C" fn(Component, *mut c_void, *mut u8, size_t) -> Status;
        let size_of = self.library.function::<Size>("fmi2SerializedFMUstateSize")?;
        let function = self.library.function::<Serialize>("fmi2SerializeFMUstate")?;
        let mut size = 0;
        // SAFETY: component and state are alive.
        succeeded(unsafe { size_of(self.component, state.0, &raw mut size) })?;
        let mut bytes = vec![0_u8; size];
        // SAFETY: as above, and there is room for so many bytes.
        succeeded(unsafe { function(self.component, state.0, bytes.as_mut_ptr(), size) })
            .map(|()| bytes)
    }

    pub(super) fn deserialize(&self, bytes: &[u8]) -> Result<State, Refused> {
        type Deserialize =
            unsafe extern "C" fn(Component, *const u8, size_t, *mut *mut c_void) -> Status;
        let function = self.library.function::<Deserialize>("fmi2DeSerializeFMUstate")?;
        let mut state = State(ptr::null_mut());
        // SAFETY: the component is alive and there are so many bytes.
        succeeded(unsafe {
            function(self.component, bytes.as_ptr(), bytes.len(), &raw mut state.0)
        })
        .map(|()| state)
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        if let Ok(free) =
            self.library.function::<unsafe extern "C" fn(Component)>("fmi2FreeInstance")
        {
            // SAFETY: the component is alive and used no more.
            unsafe { free(self.component) }
        }
    }
}

/// Bytes of the heap that are in use, where the C library can tell.
pub(super) fn heap() -> Option<usize> {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        type Ask = unsafe extern "C" fn() -> libc::mallinfo2;
        let process = libloading::os::unix::Library::this();
        // Looked up: glibc has it since 2.33 only.
        // SAFETY: the function is of this type.
        let ask = unsafe { process.get::<Ask>(b"mallinfo2") }.ok()?;
        // SAFETY: it only reads the allocator's counts.
        let info = unsafe { ask() };
        Some(info.uordblks + info.hblkhd)
    }
    #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
    None
}
