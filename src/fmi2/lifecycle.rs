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
    /// A panic was caught inside this instance; only FreeInstance is left.
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
    /// Whatever is done with a saved state but not with the instance: free, serialize.
    HeldFmuState,
    SetFmuState,
    Derivatives,
    DoStep,
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
            Self::Terminate | Self::DoStep => mask(&[StepComplete]),
            Self::Set => mask(&[Instantiated, InitializationMode, StepComplete]),
            Self::GetFmuState => {
                mask(&[Instantiated, InitializationMode, StepComplete, Terminated])
            }
            Self::Derivatives => mask(&[InitializationMode, StepComplete, Terminated, Error]),
            Self::Get
            | Self::Reset
            | Self::SetDebugLogging
            | Self::HeldFmuState
            | Self::SetFmuState
            | Self::Status => {
                mask(&[Instantiated, InitializationMode, StepComplete, Terminated, Error])
            }
        }
    }

    pub(super) const fn is_allowed_in(self, phase: Phase) -> bool {
        self.allowed() & phase as u8 != 0
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
