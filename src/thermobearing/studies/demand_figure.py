"""Demand against temperature: median, fractiles, and what is known of the median."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.studies.labels import title_of, words_of

WIDTH, HEIGHT, MOST_COLUMNS = 2.3, 2.7, 4
BANDS = (("0.05", "0.95", 0.15), ("0.16", "0.84", 0.3))
COLOUR = "#0077BB"


def draw_demand(
    found: pd.DataFrame, demand: str, across: str, by: Sequence[str], note: str, capacity: float
) -> Figure:
    """A panel for each combination of `by`.

    Parameters
    ----------
    found : of `demand_against`.
    demand, across, by : as given to it.
    note : what became of runs that failed.
    capacity : of the demand, drawn as a line; NaN for none.
    """
    groups = found.groupby(list(by), sort=False, observed=True) if by else [((), found)]
    cells = [(label, rows) for label, rows in groups]
    columns = min(len(cells), MOST_COLUMNS)
    rows_ = -(-len(cells) // columns)
    size = (max(WIDTH * columns, 4.6) + 0.6, HEIGHT * rows_ + 0.9)
    title = f"{words_of(demand)} against {words_of(across)}: {note}"
    figure, axes = drawing.panels(rows_, columns, size, title, share=True)
    for ax in axes[len(cells) :]:
        ax.set_visible(False)
    for place, (ax, (label, rows)) in enumerate(zip(axes, cells, strict=False)):
        _draw(ax, rows, across, capacity)
        last = place + columns >= len(cells)
        first = place % columns == 0
        drawing.name_axes(ax, title_of(across) if last else "", title_of(demand) if first else "")
        ax.set_title(
            ", ".join(map(str, label)), fontsize=drawing.SMALL, fontweight="bold", color=drawing.INK
        )
        ax.tick_params(labelbottom=last)
    top = np.nanmax(np.where(np.isinf(found["0.95"]), np.nan, found["0.95"]), initial=0.0)
    largest = max(float(top), capacity if np.isfinite(capacity) else 0.0)
    axes[0].set_ylim(0.0, 1.08 * largest or 1.0)
    drawing.legend_below(figure, _handles(capacity))
    return figure


def _draw(ax: Axes, rows: pd.DataFrame, across: str, capacity: float) -> None:
    """Bands between fractiles, the median with its own band, the mean."""
    x = rows[across].to_numpy(dtype=float)
    values = {
        name: rows[name].to_numpy(dtype=float)
        for name in rows
        if name not in (across,) and pd.api.types.is_numeric_dtype(rows[name])
    }
    for low, high, alpha in BANDS:
        ax.fill_between(x, values[low], values[high], color=COLOUR, alpha=alpha, linewidth=0)
    median = values["0.5"]
    known = np.isfinite(values["median_low"]) & np.isfinite(values["median_high"])
    reach = [
        (median - values["median_low"])[known],
        (values["median_high"] - median)[known],
    ]
    ax.plot(x, median, color=COLOUR, linewidth=1.4, marker="o", markersize=3)
    ax.errorbar(x[known], median[known], yerr=reach, fmt="none", ecolor=COLOUR, elinewidth=1.0)
    ax.plot(x, values["mean"], color=drawing.INK, linewidth=0.9, linestyle="--")
    if np.isfinite(capacity):
        ax.axhline(capacity, **drawing.LIMIT)


def _handles(capacity: float) -> list[Line2D]:
    """Legend entries."""
    look: drawing.Look = {"color": COLOUR}
    found = [
        Line2D([], [], marker="o", markersize=3, linewidth=1.4, label="median, 95 % band", **look),
        Line2D([], [], linewidth=6, alpha=0.45, label="16 to 84 % of runs", **look),
        Line2D([], [], linewidth=6, alpha=0.15, label="5 to 95 %", **look),
        Line2D([], [], color=drawing.INK, linewidth=0.9, linestyle="--", label="mean"),
    ]
    if np.isfinite(capacity):
        found.append(Line2D([], [], label="capacity", **drawing.LIMIT))
    return found
