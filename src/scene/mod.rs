//! A scene: what the user wants simulated, as validated data.
//!
//! [`read`] and [`builtin`] give a [`Scene`]; [`Scene::check`] is the one place that says which
//! values are possible. No physics here.

mod builtin;
mod file;
#[cfg(feature = "tools")]
mod located;
#[cfg(feature = "tools")]
mod nearest;
mod per_module;
mod problem;
mod rule;
mod text;

pub use builtin::{BUILTIN, Builtin, builtin, builtin_names, find, named};
#[cfg(feature = "tools")]
pub use file::schema;
pub use file::{parse, read};
#[cfg(feature = "tools")]
pub use nearest::nearest;
pub use problem::Problem;
pub use rule::Rule;

use crate::Error;
use serde::{Deserialize, Serialize};

/// The most modules a ring may have.
pub const MAX_MODULES: usize = 100_000;

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
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Velocity along the tangent t = (cos θ, sin θ), m/s; of either sign.
    pub velocity: f64,
    /// Inclination θ against the horizontal, rad.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::ANGLE.bounds()))]
    pub angle: f64,
}

/// Rayleigh damping, C = α M + β K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Damping {
    /// Mass-proportional part α, 1/s.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::DAMPING.bounds()))]
    pub alpha: f64,
    /// Stiffness-proportional part β, s.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::DAMPING.bounds()))]
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
#[cfg_attr(feature = "tools", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Experiment {
    /// End of the run, s; it starts at 0.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::TIME.bounds()))]
    pub stop_time: f64,
    /// Time between two rows of results, s.
    #[cfg_attr(feature = "tools", schemars(transform = Rule::TIME.bounds()))]
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
        let problems = self.problems();
        if problems.is_empty() { Ok(()) } else { Err(problem::error(&problems)) }
    }

    /// Every impossible value; its path is the FMU's name of the variable.
    #[must_use]
    pub fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut check = |name: &dyn Fn() -> String, value: f64, rule: Rule| {
            if let Some(wish) = rule.broken_by(value) {
                problems.push(Problem::new(name(), wish).of(value));
            }
        };
        let named = |name: &'static str| move || name.to_owned();
        check(&named("slider.velocity"), self.slider.velocity, Rule::Finite);
        check(&named("slider.angle"), self.slider.angle, Rule::ANGLE);
        check(&named("friction.coefficient"), self.friction_coefficient, Rule::FRICTION);
        check(&named("damping.alpha"), self.damping.alpha, Rule::DAMPING);
        check(&named("damping.beta"), self.damping.beta, Rule::DAMPING);
        check(&named("integrator.step"), self.step, Rule::TIME);
        let Experiment { stop_time, output_interval } = self.experiment;
        check(&named("experiment.stop_time"), stop_time, Rule::TIME);
        check(&named("experiment.output_interval"), output_interval, Rule::TIME);
        for (i, module) in self.modules.iter().enumerate() {
            let i = i + 1;
            for (j, mass) in module.mass.into_iter().enumerate() {
                check(&|| format!("module[{i}].m{}", j + 1), mass, Rule::MASS);
            }
            for (j, stiffness) in module.stiffness.into_iter().enumerate() {
                check(&|| format!("module[{i}].k{}", j + 1), stiffness, Rule::STIFFNESS);
            }
            check(&|| format!("module[{i}].preload"), module.preload, Rule::Finite);
            for j in 0..4 {
                check(&|| format!("module[{i}].f{}", j + 1), module.force[j], Rule::Finite);
                let rule = if j == 3 { Rule::GAP } else { Rule::Finite };
                check(&|| format!("initial.module[{i}].x{}", j + 1), module.displacement[j], rule);
                check(
                    &|| format!("initial.module[{i}].v{}", j + 1),
                    module.velocity[j],
                    Rule::Finite,
                );
            }
        }
        if stop_time / output_interval > MAX_ROWS {
            let message = format!(
                "gives more than {MAX_ROWS:e} rows up to experiment.stop_time = {stop_time}"
            );
            problems.push(
                Problem::new("experiment.output_interval", message)
                    .help("choose a longer one")
                    .of(format!("{output_interval:e}")),
            );
        }
        if self.modules.is_empty() || self.modules.len() > MAX_MODULES {
            problems.push(file::not_a_ring(self.modules.len()));
        }
        problems
    }
}
