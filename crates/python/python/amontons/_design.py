"""The smallest change that silences a scene, as a method of `Scene`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ._errors import ArgumentError
from ._executors import Executor
from ._robustness import _count, _of_runs_alone
from ._studies import _number, _observation, _run
from ._tables import names_of

if TYPE_CHECKING:
    from ._scene import Scene


def design(
    scene: Scene,
    vary: Mapping[str, str | tuple[float, float]],
    friction: float | tuple[float, float],
    *,
    states: Iterable[str] = (),
    together: bool = False,
    margin: float | None = None,
    cost: Mapping[str, float] | None = None,
    starts: int = 8,
    points: int = 8,
    seed: int = 1,
    pushes: str | None = None,
    runs: int = 40,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> dict[str, Any]:
    """The smallest change of the scene after which no mode grows over a range of friction coefficients.

    Parameters
    ----------
    vary : mapping of str to str or pair
        The range of each value that may change by its name, such as ``{"module[*].k6": "±5%", "damping.beta": (0.0, 1e-4)}``;
        ``*`` stands for any part of a name. The ranges are those of ``amontons study design``; a pair has the smallest and the
        largest value.
    friction : float or pair
        The range of the friction coefficient in which no mode may grow, or one value.
    states : iterable of str
        Contact states in which no mode may grow, as in `Scene.eigenvalues`, or ``"all"``; by default uniform sliding.
    together : bool
        Change all parts that a ``*`` stands for by the same percentage, as those of equal modules.
    margin : float, optional
        Growth rate, 1/s, by which all modes stay below zero; by default a tenth of the slowest decay without friction.
    cost : mapping of str to float, optional
        The factors by which changes of names count in the size of a change; by default 1.
    starts, points : int
        Number of starts of the search, and of points of the trade-off between growth rate and change.
    seed : int
        Seed of the starts and of the pushes.
    pushes : str, optional
        The distribution of the largest velocity of the pushes that verify the design, m/s; by default uniform from 0 to the
        velocity of the fastest surface.
    runs : int
        Number of runs after pushes at random friction coefficients of the range, and at its end, of the scene and of the design
        each; 0 leaves them out. The settings after it are those of the runs.
    of, window, interval, longest, executor, progress
        As in `limit_cycles`.

    Returns
    -------
    dict
        ``found`` and ``margin``, as in study.json of ``amontons study design``: in ``found`` the scene ``before``, the ``design``
        with its relative ``changes``, their ``size`` and the ``worst`` mode, ``is_kept``, ``starts``, ``trade_off``, ``growth`` over
        µ, and ``checked``, the verification. ``vary`` has the values that may change in the order of ``changes``, ``states`` the
        contact states, and ``values`` the values of the design, for `Scene.with_values`.

    Examples
    --------
    >>> scene = amontons.Scene.builtin("set1")
    >>> found = scene.design({"module[*].k6": "±5%"}, (0.0, 1.3), together=True, runs=0)
    >>> bool(scene.with_values({**found["values"], "friction.coefficient": 1.3}).eigenvalues().real.max() < 0)
    True
    """
    of_runs = {"pushes": pushes, "of": of, "window": window, "interval": interval, "longest": longest}
    _of_runs_alone(_count(runs, "runs") == 0, of_runs, "give runs=1 or more")
    request = {
        "study": "design",
        "vary": _ranges(vary),
        "together": bool(together),
        "costs": [] if cost is None else _costs(cost),
        "friction": _friction(friction),
        "states": names_of(states),
        "margin": None if margin is None else _number(margin, "margin"),
        "starts": _count(starts, "starts"),
        "points": _count(points, "points"),
        "seed": _count(seed, "seed"),
        "pushes": None if pushes is None else str(pushes),
        "runs": _count(runs, "runs"),
        **_observation(of, window, interval, longest),
    }
    result: dict[str, Any] = _run(scene, request, executor, progress, "the design")["result"]
    result.pop("note")
    return result


def _ranges(vary: Mapping[str, str | tuple[float, float]]) -> list[tuple[str, str]]:
    if not isinstance(vary, Mapping):
        raise ArgumentError(f"{vary!r} has no ranges; give names with ranges, such as {{'module[*].k6': '±5%'}}")
    return [(str(name), _range(given, str(name))) for name, given in vary.items()]


def _range(given: str | tuple[float, float], name: str) -> str:
    if isinstance(given, str):
        return given
    low, high = _pair(given, name, "give '±5%', '-10%:30%', or the smallest and the largest value as a pair")
    return f"{low!r}:{high!r}"


def _friction(friction: float | tuple[float, float]) -> list[float]:
    if isinstance(friction, (list, tuple)):
        return _pair(friction, "friction", "give one value, or the smallest and the largest as a pair")
    return [_number(friction, "friction")] * 2


def _pair(given: Any, name: str, wish: str) -> list[float]:
    if not isinstance(given, (list, tuple)) or len(given) != 2:
        raise ArgumentError(f"{name} = {given!r} is no range; {wish}")
    return [_number(end, name) for end in given]


def _costs(cost: Mapping[str, float]) -> list[tuple[str, float]]:
    if not isinstance(cost, Mapping):
        raise ArgumentError(f"{cost!r} has no costs; give names with factors, such as {{'module[*].k6': 10.0}}")
    return [(str(name), _number(factor, f"the cost of {name}")) for name, factor in cost.items()]
