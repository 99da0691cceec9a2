//! Makes an FMI 2.0 co-simulation FMU of a scene of Amontons.
//!
//! | module | contents |
//! | --- | --- |
//! | [`superelement`] | reads the matrix files of superelements |
//! | [`scene`] | reads a scene file and reports everything that is wrong with it, with its lines |
//! | [`package`] | the FMU as an archive: model description, libraries, the scene |
//! | [`documentation`] | what an FMU says of itself: its pages, its icon, a reference run |
//!
//! The build script compiles the crate `amontons` as the library that FMUs carry.

pub mod documentation;
mod feedthrough;
pub mod package;
pub mod scene;
pub mod superelement;
