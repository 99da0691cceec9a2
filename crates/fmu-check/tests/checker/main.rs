//! Sound FMUs pass, and each rule finds what breaks it, and nothing else.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

mod archive;
mod description;
mod exporters;
mod fmu;
mod formats;
mod libraries;
mod outputs;
mod processes;
#[path = "../../../../tests/support/program.rs"]
mod program;
#[path = "../../../../tests/support/python/mod.rs"]
mod python;
mod rules;
mod survey;
mod trials;
