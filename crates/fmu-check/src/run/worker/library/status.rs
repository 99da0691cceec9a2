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
    /// The library gave a Boolean a value that is neither `fmi2True` nor `fmi2False`.
    NoBoolean(i32),
    /// An earlier call returned fmi2Fatal or fmi2Pending, so that the function was not called.
    Lost,
}

impl Refused {
    /// `true` if the step was not completed: it was discarded, or it is pending.
    pub(crate) fn is_no_step(self) -> bool {
        matches!(self, Self::Status(DISCARD | PENDING))
    }

    /// `true` if the library has given up the instance.
    pub(crate) fn is_fatal(self) -> bool {
        matches!(self, Self::Status(FATAL) | Self::Lost)
    }

    /// `true` if no function of the instance may be called after this.
    pub(super) fn is_last(self) -> bool {
        matches!(self, Self::Status(FATAL | PENDING))
    }
}

pub(super) fn is_warning(status: Status) -> bool {
    status == WARNING
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
            Self::NoBoolean(value) => {
                write!(f, "the value {value}, which is neither fmi2True (1) nor fmi2False (0)")
            }
            Self::Lost => {
                f.write_str("nothing (an earlier call returned fmi2Fatal or fmi2Pending)")
            }
            Self::Size(size) => write!(f, "a size of {size} bytes, which cannot be allocated"),
        }
    }
}

pub(super) fn succeeded(status: Status) -> Result<(), Refused> {
    if (0..=WARNING).contains(&status) { Ok(()) } else { Err(Refused::Status(status)) }
}
