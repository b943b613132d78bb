"""Kept rows of runs -> one labelled xarray dataset: named dimensions, units, provenance.

Dimensions: `ambient` (one per run), `time` (kept steps), `layer` (1 is the outermost rubber
layer), `cell` (1 is at the upper face). Runs whose rests end at different times have
different clocks: `clock(ambient, time)` then replaces the coordinate `time`. Shorter runs
are padded with NaN.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermobearing.results.writing import as_attribute

Floats = NDArray[np.float64]

# Books of a kept row in order: name, unit, what it is.
BOOKS: tuple[tuple[str, str, str], ...] = (
    ("clock", "s", "time since the start"),
    ("displacement", "mm", "shear displacement of the bearing"),
    ("force", "kN", "restoring force, positive with positive displacement"),
    ("work_in", "kN mm", "mechanical work done on the bearing"),
    ("heat_released", "kN mm", "heat released in the rubber layers"),
    ("recoverable", "kN mm", "recoverable energy stored in the rubber layers"),
    ("heat_lost_ends", "kN mm", "heat lost through the end faces"),
    ("heat_lost_sides", "kN mm", "heat lost through the sides"),
    ("heat_stored", "kN mm", "heat stored in the bearing since the start"),
    ("layer_force_mismatch", "kN", "largest difference of a layer law from the force"),
    ("sharing_weight", "1", "weight of the mean strain in the hardening factor"),
)
# Further books of bearings with lead or rate dependence.
BRANCHES: tuple[tuple[str, str, str], ...] = (
    ("rubber_force", "kN", "share of the rubber layers in the force"),
    ("lead_force", "kN", "share of the lead cores in the force"),
    ("viscous_force", "kN", "share of the rate-dependent branch in the force"),
    ("lead_temperature", "degC", "temperature of the lead cores"),
)
# Groups of further columns: variable, dimension, unit, what it is.
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
    branches: bool  # lead or rate dependence beside the rubber


@dataclass(frozen=True)
class RunRecord:
    """One run as plain arrays: `rows` holds the books, then the layer groups in their order."""

    ambient: float  # at the start [degC]
    rows: Floats
    cells: NDArray[np.float32]  # cell temperatures of the kept steps, if asked for
    segment: NDArray[np.int32]
    cycle: NDArray[np.int32]
    initial: Floats  # cell temperatures [degC]
    final: Floats
    final_lead: float  # [degC], NaN without lead
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
    groups : which of GROUPS the rows hold after the books.
    area, total_rubber_thickness : for stress and strain [mm2, mm].
    attributes : provenance, kept in the dataset's attributes.
    """
    length = max(len(run.rows) for run in runs)
    clock = _stacked([run.rows[:, 0] for run in runs], length)
    same = all(np.array_equal(clock[0], other) for other in clock)
    data: dict[str, Any] = {}
    books = BOOKS + BRANCHES if labels.branches else BOOKS
    for column, (name, unit, meaning) in enumerate(books):
        if name != "clock" or not same:
            values = _stacked([run.rows[:, column] for run in runs], length)
            data[name] = (("ambient", "time"), values, {"units": unit, "long_name": meaning})
    data |= _derived(data, area, total_rubber_thickness)
    column = len(books)
    for group in (name for name in GROUPS if name in groups):
        name, dimension, unit, meaning = GROUPS[group]
        part = slice(column, column + labels.layers)
        parts = [run.cells if group == "cells" else run.rows[:, part] for run in runs]
        attrs = {"units": unit, "long_name": meaning}
        data[name] = (("ambient", "time", dimension), _stacked(parts, length), attrs)
        column += labels.layers
    data |= _per_run(runs, length)
    coordinates = _coordinates(runs, labels)
    if same:
        coordinates["time"] = ("time", clock[0], {"units": "s", "long_name": BOOKS[0][2]})
    return xr.Dataset(
        data,
        coords=coordinates,
        attrs={key: as_attribute(value) for key, value in attributes.items()},
    )


def _stacked(arrays: list[NDArray[Any]], length: int, padding: float = np.nan) -> NDArray[Any]:
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
    segment = _stacked([run.segment for run in runs], length, padding=-1)
    cycle = _stacked([run.cycle for run in runs], length, padding=0)
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


def _coordinates(runs: list[RunRecord], labels: StackLabels) -> dict[str, Any]:
    ambient = {"units": "degC", "long_name": "ambient temperature at the start"}
    depth = {"units": "mm", "long_name": "distance of the cell centre from the upper face"}
    return {
        "ambient": ("ambient", np.array([run.ambient for run in runs]), ambient),
        "layer": ("layer", np.arange(1, labels.layers + 1), {"long_name": "rubber layer, 1 outer"}),
        "cell": ("cell", np.arange(1, len(labels.depth) + 1), {"long_name": "cell, 1 at the face"}),
        "depth": ("cell", labels.depth, depth),
        "cell_thickness": ("cell", labels.thickness, {"units": "mm"}),
        "part": ("cell", np.array(labels.part, dtype=object), {"long_name": "what the cell is"}),
    }
