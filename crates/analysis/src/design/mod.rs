//! Design: the smallest change of a scene after which no mode grows over a range of friction coefficients.
//!
//! | file | contents |
//! | --- | --- |
//! | `vary` | the values of a scene that may change, and how far |
//! | `limits` | growth rates over the range of µ, with their derivatives by the changes |
//! | `solver` | sequential quadratic programs in a trust region |
//! | `search` | solutions that hold between the values of µ, from several starts |
//! | `verify` | verification of a design: eigenvalues on a finer grid, equilibria, candidates, runs after pushes |
//! | `study` | the design, its trade-off with the growth rate, and its verification |
//! | `request` | a design as people ask for it, and the question that follows for a scene |

mod limits;
mod request;
mod search;
mod solver;
mod study;
mod vary;
mod verify;

pub use request::{DesignRequest, ReadyDesign};
pub use study::{DesignQuestion, FoundDesign, Growth, Reached, Start, design};
pub use vary::{Part, Range, Varied, Vary, scene_at, varied};
pub use verify::{Checked, PushedRuns, Remaining, Worst};
