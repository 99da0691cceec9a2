//! The state machine of a co-simulation slave (FMI 2.0.4, section 4.2.4), as one table.

/// Phase in the life of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Phase {
    Instantiated,
    InitializationMode,
    /// The instance is initialized, or a step is complete.
    StepComplete,
    Terminated,
    /// A call failed; the instance can be reset, or restored from a saved state.
    Error,
    /// A panic was caught inside this instance, which can only be freed.
    Poisoned,
}

use Phase::{Error, InitializationMode, Instantiated, Poisoned, StepComplete, Terminated};

const PHASES: [Phase; 6] =
    [Instantiated, InitializationMode, StepComplete, Terminated, Error, Poisoned];

/// Entry of the table: permission of a call in a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Permission {
    /// FMI allows the call.
    Allowed,
    /// FMI forbids the call, but hosts make it: it is answered with a warning, or refused if the instance is strict.
    Tolerated,
    /// FMI forbids the call, and no answer would make sense.
    Refused,
}

const YES: Permission = Permission::Allowed;
const HABIT: Permission = Permission::Tolerated;
const NO: Permission = Permission::Refused;

macro_rules! table {
    ($($(#[$doc:meta])* $call:ident $name:literal $($entry:ident)*;)*) => {
        /// The calls in the table, and special cases of them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Call {
            $($(#[$doc])* $call,)*
        }

        const CALLS: &[Call] = &[$(Call::$call),*];

        /// FMI's names of the calls, or a description of a group of functions.
        const NAMES: &[&str] = &[$($name),*];

        /// Permissions, by call and phase.
        static TABLE: [[Permission; PHASES.len()]; CALLS.len()] = [$([$($entry),*]),*];
    };
}

// A call has to be allowed by its own row and by the rows of the special cases that apply.
#[rustfmt::skip]
table! {
    //                                                              instan- initia- step-     termi-
    //                                                              tiated  lization complete nated  error  poisoned
    SetupExperiment      "fmi2SetupExperiment"                      YES     NO      NO      NO      NO      NO;
    EnterInitializationMode "fmi2EnterInitializationMode"           YES     NO      NO      NO      NO      NO;
    /// `fmi2EnterInitializationMode` without `fmi2SetupExperiment`.
    EnterUnprepared      "fmi2EnterInitializationMode without fmi2SetupExperiment"
                                                                    HABIT   NO      NO      NO      NO      NO;
    ExitInitializationMode "fmi2ExitInitializationMode"             NO      YES     NO      NO      NO      NO;
    Terminate            "fmi2Terminate"                            NO      NO      YES     NO      NO      NO;
    Reset                "fmi2Reset"                                YES     YES     YES     YES     YES     NO;
    SetDebugLogging      "fmi2SetDebugLogging"                      YES     YES     YES     YES     YES     NO;
    /// `fmi2SetDebugLogging` with a category that the model description does not declare.
    UnknownCategory      "fmi2SetDebugLogging with the unknown category"
                                                                    HABIT   HABIT   HABIT   HABIT   HABIT   NO;

    Get                  "reading a variable (fmi2Get…)"            HABIT   YES     YES     YES     YES     NO;
    Set                  "setting a variable (fmi2Set…)"            YES     YES     YES     NO      NO      NO;
    /// Setting an input, which has no `initial`.
    SetInput             "setting an input"                         HABIT   YES     YES     NO      NO      NO;
    SetTunable           "setting a tunable parameter"              YES     YES     YES     NO      NO      NO;
    SetFixed             "setting a fixed parameter"                YES     YES     NO      NO      NO      NO;
    SetOutput            "setting an output"                        NO      NO      NO      NO      NO      NO;

    GetFmuState          "fmi2GetFMUstate"                          YES     YES     YES     YES     YES     NO;
    SetFmuState          "fmi2SetFMUstate"                          YES     YES     YES     YES     YES     NO;
    /// All functions that turn a saved state into bytes or back, without using the instance.
    HeldFmuState         "turning a saved state into bytes or back" YES     YES     YES     YES     YES     NO;
    FreeFmuState         "fmi2FreeFMUstate"                         YES     YES     YES     YES     YES     YES;

    DirectionalDerivative "fmi2GetDirectionalDerivative"            NO      YES     YES     YES     YES     NO;
    InputDerivatives     "fmi2SetRealInputDerivatives"              HABIT   YES     YES     NO      NO      NO;
    OutputDerivatives    "fmi2GetRealOutputDerivatives"             NO      NO      YES     YES     YES     NO;

    DoStep               "fmi2DoStep"                               NO      NO      YES     NO      NO      NO;
    /// `fmi2DoStep` of length zero.
    StepOfLengthZero     "fmi2DoStep of length zero"                NO      NO      HABIT   NO      NO      NO;
    /// FMI allows this call only while a step is in progress; none is after `fmi2DoStep` has returned.
    CancelStep           "fmi2CancelStep"                           NO      NO      NO      NO      NO      NO;
    Status               "fmi2Get…Status"                           HABIT   HABIT   YES     YES     HABIT   NO;
}

impl Call {
    #[inline]
    pub(super) fn in_phase(self, phase: Phase) -> Permission {
        TABLE[self as usize][phase as usize]
    }

    /// The phases in which FMI allows the call, as text for a message.
    pub(super) fn phases(self) -> String {
        let allowed =
            PHASES.into_iter().filter(|&phase| self.in_phase(phase) == Permission::Allowed);
        let phases = allowed.map(|phase| format!("{phase:?}")).collect::<Vec<_>>().join(", ");
        if phases.is_empty() {
            "no phase allows it".to_owned()
        } else {
            format!("it is allowed in {phases}")
        }
    }

    /// FMI's requirement that a tolerated call breaks, as text for a message.
    pub(super) fn requirement(self) -> &'static str {
        match self {
            Self::EnterUnprepared => "fmi2SetupExperiment first",
            Self::UnknownCategory => "a category of the model description",
            Self::Get => "fmi2EnterInitializationMode first",
            Self::SetInput | Self::InputDerivatives => {
                "fmi2EnterInitializationMode before inputs are set"
            }
            Self::StepOfLengthZero => "a step longer than zero",
            Self::Status => "a step first",
            _ => "another phase",
        }
    }

    /// The effect of a tolerated call, to follow the requirement in a warning; empty if it has the usual one.
    pub(super) fn consequence(self) -> &'static str {
        match self {
            Self::EnterUnprepared => "; the run starts at time 0",
            Self::StepOfLengthZero => "; the state is unchanged",
            _ => "",
        }
    }
}

impl std::fmt::Display for Call {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(NAMES[*self as usize])
    }
}

/// Set of the calls that were noted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Noted(u32);

impl Noted {
    /// Notes a call; returns `true` if it was not noted before.
    pub(super) fn note(&mut self, call: Call) -> bool {
        let bit = 1 << call as u32;
        let is_new = self.0 & bit == 0;
        self.0 |= bit;
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(phase: Phase, entry: Permission) -> Vec<Call> {
        CALLS.iter().copied().filter(|call| call.in_phase(phase) == entry).collect()
    }

    #[test]
    fn once_a_panic_was_caught_what_the_importer_holds_can_be_given_back() {
        assert_eq!(entries(Poisoned, Permission::Allowed), [Call::FreeFmuState]);
        assert_eq!(entries(Poisoned, Permission::Tolerated), []);
    }

    #[test]
    fn after_an_error_only_reading_saved_states_and_the_ways_out_are_left() {
        for call in [Call::Get, Call::Reset, Call::SetFmuState, Call::GetFmuState] {
            assert_eq!(call.in_phase(Error), Permission::Allowed);
        }
        for call in [Call::Set, Call::DoStep, Call::Terminate, Call::EnterInitializationMode] {
            assert_eq!(call.in_phase(Error), Permission::Refused);
        }
    }

    #[test]
    fn every_habit_says_what_fmi_wants() {
        for phase in PHASES {
            for call in entries(phase, Permission::Tolerated) {
                assert_ne!(call.requirement(), "another phase", "{call}");
            }
        }
        // One bit is enough for each call.
        assert!(CALLS.len() <= 32 && CALLS.iter().zip(0..).all(|(&call, i)| call as u32 == i));
    }
}
