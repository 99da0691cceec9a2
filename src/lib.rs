//! Friction contact dynamics of lumped models, packaged as FMI 2.0 co-simulation FMUs.
//!
//! The way through the crate goes in one direction; a module imports only from modules above it:
//!
//! | module | what lives there |
//! | --- | --- |
//! | [`error`] | the one error type |
//! | [`contact`] | contact states and the Signorini–Coulomb law of one contact |
//! | [`scene`] | the file as its user writes it, checked |
//! | [`model`] | mass, stiffness, load and contact directions; equilibrium; reduced matrices |
//! | [`stability`] | the critical step, from the eigenvalues of the contact states |
//! | [`integrator`] | forward increment Lagrange multipliers |
//! | [`simulation`] | model and motion together: advance, read, write, save, restore |
//! | [`fmi2`] | the C interface of FMI 2.0 for co-simulation |
//!
//! All quantities are in SI units.

pub mod contact;
pub mod error;
pub mod fmi2;
pub mod integrator;
pub mod model;
pub mod scene;
pub mod simulation;
pub mod stability;

pub use error::Error;
