//! Studies of a scene beyond one run: the motions that it ends in, over the values of a parameter.
//!
//! | file | contents |
//! | --- | --- |
//! | `observation` | settings of the observation: output, rows, windows |
//! | `long_term` | the kinds of motion, and what is known of a motion that has settled |
//! | `settling` | detection of settled motions, and of their kinds |
//! | `windows` | size and lines of a motion from window to window, and their trend |
//! | `basis` | the modes of a contact state as a basis of its motions |
//! | `family` | detection of linear motions that are one of many with every size |
//! | `drive` | long-term behaviour of signals |
//! | `recurrence` | return of the state of a settled motion, and its period |
//! | `separation` | separation of neighbouring motions: the kind of a motion that does not come back |
//! | `beat` | the lines beside the strongest one and its multiples |
//! | `period` | quantities of a periodic motion over one period |
//! | `continuation` | endings over µ, upwards and downwards; jumps |
//! | `confirm` | pushes that may lead to the contact state of a candidate |
//! | `orbit` | one periodic motion, solved for itself |
//! | `branches` | branches of periodic motions over a parameter |
//! | `held` | velocities along which some contacts neither open nor close |
//! | `push` | a small push out of an equilibrium |
//! | `limit_cycle` | endings of a scene over the values of a parameter, and thresholds of contact states |
//! | `portrait` | phase portraits of a settled motion |
//! | `strobe` | states of a run at the ends of its drive's periods |
//! | `transient` | growth and decay of one run, band by band, beside eigenvalues |
//! | `attractor` | comparison of endings |
//! | `loudness` | growth of modes beside the loudness of the motions that they lead to |
//! | `initial` | runs from other initial values |
//! | `perturbation` | endings of perturbations, and the thresholds between |
//! | `basin` | attractors of the points of a plane of initial values |
//! | `work` | progress of the work on many points |
//!
//! A study is given its scene ready to run and gives plain data; files and pictures are the program's.

mod attractor;
pub mod basin;
mod basis;
mod beat;
mod branches;
pub mod confirm;
mod continuation;
mod difference;
mod drive;
mod fading;
mod family;
mod held;
mod initial;
mod limit_cycle;
mod linear;
mod long_term;
pub mod loudness;
mod observation;
mod orbit;
mod period;
pub mod perturbation;
mod portrait;
mod push;
mod recurrence;
mod separation;
mod settling;
mod strobe;
pub mod transient;
mod visit;
mod windows;
mod work;

pub use attractor::{attractors, is_same};
pub use branches::{BranchQuestion, Branches, RestBranch, RestCrossing, branches};
pub use continuation::{
    Bistable, Continuation, Jump, Plan, Point, RestAndMotion, SweepDirection, ThirdMotion,
    continuation,
};
pub(crate) use held::Held;
pub use initial::{history, initial_value};
pub use limit_cycle::{
    Change, LimitCycles, MotionBracket, Outcome, Question, Regime, limit_cycles, settled_motion,
};
pub use long_term::{Kind, LongTermMotion};
pub use observation::{
    ObservationRequest, ObservationSettings, Prepare, derive_pace, output, pace, set_pace, unit,
};
pub use orbit::{FoundOrbit, From, Unfound, orbit};
pub use portrait::{Orbit, Portrait};
pub use push::Push;
pub(crate) use push::closed_normals;
pub(crate) use settling::run_to_steady_state;
pub use visit::Visited;

pub use crate::journal::Journal;
pub use crate::watch::Watch;
