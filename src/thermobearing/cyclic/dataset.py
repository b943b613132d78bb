"""The labelled dataset of a test, its thinned histories and their size.

Dimensions: `ambient` (one per run), `time` (kept steps), `layer` (1 is the outermost rubber
layer), `cell` (1 is at the upper face). Runs whose rests end at different times have
different clocks: `clock(ambient, time)` then replaces the coordinate `time`. Shorter runs
are padded with NaN.

A step of 5 ms makes thousands of rows a cycle, and a tall bearing a hundred numbers a row. What is
computed from a history (measures, books, figures) is computed before, from all of its rows; what
is kept keeps its bits.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import thermobearing
from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import calibration_ranges
from thermobearing.core.records import labels
from thermobearing.core.types import Books, RubberBooks
from thermobearing.cyclic.case import Case, beyond, rig_demand
from thermobearing.cyclic.history import History, Segment, has_branches, longest_layer_increment
from thermobearing.cyclic.protocol import Cycles, survey
from thermobearing.cyclic.result import CYCLES, Ints, Result, find_unit, run_name
from thermobearing.model.constants import outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.handover import PREFIX, memory_attributes, memory_dimension, state_memory
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import SENTENCES, SHARING_SENTENCES
from thermobearing.results.metrics import find_cycles
from thermobearing.results.ranges import Row, asked_of_tests, outside_tests, reached_by
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


def _build_dataset(
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
    clock = _stacked([run.books["clock"] for run in runs], length)
    same = all(np.array_equal(clock[0], other) for other in clock)
    data: dict[str, Any] = {}
    meanings = {name: {"units": unit, "long_name": text} for name, unit, text in labels.books}
    for name, attrs in meanings.items():
        if name != "clock" or not same:
            values = _stacked([run.books[name] for run in runs], length)
            data[name] = (("ambient", "time"), values, attrs)
    data |= _derived(data, area, total_rubber_thickness)
    for group in (name for name in GROUPS if name in groups):
        name, dimension, unit, meaning = GROUPS[group]
        parts = [run.groups[group] for run in runs]
        attrs = {"units": unit, "long_name": meaning}
        data[name] = (("ambient", "time", dimension), _stacked(parts, length), attrs)
    data |= _per_run(runs, length) | _memories(runs)
    coordinates = _coordinates(runs, labels, bool(attributes.get("half_stack")))
    if same:
        coordinates["time"] = ("time", clock[0], meanings["clock"])
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


def _memories(runs: list[RunRecord]) -> dict[str, Any]:
    """The state at the end of each run, from which another test can go on; no empty variables."""
    found = {}
    for key in runs[0].memory:
        values = np.array([run.memory[key] for run in runs])
        dimension = memory_dimension(key)
        dims = ("ambient",) if dimension is None else ("ambient", dimension)
        if values.size:
            found[PREFIX + key] = (dims, values, memory_attributes(key))
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


def collect_warnings(case: Case, segments: list[Segment], climates: list[Ambient]) -> list[str]:
    """What a user should know about a result, in sentences."""
    found = list(dict.fromkeys(text for segment in segments for text in segment.assumed))
    if case.ambient_series is None and any(len(climate.time) > 1 for climate in climates):
        found.append(
            "the ambient series was given in Python: case.resolved.toml has its first value only; "
            "give it as a CSV file (ambient_series) to be able to run the case again"
        )
    if case.initial_state is not None and not case.initial_state.whole:
        found.append(
            "the earlier result hands over temperatures only (it was written before results held "
            "the whole state): rubber and lead begin unloaded and virgin, at zero displacement"
        )
    layers = case.bearing.geometry.rubber_layers
    increment = longest_layer_increment(segments, layers, case.starts_at)
    yielding = case.bearing.hysteresis.yield_displacement
    if increment > yielding:
        found.append(
            f"a step moves each rubber layer by up to {increment:.3g} mm, more than its yield "
            f"displacement of {yielding:g} mm: work and heat of such steps are coarse; use a "
            "smaller dt"
        )
    return found


def extrapolated(case: Case, climates: list[Ambient], histories: list[History]) -> list[str]:
    """Whether rubber left the range of its temperature law, where the model has one."""
    if case.analysis.model in BLIND:
        return []
    runs = [
        (f"{climate.at(0.0):g} degC", history.rows.books["clock"], np.asarray(history.rows.rubber))
        for climate, history in zip(climates, histories, strict=False)
    ]
    return outside_law(case.bearing.name, case.bearing.temperature_law, runs)


def stack_labels(model: BearingModel) -> StackLabels:
    """What the layers and cells of a run are; a single cell stands for the whole bearing."""
    stack, constants = model.stack, model.constants
    layers = len(constants.multiplicity)
    books = labels(Books if has_branches(constants) else RubberBooks)
    if len(constants.cells.capacity) == len(stack.part):
        return StackLabels(stack.depth, stack.thickness, stack.part, layers, books)
    height = stack.thickness.sum()
    return StackLabels(
        np.array([0.5 * height]), np.array([height]), ("whole bearing",), layers, books
    )


def asked(
    case: Case, segments: list[Segment], climates: list[Ambient], histories: list[History]
) -> dict[str, list[Row]]:
    """What each run asks of the rig and of the tests behind the bearing, where they are given.

    The speed is that of the whole test.
    """
    x = np.concatenate([[case.starts_at], *(segment.x for segment in segments)])
    dt = np.concatenate([segment.dt for segment in segments])
    speed = float((np.abs(np.diff(x)) / dt).max())
    rig: list[Row] = []
    tested: list[Row] = []
    for climate, history in zip(climates, histories, strict=False):
        books, name = history.rows.books, run_name(climate.at(0.0))
        peaks = [float(np.abs(books[one]).max()) for one in ("force", "displacement")]
        rig += rig_demand(case.rig, name, [*peaks, speed])
        reached = reached_by(
            books["clock"],
            books["displacement"],
            speed,
            rubber=case.bearing.total_rubber_thickness,
            ambient=(float(climate.temperature.min()), float(climate.temperature.max())),
            lead=books["lead_temperature"] if case.bearing.lead else None,
        )
        tested += asked_of_tests(name, reached, calibration_ranges(case.bearing))
    return {"rig": rig, "tested_range": tested}


def _run_record(case: Case, climate: Ambient, history: History, what: StackLabels) -> RunRecord:
    """What one run left behind, as plain arrays."""
    return RunRecord(
        ambient=climate.at(0.0),
        books={name: history.rows.books[name] for name, _, _ in what.books},
        groups=history.rows._asdict(),
        segment=history.segment,
        cycle=history.cycle,
        initial=history.initial,
        final=history.state.temperature,
        final_lead=history.state.books[0].lead_temperature if case.bearing.lead else np.nan,
        memory=state_memory(history.state),
        outcome=history.outcome,
        softened_steps=history.softened_steps,
        mismatch=history.mismatch,
        steps=history.steps,
    )


def label(
    case: Case,
    model: BearingModel,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> Result:
    """What the runs left behind; names, units and provenance when they are first asked for."""
    return Result(partial(labelled, case, model, segments, climates, histories))


def labelled(
    case: Case,
    model: BearingModel,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> xr.Dataset:
    """Names, units and provenance for what the runs left behind."""
    what = stack_labels(model)
    records = [
        _run_record(case, climate, history, what)
        for climate, history in zip(climates, histories, strict=False)
    ]
    rows = asked(case, segments, climates, histories)
    constants, options = model.constants, model.options
    factors = exposures([case.bearing], case.analysis.exposure)
    lead_capacity = constants.lead.cores * constants.lead.capacity
    attributes = {
        "title": f"{case.bearing.name}, {case.test.name}",
        "command": "cyclic",
        "bearing": case.bearing.name,
        "model": options.model,
        "scheme": options.scheme,
        "integrator": options.integrator,
        "heat_source": options.heat_source,
        "lead_capacity_kN_mm_per_K": lead_capacity if case.bearing.lead else 0.0,
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "citation": case.bearing.citation,
        "area_mm2": case.bearing.area,
        "total_rubber_thickness_mm": case.bearing.total_rubber_thickness,
        "heat_capacity_kN_mm_per_K": constants.cells.capacity.tolist(),
        "histories": case.analysis.histories,  # of files
        "half_stack": int(model.stack.fold == 2),
        "segments": [
            {"kind": s.kind, "label": s.label, "amplitude_strain": s.amplitude_strain}
            for s in segments
        ],
        "warnings": describe_all(factors)
        + collect_warnings(case, segments, climates)
        + extrapolated(case, climates, histories)
        + beyond(case.rig, rows["rig"])
        + outside_tests(case.bearing.name, rows["tested_range"], calibration_ranges(case.bearing)),
        **{name: found for name, found in rows.items() if found},
        **exposure_attribute(factors),
        "sentences": SENTENCES | SHARING_SENTENCES,
    }
    return _build_dataset(
        records,
        what,
        case.analysis.keep,
        area=case.bearing.area,
        total_rubber_thickness=case.bearing.total_rubber_thickness,
        attributes=attributes,
    )


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
    return Result(_with_cycles(data, result).assign_attrs({ROWS: THINNED}))


def _with_cycles(data: xr.Dataset, result: Result) -> xr.Dataset:
    """The dataset with the columns of `Result.cycles` as variables, one number a closed cycle."""
    cycles = result.cycles
    return data.assign(
        {
            f"{CYCLES}_{name}": (CYCLES, cycles[name].to_numpy(), {"units": find_unit(str(name))})
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
            found[name] = (values.dims, _stacked(parts, length, padding), values.attrs)
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


DOUBLE, SINGLE = 8, 4  # [bytes] of a number in result.nc; those of cells are single
TEXT = 11  # [bytes] of a number in history.csv, with its comma
CSV_COLUMNS = 7  # besides the layers
COUNTERS = 8  # [bytes] of the numbers of segment and cycle


def list_rows(case: Case) -> float:
    """Rows of a history that are written of one run, at most."""
    _, steps = survey(case.test, case.bearing.total_rubber_thickness, case.starts_at)
    steps = 1.0 + steps / case.analysis.keep_every
    if case.analysis.histories == COMPLETE or any(s.step == "recorded" for s in case.test.steps):
        return steps
    parts = sum(step.count + 1 if isinstance(step, Cycles) else 1 for step in case.test.steps)
    return min(steps, parts * (POINTS + 4.0))


def expected_size(case: Case) -> float:
    """Bytes of result.nc without compression, and of history.csv, at most.

    Parameters
    ----------
    case : a complete case.

    Examples
    --------
    >>> from thermobearing.cyclic.case import make_case
    >>> short = expected_size(make_case({}, "example"))
    >>> short < 0.5 * expected_size(make_case({}, "example", histories="complete"))
    True
    """
    keep = case.analysis.keep
    stack = case.analysis.build_stack(case.bearing)
    layers = sum(part == "rubber" for part in stack.part) // max(case.bearing.cells.rubber, 1)
    layers = max(layers, 1)
    wide = sum(layers for name in keep if name != "cells")
    row = DOUBLE * (len(labels(Books)) + 2 + wide) + COUNTERS
    row += SINGLE * len(stack.part) if "cells" in keep else 0
    row += TEXT * (CSV_COLUMNS + (layers if "rubber" in keep else 0))
    return float(row) * list_rows(case) * len(case.ambient)
