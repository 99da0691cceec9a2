//! The table `[effects]` of a scene file.

use super::{Effects, Problem};
use crate::contact::Law;
use serde::Deserialize;

/// What is simulated besides masses and springs.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct EffectsTable {
    /// May contacts stick? Unless false; then friction keeps the direction that it has in uniform sliding.
    sticking: Option<bool>,
    /// May contacts open? Unless false; then they hold in both directions.
    detachment: Option<bool>,
    /// Account for energy: kinetic, elastic, dissipated, and the work that is done.
    #[serde(default)]
    energy: bool,
    /// Watch the stability of the present contact state: its largest growth rate, and that mode's frequency.
    #[serde(default)]
    stability: bool,
}

impl EffectsTable {
    /// Switches of what this scene has nothing of: contacts, or friction.
    pub(super) fn check(&self, contacts: usize, law: Law, problems: &mut Vec<Problem>) {
        let mut report = |key: &str, is_given: bool, message: &str, help: &str| {
            if is_given {
                problems.push(Problem::new(format!("effects.{key}"), message).help(help));
            }
        };
        if contacts == 0 {
            let help = "leave it out";
            report("sticking", self.sticking.is_some(), "the scene has no contact", help);
            report("detachment", self.detachment.is_some(), "the scene has no contact", help);
        } else if !law.info().sticks {
            let message = "there is no friction that could hold a contact";
            let help = "leave it out, or give another law of friction";
            report("sticking", self.sticking.is_some(), message, help);
        }
    }

    /// What the scene calls for in this table; the other effects are there where they have values.
    pub(super) fn effects(&self) -> Effects {
        let whole = Effects::default();
        Effects {
            sticking: self.sticking.unwrap_or(whole.sticking),
            detachment: self.detachment.unwrap_or(whole.detachment),
            energy: self.energy,
            stability: self.stability,
            ..whole
        }
    }
}
