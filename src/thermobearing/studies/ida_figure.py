"""Curves of incremental dynamic analysis, and their fractiles."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.studies.ida import FRACTILES, Ida
from thermobearing.studies.labels import title_of, words_of

LOOKS = dict(zip(FRACTILES, (":", "-", "--"), strict=True))
MOST_CURVES = 400  # drawn; more are every so many of them
ROOM = 1.35  # of the capacity, or of the largest demand of a fractile, that the axis shows
COLOUR = "#0077BB"


def draw_ida(ida: Ida, capacity: float) -> Figure:
    """Intensity against demand, as such curves are drawn; a cross where one collapses.

    Parameters
    ----------
    ida : curves.
    capacity : of the demand, drawn as a line; NaN for none.
    """
    title = f"incremental dynamic analysis, {words_of(ida.demand)}: {ida.sentence}"
    figure, (ax,) = drawing.panels(1, 1, (5.2, 4.2), title)
    every = -(-len(ida.curves) // MOST_CURVES)
    for curve in ida.curves[::every]:
        stood = np.isfinite(curve.demand)
        first = len(stood) if stood.all() else int((~stood).argmax())
        x, y = curve.demand[:first], curve.intensity[:first]
        ax.plot(x, y, color=drawing.GREY, linewidth=0.6, alpha=0.5)
        if first < len(stood):
            ax.plot(x[-1], y[-1], "x", color="#CC3311", markersize=4)
    _fractiles(ax, ida)
    highest = max(float(curve.intensity[-1]) for curve in ida.curves)
    if np.isfinite(capacity):
        ax.axvline(capacity, **drawing.LIMIT)
    ends = [curve.demand[np.isfinite(curve.demand)].max() for curve in ida.curves]
    widest = float(max(ends))
    right = min(widest, max(4.0 * capacity, 1e-300)) if np.isfinite(capacity) else widest
    ax.set_xlim(0.0, 1.03 * right)
    ax.set_ylim(0.0, 1.03 * highest)
    drawing.name_axes(ax, title_of(ida.demand), title_of(ida.intensity))
    drawing.legend_below(figure, _handles(ida, capacity))
    return figure


def _fractiles(ax: Axes, ida: Ida) -> None:
    """Lines of the fractiles as far as most curves go, so that they do not jump with those left."""
    table = ida.fractiles()
    table = table[table["curves"] == len(ida.curves)]
    for share, line in LOOKS.items():
        x = np.append(0.0, table[f"{share:g}"].to_numpy(dtype=float)) if len(table) else np.zeros(1)
        y = np.append(0.0, table[ida.intensity].to_numpy(dtype=float))
        stood = np.isfinite(x)
        ax.plot(x[stood], y[stood], color=COLOUR, linewidth=1.6, linestyle=line)


def _handles(ida: Ida, capacity: float) -> list[Line2D]:
    """Legend entries."""
    count = f"{len(ida.curves)} curves"
    found = [Line2D([], [], color=drawing.GREY, linewidth=0.6, label=count)]
    for share, line in LOOKS.items():
        look: drawing.Look = {"color": COLOUR, "linewidth": 1.6, "linestyle": line}
        found.append(Line2D([], [], label=f"{100 * share:g} % of curves below", **look))
    if any(np.isinf(curve.demand).any() for curve in ida.curves):
        cross: drawing.Look = {"marker": "x", "linestyle": "none", "color": "#CC3311"}
        found.append(Line2D([], [], markersize=4, label="last before collapse", **cross))
    if np.isfinite(capacity):
        found.append(Line2D([], [], label="capacity", **drawing.LIMIT))
    return found
