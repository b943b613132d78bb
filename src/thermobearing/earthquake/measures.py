"""The numbers of one run: outcome, peaks of every step, energy books at the end, largest loop."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.core.records import Floats, labels
from thermobearing.earthquake.columns import BEARING, STRUCTURE
from thermobearing.earthquake.meanings import PEAK
from thermobearing.earthquake.parts import governing_peaks, largest, line_peaks, pier_peaks
from thermobearing.results.largest_loop import largest_loop
from thermobearing.results.metrics import LEAST_ENERGY, LEAST_HEAT
from thermobearing.structure.run import StructureHistory
from thermobearing.structure.types import MotionBooks

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

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
LOOP_TIMES = ("loop_start", "loop_end")  # [s]
STRUCTURE_ENERGIES: Final = tuple(
    label.name for label in labels(MotionBooks) if label.unit == "kN mm"
)
UNITS: Final = {
    "outcome": "",
    "bearing_strain_max": "1",
    "bearing_displacement_max": "mm",
    "bearing_force_max": "kN",
    "bearing_energy_end": "kN mm",
    "pier_displacement_max": "mm",
    "pier_top_displacement_max": "mm",
    "pier_displacement_residual": "mm",
    "pier_rotation_max": "rad",
    "pier_moment_max": "kN m",
    "deck_displacement_max": "mm",
    "deck_acceleration_max": "m/s2",
    "pier_top_acceleration_max": "m/s2",
    "steps": "1",
    "iterations": "1",
    "substeps": "1",
    "pier_ductility": "1",
    **{f"energy_{name}": "kN mm" for name in STRUCTURE_ENERGIES},
    **{f"heat_{name}": "kN mm" for name in BEARING},
    "layer_force_mismatch_max": "kN",
}
PEAKS: Final = tuple(n for n in UNITS if n.endswith(PEAK) and n.startswith("deck_"))
LOOP_UNITS: Final = {name: unit for name, (_, unit) in LOOP.items()} | dict.fromkeys(
    LOOP_TIMES, "s"
)


def measures_of(
    task: "Task", history: StructureHistory, trace: Mapping[str, Floats]
) -> dict[str, Any]:
    """Return what `UNITS` names, of one run: the peaks of the line or pier that goes farthest.

    Heat and the mismatch of layers are those of the line whose histories are kept.

    Parameters
    ----------
    task, history : what was run, and what came out.
    trace : its histories, from `structure_traces` or `traces_of`.
    """
    bearing, books = history.bearing(task.told_line), history.rows.books
    found: dict[str, Any] = {name: largest(trace[name.removesuffix(PEAK)]) for name in PEAKS}
    found |= governing_peaks(line_peaks(task, history))
    found |= governing_peaks(pier_peaks(task, history))
    found["outcome"] = history.outcome
    found["steps"] = history.steps
    found["iterations"] = history.iterations
    found["substeps"] = history.substeps
    for name in STRUCTURE_ENERGIES:
        found[f"energy_{name}"] = books[name][-1]
    if task.case.laboratory is not None:
        found["energy_actuator"] = actuator_work(task, history)
    for name in BEARING:
        column = bearing[name]
        found[f"heat_{name}"] = column[-1] - column[0]
    found["layer_force_mismatch_max"] = bearing["layer_force_mismatch"].max()
    return found


def actuator_work(task: "Task", history: StructureHistory) -> float:
    """Return the work of the structure that does not reach the specimen [kN mm].

    The structure feels the measured force at its own displacement, which a delayed actuator has not
    reached; the error of the force counts too. Negative where they feed energy to the structure.
    """
    found = -float(history.rows.books["bearings"][-1])
    lines = enumerate(
        zip(task.case.structure.bearings, task.prepared.matrices.line_rows, strict=True)
    )
    for b, (line, row) in lines:
        force = history.bearing(b)["force"]
        felt = force - force[0]
        if task.noise is not None:
            felt[1:] += task.noise[: len(felt) - 1]
        work = 0.5 * (felt[1:] + felt[:-1]) @ np.diff(history.rows.q @ row)
        found += line.count / line.scale**2 * float(work)
    return found


def residuals_of(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """What is missing from the books of `measures_of`, see `EarthquakeResult.energy`.

    Parameters
    ----------
    numbers : energies of the structure and of one bearing at the end, of one run or as columns.
    """
    given = numbers["energy_input"]
    spent = sum(numbers.get(f"energy_{name}", 0.0) for name in STRUCTURE[1:])
    work, released = numbers["heat_work_in"], numbers["heat_heat_released"]
    stored = numbers["heat_heat_stored"]
    lost = numbers["heat_heat_lost_ends"] + numbers["heat_heat_lost_sides"]
    moved = np.maximum(np.abs(work), LEAST_ENERGY)
    heat = np.maximum(np.maximum(np.abs(stored), np.abs(lost)), LEAST_HEAT)
    return {
        "structure_residual": (given - spent) / np.maximum(np.abs(given), LEAST_ENERGY),
        "mechanical_residual": (work - released - numbers["heat_recoverable"]) / moved,
        "thermal_residual": (released - stored - lost) / np.maximum(moved, heat),
    }


def loop_measures(task: "Task", trace: Mapping[str, Floats]) -> dict[str, float]:
    """What `LOOP_UNITS` names: the largest loop of one bearing; NaN where none is closed."""
    bearing = task.told.device.bearing
    area = None if isinstance(bearing, BilinearBearing) else bearing.area
    loop = largest_loop(
        trace["bearing_displacement"],
        trace["bearing_force"],
        trace["bearing_energy"],
        area=area or 1.0,
        total_rubber_thickness=bearing.total_rubber_thickness,
    )
    if loop is None:
        return dict.fromkeys(LOOP_UNITS, np.nan)
    values = vars(loop.measures)
    if area is None:  # of a bilinear one
        values = values | {"G_eq_MPa": np.nan}
    found = {name: values[key] for name, (key, _) in LOOP.items()}
    ends = trace["time"][[loop.first, loop.last]]
    return found | dict(zip(LOOP_TIMES, ends, strict=True))
