//! Reads sparse matrices, and [meshes](mesh), that finite-element programs and numerical tools write.
//!
//! [`open`] reads a file. Each reader takes the bytes of a file, so that it can be tried without one. A fault in a file is an
//! [`Error`] with the line or the offset, and the remedy. No content makes a reader panic, and its memory is bounded by the size of
//! the file, of which packed parts may unpack to 64 times as much and 32 MiB.
//!
//! ```
//! use amontons_matrices::matrix_market;
//!
//! let file = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 1D0\n";
//! let matrix = matrix_market::read(file.as_bytes())?;
//! // Both triangles, by columns.
//! let values: Vec<f64> = matrix.entries.iter().map(|entry| entry.value).collect();
//! assert_eq!(values, [2.0, -1.0, -1.0, 1.0]);
//! # Ok::<(), amontons_matrices::Fault>(())
//! ```

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
pub mod mesh;
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
pub use freedoms::{name_rows, read_freedoms, write_freedoms};
pub use matrix::{Entry, Freedom, Matrix, Symmetry};
pub use open::{Location, open};
pub use write::{write_matrix_market, write_npy};
