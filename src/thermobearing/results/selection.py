"""Select and compare runs by their labels."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.results.writing import as_attribute, from_attribute

Floats = NDArray[np.float64]
REACHED = ("rig", "tested_range")  # attributes: what each run reached
CLOSE = 1e-9  # of a number that is asked for, relative to itself


def chosen_runs(labels: Mapping[str, Any], wanted: Mapping[str, Any]) -> list[int]:
    """Numbers of the runs that have the wanted labels.

    Parameters
    ----------
    labels : of all runs, by name: an array each.
    wanted : by name: a value, or several in a list.

    Raises
    ------
    InputError : there is no such label, or no run with it.

    Examples
    --------
    >>> chosen_runs({"ambient": [-20.0, 0.0, 23.0]}, {"ambient": [23, -20]})
    [0, 2]
    """
    unknown = [name for name in wanted if name not in labels]
    if unknown:
        told = [f'no label "{name}"{nearest(name, set(labels))}' for name in unknown]
        raise InputError(told, "sel()")
    found = np.ones(len(next(iter(labels.values()))), dtype=bool)
    for name, values in wanted.items():
        several = isinstance(values, list | tuple | set | np.ndarray)
        mine = np.zeros(len(found), dtype=bool)
        for value in values if several else [values]:
            same = _same(labels[name], value)
            if not same.any():
                there = ", ".join(dict.fromkeys(f"{item}" for item in labels[name]))
                raise InputError(f"no run with {name} = {value!r}; there are {there}", "sel()")
            mine |= same
        found &= mine
    if not found.any():
        raise InputError(f"no run has all of {dict(wanted)!r}", "sel()")
    return [int(run) for run in np.flatnonzero(found)]


def _same(labels: Any, value: Any) -> Any:
    """Which labels are a value."""
    there = np.asarray(labels)
    if there.dtype.kind in "fi":
        try:
            return np.isclose(there, float(value), rtol=CLOSE, atol=CLOSE)
        except (TypeError, ValueError):
            return np.zeros(len(there), dtype=bool)
    return np.array([str(item) == str(value) for item in there])


def selected(data: xr.Dataset, dimension: str, runs: list[int], names: Sequence[str]) -> xr.Dataset:
    """Some runs of a dataset, and what its attributes say of them.

    Parameters
    ----------
    data : of several runs.
    dimension : that the runs have in it.
    runs : their numbers.
    names : what each of all runs is called in the rows of `results.ranges.compared`.
    """
    mine = {names[run] for run in runs}
    told = {
        key: as_attribute([row for row in from_attribute(data, key) if row["run"] in mine])
        for key in REACHED
        if key in data.attrs
    }
    return data.isel({dimension: runs}).assign_attrs(told)


def gridded(data: xr.Dataset, names: list[str]) -> xr.Dataset:
    """The labels of the dimension `run` as dimensions, in the order in which they come.

    Parameters
    ----------
    data : with a dimension `run`, and the labels as its coordinates.
    names : of the labels; a combination without a run becomes NaN.
    """
    orders = {name: list(dict.fromkeys(data[name].values.tolist())) for name in names}
    others = [str(n) for n, c in data.coords.items() if c.dims == ("run",) and n not in names]
    grid = data.drop_vars(others).set_index(run=names).unstack("run").reindex(orders)
    for name in names:
        grid[name].attrs.update(data[name].attrs)
    return grid.transpose(*names, ...)


def temperature_differences(place: str, found: Floats, expected: Floats) -> dict[str, float]:
    """Root mean square and largest error of a temperature, with its sign [K].

    Examples
    --------
    >>> temperature_differences("lead", np.array([1.0, -3.0]), np.array([0.0, 0.0]))
    {'lead rms K': 2.23606797749979, 'lead largest K': -3.0}
    """
    error = found - expected
    return {
        f"{place} rms K": float(np.sqrt(np.mean(error**2))),
        f"{place} largest K": float(error[np.abs(error).argmax()]),
    }


def force_differences(found: Floats, expected: Floats) -> dict[str, float]:
    """Root mean square error of a force and error of its peak, of the expected peak [%].

    Examples
    --------
    >>> force_differences(np.array([1.0, -3.0]), np.array([1.0, -2.0]))["peak force %"]
    50.0
    """
    peak = float(np.abs(expected).max())
    rms = float(np.sqrt(np.mean((found - expected) ** 2)))
    return {"force rms %": per_cent(rms, peak), "peak force %": more(np.abs(found).max(), peak)}


def per_cent(part: float, whole: float) -> float:
    """A part of a whole [%]; NaN of nothing."""
    return 100.0 * part / whole if whole else float("nan")


def more(found: float, expected: float) -> float:
    """How much more than expected [%]; NaN of nothing."""
    return per_cent(float(found) - float(expected), float(expected))
