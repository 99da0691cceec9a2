//! The C interface of FMI 2.0 for co-simulation.
//!
//! | file | contents |
//! | --- | --- |
//! | `types` | C types under FMI's own names |
//! | `functions` | the exported functions: arguments in, status out |
//! | `boundary` | handles, arrays, and the catching of panics |
//! | `lifecycle` | the calls that are allowed in each phase, as one table |
//! | `instance` | the work behind the calls, in safe Rust |
//! | `logger` | messages to the importer |
//! | `resources` | location of the scene inside the FMU |
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

/// Digest of the sources of this library: a program is not built around a library of other sources.
#[allow(non_upper_case_globals, unsafe_code)]
// SAFETY: no other library has a symbol of this name.
#[unsafe(no_mangle)]
static amontons_sources: [u8; SOURCES.len()] = *SOURCES.first_chunk().unwrap();

const SOURCES: &[u8] = concat!("amontons sources ", env!("AMONTONS_SOURCES")).as_bytes();

pub use instance::{SCENE_FILE, STRICT};
pub use logger::CATEGORIES;
