//! Which role the values have that an importer may give during a run.

use serde::Deserialize;

/// The role of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Given throughout the run; signals and tables may drive it.
    Input,
    /// Given before the run, and tunable between steps.
    Parameter,
}

/// The role of external forces, which a scene may go without.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ForceRole {
    /// Given throughout the run; signals and tables may drive them.
    Input,
    /// Given before the run, and tunable between steps.
    Parameter,
    /// There are none.
    None,
}

/// What an importer may give during a run, and whether as inputs or as tunable parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Roles {
    /// The slider's velocity, and those of contacts that have their own.
    pub slider_velocity: Role,
    /// All friction coefficients.
    pub friction: Role,
    /// All preloads.
    pub preload: Role,
    /// External forces.
    pub forces: ForceRole,
}

impl Default for Roles {
    fn default() -> Self {
        Self {
            slider_velocity: Role::Input,
            friction: Role::Input,
            preload: Role::Parameter,
            forces: ForceRole::Input,
        }
    }
}

/// Values that have their role in common: a key of `[inputs]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    SliderVelocity,
    Friction,
    Preload,
    Forces,
}

impl Group {
    /// Its key in `[inputs]`.
    pub(super) fn key(self) -> &'static str {
        match self {
            Self::SliderVelocity => "slider_velocity",
            Self::Friction => "friction",
            Self::Preload => "preload",
            Self::Forces => "forces",
        }
    }
}

impl Roles {
    /// The role of a group; `None` where the scene goes without.
    pub(crate) fn of(self, group: Group) -> Option<Role> {
        match (group, self.forces) {
            (Group::SliderVelocity, _) => Some(self.slider_velocity),
            (Group::Friction, _) => Some(self.friction),
            (Group::Preload, _) => Some(self.preload),
            (Group::Forces, ForceRole::Input) => Some(Role::Input),
            (Group::Forces, ForceRole::Parameter) => Some(Role::Parameter),
            (Group::Forces, ForceRole::None) => None,
        }
    }
}
