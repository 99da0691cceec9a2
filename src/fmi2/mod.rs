//! The C interface of FMI 2.0 for co-simulation.
//!
//! | file | what it does |
//! | --- | --- |
//! | `types` | C types under FMI's own names |
//! | `functions` | the exported functions: arguments in, status out |
//! | `boundary` | handles, arrays, and the fence that no panic crosses |
//! | `lifecycle` | which call is allowed when, as one table |
//! | `instance` | what the calls do, in safe Rust |
//! | `logger` | messages to the importer |
//! | `resources` | where the scene inside the FMU lies |
//!
//! `unsafe` is confined to this module. An importer's contract (live handles, arrays as long as
//! said, terminated strings) is the safety condition of every exported function.

mod boundary;
mod functions;
mod instance;
mod lifecycle;
mod logger;
mod resources;
mod types;

/// Of which sources this library is: a program is not built around one of others.
#[allow(non_upper_case_globals, unsafe_code)]
// SAFETY: no other library has anything of this name.
#[unsafe(no_mangle)]
static amontons_sources: [u8; SOURCES.len()] = *SOURCES.first_chunk().unwrap();

const SOURCES: &[u8] = concat!("amontons sources ", env!("AMONTONS_SOURCES")).as_bytes();

pub use instance::{SCENE_FILE, STRICT};
pub use logger::CATEGORIES;
