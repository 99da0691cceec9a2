//! Derivatives of first order that an instance returns and accepts.

use super::{Instance, Number};
use crate::Error;
use crate::simulation::{Variable, check_rate};

impl Instance {
    /// Immediate changes of outputs due to these changes of inputs; before a run starts they include the effect of
    /// the equilibrium from which it starts.
    pub(in crate::fmi2) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        changes: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let places = self.reals(unknowns)?;
        let by = self.reals(knowns)?;
        for (&place, change) in by.iter().zip(changes) {
            if !change.is_finite() {
                let name = &self.variables[place].name;
                return Err(Error::variable(format!(
                    "the change of {name} is {change:?}, but must be finite"
                )));
            }
        }
        self.start()?;
        let is_set_up = self.is_set_up();
        let Self { simulation, variables, .. } = self;
        let simulation = simulation.as_mut().expect("just made");
        let of: Vec<&Variable> = places.iter().map(|&place| &variables[place]).collect();
        let by = by.into_iter().map(|place| &variables[place]);
        let by: Vec<(&Variable, f64)> = by.zip(changes.iter().copied()).collect();
        let found = if is_set_up {
            simulation.directional_derivative_at_start(&of, &by)?
        } else {
            simulation.directional_derivative(&of, &by)?
        };
        self.answer(found, &places)
    }

    /// Rates of change of outputs now, per second.
    pub(in crate::fmi2) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
    ) -> Result<Vec<f64>, Error> {
        check_orders(orders)?;
        let places = self.reals(references)?;
        self.start()?;
        let Self { simulation, variables, .. } = self;
        let simulation = simulation.as_mut().expect("just made");
        let of: Vec<&Variable> = places.iter().map(|&place| &variables[place]).collect();
        let found = simulation.rates(&of)?;
        self.answer(found, &places)
    }

    /// Sets the rates of change of inputs during the next step, per second; all or none.
    pub(in crate::fmi2) fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Error> {
        check_orders(orders)?;
        let places = self.reals(references)?;
        for (&place, &rate) in places.iter().zip(values) {
            check_rate(&self.variables[place], rate)?;
        }
        for (&place, &rate) in places.iter().zip(values) {
            if self.is_set_up() {
                self.setup.rates.retain(|(known, _)| *known != place);
                self.setup.rates.push((place, rate));
            } else {
                let simulation = self.simulation.as_mut().expect("made when initialization ended");
                simulation.set_rate(&self.variables[place], rate)?;
            }
        }
        Ok(())
    }

    /// Passes the rates that were set before to a simulation that has just been made.
    pub(super) fn start_rates(&mut self) -> Result<(), Error> {
        let Some(simulation) = &mut self.simulation else { return Ok(()) };
        for (place, rate) in self.setup.rates.drain(..) {
            simulation.set_rate(&self.variables[place], rate)?;
        }
        Ok(())
    }

    /// Refuses derivatives that are not finite.
    fn answer(&self, found: Vec<f64>, of: &[usize]) -> Result<Vec<f64>, Error> {
        match found.iter().zip(of).find(|(value, _)| !value.is_finite()) {
            None => Ok(found),
            Some((_, &place)) => Err(Error::step(format!(
                "the derivative of {} is not a finite number",
                self.variables[place].name
            ))),
        }
    }

    /// Indices of the Real variables in the list.
    fn reals(&self, references: &[u32]) -> Result<Vec<usize>, Error> {
        references.iter().map(|&reference| self.find(reference, Number::Real)).collect()
    }
}

fn check_orders(orders: &[i32]) -> Result<(), Error> {
    match orders.iter().find(|order| **order != 1) {
        None => Ok(()),
        Some(order) => Err(Error::variable(format!(
            "derivatives of order {order} are not supported, only those of order 1"
        ))),
    }
}
