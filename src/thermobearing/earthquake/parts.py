"""Rows of bearing lines and piers, and governing runs."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from thermobearing.core.records import Floats
from thermobearing.structure.model import Pier, list_piers
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult
    from thermobearing.earthquake.task import Task

MM_PER_M, KN_MM_PER_KN_M = 1e3, 1e3
RUN = {"bearing": "bearing", "motion": "motion", "ambient": "ambient_degC", "mode": "mode"}
LINES = {  # peaks of a bearing line: name in the dataset, unit, column of the table
    "line_bearing": ("", "line_bearing"),
    "line_count": ("1", "count"),
    "line_ambient": ("degC", "line_ambient_degC"),
    "line_displacement_max": ("mm", "displacement_max_mm"),
    "line_strain_max": ("1", "strain_max"),
    "line_force_max": ("kN", "force_max_kN"),
    "line_total_force_max": ("kN", "total_force_max_kN"),
    "line_energy_end": ("kN mm", "energy_kN_mm"),
    "line_rubber_temperature_max": ("degC", "rubber_max_degC"),
    "line_lead_temperature_max": ("degC", "lead_max_degC"),
    "line_rubber_rise_max": ("K", "rubber_rise_K"),
    "line_lead_rise_max": ("K", "lead_rise_K"),
}
PIERS = {  # peaks of a pier, likewise
    "pier_part_displacement_max": ("mm", "displacement_max_mm"),
    "pier_part_displacement_residual": ("mm", "displacement_residual_mm"),
    "pier_part_top_displacement_max": ("mm", "top_displacement_max_mm"),
    "pier_part_top_acceleration_max": ("m/s2", "top_acceleration_max_m_s2"),
    "pier_part_rotation_max": ("rad", "rotation_max_rad"),
    "pier_part_ductility": ("1", "ductility"),
    "pier_part_moment_max": ("kN m", "moment_max_kN_m"),
}
GOVERNING = {  # peaks of a run: the line or pier that goes farthest, where there are several
    "bearing_displacement_max": "line_displacement_max",
    "bearing_strain_max": "line_strain_max",
    "bearing_force_max": "line_force_max",
    "bearing_energy_end": "line_energy_end",
    "pier_displacement_max": "pier_part_displacement_max",
    "pier_displacement_residual": "pier_part_displacement_residual",
    "pier_top_displacement_max": "pier_part_top_displacement_max",
    "pier_top_acceleration_max": "pier_part_top_acceleration_max",
    "pier_rotation_max": "pier_part_rotation_max",
    "pier_ductility": "pier_part_ductility",
    "pier_moment_max": "pier_part_moment_max",
}
HISTORIES = {  # of the parts: dimension, unit, long name, column of history.csv
    "line_displacement": ("line", "mm", "displacement of each bearing line", "displacement_mm"),
    "line_force": ("line", "kN", "force of one bearing of each line", "force_kN"),
    "pier_part_displacement": (
        "pier_part",
        "mm",
        "displacement of each pier top relative to its base",
        "displacement_mm",
    ),
    "pier_part_rotation": ("pier_part", "rad", "rotation of each pier's hinge", "rotation_rad"),
    "pier_part_moment": ("pier_part", "kN m", "moment of each pier's hinge", "moment_kN_m"),
}


def farthest(values: Any) -> Any:
    """Return the value of largest magnitude along the last axis; NaN where none is known.

    Examples
    --------
    >>> farthest([[1.0, -3.0, np.nan], [np.nan, np.nan, np.nan]]).tolist()
    [-3.0, nan]
    """
    known = np.asarray(values, dtype=float)
    place = np.nan_to_num(np.abs(known), nan=-1.0).argmax(axis=-1)[..., None]
    return np.take_along_axis(known, place, axis=-1)[..., 0]


def governing_peaks(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return those of `GOVERNING` that rows of lines or piers of one run hold."""
    return {
        name: float(farthest([row[of] for row in rows]))
        for name, of in GOVERNING.items()
        if of in rows[0]
    }


def largest(values: Floats) -> float:
    """Largest size of a history; NaN where it is not known."""
    return float(np.abs(values).max())


def warmest(values: Floats) -> float:
    """Largest of some temperatures; NaN without any."""
    return float(values.max()) if values.size else np.nan


def line_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """A row for each bearing line, by name in the dataset."""
    rows = []
    for b, (line, one) in enumerate(zip(task.case.structure.bearings, task.lines, strict=True)):
        books, device = history.bearing(b), one.device
        lead = books["lead_temperature"] if device.has_lead else np.empty(0)
        rubber = history.layers(b) if device.heats else np.empty((0, 0))
        moved = largest(books["displacement"])
        force = largest(books["force"])
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
                "line_rubber_temperature_max": warmest(rubber),
                "line_lead_temperature_max": warmest(lead),
                "line_rubber_rise_max": warmest(rubber - rubber[:1]),
                "line_lead_rise_max": warmest(lead - lead[:1]),
            }
        )
    return rows


def _pier_histories(
    task: "Task", history: StructureHistory, pier: Pier, top: Floats, base: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Displacement, rotation, moment, motion and acceleration of the top of one pier."""
    q = history.rows.q
    missing = np.full(len(q), np.nan)
    rotation = moment = missing
    if pier.hinge is not None:
        bend = history.hinge(pier.hinge)
        rotation, moment = bend["rotation"], bend["moment"] / KN_MM_PER_KN_M
    ground = task.shaking.ground[: len(q)]
    acceleration = (history.rows.a @ top + ground) / MM_PER_M
    return q @ (top - base), rotation, moment, q @ top, acceleration


def pier_peaks(task: "Task", history: StructureHistory) -> list[dict[str, Any]]:
    """A row for each pier, by name in the dataset."""
    rows = []
    structure = task.case.structure
    for pier, *where in task.prepared.piers:
        moved, rotation, moment, top, acceleration = _pier_histories(task, history, pier, *where)
        hinge = None if pier.hinge is None else structure.hinges[pier.hinge]
        rows.append(
            {
                "pier_part_displacement_max": largest(moved),
                "pier_part_displacement_residual": float(moved[-1]),
                "pier_part_top_displacement_max": largest(top),
                "pier_part_top_acceleration_max": largest(acceleration),
                "pier_part_rotation_max": largest(rotation),
                "pier_part_ductility": (
                    np.nan if hinge is None else largest(rotation) / hinge.yield_rotation
                ),
                "pier_part_moment_max": largest(moment),
            }
        )
    return rows


def drift(task: "Task", moved: Sequence[float]) -> float:
    """Return the largest displacement of a pier top over the height of its pier; NaN without."""
    piers = [pier for pier, _, _ in task.prepared.piers]
    each = [m / p.height if p.height > 0.0 else np.nan for p, m in zip(piers, moved, strict=True)]
    return float(farthest(each))


def label_parts(
    tasks: Sequence["Task"],
    histories: Sequence[StructureHistory],
    padded: Callable[[Sequence[Floats], tuple[int, ...]], Any],
    length: int,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Variables and coordinates of lines and piers; none where there is one of each."""
    if not tasks:
        return {}, {}
    case = tasks[0].case
    lines, piers = case.structure.bearings, list_piers(case.structure)
    if len(lines) == 1 and len(piers) == 1:
        return {}, {}
    every = case.analysis.keep_every
    data: dict[str, Any] = {}
    for table, dimension, make in ((LINES, "line", line_peaks), (PIERS, "pier_part", pier_peaks)):
        rows = [make(task, history) for task, history in zip(tasks, histories, strict=True)]
        for name, (unit, _) in table.items():
            values = np.array([[row[name] for row in run] for run in rows])
            values = values.astype(str) if name == "line_bearing" else values
            data[name] = (("run", dimension), values, {"units": unit})
    for name, (dimension, unit, about, _) in HISTORIES.items():
        count = len(lines) if dimension == "line" else len(piers)
        parts = [
            _history(name, task, history)[::every]
            for task, history in zip(tasks, histories, strict=True)
        ]
        units = {"units": unit, "long_name": about}
        data[name] = (("run", "step", dimension), padded(parts, (length, count)), units)
    coords = {
        "line": np.array([line.name for line in lines], dtype=str),
        "pier_part": np.array([pier.name for pier in piers], dtype=str),
    }
    return data, coords


def _history(name: str, task: "Task", history: StructureHistory) -> Floats:
    """One history of all lines or piers of a run, [step, part]."""
    if name.startswith("line_"):
        book = name.removeprefix("line_")
        lines = range(len(task.lines))
        return np.column_stack([history.bearing(b)[book] for b in lines])
    place = ("pier_part_displacement", "pier_part_rotation", "pier_part_moment").index(name)
    piers = task.prepared.piers
    return np.column_stack([_pier_histories(task, history, *pier)[place] for pier in piers])


def has_parts(dataset: xr.Dataset) -> bool:
    """Whether there are several lines or piers, with rows of their own."""
    return "line" in dataset.coords


def told_of_parts(dataset: xr.Dataset) -> str:
    """Which line and pier tables and histories are about, where there are several; else empty."""
    if not has_parts(dataset) or "line" not in dataset.attrs:  # results before 0.2
        return ""
    names = {part: str(dataset.attrs[part]) for part in ("line", "pier")}
    told = [n if n.lower().startswith(part) else f"{part} {n}" for part, n in names.items()]
    return ", ".join(told)


def parts_table(dataset: xr.Dataset, dimension: str, columns: dict[str, Any]) -> pd.DataFrame:
    """One row for each run and line (`LINES`) or pier (`PIERS`)."""
    if not has_parts(dataset):
        return pd.DataFrame()
    modes = any(str(mode) for mode in dataset["mode"].values)
    told = {key: name for key, name in RUN.items() if key != "mode" or modes}
    rows = []
    for run in range(dataset.sizes["run"]):
        who = {name: dataset[key].values[run] for key, name in told.items()}
        for k, part in enumerate(dataset[dimension].values):
            own = {
                name: dataset[key].values[run, k]
                for key, (_, name) in columns.items()
                if key in dataset  # earlier results have fewer
            }
            rows.append(who | {dimension.removesuffix("_part"): str(part)} | own)
    return pd.DataFrame(rows)


def parts_columns(dataset: xr.Dataset, count: int) -> dict[str, Floats]:
    """Histories of lines and piers of one run, by column of history.csv."""
    if not has_parts(dataset):
        return {}
    found = {}
    for name, (dimension, _, _, column) in HISTORIES.items():
        for k, part in enumerate(dataset[dimension].values):
            values = dataset[name].values[:count, k]
            if np.isfinite(values).any():
                found[f"{part}_{column}"] = values
    return found


# What: table of a study with several lines or piers, who, column; column of the table otherwise.
GOVERNED = {
    "bearing strain": ("lines", "line", "strain_max", "bearing_strain_max"),
    "bearing displacement [mm]": ("lines", "line", "displacement_max_mm", ""),
    "force of one bearing [kN]": ("lines", "line", "force_max_kN", "bearing_force_max_kN"),
    "lead [degC]": ("lines", "line", "lead_max_degC", ""),
    "pier displacement [mm]": (
        "piers",
        "pier",
        "displacement_max_mm",
        "pier_displacement_max_mm",
    ),
    "pier ductility": ("piers", "pier", "ductility", "pier_ductility"),
    "deck displacement [mm]": ("", "", "", "deck_displacement_max_mm"),
}


def governing_runs(result: "EarthquakeResult") -> pd.DataFrame:
    """The largest of every peak over all runs, lines and piers of each bearing.

    Parameters
    ----------
    result : a study.

    Returns
    -------
    DataFrame : bearing, what, largest, part (line or pier; empty where there is one), motion,
        ambient_degC; a row for each bearing and peak that is known. Of studies in a laboratory
        both modes count.

    Examples
    --------
    >>> import thermobearing as tb
    >>> study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=12)
    >>> governing_runs(study).set_index("what").loc["pier ductility", "ambient_degC"]
    np.float64(-20.0)
    """
    rows = []
    whole = result.table  # each is made anew whenever it is asked for
    parts = {"": pd.DataFrame(), "lines": result.lines, "piers": result.piers}
    for bearing in dict.fromkeys(whole["bearing"]):
        for what, (name, who, column, plain) in GOVERNED.items():
            table = parts[name]
            column, part = (column, who) if len(table) else (plain, "")
            table = table if len(table) else whole
            mine = table[table["bearing"] == bearing]
            if column not in mine or not mine[column].notna().any():
                continue
            worst = mine.loc[mine[column].idxmax()]
            rows.append(
                {
                    "bearing": bearing,
                    "what": what,
                    "largest": float(worst[column]),
                    "part": str(worst[part]) if part else "",
                    "motion": str(worst["motion"]),
                    "ambient_degC": float(worst["ambient_degC"]),
                }
            )
    return pd.DataFrame(rows)
