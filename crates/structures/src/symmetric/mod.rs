//! Structures whose matrices are symmetric: undamped modes with bounds, and reduction.

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
