"""From histories of an earthquake study to one labelled dataset with its provenance."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.core.records import Floats, Rows, labels
from thermobearing.core.types import Books
from thermobearing.cyclic.dataset import depth_attributes
from thermobearing.cyclic.label import stack_labels
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.ends import labelled_ends
from thermobearing.earthquake.meanings import meaning_of
from thermobearing.earthquake.parts import label_parts
from thermobearing.earthquake.reached import warnings_of
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import INTERRUPTED
from thermobearing.model.outcomes import SENTENCES as RUN_SENTENCES
from thermobearing.results.largest_loop import largest_loop
from thermobearing.results.writing import as_attribute
from thermobearing.structure.matrices import (
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    mean_height,
    unit,
)
from thermobearing.structure.parts import hinge_of
from thermobearing.structure.run import SENTENCES, StructureHistory
from thermobearing.structure.types import Bend, MotionBooks

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

AIR = {"units": "degC", "long_name": "ambient temperature"}
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
LOOP = {  # of the largest loop: name in CycleMeasures, unit
    "loop_force_max": ("force_max_kN", "kN"),
    "loop_force_min": ("force_min_kN", "kN"),
    "loop_displacement_max": ("displacement_max_mm", "mm"),
    "loop_displacement_min": ("displacement_min_mm", "mm"),
    "loop_stiffness": ("stiffness_kN_mm", "kN/mm"),
    "loop_damping_ratio": ("h_eq", "1"),
    "loop_modulus": ("G_eq_MPa", "MPa"),
    "loop_energy": ("energy_kN_mm", "kN mm"),
}
ACROSS = {  # histories with one number per layer, body or cell: dimension, unit, long name
    "rubber_temperature": ("layer", "degC", "mid-thickness temperature of the rubber layers"),
    "body_acceleration": ("body", "m/s2", "absolute acceleration of the masses of each body"),
}
CELLS = ("cell", "degC", "temperature of the cells, the first at the upper face")
BEARING_ENERGIES = (
    "work_in",
    "heat_released",
    "recoverable",
    "heat_stored",
    "heat_lost_ends",
    "heat_lost_sides",
)


def label_study(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> EarthquakeResult:
    """The dataset of a study: peaks from every step, histories every `keep_every`-th."""
    tasks = tasks[: len(histories)]
    traces = [_traces(task, history) for task, history in zip(tasks, histories, strict=True)]
    every = case.analysis.keep_every
    length = max((len(trace["time"][::every]) for trace in traces), default=0)
    data: dict[str, Any] = {}
    slow = [CLOCK] if "pd" in case.modes else []
    for name, unit_name, long_name in (("time", "s", "time"), *HISTORIES, *slow):
        rows = _padded([trace[name][::every] for trace in traces], (length,))
        data[name] = (("run", "step"), rows, {"units": unit_name, "long_name": long_name})
    across = ACROSS | ({"temperature": CELLS} if "cells" in case.analysis.keep else {})
    for name, (dimension, unit_name, long_name) in across.items():
        parts = (
            [_bodies(task, history) for task, history in zip(tasks, histories, strict=True)]
            if name == "body_acceleration"
            else [trace[name][::every] for trace in traces]
        )
        wide = _padded(parts, (length, max((part.shape[1] for part in parts), default=0)))
        about = {"units": unit_name, "long_name": long_name}
        data[name] = (("run", "step", dimension), wide, about)
    if "temperature" in across:
        data |= _stacks(tasks, data["temperature"][1].shape[2])
    parts_data, parts_coords = label_parts(tasks, histories, _padded, length)
    data |= parts_data
    known = {name: long_name for name, _, long_name in HISTORIES}
    for name, values, unit_name in _scalars(tasks, histories, traces):
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


def _padded(parts: Sequence[Floats], shape: tuple[int, ...]) -> Any:
    """Tables of several runs in one, of that shape each, with NaN where a table ends."""
    whole = np.empty((len(parts), *shape), dtype=np.float32)
    for run, part in enumerate(parts):
        inside = tuple(slice(0, size) for size in part.shape)
        if part.shape != shape:
            whole[run] = np.nan
        whole[run][inside] = part
    return whole


def _traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Histories of one run, in the units of the dataset."""
    structure, report = task.case.structure, task.case.structure.report
    told, line, hinge = task.told.device, task.case.told_line, _hinge(task, history)
    rows, bearing = history.rows, history.bearing(line)
    q, a = rows.q, rows.a
    top = displacement_row(structure, report.pier, report.pier_top)
    base = displacement_row(structure, report.pier_base, report.pier_top)
    deck = unit(structure, f"{report.deck} x")
    moved = np.array([deck, top]) @ a.T / MM_PER_M  # relative to the ground
    ground = task.shaking.ground[: len(q)] / MM_PER_M
    thickness = told.bearing.total_rubber_thickness
    heat = told.stack is not None
    lead = heat and told.constants.lead.cores > 0.0
    missing = np.full(len(q), np.nan)
    return {
        "time": rows.books["clock"],
        "ground_acceleration": ground,
        "bearing_displacement": bearing["displacement"],
        "bearing_strain": bearing["displacement"] / thickness,
        "bearing_force": bearing["force"],
        "rubber_force": bearing["rubber_force"],
        "lead_force": bearing["lead_force"],
        "viscous_force": bearing["viscous_force"],
        "bearing_speed": _speed(bearing),
        "bearing_clock": bearing["clock"],
        "bearing_energy": bearing["work_in"],
        "pier_displacement": q @ (top - base),
        "pier_top_displacement": q @ top,
        "deck_displacement": q @ deck,
        "deck_acceleration": moved[0] + ground,
        "pier_top_acceleration": moved[1] + ground,
        "pier_rotation": missing if hinge is None else hinge["rotation"],
        "pier_moment": missing if hinge is None else hinge["moment"] / KN_MM_PER_KN_M,
        "lead_temperature": bearing["lead_temperature"] if lead else missing,
        "rubber_temperature": history.layers(line) if heat else np.empty((len(q), 0)),
        "temperature": history.cells(line) if heat else np.empty((len(q), 0)),
    }


def _hinge(task: "Task", history: StructureHistory) -> Rows[Bend] | None:
    """The hinge of the pier of the report, which may have none."""
    number = hinge_of(task.case.structure, task.case.structure.report.pier)
    return None if number is None else history.hinge(number)


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


def _speed(bearing: Rows[Books]) -> Floats:
    """Loading speed at the end of each step, on the clock of the modelled bearing [mm/s]."""
    steps = np.maximum(np.diff(bearing["clock"]), np.finfo(float).tiny)
    return np.concatenate([[0.0], np.diff(bearing["displacement"]) / steps])


def _scalars(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory], traces: list[dict[str, Floats]]
) -> list[tuple[str, Any, str]]:
    """One number per run: outcome, peaks over every step, energy books at the end."""

    def peak(name: str) -> Floats:
        return np.array([np.abs(trace[name]).max() for trace in traces])

    line = tasks[0].case.told_line if tasks else 0
    outcomes = np.array([history.outcome for history in histories], dtype=str)
    found: list[tuple[str, Any, str]] = [
        ("outcome", outcomes, ""),
        ("bearing_strain_max", peak("bearing_strain"), "1"),
        ("bearing_displacement_max", peak("bearing_displacement"), "mm"),
        ("bearing_force_max", peak("bearing_force"), "kN"),
        ("bearing_energy_end", np.array([t["bearing_energy"][-1] for t in traces]), "kN mm"),
        ("pier_displacement_max", peak("pier_displacement"), "mm"),
        ("pier_top_displacement_max", peak("pier_top_displacement"), "mm"),
        (
            "pier_displacement_residual",
            np.array([t["pier_displacement"][-1] for t in traces]),
            "mm",
        ),
        ("pier_rotation_max", peak("pier_rotation"), "rad"),
        ("pier_moment_max", peak("pier_moment"), "kN m"),
        ("deck_displacement_max", peak("deck_displacement"), "mm"),
        ("deck_acceleration_max", peak("deck_acceleration"), "m/s2"),
        ("pier_top_acceleration_max", peak("pier_top_acceleration"), "m/s2"),
        ("steps", np.array([history.steps for history in histories]), "1"),
        ("iterations", np.array([history.iterations for history in histories]), "1"),
        ("substeps", np.array([history.substeps for history in histories]), "1"),
    ]
    yields = np.array([_yield_rotation(task) for task in tasks])
    found.append(("pier_ductility", peak("pier_rotation") / yields, "1"))
    for label in labels(MotionBooks):
        if label.unit == "kN mm":
            ends = np.array([history.rows.books[label.name][-1] for history in histories])
            found.append((f"energy_{label.name}", ends, label.unit))
    for name in BEARING_ENERGIES:
        columns = [history.bearing(line)[name] for history in histories]
        values = np.array([column[-1] - column[0] for column in columns])
        found.append((f"heat_{name}", values, "kN mm"))
    mismatch = np.array([h.bearing(line)["layer_force_mismatch"].max() for h in histories])
    found.append(("layer_force_mismatch_max", mismatch, "kN"))
    return found + _loops(tasks, traces)


def _yield_rotation(task: "Task") -> float:
    """Of the hinge of the pier of the report [rad]; NaN without one."""
    structure = task.case.structure
    number = hinge_of(structure, structure.report.pier)
    return np.nan if number is None else structure.hinges[number].yield_rotation


def _loops(tasks: Sequence["Task"], traces: list[dict[str, Floats]]) -> list[tuple[str, Any, str]]:
    """Measures of the largest loop of one bearing, from every step; NaN where none is closed."""
    rows = []
    for task, trace in zip(tasks, traces, strict=True):
        bearing = task.told.device.bearing
        loop = largest_loop(
            trace["bearing_displacement"],
            trace["bearing_force"],
            trace["bearing_energy"],
            area=1.0 if isinstance(bearing, BilinearBearing) else bearing.area,
            total_rubber_thickness=bearing.total_rubber_thickness,
        )
        if loop is None:
            rows.append([np.nan] * (len(LOOP) + 2))
            continue
        measures = vars(loop.measures)
        if isinstance(bearing, BilinearBearing):  # it says no area
            measures = measures | {"G_eq_MPa": np.nan}
        values = [measures[name] for name, _ in LOOP.values()]
        rows.append([*values, *trace["time"][[loop.first, loop.last]]])
    columns = np.array(rows).reshape(len(rows), len(LOOP) + 2).T
    units = [*(item for _, item in LOOP.values()), "s", "s"]
    names = [*LOOP, "loop_start", "loop_end"]
    return list(zip(names, columns, units, strict=True))


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
