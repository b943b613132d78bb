"""The labelled dataset of an analysis of earthquakes."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.plausible import implausible
from thermobearing.border.toml import to_table
from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import Books
from thermobearing.cyclic.case import beyond, rig_demand
from thermobearing.cyclic.dataset import depth_attributes, stack_labels
from thermobearing.cyclic.reported import heat_flow
from thermobearing.earthquake.case import EarthquakeCase, in_weather
from thermobearing.earthquake.measures import (
    LOOP_UNITS,
    UNITS,
    compute_measures,
    describe_quantity,
    loop_measures,
)
from thermobearing.earthquake.parts import label_parts, largest
from thermobearing.earthquake.result import EarthquakeResult, run_name
from thermobearing.model.constants import outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.handover import (
    MEMORY,
    OF_LOOPS,
    PREFIX,
    SpecimenState,
    memory_attributes,
    memory_dimension,
    specimen_state,
    state_memory,
)
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import INTERRUPTED
from thermobearing.model.outcomes import SENTENCES as RUN_SENTENCES
from thermobearing.results.ranges import (
    Ends,
    Row,
    asked_of_tests,
    one_per_cause,
    outside_tests,
    reached_by,
)
from thermobearing.results.writing import as_attribute
from thermobearing.structure.matrices import (
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    mean_height,
)
from thermobearing.structure.result import implausible_structure
from thermobearing.structure.run import SENTENCES, StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

ENDS = {  # temperatures at the end
    "final_temperature": {"units": "degC", "long_name": "temperature of the cell at the end"},
    "final_lead_temperature": {"units": "degC", "long_name": "temperature of the lead at the end"},
}


def end_state_at(task: "Task", history: StructureHistory) -> SpecimenState:
    """Where the bearing of the first line is at the end of a run; not a bilinear one.

    Parameters
    ----------
    task, history : a run, and what came of it.

    Returns
    -------
    SpecimenState
    """
    end, cored = history.end(), task.device.constants.lead.cores > 0.0
    lead = end.books[0].lead_temperature if cored else float("nan")
    return specimen_state(end.temperature, lead, state_memory(end))


def _labelled_ends(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> dict[str, Any]:
    """The ends of all runs for a dataset, as in those of cyclic tests, filled up with NaN.

    Nothing where the structure has several bearing lines, which end each elsewhere.
    """
    warm = [task.device.stack is not None for task in tasks]
    if not any(warm) or len(tasks[0].case.structure.bearings) > 1:
        return {}
    ends: list[dict[str, Any]] = []
    for task, history, has_heat in zip(tasks, histories, warm, strict=True):
        end, cored = history.end(), task.device.constants.lead.cores > 0.0
        lead = end.books[0].lead_temperature if cored else np.nan
        found = {"final_temperature": end.temperature, "final_lead_temperature": lead}
        ends.append(found | state_memory(end) if has_heat else {})
    dims = {"final_temperature": "cell", "final_lead_temperature": None}
    memory = [*MEMORY, *(key for key in OF_LOOPS if any(key in end for end in ends))]
    dims |= {key: memory_dimension(key) for key in memory}
    data: dict[str, Any] = {}
    for key, dimension in dims.items():
        parts = [np.atleast_1d(end.get(key, np.nan)) for end in ends]
        whole = np.full((len(parts), max(len(part) for part in parts)), np.nan)
        for row, part in zip(whole, parts, strict=True):
            row[: len(part)] = part
        name, about = (PREFIX + key, memory_attributes(key)) if key in memory else (key, ENDS[key])
        if dimension is None:
            data[name] = (("run",), whole[:, 0], about)
        elif whole.size:
            data[name] = (("run", dimension), whole, about)
    return data


MM_PER_M, KN_MM_PER_KN_M = 1e3, 1e3
HISTORIES = (  # name, unit, long name
    ("ground_acceleration", "m/s2", "acceleration of the ground"),
    ("bearing_displacement", "mm", "displacement of the bearing"),
    ("bearing_strain", "1", "shear strain of the bearing"),
    ("bearing_force", "kN", "force of one bearing"),
    ("rubber_force", "kN", "share of the rubber in the force of one bearing"),
    ("lead_force", "kN", "share of the lead cores"),
    ("viscous_force", "kN", "share of the rate-dependent branch"),
    ("bearing_speed", "mm/s", "loading speed of the bearing, on its own clock"),
    ("bearing_energy", "kN mm", "work done on one bearing"),
    ("pier_displacement", "mm", "displacement of the pier top relative to its base"),
    ("pier_top_displacement", "mm", "displacement of the pier top relative to the ground"),
    ("deck_displacement", "mm", "displacement of the deck relative to the ground"),
    ("deck_acceleration", "m/s2", "absolute acceleration of the deck"),
    ("pier_top_acceleration", "m/s2", "absolute acceleration of the pier top"),
    ("pier_rotation", "rad", "rotation of the first hinge"),
    ("pier_moment", "kN m", "moment of the first hinge"),
    ("lead_temperature", "degC", "temperature of the lead cores"),
)
CLOCK = (
    "bearing_clock",
    "s",
    "time of the bearing: in a pseudo-dynamic test that of the laboratory",
)


def structure_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Those of `HISTORIES` that the structure has: ground, pier, deck."""
    where = task.prepared.reported
    hinge = None if where.hinge is None else history.hinge(where.hinge)
    q, a = history.rows.q, history.rows.a
    moved = np.array([where.deck, where.top]) @ a.T / MM_PER_M  # relative to the ground
    ground = task.shaking.ground[: len(q)] / MM_PER_M
    missing = np.full(len(q) if hinge is None else 0, np.nan)
    return {
        "ground_acceleration": ground,
        "pier_displacement": q @ (where.top - where.base),
        "pier_top_displacement": q @ where.top,
        "deck_displacement": q @ where.deck,
        "deck_acceleration": moved[0] + ground,
        "pier_top_acceleration": moved[1] + ground,
        "pier_rotation": missing if hinge is None else hinge["rotation"],
        "pier_moment": missing if hinge is None else hinge["moment"] / KN_MM_PER_KN_M,
    }


def history_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Each of `HISTORIES` by name, and temperatures of layers and of cells that are kept."""
    told, bearing = task.told.device, history.bearing(task.told_line)
    heat, count = told.heats, len(history.rows.q)
    return structure_traces(task, history) | {
        "time": history.rows.books["clock"],
        "bearing_displacement": bearing["displacement"],
        "bearing_strain": bearing["displacement"] / told.bearing.total_rubber_thickness,
        "bearing_force": bearing["force"],
        "rubber_force": bearing["rubber_force"],
        "lead_force": bearing["lead_force"],
        "viscous_force": bearing["viscous_force"],
        "bearing_speed": _loading_speed(bearing),
        "bearing_clock": bearing["clock"],
        "bearing_energy": bearing["work_in"],
        "lead_temperature": bearing["lead_temperature"]
        if told.has_lead
        else np.full(count, np.nan),
        "rubber_temperature": history.layers(task.told_line) if heat else np.empty((count, 0)),
        "temperature": history.cells(task.told_line) if heat else np.empty((count, 0)),
    }


def _loading_speed(bearing: Rows[Books]) -> Floats:
    """Loading speed at the end of each step, on the clock of the modelled bearing [mm/s]."""
    steps = np.maximum(np.diff(bearing["clock"]), np.finfo(float).tiny)
    return np.concatenate([[0.0], np.diff(bearing["displacement"]) / steps])


def padded(parts: Sequence[Floats], shape: tuple[int, ...]) -> Any:
    """Tables of several runs in one, of that shape each, with NaN where a table ends."""
    whole = np.empty((len(parts), *shape), dtype=np.float32)
    for run, part in enumerate(parts):
        inside = tuple(slice(0, size) for size in part.shape)
        if part.shape != shape:
            whole[run] = np.nan
        whole[run][inside] = part
    return whole


Traces = Sequence[Mapping[str, Floats]]


def collect_warnings(
    case: EarthquakeCase,
    tasks: Sequence["Task"],
    histories: Sequence[StructureHistory],
    traces: Traces,
) -> dict[str, Any]:
    """Attributes of the dataset: sentences, what was asked of the rig and of the bearings."""
    rig = _asked_of_rig(case, tasks, traces)
    found, asked = beyond(case.rig, rig), []
    if tasks:
        found += implausible_structure(case.structure, tasks[0].prepared)
    told: list[tuple[str, str]] = []
    for bearing, mine in _bearings(tasks).values():
        said = [f"{bearing.name}: {text}" for text in implausible(bearing)]
        ranges = calibration_ranges(bearing)
        rows: list[Row] = []
        for k, lines in mine:
            name = _name(tasks[k], bearing.name)
            rows += asked_of_tests(name, reached(tasks[k], histories[k], lines), ranges)
        said += outside_tests(bearing.name, rows, ranges, skip=("strain_rate",))
        asked += rows
        if not isinstance(bearing, BilinearBearing) and case.analysis.model not in BLIND:
            runs = [
                (_name(tasks[k]), traces[k]["time"], histories[k].layers(line))
                for k, lines in mine
                for line in lines
            ]
            said += outside_law(bearing.name, bearing.temperature_law, runs)
        told += [(bearing.name, text.removeprefix(f"{bearing.name}: ")) for text in said]
    found += one_per_cause(told)
    standing = [one.device.bearing for task in tasks for one in task.lines]
    factors = exposures(standing, case.analysis.exposure)
    found = describe_all(factors) + found
    row_tables = {"rig": rig, "tested_range": asked, **exposure_attribute(factors)}
    attributes = {name: as_attribute(rows) for name, rows in row_tables.items() if rows}
    return {"warnings": as_attribute(found)} | attributes


def _bearings(
    tasks: Sequence["Task"],
) -> dict[str, tuple[Bearing | BilinearBearing, list[tuple[int, list[int]]]]]:
    """Every bearing by name, and in which runs it stands on which lines."""
    found: dict[str, tuple[Bearing | BilinearBearing, list[tuple[int, list[int]]]]] = {}
    for k, task in enumerate(tasks):
        lines: dict[str, list[int]] = {}
        for line, one in enumerate(task.lines):
            lines.setdefault(one.device.bearing.name, []).append(line)
            found.setdefault(one.device.bearing.name, (one.device.bearing, []))
        for name, mine in lines.items():
            found[name][1].append((k, mine))
    return found


def reached(
    task: "Task", history: StructureHistory, lines: Sequence[int]
) -> dict[str, float | Ends]:
    """What a run asks of the bearings of some lines, each by the line that goes farthest."""
    found: dict[str, float | Ends] = {}
    for line in lines:
        rows, mine = history.bearing(line), task.lines[line]
        one = reached_by(
            rows["clock"],
            rows["displacement"],
            largest(_loading_speed(rows)),
            rubber=mine.device.bearing.total_rubber_thickness,
            ambient=(mine.ambient, mine.ambient),
            lead=rows["lead_temperature"] if mine.device.has_lead else None,
        )
        found = {name: _farther(found.get(name, value), value) for name, value in one.items()}
    return found


def _farther(one: float | Ends, other: float | Ends) -> float | Ends:
    """What holds both."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return min(one[0], other[0]), max(one[1], other[1])
    return one if isinstance(one, tuple) or isinstance(other, tuple) else max(one, other)


def _name(task: "Task", bearing: str = "") -> str:
    """What a run is called, with or without a bearing."""
    return run_name(bearing, task.shaking.motion.name, task.ambient, task.mode)


def _asked_of_rig(case: EarthquakeCase, tasks: Sequence["Task"], traces: Traces) -> list[Row]:
    """What each run asks of the rig, the speed on the clock of the specimen."""
    found = []
    names = ("bearing_force", "bearing_displacement", "bearing_speed")
    for task, trace in zip(tasks, traces, strict=True):
        peaks = [float(np.abs(trace[name]).max()) for name in names]
        found += rig_demand(case.rig, _name(task, task.told.device.bearing.name), peaks)
    return found


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
    traces = [history_traces(task, history) for task, history in zip(tasks, histories, strict=True)]
    numbers = [
        compute_measures(task, history, trace) | loop_measures(task, trace)
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
        data[name] = (
            ("run",),
            values,
            {"units": unit_name, "long_name": describe_quantity(name, known)},
        )
    data |= _labelled_ends(tasks, histories)
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
        attrs=_attributes(case, tasks, histories)
        | collect_warnings(case, tasks, histories, traces),
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
