//! Reading and writing variables.

use crate::Error;
use crate::fmi2::boundary::{OK, array, array_mut, call};
use crate::fmi2::instance::{Instance, Number};
use crate::fmi2::lifecycle::Call;
use crate::fmi2::types::*;
use libc::size_t;

/// Reads variables of one type.
///
/// # Safety
/// The importer's contract.
unsafe fn get<T>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut T,
    number: Number,
    convert: impl Fn(f64) -> T,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: this function's contract.
        let (references, values) =
            unsafe { (array(references, count)?, array_mut(values, count)?) };
        for (&reference, value) in references.iter().zip(values) {
            value.write(convert(instance.get(reference, number)?));
        }
        OK
    };
    // SAFETY: this function's contract.
    unsafe { call(component, Call::Get, body) }
}

/// Writes variables of one type, all or none.
///
/// # Safety
/// The importer's contract.
unsafe fn set<T: Copy + Into<f64>>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const T,
    number: Number,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: this function's contract.
        let (references, values) = unsafe { (array(references, count)?, array(values, count)?) };
        let pairs = || references.iter().copied().zip(values.iter().map(|&value| value.into()));
        for (reference, value) in pairs() {
            instance.check_set(reference, value, number)?;
        }
        for (reference, value) in pairs() {
            instance.set(reference, value, number)?;
        }
        OK
    };
    // SAFETY: this function's contract.
    unsafe { call(component, Call::Set, body) }
}

/// Answers a call for a type of which the FMU has no variables.
///
/// # Safety
/// The importer's contract.
unsafe fn no_such_type(
    component: fmi2Component,
    count: size_t,
    what: Call,
    kind: &str,
) -> fmi2Status {
    let body = |_: &mut Instance| match count {
        0 => OK,
        _ => Err(Error::variable(format!("this FMU has no {kind} variables"))),
    };
    // SAFETY: this function's contract.
    unsafe { call(component, what, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { get(component, references, count, values, Number::Real, |value| value) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut fmi2Integer,
) -> fmi2Status {
    // All integers are small whole numbers, which the conversion keeps.
    #[allow(clippy::cast_possible_truncation)]
    let convert = |value: f64| value as fmi2Integer;
    // SAFETY: the importer's contract.
    unsafe { get(component, references, count, values, Number::Integer, convert) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetBoolean(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *mut fmi2Boolean,
) -> fmi2Status {
    let convert = |value: f64| fmi2Boolean::from(value != 0.0);
    // SAFETY: the importer's contract.
    unsafe { get(component, references, count, values, Number::Boolean, convert) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetString(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Get, "String") }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { set(component, references, count, values, Number::Real) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { set(component, references, count, values, Number::Integer) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetBoolean(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    values: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { set(component, references, count, values, Number::Boolean) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetString(
    component: fmi2Component,
    _references: *const fmi2ValueReference,
    count: size_t,
    _values: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the importer's contract.
    unsafe { no_such_type(component, count, Call::Set, "String") }
}
