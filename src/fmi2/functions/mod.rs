//! The functions of FMI 2.0 for co-simulation with their C signatures, grouped by purpose.
//!
//! Each function only converts its arguments into safe ones and leaves the work to [`Instance`](super::instance::Instance).
//!
//! Each function is called by an importer that keeps FMI's contract: handles come from `fmi2Instantiate` and are
//! live, arrays have the length given with them, strings are terminated. That contract is the safety condition of all
//! of them and the reason given in each block.
#![allow(non_snake_case, unsafe_code, clippy::missing_safety_doc)]

mod derivatives;
mod life;
mod saved_states;
mod steps;
mod variables;
