//! The libraries that FMUs get; the build script has made or found them.

include!(concat!(env!("OUT_DIR"), "/libraries.rs"));

/// Platforms whose libraries a release carries.
const MADE: [&str; 2] = ["linux64", "win64"];

/// The library of an FMU for one platform: the crate `amontons` as a shared library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Library {
    /// The platform, as FMI names it: `linux64`, `win64`.
    pub platform: &'static str,
    /// The end of the library's file name.
    pub extension: &'static str,
    pub(super) bytes: &'static [u8],
}

impl Library {
    /// All libraries that this program carries, by their platforms' names.
    #[must_use]
    pub fn carried() -> &'static [Self] {
        CARRIED
    }

    /// The library for a platform.
    ///
    /// # Errors
    /// Returns an error if this program carries none for it; the message says how to get one that does.
    pub fn of(platform: &str) -> Result<Self, String> {
        let platform = platform.trim();
        CARRIED.iter().find(|library| library.platform == platform).copied().ok_or_else(|| {
            let carried: Vec<&str> = CARRIED.iter().map(|library| library.platform).collect();
            let carried = carried.join(" and ");
            if MADE.contains(&platform) {
                format!(
                    "this program contains the library for {carried} only; a released program contains all libraries, \
                     and release/make or AMONTONS_FMU_LIBRARIES builds such a program (docs/fmu/platforms.md)"
                )
            } else {
                let made = MADE.join(" and ");
                format!("FMUs can be made for {made}; this program contains the library for {carried}")
            }
        })
    }
}
