"""From histories of an earthquake study to one labelled dataset with its provenance."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.border.toml import to_table
from thermobearing.core.records import Floats
from thermobearing.cyclic.dataset import depth_attributes
from thermobearing.cyclic.label import stack_labels
from thermobearing.cyclic.reported import heat_flow
from thermobearing.earthquake.case import EarthquakeCase, in_weather
from thermobearing.earthquake.ends import labelled_ends
from thermobearing.earthquake.meanings import meaning_of
from thermobearing.earthquake.measures import LOOP_UNITS, UNITS, loop_measures, measures_of
from thermobearing.earthquake.parts import label_parts
from thermobearing.earthquake.reached import warnings_of
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.traces import CLOCK, HISTORIES, MM_PER_M, padded, traces_of
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import INTERRUPTED
from thermobearing.model.outcomes import SENTENCES as RUN_SENTENCES
from thermobearing.results.writing import as_attribute
from thermobearing.structure.matrices import (
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    mean_height,
)
from thermobearing.structure.run import SENTENCES, StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

AIR = {"units": "degC", "long_name": "ambient temperature"}
ACROSS = {  # histories with one number per layer, body or cell: dimension, unit, long name
    "rubber_temperature": ("layer", "degC", "mid-thickness temperature of the rubber layers"),
    "body_acceleration": ("body", "m/s2", "absolute acceleration of the masses of each body"),
}
CELLS = ("cell", "degC", "temperature of the cells, the first at the upper face")


def label_study(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> EarthquakeResult:
    """The dataset of a study: peaks from every step, histories every `keep_every`-th."""
    tasks = tasks[: len(histories)]
    traces = [traces_of(task, history) for task, history in zip(tasks, histories, strict=True)]
    numbers = [
        measures_of(task, history, trace) | loop_measures(task, trace)
        for task, history, trace in zip(tasks, histories, traces, strict=True)
    ]
    every = case.analysis.keep_every
    length = max((len(trace["time"][::every]) for trace in traces), default=0)
    data: dict[str, Any] = {}
    slow = [CLOCK] if "pd" in case.modes else []
    for name, unit_name, long_name in (("time", "s", "time"), *HISTORIES, *slow):
        rows = padded([trace[name][::every] for trace in traces], (length,))
        data[name] = (("run", "step"), rows, {"units": unit_name, "long_name": long_name})
    across = ACROSS | ({"temperature": CELLS} if "cells" in case.analysis.keep else {})
    for name, (dimension, unit_name, long_name) in across.items():
        parts = (
            [_bodies(task, history) for task, history in zip(tasks, histories, strict=True)]
            if name == "body_acceleration"
            else [trace[name][::every] for trace in traces]
        )
        wide = padded(parts, (length, max((part.shape[1] for part in parts), default=0)))
        about = {"units": unit_name, "long_name": long_name}
        data[name] = (("run", "step", dimension), wide, about)
    if "temperature" in across:
        data |= _stacks(tasks, data["temperature"][1].shape[2])
    parts_data, parts_coords = label_parts(tasks, histories, padded, length)
    data |= parts_data
    known = {name: long_name for name, _, long_name in HISTORIES}
    units = UNITS | LOOP_UNITS
    if case.laboratory is not None:
        units = units | {"energy_actuator": "kN mm"}
    for name, unit_name in units.items():
        values = np.array([row[name] for row in numbers], dtype=None if unit_name else str)
        data[name] = (("run",), values, {"units": unit_name, "long_name": meaning_of(name, known)})
    data |= labelled_ends(tasks, histories)
    dataset = xr.Dataset(
        data,
        coords={
            "bearing": ("run", np.array([task.device.bearing.name for task in tasks], dtype=str)),
            "motion": ("run", np.array([task.shaking.motion.name for task in tasks], dtype=str)),
            "ambient": ("run", np.array([task.ambient for task in tasks]), AIR),
            "mode": ("run", np.array([task.mode for task in tasks], dtype=str)),
            "layer": np.arange(1, data["rubber_temperature"][1].shape[2] + 1),
            "body": np.array([body.name for body in case.structure.bodies], dtype=str),
            **parts_coords,
        },
        attrs=_attributes(case, tasks, histories) | warnings_of(case, tasks, histories, traces),
    )
    return EarthquakeResult(dataset)


def _bodies(task: "Task", history: StructureHistory) -> Floats:
    """Absolute acceleration of the masses of each body, at the steps that are kept [m/s2]."""
    structure, every = task.case.structure, task.case.analysis.keep_every
    rows = [
        displacement_row(structure, body.name, mean_height(structure, body.name))
        for body in structure.bodies
    ]
    a = history.rows.a[::every]
    ground = task.shaking.ground[: len(history.rows.a) : every]
    return np.asarray((np.array(rows) @ a.T + ground).T / MM_PER_M)


def _stacks(tasks: Sequence["Task"], cells: int) -> dict[str, Any]:
    """What the cells of each run are: thickness and depth, padded with NaN, and part."""
    shape = len(tasks), cells
    depth, thickness = np.full(shape, np.nan), np.full(shape, np.nan)
    part = np.full(shape, "", dtype="<U32")
    for run, task in enumerate(tasks):
        told = task.told.device
        if told.stack is None:
            continue
        model = BearingModel(told.stack, told.constants, task.case.analysis)
        labels_ = stack_labels(model)
        own = slice(0, len(labels_.depth))
        depth[run, own], thickness[run, own] = labels_.depth, labels_.thickness
        part[run, own] = labels_.part
    about = depth_attributes(bool(tasks and tasks[0].case.analysis.half))
    return {
        "depth": (("run", "cell"), depth, about),
        "cell_thickness": (("run", "cell"), thickness, {"units": "mm"}),
        "part": (("run", "cell"), part, {"units": "", "long_name": "what the cell is"}),
    }


def _attributes(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> dict[str, Any]:
    """What the files need beside the numbers."""
    prepared = tasks[0].prepared if tasks else None
    attrs: dict[str, Any] = {
        "command": case.command,
        "structure": case.structure.name,
        "title": case.structure.description or case.structure.name,
        "half_stack": int(case.analysis.half),
        "deck": case.structure.report.deck,
        "pier": case.structure.report.pier,
        "line": case.structure.bearings[case.told_line].name,
        "mass": case.analysis.mass,
        "method": case.analysis.method,
        "damping": case.analysis.damping or case.structure.damping.kind,
        "scheme": case.analysis.scheme,
        "mode": ", ".join(case.modes),
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "interrupted": int(_interrupted(case, histories)),
        "sentences": as_attribute(RUN_SENTENCES | SENTENCES),
    }
    if in_weather(case.model_dump(include={"weather", "lines"})):
        attrs["surroundings"] = heat_flow(to_table(case.analysis), [])
    if prepared is None:
        return attrs
    matrices = prepared.matrices
    attrs["periods_s"] = np.asarray(prepared.modes.periods).tolist()
    attrs["damping_ratios"] = np.asarray(prepared.ratios).tolist()
    attrs["coordinates"] = list(matrices.coordinates)
    seen: dict[str, Any] = {}
    for task in tasks:
        seen.setdefault(task.device.bearing.name, task)
    for name, task in seen.items():
        attrs[f"initial_periods_s:{name}"] = _initial_periods(task).tolist()
        attrs[f"bilinear:{name}"] = int(isinstance(task.device.bearing, BilinearBearing))
    return attrs


def _initial_periods(task: "Task") -> Floats:
    """Periods with the initial stiffness of the bearings at the temperature of the start."""
    from thermobearing.model.element import BearingElement

    matrices, structure = task.prepared.matrices, task.case.structure
    small = 1e-6
    each = np.zeros(len(task.lines))
    for b, (one, line) in enumerate(zip(task.lines, structure.bearings, strict=True)):
        element = BearingElement.from_constants(one.device.constants, initial=one.temperature)
        slope = element.set_trial(small, small, one.ambient).force / small
        each[b] = slope / line.scale
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    stiffness = stiffness + line_stiffness(structure, matrices, each)
    return find_modes(matrices.mass, stiffness).periods


def _interrupted(case: EarthquakeCase, histories: Sequence[StructureHistory]) -> bool:
    """Whether runs are missing."""
    whole = len(case.bearings) * len(case.motions) * case.climates * len(case.modes)
    return len(histories) < whole or any(h.outcome == INTERRUPTED for h in histories)
