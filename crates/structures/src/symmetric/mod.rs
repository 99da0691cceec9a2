//! Structures whose matrices are symmetric: undamped modes with bounds, and reduction.
//!
//! ```
//! use amontons_analysis::watch::Watch;
//! use amontons_matrices::matrix_market;
//! use amontons_structures::symmetric::{Request, Structure, certify, reduce};
//!
//! // Two masses of 1 kg and two springs of 1 N/m in a row, held at one end: ω² = (3 ± √5)/2.
//! let head = "%%MatrixMarket matrix coordinate real symmetric\n2 2";
//! let read = |entries: &str| matrix_market::read(format!("{head} {entries}").as_bytes()).unwrap();
//! let structure = Structure::new(&read("3\n1 1 2\n2 1 -1\n2 2 1\n"), &read("2\n1 1 1\n2 2 1\n"))?;
//! // Row 1, the free end, is retained; the mode that is left has ω = √2.
//! let request = Request { retained: vec![1], modes_to: 1.0, memory: 1 << 30 };
//! let superelement = reduce(&structure, &request, Watch::IDLE)?;
//! assert!((superelement.modes[0] - 2.0).abs() < 1e-14);
//! let certificate = certify(&structure, &superelement, &[], 1.0, 1 << 30, Watch::IDLE)?;
//! assert!(certificate.is_complete() && certificate.full == 2);
//! assert!((certificate.intervals[0].value - (3.0 - 5_f64.sqrt()) / 2.0).abs() < 1e-14);
//! # Ok::<(), amontons::Error>(())
//! ```

mod bounds;
mod certificate;
mod factor;
mod lanczos;
mod modes;
mod reduction;
mod structure;

pub use bounds::{Bounded, frequency};
pub use certificate::{Certificate, certify};
pub use reduction::{Request, Superelement, reduce};
pub use structure::Structure;
