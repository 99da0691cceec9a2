//! The boundary between C and [`Instance`]: handles, arrays, and the catching of panics.
#![allow(unsafe_code)]

use super::instance::Instance;
use super::lifecycle::Call;
use super::logger::Category;
use super::types::{fmi2Component, fmi2Status};
use crate::Error;
use std::any::Any;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Result of a call, before it becomes a status.
pub(super) type Outcome = Result<fmi2Status, Error>;

/// Result of a call that succeeded.
pub(super) const OK: Outcome = Ok(fmi2Status::fmi2OK);

/// Makes a handle of an instance; [`free`] takes it back.
pub(super) fn handle(instance: Instance) -> fmi2Component {
    Box::into_raw(Box::new(instance)).cast()
}

/// Frees an instance; NULL is allowed.
///
/// # Safety
/// `component` comes from [`handle`] and is not used again.
pub(super) unsafe fn free(component: fmi2Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: by this function's contract the handle is one of ours and is given up here.
    let instance = unsafe { Box::from_raw(component.cast::<Instance>()) };
    // A panic while dropping cannot be reported, since the instance is gone.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(instance)));
}

/// Runs a call on an instance if its phase allows it. An error is logged and puts the instance into its error phase;
/// a panic is caught and poisons the instance. A call that succeeds because it is tolerated returns a warning.
///
/// # Safety
/// `component` is NULL or comes from [`handle`] and has not been freed; no other thread is in a
/// call on it.
pub(super) unsafe fn call(
    component: fmi2Component,
    call: Call,
    body: impl FnOnce(&mut Instance) -> Outcome,
) -> fmi2Status {
    // SAFETY: by this function's contract the pointer is NULL or a live instance of ours, and FMI forbids any other
    // use of it during the call.
    let Some(instance) = (unsafe { component.cast::<Instance>().as_mut() }) else {
        return fmi2Status::fmi2Error;
    };
    let result = catch_unwind(AssertUnwindSafe(|| {
        instance.tolerated = false;
        instance.require(call)?;
        body(instance)
    }));
    let (message, panicked) = match result {
        Ok(Ok(fmi2Status::fmi2OK)) if instance.tolerated => return fmi2Status::fmi2Warning,
        Ok(Ok(status)) => return status,
        Ok(Err(error)) => (error.to_string(), false),
        Err(panic) => (format!("internal error: {}", panic_message(&*panic)), true),
    };
    instance.fail(panicked);
    // The logger belongs to the importer; a panic while formatting the message must not cross the boundary either.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        instance.logger.log(fmi2Status::fmi2Error, Category::Error, &message);
    }));
    fmi2Status::fmi2Error
}

pub(super) fn panic_message(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without a message")
}

/// The importer's array; NULL is allowed for an empty one.
///
/// # Safety
/// `pointer` is NULL or points to `length` values that do not change during the call.
pub(super) unsafe fn array<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Error> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer, length)?;
    // SAFETY: not NULL, aligned and not too long, as checked; the rest is this function's contract.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// The importer's array to write to, which may be uninitialized; NULL is allowed for an empty one.
///
/// # Safety
/// `pointer` is NULL or points to room for `length` values that nothing else uses during the call.
pub(super) unsafe fn array_mut<'a, T>(
    pointer: *mut T,
    length: usize,
) -> Result<&'a mut [MaybeUninit<T>], Error> {
    if length == 0 {
        return Ok(&mut []);
    }
    check(pointer, length)?;
    // SAFETY: not NULL, aligned and not too long, as checked; the rest is this function's contract.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), length) })
}

fn check<T>(pointer: *const T, length: usize) -> Result<(), Error> {
    let fits = length <= isize::MAX as usize / size_of::<T>().max(1);
    if !pointer.is_null() && pointer.is_aligned() && fits {
        return Ok(());
    }
    Err(Error::call(format!(
        "the pointer to an array of length {length} is NULL or misaligned, or the array is too long"
    )))
}

/// The importer's pointer to one value to write.
///
/// # Safety
/// `pointer` is NULL or points to room for one value that nothing else uses during the call.
pub(super) unsafe fn single<'a, T>(pointer: *mut T) -> Result<&'a mut MaybeUninit<T>, Error> {
    // SAFETY: this function's contract.
    unsafe { array_mut(pointer, 1) }.map(|array| &mut array[0])
}

/// The importer's string; `None` for NULL.
///
/// # Safety
/// `pointer` is NULL or points to a terminated string that does not change during the call.
pub(super) unsafe fn string<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    // SAFETY: not NULL as checked; terminated by this function's contract.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi2::instance::SCENE_FILE;
    use crate::fmi2::logger::Logger;
    use crate::scene::builtin;
    use crate::simulation::fingerprint;

    fn instance() -> fmi2Component {
        let folder = tempfile::tempdir().unwrap();
        let text = builtin("set1").unwrap().text;
        std::fs::write(folder.path().join(SCENE_FILE), text).unwrap();
        let logger = Logger::new(None, c"one", false);
        let made = Instance::new(folder.path(), &fingerprint(&text.into()), logger);
        handle(made.unwrap_or_else(|(error, _)| panic!("{error}")))
    }

    /// Makes one call on an instance.
    fn make(component: fmi2Component, kind: Call, body: fn() -> Outcome) -> fmi2Status {
        // SAFETY: the instance is alive and used by this thread alone.
        unsafe { call(component, kind, |_| body()) }
    }

    #[test]
    fn a_panic_stops_at_the_boundary_and_poisons_its_instance_alone() {
        let (hit, other) = (instance(), instance());
        assert_eq!(make(hit, Call::Reset, || panic!("on purpose")), fmi2Status::fmi2Error);
        for kind in [Call::Reset, Call::Get, Call::SetFmuState, Call::SetDebugLogging] {
            assert_eq!(make(hit, kind, || OK), fmi2Status::fmi2Error);
        }
        // The importer can still free its instance and its saved states.
        assert_eq!(make(hit, Call::FreeFmuState, || OK), fmi2Status::fmi2OK);
        assert_eq!(make(other, Call::Reset, || OK), fmi2Status::fmi2OK);
        for component in [hit, other, std::ptr::null_mut()] {
            // SAFETY: each is NULL or alive, and not used again.
            unsafe { free(component) };
        }
    }

    #[test]
    fn bad_arrays_are_refused_and_empty_ones_may_be_null() {
        let null = std::ptr::null::<f64>();
        let odd = std::ptr::without_provenance::<f64>(4);
        // SAFETY: an invalid array is refused before it is read.
        unsafe {
            assert_eq!(array(null, 0), Ok(&[][..]));
            assert!(array(null, 1).unwrap_err().is_call());
            assert!(array(odd, 1).unwrap_err().is_call());
            assert!(array(&raw const odd, usize::MAX).unwrap_err().is_call());
        }
    }
}
