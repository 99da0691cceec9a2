//! Checks that the values of a scene are possible.

use super::missing::MissingFeature;
use super::nearest::nearest;
use super::network_check::quoted;
use super::{
    ContactDefinition, Experiment, Network, NodeAt, Problem, Rule, Scene, Signal, Structure,
    effects_check, network_check, problem, ring,
};
use crate::Error;
use crate::error::Short;

/// Largest number of rows of results in a run.
const MAX_ROWS: f64 = 1e9;

/// Largest number of steps in a run: a double cannot hold every larger whole number, so that times would not increase
/// by a step.
pub const MAX_STEPS: f64 = 9_007_199_254_740_992.0;

/// Largest number of rows of a dense matrix whose eigenvalues are computed during a run: about 30 ms for each contact
/// state. From 256 rows on, the analyser uses another algorithm, whose last digits differ.
const MAX_WATCHED_ROWS: usize = 255;

/// Owner of a value, with its index from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Module(usize),
    InitialOfModule(usize),
    Mass(usize),
    InitialOfMass(usize),
    Superelement(usize),
    InitialOfSuperelement(usize),
    InitialOfNode(NodeAt),
    ContactSet(usize),
    Spring(usize),
    Damper(usize),
    Contact(usize),
}

/// Function that names a part's value for the reader: the FMU's variable name, or the path through a file. Without a
/// key it names the part itself.
pub(super) type Naming<'a> = &'a dyn Fn(Owner, &str) -> String;

/// Problems found so far.
pub(super) struct Checks<'a> {
    naming: Naming<'a>,
    pub(super) problems: Vec<Problem>,
}

impl Checks<'_> {
    /// The path of a part's value, or of the part itself if the key is empty.
    pub(super) fn path(&self, part: Owner, key: &str) -> String {
        (self.naming)(part, key)
    }

    /// A problem at the path of a part's value.
    pub(super) fn problem(&self, part: Owner, key: &str, message: impl Into<String>) -> Problem {
        Problem::new(self.path(part, key), message)
    }

    /// Adds a problem if the value breaks its rule.
    pub(super) fn value(&mut self, part: Owner, key: &str, value: f64, rule: Rule) {
        if let Some(wish) = rule.broken_by(value) {
            self.problems.push(self.problem(part, key, wish).of(value));
        }
    }
}

impl Scene {
    /// Checks the scene and reports every impossible value.
    ///
    /// # Errors
    /// Returns an error with one line for each problem, up to twenty: the variable, its value, and the requirement.
    pub fn check(&self) -> Result<(), Error> {
        let problems = self.problems();
        if problems.is_empty() { Ok(()) } else { Err(problem::error(&problems)) }
    }

    /// All impossible values; the path of each is the FMU's name of the variable.
    #[must_use]
    pub fn problems(&self) -> Vec<Problem> {
        self.problems_named(&|part, key| self.variable_name(part, key))
    }

    /// Rule for the slider's inclination: the modules of a ring stand on the slider, while the masses of a network
    /// may be anywhere around it.
    #[must_use]
    pub fn inclination_rule(&self) -> Rule {
        match self.structure {
            Structure::Ring(_) => Rule::INCLINATION,
            Structure::Network(_) => Rule::Finite,
        }
    }

    /// All impossible values, with the paths that `naming` gives.
    pub(super) fn problems_named(&self, naming: Naming<'_>) -> Vec<Problem> {
        let mut checks = Checks { naming, problems: self.common_problems() };
        match &self.structure {
            Structure::Ring(modules) => ring::check(modules, &mut checks),
            Structure::Network(network) => {
                let has_beta = self.effects.stiffness_damping;
                network_check::check(network, self.slider, has_beta, &mut checks);
                self.check_static_friction(network, &mut checks);
            }
        }
        self.check_transverse_damping(&mut checks);
        effects_check::check(self, &mut checks);
        checks.problems.extend(self.unknown_inputs());
        checks.problems.extend(self.too_large_to_watch());
        checks.problems
    }

    /// Reports a structure that is too large for its eigenvalues to be computed during a run.
    fn too_large_to_watch(&self) -> Option<Problem> {
        let is_damped = self.network().is_some_and(|network| !network.dampers.is_empty());
        let falls = !self.friction_law.info().is_constant();
        let (most, with) = match (is_damped, falls) {
            // Displacements and velocities then have a row each.
            (true, _) => (MAX_WATCHED_ROWS / 2, " with dampers"),
            (false, true) => {
                (MAX_WATCHED_ROWS / 2, " with friction that depends on the slip velocity")
            }
            (false, false) => (MAX_WATCHED_ROWS, ""),
        };
        let dofs = self.external_forces().count();
        let message = format!(
            "is supported for up to {most} degrees of freedom{with}, but this scene has {dofs}"
        );
        (self.effects.stability && dofs > most).then(|| {
            Problem::new("effects.stability", message).of(true).help(
                "leave it out; amontons-stability analyses single contact states of larger scenes",
            )
        })
    }

    /// Reports damping across the sliding where no contact has a motion in that direction, so that it would do nothing.
    fn check_transverse_damping(&self, checks: &mut Checks<'_>) {
        if !self.transverse_damping {
            return;
        }
        let lacking = match self.network() {
            None => Some("a ring moves in a plane".to_owned()),
            Some(network) => {
                let lacks = |contact: &ContactDefinition| {
                    let ends = [Some(contact.mass), contact.on].into_iter().flatten();
                    !ends.into_iter().any(|point| network.moves_across(point, contact, self.slider))
                };
                let has_none = !network.contacts.is_empty() && network.contacts.iter().all(lacks);
                has_none.then(|| "no contact has a motion across its sliding".to_owned())
            }
        };
        let Some(lacking) = lacking else { return };
        let problem =
            Problem::new("friction.transverse_damping", format!("does nothing: {lacking}"));
        checks.problems.push(problem.of(true).help(
            "leave it out, or keep the third direction of the nodes when the structure is reduced",
        ));
    }

    /// Checks the static friction of contacts that have their own.
    fn check_static_friction(&self, network: &Network, checks: &mut Checks<'_>) {
        for (i, place) in network.contacts.iter().enumerate() {
            let Some(static_friction) = place.static_friction else { continue };
            let kinetic = place.friction.unwrap_or(self.friction_coefficient);
            let path = || checks.path(Owner::Contact(i), "static_friction");
            let problem = weak_static_friction(path, static_friction, kinetic);
            checks.problems.extend(problem);
        }
    }

    /// Reports signals for inputs that the scene does not have.
    fn unknown_inputs(&self) -> Vec<Problem> {
        if self.signals.is_empty() {
            return Vec::new();
        }
        let inputs = self.input_names();
        let unknown = self.signals.iter().enumerate().filter(|(_, s)| !inputs.contains(&s.input));
        let problem = |(i, signal): (usize, &Signal)| {
            let path = format!("signal[{}].input", i + 1);
            match self.explain_missing_input(&signal.input) {
                Some(MissingFeature { reason, help }) => Problem::new(path, reason).help(help),
                None => Problem::new(path, "the scene has no such input")
                    .help(meant_input(&signal.input, &inputs)),
            }
            .of(quoted(&signal.input))
        };
        unknown.map(problem).collect()
    }

    /// Impossible values that do not belong to the structure.
    pub(super) fn common_problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let Experiment { stop_time, output_interval } = self.experiment;
        for (name, value, rule) in [
            ("slider.velocity", self.slider.velocity, Rule::Finite),
            ("slider.angle", self.slider.angle, self.inclination_rule()),
            ("friction.coefficient", self.friction_coefficient, Rule::FRICTION),
            ("damping.alpha", self.damping.alpha, Rule::DAMPING),
            ("damping.beta", self.damping.beta, Rule::DAMPING),
            ("integrator.step", self.step, Rule::TIME),
            ("integrator.tolerance", self.selection.tolerance().unwrap_or(0.5), Rule::TOLERANCE),
            ("experiment.stop_time", stop_time, Rule::TIME),
            ("experiment.output_interval", output_interval, Rule::TIME),
        ] {
            if let Some(wish) = rule.broken_by(value) {
                problems.push(Problem::new(name, wish).of(value));
            }
        }
        if let Some(wish) =
            self.stribeck_velocity.and_then(|v| Rule::STRIBECK_VELOCITY.broken_by(v))
        {
            let problem = Problem::new("friction.stribeck_velocity", wish);
            problems.push(problem.of(self.stribeck_velocity.unwrap_or(0.0)));
        }
        if let Some(static_friction) = self.static_friction {
            problems.extend(weak_static_friction(
                || "friction.static".to_owned(),
                static_friction,
                self.friction_coefficient,
            ));
        }
        for (i, signal) in self.signals.iter().enumerate() {
            signal.shape.check(&format!("signal[{}]", i + 1), &mut problems);
        }
        let end = format!("up to experiment.stop_time = {}", Short(stop_time));
        if self.selection.tolerance().is_none() && stop_time / self.step > MAX_STEPS {
            let message = format!(
                "needs {} steps {end}, more than a run can count",
                count(stop_time / self.step)
            );
            let help = format!("choose a step of at least {} s", least(stop_time / MAX_STEPS));
            problems.push(
                Problem::new("integrator.step", message).help(help).of(format!("{:e}", self.step)),
            );
        }
        if stop_time / output_interval > MAX_ROWS {
            let message = format!("gives more than {MAX_ROWS:e} rows {end}");
            problems.push(
                Problem::new("experiment.output_interval", message)
                    .help("choose a longer interval")
                    .of(format!("{output_interval:e}")),
            );
        }
        problems
    }

    /// The FMU's name of a part's value.
    fn variable_name(&self, part: Owner, key: &str) -> String {
        let network = self.network();
        let mass = |i: usize| network.map_or("", |network| &*network.masses[i].name);
        let part = match part {
            Owner::Module(i) => format!("module[{}]", i + 1),
            Owner::InitialOfModule(i) => format!("initial.module[{}]", i + 1),
            Owner::Mass(i) => format!("mass.{}", mass(i)),
            Owner::InitialOfMass(i) => format!("initial.mass.{}", mass(i)),
            Owner::Superelement(i) | Owner::InitialOfSuperelement(i) => {
                let name =
                    |network: &Network| format!("superelement.{}", network.superelements[i].name);
                network.map_or_else(String::new, name)
            }
            Owner::InitialOfNode(NodeAt { superelement, node }) => {
                let name = |network: &Network| network.superelements[superelement].node_name(node);
                format!("initial.{}", network.map_or_else(String::new, name))
            }
            Owner::ContactSet(i) => {
                network.map_or_else(String::new, |network| network.contact_sets[i].clone())
            }
            Owner::Spring(i) => {
                format!("spring.{}", network.map_or("", |network| &*network.springs[i].name))
            }
            Owner::Damper(i) => {
                format!("damper.{}", network.map_or("", |network| &*network.dampers[i].name))
            }
            Owner::Contact(i) => self.contact_name(i),
        };
        with_key(part, key)
    }
}

/// Text for a number of steps that is too large to count.
pub(crate) fn count(steps: f64) -> String {
    if steps.is_finite() { format!("{steps:.1e}") } else { "more than 1e308".to_owned() }
}

/// Text for a lower limit, rounded upwards.
pub(crate) fn least(value: f64) -> String {
    const UPWARDS: f64 = 1.05;
    format!("{:.1e}", UPWARDS * value)
}

/// Reports a static friction coefficient that breaks its rule or is below the kinetic one.
pub(super) fn weak_static_friction(
    path: impl FnOnce() -> String,
    static_friction: f64,
    kinetic: f64,
) -> Option<Problem> {
    let wish = Rule::FRICTION.broken_by(static_friction);
    let wish = wish
        .or((static_friction < kinetic)
            .then_some("must be at least the kinetic friction coefficient"))?;
    let problem = Problem::new(path(), wish).of(static_friction);
    Some(problem.help(format!("the kinetic friction coefficient is {}", Short(kinetic))))
}

/// The path of a part's value, or of the part itself if the key is empty.
pub(super) fn with_key(part: String, key: &str) -> String {
    if key.is_empty() { part } else { format!("{part}.{key}") }
}

/// Suggests the input that an unknown name is likely to mean, or else lists the scene's inputs.
pub fn meant_input(name: &str, inputs: &[String]) -> String {
    const MOST: usize = 12;
    if let Some(meant) = nearest(name, inputs.iter().map(String::as_str)) {
        return format!("did you mean {}?", quoted(meant));
    }
    if inputs.is_empty() {
        return "the scene has no inputs".to_owned();
    }
    let more = if inputs.len() > MOST { ", …" } else { "" };
    let first: Vec<&str> = inputs.iter().take(MOST).map(String::as_str).collect();
    format!("the inputs of the scene are {}{more}", first.join(", "))
}
