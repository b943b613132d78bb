"""Annual rates: the hazard curve, and how often a capacity is passed in which air."""

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermobearing.results import drawing
from thermobearing.studies.fragility_figure import colours_of
from thermobearing.studies.hazard import Hazard, Rate

WRAPPED = 120  # letters of a note in a line
DECADES = 6  # of rates that are shown below the largest


def draw_rates(
    hazard: Hazard, rates: Mapping[Any, Rate], title: str, unit: str = "", note: str = ""
) -> Figure:
    """The hazard curve beside the rate of each temperature or climate.

    Parameters
    ----------
    hazard : of the site.
    rates : by temperature or name.
    title : above.
    unit : of the intensity.
    note : what became of runs that failed.
    """
    figure, (left, right) = drawing.panels(1, 2, (7.1, 3.2), title)
    left.loglog(hazard.intensity, hazard.rate, color=drawing.INK, linewidth=1.4, marker="o", ms=3)
    measure = hazard.measure or "intensity"
    drawing.name_axes(left, f"{measure} [{unit}]" if unit else measure, "exceeded [1/year]")
    left.set_title("hazard of the site", fontsize=drawing.NORMAL, loc="left")
    _bars(right, rates)
    right.set_title("capacity passed", fontsize=drawing.NORMAL, loc="left")
    notes = dict.fromkeys([note, *(text for rate in rates.values() for text in rate.notes)])
    told = "\n".join(textwrap.fill(text, WRAPPED) for text in notes if text)
    figure.supxlabel(told, x=0.02, ha="left", fontsize=drawing.SMALL, color=drawing.GREY)
    left.tick_params(which="both", labelsize=drawing.SMALL)
    return figure


def _bars(ax: Axes, rates: Mapping[Any, Rate]) -> None:
    """Points with bands; names across."""
    names = list(rates)
    numbers = [name for name in names if isinstance(name, int | float)]
    warm = dict(zip(numbers, colours_of(numbers), strict=True)) if len(numbers) > 1 else {}
    top = max((rate.high for rate in rates.values() if np.isfinite(rate.high)), default=1.0)
    floor = top * 10.0**-DECADES if top > 0.0 else 1e-9
    for place, name in enumerate(names):
        rate, colour = rates[name], warm.get(name, drawing.INK)
        if not rate.rate > 0.0:
            told = "no run beyond,\nupper bound" if rate.rate == 0.0 else "no curve"
            look: drawing.Look = {"ha": "center", "va": "bottom", "color": drawing.GREY}
            ax.text(place, 0.02, told, transform=ax.get_xaxis_transform(), fontsize=6.5, **look)
            if rate.high > 0.0:  # an upper bound
                ax.plot(place, rate.high, "v", color=colour, markersize=5, markerfacecolor="none")
            continue
        ax.plot(place, rate.rate, "o", color=colour, markersize=5)
        ax.vlines(place, max(rate.low, floor), rate.high, color=colour, linewidth=1.4)
    ax.set_yscale("log")
    ax.tick_params(which="both", labelsize=drawing.SMALL)
    ax.set_xlim(-0.6, len(names) - 0.4)
    ticks = [drawing.degrees(n) if isinstance(n, int | float) else str(n) for n in names]
    turn: drawing.Look = {"rotation": 30, "ha": "right"} if len(names) > 4 else {}
    ax.set_xticks(range(len(names)), ticks, **turn)
    ax.grid(False, axis="x")
    drawing.name_axes(ax, "", "passed [1/year]")
