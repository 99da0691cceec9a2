//! Calls on derivatives: by variables, and of inputs and outputs by time.

use super::instance::Instance;
use super::status::Refused;
use super::{Component, Status};
use libc::{c_int, c_uint, size_t};

impl Instance<'_> {
    /// Returns the derivative of one variable by another.
    pub(crate) fn directional(&self, unknown: u32, known: u32) -> Result<f64, Refused> {
        type Ask = unsafe extern "C" fn(
            Component,
            *const c_uint,
            size_t,
            *const c_uint,
            size_t,
            *const f64,
            *mut f64,
        ) -> Status;
        let function = self.function::<Ask>("fmi2GetDirectionalDerivative")?;
        let (direction, mut found) = (1.0, 0.0);
        // SAFETY: the component is alive and each array has one element.
        self.succeeded(unsafe {
            function(
                self.component(),
                &raw const unknown,
                1,
                &raw const known,
                1,
                &raw const direction,
                &raw mut found,
            )
        })
        .map(|()| found)
    }

    /// Returns the first derivatives of outputs by time.
    pub(crate) fn output_derivatives(&self, references: &[u32]) -> Result<Vec<f64>, Refused> {
        type Ask = unsafe extern "C" fn(
            Component,
            *const c_uint,
            size_t,
            *const c_int,
            *mut f64,
        ) -> Status;
        let function = self.function::<Ask>("fmi2GetRealOutputDerivatives")?;
        let orders = vec![1; references.len()];
        let mut found = vec![0.0; references.len()];
        // SAFETY: the component is alive and the arrays are of the length that is stated.
        self.succeeded(unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                found.as_mut_ptr(),
            )
        })
        .map(|()| found)
    }

    /// Sets the first derivatives of inputs by time to zero.
    pub(crate) fn hold_inputs(&self, references: &[u32]) -> Result<(), Refused> {
        type Set = unsafe extern "C" fn(
            Component,
            *const c_uint,
            size_t,
            *const c_int,
            *const f64,
        ) -> Status;
        let function = self.function::<Set>("fmi2SetRealInputDerivatives")?;
        let (orders, rates) = (vec![1; references.len()], vec![0.0; references.len()]);
        // SAFETY: as above.
        self.succeeded(unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                rates.as_ptr(),
            )
        })
    }
}
