//! A branch of periodic motions over a parameter, by pseudo-arclength.
//!
//! The parameter is one more unknown of the [chain](super::chain), and the distance from the last point along the
//! branch one more equation, so folds are points like others. Distances are measured in the first state, in parts of
//! the motion's size, and in the parameter, in parts of its range.
//!
//! Each point is confirmed by the event-driven integrator. Where the integrator finds another sequence of events than
//! the chain has, a contact touches, lifts, stops or reaches its limit of friction just there. The place is bisected,
//! and the branch goes on with the sequence that a run beyond it finds, on either side of the parameter; if there is
//! none near, it ends there. Points at which the number of multipliers outside the unit circle changes are bisected
//! too.

use super::Orbit;
use super::flow::Flow;
use amontons::Error;
use amontons::integrator::Event;
use serde::{Deserialize, Serialize};

/// The flow with a value of the parameter.
pub type FlowAt<'a> = dyn Fn(f64) -> Result<Flow, Error> + 'a;

/// A periodic motion at a value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// The value of the parameter.
    pub parameter: f64,
    /// The motion.
    pub orbit: Orbit,
}

/// The kind of a special point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpecialKind {
    /// The branch turns back; a multiplier is 1.
    Fold,
    /// A multiplier is 1 without a fold: branches cross, as where a symmetry is lost.
    BranchPoint,
    /// A multiplier is −1: a motion of twice the period begins.
    PeriodDoubling,
    /// A pair of multipliers has magnitude 1: beyond it the motion is quasi-periodic, and not followed.
    NeimarkSacker,
    /// The sequence of events changes: this event of a contact (from 0) appears or vanishes, where it is known.
    Sequence(Option<(usize, Event)>),
    /// The sequence of events changes, and the branch turns back at once without a multiplier 1.
    SequenceFold(Option<(usize, Event)>),
}

/// A special point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecialPoint {
    /// The value of the parameter.
    pub parameter: f64,
    /// Its kind.
    pub kind: SpecialKind,
    /// The motion nearest to it.
    pub orbit: Orbit,
    /// The place among the points of the branch behind which it is.
    pub place: usize,
}

/// How a branch ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BranchEnd {
    /// At the end of the parameter's range.
    Range,
    /// Where it began.
    Closed,
    /// At a change of the sequence of events, beyond which no motion is near: a discontinuous fold, or a place where the
    /// motion has no derivative. The contact, and its event that appears or vanishes.
    Grazing(usize, Event),
    /// In a motion without any event, which is linear: one of the neutral cycles of every size at a critical value.
    Linear,
    /// After as many points as were allowed.
    Points,
    /// Where no next point was found.
    NotConverged,
}

/// A branch of periodic motions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// Its points, in their order along the branch.
    pub points: Vec<BranchPoint>,
    /// Its special points, in the same order.
    pub specials: Vec<SpecialPoint>,
    /// How it ends before its first and behind its last point.
    pub ends: [BranchEnd; 2],
}

/// The parameter over which a branch is followed, and how far.
pub struct Continued<'a> {
    /// The flow with a value of the parameter.
    pub flow_at: &'a FlowAt<'a>,
    /// The range of the parameter.
    pub range: [f64; 2],
    /// Most points to either side.
    pub most_points: usize,
    /// Receives the number of points found so far, and returns `false` to end the work.
    pub goes_on: &'a dyn Fn(usize) -> bool,
}
