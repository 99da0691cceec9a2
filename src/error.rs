//! The one error type of Amontons: opaque, with private kinds that grow with what can fail.

use crate::decimal::to_significant;
use std::fmt;
use std::path::Path;

/// Anything that can go wrong, in words that say what is wrong, where, and what would be right.
///
/// The kinds stay private so that they can grow; ask with the `is_*` methods.
#[derive(Clone, PartialEq)]
pub struct Error(Box<ErrorKind>);

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// Could a file not be read or written?
    File: unusable_file, is_file;
    /// Is the scene itself unusable: unreadable, a wrong key, an impossible value?
    Scene: scene, is_scene;
    /// Is there no static equilibrium to start from (jamming, or a contact that opens)?
    Equilibrium: equilibrium, is_equilibrium;
    /// Is the integration step above the critical step?
    StepTooLarge: step_too_large, is_step_too_large;
    /// Did the analysis of a contact state fail?
    Analysis: analysis, is_analysis;
    /// Did a step fail: a non-finite state, contact forces that do not converge, time going back?
    Step: step, is_step;
    /// Does a command name what there is not: a parameter, a contact state, a built-in scene?
    Argument: argument, is_argument;
    /// Is a variable unknown, or not one that may be set now?
    Variable: variable, is_variable;
    /// Was an FMI call made at the wrong time, or with arguments that cannot be used?
    Call: call, is_call;
    /// Is a saved state damaged, or not of this FMU?
    SavedState: saved_state, is_saved_state;
    /// Could an FMU not be read or written?
    Package: package, is_package;
    /// Could a picture not be drawn or written?
    Picture: picture, is_picture;
}

impl Error {
    /// A file could not be read or written.
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

/// A number in a message that was computed: the ten digits that rounding leaves of it.
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
