"""How much each slip of the printed heat scheme matters: `conservative` becomes `published`.

A slip is a change of the numbers that the one coupled step is given (rates of the cells, ways of
heat out of lead), so that no step is written twice. The last model of a chain is the published
scheme itself.
"""

from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from reproduction.runs import Runs, source_bearing
from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.core.types import Constants
from thermobearing.cyclic.history import build_segments, run_segments
from thermobearing.cyclic.protocol import Wave, cyclic_test
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.run import Device, build_tasks, run_task
from thermobearing.model.options import BearingModel, ModelOptions, build_model
from thermobearing.results.drawing import GREY, INK, SMALL, WIDEST, Look, name_axes, panels

PLATES, CLOCK, REFERENCE, BOOKKEEPING = "half-space", "clock", "reference", "bookkeeping"
SHIMS, SIDES, REST = "shims", "side loss", "rest"
SLIPS = {  # in the order in which they are put in: what the print does instead of what
    PLATES: "ends of the lead on a half-space (Eq. 5.3, 5.5; no slip) instead of finite plates",
    CLOCK: "clock of Eq. 5.6 with the diffusivity of lead instead of steel",
    REFERENCE: "lead loses heat towards the ambient (Eq. 5.31) instead of the plate it touches",
    BOOKKEEPING: "n_l twice, and c rho of lead in the plate (Eq. 5.13, 5.21)",
    SHIMS: "shims receive twice the heat that the rubber loses (P1: Eq. 4.28, 4.31, 5.27, 5.30)",
    SIDES: "side loss with c rho of rubber in steel too, explicit in time (P2: Eq. 4.10, 4.23)",
    REST: "gross area everywhere, and no heat from the rate-dependent branch",
}
OF_LEAD = (PLATES, CLOCK, REFERENCE, BOOKKEEPING, REST)
# What a slip cannot be without.
NEEDS = {CLOCK: {PLATES}, REFERENCE: {PLATES}, BOOKKEEPING: {PLATES, REFERENCE}}
BEARINGS = {"HDR": "shen-hdr", "LHDR": "shen-lhdr"}  # and -specimen, -bridge
AMBIENT = -20.0  # [degC], where it matters most
STRAIN, MOTION = 2.5, "jra-ii-i-1"
QUANTITIES = {
    "inner_layer_K": "rise of the inner layer, 250 %, five cycles [K]",
    "lead_K": "rise of the lead, the same [K]",
    "steel_at_lead_K": "rise of the end plate next to rubber or sealing plate, the same [K]",
    "force_kN": "force of the fifth cycle, the same [kN]",
    "energy_kN_mm": "energy of the five cycles [kN mm]",
    "bridge_inner_layer_K": "rise of the inner layer, bridge, II-I-1 [K]",
    "bridge_force_kN": "force of a bearing, bridge [kN]",
    "bridge_energy_kN_mm": "energy of a bearing, bridge [kN mm]",
    "pier_ductility": "ductility of the pier, bridge",
}


class SlipRow(NamedTuple):
    """A model: "HDR" or "LHDR", its slip (a key of `SLIPS`, "" for none) and what came out.

    `kind` is "chain", on top of all before, or "alone"; `values` are by the keys of `QUANTITIES`,
    NaN for lead where there is none.
    """

    bearing: str
    kind: str
    slip: str
    values: dict[str, float]


def possible_slips(bearing: Bearing) -> list[str]:
    """Return what the bearing can have: none of lead without lead, no side loss without film."""
    lead, film = bearing.lead is not None, bearing.materials.side_film > 0.0
    return [slip for slip in SLIPS if (lead or slip not in OF_LEAD) and (film or slip != SIDES)]


def with_slips(bearing: Bearing, slips: set[str]) -> BearingModel:
    """Return the conservative model with some slips; with all of them, the published one.

    The bearing has one cell in a shim, as in Fig. 4.2b and 5.2b, or P1 has nothing to act on. All
    slips of the lead but `half-space` need that one; `bookkeeping` needs `reference`, since the
    print has no bookkeeping towards the plate: without it there is a ValueError.
    """
    lead = bearing.lead is not None
    for slip in slips:
        if lead and not NEEDS.get(slip, set()) <= slips:
            raise ValueError(f'slip "{slip}" needs {sorted(NEEDS[slip])}')
    half_space: dict[str, Any] = {}
    if lead and PLATES in slips:
        half_space = {"lead_ends": "half-space", "clock": "lead" if CLOCK in slips else "steel"}
    model = build_model(bearing, ModelOptions(**half_space))
    clock = half_space.get("clock")
    printed = build_model(bearing, ModelOptions(scheme="published", clock=clock)).constants
    constants = model.constants
    if REST in slips:
        constants = _printed_flow(constants, printed, model)
    if SHIMS in slips:
        constants = _doubled(constants, model, 2.0)
    if SIDES in slips:
        cells = constants.cells._replace(side_loss=printed.cells.side_loss)
        constants = constants._replace(cells=cells, side_implicit=printed.side_implicit)
    if lead and REFERENCE in slips:
        constants = constants._replace(lead=printed.lead, lead_cells=printed.lead_cells)
        if BOOKKEEPING not in slips:
            constants = _mended_bookkeeping(constants)
    return replace(model, constants=constants)


def _doubled(constants: Constants, model: BearingModel, factor: float) -> Constants:
    """What shims of one cell exchange with their neighbours, times a factor, on their side only."""
    cells, times = constants.cells, np.where(model.stack.lone_shim, factor, 1.0)
    cells = cells._replace(to_previous=cells.to_previous * times, to_next=cells.to_next * times)
    return constants._replace(cells=cells)


def _printed_flow(constants: Constants, printed: Constants, model: BearingModel) -> Constants:
    """One-dimensional flow without areas, and a rate-dependent branch that heats nothing."""
    rates = _doubled(printed, model, 0.5).cells  # P1 is a slip of its own
    cells = constants.cells._replace(
        to_previous=rates.to_previous, to_next=rates.to_next, end_loss=rates.end_loss
    )
    return constants._replace(cells=cells, viscous=printed.viscous)


def _mended_bookkeeping(constants: Constants) -> Constants:
    """One core loses its own flux, and the plates gain what all of them lose.

    `published_exchange` makes a core lose n_l times `end_conductance` and `side_conductance`, and
    a plate cell gain n_l `end`/(fold c rho V_l) of the lead: the numbers take both out.
    """
    lead, touched = constants.lead, constants.lead_cells.copy()
    for k in range(len(touched)):
        capacity = constants.cells.capacity[touched[k].cell]
        factor = lead.fold * lead.capacity / (lead.cores * capacity)
        touched[k].end *= factor
        touched[k].side *= factor
    lead = lead._replace(
        end_conductance=lead.end_conductance / lead.cores,
        side_conductance=lead.side_conductance / lead.cores,
    )
    return constants._replace(lead=lead, lead_cells=touched)


def _cyclic_values(bearing: Bearing, model: BearingModel, wave: Wave) -> dict[str, float]:
    """Five cycles of 250 %."""
    test = cyclic_test(strain=[STRAIN], wave=wave, closing_strain=None)
    cells = len(model.constants.cells.capacity)
    history = run_segments(
        model.constants,
        build_segments(test, bearing.total_rubber_thickness),
        Ambient.constant(AMBIENT),
        np.full(cells, AMBIENT),
        groups=("rubber", "cells"),
    )
    response, fifth = history.rows.response, history.cycle == history.cycle.max()
    end = int(np.flatnonzero(np.array(model.stack.part) == "end_plate")[-1])
    lead = float(response["lead_temperature"][-1]) - AMBIENT if bearing.lead else float("nan")
    return {
        "inner_layer_K": float(history.rows.rubber[-1, -1]) - AMBIENT,
        "lead_K": lead,
        "steel_at_lead_K": float(history.rows.cells[-1, end]) - AMBIENT,
        "force_kN": float(np.abs(response["force"][fifth]).max()),
        "energy_kN_mm": float(response["work_in"][-1]),
    }


def _bridge_values(bearing: Bearing, model: BearingModel) -> dict[str, float]:
    """Pier P1 in II-I-1."""
    case = make_earthquake_case(
        {"command": "bridge"}, "slips", bearings=[bearing], motions=[MOTION], ambient=[AMBIENT]
    )
    (task,) = build_tasks(case)
    device = Device(bearing, model.constants, model.stack)
    lines = tuple(line._replace(device=device) for line in task.lines)
    task = replace(task, device=device, lines=lines)
    result = label_analysis(case, [task], [run_task(task)])
    row = result.table.iloc[0]
    inner = result["rubber_temperature"].values[0, :, -1]
    return {
        "bridge_inner_layer_K": float(np.nanmax(inner)) - AMBIENT,
        "bridge_force_kN": float(row["bearing_force_max_kN"]),
        "bridge_energy_kN_mm": float(row["bearing_energy_kN_mm"]),
        "pier_ductility": float(row["pier_ductility"]),
    }


def _as_in_print(bearing: Bearing) -> Bearing:
    """With two cells in a layer and one in a shim, as Fig. 4.2b and 5.2b: P1 is of such shims."""
    cells = bearing.cells.model_copy(update={"rubber": 2, "shim": 1})
    return bearing.model_copy(update={"cells": cells})


def slip_values(kind: str, slips: frozenset[str]) -> dict[str, float]:
    """Return what a specimen and a bridge bearing with some slips give, by `QUANTITIES`."""
    specimen = _as_in_print(source_bearing(f"{BEARINGS[kind]}-specimen"))
    bridge = _as_in_print(source_bearing(f"{BEARINGS[kind]}-bridge"))
    wave: Wave = "sine" if specimen.lead else "triangular"
    values = _cyclic_values(specimen, with_slips(specimen, set(slips)), wave)
    return values | _bridge_values(bridge, with_slips(bridge, set(slips)))


def slip_rows() -> list[SlipRow]:
    """Return all models of both bearings: each slip on top of those before it, and each alone.

    A slip alone is compared with the model that has what it needs but not itself: the clock on a
    half-space, the bookkeeping with the ambient as reference. Its values are those of the model
    without slips times that change. The first of a bearing has no slip; the last of its chain is
    `published`.
    """
    rows: list[SlipRow] = []
    cached_values = cache(slip_values)
    for kind, name in BEARINGS.items():
        slips = possible_slips(load_bearing(f"{name}-specimen"))
        start = cached_values(kind, frozenset())
        rows.append(SlipRow(kind, "chain", "", start))
        for k, slip in enumerate(slips, 1):
            rows.append(SlipRow(kind, "chain", slip, cached_values(kind, frozenset(slips[:k]))))
        for slip in slips:
            # Some slips act on another one only: both models of the pair have that one.
            needed = NEEDS.get(slip, set()) if kind == "LHDR" else set()
            reference, changed = (
                cached_values(kind, frozenset(needed)),
                cached_values(kind, frozenset({*needed, slip})),
            )
            values = {key: start[key] * changed[key] / reference[key] for key in start}
            rows.append(SlipRow(kind, "alone", slip, values))
    return rows


def slips_table(rows: list[SlipRow]) -> pd.DataFrame:
    """Return one row for each model: bearing, kind, slip, what it is, every quantity, its change.

    Changes [%] are of a chain against the model before, of a slip alone against the first model.
    """
    lines, last = [], dict[tuple[str, str], SlipRow]()
    for row in rows:
        start = last.setdefault((row.bearing, ""), row)
        reference = last.get((row.bearing, row.kind), start)
        line: dict[str, Any] = {"bearing": row.bearing, "kind": row.kind, "slip": row.slip}
        line["means"] = SLIPS.get(row.slip, "conservative scheme, no slip")
        for key, value in row.values.items():
            line[key] = value
            line[f"{key}_change_percent"] = 100.0 * (value / reference.values[key] - 1.0)
        lines.append(line)
        if row.kind == "chain":
            last[row.bearing, row.kind] = row
    return pd.DataFrame(lines)


def total_change(rows: list[SlipRow], bearing: str, quantity: str) -> float:
    """Return the change from `conservative` to `published`, all slips together [%]."""
    chain = [row for row in rows if row.bearing == bearing and row.kind == "chain"]
    return 100.0 * (chain[-1].values[quantity] / chain[0].values[quantity] - 1.0)


def all_tables(runs: Runs) -> dict[str, pd.DataFrame]:
    """Return the table of slips, by name."""
    return {"slips": slips_table(runs.once(slip_rows, "slips"))}


CAPTION = (
    "Slips of the printed heat scheme, one by one: change of the rise of the inner layer, of the "
    "rise of the lead, of the force in the fifth cycle and of the energy (five cycles of 250 % at "
    "-20 degC, specimens), and of the pier's ductility (bridge, II-I-1, -20 degC), against the "
    "conservative scheme. These are predictions; Shen (2023) has no such figure."
)
SHOWN = {
    "inner_layer_K": "inner layer",
    "lead_K": "lead",
    "force_kN": "force",
    "energy_kN_mm": "energy",
    "pier_ductility": "ductility",
}
SHORT = {
    "half-space": "half-space",
    "clock": "clock of lead",
    "reference": "reference: air",
    "bookkeeping": "bookkeeping of lead",
    "shims": "shims (P1)",
    "side loss": "side loss (P2)",
    "rest": "areas, rate branch",
}
ALL = "all: published"
COLOURS = {"HDR": "#0077BB", "LHDR": "#EE7733"}  # Paul Tol's "vibrant"
THICK = 0.36
NEGLIGIBLE = 0.05  # [%]: told as 0.0
ROOM = 2.4  # of the largest bar, for the numbers beside the bars


def draw_slips(rows: list[SlipRow]) -> Figure:
    """Draw bars of both bearings for each slip, one panel for each quantity."""
    title = "Deviations of the published scheme, one by one"
    figure, axes = panels(1, len(SHOWN), (WIDEST, 3.6), title)
    places = {name: -float(k) for k, name in enumerate([*SLIPS, ALL])}
    for ax, (quantity, name) in zip(axes, SHOWN.items(), strict=True):
        names = [SHORT.get(key, key) if ax is axes[0] else "" for key in places]
        ax.set_yticks(list(places.values()), names)
        ax.set_ylim(min(places.values()) - 0.6, 0.6)
        bars = _bars(rows, quantity)
        for (kind, slip), value in bars.items():
            y = places[slip] + (0.5 if kind == "HDR" else -0.5) * THICK
            ax.barh(y, value, THICK, color=COLOURS[kind], linewidth=0)
            text = f"{value:+.1f}" if abs(value) >= NEGLIGIBLE else "0.0"
            style: Look = {"fontsize": SMALL - 1.5, "color": INK, "va": "center"}
            style["ha"], gap = ("left", 2.0) if value >= 0.0 else ("right", -2.0)
            text = text.replace("-", "\N{MINUS SIGN}")
            ax.annotate(text, (value, y), (gap, 0.0), textcoords="offset points", **style)
        largest = max(1.0, *(abs(value) for value in bars.values()))
        ax.set_xlim(-ROOM * largest, ROOM * largest)
        ax.axvline(0.0, color=GREY, linewidth=0.8)
        ax.axhline(0.5 * (places["rest"] + places[ALL]), color=GREY, linewidth=0.6)
        name_axes(ax, "change [%]", title=name)
    handles = [Patch(color=COLOURS[kind], label=kind) for kind in BEARINGS]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=2, fontsize=SMALL, frameon=False
    )
    return figure


def _bars(rows: list[SlipRow], quantity: str) -> dict[tuple[str, str], float]:
    """Change [%] by bearing and slip; without those that a bearing cannot have."""
    changes = {}
    first = {row.bearing: row.values[quantity] for row in reversed(rows) if row.slip == ""}
    for row in rows:
        if row.kind == "alone":
            value = 100.0 * (row.values[quantity] / first[row.bearing] - 1.0)
            changes[row.bearing, row.slip] = value
    for kind in BEARINGS:
        changes[kind, ALL] = total_change(rows, kind, quantity)
    return {key: value for key, value in changes.items() if np.isfinite(value)}
