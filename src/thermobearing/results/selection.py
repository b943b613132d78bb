"""Select and compare runs by their labels."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, nearest, short_repr
from thermobearing.border.lazy import xr
from thermobearing.border.units import refuse_hidden
from thermobearing.core.records import Floats
from thermobearing.quantities.governing import place_of_largest
from thermobearing.results.writing import as_attribute, from_attribute

# Attributes with rows of each run.
REACHED = ("rig", "tested_range", "bearing_checks", "axial", "devices")
CLOSE = 1e-9  # relative tolerance of a selected number


def chosen_runs(labels: Mapping[str, Any], wanted: Mapping[str, Any]) -> list[int]:
    """Return the indices of the runs with the wanted labels, each one value or several."""
    unknown = [name for name in wanted if name not in labels]
    if unknown:
        problems = [f'no label "{name}"{nearest(name, set(labels))}' for name in unknown]
        raise InputError(problems, "sel()")
    chosen = np.ones(len(next(iter(labels.values()))), dtype=bool)
    for name, values in wanted.items():
        is_list = isinstance(values, list | tuple | set | np.ndarray)
        matching = np.zeros(len(chosen), dtype=bool)
        for value in values if is_list else [values]:
            matches = _matches(labels[name], value)
            if not matches.any():
                available = ", ".join(dict.fromkeys(f"{item}" for item in labels[name]))
                raise InputError(
                    f"no run with {name} = {short_repr(value)}; there are {available}", "sel()"
                )
            matching |= matches
        chosen &= matching
    if not chosen.any():
        raise InputError(f"no run has all of {short_repr(dict(wanted))}", "sel()")
    return [int(run) for run in np.flatnonzero(chosen)]


def _matches(labels: Any, value: Any) -> Any:
    values = np.asarray(labels)
    if values.dtype.kind not in "fi":
        return np.array([str(item) == str(value) for item in values])
    try:
        refuse_hidden(value, "sel()")
        return np.isclose(values, float(value), rtol=CLOSE, atol=CLOSE)
    except (TypeError, ValueError, OverflowError):
        return np.zeros(len(values), dtype=bool)


def selected(
    data: "xr.Dataset", dimension: str, runs: list[int], names: Sequence[Collection[str]]
) -> "xr.Dataset":
    """Return some runs of a dataset along a dimension, with their rows of the attributes.

    `names` are those of each run in the rows.
    """
    run_names = {name for run in runs for name in names[run]}
    attributes = {
        key: as_attribute([row for row in from_attribute(data, key) if row["run"] in run_names])
        for key in REACHED
        if key in data.attrs
    }
    return data.isel({dimension: runs}).assign_attrs(attributes)


def gridded(data: "xr.Dataset", names: list[str]) -> "xr.Dataset":
    """Return a dataset with labels as dimensions instead of `run`; NaN where there is no run."""
    orders = {name: list(dict.fromkeys(data[name].values.tolist())) for name in names}
    unused_labels = [
        str(n) for n, c in data.coords.items() if c.dims == ("run",) and n not in names
    ]
    grid = data.drop_vars(unused_labels).set_index(run=names).unstack("run").reindex(orders)
    for name in names:
        grid[name].attrs.update(data[name].attrs)
    return grid.transpose(*names, ...)


def temperature_differences(place: str, computed: Floats, expected: Floats) -> dict[str, float]:
    """Return the root mean square and the largest error of a temperature, with its sign [K]."""
    error = computed - expected
    return {
        f"{place} rms K": float(np.sqrt(np.mean(error**2))),
        f"{place} largest K": float(error[place_of_largest(np.abs(error))]),
    }


def force_differences(computed: Floats, expected: Floats) -> dict[str, float]:
    """Return the root mean square error of a force and that of its peak, of the peak [%]."""
    peak = float(np.abs(expected).max())
    rms = float(np.sqrt(np.mean((computed - expected) ** 2)))
    return {"force rms %": _percent(rms, peak), "peak force %": more(np.abs(computed).max(), peak)}


def _percent(part: float, total: float) -> float:
    return 100.0 * part / total if total else float("nan")


def more(computed: float, expected: float) -> float:
    """Return how much a number is larger than expected [%]; NaN if that is zero."""
    return _percent(float(computed) - float(expected), float(expected))


def layer_names(count: int, half: bool) -> list[str]:
    """Return layers from the upper face, with where the first and the last one are."""
    names = [f"layer {j}" for j in range(1, count + 1)]
    names[-1] += " (innermost)" if half else " (lower face)"
    names[0] = "layer 1 (outermost)" if half else "layer 1 (upper face)"
    return names


def layer_groups(temperature: Floats, half: bool, within: float) -> list[tuple[str, int]]:
    """Return name and last index of each group of adjacent layers that are alike.

    `temperature` has the layers on its last axis; those of a group differ nowhere by more than
    `within` from its first layer [K].
    """
    names, first = layer_names(temperature.shape[-1], half), 0
    groups: list[tuple[str, int]] = []
    for j, name in enumerate(names):
        if j and np.nanmax(np.abs(temperature[..., j] - temperature[..., first])) <= within:
            groups[-1] = f"layers {first + 1} to{name.removeprefix('layer')}", j
        else:
            first = j
            groups.append((name, j))
    return groups
