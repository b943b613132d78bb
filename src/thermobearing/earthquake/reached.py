"""What the runs of a study reached, beside rig, tested range and temperature law: sentences."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import exposure_attribute, exposures, told_of
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.plausible import implausible
from thermobearing.bearing.validity import ranges_of
from thermobearing.core.records import Floats
from thermobearing.cyclic.rig import asked_of, beyond
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.parts import largest
from thermobearing.earthquake.result import run_name
from thermobearing.earthquake.traces import loading_speed
from thermobearing.model.earlier import BLIND
from thermobearing.model.temperature import outside_law
from thermobearing.results.ranges import (
    Ends,
    Row,
    asked_of_tests,
    one_per_cause,
    outside_tests,
    reached_by,
)
from thermobearing.results.writing import as_attribute
from thermobearing.structure.plausible import implausible_structure
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

Traces = Sequence[Mapping[str, Floats]]


def warnings_of(
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
        ranges = ranges_of(bearing)
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
    found = told_of(factors) + found
    rows_of = {"rig": rig, "tested_range": asked, **exposure_attribute(factors)}
    attributes = {name: as_attribute(rows) for name, rows in rows_of.items() if rows}
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
            largest(loading_speed(rows)),
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
        found += asked_of(case.rig, _name(task, task.told.device.bearing.name), peaks)
    return found
