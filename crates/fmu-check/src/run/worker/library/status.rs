//! The status that calls return, `fmi2Status`.

use super::Status;
use std::fmt;

const WARNING: Status = 1;
const DISCARD: Status = 2;
const ERROR: Status = 3;
const FATAL: Status = 4;
const PENDING: Status = 5;

/// Reasons for which a call did not succeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    Status(Status),
    /// The library does not export the function.
    Missing,
    /// The library states a size that no memory can have.
    Size(usize),
}

impl Refused {
    /// `true` if the step was not completed: it was discarded, or it is pending.
    pub(crate) fn is_no_step(self) -> bool {
        matches!(self, Self::Status(DISCARD | PENDING))
    }

    /// `true` if the status is fmi2Fatal, after which no instance may be used.
    pub(crate) fn is_fatal(self) -> bool {
        self == Self::Status(FATAL)
    }
}

/// The answer of the call, in words.
impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Status(DISCARD) => f.write_str("fmi2Discard"),
            Self::Status(ERROR) => f.write_str("fmi2Error"),
            Self::Status(FATAL) => f.write_str("fmi2Fatal"),
            Self::Status(PENDING) => f.write_str("fmi2Pending"),
            Self::Status(other) => write!(f, "{other}, which is not a value of fmi2Status"),
            Self::Missing => f.write_str("nothing (it is not exported)"),
            Self::Size(size) => write!(f, "a size of {size} bytes, which cannot be allocated"),
        }
    }
}

pub(super) fn succeeded(status: Status) -> Result<(), Refused> {
    if (0..=WARNING).contains(&status) { Ok(()) } else { Err(Refused::Status(status)) }
}
