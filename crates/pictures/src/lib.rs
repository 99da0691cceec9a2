//! Pictures of scenes of Amontons and of what analyses find in them.
//!
//! | module | contents |
//! | --- | --- |
//! | [`picture`] | charts, maps, moving mode shapes and structures as SVG or PNG |
//! | [`report`] | claims, figures and tables as one HTML page |

pub mod picture;
pub mod report;
