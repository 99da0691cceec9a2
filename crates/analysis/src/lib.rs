//! Analyses of scenes of Amontons: stability of contact states, studies of motions, sweeps, accuracy.
//!
//! A module imports only from the crate `amontons` and from modules above it:
//!
//! | module | contents |
//! | --- | --- |
//! | [`watch`] | progress of long work, and its end before it is done |
//! | [`record`] | a run of an experiment, row by row |
//! | [`journal`] | finished pieces of work, with which work that was ended continues, and which several workers share |
//! | [`output`] | files of results that appear whole or not at all |
//! | [`patterns`] | patterns of contact states that a run went through, and their names |
//! | `statistics` | statistics of values |
//! | [`regions`] | classes of a plane of points, found without looking at each point |
//! | [`spectral`] | spectra of histories |
//! | [`assign`] | a value of a scene, by its variable's name |
//! | [`instant`] | what an analysis at one instant says of the signals that it leaves out |
//! | [`inputs`] | inputs over time from a CSV file |
//! | [`effects`] | all effects of the model for one scene |
//! | [`stability`] | modes, loci over a parameter, bi-stable candidates, maps |
//! | [`doubts`], [`warning`] | values that are possible, but hardly meant |
//! | [`accuracy`] | the distance of each method and step from a proven reference |
//! | [`sweep`] | many runs over the values of a parameter |
//! | [`orbit`] | periodic motions solved for themselves, with Floquet multipliers |
//! | [`study`] | endings of a scene: limit cycles, perturbations, branches over µ, basins |
//! | [`robustness`] | the probability that a scene is unstable, when its parameters scatter |
//! | [`design`] | the smallest change of a scene after which it does not squeal |
//!
//! All quantities are in SI units.

pub mod accuracy;
pub mod assign;
pub mod design;
pub mod doubts;
pub mod effects;
pub mod inputs;
pub mod instant;
pub mod journal;
pub mod orbit;
pub mod output;
pub mod patterns;
pub mod record;
pub mod regions;
pub mod robustness;
pub mod spectral;
pub mod stability;
mod statistics;
pub mod study;
pub mod sweep;
pub mod warning;
pub mod watch;
