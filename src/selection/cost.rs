//! Cost of a run as a count of operations, equal on each machine, so that a choice based on it is equal too.
//!
//! The weights are nanoseconds on one machine, from the times of `amontons accuracy`; only their ratios matter.
//! Between the two methods the ratio of the times of whole runs is that of the counts within a factor of 2.5, on
//! the scenes that are built in and on rings of 3 to 256 modules.

use crate::integrator::{RingForwardIncrement, full_places};
use crate::model::{Contact, LumpedModel};
use crate::scene::{Method, Shape, Signal};
use crate::stability::highest_frequency;
use std::f64::consts::TAU;

/// Weight of a degree of freedom in a step of the paper's scheme on a ring.
const RING_DOF: f64 = 2.1;
/// Weights of a step of the scheme on other structures: the step, an entry of the matrices, a contact, and a contact
/// that shares masses with others.
const SPARSE_STEP: f64 = 20.0;
const SPARSE_ENTRY: f64 = 8.0;
const SPARSE_CONTACT: f64 = 40.0;
const SHARING_CONTACT: f64 = 400.0;
/// Weights of a power series: the series itself, and for each power an entry of the full matrix of a small structure,
/// or of the sparse ones of a large one.
const SERIES: f64 = 150.0;
const FULL_ENTRY: f64 = 0.4;
const LAW_ENTRY: f64 = 2.0;

/// Largest angle of the fastest oscillation that a series covers, rad: its highest power is then 3²⁸/28! ≈ 1e-16 of the
/// first.
const REACH: f64 = 3.0;
/// A power below this part of the first one ends a series.
const NEGLIGIBLE: f64 = 1e-16;

/// Costs of both methods on a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Operations of a step of the paper's scheme.
    scheme_step: f64,
    /// Operations of one power of a series.
    power: f64,
    /// Upper bound of the frequencies of all oscillations, rad/s.
    frequency: f64,
}

impl Cost {
    /// The costs on this model.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn of(model: &LumpedModel) -> Self {
        let dofs = model.dofs();
        let entries = model.stiffness.entries().count() + model.dampers.entries().count() + dofs;
        let entries = entries as f64;
        let mut users = vec![0_u32; dofs];
        let parts = |contact: &Contact| {
            let mut parts: Vec<usize> =
                contact.normal.0.iter().chain(&contact.tangent.0).map(|part| part.0).collect();
            parts.sort_unstable();
            parts.dedup();
            parts
        };
        model.contacts.iter().flat_map(parts).for_each(|dof| users[dof] += 1);
        let shares = |contact: &&Contact| parts(contact).iter().any(|dof| users[*dof] > 1);
        let sharing = model.contacts.iter().filter(shares);
        let scheme_step = match RingForwardIncrement::new(model) {
            Some(_) => RING_DOF * dofs as f64,
            None => {
                SPARSE_STEP
                    + SPARSE_ENTRY * entries
                    + SPARSE_CONTACT * model.contacts.len() as f64
                    + SHARING_CONTACT * sharing.count() as f64
            }
        };
        let power = match full_places(&model.contacts, dofs) {
            Some(places) => FULL_ENTRY * (places * places) as f64,
            None => LAW_ENTRY * entries,
        };
        Self { scheme_step, power, frequency: highest_frequency(model).unwrap_or(0.0) }
    }

    /// The cost when these signals drive the motion: a series covers no larger angle of a sine than of the fastest
    /// mode.
    #[must_use]
    pub fn driven(self, signals: &[Signal]) -> Self {
        let frequency =
            signals.iter().fold(self.frequency, |fastest, signal| match &signal.shape {
                Shape::Sine(sine) => fastest.max(TAU * sine.frequency),
                _ => fastest,
            });
        Self { frequency, ..self }
    }

    /// The operations of a run over `span` (s) with `events` changes of contact state.
    #[must_use]
    pub fn run(&self, method: Method, step: f64, span: f64, events: f64) -> f64 {
        let steps = span / step;
        match method {
            Method::ForwardIncrement => steps * self.scheme_step,
            Method::EventDriven => {
                let angle = (self.frequency * step).min(REACH);
                let series = steps.max(span * self.frequency / REACH) + events;
                series * (SERIES + powers(angle) * self.power)
            }
        }
    }
}

/// Number of powers of a series over this angle (rad) of the fastest oscillation.
fn powers(angle: f64) -> f64 {
    let (mut power, mut term) = (1.0, angle);
    while term > NEGLIGIBLE {
        power += 1.0;
        term *= angle / power;
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    fn cost(name: &str) -> Cost {
        Cost::of(&LumpedModel::from(&builtin(name).unwrap().scene()))
    }

    #[test]
    fn a_series_has_the_powers_that_its_sum_needs() {
        // Terms are x^k / k!: 1/18! = 1.6e-16, 1/19! = 8e-18; 3²⁷/27! = 7e-16, 3²⁸/28! = 8e-17.
        assert_eq!(powers(1.0), 19.0);
        assert_eq!(powers(REACH), 28.0);
        assert_eq!(powers(0.0), 1.0);
    }

    #[test]
    fn half_the_step_is_twice_the_work_of_the_scheme_and_less_than_that_of_exact_motion() {
        let cost = cost("set1");
        let of = |method, step| cost.run(method, step, 1.0, 700.0);
        let scheme = [1e-5, 5e-6].map(|step| of(Method::ForwardIncrement, step));
        assert!((scheme[1] / scheme[0] - 2.0).abs() < 1e-12);
        let exact = [2e-4, 1e-4].map(|step| of(Method::EventDriven, step));
        assert!(exact[0] < exact[1] && exact[1] < 2.0 * exact[0], "{exact:?}");
        // However long its step, exact motion takes a series for some radians and one for each event.
        assert_eq!(of(Method::EventDriven, 0.5), of(Method::EventDriven, 1.0));
    }

    #[test]
    fn contacts_that_share_masses_make_a_step_of_the_scheme_dear() {
        let ratio = |name: &str| {
            let cost = cost(name);
            let of = |method| cost.run(method, 1e-6, 1.0, 0.0);
            of(Method::EventDriven) / of(Method::ForwardIncrement)
        };
        // Measured values: a step of set1 as long as 20 of the scheme, one of the disc brake no longer than one.
        assert!(
            ratio("set1") > 10.0 && ratio("disc_brake") < 1.5,
            "{} {}",
            ratio("set1"),
            ratio("disc_brake")
        );
    }
}
