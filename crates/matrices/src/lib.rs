//! Reads sparse matrices that finite-element programs and numerical tools write.
//!
//! [`open`] reads a file. Each reader takes the bytes of a file, so that it can be tried without one. A fault in a file is an
//! [`Error`] with the line or the offset, and the remedy; no content makes a reader panic, and none needs more memory than
//! its entries do.

pub mod abaqus;
mod abaqus_elements;
mod align;
mod builder;
pub mod calculix;
mod cards;
mod compressed;
pub mod dmig;
mod error;
mod freedoms;
pub mod harwell_boeing;
mod labelled;
pub mod mapping;
pub mod mat;
pub mod mat73;
mod matrix;
pub mod matrix_market;
pub mod npy;
pub mod npz;
mod numbers;
mod open;
pub mod output4;
mod output4_binary;
mod output4_text;
mod text;
mod write;

pub use align::align;
pub use error::{Error, Fault, Place};
pub use freedoms::{read_freedoms, write_freedoms};
pub use matrix::{Entry, Freedom, Matrix, Symmetry};
pub use open::{Location, open};
pub use write::{write_matrix_market, write_npy};
