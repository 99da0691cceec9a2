//! An instance and the calls of the standard on it.

use super::callbacks::Callbacks;
use super::status::{Refused, is_warning, succeeded};
use super::{Component, FreeInstance, Library, Status, Text};
use libc::{c_int, c_void, size_t};
use std::cell::Cell;
use std::ffi::CString;
use std::ptr;

type Of = unsafe extern "C" fn(Component) -> Status;

/// An instance of a library; it is freed when dropped.
pub(crate) struct Instance<'a> {
    library: &'a Library,
    component: Component,
    // Some libraries keep the pointers to these.
    _callbacks: Box<Callbacks>,
    _texts: [CString; 3],
    /// `true` after fmi2Fatal or fmi2Pending, when no function may be called any more, not even fmi2FreeInstance.
    is_lost: Cell<bool>,
    /// `true` if a call has returned fmi2Warning since it was last asked.
    has_warned: Cell<bool>,
    /// `true` once a state was saved, to which the host may go back.
    may_go_back: Cell<bool>,
}

/// A state that a library has saved.
pub(crate) struct SavedState(*mut c_void);

impl<'a> Instance<'a> {
    pub(super) fn new(
        library: &'a Library,
        component: Component,
        callbacks: Box<Callbacks>,
        texts: [CString; 3],
    ) -> Self {
        Self {
            library,
            component,
            _callbacks: callbacks,
            _texts: texts,
            is_lost: Cell::new(false),
            has_warned: Cell::new(false),
            may_go_back: Cell::new(false),
        }
    }

    /// The library's own pointer to the instance.
    pub(super) fn component(&self) -> Component {
        self.component
    }

    /// Returns a function of the library; `T` is the type that the standard gives it.
    pub(super) fn function<T: Copy>(&self, name: &str) -> Result<T, Refused> {
        if self.is_lost.get() {
            return Err(Refused::Lost);
        }
        self.library.function(name)
    }

    pub(super) fn succeeded(&self, status: Status) -> Result<(), Refused> {
        let result = succeeded(status);
        if result.is_err_and(Refused::is_last) {
            self.is_lost.set(true);
        }
        if is_warning(status) {
            self.has_warned.set(true);
        }
        result
    }

    /// `true` if a call has returned fmi2Warning since this was last asked.
    pub(crate) fn has_warned(&self) -> bool {
        self.has_warned.take()
    }

    fn call(&self, name: &str) -> Result<(), Refused> {
        let function = self.function::<Of>(name)?;
        // SAFETY: the component is alive.
        self.succeeded(unsafe { function(self.component) })
    }

    pub(crate) fn setup(
        &self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Refused> {
        type Setup = unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> Status;
        let function = self.function::<Setup>("fmi2SetupExperiment")?;
        let given = |value: Option<f64>| (c_int::from(value.is_some()), value.unwrap_or(0.0));
        let ((has_tolerance, tolerance), (has_stop, stop)) = (given(tolerance), given(stop));
        // SAFETY: the component is alive.
        self.succeeded(unsafe {
            function(self.component, has_tolerance, tolerance, start, has_stop, stop)
        })
    }

    pub(crate) fn enter_initialization(&self) -> Result<(), Refused> {
        self.call("fmi2EnterInitializationMode")
    }

    pub(crate) fn exit_initialization(&self) -> Result<(), Refused> {
        self.call("fmi2ExitInitializationMode")
    }

    pub(crate) fn terminate(&self) -> Result<(), Refused> {
        self.call("fmi2Terminate")
    }

    pub(crate) fn reset(&self) -> Result<(), Refused> {
        self.call("fmi2Reset")
    }

    pub(crate) fn step(&self, time: f64, step: f64) -> Result<(), Refused> {
        type Step = unsafe extern "C" fn(Component, f64, f64, c_int) -> Status;
        let function = self.function::<Step>("fmi2DoStep")?;
        let stays = c_int::from(!self.may_go_back.get());
        // SAFETY: the component is alive.
        self.succeeded(unsafe { function(self.component, time, step, stays) })
    }

    /// Turns messages to the logger on or off, of the categories that are given or of all if there are none.
    pub(crate) fn log(&self, on: bool, categories: &[String]) -> Result<(), Refused> {
        type Log = unsafe extern "C" fn(Component, c_int, size_t, *const Text) -> Status;
        let function = self.function::<Log>("fmi2SetDebugLogging")?;
        let texts: Vec<_> =
            categories.iter().filter_map(|text| CString::new(text.as_str()).ok()).collect();
        let pointers: Vec<Text> = texts.iter().map(|text| text.as_ptr()).collect();
        let first = if pointers.is_empty() { ptr::null() } else { pointers.as_ptr() };
        // SAFETY: the component is alive. The array has as many strings as are stated, and outlives the call.
        self.succeeded(unsafe { function(self.component, c_int::from(on), pointers.len(), first) })
    }

    pub(crate) fn save(&self) -> Result<SavedState, Refused> {
        type Save = unsafe extern "C" fn(Component, *mut *mut c_void) -> Status;
        let function = self.function::<Save>("fmi2GetFMUstate")?;
        self.may_go_back.set(true);
        let mut state = SavedState(ptr::null_mut());
        // SAFETY: the component is alive; NULL asks for a new state.
        self.succeeded(unsafe { function(self.component, &raw mut state.0) }).map(|()| state)
    }

    pub(crate) fn restore(&self, state: &SavedState) -> Result<(), Refused> {
        type Restore = unsafe extern "C" fn(Component, *mut c_void) -> Status;
        let function = self.function::<Restore>("fmi2SetFMUstate")?;
        // SAFETY: component and state are alive.
        self.succeeded(unsafe { function(self.component, state.0) })
    }

    /// Frees a state. Returns `true` if the library has set the pointer to it to NULL, as the standard wants.
    pub(crate) fn free(&self, mut state: SavedState) -> Result<bool, Refused> {
        self.free_state(&mut state).map(|()| state.0.is_null())
    }

    /// Frees NULL, which the standard has ignored.
    pub(crate) fn free_no_state(&self) -> Result<(), Refused> {
        self.free_state(&mut SavedState(ptr::null_mut()))
    }

    fn free_state(&self, state: &mut SavedState) -> Result<(), Refused> {
        type FreeState = unsafe extern "C" fn(Component, *mut *mut c_void) -> Status;
        let function = self.function::<FreeState>("fmi2FreeFMUstate")?;
        // SAFETY: the component is alive, and the state is alive or NULL and used no more.
        self.succeeded(unsafe { function(self.component, &raw mut state.0) })
    }

    pub(crate) fn serialize(&self, state: &SavedState) -> Result<Vec<u8>, Refused> {
        type Size = unsafe extern "C" fn(Component, *mut c_void, *mut size_t) -> Status;
        type Serialize = unsafe extern "C" fn(Component, *mut c_void, *mut u8, size_t) -> Status;
        let size_of = self.function::<Size>("fmi2SerializedFMUstateSize")?;
        let function = self.function::<Serialize>("fmi2SerializeFMUstate")?;
        let mut size = 0;
        // SAFETY: component and state are alive.
        self.succeeded(unsafe { size_of(self.component, state.0, &raw mut size) })?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(size).map_err(|_| Refused::Size(size))?;
        bytes.resize(size, 0_u8);
        // SAFETY: as above, and there is room for so many bytes.
        self.succeeded(unsafe { function(self.component, state.0, bytes.as_mut_ptr(), size) })
            .map(|()| bytes)
    }

    pub(crate) fn deserialize(&self, bytes: &[u8]) -> Result<SavedState, Refused> {
        type Deserialize =
            unsafe extern "C" fn(Component, *const u8, size_t, *mut *mut c_void) -> Status;
        let function = self.function::<Deserialize>("fmi2DeSerializeFMUstate")?;
        let mut state = SavedState(ptr::null_mut());
        // SAFETY: the component is alive and there are so many bytes.
        self.succeeded(unsafe {
            function(self.component, bytes.as_ptr(), bytes.len(), &raw mut state.0)
        })
        .map(|()| state)
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        if let Ok(free) = self.function::<FreeInstance>("fmi2FreeInstance") {
            // SAFETY: the component is alive and used no more.
            unsafe { free(self.component) }
        }
    }
}
