"""How temperatures through the height of bearings are drawn, and of the lead cores beside them."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.results import drawing

Floats = NDArray[np.float64]
MOST_PROFILES = 8
CORE = (0, (4, 1.5))  # dashes of a lead core


@dataclass(frozen=True)
class ProfilePanel:
    """Profiles of one run.

    Attributes
    ----------
    title, ambient : of the run; ambient temperature [degC].
    stack : `depth`, `cell_thickness` and `part` of its cells, and the attribute `half_stack`.
    lines : which of the names of the figure it is, temperatures of the cells, and that of the
        lead, or None [degC].
    """

    title: str
    ambient: float
    stack: xr.Dataset
    lines: list[tuple[int, Floats, float | None]]


def draw_profile_panels(
    title: str,
    size: tuple[float, float],
    columns: int,
    panels: list[ProfilePanel],
    names: list[str],
) -> Figure:
    """Panels row by row, all with the same number of kelvin; one colour and marker for a name."""
    figure, axes = drawing.panels(-(-len(panels) // columns), columns, size, title)
    colours = drawing.ordered_colours(len(names), "viridis")
    looks: list[drawing.Look] = [
        {"color": colour, "marker": marker, "markersize": 3.2}
        for colour, marker in zip(colours, drawing.MARKERS, strict=False)
    ]
    ranges = []
    for ax in axes[len(panels) :]:  # of runs that an interrupted study did not come to
        ax.remove()
    for ax, panel in zip(axes, panels, strict=False):
        seen = [panel.ambient]
        for number, profile, lead in panel.lines:
            look = looks[number]
            ax.plot(profile, panel.stack["depth"].values, linewidth=1.1, **look)
            seen += [float(profile.min()), float(profile.max())]
            if lead is not None:
                seen.append(lead)
                _draw_core(ax, panel.stack, lead, look["color"])
        ax.axvline(panel.ambient, color=drawing.GREY, linewidth=0.8, linestyle=":")
        ax.locator_params(axis="x", nbins=6)
        drawing.name_axes(ax, title=panel.title)
        ranges.append((min(seen), max(seen)))
    span = max(*(high - low for low, high in ranges), 0.1)
    for place, (ax, panel) in enumerate(zip(axes, panels, strict=False)):
        low = ranges[place][0]
        ax.set_xlim(low - 0.06 * span, low + 1.06 * span)
        first, last = place % columns == 0, place % columns == columns - 1
        drawing.draw_stack(ax, panel.stack, names=last)
        ax.tick_params(labelleft=first)
        drawing.name_axes(
            ax,
            "temperature [°C]" if place >= len(panels) - columns else "",
            "distance from the upper face [mm]" if first else "",
        )
    handles = [Line2D([], [], label=name, **k) for name, k in zip(names, looks, strict=False)]
    if any(lead is not None for panel in panels for _, _, lead in panel.lines):
        dashed = Line2D([], [], color=drawing.INK, linestyle=CORE, label="lead core (dashed)")
        handles.append(dashed)
    drawing.legend_below(figure, [*handles, drawing.ambient_handle()])
    return figure


def _draw_core(ax: Axes, stack: xr.Dataset, temperature: float, colour: str) -> None:
    """The core as a line over its height, between the end plates."""
    bottom = np.cumsum(stack["cell_thickness"].values)
    inside = np.flatnonzero(stack["part"].values != "end_plate")
    top = bottom[inside[0] - 1] if inside[0] else 0.0
    ax.plot(
        [temperature] * 2, [top, bottom[inside[-1]]], color=colour, linestyle=CORE, linewidth=1.6
    )
