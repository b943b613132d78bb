"""Every bearing line and every pier of a study beside each other: a dot for each run."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

SHOWN = (  # part, column, label, factor
    ("line", "strain_max", "bearing strain [%]", 100.0),
    ("line", "total_force_max_kN", "force of the line [kN]", 1.0),
    ("pier", "displacement_max_mm", "pier displacement [mm]", 1.0),
    ("pier", "ductility", "pier ductility", 1.0),
)
SPREAD = 0.9  # of the room of a part that its dots take


def draw_parts(result: EarthquakeResult) -> Figure:
    """Peaks of lines (strain, force) and piers (displacement, ductility), by ambient temperature.

    The bearings that are compared stand side by side at each part, with other markers; each has
    its motions from the left.
    """
    tables = {"line": result.lines, "pier": result.piers}
    shown = [item for item in SHOWN if tables[item[0]][item[1]].notna().any()]
    names = {part: list(dict.fromkeys(table[part])) for part, table in tables.items()}
    motions = list(dict.fromkeys(result.table["motion"]))
    wide = max(len(parts) for parts in names.values())
    size = (max(3.6, 1.0 + 0.8 * wide) * 2, 2.7 * ((len(shown) + 1) // 2) + 0.9)
    several = len(motions) > 1
    told = f" (motions from the left: {', '.join(motions)})" if several and len(motions) < 5 else ""
    title = f"{result.dataset.attrs['structure']}: bearing lines and piers{told}"
    figure, axes = drawing.panels((len(shown) + 1) // 2, 2, size, title)
    ambients = sorted(set(result.table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    looks = dict(zip(ambients, colours, strict=True))
    bearings = list(dict.fromkeys(result.table["bearing"]))
    for spare in axes[len(shown) :]:
        spare.set_visible(False)
    for ax, (part, column, label, factor) in zip(axes, shown, strict=False):
        _dots(ax, tables[part], names[part], (part, column, factor), looks, bearings)
        drawing.name_axes(ax, "", label)
    handles = [
        Line2D([], [], color=c, marker="o", linestyle="none", label=drawing.degrees(t))
        for t, c in looks.items()
    ]
    for k, name in enumerate(bearings if len(bearings) > 1 else []):
        marker = drawing.MARKERS[k % len(drawing.MARKERS)]
        look: drawing.Look = {"color": drawing.GREY, "marker": marker, "linestyle": "none"}
        handles.append(Line2D([], [], label=name, **look))
    drawing.legend_below(figure, handles)
    return figure


def _dots(
    ax: Axes,
    table: pd.DataFrame,
    names: list[str],
    what: tuple[str, str, float],
    looks: dict[float, str],
    bearings: list[str],
) -> None:
    """One panel: a column of dots for each motion at each part."""
    part, column, factor = what
    motions = list(dict.fromkeys(table["motion"]))
    offsets = np.linspace(-0.5, 0.5, len(motions) * len(bearings) + 2)[1:-1] * SPREAD
    for row in table.to_dict("records"):
        place = bearings.index(row["bearing"]) * len(motions) + motions.index(row["motion"])
        at = names.index(row[part]) + offsets[place]
        marker = drawing.MARKERS[bearings.index(row["bearing"]) % len(drawing.MARKERS)]
        look: drawing.Look = {"color": looks[row["ambient_degC"]], "marker": marker}
        ax.plot([at], [factor * row[column]], markersize=3.5, linestyle="none", **look)
    ax.set_xticks(range(len(names)), names, rotation=30, ha="right", rotation_mode="anchor")
    ax.set_xlim(-0.6, len(names) - 0.4)
    ax.set_ylim(bottom=0.0)
    ax.grid(False, axis="x")
