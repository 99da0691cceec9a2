"""Simulations that are advanced step by step."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from . import _core
from ._tables import names_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._scene import Scene


class Simulation:
    """A scene in motion.

    A simulation can be advanced, read, changed, saved and restored. One thread uses it at a time; other threads get an
    error meanwhile. It can be pickled with its motion.

    Parameters
    ----------
    scene : Scene
        The scene.
    start_time : float
        Time at the start, s.

    Examples
    --------
    >>> simulation = amontons.Simulation(amontons.Scene.builtin("set1"))
    >>> simulation.advance_to(0.001)
    >>> saved = simulation.save()
    >>> simulation.advance_to(0.002)
    >>> first = simulation["module[1].x1"]
    >>> simulation.restore(saved)
    >>> simulation.advance_to(0.002)
    >>> simulation["module[1].x1"] == first
    True
    """

    def __init__(self, scene: Scene, start_time: float = 0.0) -> None:
        self._scene = scene
        self._core = _core.Simulation(scene._core, scene.hash, float(start_time))

    @property
    def scene(self) -> Scene:
        """The scene with the values of the start."""
        return self._scene

    @property
    def time(self) -> float:
        """Present time, s."""
        return self._core.time

    @property
    def internal_step(self) -> float:
        """The internal step, s."""
        return self._core.step

    def advance_to(self, time: float) -> None:
        """Advances to a time (s), with inputs held.

        Results are the same to the last bit however a run is split at multiples of the internal step.

        Raises
        ------
        StepError
            For a time in the past, or a step that fails.
        KeyboardInterrupt
            If it is interrupted. The motion is lost then: restore a saved state, or make a new simulation.
        """
        self._core.advance_to(float(time))

    def advance_by(self, interval: float) -> None:
        """Advances by a time (s) from the present one.

        Times add up with rounding; `advance_to` a multiple of the interval does not.
        """
        self._core.advance_to(self._core.time + float(interval))

    def __getitem__(self, name: str) -> float:
        """Present value of a variable."""
        return self._core.read(name)

    def __setitem__(self, name: str, value: float) -> None:
        """Gives an input or a tunable parameter another value from now on."""
        self._core.set(name, float(value))

    def read(self, names: Iterable[str]) -> NDArray[np.float64]:
        """Present values of several variables."""
        return self._core.read_all(names_of(names))

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacements from the equilibrium, m, one for each degree of freedom."""
        return self._core.motion()[0]

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocities, m/s, one for each degree of freedom."""
        return self._core.motion()[1]

    @property
    def contact_states(self) -> list[str]:
        """The state of each contact: ``Sl`` (sliding), ``R-Sl`` (sliding the other way), ``St`` (sticking), ``Dt`` (open)."""
        return self._core.contact_states()

    def save(self) -> bytes:
        """All that the simulation needs to continue from here with the same doubles, also in another process."""
        return self._core.save()

    def restore(self, state: bytes) -> None:
        """Continues from a state that a simulation of an equal scene has saved.

        Raises
        ------
        Error
            If the state is damaged, or belongs to another scene, other values at the start, or another version.
        """
        self._core.restore(self._scene._core, state)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._scene, self.save())

    def __repr__(self) -> str:
        return f"<amontons.Simulation of {self._scene.name} at {self.time!r} s>"


def _restored(scene: Scene, state: bytes) -> Simulation:
    simulation = Simulation(scene)
    simulation.restore(state)
    return simulation
