"""Peak responses of a run: names, units, factors, meanings and values."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.core.records import Floats, labels
from thermobearing.core.types import Books
from thermobearing.earthquake.parts import governing_peaks, largest, line_peaks, pier_peaks
from thermobearing.results.metrics import LEAST_ENERGY, LEAST_HEAT, largest_loop
from thermobearing.structure.run import StructureHistory
from thermobearing.structure.types import MotionBooks

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

OWN: Final = {
    "outcome": "what ended the run",
    "energy_actuator": "work that delay and force error of the actuator take, at the end",
    "bearing_energy_end": "work done on one bearing at the end",
    "pier_displacement_residual": "displacement of the pier top relative to its base at the end",
    "steps": "steps of the run",
    "iterations": "iterations of Newton's method in the whole run",
    "substeps": "halvings of steps in the whole run",
    "pier_ductility": "largest rotation of the hinge over its yield rotation",
    "layer_force_mismatch_max": "largest difference of a layer law from the force",
    "loop_force_max": "largest force of the largest loop",
    "loop_force_min": "smallest force of the largest loop",
    "loop_displacement_max": "largest displacement of the largest loop",
    "loop_displacement_min": "smallest displacement of the largest loop",
    "loop_stiffness": "equivalent stiffness of the largest loop",
    "loop_damping_ratio": "equivalent damping ratio of the largest loop",
    "loop_modulus": "equivalent shear modulus of the largest loop",
    "loop_energy": "energy of the largest loop",
    "loop_start": "time when the largest loop begins",
    "loop_end": "time when the largest loop ends",
}
PEAK: Final = "_max"  # of a history
ENERGY, HEAT = "energy_", "heat_"  # of the structure, of one bearing


def describe_quantity(name: str, histories: Mapping[str, str]) -> str:
    """What a number of a run is.

    Parameters
    ----------
    name : of its variable.
    histories : what each history is, by name.

    Examples
    --------
    >>> describe_quantity("bearing_force_max", {"bearing_force": "force of one bearing"})
    'largest force of one bearing'
    >>> describe_quantity("energy_input", {})
    'work of the ground, on motion relative to it, at the end'
    """
    if name in OWN:
        return OWN[name]
    for prefix, books in ((ENERGY, MotionBooks), (HEAT, Books)):
        meanings = {f"{prefix}{label.name}": label.meaning for label in labels(books)}
        if name in meanings:
            return f"{meanings[name].removesuffix(' now')}, at the end"
    return f"largest {histories[name.removesuffix(PEAK)]}"


BEARING = (
    "work_in",
    "heat_released",
    "recoverable",
    "heat_stored",
    "heat_lost_ends",
    "heat_lost_sides",
)
# Of the actuator: in a laboratory only.
STRUCTURE = ("input", "kinetic", "damping", "springs", "hinges", "bearings", "actuator")
COLUMNS = {  # of the table: name in the dataset, factor
    "bearing_strain_max": ("bearing_strain_max", 1.0),
    "bearing_force_max_kN": ("bearing_force_max", 1.0),
    "bearing_energy_kN_mm": ("bearing_energy_end", 1.0),
    "pier_displacement_max_mm": ("pier_displacement_max", 1.0),
    "pier_ductility": ("pier_ductility", 1.0),
    "pier_moment_max_kN_m": ("pier_moment_max", 1.0),
    "deck_displacement_max_mm": ("deck_displacement_max", 1.0),
    "deck_acceleration_max_m_s2": ("deck_acceleration_max", 1.0),
    "pier_top_acceleration_max_m_s2": ("pier_top_acceleration_max", 1.0),
    "pier_top_displacement_max_mm": ("pier_top_displacement_max", 1.0),
    "pier_displacement_residual_mm": ("pier_displacement_residual", 1.0),
}
PLACES = {  # columns that name the governing line or pier: dimension, peak of the parts
    "strain_line": ("line", "line_strain_max"),
    "force_line": ("line", "line_force_max"),
    "displacement_pier": ("pier_part", "pier_part_displacement_max"),
    "ductility_pier": ("pier_part", "pier_part_ductility"),
}
LOOP_COLUMNS = {  # of the largest loop: name in the dataset
    "loop_F_plus_kN": "loop_force_max",
    "loop_F_minus_kN": "loop_force_min",
    "loop_D_plus_mm": "loop_displacement_max",
    "loop_D_minus_mm": "loop_displacement_min",
    "loop_K_eq_kN_mm": "loop_stiffness",
    "loop_h_eq": "loop_damping_ratio",
    "loop_G_e_MPa": "loop_modulus",
    "loop_energy_kN_mm": "loop_energy",
}
LABELS = ("bearing", "motion", "ambient", "mode")  # of a run
HISTORY = {  # columns of a history: name in the dataset
    "time_s": "time",
    "ground_m_s2": "ground_acceleration",
    "displacement_mm": "bearing_displacement",
    "strain": "bearing_strain",
    "force_kN": "bearing_force",
    "rubber_force_kN": "rubber_force",
    "lead_force_kN": "lead_force",
    "viscous_force_kN": "viscous_force",
    "energy_kN_mm": "bearing_energy",
    "pier_displacement_mm": "pier_displacement",
    "pier_rotation_rad": "pier_rotation",
    "pier_moment_kN_m": "pier_moment",
    "pier_top_acceleration_m_s2": "pier_top_acceleration",
    "deck_displacement_mm": "deck_displacement",
    "deck_acceleration_m_s2": "deck_acceleration",
    "lead_degC": "lead_temperature",
}
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


def compute_measures(
    task: "Task", history: StructureHistory, trace: Mapping[str, Floats]
) -> dict[str, Any]:
    """Return what `UNITS` names, of one run: the peaks of the line or pier that goes farthest.

    Heat and the mismatch of layers are those of the line whose histories are kept.

    Parameters
    ----------
    task, history : what was run, and what came out.
    trace : its histories, from `structure_traces` or `history_traces`.
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
        found["energy_actuator"] = _actuator_work(task, history)
    for name in BEARING:
        column = bearing[name]
        found[f"heat_{name}"] = column[-1] - column[0]
    found["layer_force_mismatch_max"] = bearing["layer_force_mismatch"].max()
    return found


def _actuator_work(task: "Task", history: StructureHistory) -> float:
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


def compute_residuals(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """What is missing from the books of `compute_measures`, see `EarthquakeResult.energy`.

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
