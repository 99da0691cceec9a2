//! How a scene comes to its method and step: it gives them, or a tolerance by which they are chosen.
//!
//! A *tolerance* is the relative error that a user accepts: root mean square, of all displacements together,
//! over the scene's experiment, in parts of their deviation from the mean. Where the motion forgets its start, so
//! that not even exact motion agrees with itself to 5 % at another step, it is that of amplitude and frequency,
//! whichever is larger.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A tolerance with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// 1e-2: no difference is seen in a picture of the motion.
    Preview,
    /// 1e-4: below what masses and stiffnesses are known to.
    Design,
    /// 1e-9: to compare others with.
    Reference,
}

impl Preset {
    /// All of them, the coarsest first.
    pub const ALL: [Self; 3] = [Self::Preview, Self::Design, Self::Reference];

    /// The relative error that it accepts.
    #[must_use]
    pub const fn tolerance(self) -> f64 {
        match self {
            Self::Preview => 1e-2,
            Self::Design => 1e-4,
            Self::Reference => 1e-9,
        }
    }

    /// Its name in a scene file and on the command line.
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

/// Where a scene's method and step come from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Selection {
    /// They are given.
    #[default]
    Given,
    /// They are chosen when a simulation is made, by the tolerance of that name.
    Preset(Preset),
    /// They are chosen when a simulation is made, by an importer's tolerance or else by this one.
    Auto {
        /// The relative error that is accepted, above 0 and below 1.
        tolerance: f64,
    },
}

impl Selection {
    /// The tolerance by which method and step are chosen; `None` where they are given.
    #[must_use]
    pub const fn tolerance(self) -> Option<f64> {
        match self {
            Self::Given => None,
            Self::Preset(preset) => Some(preset.tolerance()),
            Self::Auto { tolerance } => Some(tolerance),
        }
    }
}

/// As a scene file writes it.
impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given => f.write_str("method and step"),
            Self::Preset(preset) => write!(f, "preset = \"{preset}\""),
            Self::Auto { .. } => f.write_str("method = \"auto\""),
        }
    }
}
