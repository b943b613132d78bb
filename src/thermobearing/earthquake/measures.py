"""What is measured of a run: histories, peaks of lines and piers, energies, the largest loop.

Names, units and meanings are in the register (data/quantities/earthquake.toml). With two components
of the ground motion, a vector has its values along x, along y and of the resultant on a last axis.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import BearingResponse
from thermobearing.cyclic.protocol import lengths
from thermobearing.quantities.governing import place_of_largest, places_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.quantities.warned import ASSUMED, Warned
from thermobearing.results.metrics import (
    BALANCE,
    LEAST_ENERGY,
    energy_balance,
    largest_loop,
    relative_residual,
)
from thermobearing.results.ranges import largest_tested, limits_passed
from thermobearing.results.sums import product_in_order, sum_of_products
from thermobearing.structure.model import Pier, Structure, list_hinges
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult
    from thermobearing.earthquake.run import Task

MM_PER_M, KN_MM_PER_KN_M = 1e3, 1e3
CONDITIONS: Final = ("bearing", "motion", "ambient_degC")  # that every run of an analysis has
KEYS: Final = (*CONDITIONS, "mode", "direction")  # of a run in tables
DIRECTION: Final = "direction"  # dimension of vectors
AXES: Final = ("x", "y")
RESULTANT: Final = "resultant"
DIRECTIONS: Final = (*AXES, RESULTANT)
PLACES: Final = {  # columns that name the governing line or pier: dimension, peak of the parts
    "strain_line": ("line", "line_strain_max"),
    "force_line": ("line", "line_force_max"),
    "displacement_pier": ("pier_part", "pier_part_displacement_max"),
    "ductility_pier": ("pier_part", "pier_part_ductility"),
}
HISTORIES: Final = (  # in the dataset
    "ground_acceleration",
    "bearing_displacement",
    "bearing_strain",
    "bearing_force",
    "rubber_force",
    "lead_force",
    "viscous_force",
    "bearing_speed",
    "bearing_energy",
    "pier_displacement",
    "pier_top_displacement",
    "deck_displacement",
    "deck_acceleration",
    "pier_top_acceleration",
    "pier_rotation",
    "pier_moment",
    "lead_temperature",
)
HISTORY: Final = {  # columns of a history: name in the dataset
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
PART_HISTORIES: Final = {  # of lines and piers: dimension, column of history.csv behind the name
    "line_displacement": ("line", "displacement_mm"),
    "line_force": ("line", "force_kN"),
    "pier_part_displacement": ("pier_part", "displacement_mm"),
    "pier_part_rotation": ("pier_part", "rotation_rad"),
    "pier_part_moment": ("pier_part", "moment_kN_m"),
}
SCALARS: Final = (
    "time_s",
    "energy_kN_mm",
)  # columns of a history that are no vectors, with temperatures
FORCES: Final = ("rubber_force", "lead_force", "viscous_force")  # shares of that of the bearing
STRUCTURE_ENERGIES: Final = ("input", "kinetic", "damping", "springs", "hinges", "bearings")
DEVICE_ENERGIES: Final = {"damper": "dampers", "slider": "sliders", "gap": "gaps"}  # by kind
# Those of devices where there are some, that of the actuator in a laboratory only.
STRUCTURE: Final = (*STRUCTURE_ENERGIES, *DEVICE_ENERGIES.values(), "actuator")
COLUMNS: Final = (  # of the table of runs
    "bearing_strain_max",
    "bearing_force_max_kN",
    "bearing_energy_kN_mm",
    "pier_displacement_max_mm",
    "pier_ductility",
    "pier_moment_max_kN_m",
    "deck_displacement_max_mm",
    "deck_acceleration_max_m_s2",
    "pier_top_acceleration_max_m_s2",
    "pier_top_displacement_max_mm",
    "pier_displacement_residual_mm",
)
NUMBERS: Final = (  # of a run in the dataset
    *COLUMNS,
    "bearing_displacement_max_mm",
    "pier_rotation_max_rad",
    "steps",
    "iterations",
    "substeps",
    *(f"{name}_kN_mm" for name in STRUCTURE_ENERGIES),
    *(f"bearing_{name}_kN_mm" for name in BALANCE),
    "layer_force_mismatch_max_kN",
)
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
PARTIAL: Final = 0.5  # of the larger side of a loop, below which the smaller makes it partial
PARTIAL_NOTE: Final = (
    " Partial: one-sided, |D+| or |D−| below half of the other, and no equivalent linear model."
)
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
COLD: Final = (  # compared with the warmest run
    "bearing_strain_max",
    "bearing_force_max_kN",
    "bearing_energy_kN_mm",
    "pier_displacement_max_mm",
    "deck_acceleration_max_m_s2",
)
COLD_LINES: Final = {  # of them, peaks of bearings: column of the table of lines
    "bearing_strain_max": "strain_max",
    "bearing_force_max_kN": "force_max_kN",
    "bearing_energy_kN_mm": "energy_kN_mm",
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


def key_columns(frame: "pd.DataFrame") -> list[str]:
    """Return those of `KEYS` that are columns of a table."""
    return [name for name in KEYS if name in frame]


def with_partial_loops(frame: "pd.DataFrame") -> "pd.DataFrame":
    """Return runs with a column `loop`, "partial" where the largest loop is one-sided, else ""."""
    sides = frame[["loop_D_plus_mm", "loop_D_minus_mm"]].abs().to_numpy(dtype=float)
    partial = sides.min(axis=1) < PARTIAL * sides.max(axis=1)
    return frame.assign(loop=np.where(partial, "partial", ""))


def cold_ratios(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return peaks of each run over those at the warmest temperature of the same run otherwise.

    `..._cold` and `..._warm` are both peaks of each ratio. With several kinds of bearings there is
    a row for each kind (`line_bearing`), whose strain, force and energy are means over its lines.
    With one kind this holds for the energy alone.
    """
    table = result.table
    table = table[table["outcome"] == "completed"]
    keys = [name for name in key_columns(table) if name != "ambient_degC"]
    if table["ambient_degC"].nunique() < 2:
        return pd.DataFrame()
    warmest = float(table["ambient_degC"].max())
    warm = table.loc[table["ambient_degC"] == warmest, [*keys, *COLD]]
    cold = table.loc[table["ambient_degC"] < warmest, [*keys, "ambient_degC", *COLD]]
    # A warm run that ended early has no row.
    pairs = cold.merge(warm, on=keys, suffixes=("_cold", "_warm"))
    return _with_ratios(_with_means_of_lines(result, pairs, keys))


def _with_ratios(pairs: "pd.DataFrame") -> "pd.DataFrame":
    """Return peaks in the cold and at the warmest temperature with their ratios."""
    warm = {name: pairs[f"{name}_warm"] for name in COLD}
    ratios = {name: pairs[f"{name}_cold"] / warm[name].where(warm[name] != 0.0) for name in COLD}
    return pairs.assign(**ratios)


def ratio_of_means(ratios: "pd.DataFrame", name: str) -> float:
    """Return the mean of a peak in the cold over its mean at the warmest temperature.

    Of the motions in rows of `cold_ratios`: codes take means of responses over motions, in which a
    strong motion weighs more than in the mean of the ratios of each motion. NaN without a peak.
    """
    pairs = ratios.loc[ratios[name].notna(), [f"{name}_cold", f"{name}_warm"]]
    cold, warm = pairs.mean()
    return float(cold / warm)


def _with_means_of_lines(
    result: "EarthquakeResult", pairs: "pd.DataFrame", keys: Sequence[str]
) -> "pd.DataFrame":
    """Return peaks of pairs of runs with means over lines in place of the largest of all lines."""
    lines = result.lines
    if not len(lines) or not len(pairs):
        return pairs
    kinds = ["line_bearing"] if result.line_bearings else []
    columns = COLD_LINES if kinds else {"bearing_energy_kN_mm": "energy_kN_mm"}
    runs = [name for name in keys if name in lines]
    identity = [*runs, *kinds]
    values = list(columns.values())
    means = lines.groupby([*identity, "ambient_degC"], sort=False)[values].mean().reset_index()
    means = means.rename(columns={column: peak for peak, column in columns.items()})
    warm = means[means["ambient_degC"] == means["ambient_degC"].max()].drop(columns="ambient_degC")
    of_lines = means.merge(warm, on=identity, suffixes=("_cold", "_warm"))
    replaced = [f"{peak}_{state}" for peak in columns for state in ("cold", "warm")]
    return pairs.drop(columns=replaced).merge(of_lines, on=[*runs, "ambient_degC"])


def with_resultant(values: Floats) -> Floats:
    """Return a history [steps], or one of two components [steps, 2] with its resultant."""
    return values if values.ndim == 1 else np.column_stack([values, lengths(values)])


def _hinge_numbers(values: Any, per: Sequence[float] = (1.0,)) -> Any:
    """Return numbers of a pier's hinge; in plan of both hinges and, for all, the larger one."""
    components = np.atleast_1d(values)[: len(AXES)] / per
    if not np.ndim(values):
        return float(components[0])
    # Each direction has a hinge of its own, so that a resultant rotation belongs to neither.
    return np.append(components, np.fmax.reduce(components))


def largest(values: Floats) -> Any:
    """Return the largest magnitude in a history, of each direction; NaN where it is not known."""
    return _plain(np.abs(values).max(axis=0))


def _plain(value: Any) -> Any:
    return value if np.ndim(value) else float(value)


def signed_peak(values: Any) -> Any:
    """Return the value of largest magnitude along the last axis; NaN where none is known.

    >>> signed_peak([[1.0, -3.0, np.nan], [np.nan, np.nan, np.nan]]).tolist()
    [-3.0, nan]
    """
    numbers = np.asarray(values, dtype=float)
    if numbers.shape[-1] == 1:  # nothing to compare: faster, in studies of very many runs
        return numbers[..., 0]
    place = places_of_largest(np.abs(numbers))[..., None]
    return np.take_along_axis(numbers, place, axis=-1)[..., 0]


def structure_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Return those of `HISTORIES` that the structure has: ground, pier, deck."""
    (pier, top, base), deck = task.prepared.piers[0], task.prepared.deck
    displacement, acceleration = history.rows.q, history.rows.a
    # Coordinates are relative to the ground: an absolute acceleration adds that of the ground.
    ground = task.shaking.ground[: len(displacement)] / MM_PER_M
    rotation, moment = _hinge_histories(history, pier.hinges)
    # `base` moves the top rigidly with its footing, whose rocking thus does not bend the pier.
    traces = {
        "ground_acceleration": ground,
        "pier_displacement": product_in_order(displacement, top - base),
        "pier_top_displacement": product_in_order(displacement, top),
        "deck_displacement": product_in_order(displacement, deck),
        "deck_acceleration": product_in_order(acceleration, deck) / MM_PER_M + ground,
        "pier_top_acceleration": product_in_order(acceleration, top) / MM_PER_M + ground,
    }
    traces = {name: with_resultant(values) for name, values in traces.items()}
    return traces | {"pier_rotation": rotation, "pier_moment": moment}


def _hinge_histories(
    history: StructureHistory, hinges: Sequence[int | None]
) -> tuple[Floats, Floats]:
    """Return rotation [rad] and moment [kN m] of a pier's hinge in each direction, NaN without."""
    missing = np.full(len(history.rows.q), np.nan)
    hinge_rows = [None if number is None else history.hinge(number) for number in hinges]
    rotations = [missing if rows is None else rows["rotation"] for rows in hinge_rows]
    moments = [missing if rows is None else rows["moment"] / KN_MM_PER_KN_M for rows in hinge_rows]
    if len(hinge_rows) == 1:
        return rotations[0], moments[0]
    return np.column_stack([*rotations, missing]), np.column_stack([*moments, missing])


def history_traces(task: "Task", history: StructureHistory) -> dict[str, Floats]:
    """Return each of `HISTORIES` by name, and temperatures of layers and of cells that are kept."""
    device, bearing = task.reported.device, history.bearing(task.reported_line)
    count = len(history.rows.q)
    missing, displacement = np.full(count, np.nan), with_resultant(bearing["displacement"])
    layers, cells = np.empty((count, 0)), np.empty((count, 0))
    if device.stack is not None:
        layers, cells = history.layers(task.reported_line), history.cells(task.reported_line)
    return structure_traces(task, history) | {
        "time": history.rows.energies["clock"],
        "bearing_displacement": displacement,
        "bearing_strain": displacement / device.bearing.total_rubber_thickness,
        "bearing_force": with_resultant(bearing["force"]),
        **{name: with_resultant(bearing[name]) for name in FORCES},
        "bearing_speed": with_resultant(loading_speed(bearing)),
        "bearing_clock": bearing["clock"],
        "bearing_energy": bearing["work_in"],
        "lead_temperature": bearing["lead_temperature"] if device.has_lead else missing,
        "rubber_temperature": layers,
        "temperature": cells,
    }


def loading_speed(bearing: Rows[BearingResponse]) -> Floats:
    """Return the loading speed at the end of each step, on the clock of the bearing [mm/s]."""
    steps = np.maximum(np.diff(bearing["clock"]), np.finfo(float).tiny)
    displacement = bearing["displacement"]
    speed = (np.diff(displacement, axis=0).T / steps).T
    return np.concatenate([np.zeros_like(displacement[:1]), speed])


def _warmest(values: Floats) -> float:
    return float(values.max()) if values.size else np.nan


def line_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """Return the peaks of each bearing line, by name in the dataset."""
    rows = []
    for number, (line, installed) in enumerate(
        zip(task.case.structure.bearings, task.lines, strict=True)
    ):
        record, device = history.bearing(number), installed.device
        lead = record["lead_temperature"] if device.has_lead else np.empty(0)
        rubber = history.layers(number) if device.stack is not None else np.empty((0, 0))
        displacement, force = (
            largest(with_resultant(record[n])) for n in ("displacement", "force")
        )
        rows.append(
            {
                "line_bearing": device.bearing.name,
                "line_count": line.count,
                "line_ambient": installed.ambient,
                "line_displacement_max": displacement,
                "line_strain_max": displacement / device.bearing.total_rubber_thickness,
                "line_force_max": force,
                # A specimen at a scale s carries s^2 of the force of the bearing in the structure.
                "line_total_force_max": force * line.count / line.scale**2,
                "line_energy_end": float(record["work_in"][-1]),
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
    displacement = history.rows.q
    rotation, moment = _hinge_histories(history, pier.hinges)
    ground = task.shaking.ground[: len(displacement)]
    acceleration = with_resultant((product_in_order(history.rows.a, top) + ground) / MM_PER_M)
    relative_displacement = with_resultant(product_in_order(displacement, top - base))
    top_displacement = with_resultant(product_in_order(displacement, top))
    return relative_displacement, rotation, moment, top_displacement, acceleration


def pier_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """Return the peaks of each pier, by name in the dataset."""
    rows = []
    hinges = list_hinges(task.case.structure)
    for pier, top_row, base_row in task.prepared.piers:
        yield_rotations = [np.nan if k is None else hinges[k].yield_rotation for k in pier.hinges]
        displacement, rotation, moment, top, acceleration = pier_histories(
            task, history, pier, top_row, base_row
        )
        largest_rotation = largest(rotation)
        rows.append(
            {
                "pier_part_displacement_max": largest(displacement),
                "pier_part_displacement_residual": _plain(displacement[-1]),
                "pier_part_top_displacement_max": largest(top),
                "pier_part_top_acceleration_max": largest(acceleration),
                "pier_part_rotation_max": _hinge_numbers(largest_rotation),
                "pier_part_ductility": _hinge_numbers(largest_rotation, yield_rotations),
                "pier_part_moment_max": _hinge_numbers(largest(moment)),
            }
        )
    return rows


def governing_peaks(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return those of `GOVERNING` that rows of lines or piers of one run hold."""
    if len(rows) == 1:  # nothing to compare: faster, in studies of very many runs
        return {
            name: rows[0][part_name]
            for name, part_name in GOVERNING.items()
            if part_name in rows[0]
        }
    return {
        name: _plain(signed_peak(np.transpose([row[part_name] for row in rows])))
        for name, part_name in GOVERNING.items()
        if part_name in rows[0]
    }


def drift(task: "Task", top_displacements: Sequence[Any]) -> float:
    """Return the largest displacement of a pier top, in x or y, over its height; NaN without."""
    piers = [pier for pier, _, _ in task.prepared.piers]
    largest_tops = [
        top if isinstance(top, float) else float(np.max(np.atleast_1d(top)[: len(AXES)]))
        for top in top_displacements
    ]
    drifts = [
        m / p.height if p.height > 0.0 else np.nan for p, m in zip(piers, largest_tops, strict=True)
    ]
    return float(signed_peak(drifts)) if len(drifts) > 1 else drifts[0]


def compute_measures(
    task: "Task",
    history: StructureHistory,
    trace: Mapping[str, Floats],
    peaks: tuple[list[dict[str, Any]], list[dict[str, Any]]] | None = None,
) -> dict[str, Any]:
    """Return `NUMBERS` of a run by name in the dataset: of the line or pier that goes farthest.

    Heat and the mismatch of layers are those of the line whose histories are kept.
    """
    bearing, balance = history.bearing(task.reported_line), history.rows.energies
    numbers: dict[str, Any] = {
        f"{name}_max": largest(trace[name]) for name in ("deck_displacement", "deck_acceleration")
    }
    lines, piers = peaks or (line_peaks(task, history), pier_peaks(task, history))
    numbers |= governing_peaks(lines) | governing_peaks(piers) | {"outcome": history.outcome}
    numbers |= {name: getattr(history, name) for name in ("steps", "iterations", "substeps")}
    present = [*STRUCTURE_ENERGIES, *device_energies(task.case.structure)]
    numbers |= {f"energy_{name}": balance[name][-1] for name in present}
    if task.case.laboratory is not None:
        numbers["energy_actuator"] = _actuator_work(task, history)
    numbers |= {f"heat_{name}": bearing[name][-1] - bearing[name][0] for name in BALANCE}
    numbers["layer_force_mismatch_max"] = bearing["layer_force_mismatch"].max()
    return numbers


def device_energies(structure: Structure) -> list[str]:
    """Return the names of the energies of the kinds of devices that a structure has."""
    kinds = {device.kind for device in structure.device_list}
    return [name for kind, name in DEVICE_ENERGIES.items() if kind in kinds]


def device_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """Return the peaks and energies of all devices of a run, as rows of the table of devices."""
    rows = []
    for number, device in enumerate(task.case.structure.device_list):
        peak, end = history.device_peaks[number], history.device(number)[-1]
        # In plan the resultant is the last.
        force, stroke, speed = (
            float(np.atleast_1d(size)[-1]) for size in (peak.force, peak.stroke, peak.velocity)
        )
        rows.append(
            {
                "run": task.label(task.device.bearing.name),
                "device": device.name,
                "device_kind": device.kind,
                "device_force_max_kN": force,
                "device_stroke_mm": stroke,
                "device_speed_mm_s": speed,
                "device_energy_kN_mm": float(end.work),
                "device_stored_kN_mm": float(end.stored),
                "oil_rise_K": float(end.heated),
            }
        )
    return rows


def _actuator_work(task: "Task", history: StructureHistory) -> float:
    """Return the work of the structure that does not reach the specimen [kN mm].

    The structure feels the measured force at its own displacement, which a delayed actuator has not
    reached; the error of the force counts too. Negative where they feed energy to the structure.
    """
    # The energy balance has the work on the bearings at their own, delayed displacements. It is
    # taken from the work at the displacements of the structure; the difference is the actuator's.
    work = -float(history.rows.energies["bearings"][-1])
    lines = zip(task.case.structure.bearings, task.prepared.matrices.line_rows, strict=True)
    for b, (line, row) in enumerate(lines):
        force = history.bearing(b)["force"]
        force_change = force - force[0]
        if task.noise is not None:
            force_change[1:] += task.noise[: len(force_change) - 1]
        step_displacements = np.diff(product_in_order(history.rows.q, row))
        mean_forces = 0.5 * (force_change[1:] + force_change[:-1])
        line_work = sum_of_products(mean_forces, step_displacements)
        work += line.count / line.scale**2 * line_work
    return work


def damping_share(damping: Any, input_energy: Any) -> Any:
    """Return the share of viscous damping in the input energy, of one run or of columns."""
    return damping / np.maximum(input_energy, LEAST_ENERGY)


def compute_residuals(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the residuals of the energy balances of one run, or of columns of runs."""
    input_energy = numbers["energy_input"]
    taken_energy = sum(numbers.get(f"energy_{name}", 0.0) for name in STRUCTURE if name != "input")
    return {
        "structure_residual": relative_residual(input_energy - taken_energy, [input_energy]),
        **energy_balance({name: numbers[f"heat_{name}"] for name in BALANCE}),
    }


def loop_measures(task: "Task", trace: Mapping[str, Floats]) -> dict[str, Any]:
    """Return numbers of the largest loop, in plan of each direction; NaN where none is closed."""
    displacement, force, work = (trace[f"bearing_{n}"] for n in ("displacement", "force", "energy"))
    if displacement.ndim == 1:
        return _loop_numbers(task, trace["time"], displacement, force, work)
    loops = []
    # The kept work is that of both components: the loop of one has the work of its force alone.
    for axis in range(len(AXES)):
        x, f = displacement[:, axis], force[:, axis]
        component_work = np.append(0.0, np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))
        loops.append(_loop_numbers(task, trace["time"], x, f, component_work))
    # A resultant has no sign and so no loop.
    return {name: np.array([loop[name] for loop in loops] + [np.nan]) for name in loops[0]}


def _loop_numbers(
    task: "Task", time: Floats, displacement: Floats, force: Floats, work: Floats
) -> dict[str, float]:
    names = [quantity(name).variable for name in LOOP]
    bearing = task.reported.device.bearing
    area = None if isinstance(bearing, BilinearBearing) else bearing.area
    loop = largest_loop(
        displacement,
        force,
        work,
        area=area or 1.0,
        total_rubber_thickness=bearing.total_rubber_thickness,
    )
    if loop is None:
        return dict.fromkeys((*names, *LOOP_TIMES), np.nan)
    values = vars(loop.measures)
    if area is None:  # a bilinear bearing, of which `area or 1.0` above made a meaningless G_e
        values = values | {"G_eq_MPa": np.nan}
    ends = dict(zip(LOOP_TIMES, time[[loop.first, loop.last]], strict=True))
    return {name: values[key] for name, key in zip(names, LOOP.values(), strict=True)} | ends


# Of the input. In the default analysis, bearings of runs below it move 13 to 19 % farther without
# viscous damping, those of runs above it 12 to 200 %: there the assumed ratios count as much as
# the bearing.
LARGEST_DAMPING_SHARE = 0.25


# Of the input, either way: a delay of 5 ms comes to 3 % in the default hybrid test.
LARGEST_ACTUATOR_SHARE = 0.05


def actuator_warnings(energy: "pd.DataFrame") -> list[Warned]:
    """Return a warning if an actuator takes or feeds much energy; `energy` is that of a result."""
    if "actuator_kN_mm" not in energy:
        return []
    ratios = energy["actuator_kN_mm"] / energy["input_kN_mm"].clip(lower=LEAST_ENERGY)
    worst = float(ratios.iloc[place_of_largest(ratios.abs())]) if len(ratios) else 0.0
    if abs(worst) <= LARGEST_ACTUATOR_SHARE:
        return []
    does, damped = ("take", "more") if worst > 0.0 else ("feed", "less")
    sentence = (
        f"delay and force error of the actuator {does} up to {abs(worst):.0%} of the input "
        f"energy, so that the structure is damped {damped} than it should be"
    )
    return [Warned(sentence, "actuator", ASSUMED)]


def damping_sentence(shares: Floats, kind: str) -> str:
    """Return how much of the input energy viscous damping takes in runs; empty where it is little.

    `shares` are those of the runs, `kind` is that of the damping.
    """
    exceeding = shares > LARGEST_DAMPING_SHARE
    if not exceeding.any():
        return ""
    return (
        f"viscous damping ({kind}) takes more than {LARGEST_DAMPING_SHARE:.0%} of the "
        f"input energy in {exceeding.sum()} of {len(shares)} runs, at most "
        f"{shares.max():.0%}: there the results depend on the assumed damping ratios "
        'as much as on the bearings; compare with damping = "none"'
    )


def row_names(result: "EarthquakeResult") -> list[dict[str, str]]:
    """Return the names of each run in rows of checks and ranges, each with the bearing in it."""
    lines, names = result.line_bearings, []
    for run, bearing in zip(result.run_names, result.dataset["bearing"].values, strict=True):
        bearings = [str(bearing), *lines.get(str(bearing), {}).values()]
        names.append({_with_bearing(run, str(bearing), name): name for name in bearings})
    return names


def limits_by_bearing(result: "EarthquakeResult") -> list[dict[str, str]]:
    """Return the calibration limits that each run passes, by the bearings of its lines."""
    rows = result.tested_range.to_dict("records")
    return [
        dict(zip(names.values(), limits_passed(rows, list(names)), strict=True))
        for names in row_names(result)
    ]


def beyond_tested(result: "EarthquakeResult") -> list[str]:
    """Return the calibration limits that each run passes with any of its bearings."""
    limits = [" ".join(passed.values()).split() for passed in limits_by_bearing(result)]
    return [" ".join(dict.fromkeys(names)) for names in limits]


def strained_elsewhere(result: "EarthquakeResult") -> list[bool]:
    """Return the runs in which the strain is beyond the tests on other lines than the governing.

    The largest strain of such a run, which tables state, is inside the calibration range.
    """
    data, lines, elsewhere = result.resultant.dataset, result.line_bearings, []
    for run, passed in enumerate(limits_by_bearing(result)):
        strained = {name for name, limits in passed.items() if "strain" in limits.split()}
        governing = str(data["bearing"].values[run])
        if governing in lines:
            place = place_of_largest(data["line_strain_max"].values[run])
            governing = lines[governing][str(data["line"].values[place])]
        elsewhere.append(bool(strained) and governing not in strained)
    return elsewhere


def tested_rows(result: "EarthquakeResult") -> list[dict[Any, Any]]:
    """Return the rows of the tested range, each with the `runs` in which its bearing is.

    A row is named after the bearing of a line, and a run after that of the analysis.
    """
    runs: dict[str, list[str]] = {}
    for run, bearing in zip(result.run_names, result["bearing"].values.tolist(), strict=True):
        on_lines = result.line_bearings.get(bearing, {}).values()
        for name in dict.fromkeys([bearing, *on_lines]):
            runs.setdefault(_with_bearing(run, bearing, name), []).append(run)
    rows = result.tested_range.to_dict("records")
    return [row | {"runs": runs.get(str(row["run"]), [str(row["run"])])} for row in rows]


def tested_to(result: "EarthquakeResult", runs: Sequence[int], limit: str) -> float:
    """Return the largest tested value that one of some runs exceeds on the line shown; or inf."""
    rows, line = result.tested_range.to_dict("records"), str(result.dataset.attrs.get("line", ""))
    tested = []
    for run in runs:
        bearing = str(result.dataset["bearing"].values[run])
        shown_bearing = result.line_bearings.get(bearing, {}).get(line, bearing)
        name = _with_bearing(result.run_names[run], bearing, shown_bearing)
        tested.append(largest_tested(rows, name, limit))
    return min(tested, default=np.inf)


def _with_bearing(run: str, bearing: str, replacement: str) -> str:
    """Return the name of a run of a bearing with that of another bearing on its lines."""
    return f"{replacement}{run.removeprefix(bearing)}"


def run_name(bearing: str, motion: str, ambient: float, *others: str) -> str:
    """Return the name of a run: bearing, motion, temperature, mode, direction, as far as given."""
    return ", ".join(part for part in (bearing, motion, f"{ambient:g} degC", *others) if part)
