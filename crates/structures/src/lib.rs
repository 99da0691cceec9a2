//! Structures of many degrees of freedom, given by sparse matrices.
//!
//! A module imports only from those above it:
//!
//! | module | contents |
//! | --- | --- |
//! | `random` | start vectors |
//! | `dissection` | orders of elimination |
//! | `sparse` | sparse matrices by columns |
//! | [`nodes`] | the motion of the nodes of a mesh |
//! | [`shapes`] | from the coordinates of a superelement to the motion of all rows |
//! | [`symmetric`] | undamped structures: modes with bounds, superelements with a certificate |
//! | [`quadratic`] | complex eigenvalues in a rectangle, and a count that shows that none is missing |
//! | [`family`] | matrices that depend on a parameter, and their modes followed over it |
//!
//! Quantities have the units of the matrices. Where a frequency is told in Hz, the unit of time of the matrices is a second.

mod dissection;
pub mod family;
pub mod nodes;
pub mod quadratic;
mod random;
pub mod shapes;
mod sparse;
pub mod symmetric;

pub use quadratic::Quadratic;
pub use sparse::Sparse;
