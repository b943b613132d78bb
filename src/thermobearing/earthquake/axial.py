"""Axial forces of bearings in an analysis: tables of lines, histories, outcomes and sentences."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.measures import pier_peaks
from thermobearing.model.axial import AxialPeak, axial_rows, column_of, uplift_warning
from thermobearing.model.checks import axial_checks, check_rows
from thermobearing.model.outcomes import CAVITATED, NOT_PHYSICAL, UNSTABLE, UPLIFT
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import VALID_UNTIL
from thermobearing.quantities.warned import ASSUMED, EXCEEDED, OTHER, UNUSABLE, Warned
from thermobearing.quantities.words import joined
from thermobearing.results.base import COMPLETED
from thermobearing.results.ranges import Row
from thermobearing.results.writing import as_attribute
from thermobearing.structure.fields import GRAVITY
from thermobearing.structure.model import (
    LIMITS,
    BearingLine,
    Structure,
    carried_mass,
    default_deck_height,
    list_hinges,
    list_piers,
)
from thermobearing.structure.run import AxialHistory, PressedLine, StructureHistory
from thermobearing.structure.types import SectionEnergies, SectionPeak

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from thermobearing.earthquake.result import EarthquakeResult
    from thermobearing.earthquake.run import Task


EARLIER = 1e-9  # [s] by which rounding may move a step
NEAR = 0.8  # of a limit of axial forces, from which on a warning says so
LEAST_STEPS = 10.0  # of a period of vertical motion
WEIGHT_TOLERANCE = 0.2  # of the weight above all bearing lines: of the sum of dead loads


def pressed_line(
    case: EarthquakeCase, line: BearingLine, bearing: Bearing | BilinearBearing
) -> PressedLine | None:
    """Return the axial forces of a line; None where they do not act."""
    table, level = line.axial, case.analysis.axial
    if table is None or not case.analysis.has_axial or not isinstance(bearing, Bearing):
        return None
    loads = np.array(table.dead_loads(line.count))
    moves = level != "dead"
    return PressedLine(
        columns=column_of(bearing, case.analysis.axial_factor or "overlap"),
        dead_loads=loads,
        places=np.array(table.places if moves and table.places else [0.0] * line.count),
        moves=moves,
        overturns=moves,
        height=table.deck_height or default_deck_height(case.structure, line),
        dowelled=table.joint == "dowelled",
        dowel_length=table.dowel_length or 0.0,
        mass=table.mass or float(loads.sum()) / GRAVITY,
        damping_ratio=table.damping_ratio,
        span_stiffness=table.span_stiffness or 0.0,
        roll_inertia=table.roll_inertia or 0.0,
    )


AXIAL_LINE, SUPPORT = "axial_line", "support"  # dimensions: lines, and all their bearings


def axial_histories(
    runs: Sequence[tuple["Task", StructureHistory]], keep_every: int
) -> dict[str, tuple[str, list[Floats]]]:
    """Return dimension and kept rows of axial forces and of their limits, by variable.

    Empty where axial forces do not act. The cavitation force is NaN for bearings that lift.
    """
    acting = [history.axial for _, history in runs if history.axial is not None]
    if not acting or len(acting) < len(runs):
        return {}
    return {
        "axial_force": (SUPPORT, [axial.force[::keep_every] for axial in acting]),
        "critical_load": (AXIAL_LINE, [axial.limit[::keep_every] for axial in acting]),
        "cavitation_force": (
            AXIAL_LINE,
            [_cavitation_forces(*run)[::keep_every] for run in runs],
        ),
    }


def _cavitation_forces(task: "Task", history: StructureHistory) -> Floats:
    """Return the tension at which the bearings of each line cavitate [kN], in kept rows."""
    assert history.axial is not None
    columns = []
    for number in history.axial.lines:
        line, installed = task.case.structure.bearings[number], task.lines[number]
        load = pressed_line(task.case, line, installed.device.bearing)
        moved = history.bearing(number)["displacement"]
        assert load is not None
        if load.dowelled:
            columns.append(np.full(len(moved), np.nan))
            continue
        constants, rubber = installed.device.constants, history.layers(number)
        rows = axial_rows(load.columns, constants, moved, np.zeros(len(moved)), rubber)
        columns.append(rows["cavitation_force"] / line.scale**2)
    return np.stack(columns, axis=1)


def axial_coordinates(runs: Sequence[tuple["Task", StructureHistory]]) -> dict[str, Any]:
    """Return the line of each column of the variables of `axial_histories`."""
    task, history = runs[0]
    lines = task.case.structure.bearings
    numbers = history.axial.lines if history.axial is not None else []
    supports = [lines[number].name for number in numbers for _ in range(lines[number].count)]
    names = [lines[number].name for number in numbers]
    return {AXIAL_LINE: np.array(names, dtype=str), SUPPORT: np.array(supports, dtype=str)}


def is_unstable(axial: AxialHistory | None) -> bool:
    """Return whether a bearing passed its critical load, or the force of a line fell beyond it."""
    if axial is None:
        return False
    peaks: Any = axial.peaks
    return bool((peaks["first"] >= 0.0).any() or (peaks["falling"] >= 0.0).any())


def first_exceedance(peak: SectionPeak) -> float:
    """Return when the first bearing of a line became unstable [s]; NaN if it did not."""
    moments = [float(moment) for moment in (peak.first, peak.falling) if moment >= 0.0]
    return min(moments, default=math.nan)


def with_axial_outcome(outcome: str, axial: AxialHistory | None) -> str:
    """Return the outcome of a run that reached its end, with that of its axial forces."""
    if axial is None:
        return outcome
    peaks: Any = axial.peaks
    sections: Any = axial.sections
    # The cause before its effects: a bearing that buckles may then move farther than is physical.
    if is_unstable(axial) or (outcome != NOT_PHYSICAL and peaks["unbalanced"].any()):
        return UNSTABLE
    if outcome != COMPLETED:
        return outcome
    stated = sections["dowel_length"] > 0.0
    if (stated & (peaks["uplift"] > sections["dowel_length"])).any():
        return UPLIFT
    return CAVITATED if (peaks["tension"] > 1.0).any() else outcome


def _pressed_lines(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> Iterator[tuple["Task", int, SectionPeak, SectionEnergies]]:
    """Yield run, line, peaks and works of all lines whose axial forces acted, run by run."""
    for task, history in zip(tasks, histories, strict=True):
        if history.axial is not None:
            for a, number in enumerate(history.axial.lines):
                yield task, number, history.axial.peaks[a], history.axial.energies[a]


def axial_messages(tasks: Sequence["Task"], histories: Sequence[StructureHistory]) -> list[Warned]:
    """Return warnings of bearings that pass a limit of their axial force.

    Lines of a run with the same sentence, such as those of equal piers, share one.
    """
    lines: dict[tuple[str, Warned], list[str]] = {}
    for task, history in zip(tasks, histories, strict=True):
        for a, number in enumerate(history.axial.lines if history.axial is not None else ()):
            line = task.case.structure.bearings[number]
            for warning in _line_messages(history, a, line.count):
                lines.setdefault((task.label(), warning), []).append(line.name)
    return [
        Warned(f"{joined(names)}{warning.format(run=run)}", warning.code, warning.effect)
        for (run, warning), names in lines.items()
    ]


def _line_messages(history: StructureHistory, a: int, count: int) -> list[Warned]:
    """Return warnings of the bearings of a line, without its name and with a place for the run."""
    assert history.axial is not None
    peak, messages = history.axial.peaks[a], []

    def warn(code: str, effect: float, sentence: str) -> None:
        messages.append(Warned(sentence, code, effect))

    if peak.first >= 0.0:
        warn("unstable", UNUSABLE, _unstable_message(history, a, count))
    elif peak.falling >= 0.0:
        warn(
            "unstable",
            UNUSABLE,
            " ({run}): unstable, the shear force falls as the displacement grows from "
            f"{peak.falling:.4g} s on",
        )
    elif peak.unbalanced > 0.0:
        warn(
            "unstable",
            UNUSABLE,
            " ({run}): unstable, the overturning moment exceeds what the bearings can balance in "
            f"{peak.unbalanced:.0f} steps",
        )
    elif peak.share > NEAR:
        warn(
            "near_critical_load",
            OTHER,
            f", bearing {peak.share_bearing + 1:.0f} of {count} ({{run}}): reaches "
            f"{peak.share:.2f} of its critical load at {peak.share_time:.4g} s and "
            f"{peak.share_x:.3g} mm, with an axial force of {peak.share_force:.4g} kN",
        )
    least = f", bearing {peak.least_bearing + 1:.0f} of {count} ({{run}}): "
    if peak.uplift > 0.0:
        messages.append(uplift_warning(least, float(peak.least_time), float(peak.uplift)))
    if peak.tension > 1.0:
        warn(
            "cavitated",
            EXCEEDED,
            f"{least}the rubber cavitates, with a damage of {peak.damage:.0%} and a tension of up "
            f"to {-peak.least:.4g} kN",
        )
    elif peak.tension > NEAR:
        warn(
            "near_cavitation",
            OTHER,
            f"{least}reaches {peak.tension:.2f} of the tension at which its rubber cavitates at "
            f"{peak.least_time:.4g} s, with {-peak.least:.4g} kN",
        )
    return messages


def p_delta_messages(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Warned]:
    """Return a warning for each pier whose dead load takes a large share of its yield moment."""
    largest: dict[str, tuple[float, float, str]] = {}
    for task, history in zip(tasks, histories, strict=True):
        structure = task.case.structure
        hinges, peaks = list_hinges(structure), pier_peaks(task, history)
        for pier, row in zip(list_piers(structure), peaks, strict=True):
            load = dead_load_on(structure, pier.name)
            displacements = np.atleast_1d(row["pier_part_displacement_max"])
            for number, displacement in zip(pier.hinges, displacements, strict=False):
                if number is not None:
                    share = load * float(displacement) / hinges[number].yield_moment
                    named = share, float(displacement), task.label()
                    largest[pier.name] = max(largest.get(pier.name, named), named)
    remedy = "p_delta = true of the structure adds P-delta"
    if tasks and tasks[0].case.structure.p_delta:
        remedy = "check the P-delta of the pier"
    limit = LIMITS["p_delta"]["value"]
    return [
        Warned(
            f"the dead load of its bearing lines at {displacement:.0f} mm makes {share:.0%} of the "
            f"yield moment of the pier ({label}), more than {limit:.0%}; {remedy}",
            "p_delta",
            EXCEEDED,
            name,
        )
        for name, (share, displacement, label) in largest.items()
        if share > limit
    ]


def dead_load_on(structure: Structure, name: str) -> float:
    """Return the dead load of the bearing lines on a body, as far as it is stated [kN]."""
    return sum(line.dead_load for line in structure.bearings if line.base == name)


def _unstable_message(history: StructureHistory, a: int, count: int) -> str:
    """Return where a line is first above its critical load: what comes later is no result."""
    axial = history.axial
    assert axial is not None
    section, peak = axial.sections[a], axial.peaks[a]
    moved = history.bearing(axial.lines[a])
    # The first kept row from that step on; in studies, which keep fewer, it may be later.
    row = min(int(np.searchsorted(moved["clock"], peak.first - EARLIER)), len(moved) - 1)
    forces, limit = axial.force[row, int(section.first) : int(section.last)], axial.limit[row, a]
    place, offset = place_of_largest(forces), np.linalg.norm(moved["displacement"][row])
    return (
        f", bearing {place + 1} of {count} ({{run}}): unstable from {peak.first:.4g} s on, with an "
        f"axial force of {forces[place]:.4g} kN and a critical load of {limit:.4g} kN at "
        f"{offset:.3g} mm; the line as a whole is then at {forces.sum() / (count * limit):.2f} of "
        f"its critical load. Bearings of the line are above it for {peak.exceeded:.3g} s"
    )


def loading_messages(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Warned]:
    """Return warnings on the table of axial forces: dead loads, and steps of vertical motion."""
    messages: list[Warned] = []
    if case.analysis.has_axial and (sentence := _weight_message(case)):
        messages.append(Warned(sentence, "dead_loads", ASSUMED))
    shortest: dict[str, tuple[float, float]] = {}
    for task, history in zip(tasks, histories, strict=True):
        if history.axial is not None and case.analysis.axial == "vertical":
            for number, period in zip(
                history.axial.lines, _vertical_periods(history.axial), strict=True
            ):
                name = case.structure.bearings[number].name
                pair = period / task.shaking.dt, period
                shortest[name] = min(pair, shortest.get(name, pair))
    if steep := {name: pair for name, pair in shortest.items() if pair[0] < LEAST_STEPS}:
        name, (steps, period) = min(steep.items(), key=lambda item: item[1])
        sentence = (
            f"the vertical period of the bearings ({joined(list(steep))}; shortest {period:.3g} s, "
            f"{name}) has {steps:.1f} steps, fewer than {LEAST_STEPS:g}: extremes of axial forces "
            f"are uncertain; give analysis.dt = {_rounded_down(1e3 * period / LEAST_STEPS):g} ms"
        )
        messages.append(Warned(sentence, "vertical_steps", ASSUMED))
    return messages


def _weight_message(case: EarthquakeCase) -> str:
    """Return a sentence where dead loads of all lines are not the weight above them."""
    lines = case.structure.bearings
    weight = GRAVITY * carried_mass(case.structure)
    if not weight or any(line.axial is None for line in lines):
        return ""
    loads = sum(line.dead_load for line in lines)
    if abs(loads - weight) <= WEIGHT_TOLERANCE * weight:
        return ""
    return (
        f"dead loads of the bearing lines are {loads:.4g} kN, and the masses above them weigh "
        f"{weight:.4g} kN: check dead_load (on each bearing) and the masses"
    )


def _vertical_periods(axial: AxialHistory) -> list[float]:
    """Return the shorter period of vertical motion and roll of each line, at the start [s]."""
    periods = []
    for a in range(len(axial.lines)):
        section = axial.sections[a]
        bearings = slice(int(section.first), int(section.last))
        stiffness = axial.force[0, bearings] / axial.supports["offset"][bearings]
        of_line, span = float(stiffness.sum()), float(section.span_stiffness)
        if span > 0.0:
            of_line = 1.0 / (1.0 / of_line + 1.0 / span)
        period = math.sqrt(float(section.mass) / of_line)
        if section.roll_inertia > 0.0:
            of_roll = float((stiffness * axial.supports["place"][bearings] ** 2).sum())
            period = min(period, math.sqrt(float(section.roll_inertia) / of_roll))
        periods.append(2.0 * math.pi * period)
    return periods


def _rounded_down(value: float) -> float:
    """Return a number with one digit that is not larger."""
    digit = 10.0 ** math.floor(math.log10(value))
    return math.floor(value / digit) * digit


def axial_check_rows(
    case: EarthquakeCase, tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[Row]:
    """Return the checks of axial forces that acted in the analysis, of every line in every run."""
    rows: list[Row] = []
    several = len(case.structure.bearings) > 1
    for task, number, peak, _ in _pressed_lines(tasks, histories):
        name = case.structure.bearings[number].name if several else ""
        bearing = task.lines[number].device.bearing.name
        rows += check_rows(task.label(bearing), bearing, axial_checks(section_peaks(peak), name))
    return rows


def section_peaks(peak: SectionPeak) -> dict[str, AxialPeak]:
    """Return the peaks of a line in a run, as `axial_checks` takes them."""
    first = float(peak.first) if peak.first >= 0.0 else math.nan
    force, limit = float(peak.share_force), float(peak.share_limit)
    shares = float(peak.share), force, limit, float(peak.share_time), first, float(peak.exceeded)
    peaks = {"analysis": AxialPeak(*shares)}
    if peak.least < 0.0:
        tension, strength = -float(peak.least), float(peak.cavitation_force)
        moment = float(peak.least_time)
        peaks["cavitation"] = AxialPeak(
            tension / strength, tension, strength, moment, math.nan, 0.0
        )
    return peaks


def axial_attribute(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> dict[str, str | int | float]:
    """Return the extremes of axial forces as an attribute of a dataset; none where none act."""
    extremes = _axial_extremes(tasks, histories)
    return {"axial": as_attribute(extremes)} if extremes else {}


def _axial_extremes(
    tasks: Sequence["Task"], histories: Sequence[StructureHistory]
) -> list[dict[str, Any]]:
    """Return the extremes of the axial forces of each line in each run."""
    rows = []
    for task, number, peak, works in _pressed_lines(tasks, histories):
        rows.append(
            {
                "run": task.label(task.device.bearing.name),
                "line": task.case.structure.bearings[number].name,
                "critical_share": float(peak.share),
                "axial_bearing": int(peak.share_bearing) + 1,
                "axial_time_s": float(peak.share_time),
                "axial_displacement_mm": float(peak.share_x),
                "axial_force_kN": float(peak.share_force),
                "critical_load_kN": float(peak.share_limit),
                "axial_first_s": first_exceedance(peak),
                "axial_exceeded_s": float(peak.exceeded),
                "critical_share_line": float(peak.line_share),
                "axial_force_min_kN": float(peak.least),
                "axial_least_bearing": int(peak.least_bearing) + 1,
                "axial_least_time_s": float(peak.least_time),
                "cavitation_share": float(peak.tension),
                "uplift_mm": float(peak.uplift),
                "cavitation_damage": float(peak.damage),
                "lent_kN_mm": float(works.lent),
            }
        )
    return rows


AXIAL_COLUMNS = (  # of the table of runs of a study
    "critical_share",
    "axial_force_min_kN",
    "cavitation_share",
    "uplift_mm",
)


def run_extremes(axial: AxialHistory | None) -> dict[str, float]:
    """Return `AXIAL_COLUMNS` of a run, of all lines; nothing where axial forces do not act."""
    if axial is None:
        return {}
    peaks: Any = axial.peaks
    largest = [float(peaks[name].max()) for name in ("share", "tension", "uplift")]
    values = largest[0], float(peaks["least"].min()), *largest[1:]
    return dict(zip(AXIAL_COLUMNS, values, strict=True))


def axial_table(rows: "pd.DataFrame") -> Table:
    """Return the extremes of axial forces that act on the shear force, of each line and run."""
    names = [] if rows.empty else [str(name) for name in rows]
    return make_table(rows, names, "Axial forces of the bearings", keys=2)


def axial_forces_change(dataset: "xr.Dataset") -> bool:
    """Return whether axial forces of an analysis change in time."""
    if "axial_force" not in dataset:
        return False
    forces = dataset["axial_force"].values
    return bool((np.fmax.reduce(forces, axis=1) > np.fmin.reduce(forces, axis=1)).any())


def governing_axial_line(result: "EarthquakeResult") -> str:
    """Return the line with the bearing that comes nearest to a limit of its axial force.

    The limits are its critical load, and no axial force at all, by the share of its dead load that
    it loses.
    """
    forces, supports = result["axial_force"].values, result[SUPPORT].values
    lost = np.fmax.reduce(1.0 - np.fmin.reduce(forces, axis=1) / forces[:, 0], axis=0)
    pressed = result.axial.groupby("line")["critical_share"].max()
    names = [str(name) for name in result[AXIAL_LINE].values]
    nearest = [max(float(lost[supports == name].max()), float(pressed[name])) for name in names]
    return names[place_of_largest(nearest)]


def valid_until(result: "EarthquakeResult") -> Floats:
    """Return when the first bearing became unstable in each run [s]; NaN where none did."""
    rows = result.axial
    if rows.empty:
        return np.full(result.runs, np.nan)
    first = rows.groupby("run")["axial_first_s"].min()
    return np.array([float(first.get(name, np.nan)) for name in result.run_names])


def with_validity(frame: "pd.DataFrame", result: "EarthquakeResult") -> "pd.DataFrame":
    """Return a table with the time when its runs became unstable, if any did.

    It has as many rows for each run, in the order of the runs.
    """
    moments = np.repeat(valid_until(result), len(frame) // max(result.runs, 1))
    return frame.assign(**{VALID_UNTIL: moments}) if np.isfinite(moments).any() else frame
