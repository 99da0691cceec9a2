//! The exit codes of the programs; clap also uses 2 for wrong arguments.

use crate::interrupt::Interrupted;
use crate::shards::Missing;

/// A file cannot be read or written, or the work has failed.
pub const FAILED: u8 = 1;
/// The arguments are wrong.
pub const ARGUMENTS: u8 = 2;
/// The scene is wrong.
pub const SCENE: u8 = 3;
/// The run of a scene has failed.
pub const RUN: u8 = 4;
/// It was not shown that no mode is missing.
pub const NOT_SHOWN: u8 = 4;
/// Pieces of a study are missing that other workers compute.
pub const MISSING: u8 = 5;
/// The user has ended the command; shells use this code for Ctrl-C.
pub const INTERRUPTED: u8 = 130;

/// The exit code for an error of the libraries, [`Interrupted`] or [`Missing`]; other errors give [`FAILED`].
#[must_use]
pub fn code(error: &(dyn std::error::Error + 'static)) -> u8 {
    if error.is::<Interrupted>() {
        return INTERRUPTED;
    }
    if error.is::<Missing>() {
        return MISSING;
    }
    match error.downcast_ref::<amontons::Error>() {
        Some(error) if error.is_argument() => ARGUMENTS,
        Some(error) if error.is_step() => RUN,
        Some(error) if error.is_package() || error.is_file() || error.is_picture() => FAILED,
        Some(_) => SCENE,
        None => FAILED,
    }
}
