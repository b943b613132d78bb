"""Tables of a cyclic test that an engineer can quote: cycles, the cold beside the warm, heat."""

import math
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.cyclic.result import Result, run_name
from thermobearing.report.limits import MARKED, beyond_mark
from thermobearing.report.pieces import Column, ReportTable
from thermobearing.results import drawing

KJ = 1e-3
MOST_ROWS = 60
AMBIENT = Column("Ambient", "°C", "g")


def shown_cycles(cycles: pd.DataFrame) -> pd.DataFrame:
    """First and last cycle of each amplitude of each run; every one of a short record."""
    if not len(cycles):
        return cycles
    group = _block(cycles)
    first = group != group.shift()
    last = group != group.shift(-1)
    chosen = cycles[first | last]
    return cycles if len(cycles) <= MOST_ROWS // 3 else chosen.head(MOST_ROWS)


def _block(cycles: pd.DataFrame) -> pd.Series:
    """A number for each loading: cycles of one run that follow each other."""
    new = (cycles["cycle"].diff() != 1) | (cycles["ambient_degC"].diff() != 0)
    return new.cumsum()


def cycles_table(result: Result) -> ReportTable:
    """Measures of the first and the last cycle of each amplitude."""
    cycles, ranges = shown_cycles(result.cycles), result.tested_range.to_dict("records")
    stress = result.dataset.attrs["area_mm2"] / 1e3
    inner, names = inner_layer(result), list(result.cycles.columns)
    heat: list[tuple[Column, str]] = []
    if inner in names:
        heat.append((Column("Inner rubber", "°C", ".1f"), inner))
    if "lead_degC" in names:
        heat.append((Column("Lead", "°C", ".1f"), "lead_degC"))
    columns = [
        AMBIENT,
        Column("Strain", "%", ".0f"),
        Column("Cycle", form="d"),
        Column("G_e", "MPa", ".3f"),
        Column("K_eq", "kN/mm", ".3f"),
        Column("h_eq", "", ".3f"),
        Column("Energy", "kJ", ".2f"),
        Column("Peak force", "kN", ".0f"),
        Column("Q_d", "kN", ".1f"),
        Column("K_d", "kN/mm", ".3f"),
        *(column for column, _ in heat),
    ]
    rows: list[tuple[Any, ...]] = []
    marked: set[tuple[int, int]] = set()
    for row in cycles.to_dict("records"):
        run, place = run_name(float(row["ambient_degC"])), len(rows)
        rows.append(
            (
                float(row["ambient_degC"]),
                100.0 * row["amplitude_strain"],
                int(row["cycle"]),
                row["G_eq_MPa"],
                row["K_eq_kN_mm"],
                row["h_eq"],
                KJ * row["energy_kN_mm"],
                stress * max(row["stress_max_MPa"], -row["stress_min_MPa"]),
                row["characteristic_strength_kN"],
                row["post_yield_stiffness_kN_mm"],
                *(float(row[name]) for _, name in heat),
            )
        )
        asked = {
            0: ("ambient", row["ambient_degC"]),
            1: ("strain", row["amplitude_strain"]),
            2: ("cycles", row["cycle"]),
            10 + len(heat) - 1: ("lead_temperature", row.get("lead_degC", math.nan)),
        }
        marked |= {
            (place, column)
            for column, (limit, value) in asked.items()
            if value == value and beyond_mark(ranges, run, limit, float(value))
        }
    of = "each cycle" if len(cycles) == len(result.cycles) else "first and last cycle"
    note = "G_e: equivalent shear modulus (Eq. 3.1); h_eq: equivalent damping ratio (Eq. 3.2); "
    note += "Q_d, K_d: characteristic strength and post-yield stiffness of the bearing; "
    note += "temperatures at the end of the cycle."
    note += f" {MARKED}." if marked else ""
    caption = f"Measures of {of} of each amplitude" if of != "each cycle" else f"Measures of {of}"
    return ReportTable(caption, columns, rows, 3, frozenset(marked), note)


def inner_layer(result: Result) -> str:
    """Column of `Result.cycles` of the layer that gets warmest by its place."""
    layers = int(result.dataset.sizes.get("layer", 1))
    half = bool(result.dataset.attrs["half_stack"])
    return f"rubber{layers if half else layers // 2 + 1}_degC"


def cold_table(result: Result) -> ReportTable | None:
    """Last cycle of each amplitude over that at the warmest ambient; None with one temperature."""
    cycles = result.cycles
    if not len(cycles) or cycles["ambient_degC"].nunique() < 2:
        return None
    last = cycles[_block(cycles) != _block(cycles).shift(-1)]
    warmest = float(last["ambient_degC"].max())
    names = {
        "G_eq_MPa": Column("G_e ratio", "", ".2f"),
        "h_eq": Column("h_eq ratio", "", ".2f"),
        "energy_kN_mm": Column("Energy ratio", "", ".2f"),
        "characteristic_strength_kN": Column("Q_d ratio", "", ".2f"),
    }
    rows = []
    warm = last[last["ambient_degC"] == warmest].reset_index(drop=True)
    for ambient in sorted(set(last["ambient_degC"]) - {warmest}):
        mine = last[last["ambient_degC"] == ambient].reset_index(drop=True)
        for k in range(min(len(mine), len(warm))):
            if mine["cycle"][k] != warm["cycle"][k]:  # a run that ended early
                continue
            share = [float(mine[name][k] / warm[name][k]) for name in names]
            strain = 100.0 * float(mine["amplitude_strain"][k])
            rows.append((float(ambient), strain, int(mine["cycle"][k]), *share))
    if not rows:
        return None
    columns = [AMBIENT, Column("Strain", "%", ".0f"), Column("Cycle", form="d"), *names.values()]
    caption = f"The cold: last cycle of each amplitude over that at {warmest:g} °C"
    return ReportTable(caption.replace("-", "\N{MINUS SIGN}"), columns, rows, 3)


def warming_table(result: Result) -> ReportTable | None:
    """Largest rise of each rubber layer and of the lead over the start, a row per temperature."""
    data = result.dataset
    if "rubber_temperature" not in data:
        return None
    names = drawing.layer_names(data.sizes["layer"], bool(data.attrs["half_stack"]))
    places = [0, len(names) - 1] if len(names) > 3 else list(range(len(names)))
    columns = [AMBIENT]
    for place in places:
        columns += [Column(f"{names[place]}: highest", "°C", ".1f"), Column("rise", "K", ".1f")]
    if result.has_lead:
        columns += [Column("lead: highest", "°C", ".1f"), Column("rise", "K", ".1f")]
    rows = []
    for run, ambient in enumerate(data["ambient"].values):
        told = data["segment"].values[run] >= 0
        histories = [data["rubber_temperature"].values[run, told, place] for place in places]
        if result.has_lead:
            histories.append(data["lead_temperature"].values[run, told])
        values: list[Any] = [float(ambient)]
        for history in histories:
            values += [float(history.max()), float(history.max() - history[0])]
        rows.append(tuple(values))
    return ReportTable("Warming during the test", columns, rows)


def books_table(result: Result) -> ReportTable:
    """Energy books at the end of each run."""
    columns = [
        AMBIENT,
        Column("Work in", "kJ", ".2f"),
        Column("Heat released", "kJ", ".2f"),
        Column("Recoverable", "kJ", ".3f"),
        Column("Heat stored", "kJ", ".2f"),
        Column("Heat lost, ends", "kJ", ".2f"),
        Column("Heat lost, sides", "kJ", ".2f"),
        Column("Residual, mechanical", "", ".1e"),
        Column("Residual, thermal", "", ".1e"),
    ]
    names = ["work_in", "heat_released", "recoverable", "heat_stored", "heat_lost_ends"]
    names.append("heat_lost_sides")
    rows = [
        (
            row["ambient_degC"],
            *(KJ * row[f"{name}_kN_mm"] for name in names),
            row["mechanical_residual"],
            row["thermal_residual"],
        )
        for row in result.energy.to_dict("records")
    ]
    note = "Work in = heat released + recoverable; heat released = stored + lost. Residuals are "
    note += "relative to the largest of these energies."
    return ReportTable("Energy books at the end of each run", columns, rows, note=note)


def peaks(result: Result, run: int) -> tuple[float, float]:
    """Largest |force| [kN] and |strain| of a run."""
    force, strain = (result[name].values[run] for name in ("force", "strain"))
    return float(np.nanmax(np.abs(force))), float(np.nanmax(np.abs(strain)))
