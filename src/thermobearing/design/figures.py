"""Figures of a design: rounds of the loop, loops of equal bearings, bounds against the model."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from thermobearing.results import drawing

Floats = NDArray[np.float64]
BAND = "#c8ccd2"


def draw_rounds(assumed: Sequence[float], found: Sequence[float], title: str) -> Figure:
    """Assumed and found displacement, round by round."""
    figure, (ax,) = drawing.panels(1, 1, (6.5, 3.6), title)
    numbers = np.arange(1, len(assumed) + 1)
    ax.plot(numbers, assumed, color="#0072B2", marker="o", linewidth=1.2, label="assumed")
    ax.plot(numbers, found, color="#D55E00", marker="s", linewidth=1.2, label="found")
    ax.set_xticks(numbers)
    drawing.name_axes(ax, "round", "displacement of the bearing [mm]")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
    return figure


def draw_equal(loops: dict[str, tuple[Floats, Floats]], title: str) -> Figure:
    """Loops [mm, kN] by name, as Fig. 6.6."""
    figure, (ax,) = drawing.panels(1, 1, (6.0, 4.4), title)
    colours = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
    for (name, (x, force)), colour in zip(loops.items(), colours, strict=False):
        ax.plot(x, force, color=colour, linewidth=1.3, label=name)
    drawing.name_axes(ax, "displacement [mm]", "force [kN]")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
    return figure


def draw_bounds(table: pd.DataFrame, demands: dict[str, str], title: str) -> Figure:
    """Bars between the bounds, dots of the coupled model: a dot above its bar is unsafe."""
    names = [str(name) for name in table.columns]
    temperatures = [
        float(name.split("_")[1])
        for name in names
        if name.startswith("coupled_") and name.endswith("_degC") and name != "coupled_at_degC"
    ]
    colours = drawing.ambient_colours(np.array(temperatures))
    motions = list(dict.fromkeys(table["motion"]))
    wide = max(2.6, 0.42 * len(motions) + 1.2)
    figure, axes = drawing.panels(1, len(demands), (wide * len(demands), 4.0), title)
    for ax, (column, label) in zip(axes, demands.items(), strict=True):
        rows = table[table["demand"] == column].set_index("motion").loc[motions]
        low = rows[["lower_bound", "upper_bound"]].min(axis=1).to_numpy()
        high = rows[["lower_bound", "upper_bound"]].max(axis=1).to_numpy()
        at = np.arange(len(motions))
        ax.bar(at, high - low, bottom=low, width=0.62, color=BAND, zorder=1)
        for temperature, colour in zip(temperatures, colours, strict=True):
            values = rows[f"coupled_{temperature:g}_degC"].to_numpy()
            ax.plot(at, values, "o", color=colour, markersize=4.5, zorder=3)
        ax.set_ylim(bottom=0.0)
        ax.set_xticks(at, motions, rotation=60, ha="right", rotation_mode="anchor")
        drawing.name_axes(ax, "", "", label)
    handles = [
        Line2D([], [], color=c, marker="o", linestyle="none", label=drawing.degrees(t))
        for t, c in zip(temperatures, colours, strict=True)
    ]
    figure.legend(
        handles=[Patch(color=BAND, label="between the two bounds"), *handles],
        loc="outside lower center",
        ncols=len(handles) + 1,
        fontsize=drawing.SMALL,
        frameon=False,
    )
    return figure
