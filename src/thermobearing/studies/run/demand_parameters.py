"""Engineering demand parameters of a run.

The definitions are those of an earthquake analysis (earthquake/measures.py), whose table has the
same columns; the register has their units and meanings. Rows of histories are forgotten after each
run; in lockstep there are none. `measure_all` is the one place where a study computes.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.earthquake.measures import (
    BEARING,
    KN_MM_PER_KN_M,
    MM_PER_M,
    STRUCTURE_ENERGIES,
    compute_measures,
    compute_residuals,
    drift,
    farthest,
    governing_peaks,
    history_traces,
    line_peaks,
    pier_peaks,
    structure_traces,
)
from thermobearing.earthquake.run import Task, judged, lines_to_shake, run_task
from thermobearing.model.outcomes import SENTENCES as RUN_SENTENCES
from thermobearing.structure.lanes import Run, RunPeaks, run_lanes
from thermobearing.structure.run import SENTENCES, StructureHistory

COMPLETED: Final = "completed"
BAD_INPUT: Final = "bad_input"  # a drawn number that makes no bearing, no structure
BROKEN: Final = "broken"  # a fault of this program
ALL_SENTENCES: Final = RUN_SENTENCES | SENTENCES
OF_RUN: Final = {  # columns that an earthquake analysis measures too: name there
    "bearing_displacement_max_mm": "bearing_displacement_max",
    "bearing_strain_max": "bearing_strain_max",
    "bearing_force_max_kN": "bearing_force_max",
    "bearing_energy_kN_mm": "bearing_energy_end",
    "bearing_heat_kN_mm": "heat_heat_released",
    "pier_displacement_max_mm": "pier_displacement_max",
    "pier_displacement_residual_mm": "pier_displacement_residual",
    "pier_rotation_max_rad": "pier_rotation_max",
    "pier_ductility": "pier_ductility",
    "pier_moment_max_kN_m": "pier_moment_max",
    "pier_top_displacement_max_mm": "pier_top_displacement_max",
    "pier_top_acceleration_max_m_s2": "pier_top_acceleration_max",
    "deck_displacement_max_mm": "deck_displacement_max",
    "deck_acceleration_max_m_s2": "deck_acceleration_max",
    "layer_force_mismatch_max_kN": "layer_force_mismatch_max",
    "steps": "steps",
    "iterations": "iterations",
    "substeps": "substeps",
}
TEXTS: Final = ("outcome", "sentence")
COUNTS: Final = ("steps", "iterations", "substeps")
RESULT_COLUMNS: Final = (  # of the table of runs, that computing fills
    *TEXTS,
    *OF_RUN,
    "bearing_displacement_residual_mm",
    "pier_drift_max",
    "deck_displacement_residual_mm",
    "rubber_max_degC",
    "lead_max_degC",
    "structure_residual",
    "mechanical_residual",
    "thermal_residual",
)
DECK: Final = -1  # watched last in a run without rows; before it each pier and its top
DRIFTS: Final = "pier_part_displacement_max"


class Measured(NamedTuple):
    """One run: a value for each of `RESULT_COLUMNS`; its histories where they are kept."""

    numbers: dict[str, Any]
    traces: Mapping[str, Any] | None = None


def measure(task: Task) -> dict[str, Any]:
    """Carry out one run and return a value for each of `RESULT_COLUMNS`.

    A failed analysis does not raise: its outcome says what ended it, and the numbers are those
    until then.
    """
    return next(measure_all([task])).numbers


def measure_all(
    tasks: Sequence[Task], *, traces: bool = False, lockstep: bool = False
) -> Iterator[Measured]:
    """Carry out some runs, each as `measure` does; with `traces` keep their histories.

    With `lockstep` those of one shape run side by side; the result of each depends on its own
    input only, and differs from `measure` by rounding.
    """
    if lockstep and not traces:
        for task, peaks in zip(tasks, run_lanes([_to_shake(task) for task in tasks]), strict=True):
            yield Measured(_numbers_of_peaks(task, peaks))
        return
    for task in tasks:
        history = run_task(task)
        found = history_traces(task, history) if traces else structure_traces(task, history)
        yield Measured(_numbers(task, history, found), found if traces else None)


def _to_shake(task: Task) -> Run:
    """Return a run for its peaks only: every pier, its top, and the deck are watched."""
    piers, shaking = task.prepared.piers, task.shaking
    watched = [row for _, top, base in piers for row in (top - base, top)]
    return Run(
        task.prepared,
        lines_to_shake(task),
        shaking.ground,
        shaking.dt,
        task.ambient,
        places=np.array([*watched, task.prepared.reported.deck]),
        carried=np.array([*[0.0, 1.0] * len(piers), 1.0]),  # the ground carries tops and deck
        method=task.case.analysis.method,
    )


def _numbers(task: Task, history: StructureHistory, traces: Mapping[str, Floats]) -> dict[str, Any]:
    lines, piers = line_peaks(task, history), pier_peaks(task, history)
    return _row(
        task,
        compute_measures(task, history, traces, (lines, piers)),
        left=[history.bearing(b)["displacement"][-1] for b in range(len(lines))],
        tops=[row[DRIFTS] for row in piers],
        deck=traces["deck_displacement"][-1],
        rubber=(line["line_rubber_temperature_max"] for line in lines),
        lead=(line["line_lead_temperature_max"] for line in lines),
    )


def _numbers_of_peaks(task: Task, peaks: RunPeaks) -> dict[str, Any]:
    """Return a value for each of `RESULT_COLUMNS`, of a run without rows."""
    found = _measures_of_peaks(task, peaks)
    tops = peaks.watches["displacement"][:DECK:2].tolist()
    if peaks.outcome == COMPLETED:
        moved, turned = peaks.lines["displacement"], peaks.hinges["rotation"]
        found["outcome"] = judged(task, moved.tolist(), turned.tolist(), tops)
    each = list(zip(_named(peaks.lines), [one.device for one in task.lines], strict=True))
    return _row(
        task,
        found,
        left=peaks.bearings["displacement"],
        tops=tops,
        deck=peaks.watches["residual"][DECK],
        rubber=(peak["rubber_temperature"] for peak, one in each if one.heats),
        lead=(peak["lead_temperature"] for peak, one in each if one.has_lead),
    )


def _named(rows: Any) -> list[dict[str, float]]:
    """Return the numbers of records by name: reading them one by one from numpy takes long."""
    return [dict(zip(rows.dtype.names, row, strict=True)) for row in rows.tolist()]


def _measures_of_peaks(task: Task, peaks: RunPeaks) -> dict[str, Any]:
    """Return what `compute_measures` does of a run with rows; its bearings begin at rest."""
    bearings, lines = _named(peaks.bearings), _named(peaks.lines)
    bearing, books = bearings[task.reported_line], _named(peaks.books)[0]
    *piers, deck = _named(peaks.watches)
    of_lines = [
        {
            "line_displacement_max": peak["displacement"],
            "line_strain_max": peak["displacement"] / one.device.bearing.total_rubber_thickness,
            "line_force_max": peak["force"],
            "line_energy_end": end["work_in"],
        }
        for peak, end, one in zip(lines, bearings, task.lines, strict=True)
    ]
    of_piers = [
        {
            "pier_part_displacement_max": piers[2 * k]["displacement"],
            "pier_part_displacement_residual": piers[2 * k]["residual"],
            "pier_part_top_displacement_max": piers[2 * k + 1]["displacement"],
            "pier_part_top_acceleration_max": piers[2 * k + 1]["acceleration"] / MM_PER_M,
            **_hinge_peaks(task, peaks, pier.hinge),
        }
        for k, (pier, _, _) in enumerate(task.prepared.piers)
    ]
    return {
        "outcome": peaks.outcome,
        **governing_peaks(of_lines),
        **governing_peaks(of_piers),
        "deck_displacement_max": deck["displacement"],
        "deck_acceleration_max": deck["acceleration"] / MM_PER_M,
        "layer_force_mismatch_max": lines[task.reported_line]["mismatch"],
        **{name: getattr(peaks, name) for name in COUNTS},
        **{f"energy_{name}": books[name] for name in STRUCTURE_ENERGIES},
        **{f"heat_{name}": bearing[name] for name in BEARING},
    }


def _hinge_peaks(task: Task, peaks: RunPeaks, hinge: int | None) -> dict[str, float]:
    rotation = moment = limit = np.nan
    if hinge is not None:
        found, limit = _named(peaks.hinges)[hinge], task.case.structure.hinges[hinge].yield_rotation
        rotation, moment = found["rotation"], found["moment"] / KN_MM_PER_KN_M
    return {
        "pier_part_rotation_max": rotation,
        "pier_part_ductility": rotation / limit,
        "pier_part_moment_max": moment,
    }


def _row(
    task: Task,
    found: Mapping[str, Any],
    *,
    left: Any,
    tops: Sequence[float],
    deck: float,
    rubber: Iterable[float],
    lead: Iterable[float],
) -> dict[str, Any]:
    """Return all columns, of `compute_measures` and of what only a study has.

    `left` are residual displacements of the lines, `tops` the largest ones of the piers, `rubber`
    and `lead` the highest temperatures of the lines.
    """
    ended = found["outcome"]
    return {
        "outcome": ended,
        "sentence": "" if ended == COMPLETED else ALL_SENTENCES.get(ended, ""),
        **{name: found[key] for name, key in OF_RUN.items()},
        "bearing_displacement_residual_mm": float(farthest(left)),
        "pier_drift_max": drift(task, tops),
        "deck_displacement_residual_mm": deck,
        "rubber_max_degC": _hottest(rubber),
        "lead_max_degC": _hottest(lead),
        **compute_residuals(found),
    }


def _hottest(values: Iterable[float]) -> float:
    return max((float(value) for value in values if value == value), default=np.nan)


def not_run(outcome: str, sentence: str) -> dict[str, Any]:
    """Return a value for each of `RESULT_COLUMNS` of a run that could not be carried out."""
    found = {name: 0 if name in COUNTS else np.nan for name in RESULT_COLUMNS}
    return found | {"outcome": outcome, "sentence": sentence}


def error_outcome(error: Exception) -> tuple[str, str]:
    """Return outcome and sentence of a run that raised instead of ending."""
    if isinstance(error, InputError):
        return BAD_INPUT, " ".join(str(error).split())
    return BROKEN, f"a fault of this program: {type(error).__name__}: {error}"
