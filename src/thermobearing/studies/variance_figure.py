"""Share of each factor in the variance of a demand."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.studies.labels import words_of

KINDS = {
    "share": ("share by itself", "#0077BB"),
    "first": ("first order, by itself", "#0077BB"),
    "total": ("total, with all others", "#EE7733"),
}


def draw_variance(found: pd.DataFrame, demand: str) -> Figure:
    """Bars with bands, the largest factor above.

    Parameters
    ----------
    found : of `sobol_table` or `variance_shares`.
    demand : whose variance it is.
    """
    kinds = [kind for kind in KINDS if kind in found]
    by = "total" if "total" in found else "share"
    rest = found["factor"] == "together and the rest"
    rows = pd.concat([found[rest], found[~rest].sort_values(by)])
    size = (5.6, 1.2 + 0.42 * len(rows))
    title = f"what the variance of {words_of(demand)} comes from"
    figure, (ax,) = drawing.panels(1, 1, size, title)
    places = np.arange(len(rows), dtype=float)
    height = 0.7 / len(kinds)
    for number, kind in enumerate(kinds):
        share = 100.0 * rows[kind].to_numpy(dtype=float)
        low = 100.0 * rows[f"{kind}_low"].to_numpy(dtype=float)
        high = 100.0 * rows[f"{kind}_high"].to_numpy(dtype=float)
        at = places + height * (0.5 * (len(kinds) - 1) - number)
        ax.barh(at, share, height=0.9 * height, color=KINDS[kind][1], alpha=0.85)
        ax.hlines(at, low, high, color=drawing.INK, linewidth=1.0)
    ax.set_yticks(places, [words_of(str(name)).replace(", ", ",\n") for name in rows["factor"]])
    ax.grid(False, axis="y")
    ax.axvline(0.0, color=drawing.GREY, linewidth=0.7)
    lost, rows_ = int(found["left_out"].iloc[0]), int(found["rows"].iloc[0])
    kind = "rows of all matrices, {0} with failed runs" if "total" in found else "runs, {0} failed"
    drawing.name_axes(ax, f"share of the variance [%], {rows_} {kind.format(lost)} left out")
    handles = [
        Line2D([], [], color=KINDS[kind][1], linewidth=5, label=KINDS[kind][0]) for kind in kinds
    ]
    handles.append(Line2D([], [], color=drawing.INK, linewidth=1.0, label="95 % band"))
    drawing.legend_below(figure, handles)
    return figure
