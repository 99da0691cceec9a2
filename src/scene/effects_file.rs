//! The table `[effects]` of a scene file.

use super::{Effects, Problem};
use crate::contact::Law;
use serde::Deserialize;

/// Effects that are simulated besides masses and springs.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct EffectsTable {
    /// `true` (the default) if contacts may stick. If `false`, friction keeps the direction that it has in uniform sliding.
    sticking: Option<bool>,
    /// `true` (the default) if contacts may open. If `false`, they transmit tension as well as compression.
    detachment: Option<bool>,
    /// `true` to compute the kinetic, elastic and dissipated energy, and the work done; `false` by default.
    #[serde(default)]
    energy: bool,
    /// `true` to compute the present contact state's largest growth rate and that mode's frequency; `false` by default.
    #[serde(default)]
    stability: bool,
}

impl EffectsTable {
    /// Reports switches for features that the scene does not have: contacts, or friction.
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
            let message = "contacts without friction cannot stick";
            let help = "leave it out, or give another law of friction";
            report("sticking", self.sticking.is_some(), message, help);
        }
    }

    /// The effects with the switches of this table; the remaining ones keep their defaults, since a scene requests
    /// them by values.
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
