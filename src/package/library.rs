//! The library that goes into every FMU; `build.rs` made it from this same crate.

/// The library itself.
pub(super) const BYTES: &[u8] = include_bytes!(env!("AMONTONS_FMU_LIBRARY"));

/// The platform that the library is for, as FMI names it; `build.rs` refuses others.
pub const PLATFORM: &str = "linux64";

/// The end of the library's file name.
pub(super) const EXTENSION: &str = "so";
