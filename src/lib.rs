//! Friction contact dynamics of lumped models, packaged as FMI 2.0 co-simulation FMUs.
//!
//! The modules form a sequence; a module imports only from modules above it:
//!
//! | module | contents |
//! | --- | --- |
//! | [`numerics`] | bisection; the norm and the range of values; complementarity |
//! | [`decimal`] | significant digits, and the series 1, 2, 5 |
//! | [`error`] | the one error type |
//! | [`contact`] | contact states and the Signorini–Coulomb law of one contact |
//! | [`model`] | mass, stiffness, load and contacts; equilibrium; the linear model of a contact state |
//! | [`stability`] | eigenvalues of contact states, and the critical step |
//! | [`integrator`] | forward increment Lagrange multipliers; event-driven motion |
//! | [`scene`] | the file as its user writes it, checked |
//! | [`assembly`] | the model of a scene |
//! | [`selection`] | the rule by which a tolerance chooses method and step |
//! | [`simulation`] | model and motion together: advance, read, write, save, restore |
//! | [`fmi2`] | the C interface of FMI 2.0 for co-simulation |
//!
//! The book in `docs/` (`SUMMARY.md` lists its pages) has tutorials, the scene file, the FMU and the analyses for users, and
//! the equations, decisions and a map of the repository for developers. Its glossary, `docs/glossary.md`, gives the paper's
//! term, the field's term and the code's name of each notion.
//!
//! All quantities are in SI units.

pub mod assembly;
pub mod contact;
pub mod decimal;
pub mod error;
pub mod fmi2;
pub mod integrator;
pub mod model;
pub mod numerics;
pub mod scene;
pub mod selection;
pub mod simulation;
pub mod stability;

pub use error::Error;
