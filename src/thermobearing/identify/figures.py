"""Figures of test records and fits: arrays in, figures out, no physics."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.results import drawing

Floats = NDArray[np.float64]

TEST, MODEL = "#8a8f98", "#CC3311"
BINS = 3000
LABELLED = 14  # parameters whose correlation is printed into the squares


@dataclass(frozen=True)
class Panel:
    """One record for the figures: histories, and errors of its cycles."""

    title: str
    time: Floats
    displacement: Floats
    force: Floats
    model: Floats
    cycle: Floats
    errors: dict[str, Floats]


def check_figure(
    title: str,
    time: Floats,
    displacement: Floats,
    force: Floats,
    *,
    cycles: Sequence[tuple[int, int]],
    starts: Sequence[int],
    clipped: NDArray[np.bool_],
    sentences: Sequence[str],
) -> Figure:
    """A record at a glance: histories over samples, loops, middles of the loops, findings."""
    figure, (top, middle, loops, centre) = drawing.panels(2, 2, (10.0, 6.8), title)
    number = np.arange(len(time))
    for ax, values, name in (
        (top, displacement, "displacement [mm]"),
        (middle, force, "force [kN]"),
    ):
        kept = drawing.thin(values, BINS)
        ax.plot(number[kept], values[kept], color=drawing.INK, linewidth=0.7)
        ax.plot(starts, np.zeros(len(starts)), "|", color=MODEL, markersize=7)
        drawing.name_axes(ax, "sample", name)
    top.set_title("bars: begin of each cycle found", fontsize=drawing.NORMAL, loc="left")
    middle.plot(number[clipped], force[clipped], "x", color=MODEL, markersize=4)
    spans = max(float(np.ptp(displacement)), 1e-9), max(float(np.ptp(force)), 1e-9)
    kept = drawing.thin_loops(displacement, force, *spans)
    loops.plot(displacement[kept], force[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    for values, name, colour in (
        (displacement, "displacement", "#0077BB"),
        (force, "force", "#EE7733"),
    ):
        peak = max(float(np.abs(values).max()), 1e-12)
        mids = [50.0 * (values[a : b + 1].max() + values[a : b + 1].min()) / peak
                for a, b in cycles]  # fmt: skip
        centre.plot(np.arange(1, len(mids) + 1), mids, "o-", color=colour, markersize=3, label=name)
    centre.axhline(0.0, color=drawing.GREY, linewidth=0.8)
    drawing.name_axes(centre, "cycle", "middle of loop [% of peak]", "drift and offset")
    centre.legend(fontsize=drawing.SMALL, frameon=False)
    if sentences:
        shown = "\n".join(textwrap.fill(f"- {text}", 150) for text in sentences)
        figure.supxlabel(shown, fontsize=drawing.SMALL, x=0.02, ha="left")
    return figure


def loops_figure(title: str, panels: Sequence[Panel]) -> Figure:
    """Loops of each test, the model's over them."""
    columns = min(len(panels), 3)
    rows = -(-len(panels) // columns)
    figure, axes = drawing.panels(
        rows, columns, (max(5.5, 1.0 + 3.4 * columns), 0.9 + 3.6 * rows), title
    )
    for ax, panel in zip(axes, panels, strict=False):
        span = float(np.ptp(panel.displacement)), float(np.ptp(panel.force))
        for values, colour, width in ((panel.force, TEST, 0.9), (panel.model, MODEL, 0.7)):
            kept = drawing.thin_loops(panel.displacement, values, *span)
            ax.plot(panel.displacement[kept], values[kept], color=colour, linewidth=width)
        drawing.name_axes(ax, "displacement [mm]", "force [kN]", panel.title)
    for ax in axes[len(panels) :]:
        ax.set_visible(False)
    lines = [
        Line2D([], [], color=TEST, linewidth=2.0, label="test"),
        Line2D([], [], color=MODEL, linewidth=2.0, label="model"),
    ]
    drawing.legend_below(figure, lines)
    return figure


def residual_figure(title: str, panels: Sequence[Panel]) -> Figure:
    """Residual force over samples, and its distribution, for each record."""
    size = (9.5, 0.8 + 2.3 * len(panels))
    figure, axes = drawing.panels(len(panels), 2, size, title)
    for k, panel in enumerate(panels):
        off = 100.0 * (panel.model - panel.force) / float(np.abs(panel.force).max())
        left, right = axes[2 * k], axes[2 * k + 1]
        kept = drawing.thin(off, BINS)
        left.plot(kept, off[kept], color=drawing.INK, linewidth=0.5)
        left.axhline(0.0, color=MODEL, linewidth=0.8)
        drawing.name_axes(left, "sample", "model - test [% of peak]", panel.title)
        right.hist(off, bins=80, density=True, color=TEST)
        sigma = max(float(off.std()), 1e-12)
        grid = np.linspace(float(off.min()), float(off.max()), 200)
        normal = np.exp(-0.5 * ((grid - off.mean()) / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
        right.plot(grid, normal, color=MODEL, linewidth=1.2, label="normal")
        drawing.name_axes(
            right, "model - test [% of peak]", "density", f"standard deviation {sigma:.2g} %"
        )
        right.legend(fontsize=drawing.SMALL, frameon=False)
    return figure


def convergence_figure(title: str, history: Sequence[tuple[int, float]]) -> Figure:
    """Best residual so far against evaluations."""
    figure, (ax,) = drawing.panels(1, 1, (6.5, 3.8), title)
    count = np.array([item[0] for item in history], dtype=float)
    error = 100.0 * np.sqrt(np.array([item[1] for item in history]))
    ax.step(count, error, where="post", color=drawing.INK, linewidth=1.3)
    ax.set_yscale("log")
    ax.yaxis.set_minor_formatter("{x:g}")
    ax.yaxis.set_major_formatter("{x:g}")
    ax.tick_params(which="both", labelsize=drawing.SMALL)
    drawing.name_axes(ax, "evaluations (all records each)", "rms residual [% of peak]")
    return figure


def correlation_figure(title: str, names: Sequence[str], matrix: Floats) -> Figure:
    """Correlation matrix of the free parameters."""
    size = 1.8 + 0.55 * len(names)
    figure, (ax,) = drawing.panels(1, 1, (max(size + 0.8, 4.5), max(size, 3.8)), title)
    ax.grid(False)
    image = ax.imshow(matrix, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
    ax.set_xticks(range(len(names)), names, fontsize=drawing.NORMAL, rotation=45)
    ax.set_yticks(range(len(names)), names, fontsize=drawing.NORMAL)
    for (i, j), value in np.ndenumerate(matrix):
        if len(names) <= LABELLED:
            colour = "white" if abs(value) > 0.6 else drawing.INK
            text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
            ax.text(j, i, text, ha="center", va="center", fontsize=6.5, color=colour)
    figure.colorbar(image, ax=ax, shrink=0.8).ax.tick_params(labelsize=drawing.SMALL)
    return figure


def cycle_figure(title: str, panels: Sequence[Panel]) -> Figure:
    """Errors of each cycle: one panel per measure, one line per record."""
    names = list(panels[0].errors)
    figure, axes = drawing.panels(2, 2, (10.0, 6.0), title)
    colours = drawing.ordered_colours(len(panels), "viridis")
    for ax, name in zip(axes, names, strict=False):
        for k, panel in enumerate(panels):
            ax.plot(
                panel.cycle, 100.0 * panel.errors[name], drawing.MARKERS[k % 8] + "-",
                color=colours[k], markersize=3.5, linewidth=0.9, label=panel.title,
            )  # fmt: skip
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.9)
        drawing.name_axes(ax, "cycle", "model / test - 1 [%]", name)
    lines, _ = axes[0].get_legend_handles_labels()
    drawing.legend_below(figure, [line for line in lines if isinstance(line, Line2D)])
    return figure


def band_figure(
    title: str,
    displacement: Floats,
    best: Floats,
    lower: Floats,
    upper: Floats,
    peak: tuple[float, float, float],
) -> Figure:
    """Loops at a temperature with their 95 % band over samples, and the peak force."""
    figure, (loops, band) = drawing.panels(1, 2, (10.0, 4.2), title)
    loops.plot(displacement, best, color=drawing.INK, linewidth=0.6)
    text = f"peak {peak[0]:.4g} kN, 95 % {peak[1]:.4g} to {peak[2]:.4g} kN"
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", text)
    number = np.arange(len(best))
    band.fill_between(number, lower - best, upper - best, color=TEST, linewidth=0.0)
    band.axhline(0.0, color=MODEL, linewidth=0.8)
    drawing.name_axes(band, "sample", "force - best [kN]", "95 % band from the parameters alone")
    return figure
