//! How the integrators compute: orders of convergence, kernels, steps, and what must not change a result.

mod convergence;
mod coupled_contacts;
mod critical_step;
mod derivatives;
mod event_driven;
mod invariance;
mod kernels;
mod scheme;
#[path = "../support/trajectory.rs"]
mod trajectory;
