//! What an examination is asked to do.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// A version of glibc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Glibc(pub u32, pub u32);

impl Default for Glibc {
    /// What hosts still in use have at least (CentOS 7 and the tools built for it).
    fn default() -> Self {
        Self(2, 17)
    }
}

impl fmt::Display for Glibc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.0, self.1)
    }
}

impl FromStr for Glibc {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wish = || "must be a version of glibc, such as 2.17".to_owned();
        let (major, rest) = text.split_once('.').ok_or_else(wish)?;
        let minor = rest.split('.').next().unwrap_or_default();
        Ok(Self(major.parse().map_err(|_| wish())?, minor.parse().map_err(|_| wish())?))
    }
}

/// What to examine, and against what.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The newest glibc that a library for Linux may need; without one, a newer glibc than [`Glibc::default`] is a
    /// hint.
    pub glibc: Option<Glibc>,
    /// How to run the library for this host; none examines files only.
    pub run: Option<Run>,
}

/// How to run a library.
#[derive(Clone, Debug)]
pub struct Run {
    /// This crate's program, which runs the library in a process of its own.
    pub program: PathBuf,
    /// How long that process may take.
    pub timeout: Duration,
}
