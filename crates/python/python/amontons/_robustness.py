"""Robustness of a scene whose parameters scatter, as methods of `Scene`."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import ArgumentError
from ._executors import Executor
from ._progress import reporting
from ._studies import _array, _number, _observation, _run
from ._tables import columns, give_units, names_of, table

if TYPE_CHECKING:
    import numpy as np
    import xarray
    from numpy.typing import ArrayLike, NDArray

    from . import _tables
    from ._scene import Scene
    from ._tables import Column

    Table = xarray.Dataset | _tables.Table

ESTIMATE = ("value", "low", "high")


def robustness(
    scene: Scene,
    uncertain: Mapping[str, str],
    *,
    state: str | None = None,
    points: int = 1024,
    scramblings: int = 16,
    seed: int = 1,
    bands: Sequence[tuple[float, float]] | None = None,
    indices: bool = True,
    pushes: str | None = None,
    runs: int | None = None,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> Table:
    """The probability that the scene is unstable when its parameters scatter, and which of them that is due to.

    Parameters
    ----------
    uncertain : mapping of str to str
        The distribution of each parameter by its name, such as ``{"friction.coefficient": "normal(0.4,0.05)",
        "module[*].k6": "uniform(±10%)"}``; ``*`` stands for any part of a name, and each parameter has draws of its own, unless
        the word together precedes the distribution: all then change by the same part. The
        distributions are those of ``amontons study robustness``. The mapping may be empty if there are pushes.
    state : str, optional
        A contact state, as in `Scene.eigenvalues`; by default uniform sliding.
    points, scramblings : int
        Number of draws in each scrambling, a power of two, and of independent scramblings, whose differences give the
        intervals.
    seed : int
        Other seeds give independent results.
    bands : sequence of pairs, optional
        Ranges of frequencies, Hz, in each of which the probability of growth is given; by default the families of
        frequencies in which modes grow.
    indices : bool
        Compute Sobol indices, which take one more evaluation and one for each parameter with each draw.
    pushes : str, optional
        Run draws too, each after a push in a random direction: the distribution of the push's largest velocity, m/s, such as
        ``"uniform(0,0.1)"``. The settings after it are those of the runs.
    runs : int, optional
        Number of runs after pushes; by default 100.
    of, window, interval, longest, executor, progress
        As in `limit_cycles`.

    Returns
    -------
    xarray.Dataset or dict
        Over ``probability``, whose names are ``unstable``, ``stable`` and ``no equilibrium``, and ``squeals`` with pushes:
        ``probability_value``, and ``probability_low`` and ``probability_high``, its interval of 95 %.
        Over ``band``: ``band_from`` and ``band_to`` (Hz), and the probability that a mode grows there, ``band_value``,
        ``band_low`` and ``band_high``.
        Over ``parameter``, which has the names of all parameters that scatter: ``distribution``, ``nominal`` (the scene's
        value), ``cut_off`` (the probability of impossible values), and Sobol indices: ``growth_first`` and ``growth_total``
        of the largest growth rate, ``instability_first`` and ``instability_total``, each with its interval, such as
        ``growth_first_low`` and ``growth_first_high``; NaN where there are none.
        Over ``class``: the histogram of the largest growth rate, ``class_from``, ``class_to`` (1/s) and ``class_draws``.
        Over ``run``: ``run_push`` (m/s), ``run_end``, ``run_kind``, ``run_frequency`` (Hz) and ``run_failure``; over ``run``
        and ``parameter`` the drawn ``run_value``.
        Attributes: ``nominal_growth``, the largest growth rate of the scene itself (1/s, NaN without equilibrium), and
        ``draws``.

    Examples
    --------
    >>> scene = amontons.Scene.builtin("set1")
    >>> found = scene.robustness({"friction.coefficient": "uniform(1.1,1.3)"}, points=64)
    >>> [f"{float(value):.2f}" for value in found["probability_value"]]
    ['0.58', '0.42', '0.00']
    """
    import numpy as np

    of_runs = {"runs": runs, "of": of, "window": window, "interval": interval, "longest": longest}
    _of_runs_alone(pushes is None, of_runs, "give pushes")
    of_draws = {"state": state, "bands": bands, "indices": None if indices else False}
    idle = [name for name, value in of_draws.items() if value is not None]
    if idle and uncertain == {}:
        raise ArgumentError(
            f"{idle[0]} is for eigenvalues of draws, and no parameter scatters: leave it out, or give uncertain parameters"
        )
    request = {
        "study": "robustness",
        "uncertain": _texts(uncertain),
        "state": state,
        "points": _count(points, "points", "give a power of two, such as 1024"),
        "scramblings": _count(scramblings, "scramblings"),
        "seed": _count(seed, "seed"),
        "bands": None if bands is None else _bands(bands),
        "indices": bool(indices),
        "pushes": None if pushes is None else str(pushes),
        "runs": 100 if runs is None else _count(runs, "runs"),
        **_observation(of, window, interval, longest),
    }
    found = _run(scene, request, executor, progress, "the draws")
    result = found["result"]
    for note in result["notes"]:
        warnings.warn(note, stacklevel=2)
    parameters, eigenvalues, pushed = result["parameters"], result["found"]["eigenvalues"], result["found"]["runs"]
    names = [parameter.pop("name") for parameter in parameters]
    rows: dict[str, dict[str, float]] = {}
    bands_found, classes = [], []
    if eigenvalues:
        rows = {kind: eigenvalues[kind.replace(" ", "_")] for kind in ("unstable", "stable", "no equilibrium")}
        bands_found = [
            {"from": band["frequencies"][0], "to": band["frequencies"][1], **band["unstable"]}
            for band in eigenvalues["bands"]
        ]
        classes = [
            {"from": one["ends"][0], "to": one["ends"][1], "draws": one["count"]} for one in eigenvalues["histogram"]
        ]
        for what in ("growth", "instability"):
            of_each = eigenvalues[f"of_{what}"] or [None] * len(names)
            for parameter, index in zip(parameters, of_each):
                parameter.update(_index(what, index))
    if pushed:
        rows["squeals"] = pushed["probability"]
    variables: dict[str, Column] = {
        **columns(list(rows.values()), "probability", "probability_"),
        **columns(bands_found, "band", "band_"),
        **columns(parameters, "parameter"),
        **columns(classes, "class", "class_"),
    }
    if pushed:
        values = [run.pop("values") for run in pushed["runs"]]
        variables.update(columns(pushed["runs"], "run", "run_"))
        drawn = _array(values).reshape(len(values), len(names))
        variables["run_value"] = (("run", "parameter"), drawn, {})
    units = {"class_from": "1/s", "class_to": "1/s", "run_push": "m/s", "run_frequency": "Hz"}
    give_units(variables, {**units, "band_from": "Hz", "band_to": "Hz"})
    coordinates: dict[str, Column] = {
        "probability": (("probability",), np.array(list(rows), dtype=np.str_), {}),
        "parameter": (("parameter",), np.array(names, dtype=np.str_), {}),
    }
    attributes = {"state": state or "uniform sliding", "at": 0.0, "seed": int(seed)}
    if eigenvalues:
        growth = eigenvalues["nominal_growth"]
        attributes["nominal_growth"] = float("nan") if growth is None else growth
        attributes.update(draws=eigenvalues["draws"], points=int(points), scramblings=int(scramblings))
    if pushed:
        attributes.update(found["look"], integrator=found["pace"]["method"], step=found["pace"]["step"], pushes=str(pushes))
    return table(variables, coordinates, scene._attributes(**attributes))


def growth_rates(
    scene: Scene,
    names: Sequence[str],
    values: ArrayLike,
    *,
    state: str | None = None,
    at: float | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> NDArray[np.float64]:
    """The largest growth rate for each row of values of some parameters, on all cores.

    It is for tools that draw values by themselves, such as SALib and OpenTURNS.

    Parameters
    ----------
    names : sequence of str
        Names of parameters, each once.
    values : array-like, shape (rows, names)
        A row of values for each scene.
    state, at
        As in `Scene.eigenvalues`.
    progress : callable or bool, optional
        As in `Scene.simulate`.

    Returns
    -------
    ndarray, shape (rows,)
        The largest growth rate of each row, 1/s, which is positive if the state is unstable; NaN where there is no equilibrium
        in sliding.

    Raises
    ------
    ArgumentError
        For a name that the scene does not have, and for one that eigenvalues do not depend on.
    SceneError
        For an impossible value; the text has the number and the values of its row.
    AnalysisError
        For a row that cannot be analysed; the text has its number and values.

    Examples
    --------
    >>> scene = amontons.Scene.builtin("set1")
    >>> scene.growth_rates(["friction.coefficient"], [[0.9], [1.96]]).round(2)
    array([-0.88, 16.81])
    """
    import numpy as np

    known = names_of(names)
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError("the values of parameters must be numbers") from None
    if array.ndim != 2 or array.shape[1] != len(known):
        raise ArgumentError(
            f"values must have a row for each scene with {len(known)} columns, one for each name, not the shape {array.shape}"
        )
    instant = scene._instant(at)
    with reporting(progress, "the growth rates") as report:
        return _core.growth_rates(scene._core, known, array.ravel().tolist(), state, instant, report)


def _texts(uncertain: Mapping[str, str]) -> list[tuple[str, str]]:
    if not isinstance(uncertain, Mapping):
        raise ArgumentError(
            f"{uncertain!r} has no distributions; give names with distributions, such as "
            "{'friction.coefficient': 'normal(±10%)'}"
        )
    return [(str(name), str(distribution)) for name, distribution in uncertain.items()]


def _bands(bands: Sequence[tuple[float, float]]) -> list[list[float]]:
    if not isinstance(bands, Iterable) or isinstance(bands, str):
        raise ArgumentError(f"bands = {bands!r} are no ranges; give pairs of frequencies in Hz, such as [(0.0, 500.0)]")
    return [_band(band) for band in bands]


def _band(band: Any) -> list[float]:
    wish = "a band is a pair of its ends in Hz, such as (0.0, 500.0)"
    if not isinstance(band, Iterable) or isinstance(band, str):
        raise ArgumentError(f"{band!r} is no range of frequencies; {wish}")
    ends = [_number(end, "a band") for end in band]
    if len(ends) != 2 or not 0.0 <= ends[0] < ends[1] < float("inf"):
        raise ArgumentError(f"{band!r} is no range of frequencies; {wish}")
    return ends


def _count(value: Any, name: str, wish: str = "give a whole number from zero") -> int:
    try:
        number = int(value)
        is_count = not isinstance(value, str) and number == value and 0 <= number < 2**63
    except (TypeError, ValueError, OverflowError):
        is_count = False
    if not is_count:
        raise ArgumentError(f"{name} = {value!r} is impossible; {wish}")
    return number


def _of_runs_alone(has_none: bool, given: Mapping[str, object], instead: str) -> None:
    """Refuses settings of runs where there are none."""
    idle = [name for name, value in given.items() if value is not None]
    if has_none and idle:
        raise ArgumentError(f"{idle[0]} is for runs after pushes, and there are none: leave it out, or {instead}")


def _index(what: str, index: dict[str, dict[str, float]] | None) -> dict[str, float | None]:
    """The columns of the indices of one parameter."""
    row: dict[str, float | None] = {}
    for kind in ("first", "total"):
        for part in ESTIMATE:
            name = f"{what}_{kind}" if part == "value" else f"{what}_{kind}_{part}"
            row[name] = None if index is None else index[kind][part]
    return row
