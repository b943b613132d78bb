"""Which rows of a history are written: turning points, and 200 points a cycle.

A step of 5 ms makes thousands of rows a cycle, and a tall bearing a hundred numbers a row. What is
computed from a history (measures, books, figures) is computed before, from all of its rows; what
is kept keeps its bits.
"""

from itertools import pairwise

import numpy as np
import xarray as xr

from thermobearing.cyclic.dataset import stacked
from thermobearing.cyclic.measures import unit_of
from thermobearing.cyclic.result import CYCLES, Ints, Result
from thermobearing.results.metrics import find_cycles

POINTS = 200  # of a cycle, a ramp, a rest
PADDING = {"segment": -1.0, "cycle": 0.0}  # after the end of a shorter run; else NaN
ROWS = "rows"  # attribute of a dataset that was thinned
THINNED, COMPLETE = "thinned", "complete"


def thinned(result: Result) -> Result:
    """The result with its cycles as a table of its own, and the rows that are worth writing.

    Parameters
    ----------
    result : as computed; one that was thinned before comes back as it is.
    """
    if result.dataset.attrs.get(ROWS) == THINNED:
        return result
    rows = [rows_worth(result, run) for run in range(result.dataset.sizes["ambient"])]
    data = result.dataset
    if "clock" not in data:  # one clock for all
        data = data.isel(time=np.unique(np.concatenate(rows)))
    else:
        data = _gathered(data, rows)
    return Result(with_cycles(data, result).assign_attrs({ROWS: THINNED}))


def with_cycles(data: xr.Dataset, result: Result) -> xr.Dataset:
    """The dataset with the columns of `Result.cycles` as variables, one number a closed cycle."""
    cycles = result.cycles
    return data.assign(
        {
            f"{CYCLES}_{name}": (CYCLES, cycles[name].to_numpy(), {"units": unit_of(str(name))})
            for name in cycles.columns
        }
    )


def _gathered(data: xr.Dataset, rows: list[Ints]) -> xr.Dataset:
    """Other rows of each run, padded to the longest."""
    length = max(map(len, rows))
    found = {}
    for name, values in data.data_vars.items():
        if values.dims[:2] == ("ambient", "time"):
            parts = [values.values[run, mine] for run, mine in enumerate(rows)]
            padding = PADDING.get(str(name), np.nan)
            found[name] = (values.dims, stacked(parts, length, padding), values.attrs)
    return data.drop_vars(list(found)).assign(found)


def rows_worth(result: Result, run: int) -> Ints:
    """Rows of a run that are written: of each cycle its ends, its extremes, and 200 between.

    Parameters
    ----------
    result : as computed.
    run : its number.
    """
    data = result.dataset
    x, force = data["displacement"].values[run], data["force"].values[run]
    kept = [np.array([0])]
    for first, end in _blocks(result, run):
        block = slice(first, end)
        size = end - first
        even = np.linspace(0, size - 1, min(size, POINTS)).round()
        ends = [turn(values[block]) for values in (x, force) for turn in (np.argmax, np.argmin)]
        kept.append(first + np.concatenate([even, ends]).astype(np.int64))
    return np.unique(np.concatenate(kept))


def _blocks(result: Result, run: int) -> list[tuple[int, int]]:
    """First row and end of each cycle of a run, and of each step without cycles."""
    segment = result.dataset["segment"].values[run]
    cycle = result.dataset["cycle"].values[run]
    x = result.dataset["displacement"].values[run]
    count = int((segment >= 0).sum())
    change = np.diff(segment[:count]) | np.diff(cycle[:count])
    bounds = {0, count, *(1 + np.flatnonzero(change)).tolist()}
    parts = np.searchsorted(segment[:count], np.arange(len(result.segments) + 1))
    for number, about in enumerate(result.segments):
        first, end = int(parts[number]), int(parts[number + 1])
        if about["kind"] == "recorded" and first < end:
            found = find_cycles(x[first:end])
            bounds |= {first + int(place) + 1 for pair in found for place in pair}
    ordered = sorted(place for place in bounds if place <= count)
    return [(a, b) for a, b in pairwise(ordered) if a < b]
