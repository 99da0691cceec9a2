//! Stability of the contact states: here, the largest step that the explicit scheme can take.

mod critical_step;

pub use critical_step::{CriticalStep, Origin, StepGuard, critical_step};
