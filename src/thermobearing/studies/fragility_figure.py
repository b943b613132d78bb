"""Fragility curves with their bands, and the shares of runs that they were made of."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.results.overlaid import COLOURS
from thermobearing.studies.classes import equal_classes
from thermobearing.studies.counted import told_of
from thermobearing.studies.fragility import Fragility
from thermobearing.studies.labels import title_of, unit_of, words_of
from thermobearing.studies.mixture import ClimateFragility

POINTS = 160
ROOM = 1.1  # beyond the intensities that have runs
MOST_MARKS, MARKS = 40, 15  # of intensities; more are drawn in classes


def colours_of(names: list[Any]) -> list[str]:
    """From cold to warm where all names are numbers; else told apart."""
    if names and all(isinstance(name, int | float | np.number) for name in names):
        return drawing.ambient_colours(np.array(names, dtype=float))
    return [COLOURS[k % len(COLOURS)] for k in range(len(names))]


def draw_fragility(
    curves: Mapping[Any, Fragility], climate: ClimateFragility | None = None, title: str = ""
) -> Figure:
    """Probability of going beyond the capacity against intensity.

    Parameters
    ----------
    curves : by temperature, or by name.
    climate : of the whole, drawn in black.
    title : above; by default the demand and its capacity.
    """
    some = next(iter(curves.values()))
    unit = unit_of(some.demand)
    capacity = f"{some.capacity:g} {unit}".strip()
    title = title or f"fragility, {words_of(some.demand)} beyond {capacity}"
    figure, (ax,) = drawing.panels(1, 1, (5.6, 4.2), title)
    at = np.concatenate([curve.counts[curve.intensity].to_numpy() for curve in curves.values()])
    im = np.linspace(0.0, ROOM * float(at.max()), POINTS + 1)[1:]
    handles = []
    for (name, curve), colour in zip(curves.items(), colours_of(list(curves)), strict=True):
        told = drawing.degrees(name) if isinstance(name, int | float) else str(name)
        if curve.estimate.known:
            _curve(ax, curve, im, colour, len(curves) < 3)
        else:
            told += " (no curve)"
        _marks(ax, curve, colour, len(curves))
        handles.append(Line2D([], [], color=colour, linewidth=1.4, label=told))
    if climate is not None:
        _curve(ax, climate, im, drawing.INK, True)
        handles.append(Line2D([], [], color=drawing.INK, linewidth=1.8, label=climate.name))
    marks: drawing.Look = {"color": drawing.GREY, "linestyle": "none", "marker": "o"}
    handles.append(Line2D([], [], markersize=3.5, label="share of runs", **marks))
    ax.set_xlim(0.0, float(im[-1]))
    ax.set_ylim(-0.02, 1.02)
    drawing.name_axes(ax, title_of(some.intensity), "probability of going beyond")
    left_out = sum(curve.left_out for curve in curves.values())
    collapsed = sum(curve.collapsed for curve in curves.values())
    runs = sum(curve.runs for curve in curves.values()) + left_out
    why = f"{some.method}, bands of {100 * some.level:g} %\n{told_of(runs, left_out, collapsed)}"
    drawing.say_why(ax, why.replace("; ", "\n"), (0.98, 0.03))
    drawing.legend_below(figure, handles)
    return figure


def _curve(
    ax: Axes, curve: Fragility | ClimateFragility, im: Any, colour: str, filled: bool
) -> None:
    """A curve with its band: an area, or the ends of it where many would lie on each other."""
    low, high = curve.band_at(im)
    if filled:
        ax.fill_between(im, low, high, color=colour, alpha=0.13, linewidth=0)
    else:
        ax.plot(im, low, im, high, color=colour, linewidth=0.6, linestyle=":")
    wide = 1.8 if isinstance(curve, ClimateFragility) else 1.4
    ax.plot(im, curve.probability(im), color=colour, linewidth=wide)


def _marks(ax: Axes, curve: Fragility, colour: str, count: int) -> None:
    """Share of runs beyond at each intensity, or in each of some classes of them."""
    counts = curve.counts
    if len(counts) > MOST_MARKS:
        sums = counts.groupby(equal_classes(counts[curve.intensity].to_numpy(), MARKS))
        counts = (
            sums[["runs", "beyond"]].sum().assign(**{curve.intensity: sums[curve.intensity].mean()})
        )
    share = counts["beyond"] / counts["runs"]
    look: drawing.Look = {"color": colour, "linestyle": "none", "marker": "o"}
    ax.plot(counts[curve.intensity], share, markersize=3.5 if count < 6 else 2.5, alpha=0.8, **look)
