//! Rates of inputs, for importers that know how an input changes during their next step.

use super::catalogue::Causality;
use super::signals::{DrivenInputs, InputRamp};
use super::{Parameters, Simulation, Variable};
use crate::Error;
use serde::{Deserialize, Serialize};

/// The rate of an input as stored in a saved state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SavedRate {
    /// Index of the input's value among those of the parameters.
    place: usize,
    ramp: InputRamp,
}

impl Simulation {
    /// Lets an input change by `rate`, per second, from now on to the end of the next advance; after that it keeps
    /// the value that it has reached. The paper's scheme takes forces and friction from step to step, event-driven motion
    /// lets all inputs change linearly.
    ///
    /// # Errors
    /// Returns an error if the variable is not an input, or the rate is not a finite number.
    pub fn set_rate(&mut self, variable: &Variable, rate: f64) -> Result<(), Error> {
        check_rate(variable, rate)?;
        let origin = self.clock.grid_time(self.scene.step);
        let place = self.nominal.place(variable).expect("inputs are among the parameters");
        self.set_ramp(place, InputRamp { origin, rate, is_over: false });
        self.stale.by(variable);
        Ok(())
    }

    fn set_ramp(&mut self, place: usize, ramp: InputRamp) {
        let (scene, nominal) = (&self.scene, &self.nominal);
        let driven = self.driven.get_or_insert_with(|| DrivenInputs::new(scene, nominal));
        driven.set_ramp(place, ramp, scene, nominal);
    }

    /// Begins an advance to time `end` (s) and drops the rates of the previous one.
    ///
    /// # Errors
    /// Returns an error if a rate leads to an impossible value.
    pub(super) fn begin_rates(&mut self, end: f64) -> Result<(), Error> {
        let Some(driven) = &mut self.driven else { return Ok(()) };
        driven.check_ramps(end, &self.nominal)?;
        driven.drop_ramps(false);
        Ok(())
    }

    /// Ends an advance: the values that the rates have reached become the nominal ones.
    pub(super) fn end_rates(&mut self) {
        let end = self.clock.grid_time(self.scene.step);
        if let Some(driven) = &mut self.driven {
            driven.end_ramps(end, &mut self.nominal);
        }
    }

    /// The rates of inputs, to be stored in a saved state.
    pub(super) fn saved_rates(&self) -> Vec<SavedRate> {
        let ramps = self.driven.iter().flat_map(DrivenInputs::ramps);
        ramps.map(|(place, ramp)| SavedRate { place, ramp }).collect()
    }

    /// Replaces the present rates by those of a saved state.
    pub(super) fn take_over_rates(&mut self, saved: &[SavedRate]) {
        if let Some(driven) = &mut self.driven {
            driven.drop_ramps(true);
            driven.restart(&self.nominal, &mut self.scene);
        }
        saved.iter().for_each(|rate| self.set_ramp(rate.place, rate.ramp));
    }
}

/// `true` if these rates belong to inputs among the parameters and can occur in a run.
pub(super) fn belong_to(saved: &[SavedRate], parameters: &Parameters) -> bool {
    saved.iter().all(|&SavedRate { place, ramp }| {
        ramp.origin.is_finite()
            && parameters
                .variable(place)
                .is_some_and(|variable| check_rate(variable, ramp.rate).is_ok())
    })
}

/// Refuses a rate that a variable cannot have.
///
/// # Errors
/// Returns an error if the variable is not an input, or the rate is not a finite number.
pub(crate) fn check_rate(variable: &Variable, rate: f64) -> Result<(), Error> {
    let name = &variable.name;
    if variable.causality != Causality::Input {
        return Err(Error::variable(format!(
            "the rate of {name} cannot be set: it is not an input"
        )));
    }
    if !rate.is_finite() {
        return Err(Error::variable(format!("the rate of {name} is {rate:?}, but must be finite")));
    }
    Ok(())
}
