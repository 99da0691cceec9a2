//! Tests of the integrators: orders of convergence, kernels, steps, and changes that must not affect a result.

mod convergence;
mod coupled_contacts;
mod critical_step;
mod derivatives;
mod event_driven;
mod invariance;
mod kernels;
mod scheme;
mod superelement;
#[path = "../support/trajectory.rs"]
mod trajectory;
mod unsymmetric;
