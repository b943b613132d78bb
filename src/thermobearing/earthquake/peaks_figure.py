"""Peaks of every run of a study: a dot a motion, the mean, and the limits that are known."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.parts import has_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

KJ = 1e-3
SHOWN: list[tuple[str, str, float]] = [
    ("bearing_strain_max", "bearing strain [%]", 100.0),
    ("bearing_force_max_kN", "bearing force [kN]", 1.0),
    ("bearing_energy_kN_mm", "bearing energy [kJ]", KJ),
    ("pier_displacement_max_mm", "pier displacement [mm]", 1.0),
    ("pier_ductility", "pier ductility", 1.0),
    ("deck_acceleration_max_m_s2", "deck acceleration [m/s2]", 1.0),
]
MODES = {"": "mean", "rt": "mean, real time", "pd": "mean, pseudo-dynamic"}
SPREAD = 0.5  # of the room of a temperature that its dots take
MEAN = 0.36  # half the length of the line at a mean


def draw_peaks(result: EarthquakeResult) -> Figure:
    """Rows are quantities, columns bearings; across are ambient temperatures, marks are motions.

    The lines are means over the motions; a pseudo-dynamic test has empty marks and dashed means.
    """
    table = result.table.assign(mode=result.modes)
    bearings, motions = (list(dict.fromkeys(table[name])) for name in ("bearing", "motion"))
    shown = [item for item in SHOWN if np.isfinite(table[item[0]]).any()]
    columns, ambients = len(bearings), sorted(set(table["ambient_degC"]))
    wide = max(1.9, 0.5 * len(ambients) + 0.9)
    size = (max(wide * columns, 4.0) + 0.8, 1.55 * len(shown) + 1.2)
    of_all = " (largest of all lines and piers)" if has_parts(result.dataset) else ""
    title = f"{result.dataset.attrs['structure']}: peaks{of_all}"
    figure, axes = drawing.panels(len(shown), columns, size, title)
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    for panel, ax in enumerate(axes):
        name, label, factor = shown[panel // columns]
        mine = table[table["bearing"] == bearings[panel % columns]]
        top = factor * float(np.nanmax(table[name]))
        for place, (ambient, colour) in enumerate(zip(ambients, colours, strict=True)):
            rows = mine[mine["ambient_degC"] == ambient]
            _dots(ax, place, rows.assign(value=factor * rows[name]), motions, colour)
        ax.set_ylim(0.0, 1.2 * top or 1.0)  # a deck on the ground has no pier that moves
        _limits(ax, result, name, list(mine.index), factor)
        last = panel // columns == len(shown) - 1
        drawing.name_axes(ax, "ambient [°C]" if last else "", label if panel % columns == 0 else "")
        ax.yaxis.label.set_fontsize(drawing.SMALL)
        names = [drawing.degrees(value).removesuffix(" °C") for value in ambients]
        ax.set_xticks(range(len(names)), names if last else [""] * len(names))
        ax.set_xlim(-0.6, len(names) - 0.4)
        ax.grid(False, axis="x")
    drawing.head_grid(axes, bearings, [])
    figure.align_ylabels()
    drawing.legend_below(figure, _handles(motions, list(dict.fromkeys(result.modes))))
    return figure


def _dots(ax: Axes, place: int, rows: pd.DataFrame, motions: list[str], colour: str) -> None:
    """Marks of one temperature side by side by motion, and their mean for each mode."""
    offsets = np.linspace(-0.5, 0.5, len(motions) + 2)[1:-1] * SPREAD
    for mode, same in rows.groupby("mode", sort=False):
        slow = mode == "pd"
        for row in same.to_dict("records"):
            number = motions.index(row["motion"])
            marker = drawing.MARKERS[number % len(drawing.MARKERS)]
            look: drawing.Look = {"markerfacecolor": "none" if slow else colour, "marker": marker}
            at = [place + offsets[number]], [row["value"]]
            ax.plot(*at, color=colour, markersize=4.5, linestyle="none", **look)
        line: drawing.Look = {"linewidth": 1.2, "linestyle": "--" if slow else "-"}
        ends = [place - MEAN, place + MEAN]
        ax.plot(ends, [float(same["value"].mean())] * 2, color=colour, zorder=1.5, **line)


def _limits(ax: Axes, result: EarthquakeResult, name: str, runs: list[int], factor: float) -> None:
    """Where the tests of a bearing end, and where a pier yields, if a run goes beyond."""
    if name == "bearing_strain_max":
        drawing.mark_tested(ax, factor * result.tested_to(runs, "strain"), "tested to here")
    if name == "pier_ductility" and ax.get_ylim()[1] > 1.0:
        drawing.mark_tested(ax, 1.0, "yields")


def _handles(motions: list[str], modes: list[str]) -> list[Line2D]:
    """Legend: marks of the motions, as far as they differ, and means."""
    look: drawing.Look = {"color": drawing.GREY}
    told = motions if len(motions) <= len(drawing.MARKERS) else []
    found = [
        Line2D([], [], marker=drawing.MARKERS[k], linestyle="none", label=motion, **look)
        for k, motion in enumerate(told)
    ]
    for mode in modes if len(modes) > 1 else [""]:
        dashed: drawing.Look = {"linestyle": "--" if mode == "pd" else "-"}
        found.append(Line2D([], [], label=MODES[mode], **look, **dashed))
    return found
