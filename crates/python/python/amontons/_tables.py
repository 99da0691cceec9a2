"""Tables of results: an `xarray.Dataset` where xarray is installed, a dictionary of arrays elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray


def table(
    variables: dict[str, tuple[tuple[str, ...], Any, dict[str, Any]]],
    coordinates: dict[str, tuple[tuple[str, ...], Any, dict[str, Any]]],
    attributes: dict[str, Any],
) -> xarray.Dataset | dict[str, Any]:
    """Makes a table of variables over coordinates, each with its dimensions, values and attributes.

    Without xarray the result is a dictionary of the arrays of all variables and coordinates by their names, with the
    attributes under the name `attrs`.
    """
    try:
        import xarray
    except ImportError:
        columns = {name: values for name, (_, values, _) in {**coordinates, **variables}.items()}
        return {**columns, "attrs": attributes}
    return xarray.Dataset(variables, coordinates, attributes)


def columns(rows: list[dict[str, Any]], dimension: str) -> dict[str, Any]:
    """Makes a variable of each key of rows that are alike; a number that is missing is NaN, a text that is missing empty."""
    import numpy as np

    keys = list(dict.fromkeys(key for row in rows for key in row))
    made = {}
    for key in keys:
        values = [row.get(key) for row in rows]
        known = [value for value in values if value is not None]
        if known and all(isinstance(value, bool) for value in known) and len(known) == len(values):
            array = np.array(values, dtype=bool)
        elif all(isinstance(value, (bool, int, float)) for value in known):
            array = np.array([np.nan if value is None else value for value in values], dtype=float)
        elif all(isinstance(value, str) for value in known):
            array = np.array(["" if value is None else value for value in values], dtype=np.str_)
        else:
            continue
        made[key] = ((dimension,), array, {})
    return made
