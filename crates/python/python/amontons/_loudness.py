"""Growth rates beside the loudness of motions, as a method of `Scene`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from ._executors import Executor
from ._robustness import _count
from ._studies import _above_zero, _attributes, _observation, _outcome, _run
from ._tables import columns, give_units, names_of, table

if TYPE_CHECKING:
    import xarray

    from . import _tables
    from ._scene import Scene
    from ._tables import Column

    Table = xarray.Dataset | _tables.Table

OF_MOTION = ("kind", "amplitude", "frequency", "period")


def loudness(
    scene: Scene,
    *,
    push: float | None = None,
    points: Iterable[str] | None = None,
    candidates: int = 20,
    of: str | None = None,
    window: float | None = None,
    interval: float | None = None,
    longest: float | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> Table:
    """The growth rate of each growing mode of uniform sliding beside the loudness of the motion that it leads to.

    Where no mode grows, the growing modes of other contact states, the candidates, are pushed.

    Parameters
    ----------
    push : float, optional
        The largest velocity of the start along each growing mode, m/s; by default a thousandth of the fastest surface's velocity.
    points : iterable of str, optional
        Points whose motion is measured, such as ``module[1].m2``, ``pad`` or ``pad.17``; by default all masses with a contact, and
        the nodes that the scene shows.
    candidates : int
        The largest number of candidates that are pushed, those that need the least energy first.
    of, window, interval, longest, executor, progress
        As in `limit_cycles`.

    Returns
    -------
    xarray.Dataset or dict
        Over ``way``, which has the names of modes or candidates: contact ``states``, ``mode_frequency`` (Hz), ``growth_rate``
        (1/s), ``growth_rank``, ``loudness_rank`` (NaN of what has no measured motion), ``push`` (m/s), ``motion``, the number of
        its motion from 0 (-1 where it has not settled), and ``failure``.
        Over ``motion``: ``motion_kind``, ``motion_amplitude``, ``motion_frequency`` (Hz), ``motion_period`` (s);
        ``motion_nearest_mode``, the mode of uniform sliding with the nearest frequency, and ``motion_share``, its share of the
        kinetic energy; ``motion_power`` of friction (W) and ``motion_energy`` a cycle (J).
        Over ``motion`` and ``point``: ``speed_rms``, ``speed_peak``, ``normal_rms``, ``normal_peak`` (m/s) and ``amplitude`` (m);
        NaN of motions that are not measured.
        Over ``finding``: ``finding_text``, sentences on where the ranks disagree.

    Examples
    --------
    >>> found = amontons.Scene.builtin("set1").loudness()
    >>> [str(name) for name in found["way"].values], round(float(found["motion_frequency"][0]))
    (['mode 6'], 167)
    """
    import numpy as np

    request = {
        "study": "loudness",
        "push": None if push is None else _above_zero(push, "push"),
        "points": [] if points is None else names_of(points),
        "candidates": _count(candidates, "candidates"),
        **_observation(of, window, interval, longest),
    }
    found = _run(scene, request, executor, progress, "the motions")
    result = found["result"]["found"]
    ways = [row["way"] for row in result["rows"]]
    motions = result["motions"]
    measured = [motion["measured"] for motion in motions]
    names = [point["point"] for point in next((one["points"] for one in measured if one), [])]
    variables: dict[str, Column] = {
        **columns([_row(row) for row in result["rows"]], "way"),
        **columns([_motion(motion) for motion in motions], "motion", "motion_"),
        **columns([{"text": text} for text in result["findings"]], "finding", "finding_"),
    }
    shape = len(motions), len(names)
    parts = {"speed_rms": "rms", "speed_peak": "peak", "normal_rms": "normal_rms", "normal_peak": "normal_peak"}
    for name, key in {**parts, "amplitude": "amplitude"}.items():
        values = [[point[key] for point in one["points"]] if one else [None] * len(names) for one in measured]
        array = np.array(values, dtype=float).reshape(shape)
        variables[name] = (("motion", "point"), array, {"units": "m" if name == "amplitude" else "m/s"})
    output = scene._units().get(found["look"]["of"], "1")
    units = {"mode_frequency": "Hz", "growth_rate": "1/s", "push": "m/s", "motion_amplitude": output}
    of_motion = {"motion_frequency": "Hz", "motion_period": "s", "motion_power": "W", "motion_energy": "J"}
    give_units(variables, {**units, **of_motion})
    coordinates: dict[str, Column] = {
        "way": (("way",), np.array([f"{way['kind']} {way['number']}" for way in ways], dtype=np.str_), {}),
        "point": (("point",), np.array(names, dtype=np.str_), {}),
    }
    return table(variables, coordinates, _attributes(scene, found))


def _row(row: dict[str, Any]) -> dict[str, Any]:
    """The columns of a way, with the attempt that stands for all."""
    way, attempt = row["way"], row["attempts"][row["chosen"]]
    return {
        "states": way["states"],
        "mode_frequency": way["frequency"],
        "growth_rate": way["growth_rate"],
        "growth_rank": row["growth_rank"],
        "loudness_rank": row["loudness_rank"],
        "push": attempt["push"],
        "motion": -1 if attempt["motion"] is None else attempt["motion"],
        "failure": attempt["failure"] or "",
    }


def _motion(motion: dict[str, Any]) -> dict[str, Any]:
    """The columns of a motion."""
    outcome = _outcome({"ending": motion["ending"]})
    nearest, measured = motion["nearest"], motion["measured"]
    power = measured and measured["power"]
    return {
        **{key: outcome[key] for key in OF_MOTION},
        "nearest_mode": " and ".join(str(number) for number in nearest["modes"]) if nearest else "",
        "share": nearest["share"] if nearest else None,
        "power": power["friction"] if power else None,
        "energy": power["energy"] if power else None,
    }
