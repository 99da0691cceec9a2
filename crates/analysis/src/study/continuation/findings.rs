//! Results of a continuation: the motions of both ways, jumps, and ranges with two motions.

use crate::study::long_term::{Kind, LongTermMotion};
use serde::{Deserialize, Serialize};

/// Direction in which µ changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SweepDirection {
    /// Upwards, from the first value to the last.
    Rising,
    /// Downwards, from the last value to the first.
    Falling,
}

impl SweepDirection {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Rising, Self::Falling];

    /// The opposite one.
    pub(super) const fn other(self) -> Self {
        match self {
            Self::Rising => Self::Falling,
            Self::Falling => Self::Rising,
        }
    }

    /// Name of the direction in tables and in the journal.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rising => "rising",
            Self::Falling => "falling",
        }
    }
}

/// A value of µ on one of the ways.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// µ.
    pub friction: f64,
    /// The ending of the motion, or the reason of its failure; after a failure a way is not followed further.
    pub ending: Result<LongTermMotion, String>,
}

/// Value of µ at which one motion gives way to another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jump {
    /// Direction in which µ changes.
    pub way: SweepDirection,
    /// The way whose values it lies among; `None` of an end of a motion that stands among neither way's values. The falling
    /// way, too, has jumps of rising µ: upper ends of motions that stand among its values.
    pub among: Option<SweepDirection>,
    /// `true` at the end of a motion that was followed no farther; `false` where a way continues with the motion
    /// after the jump.
    pub is_end: bool,
    /// The last µ that still has the motion, and the first that has it no more.
    pub between: [f64; 2],
    /// The motion there, before and after.
    pub endings: [LongTermMotion; 2],
}

impl Jump {
    /// The middle of its bounds.
    #[must_use]
    pub fn at(&self) -> f64 {
        0.5 * (self.between[0] + self.between[1])
    }
}

/// A range of µ in which two different motions were met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bistable {
    /// Ends of the range: the jumps that bound it or, where it reaches the ends of the followed values, those values.
    pub range: [f64; 2],
    /// `true` for an end that is bounded by a jump.
    pub bounded: [bool; 2],
    /// `true` if one of the two motions is rest.
    pub rests: bool,
    /// The kinds of both: where they differ, those of the ways upwards and downwards. What decays to rest has that of rest.
    pub kinds: [Kind; 2],
    /// The third motion, if one was met.
    pub third: Option<ThirdMotion>,
}

impl Bistable {
    /// Both motions in words, such as `rest and a cycle`.
    #[must_use]
    pub fn words(&self) -> String {
        words(self.kinds)
    }
}

/// A motion beside two others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThirdMotion {
    /// µ.
    pub friction: f64,
    /// The motion.
    pub ending: LongTermMotion,
}

/// Two motions in words, rest first and cycles before others.
pub(super) fn words(kinds: [Kind; 2]) -> String {
    let one = |kind: Kind| match kind {
        Kind::Equilibrium => (0, "rest", "rest"),
        Kind::Periodic | Kind::QuasiPeriodic => (1, "a cycle", "two cycles"),
        Kind::Irregular => (2, "an irregular motion", "two irregular motions"),
        Kind::Undecided => (3, "an undecided motion", "two undecided motions"),
        Kind::Unsettled => {
            (4, "a motion that has not settled", "two motions that have not settled")
        }
        Kind::Unbounded => (5, "growth without bound", "growth without bound"),
    };
    let mut both = kinds.map(one);
    both.sort_unstable();
    let [first, second] = both;
    if first == second { first.2.to_owned() } else { format!("{} and {}", first.1, second.1) }
}

/// Rest and a motion beside it at one value of µ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestAndMotion {
    /// µ.
    pub friction: f64,
    /// Rest first.
    pub endings: [LongTermMotion; 2],
    /// `true` if contacts take the states of the candidate in the motion.
    pub takes: [bool; 2],
}

/// The motions followed in a continuation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Continuation {
    /// Points of the way upwards, by ascending µ.
    pub rising: Vec<Point>,
    /// Points of the way downwards, by ascending µ too. The way begins from the scene's own start at the last value.
    /// If both ways end in the same motion and another cycle was met, that cycle stands here in its place.
    pub falling: Vec<Point>,
    /// Jumps by ascending µ, rising ones first.
    pub jumps: Vec<Jump>,
    /// Ranges with two motions, by ascending µ.
    pub bistable: Vec<Bistable>,
    /// Ranges of µ in which a motion was met that is not known and that may be a second one, by ascending µ.
    pub unknown: Vec<[f64; 2]>,
    /// `true` where motions were met that were not followed to their ends, which takes too long.
    pub more: bool,
    /// For each of [`Plan::candidates`](super::Plan::candidates) some values of µ in each part of it in which both rest and a
    /// motion beside it were met, once for each such motion.
    pub compared: Vec<Vec<RestAndMotion>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_motions_are_called_what_they_are() {
        let said = |a, b| words([a, b]);
        assert_eq!(said(Kind::Periodic, Kind::Equilibrium), "rest and a cycle");
        assert_eq!(said(Kind::Periodic, Kind::QuasiPeriodic), "two cycles");
        assert_eq!(said(Kind::Undecided, Kind::Periodic), "a cycle and an undecided motion");
        assert_eq!(said(Kind::Equilibrium, Kind::Irregular), "rest and an irregular motion");
        assert_eq!(said(Kind::Undecided, Kind::Undecided), "two undecided motions");
        assert_eq!(said(Kind::Unbounded, Kind::Equilibrium), "rest and growth without bound");
    }
}
