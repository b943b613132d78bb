"""Kept rows of runs -> one labelled xarray dataset: named dimensions, units, provenance.

Dimensions: `ambient` (one per run), `time` (kept steps), `layer` (1 is the outermost rubber
layer), `cell` (1 is at the upper face). Runs whose rests end at different times have
different clocks: `clock(ambient, time)` then replaces the coordinate `time`. Shorter runs
are padded with NaN.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermobearing.model.handover import PREFIX, attributes_of, dimension_of
from thermobearing.results.writing import as_attribute

Floats = NDArray[np.float64]

# Groups of histories that may be kept besides: variable, dimension, unit, what it is.
GROUPS: dict[str, tuple[str, str, str, str]] = {
    "rubber": ("rubber_temperature", "layer", "degC", "temperature at mid-thickness of the layer"),
    "layer_displacement": ("layer_displacement", "layer", "mm", "shear displacement of the layer"),
    "hysteretic": ("hysteretic_variable", "layer", "mm", "Z of the layer"),
    "cells": ("temperature", "cell", "degC", "temperature of the cell"),
}


@dataclass(frozen=True)
class StackLabels:
    """What the layers and cells are, for the coordinates of a dataset."""

    depth: Floats  # of the cell centres from the upper face [mm]
    thickness: Floats  # of the cells [mm]
    part: tuple[str, ...]
    layers: int
    books: Sequence[tuple[str, str, str]]  # name, unit and meaning of what `RunRecord.books` holds


@dataclass(frozen=True)
class RunRecord:
    """One run as plain arrays, one row per kept step."""

    ambient: float  # at the start [degC]
    books: Mapping[str, Floats]  # by name
    groups: Mapping[str, NDArray[Any]]  # [steps, layers or cells] by name of GROUPS
    segment: NDArray[np.int32]
    cycle: NDArray[np.int32]
    initial: Floats  # cell temperatures [degC]
    final: Floats
    final_lead: float  # [degC], NaN without lead
    memory: Mapping[str, Any]  # where the bearing was at the end, besides (model/handover.py)
    outcome: str
    softened_steps: int
    mismatch: float
    steps: int


def build_dataset(
    runs: list[RunRecord],
    labels: StackLabels,
    groups: tuple[str, ...],
    *,
    area: float,
    total_rubber_thickness: float,
    attributes: dict[str, Any],
) -> xr.Dataset:
    """One dataset from the runs of an analysis.

    Parameters
    ----------
    runs : in the order of the ambient temperatures.
    labels : of the stack.
    groups : which of GROUPS were kept.
    area, total_rubber_thickness : for stress and strain [mm2, mm].
    attributes : provenance, kept in the dataset's attributes.
    """
    length = max(len(run.segment) for run in runs)
    clock = stacked([run.books["clock"] for run in runs], length)
    same = all(np.array_equal(clock[0], other) for other in clock)
    data: dict[str, Any] = {}
    meanings = {name: {"units": unit, "long_name": text} for name, unit, text in labels.books}
    for name, attrs in meanings.items():
        if name != "clock" or not same:
            values = stacked([run.books[name] for run in runs], length)
            data[name] = (("ambient", "time"), values, attrs)
    data |= _derived(data, area, total_rubber_thickness)
    for group in (name for name in GROUPS if name in groups):
        name, dimension, unit, meaning = GROUPS[group]
        parts = [run.groups[group] for run in runs]
        attrs = {"units": unit, "long_name": meaning}
        data[name] = (("ambient", "time", dimension), stacked(parts, length), attrs)
    data |= _per_run(runs, length) | _memories(runs)
    coordinates = _coordinates(runs, labels, bool(attributes.get("half_stack")))
    if same:
        coordinates["time"] = ("time", clock[0], meanings["clock"])
    return xr.Dataset(
        data,
        coords=coordinates,
        attrs={key: as_attribute(value) for key, value in attributes.items()},
    )


def stacked(arrays: list[NDArray[Any]], length: int, padding: float = np.nan) -> NDArray[Any]:
    """Runs on a leading axis, shorter ones padded; no copy for a single run."""
    if len(arrays) == 1:
        return arrays[0][np.newaxis]
    out = np.full((len(arrays), length, *arrays[0].shape[1:]), padding, dtype=arrays[0].dtype)
    for i, values in enumerate(arrays):
        out[i, : len(values)] = values
    return out


def _derived(data: dict[str, Any], area: float, rubber: float) -> dict[str, Any]:
    """Average shear strain and stress of the bearing."""
    dims = ("ambient", "time")
    strain = {"units": "1", "long_name": "average shear strain of the rubber"}
    stress = {"units": "MPa", "long_name": "force over gross plan area"}
    return {
        "strain": (dims, data["displacement"][1] / rubber, strain),
        "stress": (dims, data["force"][1] * (1e3 / area), stress),
    }


def _per_run(runs: list[RunRecord], length: int) -> dict[str, Any]:
    """What has no clock, or is a whole number: outcomes, profiles, segment and cycle numbers."""
    segment = stacked([run.segment for run in runs], length, padding=-1)
    cycle = stacked([run.cycle for run in runs], length, padding=0)
    counted = ("ambient", "time")
    profile = ("ambient", "cell")
    degrees = {"units": "degC"}
    return {
        "segment": (counted, segment, {"units": "1", "long_name": "step of the test, from 0"}),
        "cycle": (counted, cycle, {"units": "1", "long_name": "cycle in the step, 0 outside"}),
        "initial_temperature": (profile, np.array([r.initial for r in runs]), degrees),
        "final_temperature": (profile, np.array([r.final for r in runs]), degrees),
        "final_lead_temperature": (
            "ambient",
            np.array([r.final_lead for r in runs]),
            {"units": "degC"},
        ),
        "outcome": ("ambient", np.array([r.outcome for r in runs], dtype=object)),
        "steps": ("ambient", np.array([r.steps for r in runs]), {"units": "1"}),
        "softened_steps": ("ambient", np.array([r.softened_steps for r in runs]), {"units": "1"}),
        "layer_force_mismatch_max": (
            "ambient",
            np.array([r.mismatch for r in runs]),
            {"units": "kN", "long_name": "largest layer force mismatch of the run"},
        ),
    }


def _memories(runs: list[RunRecord]) -> dict[str, Any]:
    """The state at the end of each run, from which another test can go on; no empty variables."""
    found = {}
    for key in runs[0].memory:
        values = np.array([run.memory[key] for run in runs])
        dimension = dimension_of(key)
        dims = ("ambient",) if dimension is None else ("ambient", dimension)
        if values.size:
            found[PREFIX + key] = (dims, values, attributes_of(key))
    return found


def depth_attributes(half: bool) -> dict[str, str]:
    """Of the coordinate `depth`; of a half stack the other half is its mirror image."""
    name = "distance of the cell centre from the upper face"
    return {"units": "mm", "long_name": f"{name}, to the middle (half stack)" if half else name}


def _coordinates(runs: list[RunRecord], labels: StackLabels, half: bool) -> dict[str, Any]:
    ambient = {"units": "degC", "long_name": "ambient temperature at the start"}
    depth = depth_attributes(half)
    thickness = {"units": "mm", "long_name": "thickness of the cell"}
    return {
        "ambient": ("ambient", np.array([run.ambient for run in runs]), ambient),
        "layer": ("layer", np.arange(1, labels.layers + 1), {"long_name": "rubber layer, 1 outer"}),
        "cell": ("cell", np.arange(1, len(labels.depth) + 1), {"long_name": "cell, 1 at the face"}),
        "depth": ("cell", labels.depth, depth),
        "cell_thickness": ("cell", labels.thickness, thickness),
        "part": ("cell", np.array(labels.part, dtype=object), {"long_name": "what the cell is"}),
    }
