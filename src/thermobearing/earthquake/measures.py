"""What is measured of a run: histories, peaks of lines and piers, energies, the largest loop.

Names, units and meanings are in the register (data/quantities/earthquake.toml). With two components
of the ground motion, a vector has its values along x, along y and of the resultant on a last axis.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import Books
from thermobearing.cyclic.protocol import lengths
from thermobearing.quantities.governing import places_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.results.metrics import LEAST_ENERGY, LEAST_HEAT, largest_loop
from thermobearing.results.sums import product_in_order, sum_of_products
from thermobearing.structure.model import Pier, list_hinges
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.run import Task

MM_PER_M, KN_MM_PER_KN_M = 1e3, 1e3
KEYS: Final = ("bearing", "motion", "ambient_degC", "mode", "direction")  # of a run in tables
DIRECTION: Final = "direction"  # dimension of vectors
DIRECTIONS: Final = ("x", "y", "resultant")
PLACES: Final = {  # columns that name the governing line or pier: dimension, peak of the parts
    "strain_line": ("line", "line_strain_max"),
    "force_line": ("line", "line_force_max"),
    "displacement_pier": ("pier_part", "pier_part_displacement_max"),
    "ductility_pier": ("pier_part", "pier_part_ductility"),
}
HISTORIES: Final = (  # in the dataset
    "ground_acceleration", "bearing_displacement", "bearing_strain", "bearing_force",
    "rubber_force", "lead_force", "viscous_force", "bearing_speed", "bearing_energy",
    "pier_displacement", "pier_top_displacement", "deck_displacement", "deck_acceleration",
    "pier_top_acceleration", "pier_rotation", "pier_moment", "lead_temperature",
)  # fmt: skip
FORCES: Final = ("rubber_force", "lead_force", "viscous_force")  # shares of that of the bearing
BEARING: Final = (  # energies of one bearing
    "work_in", "heat_released", "recoverable", "heat_stored", "heat_lost_ends", "heat_lost_sides",
)  # fmt: skip
# Energies of the structure; of the actuator in a laboratory only.
STRUCTURE: Final = ("input", "kinetic", "damping", "springs", "hinges", "bearings", "actuator")
STRUCTURE_ENERGIES: Final = STRUCTURE[:-1]
COLUMNS: Final = (  # of the table of runs
    "bearing_strain_max", "bearing_force_max_kN", "bearing_energy_kN_mm",
    "pier_displacement_max_mm", "pier_ductility", "pier_moment_max_kN_m",
    "deck_displacement_max_mm", "deck_acceleration_max_m_s2", "pier_top_acceleration_max_m_s2",
    "pier_top_displacement_max_mm", "pier_displacement_residual_mm",
)  # fmt: skip
NUMBERS: Final = (  # of a run in the dataset
    *COLUMNS, "bearing_displacement_max_mm", "pier_rotation_max_rad",
    "steps", "iterations", "substeps",
    *(f"{name}_kN_mm" for name in STRUCTURE_ENERGIES),
    *(f"bearing_{name}_kN_mm" for name in BEARING),
    "layer_force_mismatch_max_kN",
)  # fmt: skip
LOOP: Final = {  # of the largest loop: name in CycleMeasures
    "loop_F_plus_kN": "force_max_kN",
    "loop_F_minus_kN": "force_min_kN",
    "loop_D_plus_mm": "displacement_max_mm",
    "loop_D_minus_mm": "displacement_min_mm",
    "loop_K_eq_kN_mm": "stiffness_kN_mm",
    "loop_h_eq": "h_eq",
    "loop_G_e_MPa": "G_eq_MPa",
    "loop_energy_kN_mm": "energy_kN_mm",
}
LOOP_TIMES: Final = ("loop_start", "loop_end")  # [s]
LINES: Final = {  # columns of the table of bearing lines: name in the dataset
    "line_bearing": "line_bearing",
    "count": "line_count",
    "line_ambient_degC": "line_ambient",
    "displacement_max_mm": "line_displacement_max",
    "strain_max": "line_strain_max",
    "force_max_kN": "line_force_max",
    "total_force_max_kN": "line_total_force_max",
    "energy_kN_mm": "line_energy_end",
    "rubber_max_degC": "line_rubber_temperature_max",
    "lead_max_degC": "line_lead_temperature_max",
    "rubber_rise_K": "line_rubber_rise_max",
    "lead_rise_K": "line_lead_rise_max",
}
PIERS: Final = {  # of the table of piers, likewise
    "displacement_max_mm": "pier_part_displacement_max",
    "displacement_residual_mm": "pier_part_displacement_residual",
    "top_displacement_max_mm": "pier_part_top_displacement_max",
    "top_acceleration_max_m_s2": "pier_part_top_acceleration_max",
    "rotation_max_rad": "pier_part_rotation_max",
    "ductility": "pier_part_ductility",
    "moment_max_kN_m": "pier_part_moment_max",
}
# Peaks of a run: that of the line or pier that goes farthest.
GOVERNING: Final = {
    f"bearing_{name}": f"line_{name}"
    for name in ("displacement_max", "strain_max", "force_max", "energy_end")
} | {name.replace("pier_part_", "pier_"): name for name in PIERS.values()}


def with_resultant(values: Floats) -> Floats:
    """Return a history [steps], or one of two components [steps, 2] with its resultant."""
    return values if values.ndim == 1 else np.column_stack([values, lengths(values)])


def _hinge_numbers(values: Any, per: Sequence[float] = (1.0,)) -> Any:
    """Return numbers of a pier's hinge; in plan of both hinges and, for all, the larger one."""
    each = np.atleast_1d(values)[: len(DIRECTIONS) - 1] / per
    return np.append(each, np.fmax.reduce(each)) if np.ndim(values) else float(each[0])


def largest(values: Floats) -> Any:
    """Return the largest magnitude in a history, of each direction; NaN where it is not known."""
    return _plain(np.abs(values).max(axis=0))


def _plain(value: Any) -> Any:
    return value if np.ndim(value) else float(value)


def farthest(values: Any) -> Any:
    """Return the value of largest magnitude along the last axis; NaN where none is known.

    >>> farthest([[1.0, -3.0, np.nan], [np.nan, np.nan, np.nan]]).tolist()
    [-3.0, nan]
    """
    known = np.asarray(values, dtype=float)
    place = places_of_largest(np.abs(known))[..., None]
    return np.take_along_axis(known, place, axis=-1)[..., 0]


def structure_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Return those of `HISTORIES` that the structure has: ground, pier, deck."""
    (pier, top, base), deck = task.prepared.piers[0], task.prepared.deck
    q, a = history.rows.q, history.rows.a
    ground = task.shaking.ground[: len(q)] / MM_PER_M
    rotation, moment = _hinge_histories(history, pier.hinges)
    found = {
        "ground_acceleration": ground,
        "pier_displacement": product_in_order(q, top - base),
        "pier_top_displacement": product_in_order(q, top),
        "deck_displacement": product_in_order(q, deck),
        "deck_acceleration": product_in_order(a, deck) / MM_PER_M + ground,
        "pier_top_acceleration": product_in_order(a, top) / MM_PER_M + ground,
    }
    found = {name: with_resultant(values) for name, values in found.items()}
    return found | {"pier_rotation": rotation, "pier_moment": moment}


def _hinge_histories(
    history: StructureHistory, hinges: Sequence[int | None]
) -> tuple[Floats, Floats]:
    """Return rotation [rad] and moment [kN m] of a pier's hinge in each direction, NaN without."""
    missing = np.full(len(history.rows.q), np.nan)
    bends = [None if number is None else history.hinge(number) for number in hinges]
    turned = [missing if bend is None else bend["rotation"] for bend in bends]
    moments = [missing if bend is None else bend["moment"] / KN_MM_PER_KN_M for bend in bends]
    if len(bends) == 1:
        return turned[0], moments[0]
    return np.column_stack([*turned, missing]), np.column_stack([*moments, missing])


def history_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Return each of `HISTORIES` by name, and temperatures of layers and of cells that are kept."""
    device, bearing = task.reported.device, history.bearing(task.reported_line)
    heat, count = device.stack is not None, len(history.rows.q)
    missing, moved = np.full(count, np.nan), with_resultant(bearing["displacement"])
    return structure_traces(task, history) | {
        "time": history.rows.books["clock"],
        "bearing_displacement": moved,
        "bearing_strain": moved / device.bearing.total_rubber_thickness,
        "bearing_force": with_resultant(bearing["force"]),
        **{name: with_resultant(bearing[name]) for name in FORCES},
        "bearing_speed": with_resultant(loading_speed(bearing)),
        "bearing_clock": bearing["clock"],
        "bearing_energy": bearing["work_in"],
        "lead_temperature": bearing["lead_temperature"] if device.has_lead else missing,
        "rubber_temperature": history.layers(task.reported_line) if heat else np.empty((count, 0)),
        "temperature": history.cells(task.reported_line) if heat else np.empty((count, 0)),
    }


def loading_speed(bearing: Rows[Books]) -> Floats:
    """Return the loading speed at the end of each step, on the clock of the bearing [mm/s]."""
    steps = np.maximum(np.diff(bearing["clock"]), np.finfo(float).tiny)
    moved = bearing["displacement"]
    speed = (np.diff(moved, axis=0).T / steps).T
    return np.concatenate([np.zeros_like(moved[:1]), speed])


def _warmest(values: Floats) -> float:
    return float(values.max()) if values.size else np.nan


def line_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """Return the peaks of each bearing line, by name in the dataset."""
    rows = []
    for b, (line, one) in enumerate(zip(task.case.structure.bearings, task.lines, strict=True)):
        books, device = history.bearing(b), one.device
        lead = books["lead_temperature"] if device.has_lead else np.empty(0)
        rubber = history.layers(b) if device.stack is not None else np.empty((0, 0))
        moved, force = (largest(with_resultant(books[n])) for n in ("displacement", "force"))
        rows.append(
            {
                "line_bearing": device.bearing.name,
                "line_count": line.count,
                "line_ambient": one.ambient,
                "line_displacement_max": moved,
                "line_strain_max": moved / device.bearing.total_rubber_thickness,
                "line_force_max": force,
                "line_total_force_max": force * line.count / line.scale**2,
                "line_energy_end": float(books["work_in"][-1]),
                "line_rubber_temperature_max": _warmest(rubber),
                "line_lead_temperature_max": _warmest(lead),
                "line_rubber_rise_max": _warmest(rubber - rubber[:1]),
                "line_lead_rise_max": _warmest(lead - lead[:1]),
            }
        )
    return rows


def pier_histories(
    task: "Task", history: StructureHistory, pier: Pier, top: Floats, base: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return displacement, rotation, moment, motion and acceleration of the top of one pier."""
    q = history.rows.q
    rotation, moment = _hinge_histories(history, pier.hinges)
    ground = task.shaking.ground[: len(q)]
    acceleration = with_resultant((product_in_order(history.rows.a, top) + ground) / MM_PER_M)
    moved = with_resultant(product_in_order(q, top - base))
    carried = with_resultant(product_in_order(q, top))
    return moved, rotation, moment, carried, acceleration


def pier_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """Return the peaks of each pier, by name in the dataset."""
    rows = []
    hinges = list_hinges(task.case.structure)
    for pier, *where in task.prepared.piers:
        yields = [np.nan if k is None else hinges[k].yield_rotation for k in pier.hinges]
        moved, rotation, moment, top, acceleration = pier_histories(task, history, pier, *where)
        turned = largest(rotation)
        rows.append(
            {
                "pier_part_displacement_max": largest(moved),
                "pier_part_displacement_residual": _plain(moved[-1]),
                "pier_part_top_displacement_max": largest(top),
                "pier_part_top_acceleration_max": largest(acceleration),
                "pier_part_rotation_max": _hinge_numbers(turned),
                "pier_part_ductility": _hinge_numbers(turned, yields),
                "pier_part_moment_max": _hinge_numbers(largest(moment)),
            }
        )
    return rows


def governing_peaks(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return those of `GOVERNING` that rows of lines or piers of one run hold."""
    if len(rows) == 1:  # quickly, in studies of very many runs
        return {name: rows[0][of] for name, of in GOVERNING.items() if of in rows[0]}
    return {
        name: _plain(farthest(np.transpose([row[of] for row in rows])))
        for name, of in GOVERNING.items()
        if of in rows[0]
    }


def drift(task: "Task", moved: Sequence[Any]) -> float:
    """Return the largest displacement of a pier top, in x or y, over its height; NaN without."""
    piers = [pier for pier, _, _ in task.prepared.piers]
    tops = [float(np.max(np.atleast_1d(top)[:2])) for top in moved]
    each = [m / p.height if p.height > 0.0 else np.nan for p, m in zip(piers, tops, strict=True)]
    return float(farthest(each)) if len(each) > 1 else each[0]


def compute_measures(
    task: "Task",
    history: StructureHistory,
    trace: Mapping[str, Floats],
    peaks: tuple[list[dict[str, Any]], list[dict[str, Any]]] | None = None,
) -> dict[str, Any]:
    """Return `NUMBERS` of a run by name in the dataset: of the line or pier that goes farthest.

    Heat and the mismatch of layers are those of the line whose histories are kept.
    """
    bearing, books = history.bearing(task.reported_line), history.rows.books
    found: dict[str, Any] = {
        f"{name}_max": largest(trace[name]) for name in ("deck_displacement", "deck_acceleration")
    }
    lines, piers = peaks or (line_peaks(task, history), pier_peaks(task, history))
    found |= governing_peaks(lines) | governing_peaks(piers) | {"outcome": history.outcome}
    found |= {name: getattr(history, name) for name in ("steps", "iterations", "substeps")}
    found |= {f"energy_{name}": books[name][-1] for name in STRUCTURE_ENERGIES}
    if task.case.laboratory is not None:
        found["energy_actuator"] = _actuator_work(task, history)
    found |= {f"heat_{name}": bearing[name][-1] - bearing[name][0] for name in BEARING}
    found["layer_force_mismatch_max"] = bearing["layer_force_mismatch"].max()
    return found


def _actuator_work(task: "Task", history: StructureHistory) -> float:
    """Return the work of the structure that does not reach the specimen [kN mm].

    The structure feels the measured force at its own displacement, which a delayed actuator has not
    reached; the error of the force counts too. Negative where they feed energy to the structure.
    """
    found = -float(history.rows.books["bearings"][-1])
    lines = zip(task.case.structure.bearings, task.prepared.matrices.line_rows, strict=True)
    for b, (line, row) in enumerate(lines):
        force = history.bearing(b)["force"]
        felt = force - force[0]
        if task.noise is not None:
            felt[1:] += task.noise[: len(felt) - 1]
        moved = np.diff(product_in_order(history.rows.q, row))
        work = sum_of_products(0.5 * (felt[1:] + felt[:-1]), moved)
        found += line.count / line.scale**2 * work
    return found


def compute_residuals(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the residuals of the energy balances of one run, or of columns of runs."""
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


def loop_measures(task: "Task", trace: Mapping[str, Floats]) -> dict[str, Any]:
    """Return numbers of the largest loop, in plan of each direction; NaN where none is closed."""
    moved, force, work = (trace[f"bearing_{n}"] for n in ("displacement", "force", "energy"))
    if moved.ndim == 1:
        return _loop_numbers(task, trace["time"], moved, force, work)
    each = []
    for x, f in zip(moved.T[:-1], force.T[:-1], strict=True):
        own = np.append(0.0, np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))
        each.append(_loop_numbers(task, trace["time"], x, f, own))
    return {name: np.array([one[name] for one in each] + [np.nan]) for name in each[0]}


def _loop_numbers(
    task: "Task", time: Floats, moved: Floats, force: Floats, work: Floats
) -> dict[str, float]:
    names = [quantity(name).variable for name in LOOP]
    bearing = task.reported.device.bearing
    area = None if isinstance(bearing, BilinearBearing) else bearing.area
    loop = largest_loop(
        moved, force, work, area=area or 1.0, total_rubber_thickness=bearing.total_rubber_thickness
    )
    if loop is None:
        return dict.fromkeys((*names, *LOOP_TIMES), np.nan)
    values = vars(loop.measures)
    if area is None:  # of a bilinear one
        values = values | {"G_eq_MPa": np.nan}
    ends = dict(zip(LOOP_TIMES, time[[loop.first, loop.last]], strict=True))
    return {name: values[key] for name, key in zip(names, LOOP.values(), strict=True)} | ends
