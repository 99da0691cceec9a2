//! FMUs in importers of other houses, coupled to each other, and on other platforms.

#[path = "../../../../examples/coupled.rs"]
mod coupled;
mod coupling;
mod fmpy;
mod importers;
mod platforms;
#[path = "../../../../tests/support/program.rs"]
mod program;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
