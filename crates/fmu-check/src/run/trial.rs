//! The ways in which a library is tried, each in a process of its own.

use clap::ValueEnum;

/// A way to try a library. Those after the first are tried only if the first came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Trial {
    /// The run that every host makes, once more after a reset.
    Plain,
    /// `fmi2FreeInstance(NULL)`.
    FreeNull,
    /// `fmi2Instantiate` with the guid of another FMU.
    WrongGuid,
    /// The location of the resources with one slash.
    OneSlash,
    /// Resources in a folder whose name has a space.
    Space,
    /// NULL for the memory callbacks.
    NullCallbacks,
    /// A reset of a new instance.
    ResetNew,
    /// Resets in all phases.
    Reset,
    /// Reading and setting of all variables.
    Variables,
    /// Inputs that change during the run.
    Inputs,
    /// Steps of different sizes.
    Steps,
    /// Two instances that take turns.
    Instances,
    /// Saved, restored and serialized states.
    States,
    /// Derivatives of outputs by inputs.
    Derivatives,
    /// Derivatives of outputs in the direction of several inputs.
    Directions,
    /// Derivatives of outputs by time.
    OutputDerivatives,
    /// Derivatives of inputs by time.
    InputDerivatives,
    /// A run with all log messages.
    Logging,
    /// Arrays beside memory that cannot be accessed.
    Arrays,
    /// Growth of memory.
    Memory,
    /// A run under valgrind, a memory checker.
    Valgrind,
}

impl Trial {
    /// `true` if the trial sets parameters to other values than their start values, which may ask for more time.
    pub(super) const fn sets_values(self) -> bool {
        matches!(self, Self::Variables | Self::Instances)
    }

    /// `true` if the trial makes more than one instance in its process.
    pub(super) const fn needs_instances(self) -> bool {
        matches!(
            self,
            Self::Inputs | Self::Instances | Self::InputDerivatives | Self::Logging | Self::Memory
        )
    }
}
