//! Roles of the values that an importer may set during a run.

use serde::Deserialize;

/// Role of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Input: set throughout the run; signals and tables may drive it.
    Input,
    /// Parameter: set before the run, and tunable between steps.
    Parameter,
}

/// Role of the external forces, which a scene may leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ForceRole {
    /// Inputs: set throughout the run; signals and tables may drive them.
    Input,
    /// Parameters: set before the run, and tunable between steps.
    Parameter,
    /// No external forces.
    None,
}

/// Roles of the values that an importer may set during a run: inputs or tunable parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Roles {
    /// Role of the slider's velocity, and of the velocities of contacts that have their own.
    pub slider_velocity: Role,
    /// Role of all friction coefficients.
    pub friction: Role,
    /// Role of all preloads.
    pub preload: Role,
    /// Role of the external forces.
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

/// A group of values with a common role: a key of `[inputs]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    SliderVelocity,
    Friction,
    Preload,
    Forces,
}

impl Group {
    /// Key of the group in `[inputs]`.
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
    /// Role of a group; `None` if the scene does not have its values.
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
