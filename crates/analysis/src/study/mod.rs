//! Studies of a scene beyond one run: the motions that it ends in, over the values of a parameter.
//!
//! | file | what it is |
//! | --- | --- |
//! | `look` | which output is looked at, how often, for how long |
//! | `ending` | the kinds of motion, and what is known of a motion that has settled |
//! | `settling` | when a motion has settled, and in what |
//! | `windows` | how large a motion is from window to window, which lines it has, and whether both stay |
//! | `basis` | the modes of a contact state as a basis of its motions |
//! | `family` | whether a linear motion is one of many with every size |
//! | `drive` | what signals do in the end |
//! | `recurrence` | whether the state of a settled motion comes back, and after which period |
//! | `parting` | how neighbouring motions part: the kind of a motion that does not come back |
//! | `beat` | the lines beside the strongest one and its multiples |
//! | `period` | what a periodic motion does over one period |
//! | `continuation` | what it ends in over µ, upwards and downwards; jumps |
//! | `confirm` | whether a push leads to the contact state of a candidate |
//! | `push` | a small push out of an equilibrium |
//! | `limit_cycle` | what a scene ends in over the values of a parameter, and where contact states come and go |
//! | `portrait` | phase portraits of a settled motion |
//! | `transient` | how one run grows and decays, band by band, beside eigenvalues |
//! | `attractor` | which endings are the same motion |
//! | `initial` | runs from other initial values |
//! | `perturbation` | what perturbations end in, and the thresholds between |
//! | `basin` | which points of a plane of initial values end in which attractor |
//! | `work` | how far the work on many points is |
//! | `journal` | finished pieces of work, so that a study that was ended goes on from there |
//!
//! A study is given its scene ready to run and gives plain data; files and pictures are the program's.

mod attractor;
pub mod basin;
mod basis;
mod beat;
mod blocks;
pub mod confirm;
mod continuation;
mod difference;
mod drive;
mod ending;
mod fading;
mod family;
mod initial;
mod journal;
mod limit_cycle;
mod linear;
mod look;
mod parting;
mod period;
pub mod perturbation;
mod portrait;
mod push;
mod recurrence;
mod settling;
pub mod transient;
mod visit;
mod windows;
mod work;

pub use attractor::{attractors, is_same};
pub use continuation::{Bistable, Both, Continuation, Jump, Plan, Point, Third, Way, continuation};
pub use ending::{Ending, Kind};
pub use initial::{history, initial_value};
pub use journal::{Journal, Owner};
pub use limit_cycle::{
    Change, LimitCycles, MotionBracket, Outcome, Question, Regime, limit_cycles,
};
pub use look::{Look, Prepare, Wish, output, pace, unit};
pub use portrait::{Orbit, Portrait};
pub use push::Push;
pub use visit::Visited;

pub use crate::watch::Watch;
