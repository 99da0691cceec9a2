//! Error messages for a failed step: the time, the contact, and the reason.

use super::catalogue::Quantity;
use super::clock::StepPlan;
use super::{Parameters, Simulation, Variable};
use crate::Error;
use crate::error::{Rounded, Short};
use crate::integrator::{Motion, StepFailure};
use crate::model::ring::MODULE_DOFS;
use crate::scene::{self, Structure};

/// Magnitude above which an input or parameter, in SI units, is named as the cause if the motion leaves the range of
/// numbers.
const HUGE: f64 = 1e100;

impl Simulation {
    /// Error for a step that the integrator could not take on the way to a time (s).
    #[cold]
    pub(super) fn failed(&self, failure: StepFailure, target: f64) -> Error {
        self.step_failed(target, &self.reason(failure))
    }

    /// The reason for which a step of this simulation's scene failed, with the contact and what would be right.
    #[cold]
    #[must_use]
    pub fn reason(&self, failure: StepFailure) -> String {
        let contact_name = |contact| self.scene.contact_name(contact);
        match failure {
            StepFailure::NoConvergence { sweeps, contact, change, tolerance } => {
                let name = contact_name(contact);
                let last = if change.is_finite() {
                    format!(
                        "in the last sweep the force of {name} still changed by {change:.1e} of the largest force, \
                         above the tolerance of {tolerance:e}"
                    )
                } else {
                    format!("the force of {name} left the range of floating-point numbers")
                };
                let coupled = || {
                    "contacts that share masses are coupled too strongly: lower friction.coefficient, or make \
                     their masses more alike"
                        .to_owned()
                };
                let cause = self.huge_value().map_or_else(coupled, too_large);
                format!("the contact forces did not converge in {sweeps} sweeps: {last}; {cause}")
            }
            StepFailure::NotFinite { contact } => {
                self.out_of_range(self.pushed().or_else(|| Some(self.scene.contact_name(contact))))
            }
            StepFailure::TooManyEvents { contact } => {
                format!("{} changed its state too many times at one instant", contact_name(contact))
            }
            StepFailure::TooManyChanges { most } => format!(
                "contacts changed their states more than {most} times in one internal step; lower integrator.step"
            ),
            StepFailure::NegativeFriction { contact, after } => format!(
                "the friction coefficient of {} falls below zero at {} s{}; lower what is added, or raise the coefficient",
                contact_name(contact),
                Rounded(self.time() + after),
                self.friction_sources(contact, |[kinetic, _]| kinetic != 0.0)
            ),
            StepFailure::WeakStaticFriction { contact, after, coefficient } => format!(
                "the static friction coefficient of {} falls below its kinetic one, {}, at {} s{}; lower what is added to \
                 the kinetic one, or raise the static one",
                contact_name(contact),
                Rounded(coefficient),
                Rounded(self.time() + after),
                self.friction_sources(contact, |_| true)
            ),
            StepFailure::TooManySeries { most } => format!(
                "one internal step took more than {most} power series; lower integrator.step, or look for \
                 a stiffness that is too large or a mass that is too small"
            ),
            StepFailure::Wedged { contact } => format!(
                "friction wedges {}: no contact force satisfies its law; lower friction.coefficient",
                contact_name(contact)
            ),
            StepFailure::Singular { contact } => format!(
                "friction wedges {} or almost wedges it: the equations of its contact forces are singular, and their \
                 solution is only rounding error; lower friction.coefficient",
                contact_name(contact)
            ),
            StepFailure::NoneFound { contact } => format!(
                "no contact force was found that satisfies the law of {}; the contact shares masses with too many others \
                 to try all their states, so that a solution may exist; lower friction.coefficient",
                contact_name(contact)
            ),
        }
    }

    /// The inputs that change the friction coefficients of a contact for one unit of the input by such numbers, with what is
    /// added to them.
    fn friction_sources(&self, contact: usize, changes: impl Fn([f64; 2]) -> bool) -> String {
        let driven = self.driven.iter();
        let sources = driven.flat_map(|driven| driven.friction_sources(contact, &changes));
        let sources = sources.map(|(added, variable, place)| {
            let value = Short(self.nominal.number(place));
            format!("{} to {} = {value}", added.join(" and "), variable.name)
        });
        let sources: Vec<String> = sources.collect();
        if sources.is_empty() { String::new() } else { format!(": {}", sources.join(", ")) }
    }

    /// Error for a motion that is no longer finite, which began on the way to a time (s).
    #[cold]
    pub(super) fn left_range(&self, target: f64) -> Error {
        self.step_failed(target, &self.out_of_range(self.pushed()))
    }

    /// Message for a motion that has left the range of numbers: its cause, and the place, which is the first degree
    /// of freedom that is not finite unless `place` is given.
    fn out_of_range(&self, place: Option<String>) -> String {
        let place = place.unwrap_or_else(|| {
            let Motion { displacement, velocity, .. } = &self.motion;
            let mut pairs = displacement.iter().zip(velocity);
            self.place(pairs.position(|(x, v)| !(x.is_finite() && v.is_finite())).unwrap_or(0))
        });
        format!(
            "the motion at {place} left the range of floating-point numbers; {}",
            self.likely_cause()
        )
    }

    /// Place of a force that is too large for any motion: within a few steps other degrees of freedom are not finite
    /// either.
    fn pushed(&self) -> Option<String> {
        let (variable, _) = self.huge_value()?;
        let is_force = variable.template.quantity == Quantity::ExternalForce;
        is_force.then(|| self.place(super::dof(&self.scene, &self.numbering, &variable)))
    }

    /// Name of a degree of freedom, with its contact.
    fn place(&self, dof: usize) -> String {
        let name = self.scene.dof_names().into_iter().nth(dof).unwrap_or_default();
        match self.contact_at(dof) {
            Some(contact) => format!("{}, {name},", self.scene.contact_name(contact)),
            None => name,
        }
    }

    /// Error for a plan that cannot be continued, for the given reason.
    #[cold]
    pub(super) fn stopped(&self, error: &Error, plan: &StepPlan) -> Error {
        if plan.done == 0 {
            return error.clone();
        }
        let time = Short(self.time());
        error.in_words(format!("{error}; the state is valid up to t = {time} s"))
    }

    /// Error for a time (s) that no steps lead to.
    #[cold]
    pub(super) fn unreachable(&self, target: f64) -> Error {
        let (time, step) = (self.time(), self.scene.step);
        let way = format!("cannot advance from {} s to {} s", Short(time), Short(target));
        if !target.is_finite() {
            return Error::step(format!("{way}: a time must be a finite number"));
        }
        if target < time {
            return Error::step(format!("{way}: time cannot go backwards"));
        }
        Error::step(format!(
            "{way}: from the start of the run this needs {} steps of integrator.step = {} s, more than a run can count; \
             choose a step of at least {} s",
            scene::count((target - self.clock.start()) / step),
            Short(step),
            scene::least((target - self.clock.start()) / scene::MAX_STEPS)
        ))
    }

    fn step_failed(&self, target: f64, what: &str) -> Error {
        let (time, is_there) = (Short(self.time()), target == self.time());
        let target = Short(target);
        if is_there {
            return Error::step(format!("at {time} s {what}"));
        }
        Error::step(format!(
            "between {time} s and {target} s {what}; the state is valid up to t = {time} s"
        ))
    }

    /// Contact of a degree of freedom, or else of the mass or module to which it belongs.
    fn contact_at(&self, dof: usize) -> Option<usize> {
        let touching = |dof: usize| {
            self.model.contacts.iter().position(|contact| {
                contact.normal.0.iter().chain(&contact.tangent.0).any(|part| part.0 == dof)
            })
        };
        touching(dof).or_else(|| match &self.scene.structure {
            Structure::Ring(_) => Some(dof / MODULE_DOFS),
            Structure::Network(network) => {
                let axes = |mass| [0, 1].map(|axis| self.numbering.dof(mass, axis));
                let mass =
                    (0..network.masses.len()).find(|mass| axes(*mass).contains(&Some(dof)))?;
                axes(mass).into_iter().flatten().find_map(touching)
            }
        })
    }

    /// Likely cause of a motion that leaves the range of numbers: a value that is far too large, or flutter.
    fn likely_cause(&self) -> String {
        self.huge_value().map_or_else(
            || {
                "look for flutter that grows without bound, as it can where contacts cannot open"
                    .to_owned()
            },
            too_large,
        )
    }

    /// The parameter or input of largest magnitude, if it is above `HUGE`.
    fn huge_value(&self) -> Option<(Variable, f64)> {
        let effective = Parameters::of(self.scene.clone());
        let values = effective.iter().map(|(variable, value)| (variable.clone(), value));
        values
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .filter(|(_, value)| value.abs() > HUGE)
    }
}

fn too_large((variable, value): (Variable, f64)) -> String {
    format!("{} = {value:e} is too large", variable.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Method, Scene, builtin};
    use crate::simulation::variables;

    const METHODS: [Method; 2] = [Method::ForwardIncrement, Method::EventDriven];

    /// Error message of a run of a scene to which this force (N) is applied after 1 ms.
    fn pushed(scene: &Scene, name: &str, force: f64) -> String {
        let mut simulation = Simulation::new(scene.clone(), 0.0).unwrap();
        simulation.advance_to(1e-3).unwrap();
        let all = variables(scene);
        let variable = all.iter().find(|variable| variable.name == name).unwrap();
        simulation.write(variable, force).unwrap();
        for row in 2..50_u32 {
            if let Err(error) = simulation.advance_to(f64::from(row) * 1e-3) {
                assert!(error.is_step());
                return error.to_string();
            }
        }
        panic!("it goes on")
    }

    #[test]
    fn a_force_beyond_all_bounds_is_named_with_when_and_where_it_acted() {
        for method in METHODS {
            for (scene, force, place) in [
                ("set1", "module[2].f3", "contact[2], module[2].x3,"),
                ("ring12", "module[7].f1", "contact[7], module[7].x1,"),
            ] {
                let scene = Scene { method, step: 1e-5, ..builtin(scene).unwrap().scene() };
                let error = pushed(&scene, force, 1e308);
                let (when, rest) = error.split_once(" the motion at ").unwrap();
                let start = when.strip_prefix("between ").unwrap().split(' ').next().unwrap();
                assert_eq!(
                    rest,
                    format!(
                        "{place} left the range of floating-point numbers; {force} = 1e308 is too large; \
                         the state is valid up to t = {start} s"
                    )
                );
            }
        }
    }

    /// Set 1 flutters without bound if contacts can neither open nor stick.
    #[test]
    fn flutter_that_nothing_bounds_ends_in_an_error_and_never_in_numbers_that_are_none() {
        for method in METHODS {
            let mut scene = Scene { method, step: 1e-4, ..builtin("set1").unwrap().scene() };
            (scene.effects.sticking, scene.effects.detachment) = (false, false);
            scene.friction_coefficient = 3.0;
            let mut simulation = Simulation::new(scene, 0.0).unwrap();
            let error = loop {
                let then = simulation.time() + 0.5;
                match simulation.advance_to(then) {
                    Ok(()) => assert!(
                        then < 1e3 && simulation.displacement().iter().all(|x| x.is_finite())
                    ),
                    Err(error) => break error.to_string(),
                }
            };
            let words = [
                "left the range of floating-point numbers",
                "flutter that grows without bound",
                "contact[",
            ];
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
            // The growth over 300 powers of ten takes time.
            assert!(simulation.time() > 1.0);
        }
    }

    #[test]
    fn more_oscillations_than_a_step_can_follow_are_refused() {
        let mut scene = builtin("set1").unwrap().scene();
        (scene.method, scene.step) = (Method::EventDriven, 1e-3);
        scene.damping.beta = 0.0;
        scene.modules_mut()[0].mass[0] = 1e-15;
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        let error = simulation.advance_to(1e-3).unwrap_err().to_string();
        assert!(
            error.contains("took more than 100000 power series; lower integrator.step"),
            "{error}"
        );
    }
}
