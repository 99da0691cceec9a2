"""Tables of results: an `xarray.Dataset` where xarray is installed, a dictionary of arrays elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    Column = tuple[tuple[str, ...], Any, dict[str, Any]]
    """Dimensions, values and attributes of a variable."""


def table(
    variables: Mapping[str, Column],
    coordinates: Mapping[str, Column],
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


def columns(rows: list[dict[str, Any]], dimension: str) -> dict[str, Column]:
    """Makes a variable of each key of rows; a number that is missing is NaN, a text that is missing empty.

    Where a key has numbers in some rows and texts in others, all are texts.
    """
    import numpy as np

    keys = list(dict.fromkeys(key for row in rows for key in row))
    made: dict[str, Column] = {}
    for key in keys:
        values = [row.get(key) for row in rows]
        known = [value for value in values if value is not None]
        if any(isinstance(value, str) for value in known):
            array = np.array(["" if value is None else str(value) for value in values], dtype=np.str_)
        elif known and len(known) == len(values) and all(isinstance(value, bool) for value in known):
            array = np.array(values, dtype=bool)
        else:
            is_complex = any(isinstance(value, complex) for value in known)
            numbers = [np.nan if value is None else value for value in values]
            array = np.array(numbers, dtype=complex if is_complex else float)
        made[key] = ((dimension,), array, {})
    return made


def names_of(names: Iterable[str]) -> list[str]:
    """Names of variables as a list; a text alone is no list of names."""
    if isinstance(names, str):
        raise TypeError(f"give a list of names, such as [{names!r}]")
    return [str(name) for name in names]
