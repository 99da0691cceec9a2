//! The randomly drawn calls: function, kind of argument, and the phase in which the call is made.

use crate::standard::{PHASES, Phase};
use proptest::prelude::*;
use std::fmt;

/// Kinds of argument. The code of each call defines their meaning for its function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Good,
    NullInstance,
    // ---- Arrays ----
    Empty,
    NullArray,
    NullString,
    Huge,
    Misaligned,
    // ---- Variables ----
    WrongReference,
    OtherType,
    Input,
    Tunable,
    Fixed,
    Output,
    NotFinite,
    OutOfRange,
    WrongOrder,
    // ---- Creation ----
    NullName,
    EmptyName,
    NullGuid,
    WrongGuid,
    NotText,
    NullLocation,
    WrongLocation,
    WrongType,
    NullCallbacks,
    NullLogger,
    // ---- Life ----
    Unprepared,
    StopBeforeStart,
    UnknownCategory,
    // ---- Saved states ----
    Existing,
    NullState,
    NullPointer,
    OtherScene,
    Twice,
    Longer,
    Short,
    Flipped,
    Garbage,
    // ---- Steps ----
    Zero,
    Rounded,
    Negative,
    WrongTime,
    NotFiniteTime,
    BeyondStop,
    TooFar,
    DoStepStatus,
    Pending,
    LastSuccessfulTime,
    Terminated,
    UnknownStatus,
}

use Kind::*;

const READ: &[Kind] =
    &[Good, Empty, NullArray, Huge, Misaligned, WrongReference, OtherType, NullInstance];
const NONE_OF_TYPE: &[Kind] = &[Empty, WrongReference, NullArray, Huge, Misaligned, NullInstance];
const ALONE: &[Kind] = &[Good, NullInstance];
const QUERY: &[Kind] = &[
    DoStepStatus,
    Pending,
    LastSuccessfulTime,
    Terminated,
    UnknownStatus,
    NullPointer,
    Misaligned,
    NullInstance,
];

/// All functions, and the kinds of argument that each is given.
#[rustfmt::skip]
pub const CALLS: &[(&str, &[Kind])] = &[
    ("fmi2GetTypesPlatform", &[Good]),
    ("fmi2GetVersion", &[Good]),
    ("fmi2SetDebugLogging", &[Good, Empty, UnknownCategory, NullArray, NullString, Huge, Misaligned, NullInstance]),
    ("fmi2Instantiate", &[
        Good, NullName, EmptyName, NullGuid, WrongGuid, NotText, NullLocation, WrongLocation, OtherScene, WrongType,
        NullCallbacks, NullLogger,
    ]),
    ("fmi2FreeInstance", ALONE),
    ("fmi2SetupExperiment", &[Good, NotFinite, StopBeforeStart, NullInstance]),
    ("fmi2EnterInitializationMode", &[Good, Unprepared, NullInstance]),
    ("fmi2ExitInitializationMode", ALONE),
    ("fmi2Terminate", ALONE),
    ("fmi2Reset", ALONE),
    ("fmi2GetReal", READ),
    ("fmi2GetInteger", READ),
    ("fmi2GetBoolean", READ),
    ("fmi2GetString", NONE_OF_TYPE),
    ("fmi2SetReal", &[
        Good, Input, Tunable, Fixed, Output, NotFinite, OutOfRange, Empty, NullArray, Huge, Misaligned, WrongReference,
        OtherType, NullInstance,
    ]),
    ("fmi2SetInteger", &[
        Output, Empty, NullArray, Huge, Misaligned, WrongReference, OtherType, NullInstance,
    ]),
    ("fmi2SetBoolean", READ),
    ("fmi2SetString", NONE_OF_TYPE),
    ("fmi2GetFMUstate", &[Good, Existing, NullPointer, Misaligned, NullInstance]),
    ("fmi2SetFMUstate", &[Good, NullState, OtherScene, NullInstance]),
    ("fmi2FreeFMUstate", &[Good, Twice, NullState, NullPointer, NullInstance]),
    ("fmi2SerializedFMUstateSize", &[Good, NullState, OtherScene, NullPointer, Misaligned, NullInstance]),
    ("fmi2SerializeFMUstate", &[
        Good, Longer, Short, Empty, NullArray, Huge, NullState, OtherScene, NullInstance,
    ]),
    ("fmi2DeSerializeFMUstate", &[
        Good, Short, Flipped, Longer, Garbage, OtherScene, Empty, NullArray, Huge, NullPointer, Misaligned,
        NullInstance,
    ]),
    ("fmi2GetDirectionalDerivative", &[
        Good, Input, Output, Fixed, NotFinite, Empty, NullArray, Huge, Misaligned, WrongReference, OtherType,
        NullInstance,
    ]),
    ("fmi2SetRealInputDerivatives", &[
        Good, Tunable, Fixed, Output, NotFinite, WrongOrder, Empty, NullArray, Huge, Misaligned, WrongReference,
        OtherType, NullInstance,
    ]),
    ("fmi2GetRealOutputDerivatives", &[
        Good, Input, WrongOrder, Empty, NullArray, Huge, Misaligned, WrongReference, OtherType, NullInstance,
    ]),
    ("fmi2DoStep", &[
        Good, Zero, Rounded, Negative, NotFinite, WrongTime, NotFiniteTime, BeyondStop, TooFar, NullInstance,
    ]),
    ("fmi2CancelStep", ALONE),
    ("fmi2GetStatus", QUERY),
    ("fmi2GetRealStatus", QUERY),
    ("fmi2GetIntegerStatus", QUERY),
    ("fmi2GetBooleanStatus", QUERY),
    ("fmi2GetStringStatus", QUERY),
];

/// Number of instances in a sequence; the last one is of another scene.
pub const SLOTS: u8 = 4;

/// A call and its preparation.
#[derive(Clone, Copy)]
pub struct Op {
    /// Index of the instance, which is created if it does not exist.
    pub slot: u8,
    /// Phase into which the instance is brought first.
    pub phase: Option<Phase>,
    /// Mode of the instance after a reset before the call, `true` for strict; `None` if it is not reset.
    pub strict: Option<bool>,
    pub function: &'static str,
    pub kind: Kind,
    /// Seed from which the arguments are drawn.
    pub seed: u64,
}

impl fmt::Debug for Op {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { slot, phase, strict, function, kind, seed } = self;
        write!(f, "[{slot}] ")?;
        if let Some(strict) = strict {
            write!(f, "{} ", if *strict { "strict" } else { "lenient" })?;
        }
        if let Some(phase) = phase {
            write!(f, "to {phase:?}, ")?;
        }
        write!(f, "{function} {kind:?} (seed {seed})")
    }
}

/// All pairs of a function and a kind of argument.
pub fn pairs() -> impl Iterator<Item = (&'static str, Kind)> {
    CALLS.iter().flat_map(|&(function, kinds)| kinds.iter().map(move |&kind| (function, kind)))
}

/// Each pair once in each phase, strict and not.
pub fn every_cell() -> Vec<Op> {
    let mut ops = Vec::new();
    for strict in [false, true] {
        for phase in PHASES {
            for (slot, (function, kind)) in (0..SLOTS).cycle().zip(pairs()) {
                let seed = ops.len() as u64;
                let strict = Some(strict);
                ops.push(Op { slot, phase: Some(phase), strict, function, kind, seed });
            }
        }
    }
    ops
}

/// One call at random: mostly brought where it is to be made, else wherever the ones before have led.
pub fn any_op() -> impl Strategy<Value = Op> {
    let pairs: Vec<_> = pairs().collect();
    let phase = prop_oneof![Just(None), prop::sample::select(&PHASES).prop_map(Some)];
    let strict = prop_oneof![4 => Just(None), 1 => any::<bool>().prop_map(Some)];
    (0..SLOTS, phase, strict, prop::sample::select(pairs), any::<u64>().no_shrink()).prop_map(
        |(slot, phase, strict, (function, kind), seed)| Op {
            slot,
            phase,
            strict,
            function,
            kind,
            seed,
        },
    )
}

/// Numbers from a seed (SplitMix64), so that a call has the same arguments whatever is left out before it.
pub struct Dice(pub u64);

impl Dice {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 … n − 1.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }

    /// From a to b.
    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
