"""The figure of slips.py: what each slip of the printed heat scheme changes, and all of them."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from thermobearing.reproduce.runs import Runs
from thermobearing.reproduce.slips import BEARINGS, SLIPS, SlipRow, rows_of, total_change
from thermobearing.results.drawing import (
    GREY,
    INK,
    SMALL,
    WIDEST,
    Look,
    name_axes,
    panels,
)

CAPTION = (
    "Slips of the printed heat scheme, one by one: change of the rise of the inner layer, of the "
    "rise of the lead, of the force in the fifth cycle and of the energy (five cycles of 250 % at "
    "-20 degC, specimens), and of the pier's ductility (bridge, II-I-1, -20 degC), against the "
    "conservative scheme. Predictions; the source has no such figure."
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


def draw(runs: Runs) -> Figure:
    """Of the rows of the table of slips."""
    return draw_slips(rows_of(runs))


def draw_slips(rows: list[SlipRow]) -> Figure:
    """Bars of both bearings for each slip, a panel a quantity.

    Parameters
    ----------
    rows : of `slip_rows`.
    """
    figure, axes = panels(1, len(SHOWN), (WIDEST, 3.6), "Slips of the print, one by one")
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
            look: Look = {"fontsize": SMALL - 1.5, "color": INK, "va": "center"}
            side = "left" if value >= 0.0 else "right"
            gap = 2.0 if value >= 0.0 else -2.0
            ax.annotate(
                text.replace("-", "\N{MINUS SIGN}"),
                (value, y),
                (gap, 0.0),
                textcoords="offset points",
                ha=side,
                **look,
            )
        most = max(1.0, *(abs(value) for value in bars.values()))
        ax.set_xlim(-ROOM * most, ROOM * most)
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
    found = {}
    first = {row.bearing: row.values[quantity] for row in reversed(rows) if row.slip == ""}
    for row in rows:
        if row.kind == "alone":
            value = 100.0 * (row.values[quantity] / first[row.bearing] - 1.0)
            found[row.bearing, row.slip] = value
    for kind in BEARINGS:
        found[kind, ALL] = total_change(rows, kind, quantity)
    return {key: value for key, value in found.items() if np.isfinite(value)}
