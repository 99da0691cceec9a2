"""Sweeps: one quantity over the values of any number of parameters."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import tau
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import ArgumentError, Error
from ._executors import Executor, carry_out
from ._progress import reporting
from ._scene import Scene, _ascending
from ._studies import motion
from ._tables import columns, table

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

    from ._tables import Table


def sweep(
    scene: Scene,
    parameters: Mapping[str, ArrayLike],
    of: str | Callable[[Scene], Any] = "growth",
    *,
    at: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> xarray.Dataset | Table:
    """Evaluates a scene at every combination of the values of some parameters.

    Parameters
    ----------
    scene : Scene
        The scene.
    parameters : mapping of str to array-like
        Ascending values of each parameter, input or initial value, by its name.
    of : str or callable
        What is evaluated:

        ``"growth"``
            ``growth_rate`` (1/s) and ``frequency`` (Hz) of the fastest growing mode of uniform sliding; a point without an
            equilibrium in sliding fails;
        ``"verdict"``
            the verdict on uniform sliding, as `Scene.verdict` gives it;
        ``"motion"``
            the motion that the scene settles into: ``kind``, ``amplitude`` of the first displacement (m),
            ``frequency`` (Hz), ``period`` (s), and shares of time in contact states;
        a function of a scene
            which returns a number, a text, or a dictionary of numbers and texts. Other processes import the function by
            its name, so it must be in a module of its own.
    at : float, optional
        The instant at which ``"growth"`` and ``"verdict"`` take the signals of the scene, s; by default 0, with a warning
        of what they leave out.
    executor : object with submit, optional
        Where the work is done: an executor of `concurrent.futures`, `dask.distributed` (a client too) or
        `mpi4py.futures`; by default threads of this process. The result does not depend on it.
    progress : callable or bool, optional
        Called with the part that is done, from 0 to 1; True shows a bar if tqdm is installed.

    Returns
    -------
    xarray.Dataset or dict
        The quantities over the parameters. ``failure`` has the reason of each point that has no result, and is empty
        elsewhere; a failing point loses no other one.

    Examples
    --------
    >>> scene = amontons.Scene.builtin("set1")
    >>> found = amontons.sweep(scene, {"friction.coefficient": [1.0, 1.5]})
    >>> [bool(rate > 0) for rate in found["growth_rate"]]
    [False, True]
    """
    evaluate: Any = _EVALUATIONS.get(of) if isinstance(of, str) else of
    if not callable(evaluate):
        raise ArgumentError(f"of = {of!r} is none of {', '.join(_EVALUATIONS)}, and no function of a scene")
    if at is not None and of not in _AT_INSTANT:
        raise ArgumentError(f"at is the instant of {' and '.join(_AT_INSTANT)}; of = {of!r} has none")
    if not parameters:
        raise ArgumentError("a sweep needs at least one parameter")
    axes = {str(name): _ascending(values, name) for name, values in parameters.items()}
    for name in axes:
        # A misspelt name is an error of the whole sweep, not of each point.
        scene[name]
    attributes: dict[str, Any] = {"of": of if isinstance(of, str) else getattr(of, "__qualname__", repr(of))}
    if of in _AT_INSTANT:
        for name in axes:
            _core.check_undriven(scene._core, name)
        attributes["at"] = scene._instant(at)
        evaluate = partial(evaluate, at=attributes["at"])
    scene._warn_of_doubts()
    points = list(itertools.product(*(values.tolist() for values in axes.values())))
    rows: dict[int, dict[str, Any]] = {}
    with reporting(progress, "the sweep") as report:
        common = (scene, list(axes), evaluate)
        for batch, found in carry_out(_evaluated, common, list(enumerate(points)), executor, report):
            places = [place for place, _ in batch]
            rows.update(zip(places, found or [{"failure": _LOST}] * len(batch)))
    failed = sum(bool(row["failure"]) for row in rows.values())
    if failed == len(points):
        raise Error(f"no point of the sweep has a result; the first one: {rows[0]['failure']}")
    if failed:
        warnings.warn(f"{failed} of {len(points)} points have no result; `failure` has the reasons", stacklevel=2)
    shape = tuple(len(values) for values in axes.values())
    flat = columns([rows[place] for place in range(len(points))], "point")
    units = scene._units()
    # A function of the user's has units of its own.
    known = {**_UNITS, "amplitude": units[scene.displacement_names[0]]} if isinstance(of, str) else {}
    variables = {
        name: (tuple(axes), values.reshape(shape), {"units": known[name]} if name in known else {})
        for name, (_, values, _) in flat.items()
    }
    coordinates = {
        name: ((name,), values, {"units": units.get(name, "1")}) for name, values in axes.items()
    }
    return table(variables, coordinates, scene._attributes(**attributes))


def _evaluated(common: tuple[Any, ...], batch: Sequence[Any]) -> list[dict[str, Any]]:
    """The rows of some points."""
    scene, names, evaluate = common
    return [_row(scene, dict(zip(names, point)), evaluate) for _, point in batch]


def _row(scene: Scene, values: dict[str, float], evaluate: Callable[[Scene], Any]) -> dict[str, Any]:
    try:
        found = evaluate(scene.with_values(values))
        if not isinstance(found, Mapping):
            found = {"value": found}
        plain = {str(key): _plain(value) for key, value in found.items()}
    except Exception as error:
        return {"failure": f"{error}" if isinstance(error, Error) else f"{type(error).__name__}: {error}"}
    for key, value in plain.items():
        if key in values:
            return {"failure": f"the function gives {key}, which is the name of a parameter of the sweep"}
        if not isinstance(value, _PLAIN):
            return {"failure": f"the function gives {key} = {value!r}, which is neither a number nor a text"}
    return {**plain, "failure": plain.get("failure", "")}


def _plain(value: Any) -> Any:
    """A number of NumPy as Python's; anything else as it is."""
    return value.item() if getattr(value, "size", 0) == 1 and hasattr(value, "item") else value


def _growth(scene: Scene, at: float) -> dict[str, float]:
    # A law of friction that is constant has eigenvalues also where nothing can slide.
    scene.equilibrium(at=at)
    fastest = max(scene.eigenvalues(at=at).tolist(), key=lambda value: value.real)
    return {"growth_rate": fastest.real, "frequency": abs(fastest.imag) / tau}


def _verdict(scene: Scene, at: float) -> dict[str, str]:
    return {"verdict": scene.verdict(at=at)}


_LOST = "the process that evaluated it ended each time"
_PLAIN = (bool, int, float, complex, str, type(None))
"""Types of results that a table can have."""
_EVALUATIONS: dict[str, Callable[..., Any]] = {"growth": _growth, "verdict": _verdict, "motion": motion}
_AT_INSTANT = ("growth", "verdict")
"""Evaluations that know no time."""
_UNITS = {"growth_rate": "1/s", "frequency": "Hz", "period": "s"}
