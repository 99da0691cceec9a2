"""Scenes."""

from __future__ import annotations

import hashlib
import json
import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _core, _design, _loudness, _robustness, _studies
from ._errors import ArgumentError, Error
from ._progress import reporting
from ._tables import columns, give_units, names_of, table

if TYPE_CHECKING:
    from ._tables import Column
    import numpy as np
    import xarray
    from numpy.typing import ArrayLike, NDArray

    from ._core import Scene as CoreScene
    from ._simulation import Simulation

    from . import _tables

    Table = xarray.Dataset | _tables.Table

FRICTION = "friction.coefficient"


@dataclass(frozen=True)
class Variable:
    """A variable of a scene, as its FMU has it.

    Attributes
    ----------
    name : str
        The name, such as ``module[1].x1``.
    causality : str
        ``"input"``, ``"output"`` or ``"parameter"``.
    type : str
        ``"Real"``, ``"Integer"``, ``"Boolean"`` or ``"Enumeration"``.
    unit : str
        The unit; ``"1"`` where there is none.
    description : str
        What it is, in one line.
    value : float or None
        The scene's value of a parameter or input; None of an output.
    """

    name: str
    causality: str
    type: str
    unit: str
    description: str
    value: float | None


class Scene:
    """Masses, springs, dampers and frictional contacts with a moving slider.

    A scene never changes: `with_values` and `with_integrator` give other scenes. Scenes can be compared, are hashable,
    and can be pickled.

    >>> import amontons
    >>> scene = amontons.Scene.builtin("set2")
    >>> scene
    <amontons.Scene set2: 2 contacts, 8 degrees of freedom>
    >>> scene.with_values({"friction.coefficent": 0.5})
    Traceback (most recent call last):
    amontons.ArgumentError: there is no parameter or input friction.coefficent; did you mean friction.coefficient?
    """

    __slots__ = ("_core",)
    _core: CoreScene

    def __init__(self) -> None:
        raise TypeError("make a scene with Scene.builtin, Scene.read or Scene.from_toml")

    @classmethod
    def _of(cls, core: CoreScene) -> Scene:
        made = object.__new__(cls)
        object.__setattr__(made, "_core", core)
        return made

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a scene does not change; with_values gives another one")

    def __delattr__(self, name: str) -> None:
        raise AttributeError("a scene does not change")

    @classmethod
    def builtin(cls, name: str) -> Scene:
        """A scene that is built into the module.

        Parameters
        ----------
        name : str
            One of `Scene.builtin_names`.

        Examples
        --------
        >>> amontons.Scene.builtin("set1").name
        'set1'
        """
        return cls._of(_core.Scene.builtin(name))

    @staticmethod
    def builtin_names() -> list[str]:
        """Names of the scenes that are built in.

        >>> amontons.Scene.builtin_names()[:3]
        ['set1', 'set2', 'ring12']
        """
        return _core.builtin_names()

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file (TOML); CSV files that it names lie beside it.

        Raises
        ------
        SceneError
            With everything that is wrong in the file, each with its line.
        """
        return cls._of(_core.Scene.read(path))

    @classmethod
    def from_toml(cls, text: str, name: str = "scene") -> Scene:
        """Makes a scene from the text of a scene file that names no other files.

        Examples
        --------
        >>> text = '''
        ... [[mass]]
        ... name = "m"
        ... mass = 1.0
        ... locked = ["y"]
        ... [[spring]]
        ... name = "k"
        ... between = ["m", "ground"]
        ... direction = "x"
        ... stiffness = 100.0
        ... [[initial]]
        ... mass = "m"
        ... x = 0.01
        ... [integrator]
        ... method = "event-driven"
        ... step = 1e-3
        ... '''
        >>> amontons.Scene.from_toml(text).eigenvalues().imag.round(9)
        array([10.])
        """
        return cls._of(_core.Scene.from_toml(name, text))

    def with_values(self, values: Mapping[str, float]) -> Scene:
        """The scene with other values of parameters, inputs, initial values and signals.

        Parameters
        ----------
        values : mapping of str to float
            Values by the names of the variables, in SI units; they are set in their order.

        Raises
        ------
        ArgumentError
            For a name that the scene does not have; the text has the nearest one.
        SceneError
            For an impossible value.

        Examples
        --------
        >>> scene = amontons.Scene.builtin("set1").with_values({"friction.coefficient": 0.9})
        >>> scene["friction.coefficient"]
        0.9
        """
        return self._of(self._core.with_values([(str(name), float(value)) for name, value in values.items()]))

    def with_integrator(
        self, method: str | None = None, step: float | None = None, preset: str | None = None
    ) -> Scene:
        """The scene with another method, step (s) or preset.

        Parameters
        ----------
        method : {"forward-increment", "event-driven"}, optional
            The paper's scheme, or exact motion from event to event.
        step : float, optional
            The internal step, s.
        preset : {"preview", "design", "reference"}, optional
            An accuracy that chooses method and step.
        """
        return self._of(self._core.with_integrator(method, step, preset))

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._core.name

    @property
    def description(self) -> str:
        """What the scene is, in one line."""
        return self._core.description

    @property
    def text(self) -> str:
        """Text of the scene file, in which no values are changed."""
        return self._core.text

    @property
    def values(self) -> dict[str, float]:
        """The values that `with_values` has changed."""
        return dict(self._core.values)

    @property
    def hash(self) -> str:
        """A hash of the scene's name and files, the values that were changed, and method and step.

        It is the same on every machine. Scenes are equal if their hashes are.
        """
        core = self._core
        state = [core.name, core.text, core.tables, sorted(core.values), core.integrator]
        if core.binaries:
            state.append([[name, hashlib.sha256(content).hexdigest()] for name, content in core.binaries])
        return hashlib.sha256(json.dumps(state).encode()).hexdigest()

    @property
    def variables(self) -> dict[str, Variable]:
        """All variables by their names: parameters, inputs and outputs.

        >>> amontons.Scene.builtin("set1").variables["friction.coefficient"].value
        1.96
        """
        return {row[0]: Variable(*row) for row in self._core.variables()}

    @property
    def displacement_names(self) -> list[str]:
        """Names of the displacements, one for each degree of freedom."""
        return self._core.dof_names

    @property
    def contact_names(self) -> list[str]:
        """Names of the contacts."""
        return self._core.contact_names

    def __getitem__(self, name: str) -> float:
        """The value of a parameter, an input, an initial value or a signal."""
        try:
            return self._core.value(name)
        except Error:
            known = self.variables.get(name)
            if known is None or known.causality != "output":
                raise
        raise ArgumentError(f"{name} is an output, which a scene has no value of; simulate() and start() give it")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.hash == other.hash

    def __hash__(self) -> int:
        return int(self.hash[:15], 16)

    def __reduce__(self) -> tuple[Any, ...]:
        core = self._core
        files = (core.name, core.text, core.tables, core.values, core.integrator)
        return _restored, (*files, core.binaries)

    def __repr__(self) -> str:
        count, dofs = self._core.contact_count, len(self._core.dof_names)
        size = f"{count} contact{'s' * (count != 1)}, {dofs} degree{'s' * (dofs != 1)} of freedom"
        changed = ", ".join(f"{name} = {value!r}" for name, value in self.values.items())
        return f"<amontons.Scene {self.name}: {size}{', with ' * bool(changed)}{changed}>"

    def _repr_svg_(self) -> str | None:
        """The drawing, for a notebook; None where the scene is too large to be drawn."""
        try:
            return self._core.svg()
        except Error:
            return None

    def _repr_html_(self) -> str:
        """The drawing and the values that were changed, for a notebook."""
        from html import escape

        drawing = self._repr_svg_() or ""
        return f"<figure>{drawing}<figcaption>{escape(repr(self)[1:-1])}. {escape(self.description)}</figcaption></figure>"

    def draw(self, path: str | os.PathLike[str] | None = None) -> Drawing:
        """Draws masses, springs, dampers and contacts (up to 40 masses).

        Parameters
        ----------
        path : path-like, optional
            A file to write; its ending, ``.svg`` or ``.png``, is the format.
        """
        if path is not None:
            self._core.draw(path)
        return Drawing(self._core.svg())

    def _attributes(self, **more: Any) -> dict[str, Any]:
        """Attributes of a table: numbers and texts."""
        values = json.dumps(self.values)
        known = {"amontons": _core.VERSION, "scene": self.name, "scene_hash": self.hash, "scene_values": values}
        return {**known, **more}

    def _instant(self, at: float | None) -> float:
        """The instant of an analysis that knows no time, s; by default 0, with a warning of what it leaves out."""
        left_out = _core.left_out(self._core, float(at or 0.0)) if at is None else None
        if left_out:
            warnings.warn(f"{left_out}; `at` selects another instant", stacklevel=3)
        return float(at or 0.0)

    def _warn_of_doubts(self) -> None:
        for doubt in self._core.doubts:
            warnings.warn(doubt, stacklevel=4)

    def _units(self) -> dict[str, str]:
        return {row[0]: row[3] for row in self._core.variables()}

    def simulate(
        self,
        stop_time: float | None = None,
        output_interval: float | None = None,
        outputs: Iterable[str] | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> Table:
        """Runs the scene from its start.

        Parameters
        ----------
        stop_time : float, optional
            End of the run, s; by default the scene's.
        output_interval : float, optional
            Time between two rows, s; by default the scene's.
        outputs : iterable of str, optional
            Variables to record; by default all outputs.
        progress : callable or bool, optional
            Called with the part that is done, from 0 to 1; True shows a bar if tqdm is installed.

        Returns
        -------
        xarray.Dataset or dict
            The outputs over ``time`` (s). Without xarray a dictionary of arrays.

        Examples
        --------
        >>> run = amontons.Scene.builtin("set1").simulate(stop_time=0.01, outputs=["module[1].x1"])
        >>> len(run["module[1].x1"]) == len(run["time"])
        True
        """
        names = None if outputs is None else names_of(outputs)
        self._warn_of_doubts()
        with reporting(progress, "the run") as report:
            times, columns, doubts = _core.run(self._core, stop_time, output_interval, names, report)
        for doubt in doubts:
            warnings.warn(doubt, stacklevel=2)
        known = self.variables
        variables = {
            name: (
                ("time",),
                values.astype("int32") if is_whole else values,
                _contact_states() if known[name].type == "Enumeration" else {"units": known[name].unit},
            )
            for name, values, is_whole in columns
        }
        method, step = self._core.pace()
        attributes = self._attributes(integrator=method, step=step)
        return table(variables, {"time": (("time",), times, {"units": "s"})}, attributes)

    def start(self, start_time: float = 0.0) -> Simulation:
        """A simulation of the scene that is advanced step by step, from `start_time` (s)."""
        from ._simulation import Simulation

        return Simulation(self, start_time)

    def eigenvalues(
        self, state: str | None = None, friction: float | None = None, at: float | None = None
    ) -> NDArray[np.complex128]:
        """Complex eigenvalues of a contact state.

        Parameters
        ----------
        state : str, optional
            A contact state: ``"Sl"``, ``"R-Sl"``, ``"St"`` or ``"Dt"`` for all contacts, or one for each, as
            ``"Sl-St"``; by names of contacts and sets of contacts, as ``"pad=St,*=Sl"``; or ``"equilibrium"``. By default
            uniform sliding.
        friction : float, optional
            Another value of ``friction.coefficient``.
        at : float
            The instant at which signals are taken, s.

        Returns
        -------
        ndarray of complex
            λ in 1/s, also where there is no equilibrium in sliding if µ is constant: first those that oscillate, one of each conjugate pair (Im λ > 0), by frequency; then the real
            ones. A positive real part grows.
        """
        return _core.eigenvalues(self._core, state, friction, self._instant(at))

    def modes(
        self, state: str | None = None, friction: float | None = None, at: float | None = None
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Eigenvalues of a contact state as `eigenvalues` gives them, and the shapes of their modes.

        Returns
        -------
        eigenvalues : ndarray of complex, shape (modes,)
        shapes : ndarray of complex, shape (modes, degrees of freedom)
            The largest component of each is 1.
        """
        return _core.modes(self._core, state, friction, self._instant(at))

    def states(
        self,
        friction: float | None = None,
        at: float | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> dict[str, NDArray[np.complex128]]:
        """Eigenvalues of all contact states, by their names; for up to eight contacts."""
        with reporting(progress, "the contact states") as report:
            return dict(_core.states(self._core, friction, self._instant(at), report))

    def locus(
        self,
        parameter: str,
        values: ArrayLike,
        *,
        state: str | None = None,
        at: float | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> Table:
        """Follows the modes of a contact state over the values of a parameter.

        Parameters
        ----------
        parameter : str
            The name of the parameter.
        values : array-like
            Ascending values of the parameter, at least two.
        state, at
            As in `eigenvalues`.
        progress : callable or bool, optional
            As in `simulate`.

        Returns
        -------
        xarray.Dataset or dict
            Over ``mode`` (from 1, in the order at the first value) and the parameter: ``growth_rate`` (1/s) and
            ``frequency`` (Hz); where a mode has become two real eigenvalues, those of the larger one.
            Over ``crossing``, for each mode that begins or ceases to grow: ``crossing_value`` of the parameter,
            ``crossing_mode``, ``crossing_frequency`` (Hz), and ``crossing_begins``, True if it grows above that value.
            Over ``merging``, for each two modes that merge or part: ``merging_value``, ``merging_first`` and
            ``merging_second``, the modes, ``merging_frequency`` (Hz), and ``merging_begins``, True if they merge as the
            parameter grows.
            Over ``undecided``: values near which modes could not be told apart, so that they may have changed numbers.

        Examples
        --------
        >>> locus = amontons.Scene.builtin("set1").locus("friction.coefficient", [1.0, 1.25, 1.5])
        >>> [round(float(value), 6) for value in locus["crossing_value"]]
        [1.183611]
        """
        import numpy as np

        values, instant = _ascending(values, parameter), self._instant(at)
        with reporting(progress, "the locus") as report:
            found = _core.locus(self._core, parameter, values.tolist(), state, instant, report)
        eigenvalues = found["eigenvalue"]
        dimensions = ("mode", parameter)
        variables = {
            "growth_rate": (dimensions, eigenvalues.real, {"units": "1/s"}),
            "frequency": (dimensions, eigenvalues.imag / (2 * np.pi), {"units": "Hz"}),
            **columns(_crossings(found["crossings"]), "crossing", "crossing_"),
            **columns(_mergings(found["mergings"]), "merging", "merging_"),
        }
        unit = self._units().get(parameter, "1")
        units = {
            "crossing_value": unit,
            "merging_value": unit,
            "crossing_frequency": "Hz",
            "merging_frequency": "Hz",
        }
        give_units(variables, units)
        coordinates = {
            "mode": (("mode",), np.arange(1, len(eigenvalues) + 1), {}),
            parameter: ((parameter,), values, {"units": unit}),
            "undecided": (("undecided",), np.array(found["undecided"], dtype=float), {}),
        }
        attributes = self._attributes(state=state or "uniform sliding", at=instant)
        return table(variables, coordinates, attributes)

    def sensitivities(
        self,
        state: str | None = None,
        friction: float | None = None,
        at: float | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> Table:
        """Derivatives of growth rates and frequencies by all parameters, exact but for rounding.

        Parameters
        ----------
        state, friction, at
            As in `eigenvalues`.
        progress : callable or bool, optional
            As in `simulate`.

        Returns
        -------
        xarray.Dataset or dict
            Over ``mode`` (from 1, those that oscillate by frequency, then the others): ``growth_rate`` (1/s) and
            ``frequency`` (Hz), and ``merging_friction`` and ``merging_distance``, the friction coefficient at which the mode
            merges with another one and the distance to it, NaN where there is none within a hundredth.
            Over ``mode`` and ``parameter``: ``growth_rate_derivative`` and ``frequency_derivative``, per unit of the
            parameter; NaN where a mode has merged with another one. Modes with one eigenvalue have the derivatives of that
            eigenvalue, the largest growth rate first.
            Over ``parameter``: ``value``. Parameters without an effect are left out.

        Examples
        --------
        >>> found = amontons.Scene.builtin("hoffmann").sensitivities()
        >>> found["parameter"].values[:2].tolist()
        ['friction.coefficient', 'slider.angle']
        >>> round(float(found["growth_rate_derivative"].sel(parameter="friction.coefficient").max()), 2)
        2.06
        """
        import numpy as np

        instant = self._instant(at)
        with reporting(progress, "the derivatives") as report:
            found = _core.sensitivities(self._core, state, friction, instant, report)
        eigenvalues, derivatives = found["eigenvalue"], found["derivative"]
        both, modes = ("mode", "parameter"), ("mode",)
        variables: dict[str, Column] = {
            "growth_rate": (modes, eigenvalues.real, {"units": "1/s"}),
            "frequency": (modes, eigenvalues.imag / (2 * np.pi), {"units": "Hz"}),
            "growth_rate_derivative": (both, derivatives.real, {}),
            "frequency_derivative": (both, derivatives.imag / (2 * np.pi), {}),
            "merging_friction": (modes, found["merging_friction"], {"units": "1"}),
            "merging_distance": (modes, found["merging_distance"], {"units": "1"}),
            "value": (("parameter",), found["value"], {}),
        }
        coordinates: dict[str, Column] = {
            "mode": (modes, np.arange(1, len(eigenvalues) + 1), {}),
            "parameter": (("parameter",), np.array(found["parameter"], dtype=np.str_), {}),
        }
        attributes = self._attributes(state=state or "uniform sliding", at=instant)
        return table(variables, coordinates, attributes)

    def candidates(
        self,
        first: float,
        last: float,
        *,
        at: float | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> dict[str, Any]:
        """Bi-stable candidates over a range of the friction coefficient.

        Parameters
        ----------
        first, last : float
            The range of µ.
        at
            As in `eigenvalues`.
        progress : callable or bool, optional
            As in `simulate`.

        Returns
        -------
        dict
            ``range``: the range of µ that was analysed, up to the static friction; ``equilibrium``: ranges in which there is
            an equilibrium; ``stable``: ranges in which uniform sliding is stable; ``crossings``: where its modes begin or
            cease to grow, as in `locus`.
            ``candidates``: modes of other contact states that grow in a stable range, what is easiest to reach first. Each
            has its ``state``; the number of states that symmetry makes equal (``alike``); the ``range`` of µ;
            ``begins``, True if it begins to grow at the start of the range; ``frequency`` (Hz) there;
            ``frequency_at_end`` (Hz) and ``growth_rate_at_end`` (1/s); and the least ``energy`` (J) and ``push`` (m/s) that a
            motion has had before the contacts were in this state, None where no motion reaches it.
        """
        first, last = _ascending([first, last], FRICTION).tolist()
        if first < 0.0:
            raise ArgumentError(f"{FRICTION} = {first!r} is impossible; give a range from zero or above")
        instant = self._instant(at)
        with reporting(progress, "the contact states") as report:
            found = _core.candidates(self._core, (first, last), instant, report)
        return {**found, "crossings": _crossings(found["crossings"])}

    def equilibrium(self, at: float | None = None) -> dict[str, dict[str, float]]:
        """The equilibrium in uniform sliding.

        Returns
        -------
        dict
            ``displacement`` (m) by degree of freedom; ``normal_force`` and ``friction_force`` (N) and ``gap`` (m) by contact:
            the gap of a closed contact is 0.

        Raises
        ------
        EquilibriumError
            If there is none: the scene jams, or the load pulls it off its contacts.
        """
        displacement, normal, friction, gap = (part.tolist() for part in _core.equilibrium(self._core, self._instant(at)))
        contacts = self._core.contact_names
        return {
            "displacement": dict(zip(self._core.dof_names, displacement)),
            "normal_force": dict(zip(contacts, normal)),
            "friction_force": dict(zip(contacts, friction)),
            "gap": dict(zip(contacts, gap)),
        }

    def verdict(self, at: float | None = None) -> str:
        """The verdict of the eigenvalue analysis on uniform sliding, as maps of ``amontons-stability`` have it.

        One of ``stable``, ``candidate``, ``candidate if a contact opens or reverses``, ``unstable``, ``no equilibrium in
        sliding`` and ``static below kinetic friction``.

        >>> amontons.Scene.builtin("set1").verdict()
        'unstable'
        """
        return _core.verdict(self._core, self._instant(at))

    def export(
        self,
        path: str | os.PathLike[str] | None = None,
        platforms: Iterable[str] | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> str:
        """Writes the scene as an FMI 2.0 co-simulation FMU.

        The FMU has the values of the scene file. A scene whose values `with_values` has changed is refused: importers set
        values themselves, and the file can have others.

        Parameters
        ----------
        path : path-like, optional
            The file; by default NAME.fmu in the current folder.
        platforms : iterable of str, optional
            Platforms on which the FMU runs; by default all that the module carries.

        Returns
        -------
        str
            The path.
        """
        path = os.fspath(path if path is not None else f"{self.name}.fmu")
        names = None if platforms is None else names_of(platforms)
        with reporting(progress, "the reference run") as report:
            _core.export(self._core, path, names, report)
        return path

    limit_cycles = _studies.limit_cycles
    perturbations = _studies.perturbations
    basin = _studies.basin
    continuation = _studies.continuation
    orbit = _studies.orbit
    branches = _studies.branches
    transient = _studies.transient
    robustness = _robustness.robustness
    growth_rates = _robustness.growth_rates
    loudness = _loudness.loudness
    design = _design.design


class Drawing:
    """The drawing of a scene, which a notebook shows."""

    def __init__(self, svg: str) -> None:
        self.svg = svg
        """Text of the SVG."""

    def _repr_svg_(self) -> str:
        return self.svg


def _contact_states() -> dict[str, Any]:
    """Attributes of a contact state: the numbers and their names."""
    import numpy as np

    return {"flag_values": np.array([1, 2, 3, 4], dtype="int32"), "flag_meanings": "Sl R-Sl St Dt"}


def _crossings(found: Iterable[tuple[float, int, float, bool]]) -> list[dict[str, Any]]:
    """Crossings as rows, with modes counted from 1."""
    return [
        {"value": value, "mode": mode + 1, "frequency": frequency, "begins": begins}
        for value, mode, frequency, begins in found
    ]


def _mergings(found: Iterable[tuple[float, tuple[int, int], float, bool]]) -> list[dict[str, Any]]:
    """Mergings as rows, with modes counted from 1."""
    return [
        {"value": value, "first": modes[0] + 1, "second": modes[1] + 1, "frequency": frequency, "begins": begins}
        for value, modes, frequency, begins in found
    ]


def _restored(
    name: str,
    text: str,
    tables: list[tuple[str, str]],
    values: list[tuple[str, float]],
    integrator: tuple[str | None, float | None, str | None],
    binaries: list[tuple[str, bytes]] | None = None,
) -> Scene:
    """The scene of a pickle."""
    if tables or binaries:
        import tempfile
        from pathlib import Path

        with tempfile.TemporaryDirectory() as folder:
            for file, content in [*tables, (f"{name}.toml", text)]:
                Path(folder, file).write_text(content, encoding="utf-8", newline="")
            for file, packed in binaries or []:
                Path(folder, file).write_bytes(packed)
            core = _core.Scene.read(Path(folder, f"{name}.toml"))
    else:
        core = _core.Scene.from_toml(name, text)
    if values:
        core = core.with_values(values)
    if any(part is not None for part in integrator):
        core = core.with_integrator(*integrator)
    return Scene._of(core)


def _ascending(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """The values of a parameter along an axis."""
    import numpy as np

    try:
        array = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise ArgumentError(f"the values of {name} must be numbers, not {values!r}") from None
    if array.ndim != 1:
        raise ArgumentError(f"the values of {name} must be a list of numbers, not an array of shape {array.shape}")
    if len(array) == 0:
        raise ArgumentError(f"there are no values of {name}; give at least one")
    if not np.all(np.isfinite(array)):
        raise ArgumentError(f"the values of {name} must be finite numbers")
    if np.any(np.diff(array) <= 0):
        raise ArgumentError(f"the values of {name} must ascend")
    return array
