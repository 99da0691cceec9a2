"""Friction contact dynamics of lumped models: simulations, stability, studies and FMUs.

A scene has masses, springs, dampers and frictional contacts with a moving slider. The module simulates its motion, tells
which of its contact states squeal by complex eigenvalues, and follows its motions over parameters, on this machine's
cores or on any number of machines.

>>> import amontons
>>> scene = amontons.Scene.builtin("set1")
>>> float(scene.eigenvalues().real.max()) > 0   # uniform sliding grows: it squeals
True

All quantities are in SI units. Tables are `xarray.Dataset` where xarray is installed, and dictionaries of NumPy arrays
elsewhere.
"""

from ._core import VERSION as __version__
from ._errors import (
    AnalysisError,
    ArgumentError,
    EquilibriumError,
    Error,
    FileError,
    SceneError,
    StepError,
)
from ._scene import Scene, Variable
from ._simulation import Simulation
from ._sweep import sweep

__all__ = [
    "AnalysisError",
    "ArgumentError",
    "EquilibriumError",
    "Error",
    "FileError",
    "Scene",
    "SceneError",
    "Simulation",
    "StepError",
    "Variable",
    "sweep",
]
