//! Settings of an examination.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// A version of glibc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Glibc(pub u32, pub u32);

impl Default for Glibc {
    /// The version that every host still in use has at least (CentOS 7 and the tools built for it).
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

/// Settings of an examination: the glibc that libraries may need, and the run of the library.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The newest glibc that a library for Linux may need; without one, a newer glibc than [`Glibc::default`] is a
    /// hint.
    pub glibc: Option<Glibc>,
    /// Settings of the run of the library for this host; `None` examines files only.
    pub run: Option<Run>,
}

/// Settings of the run of a library.
#[derive(Clone, Debug)]
pub struct Run {
    /// The program that runs the library in processes of their own, as the subcommand [`COMMAND`](crate::COMMAND).
    pub program: PathBuf,
    /// Time limit of each trial of the library.
    pub timeout: Duration,
    /// `true` if the library is also run under valgrind, a memory checker, where that is installed.
    pub valgrind: bool,
}
