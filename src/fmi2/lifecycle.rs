//! The state machine of a co-simulation slave (FMI 2.0.4, section 4.2.4), as one table.

/// Where an instance stands in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Phase {
    Instantiated = 1,
    InitializationMode = 2,
    /// Initialized, or a step is done.
    StepComplete = 4,
    Terminated = 8,
    /// A call failed; Reset or a saved state leads out.
    Error = 16,
    /// A panic was caught inside this instance; only freeing is left.
    Poisoned = 32,
}

use Phase::{Error, InitializationMode, Instantiated, StepComplete, Terminated};

/// The calls that the table knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Call {
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    SetDebugLogging,
    Get,
    Set,
    GetFmuState,
    /// Whatever turns a saved state into bytes or back, without the instance.
    HeldFmuState,
    FreeFmuState,
    SetFmuState,
    Derivatives,
    DoStep,
    CancelStep,
    Status,
}

impl Call {
    /// The phases in which the call is allowed.
    const fn allowed(self) -> u8 {
        const fn mask(phases: &[Phase]) -> u8 {
            let (mut mask, mut i) = (0, 0);
            while i < phases.len() {
                mask |= phases[i] as u8;
                i += 1;
            }
            mask
        }
        match self {
            Self::SetupExperiment | Self::EnterInitializationMode => mask(&[Instantiated]),
            Self::ExitInitializationMode => mask(&[InitializationMode]),
            Self::Terminate | Self::DoStep | Self::CancelStep => mask(&[StepComplete]),
            Self::Set => mask(&[Instantiated, InitializationMode, StepComplete]),
            Self::GetFmuState => {
                mask(&[Instantiated, InitializationMode, StepComplete, Terminated])
            }
            Self::Get | Self::Derivatives => {
                mask(&[InitializationMode, StepComplete, Terminated, Error])
            }
            Self::FreeFmuState => mask(&[
                Instantiated,
                InitializationMode,
                StepComplete,
                Terminated,
                Error,
                Phase::Poisoned,
            ]),
            Self::Reset
            | Self::SetDebugLogging
            | Self::HeldFmuState
            | Self::SetFmuState
            | Self::Status => {
                mask(&[Instantiated, InitializationMode, StepComplete, Terminated, Error])
            }
        }
    }

    /// The phases in which the call is allowed, for a message.
    pub(super) fn phases(self) -> String {
        let all = [Instantiated, InitializationMode, StepComplete, Terminated, Error];
        let allowed = all.into_iter().filter(|&phase| self.is_allowed_in(phase));
        allowed.map(|phase| format!("{phase:?}")).collect::<Vec<_>>().join(", ")
    }

    pub(super) const fn is_allowed_in(self, phase: Phase) -> bool {
        self.allowed() & phase as u8 != 0
    }
}

/// FMI's name of the call, or what its functions have in common.
impl std::fmt::Display for Call {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::SetupExperiment => "fmi2SetupExperiment",
            Self::EnterInitializationMode => "fmi2EnterInitializationMode",
            Self::ExitInitializationMode => "fmi2ExitInitializationMode",
            Self::Terminate => "fmi2Terminate",
            Self::Reset => "fmi2Reset",
            Self::SetDebugLogging => "fmi2SetDebugLogging",
            Self::Get => "reading a variable (fmi2Get…)",
            Self::Set => "setting a variable (fmi2Set…)",
            Self::GetFmuState => "fmi2GetFMUstate",
            Self::HeldFmuState => "turning a saved state into bytes or back",
            Self::FreeFmuState => "fmi2FreeFMUstate",
            Self::SetFmuState => "fmi2SetFMUstate",
            Self::Derivatives => "asking for derivatives",
            Self::DoStep => "fmi2DoStep",
            Self::CancelStep => "fmi2CancelStep",
            Self::Status => "fmi2Get…Status",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_allowed_once_a_panic_was_caught() {
        for call in [Call::Get, Call::Reset, Call::DoStep, Call::SetFmuState, Call::Terminate] {
            assert!(!call.is_allowed_in(Phase::Poisoned));
        }
    }

    #[test]
    fn after_an_error_only_reading_and_the_ways_out_are_left() {
        for call in [Call::Get, Call::Reset, Call::SetFmuState, Call::Status] {
            assert!(call.is_allowed_in(Error));
        }
        for call in [Call::Set, Call::DoStep, Call::Terminate, Call::EnterInitializationMode] {
            assert!(!call.is_allowed_in(Error));
        }
    }
}
