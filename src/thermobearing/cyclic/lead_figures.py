"""Figures of bearings with lead cores and rate dependence."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.cyclic.result import Result
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results import drawing

# Variable, label, colour: safe for colour-blind readers.
SHARES = (
    ("rubber_force", "rubber f_r", "#0072B2"),
    ("lead_force", "lead f_l", "#555555"),
    ("viscous_force", "rate dependence f_v", "#D55E00"),
)
LEAD, INNER, OUTER = "#222222", "#D55E00", "#56B4E9"


def draw_lead_temperature(result: Result, title: str, titles: list[str]) -> Figure:
    """Lead, innermost and outermost rubber layer in time, one panel per ambient temperature."""
    data = result.dataset
    time = TimeAxis(result)
    figure, axes = time.rows_of_panels(title, titles)
    rubber = data["rubber_temperature"].values
    for run, ax in enumerate(axes):
        rows = time.rows[run]
        for values, colour, width in (
            (data["lead_temperature"].values[run, :rows], LEAD, 1.6),
            (rubber[run, :rows, -1], INNER, 1.2),
            (rubber[run, :rows, 0], OUTER, 1.2),
        ):
            ax.plot(*time.trace(run, values), color=colour, linewidth=width)
        ax.axhline(data["ambient"].values[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
        drawing.name_axes(ax, y="temperature [°C]")
        drawing.mark_tested(ax, result.tested_to(run, "lead_temperature"), "lead tested to here")
    last = "innermost" if data.attrs["half_stack"] else "last"
    handles = [
        Line2D([], [], color=colour, linewidth=1.6, label=label)
        for colour, label in (
            (LEAD, "lead core"),
            (INNER, f"{last} rubber layer"),
            (OUTER, "outermost rubber layer"),
        )
    ]
    drawing.legend_below(figure, [*handles, drawing.ambient_handle()])
    return figure


def draw_force_shares(result: Result, title: str, titles: list[str]) -> Figure:
    """Forces of the branches over the first and the last cycle of the largest amplitude."""
    loaded = [n for n, about in enumerate(result.segments) if about["kind"] == "cycles"]
    largest = max(loaded, key=lambda n: float(result.segments[n]["amplitude_strain"]))
    ambient = result["ambient"].values
    size = (max(6.0, 1.5 + 3.0 * len(ambient)), 5.4)
    figure, axes = drawing.panels(2, len(ambient), size, title, share=True)
    for run in range(len(ambient)):
        inside = np.flatnonzero(result["segment"].values[run] == largest)
        cycles = result["cycle"].values[run, inside]
        for row, number in enumerate((1, int(cycles.max()))):
            ax = axes[row * len(ambient) + run]
            _draw_cycle(ax, result, run, inside[cycles == number])
            label = f"{titles[run]}, cycle {number}"
            drawing.name_axes(ax, title=label, y="force [kN]" if run == 0 else "")
    for ax in axes[len(ambient) :]:
        drawing.name_axes(ax, "time in the cycle [s]")
    handles = [Line2D([], [], color=colour, label=label) for _, label, colour in SHARES]
    total = Line2D(
        [], [], color=drawing.INK, linewidth=0.9, linestyle="--", label="bearing force f"
    )
    drawing.legend_below(figure, [total, *handles])
    return figure


def _draw_cycle(ax: Axes, result: Result, run: int, rows: np.ndarray) -> None:
    """All branches over one cycle, with their share of the peak force at its moment."""
    time = result.time(run)[rows]
    force = result["force"].values[run, rows]
    ax.plot(time - time[0], force, color=drawing.INK, linewidth=0.9, linestyle="--")
    peak = int(np.argmax(force))
    shares = []
    for name, _, colour in SHARES:
        values = result[name].values[run, rows]
        ax.plot(time - time[0], values, color=colour, linewidth=1.3)
        shares.append(f"{values[peak] / force[peak]:.0%}")
    told = "at the peak: " + " + ".join(shares)
    look: drawing.Look = {"fontsize": drawing.SMALL - 0.5, "color": drawing.GREY}
    ax.text(0.98, 0.95, told, ha="right", va="top", transform=ax.transAxes, **look)
    ax.axhline(0.0, color=drawing.GREY, linewidth=0.6)
