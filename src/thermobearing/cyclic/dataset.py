"""The labelled dataset of a test, its thinned histories and their size.

Dimensions: `ambient` (one per run), `time` (kept steps), `layer` (1 is the outermost rubber
layer), `cell` (1 is at the upper face), and `component` (x, y) of displacements and forces in a
plane. Runs whose rests end at different times have
different clocks: `clock(ambient, time)` then replaces the coordinate `time`. Shorter runs
are padded with NaN.

A step of 5 ms makes thousands of rows a cycle, and a tall bearing a hundred numbers a row.
Measures, energies and figures are computed from all rows of a history before it is thinned; the
rows that are kept keep their bits.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import thermobearing
from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.exposure import describe_all, exposure_attribute, exposures
from thermobearing.bearing.model import calibration_ranges
from thermobearing.bearing.plausible import doubled_law
from thermobearing.bearing.sources import is_never_tested
from thermobearing.bearing.state import describe_states, state_attribute, states_table
from thermobearing.border.lazy import xr
from thermobearing.core.records import Floats, Ints, labels
from thermobearing.core.types import AxialResponse, BearingResponse, RubberResponse
from thermobearing.cyclic.case import Case, beyond, rig_demand
from thermobearing.cyclic.history import History, Segment
from thermobearing.cyclic.protocol import Cycles, PlanePath, lengths, survey
from thermobearing.cyclic.result import COMPONENT, CYCLES, Result, column_quantity, run_name
from thermobearing.model.axial import axial_peaks, unstable_warning
from thermobearing.model.checks import (
    axial_checks,
    check_rows,
    failed_checks,
    lead_check_rows,
    twist_check,
    twisted_strain,
    vertical_checks,
)
from thermobearing.model.constants import LAW_RANGE, outside_law
from thermobearing.model.earlier import BLIND
from thermobearing.model.handover import DIMENSIONS, PREFIX, state_memory
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import (
    AXIAL_SENTENCES,
    MELTED,
    SENTENCES,
    SHARING_SENTENCES,
    UNSTABLE,
)
from thermobearing.quantities.governing import place_of_largest, place_of_least
from thermobearing.quantities.register import quantity
from thermobearing.quantities.validity import VALID_UNTIL
from thermobearing.quantities.warned import ASSUMED, UNUSABLE, Warned
from thermobearing.results.metrics import find_cycles
from thermobearing.results.ranges import Row, compare_with_tests, outside_tests, reached_by
from thermobearing.results.writing import (
    as_attribute,
    labelled_dataset,
    labelled_variable,
    warnings_attributes,
)

# Histories that may be kept besides: variable, dimension.
GROUPS = {
    "rubber": ("rubber_temperature", "layer"),
    "layer_displacement": ("layer_displacement", "layer"),
    "hysteretic": ("hysteretic_variable", "layer"),
    "cells": ("temperature", "cell"),
}
AXIAL_COLUMNS = 10  # of `AxialResponse` that results have
PADDING = {"segment": -1, "cycle": 0}  # after the end of a shorter run; else NaN


class StackLabels(NamedTuple):
    """Coordinates of the cells of a dataset, and the numbers that its histories have."""

    depth: Floats  # of the cell centres from the upper face [mm]
    thickness: Floats  # of the cells [mm]
    part: tuple[str, ...]
    layers: int
    response: Sequence[tuple[str, str, str]]  # name, unit and meaning of the numbers of each step


def stack_labels(model: BearingModel) -> StackLabels:
    """Return the labels of the layers and cells; a single cell represents the full bearing."""
    stack, constants = model.stack, model.constants
    layers = len(constants.multiplicity)
    branches = constants.lead.cores > 0.0 or constants.viscous.stiffness > 0.0
    response = labels(BearingResponse if branches else RubberResponse)
    if len(constants.cells.capacity) == len(stack.part):
        return StackLabels(stack.depth, stack.thickness, stack.part, layers, response)
    height = np.array([stack.thickness.sum()])
    return StackLabels(0.5 * height, height, ("whole bearing",), layers, response)


def depth_attributes(half: bool) -> dict[str, str]:
    """Attributes of the coordinate `depth`; a half stack is mirrored at the middle."""
    name = "distance of the cell centre from the upper face"
    return {"units": "mm", "long_name": f"{name}, to the middle (half stack)" if half else name}


def labelled(
    case: Case,
    model: BearingModel,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> "xr.Dataset":
    """Return the dataset of finished runs, with units, meanings and provenance."""
    bearing = case.bearing
    rows = _compared_rows(case, segments, climates, histories)
    constants, options = model.constants, model.options
    factors = exposures([bearing], case.analysis.exposure)
    states = states_table({bearing.name: (bearing, case.analysis.state)})
    lead_capacity = constants.lead.cores * constants.lead.capacity
    attributes = {
        "title": f"{bearing.name}, {case.test.name}",
        "command": "cyclic",
        "bearing": bearing.name,
        **{key: getattr(options, key) for key in ("model", "scheme", "integrator", "heat_source")},
        "lead_capacity_kN_mm_per_K": lead_capacity if bearing.lead else 0.0,
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "citation": bearing.citation,
        "area_mm2": bearing.area,
        "total_rubber_thickness_mm": bearing.total_rubber_thickness,
        "heat_capacity_kN_mm_per_K": constants.cells.capacity.tolist(),
        "histories": case.analysis.histories,  # of files
        "half_stack": int(model.stack.fold == 2),
        "segments": [
            {"kind": s.kind, "label": s.label, "amplitude_strain": s.amplitude_strain}
            for s in segments
        ],
        **warnings_attributes(
            [
                *describe_all(factors),
                *describe_states(states),
                *_collect_warnings(case, segments, climates),
                *_outside_law(case, climates, histories),
                *beyond(case.rig, rows["rig"]),
                *failed_checks(rows["bearing_checks"]),
                *_unstable_runs(climates, histories),
                *outside_tests(
                    bearing.name,
                    rows["tested_range"],
                    calibration_ranges(bearing),
                    never_tested=is_never_tested(bearing.sources),
                ),
            ]
        ),
        **{name: limit_rows for name, limit_rows in rows.items() if limit_rows},
        **exposure_attribute(factors),
        **state_attribute(states),
        "sentences": SENTENCES
        | SHARING_SENTENCES
        | (AXIAL_SENTENCES if case.analysis.has_axial else {}),
    }
    return _build_dataset(case, stack_labels(model), climates, histories, attributes)


def _build_dataset(
    case: Case,
    stack: StackLabels,
    climates: list[Ambient],
    runs: list[History],
    attributes: dict[str, Any],
) -> "xr.Dataset":
    bearing, per_run, steps = case.bearing, ("ambient",), ("ambient", "time")
    clock = stacked([run.rows.response["clock"] for run in runs])
    one_clock = all(np.array_equal(clock[0], run_clock) for run_clock in clock)
    data: dict[str, Any] = {}
    meanings = {name: {"units": unit, "long_name": text} for name, unit, text in stack.response}
    for name in meanings:
        if name != "clock" or not one_clock:
            values = stacked([run.rows.response[name] for run in runs])
            data[name] = (_dimensions(values, steps), values, meanings[name])
    (dims, displacement, _), (_, force, _) = data["displacement"], data["force"]
    data["strain"] = (dims, displacement / bearing.total_rubber_thickness)
    data["stress"] = (dims, force * (1e3 / bearing.area))
    for group, (name, dimension) in GROUPS.items():
        if group in case.analysis.keep:
            values = stacked([run.rows._asdict()[group] for run in runs])
            data[name] = (_dimensions(values, (*steps, dimension)), values)
    data |= _axial_variables(runs, steps, per_run)
    for name in ("segment", "cycle"):
        data[name] = (steps, stacked([getattr(run, name) for run in runs], PADDING[name]))
    lead = [run.state.response[0].lead_temperature if bearing.lead else np.nan for run in runs]
    data |= {
        "initial_temperature": (("ambient", "cell"), np.array([run.initial for run in runs])),
        "final_temperature": (("ambient", "cell"), np.array([r.state.temperature for r in runs])),
        "final_lead_temperature": (per_run, np.array(lead)),
        "outcome": (per_run, np.array([run.outcome for run in runs], dtype=object)),
        "steps": (per_run, np.array([run.steps for run in runs])),
        "softened_steps": (per_run, np.array([run.softened_steps for run in runs])),
        "layer_force_mismatch_max": (per_run, np.array([run.mismatch for run in runs])),
    }
    data |= _memories(runs)
    ambient = [climate.at(0.0) for climate in climates[: len(runs)]]
    coordinates: dict[str, Any] = {
        "ambient": (per_run, np.array(ambient)),
        "layer": ("layer", np.arange(1, stack.layers + 1)),
        "cell": ("cell", np.arange(1, len(stack.depth) + 1)),
        "depth": ("cell", stack.depth, depth_attributes(bool(attributes["half_stack"]))),
        "cell_thickness": ("cell", stack.thickness),
        "part": ("cell", np.array(stack.part, dtype=object)),
    }
    if dims[-1] == COMPONENT:
        coordinates[COMPONENT] = (COMPONENT, np.array(["x", "y"], dtype=object))
        data["local_strain"] = (steps, twisted_strain(bearing.geometry, displacement, force))
    if one_clock:
        coordinates["time"] = ("time", clock[0], meanings["clock"])
    plain = {key: as_attribute(value) for key, value in attributes.items()}
    dataset = labelled_dataset(data, coordinates, plain)
    for variable_name, variable in dataset.variables.items():
        if not variable.attrs:
            registered = quantity(str(variable_name))
            variable.attrs = dict(registered.attributes)
            if not registered.stored:
                del variable.attrs["units"]
    return dataset


def _axial_variables(
    runs: list[History], steps: tuple[str, ...], per_run: tuple[str, ...]
) -> dict[str, Any]:
    """Return what the axial force did to the bearing, where it acted on the shear force."""
    variables: dict[str, Any] = {}
    firsts = [
        axial_peaks(run.rows.response["clock"], run.axial)["analysis"].first
        for run in runs
        if run.axial is not None
    ]
    if np.isfinite(firsts).any():
        variables[VALID_UNTIL] = (per_run, np.array(firsts))
    for name, unit, text in labels(AxialResponse)[:AXIAL_COLUMNS]:
        columns = [run.axial[name] for run in runs if run.axial is not None]
        if columns:
            variables[name] = (steps, stacked(columns), {"units": unit, "long_name": text})
    return variables


def _dimensions(values: NDArray[Any], names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the dimensions of an array: `names`, and the component of one in a plane."""
    return (*names, COMPONENT) if values.ndim > len(names) else names


def _memories(runs: list[History]) -> dict[str, Any]:
    """Return the state at the end of each run on a line, from which another test can go on."""
    memories, variables = [state_memory(run.state) for run in runs], {}
    for key in memories[0]:
        values, dimension = np.array([memory[key] for memory in memories]), DIMENSIONS.get(key)
        if values.size:  # no empty variables
            dims = ["ambient", *([] if dimension is None else [dimension])]
            dims += [COMPONENT] * (values.ndim - len(dims))
            variables[PREFIX + key] = (dims, values, quantity(PREFIX + key).attributes)
    return variables


def stacked(arrays: list[NDArray[Any]], padding: float = np.nan) -> NDArray[Any]:
    """Return runs on a leading axis, shorter ones padded; no copy of a single run."""
    if len(arrays) == 1:
        return arrays[0][np.newaxis]
    shape = (len(arrays), max(map(len, arrays)), *arrays[0].shape[1:])
    out = np.full(shape, padding, dtype=arrays[0].dtype)
    for i, values in enumerate(arrays):
        out[i, : len(values)] = values
    return out


GIVEN_IN_PYTHON = "the ambient series was given in Python"


def _collect_warnings(case: Case, segments: list[Segment], climates: list[Ambient]) -> list[str]:
    """Return sentences on assumptions, inputs that a file cannot hold, and coarse time steps."""
    assumptions = dict.fromkeys(text for segment in segments for text in segment.assumed)
    warnings: list[str] = [Warned(text, text, ASSUMED) for text in assumptions]
    if case.analysis.model not in BLIND:
        warnings += [warning.about(case.bearing.name) for warning in doubled_law(case.bearing)]
    if case.ambient_series is None and any(len(climate.time) > 1 for climate in climates):
        warnings.append(
            f"{GIVEN_IN_PYTHON}, so that case.resolved.toml has its first value only; "
            "a CSV file (ambient_series) makes the case repeatable"
        )
    if case.initial_state is not None and not case.initial_state.complete:
        warnings.append(
            "the earlier result is of an earlier version and has temperatures only; rubber and "
            "lead begin unloaded and virgin, at zero displacement"
        )
    increment = float(_increments(case, segments).max()) / case.bearing.geometry.rubber_layers
    yielding = case.bearing.hysteresis.yield_displacement
    if increment > yielding:
        sentence = (
            f"steps of up to {increment:.2g} mm per rubber layer exceed its yield displacement, "
            f"{yielding:g} mm, so that work and heat are inaccurate; use a smaller dt"
        )
        warnings.append(Warned(sentence, "long_steps", UNUSABLE))
    return warnings


def _outside_law(case: Case, climates: list[Ambient], histories: list[History]) -> list[Warned]:
    """Return whether rubber left the range of its temperature law, where the model has one."""
    if case.analysis.model in BLIND:
        return []
    runs = [
        (
            run_name(climate.at(0.0)),
            history.rows.response["clock"],
            np.asarray(history.rows.rubber),
        )
        for climate, history in zip(climates, histories, strict=False)
    ]
    return outside_law(
        case.bearing.name,
        case.bearing.temperature_law,
        runs,
        case.bearing.sources.get(LAW_RANGE, ""),
    )


def _unstable_runs(climates: list[Ambient], histories: list[History]) -> list[Warned]:
    """Return a warning for each run whose axial force exceeds the critical load."""
    unstable = []
    for climate, history in zip(climates, histories, strict=False):
        if history.axial is None or history.outcome != UNSTABLE:
            continue
        peak = axial_peaks(history.rows.response["clock"], history.axial)["analysis"]
        unstable.append(unstable_warning(run_name(climate.at(0.0)), peak))
    return unstable


def _increments(case: Case, segments: list[Segment]) -> Floats:
    """Return how far the bearing moves in each step [mm]."""
    start = np.full_like(segments[0].x[:1], case.starts_at)
    return lengths(np.diff(np.concatenate([start, *(segment.x for segment in segments)]), axis=0))


def _compared_rows(
    case: Case, segments: list[Segment], climates: list[Ambient], histories: list[History]
) -> dict[str, list[Row]]:
    """Compare each run with the rig, with the tests of the bearing and with its critical load."""
    dt = np.concatenate([segment.dt for segment in segments])
    speed = float((_increments(case, segments) / dt).max())
    rows: dict[str, list[Row]] = {"rig": [], "tested_range": [], "bearing_checks": []}
    # An interrupted analysis has fewer histories than climates.
    for climate, history in zip(climates, histories, strict=False):
        quantities, name = history.rows.response, run_name(climate.at(0.0))
        peaks = [float(lengths(quantities[key]).max()) for key in ("force", "displacement")]
        displacement = quantities["displacement"]
        if displacement.ndim > 1:  # strain of the resultant, cycles along x
            displacement = np.copysign(lengths(displacement), displacement[:, 0])
        rows["rig"] += rig_demand(case.rig, name, [*peaks, speed])
        reached = reached_by(
            quantities["clock"],
            displacement,
            speed,
            rubber=case.bearing.total_rubber_thickness,
            ambient=(float(climate.temperature.min()), float(climate.temperature.max())),
            lead=quantities["lead_temperature"] if case.bearing.lead else None,
        )
        rows["tested_range"] += compare_with_tests(name, reached, calibration_ranges(case.bearing))
        if "lead_temperature" in reached:
            hottest = np.max(reached["lead_temperature"])
            melted = history.outcome == MELTED
            rows["bearing_checks"] += lead_check_rows(
                name, case.bearing.name, float(hottest), melted=melted
            )
        if case.axial_force is not None:
            warmest = float(climate.temperature.max())
            load = case.axial_force, quantities["displacement"], warmest
            rows["bearing_checks"] += check_rows(
                name, case.bearing.name, vertical_checks(case.bearing, *load)
            )
        if history.axial is not None:
            rows["bearing_checks"] += check_rows(
                name,
                case.bearing.name,
                axial_checks(axial_peaks(quantities["clock"], history.axial)),
            )
        if quantities["displacement"].ndim > 1:
            check = twist_check(
                case.bearing.geometry, quantities["displacement"], quantities["force"]
            )
            rows["bearing_checks"] += check_rows(name, case.bearing.name, [check])
    return rows


POINTS = 200  # of a cycle, a ramp, a rest
ROWS = "rows"  # attribute of a dataset that was thinned
THINNED, COMPLETE = "thinned", "complete"


def written_part(result: Result) -> Result:
    """Return the result with its cycles as a table, and the rows that are worth writing.

    These are all rows if the case requests complete histories.
    """
    data = result.dataset
    if data.attrs.get("histories") == COMPLETE or data.attrs.get(ROWS) == THINNED:
        return result
    rows = [_rows_to_write(result, run) for run in range(data.sizes["ambient"])]
    if "clock" not in data:  # one clock for all
        data = data.isel(time=np.unique(np.concatenate(rows)))
    else:
        variables = {}
        for name, values in data.data_vars.items():
            if values.dims[:2] == ("ambient", "time"):
                values_by_run = [values.values[run, run_rows] for run, run_rows in enumerate(rows)]
                kept_values = stacked(values_by_run, PADDING.get(str(name), np.nan))
                kept_part = (values.dims, kept_values, values.attrs)
                variables[str(name)] = labelled_variable(str(name), kept_part)
        data = data.drop_vars(list(variables)).assign(variables)
    measures = {}
    for name in map(str, result.cycles):
        units = {"units": column_quantity(name).stored}
        column = (CYCLES, result.cycles[name].to_numpy(), units)
        measures[f"{CYCLES}_{name}"] = labelled_variable(f"{CYCLES}_{name}", column)
    return Result(data.assign(measures).assign_attrs({ROWS: THINNED}))


def _rows_to_write(result: Result, run: int) -> Ints:
    """Return the rows of a run to write: of each cycle its ends, its extremes, 200 between."""
    data = result.dataset
    segment, cycle = (data[name].values[run] for name in ("segment", "cycle"))
    sides = [side for n in ("displacement", "force") for side in np.atleast_2d(data[n][run].T)]
    x = np.asarray(sides[0])
    count = int((segment >= 0).sum())
    # Not zero where the segment or the cycle changes. Rows are spread between such changes, and
    # between the cycles of a recording, so that each cycle has as many.
    change = np.diff(segment[:count]) | np.diff(cycle[:count])
    bounds = {0, count, *(1 + np.flatnonzero(change)).tolist()}
    parts = np.searchsorted(segment[:count], np.arange(len(result.segments) + 1)).tolist()
    for step, (first, end) in zip(result.segments, pairwise(parts), strict=True):
        if step["kind"] == "recorded" and first < end:
            bounds |= {first + place + 1 for pair in find_cycles(x[first:end]) for place in pair}
    places = [np.array([0])]
    for first, end in pairwise(sorted(place for place in bounds if place <= count)):
        block = slice(first, end)
        even = np.linspace(0, end - first - 1, min(end - first, POINTS)).round()
        turns = place_of_largest, place_of_least
        ends = [turn(values[block]) for values in sides for turn in turns]
        places.append(first + np.concatenate([even, ends]).astype(np.int64))
    return np.unique(np.concatenate(places))


DOUBLE, SINGLE = 8, 4  # [bytes] of a number in result.nc; those of cells are single
TEXT = 11  # [bytes] of a number in history.csv, with its comma
CSV_COLUMNS = 7  # besides the layers
COUNTERS = 8  # [bytes] of the numbers of segment and cycle


def expected_size(case: Case) -> float:
    """Return an upper bound of result.nc without compression and history.csv [bytes]."""
    keep, stack = case.analysis.keep, case.analysis.build_stack(case.bearing)
    layers = max(stack.part.count("rubber") // max(case.bearing.cells.rubber, 1), 1)
    layer_columns = sum(layers for name in keep if name != "cells")
    row = DOUBLE * (len(labels(BearingResponse)) + 2 + layer_columns) + COUNTERS
    row += (DOUBLE + TEXT) * 6 if case.test.in_plane else 0  # second components
    row += SINGLE * len(stack.part) if "cells" in keep else 0
    row += TEXT * (CSV_COLUMNS + (layers if "rubber" in keep else 0))
    _, steps = survey(case.test, case.bearing.total_rubber_thickness, case.starts_at)
    steps = 1.0 + steps / case.analysis.keep_every
    recorded = any(step.step == "recorded" for step in case.test.steps)
    if case.analysis.histories != COMPLETE and not recorded:
        parts = sum(
            step.count + 2 if isinstance(step, Cycles | PlanePath) else 1
            for step in case.test.steps
        )
        steps = min(steps, parts * (POINTS + 4.0))
    return float(row) * steps * len(case.ambient)
