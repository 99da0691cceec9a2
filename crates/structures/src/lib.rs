//! Structures of many degrees of freedom, given by sparse matrices.
//!
//! Quantities have the units of the matrices. Where a frequency is told in Hz, the unit of time of the matrices is a second.

pub mod family;
pub mod quadratic;
mod sparse;
pub mod symmetric;

pub use quadratic::Quadratic;
pub use sparse::Sparse;
