//! Calls on derivatives: by variables, and of inputs and outputs by time.

use super::instance::Instance;
use super::status::Refused;
use super::{Component, Status};
use libc::{c_int, c_uint, size_t};

impl Instance<'_> {
    /// Returns the derivative of a variable in a direction: known variables by reference, and the change of each.
    pub(crate) fn directional(
        &self,
        unknown: u32,
        direction: &[(u32, f64)],
    ) -> Result<f64, Refused> {
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
        let (knowns, changes): (Vec<u32>, Vec<f64>) = direction.iter().copied().unzip();
        let mut found = 0.0;
        // SAFETY: the component is alive and the arrays are of the lengths that are stated.
        self.succeeded(unsafe {
            function(
                self.component(),
                &raw const unknown,
                1,
                knowns.as_ptr(),
                knowns.len(),
                changes.as_ptr(),
                &raw mut found,
            )
        })
        .map(|()| found)
    }

    /// Returns the first derivatives of outputs by time.
    pub(crate) fn output_derivatives(&self, references: &[u32]) -> Result<Vec<f64>, Refused> {
        let mut found = vec![0.0; references.len()];
        self.by_time::<*mut f64>("fmi2GetRealOutputDerivatives", references, found.as_mut_ptr())?;
        Ok(found)
    }

    /// Sets the first derivatives of inputs by time to zero.
    pub(crate) fn hold_inputs(&self, references: &[u32]) -> Result<(), Refused> {
        let rates = vec![0.0; references.len()];
        self.by_time::<*const f64>("fmi2SetRealInputDerivatives", references, rates.as_ptr())
    }

    /// Calls a function on first derivatives by time. `P` is its type of pointer to one value for each reference.
    fn by_time<P>(&self, name: &str, references: &[u32], values: P) -> Result<(), Refused> {
        type Call<P> =
            unsafe extern "C" fn(Component, *const c_uint, size_t, *const c_int, P) -> Status;
        let function = self.function::<Call<P>>(name)?;
        let orders = vec![1; references.len()];
        // SAFETY: the component is alive, and each array has as many elements as there are references.
        self.succeeded(unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values,
            )
        })
    }
}
