//! A scene: what the user wants simulated, as validated data.
//!
//! [`read`] and [`builtin`] give a [`Scene`]; [`Scene::check`] is the one place that says which
//! values are possible. No physics here.

mod builtin;
mod file;
mod per_module;

pub use builtin::{BUILTIN, Builtin, builtin, builtin_names, find};
pub use file::{parse, read};

use crate::Error;
use serde::{Deserialize, Serialize};

/// The most modules a ring may have.
pub const MAX_MODULES: usize = 100_000;

/// The most impossible values that one message lists.
const MAX_PROBLEMS: usize = 20;

/// The most rows of results that a run may have.
const MAX_ROWS: f64 = 1e9;

/// A ring of modules in frictional contact with a moving slider (paper, section 3 and Fig. 1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its name: the stem of its file, or the built-in's name.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// The rigid slider that all masses m2 rub on.
    pub slider: Slider,
    /// Friction coefficient µ of every contact, ≥ 0.
    pub friction_coefficient: f64,
    /// Rayleigh damping, C = α M + β K.
    pub damping: Damping,
    /// The modules, closed in a ring.
    pub modules: Vec<Module>,
    /// Internal time step h, s.
    pub step: f64,
    /// What a run does unless told otherwise.
    pub experiment: Experiment,
}

/// The rigid slider.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Velocity along the tangent t = (cos θ, sin θ), m/s; of either sign.
    pub velocity: f64,
    /// Inclination θ against the horizontal, rad.
    pub angle: f64,
}

/// Rayleigh damping, C = α M + β K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Damping {
    /// Mass-proportional part α, 1/s.
    pub alpha: f64,
    /// Stiffness-proportional part β, s.
    pub beta: f64,
}

/// One module: two masses, its springs, and the links to the next module.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Module {
    /// m1 and m2, kg.
    pub mass: [f64; 2],
    /// k1 … k6, N/m; what each joins stands with the model, in `model::ring`.
    pub stiffness: [f64; 6],
    /// Preload δ: how far the ground end of k3 is moved down, m.
    pub preload: f64,
    /// External forces along x1 … x4, N.
    pub force: [f64; 4],
    /// Initial x1 … x4 relative to the equilibrium, m.
    pub displacement: [f64; 4],
    /// Initial velocities of x1 … x4, m/s.
    pub velocity: [f64; 4],
}

/// What a run does unless told otherwise; FMI's DefaultExperiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Experiment {
    /// End of the run, s; it starts at 0.
    pub stop_time: f64,
    /// Time between two rows of results, s.
    pub output_interval: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Self { stop_time: 1.0, output_interval: 1e-3 }
    }
}

impl Scene {
    /// Refuses impossible values, naming every one of them.
    ///
    /// # Errors
    /// One line a problem, up to twenty: the variable, its value, what would be right.
    pub fn check(&self) -> Result<(), Error> {
        let mut problems = Vec::new();
        let mut check = |name: &dyn Fn() -> String, value: f64, rule: Rule| {
            if let Some(wish) = rule.broken_by(value) {
                problems.push(format!("{} = {value}: {wish}", name()));
            }
        };
        let named = |name: &'static str| move || name.to_owned();
        check(&named("slider.velocity"), self.slider.velocity, Rule::Finite);
        check(&named("slider.angle"), self.slider.angle, Rule::QuarterTurn);
        check(&named("friction.coefficient"), self.friction_coefficient, Rule::NotNegative);
        check(&named("damping.alpha"), self.damping.alpha, Rule::NotNegative);
        check(&named("damping.beta"), self.damping.beta, Rule::NotNegative);
        check(&named("integrator.step"), self.step, Rule::Positive);
        check(&named("experiment.stop_time"), self.experiment.stop_time, Rule::Positive);
        check(
            &named("experiment.output_interval"),
            self.experiment.output_interval,
            Rule::Positive,
        );
        for (i, module) in self.modules.iter().enumerate() {
            let i = i + 1;
            for (j, mass) in module.mass.into_iter().enumerate() {
                check(&|| format!("module[{i}].m{}", j + 1), mass, Rule::Positive);
            }
            for (j, stiffness) in module.stiffness.into_iter().enumerate() {
                check(&|| format!("module[{i}].k{}", j + 1), stiffness, Rule::NotNegative);
            }
            check(&|| format!("module[{i}].preload"), module.preload, Rule::Finite);
            for j in 0..4 {
                check(&|| format!("module[{i}].f{}", j + 1), module.force[j], Rule::Finite);
                let rule = if j == 3 { Rule::NotInsideSlider } else { Rule::Finite };
                check(&|| format!("initial.module[{i}].x{}", j + 1), module.displacement[j], rule);
                check(
                    &|| format!("initial.module[{i}].v{}", j + 1),
                    module.velocity[j],
                    Rule::Finite,
                );
            }
        }
        let Experiment { stop_time, output_interval } = self.experiment;
        if stop_time / output_interval > MAX_ROWS {
            problems.push(format!(
                "experiment.output_interval = {output_interval}: gives more than {MAX_ROWS:e} rows \
                 up to experiment.stop_time = {stop_time}; choose a longer one"
            ));
        }
        if self.modules.is_empty() || self.modules.len() > MAX_MODULES {
            problems.push(format!(
                "ring.modules = {}: a ring has 1 to {MAX_MODULES} modules",
                self.modules.len()
            ));
        }
        if problems.is_empty() {
            return Ok(());
        }
        let more = problems.len().saturating_sub(MAX_PROBLEMS);
        problems.truncate(MAX_PROBLEMS);
        if more > 0 {
            problems.push(format!("and {more} more"));
        }
        Err(Error::scene(problems.join("\n")))
    }
}

/// What a value must be.
#[derive(Clone, Copy)]
enum Rule {
    Finite,
    NotNegative,
    Positive,
    NotInsideSlider,
    QuarterTurn,
}

impl Rule {
    /// What would be right, if `value` breaks the rule.
    fn broken_by(self, value: f64) -> Option<&'static str> {
        if !value.is_finite() {
            return Some("must be a finite number");
        }
        match self {
            Self::NotNegative if value < 0.0 => Some("must not be negative"),
            Self::Positive if value <= 0.0 => Some("must be above zero"),
            Self::NotInsideSlider if value < 0.0 => {
                Some("starts inside the slider; a displacement along the normal must be ≥ 0")
            }
            Self::QuarterTurn if value.abs() > std::f64::consts::FRAC_PI_2 => {
                Some("must be between −π/2 and π/2 rad (30° are 0.5236)")
            }
            _ => None,
        }
    }
}
