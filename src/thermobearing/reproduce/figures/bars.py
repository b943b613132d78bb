"""Bars of one or two numbers of every run: motions beside each other, temperatures in colours."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

GROUP = 0.8  # of the distance between two motions
HEIGHT = 3.0  # of a panel [inch]


def draw_bars(
    result: EarthquakeResult,
    title: str,
    shown: Sequence[tuple[str, str, float]],
    yields: str = "",
) -> Figure:
    """A panel for each number, a group of bars for each motion.

    Parameters
    ----------
    result : a study of one bearing.
    title : of the figure.
    shown : column of the table, label with the unit, and factor, of each panel.
    yields : the column in which 1 is where the pier yields.
    """
    table = result.table
    ambients = sorted(set(table["ambient_degC"]), reverse=True)
    motions = list(dict.fromkeys(table["motion"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    wide, size = GROUP / len(ambients), (drawing.WIDEST, HEIGHT * len(shown) + 0.6)
    figure, axes = drawing.panels(len(shown), 1, size, title)
    for ax, (column, label, factor) in zip(axes, shown, strict=True):
        for place, (ambient, colour) in enumerate(zip(ambients, colours, strict=True)):
            mine = table[table["ambient_degC"] == ambient].set_index("motion")
            values = factor * mine.loc[motions, column].to_numpy(dtype=float)
            at = np.arange(len(motions)) + wide * (place - 0.5 * (len(ambients) - 1))
            bars = ax.bar(at, values, 0.92 * wide, color=colour)
            ax.bar_label(bars, fmt="%.3g", fontsize=drawing.SMALL - 1.0, padding=1.0)
        if column == yields:
            drawing.mark_tested(ax, 1.0, "yields")
        ax.set_ylim(0.0, 1.12 * ax.get_ylim()[1])
        ax.set_xticks(range(len(motions)), motions)
        ax.grid(False, axis="x")
        drawing.name_axes(ax, y=label)
    told = [f"ambient {drawing.degrees(value)}" for value in ambients]
    pairs = zip(told, colours, strict=True)
    handles = [Line2D([], [], color=colour, linewidth=5.0, label=name) for name, colour in pairs]
    drawing.legend_below(figure, handles)
    return figure
