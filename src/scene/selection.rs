//! The source of a scene's method and step: given values, or a tolerance by which they are chosen.
//!
//! A *tolerance* is the relative error that a user accepts: the root mean square error of all displacements together
//! over the scene's experiment, relative to their deviation from the mean. If the motion is so sensitive that
//! event-driven motion with another step differs from itself by more than 5 %, it is the relative error of amplitude
//! or frequency, whichever is larger.

use super::{Method, Scene};
use crate::Error;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A tolerance with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Tolerance 1e-2: the error is not visible in a picture of the motion.
    Preview,
    /// Tolerance 1e-4: the error is below the uncertainty of masses and stiffnesses.
    Design,
    /// Tolerance 1e-9: the result can serve as a reference for others.
    Reference,
}

impl Preset {
    /// All presets, the coarsest first.
    pub const ALL: [Self; 3] = [Self::Preview, Self::Design, Self::Reference];

    /// Relative error that the preset accepts.
    #[must_use]
    pub const fn tolerance(self) -> f64 {
        match self {
            Self::Preview => 1e-2,
            Self::Design => 1e-4,
            Self::Reference => 1e-9,
        }
    }

    /// Name of the preset in a scene file and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Preview => "preview",
            Self::Design => "design",
            Self::Reference => "reference",
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A choice of method, step or preset in place of a scene's own; what is `None` stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct IntegratorChoice {
    /// The method.
    pub method: Option<Method>,
    /// The internal step, s.
    pub step: Option<f64>,
    /// The preset that chooses both, in place of them.
    pub preset: Option<Preset>,
}

impl IntegratorChoice {
    /// Gives a scene this choice.
    ///
    /// # Errors
    /// Returns an error if a method is given without a step, or a step without a method, for a scene that chooses both.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Error> {
        match self.preset {
            Some(preset) => scene.selection = Selection::Preset(preset),
            None => scene.set_integrator(self.method, self.step)?,
        }
        Ok(())
    }
}

/// Source of a scene's method and step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Selection {
    /// Method and step are given.
    #[default]
    Given,
    /// Method and step are chosen when a simulation is made, by the tolerance of this preset.
    Preset(Preset),
    /// Method and step are chosen when a simulation is made, by an importer's tolerance or else by this one.
    Auto {
        /// Relative error that is accepted, above 0 and below 1.
        tolerance: f64,
    },
}

impl Selection {
    /// Tolerance by which method and step are chosen; `None` if they are given.
    #[must_use]
    pub const fn tolerance(self) -> Option<f64> {
        match self {
            Self::Given => None,
            Self::Preset(preset) => Some(preset.tolerance()),
            Self::Auto { tolerance } => Some(tolerance),
        }
    }
}

/// Writes the selection in the notation of a scene file.
impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given => f.write_str("method and step"),
            Self::Preset(preset) => write!(f, "preset = \"{preset}\""),
            Self::Auto { .. } => f.write_str("method = \"auto\""),
        }
    }
}
