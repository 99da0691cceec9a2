"""Exceptions of the module, which have the texts of the program's errors."""


class Error(ValueError):
    """Any error of Amontons; its text says what is wrong, where, and what would be right."""


class ArgumentError(Error):
    """An unknown name, or an argument that is impossible."""


class FileError(OSError, Error):
    """A file that cannot be read or written."""


class SceneError(Error):
    """A scene with a wrong key or an impossible value."""


class EquilibriumError(Error):
    """A scene without a static equilibrium: it jams, or the load pulls it off its contacts."""


class AnalysisError(Error):
    """An analysis that has no result."""


class StepError(Error):
    """A step that fails or is longer than the critical one, or a time to which a run cannot advance."""


for _kind in (Error, ArgumentError, FileError, SceneError, EquilibriumError, AnalysisError, StepError):
    # The name that users know.
    _kind.__module__ = "amontons"
