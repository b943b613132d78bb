"""The labelled dataset of an analysis of earthquakes."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import thermobearing
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.plausible import implausible
from thermobearing.bearing.sources import is_never_tested
from thermobearing.bearing.state import (
    RubberState,
    describe_states,
    state_attribute,
    states_table,
)
from thermobearing.border.toml import to_table
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import beyond, rig_demand
from thermobearing.cyclic.dataset import depth_attributes, stack_labels
from thermobearing.cyclic.protocol import lengths
from thermobearing.cyclic.result import COMPONENT
from thermobearing.earthquake import measures
from thermobearing.earthquake.axial import (
    axial_attribute,
    axial_check_rows,
    axial_coordinates,
    axial_histories,
    axial_messages,
    loading_messages,
    p_delta_messages,
)
from thermobearing.earthquake.case import EarthquakeCase, in_weather
from thermobearing.earthquake.measures import DIRECTION
from thermobearing.earthquake.motions import CUT, GENERATED, TARGETS, cut_note, pair_notes
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model import handover
from thermobearing.model.checks import (
    check_rows,
    failed_checks,
    lead_check_rows,
    twist_check,
    vertical_checks,
)
from thermobearing.model.constants import LAW_RANGE, outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.element import initial_stiffness
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import (
    ALL_SENTENCES,
    AXIAL_SENTENCES,
    INTERRUPTED,
    MELTED,
    heat_flow,
)
from thermobearing.motions.library import list_motions
from thermobearing.motions.pair import MotionPair
from thermobearing.quantities.register import quantity
from thermobearing.quantities.warned import UNTESTED, UNUSABLE, Warned, one_per_cause
from thermobearing.results.ranges import (
    Ends,
    Row,
    compare_with_tests,
    farthest,
    outside_tests,
    reached_by,
)
from thermobearing.results.sums import product_in_order
from thermobearing.results.writing import as_attribute, labelled_dataset, warnings_attributes
from thermobearing.structure.matrices import (
    displacement_row,
    find_modes,
    mean_height,
    total_stiffness,
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
    has_lead = task.device.constants.lead.cores > 0.0
    return float(end.response[0].lead_temperature) if has_lead else np.nan


def _labelled_ends(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> dict[str, Any]:
    """Return the states at the end of all runs as variables; nothing of several bearing lines."""
    # One state each: which of several lines an earlier test would hand over is not defined.
    are_layered = [task.device.stack is not None for task in tasks]
    if not any(are_layered) or len(case.structure.bearings) > 1:
        return {}
    ends: list[dict[str, Any]] = []
    for task, history, has_heat in zip(tasks, histories, are_layered, strict=True):
        end = history.end()
        final_state: dict[str, Any] = {"final_temperature": end.temperature}
        final_state["final_lead_temperature"] = _last_lead(task, end)
        ends.append(final_state | handover.state_memory(end) if has_heat else {})
    dims = {"final_temperature": "cell", "final_lead_temperature": None}
    loops = [key for key in handover.OF_LOOPS if any(key in end for end in ends)]
    memory = [*handover.MEMORY, *loops]
    dims |= {key: handover.DIMENSIONS.get(key) for key in memory}
    data: dict[str, Any] = {}
    for key, dimension in dims.items():
        axes = [] if dimension is None else [dimension]
        if case.components > 1 and key in handover.ACROSS:
            axes.append(COMPONENT)
        # A run without the quantity has an empty array, which padding fills with NaN.
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


def _dimensions(values: Floats, *names: str) -> tuple[str, ...]:
    """Return the dimensions of a variable, whose vectors have that of directions at the end."""
    return (*names, DIRECTION) if values.ndim > len(names) else names


Traces = Sequence[Mapping[str, Floats]]
CELLS = {"units": "degC", "long_name": "temperature of the cells, the first at the upper face"}


def _incomplete_checks(tasks: Sequence["Task"], histories: Sequence[StructureHistory]) -> list[str]:
    """Return which runs have checks of a part of the motion only."""
    early_outcomes = [
        history.outcome
        for task, history in zip(tasks, histories, strict=True)
        if history.steps < len(task.shaking.ground) - 1
    ]
    if not early_outcomes:
        return []
    sentence = (
        f"checks under the axial force: {len(early_outcomes)} of {len(histories)} runs ended "
        f"as {', '.join(dict.fromkeys(early_outcomes))} and are checked until then only"
    )
    return [Warned(sentence, "checked_in_part", UNUSABLE)]


def _collect_warnings(
    case: EarthquakeCase,
    tasks: Sequence["Task"],
    histories: Sequence[StructureHistory],
    traces: Traces,
) -> dict[str, Any]:
    """Return warnings, and how far runs use the rig and the tested ranges, as attributes."""
    rig = _rig_rows(case, tasks, traces)
    messages: list[str] = [*beyond(case.rig, rig)]
    if tasks:
        messages += implausible_structure(case.structure, tasks[0].prepared)
    motions = [motion.model_dump(exclude_none=True) for motion in case.motions]
    messages += pair_notes(motions, plan=bool(case.structure.plan))
    records = [task.shaking.motion for task in tasks]
    if cut := cut_note([(record.name, record.duration) for record in records], case.duration):
        messages.append(Warned(cut, CUT))
    of_bearings, compared, of_lead = _warnings_of_bearings(case, tasks, histories, traces)
    # Several bearings that leave the same range are one cause.
    messages += one_per_cause(of_bearings)
    installed = [line.device.bearing for task in tasks for line in task.lines]
    factors = exposures(installed, case.analysis.exposure)
    states = states_table(_stated(case, tasks))
    messages = [*describe_all(factors), *describe_states(states), *messages]
    # A test with a specimen ended at one of its limits.
    messages += [
        Warned(history.note, "specimen", UNUSABLE) for history in histories if history.note
    ]
    checks = _vertical_checks(case, tasks, histories) + axial_check_rows(case, tasks, histories)
    checks += _twist_checks(case, tasks, histories)
    messages += axial_messages(tasks, histories)
    messages += failed_checks(of_lead + checks)
    if checks:
        messages += _incomplete_checks(tasks, histories)
    messages += p_delta_messages(tasks, histories) + _oil_messages(tasks)
    messages += loading_messages(case, tasks, histories)
    messages += _climate_messages(case)
    row_tables = {"rig": rig, "tested_range": compared, "bearing_checks": of_lead + checks}
    row_tables |= exposure_attribute(factors) | state_attribute(states)
    attributes = {name: as_attribute(rows) for name, rows in row_tables.items() if rows}
    return warnings_attributes(messages) | attributes


def _warnings_of_bearings(
    case: EarthquakeCase,
    tasks: Sequence["Task"],
    histories: Sequence[StructureHistory],
    traces: Traces,
) -> tuple[list[Warned], list[Row], list[Row]]:
    """Return warnings about bearings, comparisons with their tests, and checks of their lead.

    The warnings are on plausibility, tested range and the range of the temperature law.
    """
    of_bearings: list[Warned] = []
    compared: list[Row] = []
    of_lead: list[Row] = []
    for bearing, lines_by_run in _bearings(tasks).values():
        of_bearings += [warning.about(bearing.name) for warning in implausible(bearing)]
        ranges = calibration_ranges(bearing)
        rows: list[Row] = []
        for k, lines in lines_by_run.items():
            name = _name(tasks[k], bearing.name)
            reached = _reached(tasks[k], histories[k], lines)
            rows += compare_with_tests(name, reached, ranges)
            of_lead += _lead_rows(name, bearing.name, reached, histories[k])
        # Every earthquake strains faster than the tests: a note of the result states the rate.
        never = is_never_tested(bearing.sources)
        of_bearings += outside_tests(
            bearing.name, rows, ranges, skip=("strain_rate",), never_tested=never
        )
        compared += rows
        # Neither bilinear bearings nor blind models use the temperature law.
        if not isinstance(bearing, BilinearBearing) and case.analysis.model not in BLIND:
            runs = [
                (_name(tasks[k]), traces[k]["time"], histories[k].layers(line))
                for k, lines in lines_by_run.items()
                for line in lines
            ]
            of_bearings += outside_law(
                bearing.name, bearing.temperature_law, runs, bearing.sources.get(LAW_RANGE, "")
            )
    return of_bearings, compared, of_lead


def _climate_messages(case: EarthquakeCase) -> list[Warned]:
    """Return a message for each line that does not follow the temperatures that are compared."""
    messages = []
    for item in case.lines if len(case.ambient) > 1 else ():
        if item.ambient is not None or item.weather is not None:
            climate = "in its own weather" if item.ambient is None else f"at {item.ambient:g} degC"
            sentence = (
                f"line {item.line} stays {climate} in all runs; comparisons of temperatures do not "
                "apply to it"
            )
            messages.append(Warned(sentence, f"climate_of_line.{item.line}"))
    return messages


def _stated(
    case: EarthquakeCase, tasks: "Sequence[Task]"
) -> dict[str, tuple[Bearing, RubberState]]:
    """Return layered bearings whose rubber has a stated state, by name (and line, if its own)."""
    lines_with_state = {item.line for item in case.lines if item.state is not None}
    bearings = {}
    for task in tasks:
        for line, installed in zip(case.structure.bearings, task.lines, strict=True):
            bearing, state = installed.device.bearing, installed.device.state
            if isinstance(bearing, Bearing) and state is not None:
                suffix = f" on {line.name}" if line.name in lines_with_state else ""
                bearings[f"{bearing.name}{suffix}"] = bearing, state
    return bearings


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
    bearings: dict[str, tuple[Bearing | BilinearBearing, dict[int, list[int]]]] = {}
    for k, task in enumerate(tasks):
        for line, installed in enumerate(task.lines):
            bearing = installed.device.bearing
            _, lines_by_run = bearings.setdefault(bearing.name, (bearing, {}))
            lines_by_run.setdefault(k, []).append(line)
    return bearings


def _reached(
    task: "Task", history: StructureHistory, lines: Sequence[int]
) -> dict[str, float | Ends]:
    """Return how far a run goes in the tested range, the farthest of some lines."""
    line_values = []
    for line in lines:
        rows, installed = history.bearing(line), task.lines[line]
        displacement, speed = rows["displacement"], lengths(measures.loading_speed(rows))
        # The strain is that of the resultant, which has no sign; that of x keeps both sides apart.
        if displacement.ndim > 1:
            displacement = np.copysign(lengths(displacement), displacement[:, 0])
        reached = reached_by(
            rows["clock"],
            displacement,
            measures.largest(speed),
            rubber=installed.device.bearing.total_rubber_thickness,
            ambient=(installed.ambient, installed.ambient),
            lead=rows["lead_temperature"] if installed.device.has_lead else None,
        )
        line_values.append(reached)
    return farthest(line_values)


def _name(task: "Task", bearing: str = "") -> str:
    return task.label(bearing)


def _rig_rows(case: EarthquakeCase, tasks: Sequence["Task"], traces: Traces) -> list[Row]:
    """Return how far each run uses the rig, with the speed on the clock of the specimen."""
    rows = []
    names = ("bearing_force", "bearing_displacement", "bearing_speed")
    for task, trace in zip(tasks, traces, strict=True):
        peaks = [float(np.abs(trace[name]).max()) for name in names]
        rows += rig_demand(case.rig, _name(task, task.reported.device.bearing.name), peaks)
    return rows


def _oil_messages(tasks: Sequence["Task"]) -> list[Warned]:
    """Return a warning for each damper whose table of its oil does not reach an ambient."""
    messages = []
    for device in tasks[0].case.structure.device_list if tasks else ():
        temperatures, _ = device.oil()
        ambients = sorted({task.ambient for task in tasks})
        outside = [t for t in ambients if not temperatures[0] <= t <= temperatures[-1]]
        if len(temperatures) > 1 and outside:
            sentence = (
                f"its factors are of {temperatures[0]:g} to {temperatures[-1]:g} degC, and are "
                f"constant beyond; there are runs at {', '.join(f'{t:g}' for t in outside)} degC"
            )
            messages.append(Warned(sentence, "oil_table", UNTESTED, f"damper {device.name}"))
    return messages


def _vertical_checks(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Row]:
    """Return the checks of the bearings of every line that has an axial force, in every run."""
    forces, names = case.axial_forces(), [line.name for line in case.structure.bearings]
    rows: list[Row] = []
    for task, history in zip(tasks, histories, strict=True) if forces else ():
        for k, (name, installed) in enumerate(zip(names, task.lines, strict=True)):
            bearing = installed.device.bearing
            if name in forces:
                layered = bearing if isinstance(bearing, Bearing) else None
                displacement = history.bearing(k)["displacement"]
                if task.direction == "y":  # across the length of the plan
                    displacement = np.column_stack([np.zeros_like(displacement), displacement])
                part = name if len(names) > 1 else ""
                checks = vertical_checks(
                    layered, forces[name], displacement, installed.ambient, part
                )
                rows += check_rows(_name(task, bearing.name), bearing.name, checks)
    return rows


def _twist_checks(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Row]:
    """Return the estimated local strain of the bearings of every line that move in a plane."""
    names = [line.name for line in case.structure.bearings]
    rows: list[Row] = []
    for task, history in zip(tasks, histories, strict=True) if case.components > 1 else ():
        for k, (name, installed) in enumerate(zip(names, task.lines, strict=True)):
            bearing, record = installed.device.bearing, history.bearing(k)
            if isinstance(bearing, Bearing):
                part = name if len(names) > 1 else ""
                check = twist_check(bearing.geometry, record["displacement"], record["force"], part)
                rows += check_rows(_name(task, bearing.name), bearing.name, [check])
    return rows


Runs = Sequence[tuple["Task", StructureHistory]]


def _label_histories(
    case: EarthquakeCase, runs: Runs, traces: Traces, length: int
) -> dict[str, Any]:
    """Return the histories of all runs as variables: scalars, layers, bodies, cells."""
    keep_every = case.analysis.keep_every
    # Only a pseudo-dynamic test has a clock other than that of the earthquake.
    slow = ["bearing_clock"] if "pd" in case.modes else []
    data: dict[str, Any] = {}
    for name in ("time", *measures.HISTORIES, *slow):
        parts = [trace[name][::keep_every] for trace in traces]
        values = padded(parts, (length, *_wider(parts, 1)))
        data[name] = (_dimensions(values, "run", "step"), values, quantity(name).attributes)
    across = {  # histories with one number per layer, body or cell
        "rubber_temperature": (
            "layer",
            [trace["rubber_temperature"][::keep_every] for trace in traces],
        ),
        "body_acceleration": ("body", [_bodies(task, history) for task, history in runs]),
    }
    if "cells" in case.analysis.keep:
        across["temperature"] = "cell", [trace["temperature"][::keep_every] for trace in traces]
    across |= axial_histories(runs, keep_every)
    for name, (dimension, parts) in across.items():
        largest_count = max((part.shape[1] for part in parts), default=0)
        stacked = padded(parts, (length, largest_count, *_wider(parts, 2)))
        attributes = CELLS if name == "temperature" else quantity(name).attributes
        data[name] = (_dimensions(stacked, "run", "step", dimension), stacked, attributes)
    if "temperature" in across:
        data |= _stacks([task for task, _ in runs], data["temperature"][1].shape[2])
    return data


def label_analysis(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> EarthquakeResult:
    """Return the result of an analysis: peaks from every step, histories every `keep_every`-th."""
    # An interrupted analysis has histories of its first tasks only.
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
    others = ["actuator_kN_mm"] if case.laboratory is not None else []
    others += [f"{name}_kN_mm" for name in measures.device_energies(case.structure)]
    for item in map(quantity, (*measures.NUMBERS, *others, *measures.LOOP, *measures.LOOP_TIMES)):
        values = np.array([row[item.variable] for row in numbers])
        data[item.variable] = (_dimensions(values, "run"), values, item.attributes)
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
            **(axial_coordinates(runs) if "axial_force" in data else {}),
        },
        attrs=_attributes(case, tasks, _interrupted(planned, histories))
        | axial_attribute(tasks, histories)
        | _device_attribute(runs)
        | _collect_warnings(case, tasks, histories, traces),
    )
    return EarthquakeResult(dataset)


def _device_attribute(runs: Runs) -> dict[str, Any]:
    """Return the peaks and energies of devices as an attribute of a dataset; none without one."""
    rows = [row for task, history in runs for row in measures.device_peaks(task, history)]
    return {"devices": as_attribute(rows)} if rows else {}


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
    keep_every = case.analysis.keep_every
    data: dict[str, Any] = {}
    for table, dimension, make in (
        (measures.LINES, "line", measures.line_peaks),
        (measures.PIERS, "pier_part", measures.pier_peaks),
    ):
        rows = [make(task, history) for task, history in runs]
        for column, name in table.items():
            values = np.array([[row[name] for row in run] for run in rows])
            is_text = name == "line_bearing"
            values = values.astype(str) if is_text else values
            units = {"units": ""} if is_text else {}
            attributes = quantity(column).attributes | units
            data[name] = (_dimensions(values, "run", dimension), values, attributes)
    for name, (dimension, _) in measures.PART_HISTORIES.items():
        count = len(lines) if dimension == "line" else len(piers)
        parts = [_part_history(name, task, history)[::keep_every] for task, history in runs]
        stacked = padded(parts, (length, count, *_wider(parts, 2)))
        dims = _dimensions(stacked, "run", "step", dimension)
        data[name] = (dims, stacked, quantity(name).attributes)
    coords = {
        "line": np.array([line.name for line in lines], dtype=str),
        "pier_part": np.array([pier.name for pier in piers], dtype=str),
    }
    return data, coords


def _part_history(name: str, task: "Task", history: StructureHistory) -> Floats:
    """Return one of `PART_HISTORIES` of all lines or piers of a run, [step, part]."""
    if name.startswith("line_"):
        column = name.removeprefix("line_")
        lines = [history.bearing(b)[column] for b in range(len(task.lines))]
        return np.stack([measures.with_resultant(values) for values in lines], axis=1)
    histories = []
    for pier, top_row, base_row in task.prepared.piers:
        displacement, rotation, moment, _, _ = measures.pier_histories(
            task, history, pier, top_row, base_row
        )
        by_name = {
            "pier_part_displacement": displacement,
            "pier_part_rotation": rotation,
            "pier_part_moment": moment,
        }
        histories.append(by_name[name])
    return np.stack(histories, axis=1)


def _bodies(task: "Task", history: StructureHistory) -> Floats:
    """Return the absolute acceleration of the masses of each body at kept steps [m/s2]."""
    structure, keep_every = task.case.structure, task.case.analysis.keep_every
    rows = [
        displacement_row(structure, body.name, mean_height(structure, body.name))
        for body in structure.bodies
    ]
    a = history.rows.a[::keep_every]
    ground = task.shaking.ground[: len(history.rows.a) : keep_every]
    accelerations = [
        measures.with_resultant((product_in_order(a, row) + ground) / measures.MM_PER_M)
        for row in rows
    ]
    return np.stack(accelerations, axis=1)


def _stacks(tasks: Sequence["Task"], cells: int) -> dict[str, Any]:
    """Return thickness, depth and part of the cells of each run, padded with NaN."""
    shape = len(tasks), cells
    depth, thickness = np.full(shape, np.nan), np.full(shape, np.nan)
    part = np.full(shape, "", dtype="<U32")
    for run, task in enumerate(tasks):
        device = task.reported.device
        if device.stack is not None:
            labels = stack_labels(BearingModel(device.stack, device.constants, task.case.analysis))
            filled = slice(0, len(labels.depth))
            depth[run, filled], thickness[run, filled] = labels.depth, labels.thickness
            part[run, filled] = labels.part
    attributes = depth_attributes(bool(tasks and tasks[0].case.analysis.half))
    return {
        "depth": (("run", "cell"), depth, attributes),
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
        "sentences": as_attribute(
            ALL_SENTENCES | (AXIAL_SENTENCES if case.analysis.has_axial else {})
        ),
    }
    if in_weather(case.model_dump(include={"weather", "lines"})):
        attrs["surroundings"] = heat_flow(to_table(case.analysis), [])
    if targets := _motion_targets(tasks):
        attrs[TARGETS] = as_attribute(targets)
    if generated := _generated_motions(case, tasks):
        attrs[GENERATED] = as_attribute(generated)
    for k, direction in enumerate(dict.fromkeys(task.direction for task in tasks)):
        mode_attributes = _mode_attributes([task for task in tasks if task.direction == direction])
        # The first direction has plain names; `sel` replaces them by those with the ending "@y".
        if k > 0:
            mode_attributes = {
                f"{name}@{direction}": value for name, value in mode_attributes.items()
            }
        attrs |= mode_attributes
    return attrs


def _generated_motions(case: EarthquakeCase, tasks: Sequence["Task"]) -> dict[str, str]:
    """Return the descriptions of files of motions that were made to fit a spectrum, by name."""
    built_in = {motion.title for motion in case.motions if motion.name in list_motions()}
    described = {}
    for motion in (task.shaking.motion for task in tasks):
        record = motion.along("x") if isinstance(motion, MotionPair) else motion
        if record.is_generated and motion.name not in built_in:
            # Of an AT2 file the second of its free lines follows, a name.
            words = record.description
            described[motion.name] = words if record.target else words.partition("; ")[0]
    return described


def _motion_targets(tasks: Sequence["Task"]) -> dict[str, dict[str, Any]]:
    """Return factor, description and target spectrum of each motion made to fit one, by name."""
    from thermobearing.motions.targets import target_text  # takes scipy

    targets = {}
    for task in tasks:
        motion = task.shaking.motion
        along = motion.along("x") if isinstance(motion, MotionPair) else motion
        if along.target is not None:
            targets[motion.name] = {
                "factor": task.shaking.factor,
                "description": along.description,
                "target": target_text(along.target),
            }
    return targets


def _mode_attributes(tasks: Sequence["Task"]) -> dict[str, Any]:
    """Return periods and damping of the structure of some runs."""
    prepared = tasks[0].prepared
    attrs: dict[str, Any] = {
        "periods_s": np.asarray(prepared.modes.periods).tolist(),
        "damping_ratios": np.asarray(prepared.ratios).tolist(),
        "coordinates": list(prepared.matrices.coordinates),
    }
    # Reversed, so that the first run of each bearing is what remains.
    first = {task.device.bearing.name: task for task in reversed(tasks)}
    for name, task in reversed(first.items()):
        attrs[f"initial_periods_s:{name}"] = _initial_periods(task).tolist()
        attrs[f"bilinear:{name}"] = int(isinstance(task.device.bearing, BilinearBearing))
    return attrs


def _initial_periods(task: "Task") -> Floats:
    """Return periods with the initial stiffness of the bearings at the start."""
    matrices, structure = task.prepared.matrices, task.case.structure
    line_stiffnesses = np.zeros(len(task.lines))
    for b, (installed, line) in enumerate(zip(task.lines, structure.bearings, strict=True)):
        constants = installed.device.constants
        stiffness_at_rest = initial_stiffness(constants, installed.temperature, installed.ambient)
        # A specimen at a scale s has s^2 of the force at s of the displacement: s of the stiffness.
        line_stiffnesses[b] = stiffness_at_rest / line.scale
    stiffness = total_stiffness(structure, matrices, line_stiffnesses)
    return find_modes(matrices.mass, stiffness).periods


def _interrupted(planned: int, histories: Sequence[StructureHistory]) -> bool:
    return len(histories) < max(planned, 1) or any(h.outcome == INTERRUPTED for h in histories)
