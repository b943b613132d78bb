"""Temperature through the height of the bearing, and of the lead core beside it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.cyclic.result import Result
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results import drawing

MOST_PROFILES = 8
CORE = (0, (4, 1.5))  # dashes of a lead core


def draw_profiles(result: Result, title: str, titles: list[str]) -> Figure:
    """One panel per ambient temperature, one line per amplitude (Fig. 4.10, 5.17)."""
    data, ambient = result.dataset, result["ambient"].values
    time = TimeAxis(result)
    count = len(ambient)
    figure, axes = drawing.panels(1, count, (max(5.5, 1.9 + 2.5 * count), 5.2), title)
    shown = time.loading_ends(MOST_PROFILES)
    colours = drawing.ordered_colours(len(shown), "viridis")
    ranges = []
    for run, ax in enumerate(axes):
        seen = [float(ambient[run])]
        for (number, name), colour, marker in zip(shown, colours, drawing.MARKERS, strict=False):
            row = time.last_row(run, number)
            if row is None:
                continue
            profile = data["temperature"].values[run, row]
            look: drawing.Look = {"color": colour, "marker": marker, "label": name}
            ax.plot(profile, data["depth"].values, markersize=3.2, linewidth=1.1, **look)
            seen += [float(profile.min()), float(profile.max())]
            if result.has_lead:
                seen.append(_draw_core(ax, result, run, row, colour))
        ax.axvline(ambient[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
        ax.locator_params(axis="x", nbins=6)
        drawing.name_axes(ax, "temperature [°C]", title=titles[run])
        ranges.append((min(seen), max(seen)))
    span = max(*(high - low for low, high in ranges), 0.1)
    for ax, (low, _) in zip(axes, ranges, strict=True):
        ax.set_xlim(low - 0.06 * span, low + 1.06 * span)
        drawing.draw_stack(ax, data, names=ax is axes[-1])
        ax.tick_params(labelleft=ax is axes[0])
    drawing.name_axes(axes[0], y="distance from the upper face [mm]")
    handles = [
        Line2D([], [], color=colour, marker=marker, markersize=3.2, label=name)
        for (_, name), colour, marker in zip(shown, colours, drawing.MARKERS, strict=False)
    ]
    if result.has_lead:
        dashed = Line2D([], [], color=drawing.INK, linestyle=CORE, label="lead core (dashed)")
        handles.append(dashed)
    drawing.legend_below(figure, [*handles, drawing.ambient_handle()])
    return figure


def _draw_core(ax: Axes, result: Result, run: int, row: int, colour: str) -> float:
    """The core as a line over its height, between the end plates; returns its temperature."""
    data = result.dataset
    temperature = float(data["lead_temperature"].values[run, row])
    bottom = np.cumsum(data["cell_thickness"].values)
    inside = np.flatnonzero(data["part"].values != "end_plate")
    top, end = bottom[inside[0] - 1], bottom[inside[-1]]
    ax.plot([temperature] * 2, [top, end], color=colour, linestyle=CORE, linewidth=1.6)
    return temperature
