"""What is kept of each run of a study: outcome, peaks over every step, energy books.

The definitions are those of an earthquake analysis (earthquake/measures.py), whose table has the
same columns. Rows of histories are forgotten after each run. `shaken` is the one place where a
study computes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.earthquake.meanings import meaning_of
from thermobearing.earthquake.measures import UNITS, measures_of, residuals_of
from thermobearing.earthquake.parts import warmest
from thermobearing.earthquake.run import run_task
from thermobearing.earthquake.task import Task
from thermobearing.earthquake.traces import HISTORIES, structure_traces, traces_of
from thermobearing.model.outcomes import SENTENCES as RUN_SENTENCES
from thermobearing.structure.run import SENTENCES, StructureHistory

if TYPE_CHECKING:
    from thermobearing.studies.prepare import RunInput

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
COUNTS: Final = ("steps", "iterations", "substeps")
OWN: Final = {  # columns of a study alone: unit, meaning
    "bearing_displacement_residual_mm": ("mm", "displacement of the bearing at the end"),
    "pier_drift_max": ("1", "largest displacement of the pier top over the height of the pier"),
    "deck_displacement_residual_mm": ("mm", "displacement of the deck at the end"),
    "rubber_max_degC": ("degC", "highest temperature of any rubber layer, at mid-thickness"),
    "lead_max_degC": ("degC", "highest temperature of the lead cores"),
    "structure_residual": ("1", "what the energy books of the structure miss, of the input"),
    "mechanical_residual": ("1", "what the books of one bearing miss, of its work"),
    "thermal_residual": ("1", "what its books of heat miss, of its work or heat"),
}


class ResultColumn(NamedTuple):
    """A column of the table of runs that computing fills; `kind`: "text", "count" or "number"."""

    name: str
    unit: str
    meaning: str
    kind: str = "number"


def _columns() -> tuple[ResultColumn, ...]:
    known = {name: long_name for name, _, long_name in HISTORIES}
    measured = [
        ResultColumn(
            name, UNITS[key], meaning_of(key, known), "count" if name in COUNTS else "number"
        )
        for name, key in OF_RUN.items()
    ]
    return (
        ResultColumn("outcome", "", "what ended the run", "text"),
        ResultColumn("sentence", "", "what that means and what to try; empty if completed", "text"),
        *measured,
        *(ResultColumn(name, *about) for name, about in OWN.items()),
    )


RESULT_COLUMNS: Final = _columns()


@dataclass(frozen=True)
class Measured:
    """One run: a value for each of `RESULT_COLUMNS`; its histories where they were asked for."""

    numbers: dict[str, Any]
    traces: Mapping[str, Any] | None = None


def measure(run_input: "RunInput") -> dict[str, Any]:
    """Carry out one run: a value for each of `RESULT_COLUMNS`.

    Never raises for a failed analysis: its outcome says what ended it, and the numbers are those
    until then.

    Parameters
    ----------
    run_input : from `Preparer.run_input`.

    Examples
    --------
    >>> from thermobearing.studies import Preparer, make_study, plan
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> study = make_study(table, "example")
    >>> found = measure(Preparer(study).run_input(plan(study).to_dict("records")[0]))
    >>> found["outcome"], found["steps"]
    ('completed', 400)
    """
    return next(measure_all([run_input])).numbers


def measure_all(inputs: Sequence["RunInput"], *, traces: bool = False) -> Iterator[Measured]:
    """Carry out some runs, each as `measure` does; with `traces` their histories too."""
    for one, history in zip(inputs, shaken(inputs), strict=True):
        found = traces_of(one.task, history) if traces else structure_traces(one.task, history)
        yield Measured(numbers_of(one.task, history, found), found if traces else None)


def shaken(inputs: Sequence["RunInput"]) -> Iterator[StructureHistory]:
    """The runs themselves, in their order; only one is in memory at a time."""
    for one in inputs:
        yield run_task(one.task)


def numbers_of(
    task: Task, history: StructureHistory, traces: Mapping[str, Floats]
) -> dict[str, Any]:
    """A value for each of `RESULT_COLUMNS`."""
    found = measures_of(task, history, traces)
    ended = history.outcome
    sentence = "" if ended == COMPLETED else ALL_SENTENCES.get(ended, "")
    numbers = {name: found[key] for name, key in OF_RUN.items()}
    device, line = task.told.device, task.told_line
    bearing, none = history.bearing(line), np.empty(0)
    heat = device.stack is not None
    lead = heat and device.constants.lead.cores > 0.0
    height = task.prepared.reported.height
    return {
        "outcome": ended,
        "sentence": sentence,
        **numbers,
        "bearing_displacement_residual_mm": bearing["displacement"][-1],
        "pier_drift_max": found["pier_displacement_max"] / height if height > 0.0 else np.nan,
        "deck_displacement_residual_mm": traces["deck_displacement"][-1],
        "rubber_max_degC": warmest(history.layers(line) if heat else none),
        "lead_max_degC": warmest(bearing["lead_temperature"] if lead else none),
        **residuals_of(found),
    }


def not_run(outcome: str, sentence: str) -> dict[str, Any]:
    """A value for each of `RESULT_COLUMNS` of a run that could not be carried out.

    Examples
    --------
    >>> not_run(BAD_INPUT, "K_r must be positive")["steps"]
    0
    """
    empty = {"number": np.nan, "count": 0, "text": ""}
    found: dict[str, Any] = {column.name: empty[column.kind] for column in RESULT_COLUMNS}
    return found | {"outcome": outcome, "sentence": sentence}


def outcome_of(error: Exception) -> tuple[str, str]:
    """Outcome and sentence of a run that raised instead of ending."""
    if isinstance(error, InputError):
        return BAD_INPUT, " ".join(str(error).split())
    return BROKEN, f"a fault of this program: {type(error).__name__}: {error}"
