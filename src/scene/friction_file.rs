//! The table `[friction]` of a scene file.

use super::Problem;
#[cfg(feature = "schema")]
use super::Rule;
use crate::contact::Law;
use serde::Deserialize;

/// The law of friction and its coefficients.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct FrictionTable {
    /// The law of friction; by default the simplest law that uses all coefficients of this table.
    #[cfg_attr(feature = "schema", schemars(schema_with = "laws"))]
    #[serde(default)]
    law: Option<String>,
    /// Friction coefficient µ of every contact that has none of its own, ≥ 0.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    pub(super) coefficient: Option<f64>,
    /// Static friction coefficient µ_s ≥ µ of contacts that do not slip; µ by default.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FRICTION.bounds()))]
    #[serde(rename = "static")]
    pub(super) static_: Option<f64>,
    /// Decay velocity v_s of the Stribeck law, over which friction falls from µ_s towards µ by a factor of e, m/s.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::STRIBECK_VELOCITY.bounds()))]
    pub(super) stribeck_velocity: Option<f64>,
    /// `true` if eigenvalues have the damping µN/v of friction across the sliding, which the motion does not have.
    #[serde(default)]
    pub(super) transverse_damping: bool,
}

/// Schema of the laws: the name and the equation of each.
#[cfg(feature = "schema")]
fn laws(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    let law = |law: &Law| {
        let about = law.info();
        serde_json::json!({ "const": about.name, "description": about.equation, "type": "string" })
    };
    let laws: Vec<_> = Law::ALL.iter().map(law).collect();
    schemars::json_schema!({ "oneOf": laws })
}

impl FrictionTable {
    /// The keys that are given, except `law`.
    fn given(&self) -> Vec<&'static str> {
        let Self { law: _, coefficient, static_, stribeck_velocity, transverse_damping: _ } = self;
        let keys = [
            ("coefficient", coefficient.is_some()),
            ("static", static_.is_some()),
            ("stribeck_velocity", stribeck_velocity.is_some()),
        ];
        keys.into_iter().filter_map(|(key, is_given)| is_given.then_some(key)).collect()
    }

    /// Reports a law of unknown name.
    pub(super) fn unknown_law(&self) -> Option<Problem> {
        let name = self.law.as_deref().filter(|name| Law::named(name).is_none())?;
        let known: Vec<String> =
            Law::ALL.iter().map(|law| format!("\"{}\"", law.info().name)).collect();
        let problem = Problem::new("friction.law", "is not a law of friction");
        Some(problem.of(format!("\"{name}\"")).help(format!("the laws are {}", known.join(", "))))
    }

    /// The law that is named, or else the one that has the given coefficients; problems are added to `problems`.
    pub(super) fn law(&self, problems: &mut Vec<Problem>) -> Law {
        let given = self.given();
        let needs = |law: &Law| law.info().keys;
        let Some(name) = &self.law else {
            // The simplest law that has all the given coefficients.
            let has_all = |law: &&Law| given.iter().all(|key| needs(law).contains(key));
            let with_friction = || Law::ALL.iter().filter(|law| **law != Law::Frictionless);
            let Some(&law) = with_friction().find(has_all) else {
                let laws: Vec<String> = with_friction()
                    .map(|law| format!("\"{}\" has {}", law.info().name, spoken(needs(law))))
                    .collect();
                let message = format!("no law has {} together", spoken(&given));
                let help = format!("choose one: {}", laws.join("; "));
                problems.push(Problem::new("friction", message).help(help));
                return Law::Coulomb;
            };
            self.report_lacking(law, &given, problems);
            return law;
        };
        let Some(law) = Law::named(name) else {
            // `unknown_law` reports it.
            return Law::Coulomb;
        };
        self.report_lacking(law, &given, problems);
        for key in given.iter().filter(|key| !needs(&law).contains(key)) {
            let with: Vec<String> = Law::ALL
                .iter()
                .filter(|law| needs(law).contains(key))
                .map(|law| format!("\"{}\"", law.info().name))
                .collect();
            let equation = law.info().equation;
            let message = format!("the law \"{name}\" does not use this key: {equation}");
            let help = format!("leave it out, or give law = {}", with.join(" or "));
            problems.push(Problem::new(format!("friction.{key}"), message).help(help));
        }
        law
    }

    /// Reports coefficients that the law needs and the table lacks.
    fn report_lacking(&self, law: Law, given: &[&str], problems: &mut Vec<Problem>) {
        let about = law.info();
        let lacking: Vec<&str> =
            about.keys.iter().copied().filter(|key| !given.contains(key)).collect();
        if lacking.is_empty() {
            return;
        }
        let values: Vec<String> = lacking.iter().map(|key| format!("`{key} = …`")).collect();
        let add = format!("add {}", values.join(" and "));
        let help = match &self.law {
            Some(name) => format!("{add}; the law \"{name}\" is {}", about.equation),
            None if given.is_empty() => {
                format!("{add}, or `law = \"none\"` for contacts without friction")
            }
            None => format!("{add}; the law with {} is {}", spoken(given), about.equation),
        };
        let message = match &lacking[..] {
            [key] => format!("the key `{key}` is missing"),
            keys => format!("the keys {} are missing", spoken(keys)),
        };
        problems.push(Problem::new("friction", message).help(help));
    }
}

/// Keys as text: quoted, with "and" between them.
fn spoken(keys: &[&str]) -> String {
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    quoted.join(" and ")
}
