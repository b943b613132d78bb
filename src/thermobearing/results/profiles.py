"""Figures of temperature profiles, and of several results together."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import xr
from thermobearing.core.records import Floats
from thermobearing.results import drawing

MOST_PROFILES = 8
CORE = (0, (4, 1.5))  # dashes of a lead core
THIN = 0.02  # of the height: a part too thin for its name
NAMES: drawing.Look = {"fontsize": drawing.SMALLEST}  # of parts and faces
STRIP = 0.52  # width of the panel of the lead, relative to that of the profiles
STRIP_INCHES = 1.2
MOST_MARKERS = 24  # on a profile through many cells


@dataclass(frozen=True)
class ProfilePanel:
    """Profiles of one run."""

    title: str
    ambient: float  # [degC]
    stack: "xr.Dataset"  # depth, cell_thickness, part of the cells; attribute half_stack
    lines: list[tuple[int, Floats, float | None]]  # name of the figure, cells, lead or None [degC]


def draw_profile_panels(
    title: str,
    size: tuple[float, float],
    columns: int,
    panels: list[ProfilePanel],
    names: list[str],
) -> Figure:
    """Panels row by row, all with the same number of kelvin; one colour and marker for a name."""
    cored = any(lead is not None for panel in panels for _, _, lead in panel.lines)
    size = (size[0] + (STRIP_INCHES * columns if cored else 0.0), size[1])
    rows, per_run = -(-len(panels) // columns), 2 if cored else 1
    widths = [1.0, STRIP][:per_run] * columns
    figure, all_axes = drawing.panels(rows, per_run * columns, size, title, widths=widths)
    colours = drawing.ordered_colours(len(names), "viridis")
    looks: list[drawing.Look] = [
        {"color": colour, "marker": marker, "markersize": 3.2}
        for colour, marker in zip(colours, drawing.MARKERS, strict=False)
    ]
    for ax in all_axes[per_run * len(panels) :]:  # runs missing in an interrupted study
        ax.remove()
    axes = all_axes[::per_run][: len(panels)]
    strip_axes = [*all_axes[1::2]] if cored else [None] * len(panels)
    strips = [
        _draw_panel(*arguments, looks) for arguments in zip(axes, strip_axes, panels, strict=False)
    ]
    _same_kelvin(list(zip(axes, panels, strict=True)))
    _same_kelvin([(s, panel) for s, panel in zip(strips, panels, strict=True) if s is not None])
    for place, (ax, strip, panel) in enumerate(zip(axes, strips, panels, strict=True)):
        first, last = place % columns == 0, place % columns == columns - 1
        lowest = place >= len(panels) - columns
        draw_stack(ax, panel.stack, names=last and strip is None)
        ax.tick_params(labelleft=first)
        x_label = "rubber and steel [°C]" if cored else "temperature [°C]"
        y = "distance from the upper face [mm]" if first else ""
        drawing.name_axes(ax, x_label if lowest else "", y)
        if strip is not None:
            draw_stack(strip, panel.stack, names=last, faces=False)
            strip.tick_params(labelleft=False)
            drawing.name_axes(strip, "lead [°C]" if lowest else "")
    handles = [Line2D([], [], label=name, **k) for name, k in zip(names, looks, strict=False)]
    if cored:
        look: drawing.Look = {"color": drawing.INK, "linestyle": CORE}
        handles.append(Line2D([], [], label="lead core (dashed)", **look))
    drawing.legend_below(figure, [*handles, drawing.ambient_handle()])
    return figure


def _draw_panel(
    ax: Axes, strip: Axes | None, panel: ProfilePanel, looks: list[drawing.Look]
) -> Axes | None:
    """Draw profiles of a run; return the adjacent strip of its lead, if it has one."""
    if strip is not None and all(lead is None for _, _, lead in panel.lines):
        strip.remove()
        strip = None
    depth = panel.stack["depth"].values
    marker_step = max(1, len(depth) // MOST_MARKERS)
    for number, profile, lead in panel.lines:
        look = looks[number]
        ax.plot(profile, depth, linewidth=1.1, markevery=marker_step, **look)
        if strip is not None and lead is not None:
            _draw_core(strip, panel.stack, lead, look["color"])
    for panel_axes, ticks in ((ax, 4), (strip, 2)):
        if panel_axes is not None:
            panel_axes.axvline(panel.ambient, color=drawing.GREY, linewidth=0.8, linestyle=":")
            panel_axes.locator_params(axis="x", nbins=ticks)
    drawing.name_axes(ax, title=panel.title)
    return strip


def _same_kelvin(pairs: list[tuple[Axes, ProfilePanel]]) -> None:
    """Panels show the same number of kelvin, each from its own coldest."""
    ranges = []
    for ax, panel in pairs:
        temperatures = [np.asarray(line.get_xdata(), dtype=float) for line in ax.get_lines()]
        values = np.concatenate([*temperatures, [panel.ambient]])
        ranges.append((float(values.min()), float(values.max())))
    span = max([0.1, *(high - low for low, high in ranges)])
    for (ax, _), (low, _) in zip(pairs, ranges, strict=True):
        ax.set_xlim(low - 0.06 * span, low + 1.06 * span)


def _draw_core(ax: Axes, stack: "xr.Dataset", temperature: float, colour: str) -> None:
    bottom = np.cumsum(stack["cell_thickness"].values)
    inside = np.flatnonzero(~np.isin(stack["part"].values, ("end_plate", "mass")))
    ends = [bottom[inside[0] - 1] if inside[0] else 0.0, bottom[inside[-1]]]
    ax.plot([temperature] * 2, ends, color=colour, linestyle=CORE, linewidth=1.6)


def draw_stack(ax: Axes, data: "xr.Dataset", *, names: bool, faces: bool = True) -> None:
    """Draw bands of steel and rubber behind profiles, the faces, and the names of parts."""
    part = [str(name) for name in data["part"].values]
    bottom = np.cumsum(data["cell_thickness"].values)
    half, place = bool(data.attrs["half_stack"]), ax.get_yaxis_transform()
    height, layer, top = float(bottom[-1]), 0, 0.0
    ends = [i for i in range(len(part)) if part[i] != [*part, ""][i + 1]]
    for end in ends:
        rubber = part[end] == "rubber"
        layer += rubber
        colour = drawing.RUBBER if rubber else drawing.STEEL
        ax.axhspan(top, bottom[end], color=colour, zorder=0, linewidth=0)
        if names and bottom[end] - top > THIN * height:
            name = f"rubber {layer}" if rubber else part[end].replace("_", " ")
            name = f"half {name}" if half and end == ends[-1] else name
            look = NAMES | {"color": drawing.GREY, "va": "center"}
            ax.text(1.03, 0.5 * (top + bottom[end]), name, transform=place, **look)
        top = float(bottom[end])
    ax.set_yticks([y for y in ax.get_yticks() if 0.0 <= y <= height])
    ax.set_ylim(1.055 * height, -0.055 * height)  # with room for the names of the faces
    ax.grid(False, axis="y")
    lower, line = ("plane of symmetry", "-.") if half else ("lower face", "-")
    for at, label_at, name, style, side in (
        (0.0, -0.006, "upper face", "-", "bottom"),
        (height, 1.006, lower, line, "top"),
    ):
        ax.axhline(at, color=drawing.INK, linewidth=0.9, linestyle=style, zorder=1.5)
        look = NAMES | {"color": drawing.INK, "ha": "center", "va": side, "transform": place}
        ax.text(0.5, label_at * height, name if faces else "", **look)


COLOURS = ("#0077BB", "#CC3311", "#009988", "#EE7733", "#33BBEE", "#EE3377", "#BBBBBB")


@checked
def overlay(results: Mapping[str, Any], title: str = "hysteresis loops") -> Figure:
    """Draw the loops of several results in one panel, one colour each.

    Parameters
    ----------
    results : by name, of one kind: of tests, of studies, or of fits.
    title : above the panel.

    Raises
    ------
    InputError : nothing to draw, or results whose loops have other axes.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1)
    >>> names = ["shen-hdr-specimen", "shen-lhdr-specimen"]
    >>> figure = overlay({name: tb.run(name, test) for name in names})
    >>> [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    ['shen-hdr-specimen', 'shen-lhdr-specimen']
    """
    if not results:
        raise InputError("no results to draw", "overlay()")
    others = [name for name, result in results.items() if not hasattr(result, "plot")]
    if others:
        raise InputError([f'"{name}": must be a result' for name in others], "overlay()")
    figure, (ax,) = drawing.panels(1, 1, (6.0, 5.0), title)
    labels = ""
    for number, (name, result) in enumerate(results.items()):
        result.plot.loops(ax=ax, label=name, color=COLOURS[number % len(COLOURS)])
        axis_labels = f"{ax.get_ylabel()} against {ax.get_xlabel()}"
        if labels and axis_labels != labels:
            raise InputError(
                f'"{name}" has loops of {axis_labels}; the others have {labels}', "overlay()"
            )
        labels = axis_labels
    ax.legend(fontsize=drawing.SMALL, frameon=False)
    return figure
