"""Tables of results: an `xarray.Dataset` where xarray is installed, a dictionary of arrays elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    Column = tuple[tuple[str, ...], Any, dict[str, Any]]
    """Dimensions, values and attributes of a variable."""


class Table(dict[str, Any]):
    """Arrays by their names, where xarray is not installed; with the attributes that a dataset has."""

    def __init__(self, arrays: Mapping[str, Any], attrs: dict[str, Any]) -> None:
        super().__init__(arrays)
        self.attrs = attrs
        """Attributes of the table."""


def table(
    variables: Mapping[str, Column],
    coordinates: Mapping[str, Column],
    attributes: dict[str, Any],
) -> xarray.Dataset | Table:
    """Makes a table of variables over coordinates, each with its dimensions, values and attributes.

    Attributes are numbers and texts, so that a dataset can be written to a file.
    """
    try:
        import xarray
    except ImportError:
        arrays = {name: values for name, (_, values, _) in {**coordinates, **variables}.items()}
        return Table(arrays, attributes)
    return xarray.Dataset(variables, coordinates, attributes)


def columns(rows: Sequence[Mapping[str, Any]], dimension: str, prefix: str = "") -> dict[str, Column]:
    """Makes a variable of each key of rows.

    A number that is missing is NaN, a text that is missing is empty. Where a key has numbers in some rows and texts in
    others, all are texts.
    """
    keys = dict.fromkeys(key for row in rows for key in row)
    return {f"{prefix}{key}": ((dimension,), _array([row.get(key) for row in rows]), {}) for key in keys}


def _array(values: list[Any]) -> Any:
    import numpy as np

    known = [value for value in values if value is not None]
    if any(isinstance(value, str) for value in known):
        return np.array(["" if value is None else str(value) for value in values], dtype=np.str_)
    is_whole = len(known) == len(values)
    if is_whole and all(isinstance(value, bool) for value in known):
        return np.array(values, dtype=bool)
    if is_whole and all(isinstance(value, int) and abs(value) < 2**63 for value in known):
        return np.array(values, dtype=np.int64)
    is_complex = any(isinstance(value, complex) for value in known)
    numbers = [np.nan if value is None else value for value in values]
    return np.array(numbers, dtype=complex if is_complex else float)


def give_units(variables: Mapping[str, Column], units: Mapping[str, str]) -> None:
    """Gives variables their units, as far as the table has them."""
    for name, unit in units.items():
        if name in variables:
            variables[name][2]["units"] = unit


def names_of(names: Iterable[str]) -> list[str]:
    """Names of variables as a list; a text alone is no list of names."""
    if isinstance(names, str):
        raise TypeError(f"give a list of names, such as [{names!r}]")
    return [str(name) for name in names]
