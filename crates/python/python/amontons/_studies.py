"""Studies of a scene, which are methods of `Scene`."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterable, Sequence
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import ArgumentError
from ._executors import Executor, carry_out
from ._progress import reporting
from ._tables import columns, give_units, table

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

    from . import _tables
    from ._scene import Scene
    from ._tables import Column

    Table = xarray.Dataset | _tables.Table

SHARES = ("share_slide", "share_reverse_slide", "share_stick", "share_detached")


def limit_cycles(
    scene: Scene,
    parameter: str,
    values: ArrayLike,
    *,
    resolution: float = 1e-3,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> Table:
    """The motion that the scene settles into with each value of a parameter, and where it changes.

    Runs are exact from event to event where the scene allows it, whatever its file says, unless `Scene.with_integrator` has
    chosen otherwise; the attributes ``integrator`` and ``step`` (s) tell.

    Parameters
    ----------
    parameter : str
        The name of a parameter or input.
    values : array-like
        Ascending values of the parameter.
    resolution : float
        Accuracy of the values at which the motion changes, as a part of the distance between two values.
    of : str, optional
        The output whose amplitude and frequency are given; by default the first displacement.
    window, interval, longest : float, optional
        Length of the window in which a motion is classified, time between two observations, and the longest time for a
        motion to settle, s; by default the scene's frequencies choose them.
    executor : object with submit, optional
        Where the work is done, as in `amontons.sweep`.
    progress : callable or bool, optional
        Called with the part that is done, from 0 to 1; True shows a bar if tqdm is installed.

    Returns
    -------
    xarray.Dataset or dict
        Over the parameter: ``kind``; ``amplitude`` of the output, half of the distance between its largest and smallest
        value; ``frequency`` (Hz) of its strongest line; ``period`` (s),
        after which the whole state returns, and ``closure``, how nearly, in parts of the motion's size; ``time`` (s) until
        it had settled; shares of time in contact states; ``failure``, the reason why there is no motion.
        Over ``threshold``: ``threshold_low`` and ``threshold_high``, values between which the motion changes, and
        ``threshold_changes``.
    """
    from ._scene import _ascending

    request = {
        "study": "limit-cycles",
        "parameter": parameter,
        "values": _ascending(values, parameter).tolist(),
        "resolution": _above_zero(resolution, "resolution"),
        **_observation(of, window, interval, longest),
    }
    found = _run(scene, request, executor, progress, "the limit cycles")
    result = found["result"]
    rows = [_outcome(outcome) for outcome in result["found"]["outcomes"]]
    variables = columns(rows, parameter)
    units = scene._units()
    thresholds = [
        {
            "low": threshold["between"][0],
            "high": threshold["between"][1],
            "changes": ", ".join(_change(change) for change in threshold["changes"]),
        }
        for threshold in result["found"]["thresholds"]
    ]
    variables.update(columns(thresholds, "threshold", "threshold_"))
    give_units(variables, _units(units.get(found["look"]["of"], "1"), units.get(parameter, "1")))
    coordinates = {parameter: ((parameter,), _array(result["values"]), {"units": units.get(parameter, "1")})}
    return table(variables, coordinates, _attributes(scene, found))


def perturbations(
    scene: Scene,
    initial: str,
    values: ArrayLike,
    *,
    resolution: float = 1e-3,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> Table:
    """The attractors that perturbations of one initial value reach, and the thresholds between them.

    Parameters
    ----------
    initial : str
        The name of an initial value, such as ``module[1].v2``.
    values : array-like
        Its ascending values, m or m/s.
    resolution : float
        The width of the bounds of a threshold, relative to the threshold.
    of, window, interval, longest, executor, progress
        As in `limit_cycles`.

    Returns
    -------
    xarray.Dataset or dict
        Over the initial value, which has the values of the bisection too: ``attractor``, its number from 0 (-1 where there
        is none), and the columns of `limit_cycles`. Over ``number``: ``attractor_kind``, ``attractor_amplitude``,
        ``attractor_frequency`` and ``attractor_period``. Over ``threshold``: ``threshold_low`` and ``threshold_high``, and
        ``threshold_below`` and ``threshold_above``, the attractors on either side.
    """
    from ._scene import _ascending

    request = {
        "study": "perturbations",
        "parameter": initial,
        "values": _ascending(values, initial).tolist(),
        "resolution": _above_zero(resolution, "resolution"),
        **_observation(of, window, interval, longest),
    }
    found = _run(scene, request, executor, progress, "the perturbations")
    result = found["result"]
    rows = []
    for run in result["runs"]:
        attractor = -1 if run["attractor"] is None else run["attractor"]
        ending = run["ending"]
        outcome = {"ending": ending} if ending is not None else {"failure": run["failure"]}
        rows.append({"attractor": attractor, **_outcome(outcome)})
    variables = columns(rows, initial)
    variables.update(_attractors(result["attractors"]))
    thresholds = [
        dict(zip(("low", "high", "below", "above"), (*threshold["between"], *threshold["attractors"])))
        for threshold in result["thresholds"]
    ]
    variables.update(columns(thresholds, "threshold", "threshold_"))
    give_units(variables, _units(scene._units().get(found["look"]["of"], "1"), _initial_unit(initial)))
    amplitudes = _array([run["amplitude"] for run in result["runs"]])
    coordinates = {initial: ((initial,), amplitudes, {"units": _initial_unit(initial)})}
    return table(variables, coordinates, _attributes(scene, found))


def basin(
    scene: Scene,
    x: tuple[str, ArrayLike],
    y: tuple[str, ArrayLike],
    *,
    islands: int | None = None,
    every_point: bool = False,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> Table:
    """Basins of attraction in a plane of two initial values.

    Parameters
    ----------
    x, y : tuple of str and array-like
        The initial value along each axis: its name, such as ``module[1].v2``, and ascending values.
    islands : int, optional
        Width and height, in points, of the islands that are found wherever they lie: a power of two; by default 8, and
        fewer along an axis of less than 49 points. Points that show where basins meet are run, and the others filled in.
    every_point : bool
        Run every point.
    of, window, interval, longest, executor, progress
        As in `limit_cycles`.

    Returns
    -------
    xarray.Dataset or dict
        Over both initial values: ``attractor``, its number from 0 (-1 where there is none); ``run``, False where it is
        filled in; ``failure``, the reason why there is no motion. Over ``number``: the attractors, as in `perturbations`.
    """
    import numpy as np

    from ._scene import _ascending

    if not all(isinstance(axis, (tuple, list)) and len(axis) == 2 for axis in (x, y)):
        raise ArgumentError("x and y are an initial value and its values each, such as ('module[1].v2', [0.0, 0.1])")
    axes = {name: _ascending(values, name) for name, values in (x, y)}
    request = {
        "study": "basin",
        "x": [x[0], axes[x[0]].tolist()],
        "y": [y[0], axes[y[0]].tolist()],
        "islands": None if islands is None else _power_of_two(islands, "islands"),
        "every_point": bool(every_point),
        **_observation(of, window, interval, longest),
    }
    found = _run(scene, request, executor, progress, "the basins")
    cells = found["result"]["rows"]
    attractor = [[-1 if cell["attractor"] is None else cell["attractor"] for cell in row] for row in cells]
    run = [[cell["run"] for cell in row] for row in cells]
    failure = [[cell["failure"] or "" for cell in row] for row in cells]
    dimensions = (y[0], x[0])
    variables: dict[str, Column] = {
        "attractor": (dimensions, np.array(attractor, dtype=int), {}),
        "run": (dimensions, np.array(run, dtype=bool), {}),
        "failure": (dimensions, np.array(failure, dtype=np.str_), {}),
    }
    variables.update(_attractors(found["result"]["attractors"]))
    give_units(variables, _units(scene._units().get(found["look"]["of"], "1"), "1"))
    coordinates: dict[str, Column] = {
        name: ((name,), values, {"units": _initial_unit(name)}) for name, values in axes.items()
    }
    return table(variables, coordinates, _attributes(scene, found))


def continuation(
    scene: Scene,
    values: ArrayLike,
    *,
    resolution: float | None = None,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> dict[str, Any]:
    """The motions of the scene over the friction coefficient, followed upwards and downwards.

    Parameters
    ----------
    values : array-like
        Ascending values of µ.
    resolution : float, optional
        Distance in µ to which a jump is narrowed; by default a hundredth of the first step.
    of, window, interval, longest, progress
        As in `limit_cycles`. Each value starts from the motion of the one before, so the work is not shared out.

    Returns
    -------
    dict
        ``branches``, as in study.json of ``amontons study continuation``: both ways, jumps, ranges with two motions;
        ``values`` of µ; and the settings of the observation, ``look``.
    """
    from ._scene import FRICTION, _ascending

    request = {
        "study": "continuation",
        "values": _ascending(values, FRICTION).tolist(),
        "resolution": None if resolution is None else _above_zero(resolution, "resolution"),
        **_observation(of, window, interval, longest),
    }
    return _whole(_run(scene, request, None, progress, "the continuation"))


def orbit(
    scene: Scene,
    start: Any = "run",
    *,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> dict[str, Any]:
    """One periodic motion, stable or not, solved for itself.

    Parameters
    ----------
    start : str, tuple or dict
        The motion from which it is looked for: ``"run"`` for the one that the scene settles into; ``("mode", n)`` for a
        mode of uniform sliding, counted from 1; ``("between", name, a, b)`` for the boundary between the motions that two
        values of an initial value end in; or an orbit that this function has found, perhaps with other values.
    of, window, interval, longest, progress
        As in `limit_cycles`.

    Returns
    -------
    dict
        ``orbit``: its period (s), displacements, velocities, events and Floquet multipliers; ``stable``; ``ending``, what
        the run before it ended in; ``boundary``, between which initial values it was found.

    Raises
    ------
    AnalysisError
        If the motion is not periodic, or no orbit is found.
    """
    request = {"study": "orbit", "start": _start(start), **_observation(of, window, interval, longest)}
    return _whole(_run(scene, request, None, progress, "the orbit"))


def branches(
    scene: Scene,
    parameter: str,
    first: float,
    last: float,
    starts: Iterable[Any] = ("run",),
    *,
    points: int = 400,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> dict[str, Any]:
    """Branches of periodic motions over a parameter: folds, bifurcations, changes of the sequence of events.

    Parameters
    ----------
    parameter : str
        The name of the parameter.
    first, last : float
        Its range.
    starts : iterable
        The motions from which branches begin, each as in `orbit`.
    points : int
        The most points of a branch to either side of its start.

    Returns
    -------
    dict
        ``branches``: for each start the ``points``, the ``specials`` (folds, bifurcations, changes of events) and the
        ``ends`` of its branch, or the ``failure``; ``rest``: uniform sliding over the range; ``look``: the settings of the
        observation.
    """
    from ._scene import _ascending

    if points < 0:
        raise ArgumentError(f"points = {points!r} is impossible; give zero or more")
    request = {
        "study": "branches",
        "parameter": parameter,
        "range": _ascending([first, last], parameter).tolist(),
        "starts": [_start(start) for start in starts],
        "points": int(points),
        **_observation(of, window, interval, longest),
    }
    found = _whole(_run(scene, request, None, progress, "the branches"))
    found["branches"] = [branch.get("Ok", {"failure": branch.get("Err")}) for branch in found["branches"]]
    return found


def transient(
    scene: Scene,
    stop_time: float | None = None,
    output_interval: float | None = None,
    *,
    of: str | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> dict[str, Any]:
    """Growth and decay of the motion in one run, band by band, beside eigenvalues.

    Parameters
    ----------
    stop_time, output_interval : float, optional
        End of the run and time between two rows, s; by default the scene's.
    of : str, optional
        The output; by default the displacement that moves most.

    Returns
    -------
    dict
        As in study.json of ``amontons study transient``: ``findings`` has each growth and decay.
    """
    request = {
        "study": "transient",
        "stop_time": None if stop_time is None else _above_zero(stop_time, "stop_time"),
        "output_interval": None if output_interval is None else _above_zero(output_interval, "output_interval"),
        **_observation(of, None, None, None),
    }
    found: dict[str, Any] = _run(scene, request, None, progress, "the run")
    return found


def motion(scene: Scene) -> dict[str, Any]:
    """The motion that the scene settles into from its start, as one row of `limit_cycles`, and the unit of its amplitude."""
    found = _found(scene, {"study": "motion", **_observation(None, None, None, None)}, None, None, "the motion")
    row = _outcome({"ending": found["result"]})
    return {key: row[key] for key in ("kind", "amplitude", "frequency", "period", *SHARES)}


def _whole(found: dict[str, Any]) -> dict[str, Any]:
    """The result of a study beside the settings of its observation."""
    return {"look": found["look"], **found["result"]}


def _attributes(scene: Scene, found: dict[str, Any]) -> dict[str, Any]:
    look, pace = found["look"], found["pace"]
    return scene._attributes(**look, integrator=pace["method"], step=pace["step"])


def _attractors(endings: Sequence[dict[str, Any]]) -> dict[str, Column]:
    keys = ("kind", "amplitude", "frequency", "period")
    rows = [_outcome({"ending": ending}) for ending in endings]
    return columns([{key: row[key] for key in keys} for row in rows], "number", "attractor_")


def _units(of: str, parameter: str) -> dict[str, str]:
    """Units of the quantities of motions, with those of the output and of the parameter."""
    own = {"amplitude": of, "frequency": "Hz", "period": "s", "time": "s"}
    attractors = {f"attractor_{name}": unit for name, unit in own.items()}
    return {**own, **attractors, "threshold_low": parameter, "threshold_high": parameter}


def _initial_unit(name: str) -> str:
    """The unit of an initial value, whose name ends as that of a velocity or of a displacement."""
    return "m/s" if name.rpartition(".")[2].startswith("v") else "m"


def _run(
    scene: Scene,
    request: dict[str, Any],
    executor: Executor | None,
    progress: Callable[[float], object] | bool | None,
    what: str,
) -> Any:
    """The result of a study."""
    scene._warn_of_doubts()
    return _found(scene, request, executor, progress, what)


def _found(
    scene: Scene,
    request: dict[str, Any],
    executor: Executor | None,
    progress: Callable[[float], object] | bool | None,
    what: str,
) -> Any:
    try:
        text = json.dumps(request, allow_nan=False)
    except ValueError:
        raise ArgumentError("all numbers of an orbit must be finite") from None
    study = _core.Study(scene._core, text)
    with reporting(progress, what) as report:
        if executor is None:
            return _told(json.loads(study.run(report)))
        known: dict[str, str] = {}
        left = 1.0
        while True:
            result, _, missing = study.plan(list(known.items()))
            if result is not None:
                if report:
                    report(1.0)
                return _told(json.loads(result))
            common = (scene, text, list(known.items()), missing)

            def tell(part: float, left: float = left) -> None:
                if report:
                    report(1.0 - left * (1.0 - 0.5 * part))

            before = len(known)
            for _, found in carry_out(_pieces, common, missing, executor, tell):
                if found is None:
                    raise RuntimeError(f"the processes that worked on {what} ended each time")
                known.update(found)
            if len(known) == before:
                raise RuntimeError(f"{what} have not advanced: {len(missing)} pieces are missing")
            left *= 0.5


def _told(found: Any) -> Any:
    """The result of a study, after a warning of values that it has left out."""
    note = found["result"].get("note") if "result" in found else None
    if note:
        warnings.warn(note, stacklevel=4)
    return found


def _pieces(common: tuple[Any, ...], keys: Sequence[str]) -> list[tuple[str, str]]:
    """Some pieces of a study."""
    scene, request, known, missing = common
    study = _core.Study(scene._core, request)
    with reporting(None, "pieces") as report:
        return study.work(known, set(keys), set(missing).difference(keys), report)


def _observation(
    of: str | None, window: float | None, interval: float | None, longest: float | None
) -> dict[str, Any]:
    settings = {"window": window, "interval": interval, "longest": longest}
    times = {name: None if value is None else _above_zero(value, name) for name, value in settings.items()}
    return {"of": of, **times}


def _power_of_two(value: int, name: str) -> int:
    number = int(value)
    if isinstance(value, bool) or number != value or number < 1 or number & (number - 1) or number > 2**20:
        raise ArgumentError(f"{name} = {value!r} is impossible; give a power of two: 1, 2, 4, 8, …")
    return number


def _above_zero(value: Any, name: str) -> float:
    number = _number(value, name)
    if number <= 0.0:
        raise ArgumentError(f"{name} = {value!r} is impossible; give a finite number above zero")
    return number


def _number(value: Any, name: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name} = {value!r} is impossible; give a number") from None
    except OverflowError:  # an integer that no floating-point number is near
        number = inf
    if not isfinite(number):
        raise ArgumentError(f"{name} = {value!r} is impossible; give a finite number")
    return number


def _start(start: Any) -> Any:
    """A start of an orbit as the compiled part reads it."""
    match start:
        case "run":
            return "run"
        case ("mode", number) if hasattr(number, "__index__") and number > 0:
            return {"mode": int(number)}
        case ("between", name, a, b) if isfinite(a) and isfinite(b):
            return {"between": [str(name), [float(a), float(b)]]}
        case {"orbit": {"period": _} as known} | ({"period": _} as known):
            return {"orbit": known}
    raise ArgumentError(
        f"{start!r} is no start of an orbit; give 'run', ('mode', 1), ('between', 'module[1].v2', 0.0, 0.1), or an orbit "
        "that was found before"
    )


def _outcome(outcome: dict[str, Any]) -> dict[str, Any]:
    """The row of an ending, or of a failure."""
    ending = outcome.get("ending")
    if ending is None:
        return {"kind": "failed", "failure": outcome["failure"]}
    numbers = {key: ending[key] for key in ("amplitude", "frequency", "period", "closure", "time")}
    if ending["kind"] == "unbounded":
        numbers["amplitude"] = None
    return {"kind": ending["kind"], **numbers, **dict(zip(SHARES, ending["shares"])), "failure": ""}


def _change(change: Any) -> str:
    """A change in words: ``rest-ends``, ``appears: St``."""
    return change if isinstance(change, str) else ", ".join(f"{what}: {state}" for what, state in change.items())


def _array(values: Sequence[float]) -> Any:
    import numpy as np

    return np.array(values, dtype=float)
