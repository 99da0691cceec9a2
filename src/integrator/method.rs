//! The methods of time integration.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The method of time integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The paper's scheme: forward increment Lagrange multipliers, of first order.
    #[default]
    ForwardIncrement,
    /// Event-driven motion, exact up to rounding between changes of contact state.
    EventDriven,
}

impl Method {
    /// Both methods.
    pub const ALL: [Self; 2] = [Self::ForwardIncrement, Self::EventDriven];

    /// Name of the method in a scene file and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ForwardIncrement => "forward-increment",
            Self::EventDriven => "event-driven",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
