//! Friction contact dynamics of lumped models, packaged as FMI 2.0 co-simulation FMUs.
//!
//! The way through the crate goes in one direction; a module imports only from modules above it:
//!
//! | module | what lives there |
//! | --- | --- |
//! | [`error`] | the one error type |
//! | [`output`] | files that appear whole or not at all (feature `tools`) |
//! | [`progress`] | how far a long command is: a bar, or a line now and then (feature `tools`) |
//! | [`spectral`] | spectra of histories (feature `tools`) |
//! | [`contact`] | contact states and the Signorini–Coulomb law of one contact |
//! | [`scene`] | the file as its user writes it, checked |
//! | [`model`] | mass, stiffness, load and contact directions; equilibrium; reduced matrices |
//! | [`stability`] | the critical step, from the eigenvalues of the contact states |
//! | [`integrator`] | forward increment Lagrange multipliers |
//! | [`simulation`] | model and motion together: advance, read, write, save, restore |
//! | [`accuracy`] | how far each method and step is from a proven reference (feature `tools`) |
//! | [`sweep`] | many runs over the values of a parameter (feature `tools`) |
//! | [`study`] | what a scene ends in: limit cycles, perturbations, branches over µ, basins (feature `tools`) |
//! | `fmi2` | the C interface of FMI 2.0 for co-simulation |
//! | [`package`] | the FMU as an archive (feature `tools`) |
//! | [`picture`] | charts, maps, moving mode shapes and structures as SVG or PNG (feature `tools`) |
//! | [`report`] | claims, figures and tables as one HTML page (feature `tools`) |
//! | [`documentation`] | what an FMU says of itself: its pages, its icon, a reference run (feature `tools`) |
//!
//! All quantities are in SI units.

#[cfg(feature = "tools")]
pub mod accuracy;
pub mod contact;
#[cfg(feature = "tools")]
pub mod documentation;
pub mod error;
mod fmi2;
pub mod integrator;
pub mod model;
#[cfg(feature = "tools")]
pub mod output;
#[cfg(feature = "tools")]
pub mod package;
#[cfg(feature = "tools")]
pub mod picture;
#[cfg(feature = "tools")]
pub mod progress;
#[cfg(feature = "tools")]
pub mod report;
pub mod scene;
pub mod simulation;
#[cfg(feature = "tools")]
pub mod spectral;
pub mod stability;
#[cfg(feature = "tools")]
pub mod study;
#[cfg(feature = "tools")]
pub mod sweep;

pub use error::Error;
