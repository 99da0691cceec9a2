//! The table `[integrator]` of a scene file.

#[cfg(feature = "schema")]
use super::Rule;
use super::{Method, Preset, Problem, Selection};
use serde::Deserialize;

/// Method of time integration and its step.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
// The rules that `read` reports in words, for editors.
#[cfg_attr(feature = "schema", schemars(extend(
    "if" = {
        "anyOf": [
            { "required": ["preset"] },
            { "required": ["method"], "properties": { "method": { "const": "auto" } } },
        ],
    },
    "then" = { "not": { "required": ["step"] } },
    "else" = { "required": ["step"] },
)))]
#[serde(deny_unknown_fields)]
pub(super) struct IntegratorTable {
    /// Method of time integration; the paper's scheme by default.
    method: Option<MethodChoice>,
    /// Internal time step h, s.
    ///
    /// The step is required unless a tolerance chooses it.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::TIME.bounds()))]
    step: Option<f64>,
    /// Preset that chooses method and step by a relative error: preview 1e-2, design 1e-4, reference 1e-9.
    preset: Option<Preset>,
    /// Relative error by which method "auto" chooses method and step if an importer gives none; 1e-4 by default.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::TOLERANCE.bounds()))]
    tolerance: Option<f64>,
}

/// Method of time integration, or "auto" to choose it by a tolerance.
#[derive(Clone, Copy, Deserialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum MethodChoice {
    /// The paper's scheme: forward increment Lagrange multipliers, of first order.
    ForwardIncrement,
    /// Event-driven motion: exact from one change of contact state to the next.
    EventDriven,
    /// Method and step chosen by the tolerance of an importer.
    Auto,
}

impl IntegratorTable {
    /// Returns the source of method and step, and their values if the table gives them; problems of the table are
    /// added to `problems`.
    pub(super) fn read(
        &self,
        problems: &mut Vec<Problem>,
    ) -> (Selection, Option<Method>, Option<f64>) {
        let is_auto = self.method == Some(MethodChoice::Auto);
        let mut report = |key: &str, message: String, help: &str| {
            problems.push(Problem::new(format!("integrator.{key}"), message).help(help));
        };
        if let Some(preset) = self.preset {
            let others = [
                ("method", self.method.is_some()),
                ("step", self.step.is_some()),
                ("tolerance", self.tolerance.is_some()),
            ];
            let others = others.into_iter().filter(|(_, is_given)| *is_given);
            let others: Vec<String> = others.map(|(key, _)| format!("`{key}`")).collect();
            if !others.is_empty() {
                let message = format!(
                    "chooses method and step by a tolerance of {:e}, but the table also gives {}",
                    preset.tolerance(),
                    others.join(" and ")
                );
                report("preset", message, "give either a preset or method and step");
            }
        } else if is_auto && self.step.is_some() {
            report(
                "step",
                "method = \"auto\" chooses the step".to_owned(),
                "leave it out, or give one of the methods \"forward-increment\" and \"event-driven\"",
            );
        } else if self.tolerance.is_some() && !is_auto {
            report(
                "tolerance",
                "applies to method = \"auto\" only, but this is another method".to_owned(),
                "leave it out, or give method = \"auto\" and no step",
            );
        }
        let needs_step = !is_auto && self.preset.is_none();
        if needs_step && self.step.is_none() {
            let help = "add `step = …` (Internal time step h, s), or `preset = \"design\"`, which \
                        chooses method and step";
            problems.push(Problem::new("integrator", "the key `step` is missing").help(help));
        }
        let selection = match (self.preset, is_auto) {
            (Some(preset), _) => Selection::Preset(preset),
            (None, true) => {
                let tolerance = self.tolerance.unwrap_or(Preset::Design.tolerance());
                Selection::Auto { tolerance }
            }
            (None, false) => Selection::Given,
        };
        let method = match self.method {
            Some(MethodChoice::ForwardIncrement) => Some(Method::ForwardIncrement),
            Some(MethodChoice::EventDriven) => Some(Method::EventDriven),
            Some(MethodChoice::Auto) | None => None,
        };
        (selection, method, self.step)
    }
}
