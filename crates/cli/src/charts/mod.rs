//! Pictures of the results of studies. `amontons study` and the example `paper` draw them.

pub mod attractor;
pub mod branches;
pub mod continuation;
pub mod design;
mod kinds;
pub mod limit_cycle;
pub mod loudness;
pub mod perturbation;
pub mod robustness;
pub mod transient;
