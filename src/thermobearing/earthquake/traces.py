"""Histories of one run of a study, from every step, in the units of the dataset."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import Books
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

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


def traces_of(task: "Task", history: StructureHistory) -> dict[str, Floats]:
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
        "bearing_speed": loading_speed(bearing),
        "bearing_clock": bearing["clock"],
        "bearing_energy": bearing["work_in"],
        "lead_temperature": bearing["lead_temperature"]
        if told.has_lead
        else np.full(count, np.nan),
        "rubber_temperature": history.layers(task.told_line) if heat else np.empty((count, 0)),
        "temperature": history.cells(task.told_line) if heat else np.empty((count, 0)),
    }


def loading_speed(bearing: Rows[Books]) -> Floats:
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
