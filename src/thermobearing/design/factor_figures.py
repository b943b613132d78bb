"""Figures of temperature factors and of the size effect."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.results import drawing

Floats = NDArray[np.float64]
LOOKS = {
    "first": ("#0072B2", "first cycle"),
    "heated": ("#D55E00", "with self-heating"),
    "mean": ("#009E73", "mean of the cycles"),
}
OTHERS = ("#666666", "#999999", "#bbbbbb")


def draw_factors(
    table: pd.DataFrame,
    strain: float,
    reference: float,
    title: str,
    published: Sequence[Any] = (),
) -> Figure:
    """One panel per quantity; bands where the table has them; published factors dotted, at their
    own reference temperature; unverified ones say so.
    """
    quantities = list(dict.fromkeys(table["quantity"]))
    figure, axes = drawing.panels(1, len(quantities), (3.0 * len(quantities), 3.8), title)
    for ax, quantity in zip(axes, quantities, strict=True):
        rows = table[(table["quantity"] == quantity) & (table["strain"] == strain)]
        for basis, (colour, _) in LOOKS.items():
            one = rows[rows["basis"] == basis].sort_values("ambient_degC")
            x = one["ambient_degC"].to_numpy()
            if np.isfinite(one["factor_low"]).all():
                low, high = one["factor_low"].to_numpy(), one["factor_high"].to_numpy()
                ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
            ax.plot(x, one["factor"].to_numpy(), color=colour, linewidth=1.3)
        mine = [item for item in published if item.quantity == quantity]
        for item, colour in zip(mine, OTHERS, strict=False):
            ax.plot(
                item.temperatures,
                item.factors,
                color=colour,
                linestyle=":",
                marker="x",
                markersize=3.5,
                linewidth=1.0,
                label=item.label,
            )
        if mine:
            ax.legend(fontsize=drawing.SMALL - 1.5, frameon=False)
        ax.axvline(reference, color=drawing.GREY, linewidth=0.7)
        ax.axhline(1.0, color=drawing.GREY, linewidth=0.7)
        drawing.name_axes(
            ax, "ambient temperature [°C]", "", f"{quantity} / {quantity} at reference"
        )
        ax.title.set_fontsize(drawing.SMALL)
    handles = [Line2D([], [], color=colour, label=label) for colour, label in LOOKS.values()]
    drawing.legend_below(figure, handles)
    return figure


def draw_scale(
    histories: dict[float, tuple[Floats, dict[str, Floats]]],
    loops: dict[float, tuple[Floats, Floats]],
    title: str,
) -> Figure:
    """Rises [K] in time [s] by size, and loops (strain, stress [MPa])."""
    figure, (left, right) = drawing.panels(1, 2, (10.0, 4.2), title)
    colours = drawing.ordered_colours(len(histories), "viridis")
    lines: dict[str, Any] = {"inner layer": "-", "outer layer": "--", "lead": ":"}
    for (factor, (time, rises)), colour in zip(histories.items(), colours, strict=True):
        for name, values in rises.items():
            left.plot(time, values, color=colour, linestyle=lines[name], linewidth=1.2)
        strain, stress = loops[factor]
        kept = drawing.thin_loops(strain, stress, float(np.ptp(strain)), float(np.ptp(stress)))
        right.plot(100.0 * strain[kept], stress[kept], color=colour, linewidth=0.9)
    left.set_xscale("symlog", linthresh=20.0)
    left.set_xticks([0, 10, 20, 60, 600, 3600], ["0", "10", "20", "60", "600", "3600"])
    drawing.name_axes(left, "time [s]", "rise over the ambient [K]", "temperature")
    drawing.name_axes(right, "shear strain [%]", "stress [MPa]", "loops, cycles 1 to 5")
    names = {name for _, rises in histories.values() for name in rises}
    handles = [
        Line2D([], [], color=colour, label=f"scale {factor:.3g}")
        for factor, colour in zip(histories, colours, strict=True)
    ]
    handles += [
        Line2D([], [], color=drawing.INK, linestyle=style, label=name)
        for name, style in lines.items()
        if name in names
    ]
    drawing.legend_below(figure, handles)
    return figure
