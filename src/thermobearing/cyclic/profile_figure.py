"""Through the height of the bearing: temperature, and how far each layer is sheared."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.core.records import Floats
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results import drawing
from thermobearing.results.profiles import (
    MOST_PROFILES,
    ProfilePanel,
    draw_profile_panels,
    draw_stack,
)

AT_PEAK = 1.0 - 1e-9  # of the largest displacement, to find its last moment


def draw_profiles(result: Result, title: str, titles: list[str]) -> Figure:
    """One panel per ambient temperature, one line per amplitude (Fig. 4.10, 5.17)."""
    data, ambient = result.dataset, result["ambient"].values
    time = TimeAxis(result)
    shown = time.loading_ends(MOST_PROFILES)
    panels = []
    for run, name in enumerate(titles):
        lines = []
        for place, (number, _) in enumerate(shown):
            row = time.last_row(run, number)
            if row is None:
                continue
            lead = float(data["lead_temperature"].values[run, row]) if result.has_lead else None
            lines.append((place, data["temperature"].values[run, row], lead))
        panels.append(ProfilePanel(name, float(ambient[run]), data, lines))
    count = len(ambient)
    size = (max(5.5, 1.9 + 2.5 * count), 5.2)
    return draw_profile_panels(title, size, count, panels, [name for _, name in shown])


def draw_layer_shear(result: Result, title: str, titles: list[str]) -> Figure:
    """Displacement of each layer at the last peak of each amplitude, one panel a temperature."""
    data, time = result.dataset, TimeAxis(result)
    shown = time.loading_ends(MOST_PROFILES)
    colours = drawing.ordered_colours(len(shown), "viridis")
    count = len(titles)
    figure, axes = drawing.panels(1, count, (max(5.5, 1.9 + 2.5 * count), 5.2), title)
    depth = layer_depths(data)
    for run, ax in enumerate(axes):
        for (number, _), colour in zip(shown, colours, strict=True):
            rows = np.arange(len(time.numbers[run]))[time.inside(run, number, number)]
            if len(rows):
                moved = np.abs(data["displacement"].values[run, rows])
                peak = rows[np.flatnonzero(moved >= AT_PEAK * moved.max())[-1]]
                layers = np.abs(data["layer_displacement"].values[run, peak])
                ax.plot(layers, depth, color=colour, marker="o", markersize=3.5, linewidth=1.1)
        draw_stack(ax, data, names=run == count - 1)
        ax.tick_params(labelleft=run == 0)
        y = "distance from the upper face [mm]" if run == 0 else ""
        drawing.name_axes(ax, "displacement of the layer [mm]", y, titles[run])
    marks = zip(shown, colours, strict=True)
    handles = [Line2D([], [], color=c, marker="o", label=name) for (_, name), c in marks]
    drawing.legend_below(figure, handles)
    return figure


def layer_depths(data: xr.Dataset) -> Floats:
    """Depth of the middle of each rubber layer; of one that the half stack cuts, of its half."""
    thickness = data["cell_thickness"].values
    bottom = np.cumsum(thickness)
    rubber = np.flatnonzero(data["part"].values == "rubber")
    each = np.split(rubber, np.flatnonzero(np.diff(rubber) > 1) + 1)
    return np.array([0.5 * (bottom[c[0]] - thickness[c[0]] + bottom[c[-1]]) for c in each])
