//! The error type of Amontons, opaque so that its private kinds can grow.

use crate::decimal::to_significant;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// An error of Amontons, with a message that says what is wrong, where, and what would be right.
///
/// The kinds are private so that they can grow; the `is_*` methods tell them apart.
///
/// ```
/// use amontons::scene::parse;
///
/// let error = parse("empty", "").unwrap_err();
/// assert!(error.is_scene() && !error.is_step());
/// ```
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub struct Error(Box<ErrorKind>);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
enum ErrorKind {
    #[error("{0}")]
    File(String),
    #[error("{0}")]
    Scene(String),
    #[error("{0}")]
    Equilibrium(String),
    #[error("{0}")]
    StepTooLarge(String),
    #[error("{0}")]
    Analysis(String),
    #[error("{0}")]
    Step(String),
    #[error("{0}")]
    Argument(String),
    #[error("{0}")]
    Variable(String),
    #[error("{0}")]
    Call(String),
    #[error("{0}")]
    SavedState(String),
    #[error("{0}")]
    Package(String),
    #[error("{0}")]
    Picture(String),
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident: $make:ident, $is:ident;)*) => {
        impl Error {
            $(
                #[doc = concat!("The error of which [`", stringify!($is), "`](Self::", stringify!($is), ") is true.")]
                pub fn $make(message: impl Into<String>) -> Self {
                    Self(Box::new(ErrorKind::$kind(message.into())))
                }

                $(#[$doc])*
                pub fn $is(&self) -> bool {
                    matches!(*self.0, ErrorKind::$kind(_))
                }
            )*

            /// An error of the same kind in other words.
            #[must_use]
            pub fn in_words(&self, message: impl Into<String>) -> Self {
                match *self.0 {
                    $(ErrorKind::$kind(_) => Self::$make(message),)*
                }
            }
        }
    };
}

kinds! {
    /// `true` if a file could not be read or written.
    File: unusable_file, is_file;
    /// `true` if the scene itself is unusable: unreadable, with a wrong key or an impossible value.
    Scene: scene, is_scene;
    /// `true` if there is no static equilibrium to start from (jamming, or a contact that opens).
    Equilibrium: equilibrium, is_equilibrium;
    /// `true` if the integration step is above the critical step.
    StepTooLarge: step_too_large, is_step_too_large;
    /// `true` if the analysis of a contact state failed.
    Analysis: analysis, is_analysis;
    /// `true` if a step failed: a non-finite state, contact forces that do not converge, time going back.
    Step: step, is_step;
    /// `true` if a command names an unknown parameter, contact state or built-in scene.
    Argument: argument, is_argument;
    /// `true` if a variable is unknown, or may not be set now.
    Variable: variable, is_variable;
    /// `true` if an FMI call was made at the wrong time, or with arguments that cannot be used.
    Call: call, is_call;
    /// `true` if a saved state is damaged, or belongs to another FMU.
    SavedState: saved_state, is_saved_state;
    /// `true` if an FMU could not be read or written.
    Package: package, is_package;
    /// `true` if a picture could not be drawn or written.
    Picture: picture, is_picture;
}

impl Error {
    /// The error of a file that could not be read or written.
    #[must_use]
    pub fn file(path: &Path, error: &std::io::Error) -> Self {
        Self::unusable_file(format!("cannot use {}: {error}", path.display()))
    }
}

/// A number in a message: the shortest that reads back as the same double, with a power of ten where it is far from one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short(pub f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:?}", self.0);
        f.write_str(text.strip_suffix(".0").unwrap_or(&text))
    }
}

/// A computed number in a message, rounded to ten significant digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded(pub f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Short(to_significant(self.0, 10)).fmt(f)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_messages_are_short_whatever_their_size() {
        for (value, text) in [
            (6.0, "6"),
            (-0.25, "-0.25"),
            (0.0002, "0.0002"),
            (1e-300, "1e-300"),
            (1e308, "1e308"),
            (-2.5e17, "-2.5e17"),
            (123_456_789.0, "123456789"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Short(value).to_string(), text);
        }
    }
}
