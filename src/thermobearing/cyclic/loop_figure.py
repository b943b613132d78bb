"""Stress-strain loops of a test: a panel for each ambient temperature, or all in one."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermobearing.cyclic.result import Result
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results import drawing
from thermobearing.results.drawing import Floats

X, Y = "shear strain [%]", "shear stress [MPa]"


def draw_loops(result: Result, title: str, titles: Sequence[str], colours: Sequence[str]) -> Figure:
    """A panel per run, all with the same axes; rests are left out."""
    count = len(titles)
    columns = count if count <= 3 else (count + 1) // 2
    rows = -(-count // columns)
    size = (max(5.5, 1.2 + 3.0 * columns), max(4.5, 0.7 + 3.1 * rows))
    figure, axes = drawing.panels(rows, columns, size, title, share=True)
    for run, (ax, colour) in enumerate(zip(axes, colours, strict=False)):
        ax.plot(*_path(result, run), color=colour, linewidth=0.8)
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        ax.axvline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        drawing.name_axes(
            ax,
            X if run + columns >= count else "",
            Y if run % columns == 0 else "",
            titles[run],
        )
        ax.tick_params(labelbottom=run + columns >= count)
    for ax in axes[count:]:
        ax.remove()
    ends = [100.0 * result.tested_to(run, "strain") for run in range(count)]
    drawing.shade_untested(axes[:count], [(-end, end) for end in ends])
    return figure


def add_loops(ax: Axes, result: Result, labels: Sequence[str], colours: Sequence[str]) -> None:
    """All runs into a panel of somebody else."""
    for run, (label, colour) in enumerate(zip(labels, colours, strict=True)):
        ax.plot(*_path(result, run), color=colour, linewidth=0.8, label=label or None)
    drawing.name_axes(ax, X, Y)


def _path(result: Result, run: int) -> tuple[Floats, Floats]:
    """Strain [%] and stress [MPa] where the bearing moves, thinned as far as nobody sees it."""
    strain, stress = 100.0 * result["strain"].values, result["stress"].values
    spans = [max(float(np.nanmax(v) - np.nanmin(v)), 1e-9) for v in (strain, stress)]
    paths = [(strain[run, rows], stress[run, rows]) for rows in TimeAxis(result).moving_rows(run)]
    return drawing.thin_paths(paths, spans[0], spans[1])
