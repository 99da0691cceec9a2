//! Derivatives: of outputs by inputs and by time, and of inputs by time.

use crate::fmi2::boundary::{OK, array, array_mut, call};
use crate::fmi2::instance::Instance;
use crate::fmi2::lifecycle::Call;
use crate::fmi2::types::*;
use libc::size_t;

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: fmi2Component,
    unknowns: *const fmi2ValueReference,
    unknown_count: size_t,
    knowns: *const fmi2ValueReference,
    known_count: size_t,
    changes: *const fmi2Real,
    sensitivities: *mut fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let (unknowns, knowns, changes, room) = unsafe {
            (
                array(unknowns, unknown_count)?,
                array(knowns, known_count)?,
                array(changes, known_count)?,
                array_mut(sensitivities, unknown_count)?,
            )
        };
        let found = instance.directional_derivative(unknowns, knowns, changes)?;
        for (place, value) in room.iter_mut().zip(found) {
            place.write(value);
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::DirectionalDerivative, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    orders: *const fmi2Integer,
    values: *const fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let (references, orders, values) =
            unsafe { (array(references, count)?, array(orders, count)?, array(values, count)?) };
        instance.set_input_derivatives(references, orders, values)?;
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::InputDerivatives, body) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: size_t,
    orders: *const fmi2Integer,
    values: *mut fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance| {
        // SAFETY: the importer's contract.
        let (references, orders, room) = unsafe {
            (array(references, count)?, array(orders, count)?, array_mut(values, count)?)
        };
        let found = instance.output_derivatives(references, orders)?;
        for (place, value) in room.iter_mut().zip(found) {
            place.write(value);
        }
        OK
    };
    // SAFETY: the importer's contract.
    unsafe { call(component, Call::OutputDerivatives, body) }
}
