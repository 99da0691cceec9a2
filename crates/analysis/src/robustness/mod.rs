//! Robustness: the probability that a scene is unstable, when its parameters scatter.
//!
//! | file | contents |
//! | --- | --- |
//! | `normal` | the normal distribution and its inverse |
//! | `distribution` | distributions as people write them, and draws from them |
//! | `sobol` | Sobol's sequence with nested uniform scrambling |
//! | `interval` | intervals of 95 % for means and shares |
//! | `sensitivity` | first-order and total Sobol indices |
//! | `uncertain` | the parameters of a scene that scatter |
//! | `draws` | the eigenvalues of a draw, and pieces of work |
//! | `rates` | the largest growth rates for values that are given |
//! | `histogram` | classes of growth rates, families of frequencies |
//! | `study` | the probability that a contact state is unstable |
//! | `squeal` | the probability that a scene squeals after a push |
//! | `direction` | the random direction of a push |
//! | `both` | draws and runs as one study |

mod both;
mod direction;
mod distribution;
mod draws;
mod histogram;
mod interval;
mod normal;
mod rates;
mod sensitivity;
mod sobol;
mod squeal;
mod study;
mod uncertain;

pub use both::{Both, both};
pub use distribution::{Distribution, Draws};
pub use draws::{Design, Verdict, verdict};
pub use histogram::Class;
pub use interval::Estimate;
pub use rates::{check_names, growth_rates};
pub use sensitivity::Index;
pub(crate) use sobol::random;
pub use squeal::{End, PushedRun, Pushes, Squeals, check_runs, push_velocity, squeals};
pub use study::{Band, FEWEST_SCRAMBLINGS, Robustness, check_size, robustness};
pub use uncertain::{Described, Parameter, Uncertain, parameters, scene_with};
pub(crate) use uncertain::{matches, matching, settable};
