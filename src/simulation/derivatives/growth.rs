//! The changes of growth rate and frequency of the present contact state.

use super::Change;
use super::slope::Slope;
use crate::Error;
use crate::contact::ContactState;
use crate::simulation::monitor::linearised;
use crate::simulation::{Simulation, signals};
use crate::stability::{SlidingChange, eigenvalue_change};
use nalgebra::Complex;
use std::f64::consts::TAU;

impl Simulation {
    /// What the largest growth rate, 1/s, and its mode's frequency, Hz, change by. They follow friction, which in
    /// uniform sliding depends on the coefficients and, of a law that falls with the slip velocity, on v; zero
    /// where there are no modes. Not numbers where two modes coalesce: there is no derivative.
    ///
    /// # Errors
    /// Contact forces that have no solution.
    pub(super) fn growth_change(&mut self, change: &Change) -> Result<[f64; 2], Error> {
        let outlook = self.outlook()?;
        if outlook.modes <= 0 {
            return Ok([0.0; 2]);
        }
        let eigenvalue = Complex::new(outlook.growth_rate, TAU * outlook.frequency);
        let states: Vec<ContactState> =
            self.contact_forces.iter().map(|force| force.state).collect();
        let (friction, common) = (self.acting().friction(), self.acting().slider.velocity);
        let falls = self.model.law.friction.about().falls;
        let sliding: Vec<SlidingChange> = self
            .model
            .contacts
            .iter()
            .enumerate()
            .map(|(i, contact)| {
                let (surface, coefficients) =
                    (contact.velocity(common), contact.coefficients(friction));
                let slope = Slope::with_sign(self.model.law, coefficients, surface, 1.0);
                let (dv, by) = (change.slider_velocity[i], change.friction[i]);
                let weakening = falls.map_or(0.0, |falls| {
                    let normal = self.reference.equilibrium.normal_force[i];
                    let [kinetic, static_] = (falls.slope_by_coefficients)(coefficients, surface);
                    let curvature = (falls.curvature)(coefficients, surface) * surface.signum();
                    let slope = curvature * dv + kinetic * by[0] + static_ * by[1];
                    normal * slope + change.reference[i][0] * (falls.slope)(coefficients, surface)
                });
                SlidingChange { friction: slope.change(dv, by), weakening }
            })
            .collect();
        if sliding.iter().all(|change| *change == SlidingChange::default()) {
            return Ok([0.0; 2]);
        }
        let acting = signals::acting(self.driven.as_ref(), &self.scene);
        let equilibrium = &self.reference.equilibrium;
        let found = linearised(&mut self.model, equilibrium, acting, |model, common| {
            eigenvalue_change(model, &states, common, eigenvalue, &sliding)
        });
        Ok(found.map_or([f64::NAN; 2], |found| [found.re, found.im / TAU]))
    }
}
