"""Loops of different bearings over each other: what each makes of the same motion."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

MOST_COLUMNS = 4
WIDTH, HEIGHT = 3.0, 2.7  # of one panel [inch]


def draw_largest_loops(result: EarthquakeResult) -> Figure:
    """The largest loop of every bearing: a row for each temperature, a column for each motion."""
    loops, data = result.largest_loops, result.dataset
    bearings = list(dict.fromkeys(loops["bearing"]))
    ambients = sorted(set(loops["ambient_degC"]))
    motions = list(dict.fromkeys(loops["motion"]))
    columns = min(len(motions), MOST_COLUMNS)
    more = f" (first {columns} of {len(motions)} motions)" if len(motions) > columns else ""
    colours = dict(zip(bearings, drawing.ordered_colours(len(bearings), "viridis"), strict=True))
    size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * len(ambients) + 1.0)
    title = f"{data.attrs['structure']}: largest loop of one bearing{more}"
    figure, axes = drawing.panels(len(ambients), columns, size, title, share=True)
    for panel, ax in enumerate(axes):
        ambient, motion = ambients[panel // columns], motions[panel % columns]
        mine = loops[(loops["ambient_degC"] == ambient) & (loops["motion"] == motion)]
        for run, loop in mine.iterrows():
            time = data["time"].values[run]
            inside = (time >= loop["start_s"]) & (time <= loop["end_s"])  # none if there is none
            x = data["bearing_displacement"].values[run, inside]
            y = data["bearing_force"].values[run, inside]
            dashed = loop.get("mode") == "pd"
            look: drawing.Look = {"linestyle": "--" if dashed else "-", "linewidth": 1.1}
            ax.plot(x, y, color=colours[loop["bearing"]], **look)
        drawing.name_axes(
            ax,
            "displacement [mm]" if panel // columns == len(ambients) - 1 else "",
            "force [kN]" if panel % columns == 0 else "",
            f"{motion}, ambient {drawing.degrees(ambient)}",
        )
        ax.title.set_fontsize(drawing.SMALL)
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        ax.axvline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
    handles = [Line2D([], [], color=colours[name], label=name) for name in bearings]
    drawing.legend_below(figure, handles)
    return figure


def has_loops(result: EarthquakeResult) -> bool:
    """Whether any run has a largest loop to be drawn."""
    data = result.dataset
    return "loop_start" in data and bool(np.isfinite(data["loop_start"].values).any())
