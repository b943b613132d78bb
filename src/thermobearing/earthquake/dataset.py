"""The labelled dataset of an analysis of earthquakes."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.plausible import implausible
from thermobearing.border.toml import to_table
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import beyond, rig_demand
from thermobearing.cyclic.dataset import depth_attributes, stack_labels
from thermobearing.cyclic.protocol import lengths
from thermobearing.cyclic.reported import heat_flow
from thermobearing.cyclic.result import COMPONENT
from thermobearing.earthquake import measures
from thermobearing.earthquake.case import EarthquakeCase, in_weather
from thermobearing.earthquake.measures import DIRECTION
from thermobearing.earthquake.motions import pair_notes
from thermobearing.earthquake.result import PART_HISTORIES, EarthquakeResult, run_name
from thermobearing.model import handover
from thermobearing.model.checks import (
    check_rows,
    failed_checks,
    lead_check_rows,
    vertical_checks,
)
from thermobearing.model.constants import outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.element import BearingElement
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import ALL_SENTENCES, INTERRUPTED, MELTED
from thermobearing.quantities.register import quantity
from thermobearing.results.base import COMPLETED
from thermobearing.results.ranges import (
    Ends,
    Row,
    compare_with_tests,
    one_per_cause,
    outside_tests,
    reached_by,
)
from thermobearing.results.sums import product_in_order
from thermobearing.results.writing import as_attribute, labelled_dataset
from thermobearing.structure.matrices import (
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    mean_height,
)
from thermobearing.structure.model import list_piers
from thermobearing.structure.result import implausible_structure
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.run import Task


def end_state_at(task: "Task", history: StructureHistory) -> handover.SpecimenState:
    """Return the state of the bearing of the first line at the end of a run; not a bilinear one."""
    end = history.end()
    lead, memory = _last_lead(task, end), handover.state_memory(end)
    return handover.specimen_state(end.temperature, lead, memory)


def _last_lead(task: "Task", end: Any) -> float:
    cored = task.device.constants.lead.cores > 0.0
    return float(end.books[0].lead_temperature) if cored else np.nan


def _labelled_ends(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> dict[str, Any]:
    """Return the states at the end of all runs as variables; nothing of several bearing lines."""
    warm = [task.device.stack is not None for task in tasks]
    if not any(warm) or len(case.structure.bearings) > 1:
        return {}
    ends: list[dict[str, Any]] = []
    for task, history, has_heat in zip(tasks, histories, warm, strict=True):
        end = history.end()
        found: dict[str, Any] = {"final_temperature": end.temperature}
        found["final_lead_temperature"] = _last_lead(task, end)
        ends.append(found | handover.state_memory(end) if has_heat else {})
    dims = {"final_temperature": "cell", "final_lead_temperature": None}
    loops = [key for key in handover.OF_LOOPS if any(key in end for end in ends)]
    memory = [*handover.MEMORY, *loops]
    dims |= {key: handover.DIMENSIONS.get(key) for key in memory}
    data: dict[str, Any] = {}
    for key, dimension in dims.items():
        wide = [COMPONENT] * (case.components > 1 and key in handover.ACROSS)
        axes = [*([] if dimension is None else [dimension]), *wide]
        parts = [np.asarray(end.get(key, np.full([0] * len(axes), np.nan))) for end in ends]
        stacked = padded(parts, tuple(np.max([part.shape for part in parts], axis=0)), float)
        name = handover.PREFIX + key if key in memory else key
        if stacked.size:
            data[name] = (["run", *axes], stacked, quantity(name).attributes)
    return data


def padded(parts: Sequence[Floats], shape: tuple[int, ...], dtype: Any = np.float32) -> Any:
    """Return tables of several runs as one, of that shape each, with NaN where a table ends."""
    stacked = np.empty((len(parts), *shape), dtype=dtype)
    for run, part in enumerate(parts):
        if part.shape != shape:
            stacked[run] = np.nan
        place: tuple[int | slice, ...] = (run, *(slice(0, size) for size in part.shape))
        stacked[place] = part
    return stacked


def _wider(parts: Sequence[Floats], first: int) -> tuple[int, ...]:
    """Return the sizes of the axes of tables from `first` on; none without a table."""
    return parts[0].shape[first:] if parts else ()


Traces = Sequence[Mapping[str, Floats]]
CELLS = {"units": "degC", "long_name": "temperature of the cells, the first at the upper face"}


def _collect_warnings(
    case: EarthquakeCase,
    tasks: Sequence["Task"],
    histories: Sequence[StructureHistory],
    traces: Traces,
) -> dict[str, Any]:
    """Return warnings, and how far runs use the rig and the tested ranges, as attributes."""
    rig = _rig_rows(case, tasks, traces)
    found, compared = beyond(case.rig, rig), []
    if tasks:
        found += implausible_structure(case.structure, tasks[0].prepared)
    motions = [motion.model_dump(exclude_none=True) for motion in case.motions]
    found += pair_notes(motions, plan=bool(case.structure.plan))
    causes: list[tuple[str, str]] = []
    of_lead: list[Row] = []
    for bearing, mine in _bearings(tasks).values():
        said = [f"{bearing.name}: {text}" for text in implausible(bearing)]
        ranges = calibration_ranges(bearing)
        rows: list[Row] = []
        for k, lines in mine.items():
            name = _name(tasks[k], bearing.name)
            reached = _reached(tasks[k], histories[k], lines)
            rows += compare_with_tests(name, reached, ranges)
            of_lead += _lead_rows(name, bearing.name, reached, histories[k])
        said += outside_tests(bearing.name, rows, ranges, skip=("strain_rate",))
        compared += rows
        if not isinstance(bearing, BilinearBearing) and case.analysis.model not in BLIND:
            runs = [
                (_name(tasks[k]), traces[k]["time"], histories[k].layers(line))
                for k, lines in mine.items()
                for line in lines
            ]
            said += outside_law(bearing.name, bearing.temperature_law, runs)
        causes += [(bearing.name, text.removeprefix(f"{bearing.name}: ")) for text in said]
    found += one_per_cause(causes)
    installed = [one.device.bearing for task in tasks for one in task.lines]
    factors = exposures(installed, case.analysis.exposure)
    found = describe_all(factors) + found + [one.note for one in histories if one.note]
    checks = _vertical_checks(case, tasks, histories)
    found += failed_checks(of_lead + checks)
    early = [one.outcome for one in histories if one.outcome != COMPLETED]
    if checks and early:
        found.append(
            f"checks under the axial force: {len(early)} of {len(histories)} runs ended as "
            f"{', '.join(dict.fromkeys(early))}; their rows cover the time before the end"
        )
    for item in case.lines if len(case.ambient) > 1 else ():
        if item.ambient is not None or item.weather is not None:
            air = "in its own weather" if item.ambient is None else f"at {item.ambient:g} degC"
            found.append(
                f"line {item.line} stays {air} in all runs, so that comparisons of ambient "
                "temperatures do not apply to it"
            )
    row_tables = {"rig": rig, "tested_range": compared, "bearing_checks": of_lead + checks}
    row_tables |= exposure_attribute(factors)
    attributes = {name: as_attribute(rows) for name, rows in row_tables.items() if rows}
    return {"warnings": as_attribute(found)} | attributes


def _lead_rows(
    run: str, bearing: str, reached: Mapping[str, float | Ends], history: StructureHistory
) -> list[Row]:
    """Return the checks of the lead of a bearing in a run; none without lead."""
    if "lead_temperature" not in reached:
        return []
    hottest, melted = float(np.max(reached["lead_temperature"])), history.outcome == MELTED
    return lead_check_rows(run, bearing, hottest, melted=melted)


def _bearings(
    tasks: Sequence["Task"],
) -> dict[str, tuple[Bearing | BilinearBearing, dict[int, list[int]]]]:
    """Return every bearing by name, with its runs and the lines that it is on in them."""
    found: dict[str, tuple[Bearing | BilinearBearing, dict[int, list[int]]]] = {}
    for k, task in enumerate(tasks):
        for line, one in enumerate(task.lines):
            mine = found.setdefault(one.device.bearing.name, (one.device.bearing, {}))[1]
            mine.setdefault(k, []).append(line)
    return found


def _reached(
    task: "Task", history: StructureHistory, lines: Sequence[int]
) -> dict[str, float | Ends]:
    """Return how far a run goes in the tested range, the farthest of some lines."""
    found: dict[str, float | Ends] = {}
    for line in lines:
        rows, mine = history.bearing(line), task.lines[line]
        moved, speed = rows["displacement"], lengths(measures.loading_speed(rows))
        if moved.ndim > 1:  # the strain is that of the resultant
            moved = np.copysign(lengths(moved), moved[:, 0])
        one = reached_by(
            rows["clock"],
            moved,
            measures.largest(speed),
            rubber=mine.device.bearing.total_rubber_thickness,
            ambient=(mine.ambient, mine.ambient),
            lead=rows["lead_temperature"] if mine.device.has_lead else None,
        )
        found = {name: _farther(found.get(name, value), value) for name, value in one.items()}
    return found


def _farther(one: float | Ends, other: float | Ends) -> float | Ends:
    if isinstance(one, tuple) and isinstance(other, tuple):
        return min(one[0], other[0]), max(one[1], other[1])
    return one if isinstance(one, tuple) or isinstance(other, tuple) else max(one, other)


def _name(task: "Task", bearing: str = "") -> str:
    labels = task.shaking.motion.name, task.ambient, task.mode, task.direction
    return run_name(bearing, *labels)


def _rig_rows(case: EarthquakeCase, tasks: Sequence["Task"], traces: Traces) -> list[Row]:
    """Return how far each run uses the rig, with the speed on the clock of the specimen."""
    found = []
    names = ("bearing_force", "bearing_displacement", "bearing_speed")
    for task, trace in zip(tasks, traces, strict=True):
        peaks = [float(np.abs(trace[name]).max()) for name in names]
        found += rig_demand(case.rig, _name(task, task.reported.device.bearing.name), peaks)
    return found


def _vertical_checks(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Row]:
    """Return the checks of the bearings of every line that has an axial force, in every run."""
    forces, names = case.axial_forces(), [line.name for line in case.structure.bearings]
    found: list[Row] = []
    for task, history in zip(tasks, histories, strict=True) if forces else ():
        for k, (name, one) in enumerate(zip(names, task.lines, strict=True)):
            bearing = one.device.bearing
            if name in forces:
                layered = bearing if isinstance(bearing, Bearing) else None
                moved = history.bearing(k)["displacement"]
                if task.direction == "y":  # across the length of the plan
                    moved = np.column_stack([np.zeros_like(moved), moved])
                load = forces[name], moved, one.ambient, name if len(names) > 1 else ""
                checks = vertical_checks(layered, *load)
                found += check_rows(_name(task, bearing.name), bearing.name, checks)
    return found


Runs = Sequence[tuple["Task", StructureHistory]]


def _label_histories(
    case: EarthquakeCase, runs: Runs, traces: Traces, length: int
) -> dict[str, Any]:
    """Return the histories of all runs as variables: scalars, layers, bodies, cells."""
    every = case.analysis.keep_every
    slow = ["bearing_clock"] if "pd" in case.modes else []
    data: dict[str, Any] = {}
    for name in ("time", *measures.HISTORIES, *slow):
        parts = [trace[name][::every] for trace in traces]
        values = padded(parts, (length, *_wider(parts, 1)))
        data[name] = (("run", "step", DIRECTION)[: values.ndim], values, quantity(name).attributes)
    across = {  # histories with one number per layer, body or cell
        "rubber_temperature": ("layer", [trace["rubber_temperature"][::every] for trace in traces]),
        "body_acceleration": ("body", [_bodies(task, history) for task, history in runs]),
    }
    if "cells" in case.analysis.keep:
        across["temperature"] = "cell", [trace["temperature"][::every] for trace in traces]
    for name, (dimension, parts) in across.items():
        most = max((part.shape[1] for part in parts), default=0)
        wide = padded(parts, (length, most, *_wider(parts, 2)))
        about = CELLS if name == "temperature" else quantity(name).attributes
        data[name] = (("run", "step", dimension, DIRECTION)[: wide.ndim], wide, about)
    if "temperature" in across:
        data |= _stacks([task for task, _ in runs], data["temperature"][1].shape[2])
    return data


def label_analysis(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> EarthquakeResult:
    """Return the result of an analysis: peaks from every step, histories every `keep_every`-th."""
    planned, tasks = len(tasks), tasks[: len(histories)]
    runs = list(zip(tasks, histories, strict=True))
    traces = [measures.history_traces(task, history) for task, history in runs]
    numbers = [
        measures.compute_measures(task, history, trace) | measures.loop_measures(task, trace)
        for (task, history), trace in zip(runs, traces, strict=True)
    ]
    length = max((len(trace["time"][:: case.analysis.keep_every]) for trace in traces), default=0)
    data = _label_histories(case, runs, traces, length)
    parts_data, parts_coords = _label_parts(tasks, histories, length)
    data |= parts_data
    ended = np.array([row["outcome"] for row in numbers], dtype=str)
    data["outcome"] = ("run",), ended, quantity("outcome").attributes | {"units": ""}
    lab = ["actuator_kN_mm"] if case.laboratory is not None else []
    for known in map(quantity, (*measures.NUMBERS, *lab, *measures.LOOP, *measures.LOOP_TIMES)):
        values = np.array([row[known.variable] for row in numbers])
        data[known.variable] = (("run", DIRECTION)[: values.ndim], values, known.attributes)
    data |= _labelled_ends(case, tasks, histories)
    ambient = np.array([task.ambient for task in tasks])
    names = [(task.device.bearing.name, task.shaking.motion.name, task.mode) for task in tasks]
    bearings, motions, modes = np.array(names, dtype=str).reshape(-1, 3).T
    dataset = labelled_dataset(
        data,
        coords={
            "bearing": ("run", bearings),
            "motion": ("run", motions),
            "ambient": ("run", ambient, quantity("ambient_degC").attributes),
            "mode": ("run", modes),
            **_label_directions(case, tasks),
            "layer": np.arange(1, data["rubber_temperature"][1].shape[2] + 1),
            "body": np.array([body.name for body in case.structure.bodies if tasks], dtype=str),
            **parts_coords,
        },
        attrs=_attributes(case, tasks, _interrupted(planned, histories))
        | _collect_warnings(case, tasks, histories, traces),
    )
    return EarthquakeResult(dataset)


def _label_directions(case: EarthquakeCase, tasks: Sequence["Task"]) -> dict[str, Any]:
    """Return the coordinate of directions: of the runs of one direction each, or of vectors."""
    if not case.structure.plan:
        return {}
    if case.components == 1:
        return {DIRECTION: ("run", np.array([task.direction for task in tasks], dtype=str))}
    return {DIRECTION: np.array(measures.DIRECTIONS, dtype=str)}


def _label_parts(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory], length: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return variables and coordinates of lines and piers; none where there is one of each."""
    if not tasks:
        return {}, {}
    case, runs = tasks[0].case, list(zip(tasks, histories, strict=True))
    lines, piers = case.structure.bearings, list_piers(case.structure)
    if len(lines) == 1 and len(piers) == 1:
        return {}, {}
    every = case.analysis.keep_every
    data: dict[str, Any] = {}
    for table, dimension, make in (
        (measures.LINES, "line", measures.line_peaks),
        (measures.PIERS, "pier_part", measures.pier_peaks),
    ):
        rows = [make(task, history) for task, history in runs]
        for column, name in table.items():
            values = np.array([[row[name] for row in run] for run in rows])
            words = name == "line_bearing"
            values = values.astype(str) if words else values
            units = {"units": ""} if words else {}
            about = quantity(column).attributes | units
            data[name] = (("run", dimension, DIRECTION)[: values.ndim], values, about)
    for name, (dimension, _) in PART_HISTORIES.items():
        count = len(lines) if dimension == "line" else len(piers)
        parts = [_part_history(name, task, history)[::every] for task, history in runs]
        wide = padded(parts, (length, count, *_wider(parts, 2)))
        dims = ("run", "step", dimension, DIRECTION)[: wide.ndim]
        data[name] = (dims, wide, quantity(name).attributes)
    coords = {
        "line": np.array([line.name for line in lines], dtype=str),
        "pier_part": np.array([pier.name for pier in piers], dtype=str),
    }
    return data, coords


def _part_history(name: str, task: "Task", history: StructureHistory) -> Floats:
    """Return one of `PART_HISTORIES` of all lines or piers of a run, [step, part]."""
    if name.startswith("line_"):
        book = name.removeprefix("line_")
        lines = [history.bearing(b)[book] for b in range(len(task.lines))]
        return np.stack([measures.with_resultant(values) for values in lines], axis=1)
    place = ("pier_part_displacement", "pier_part_rotation", "pier_part_moment").index(name)
    piers = task.prepared.piers
    each = [measures.pier_histories(task, history, *pier)[place] for pier in piers]
    return np.stack(each, axis=1)


def _bodies(task: "Task", history: StructureHistory) -> Floats:
    """Return the absolute acceleration of the masses of each body at kept steps [m/s2]."""
    structure, every = task.case.structure, task.case.analysis.keep_every
    rows = [
        displacement_row(structure, body.name, mean_height(structure, body.name))
        for body in structure.bodies
    ]
    a = history.rows.a[::every]
    ground = task.shaking.ground[: len(history.rows.a) : every]
    each = [
        measures.with_resultant((product_in_order(a, row) + ground) / measures.MM_PER_M)
        for row in rows
    ]
    return np.stack(each, axis=1)


def _stacks(tasks: Sequence["Task"], cells: int) -> dict[str, Any]:
    """Return thickness, depth and part of the cells of each run, padded with NaN."""
    shape = len(tasks), cells
    depth, thickness = np.full(shape, np.nan), np.full(shape, np.nan)
    part = np.full(shape, "", dtype="<U32")
    for run, task in enumerate(tasks):
        device = task.reported.device
        if device.stack is not None:
            labels = stack_labels(BearingModel(device.stack, device.constants, task.case.analysis))
            own = slice(0, len(labels.depth))
            depth[run, own], thickness[run, own] = labels.depth, labels.thickness
            part[run, own] = labels.part
    about = depth_attributes(bool(tasks and tasks[0].case.analysis.half))
    return {
        "depth": (("run", "cell"), depth, about),
        "cell_thickness": (("run", "cell"), thickness, {"units": "mm"}),
        "part": (("run", "cell"), part, {"units": "", "long_name": "what the cell is"}),
    }


def _attributes(case: EarthquakeCase, tasks: Sequence["Task"], interrupted: bool) -> dict[str, Any]:
    attrs: dict[str, Any] = {
        "command": case.command,
        "structure": case.structure.name,
        "title": case.structure.description or case.structure.name,
        "half_stack": int(case.analysis.half),
        "deck": case.structure.report.deck,
        "pier": case.structure.report.pier,
        "line": case.structure.bearings[case.reported_line_number].name,
        "mass": case.analysis.mass,
        "method": case.analysis.method,
        "damping": case.analysis.damping or case.structure.damping.kind,
        "scheme": case.analysis.scheme,
        "mode": ", ".join(case.modes),
        **({"specimen": case.specimen} if case.specimen else {}),
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "interrupted": int(interrupted),
        "sentences": as_attribute(ALL_SENTENCES),
    }
    if in_weather(case.model_dump(include={"weather", "lines"})):
        attrs["surroundings"] = heat_flow(to_table(case.analysis), [])
    for k, direction in enumerate(dict.fromkeys(task.direction for task in tasks)):
        own = _mode_attributes([task for task in tasks if task.direction == direction])
        attrs |= own if k == 0 else {f"{name}@{direction}": value for name, value in own.items()}
    return attrs


def _mode_attributes(tasks: Sequence["Task"]) -> dict[str, Any]:
    """Return periods and damping of the structure of some runs."""
    prepared = tasks[0].prepared
    attrs: dict[str, Any] = {
        "periods_s": np.asarray(prepared.modes.periods).tolist(),
        "damping_ratios": np.asarray(prepared.ratios).tolist(),
        "coordinates": list(prepared.matrices.coordinates),
    }
    first = {task.device.bearing.name: task for task in reversed(tasks)}
    for name, task in reversed(first.items()):
        attrs[f"initial_periods_s:{name}"] = _initial_periods(task).tolist()
        attrs[f"bilinear:{name}"] = int(isinstance(task.device.bearing, BilinearBearing))
    return attrs


def _initial_periods(task: "Task") -> Floats:
    """Return periods with the initial stiffness of the bearings at the start."""
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


def _interrupted(planned: int, histories: Sequence[StructureHistory]) -> bool:
    return len(histories) < max(planned, 1) or any(h.outcome == INTERRUPTED for h in histories)
