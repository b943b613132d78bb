"""Loops of a bearing at three temperatures over those of the bilinear one of its design."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.reproduce.figures.words import BILINEAR
from thermobearing.results import drawing

COLUMNS = 2
BLACK: drawing.Look = {"color": "#000000", "linewidth": 0.7, "linestyle": "--"}


def draw_beside_bilinear(result: EarthquakeResult, designed: EarthquakeResult) -> Figure:
    """Force against displacement, a panel a motion.

    Parameters
    ----------
    result : one bearing under several motions at several temperatures.
    designed : the bilinear bearing, among others, under the same motions.
    """
    table = result.table
    ambients = sorted(set(table["ambient_degC"]))
    motions = list(dict.fromkeys(table["motion"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    rows = -(-len(motions) // COLUMNS)
    title = f"{table['bearing'].iloc[0]} beside the bilinear model"
    size = (drawing.WIDEST, 2.7 * rows + 0.9)
    figure, axes = drawing.panels(rows, COLUMNS, size, title, share=True)
    for panel, (ax, motion) in enumerate(zip(axes, motions, strict=False)):
        mine = table[table["motion"] == motion].set_index("ambient_degC", append=True)
        runs = {ambient: int(run) for run, ambient in mine.index}
        for ambient, colour in reversed(list(zip(ambients, colours, strict=True))):
            _path(ax, result, runs[ambient], {"color": colour, "linewidth": 0.9})
        of = designed.table
        chosen = of[(of["bearing"] == BILINEAR) & (of["motion"] == motion)]
        for run in chosen.index.to_numpy()[:1]:
            _path(ax, designed, int(run), BLACK)
        foot, side = panel // COLUMNS == rows - 1, panel % COLUMNS == 0
        x, y = "displacement [mm]" if foot else "", "force of one bearing [kN]" if side else ""
        drawing.name_axes(ax, x, y, motion)
    for ax in axes[len(motions) :]:
        ax.remove()
    pairs = zip(ambients, colours, strict=True)
    handles = [Line2D([], [], color=c, label=f"ambient {drawing.degrees(t)}") for t, c in pairs]
    drawing.legend_below(figure, [*handles, Line2D([], [], label="bilinear", **BLACK)])
    return figure


def _path(ax: Axes, result: EarthquakeResult, run: int, look: drawing.Look) -> None:
    """Force of one run against its displacement."""
    told = np.isfinite(result["time"].values[run])
    x = result["bearing_displacement"].values[run][told].astype(float)
    y = result["bearing_force"].values[run][told].astype(float)
    kept = drawing.thin_loops(x, y, max(np.ptp(x), 1e-9), max(np.ptp(y), 1e-9))
    ax.plot(x[kept], y[kept], **look)
