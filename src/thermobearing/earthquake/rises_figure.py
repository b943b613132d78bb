"""How much the rubber layers and the lead of bearings warm up in an earthquake."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.strong_part import strong_part
from thermobearing.results import drawing

Floats = NDArray[np.float64]
MOST_COLUMNS = 4
WIDTH, HEIGHT = 2.9, 2.1  # of one panel [inch]
TIME_BINS = 900
THIN, THICK = 0.6, 1.7  # lines of the outer and of the innermost layer
ROOM = 0.12  # of the height of a panel, for what is printed in it


class _Row(NamedTuple):
    """A row of panels: one bearing, its rubber or its lead."""

    bearing: str
    lead: bool


def draw_rises(result: EarthquakeResult) -> Figure:
    """Rise over the start: a row for the rubber of each bearing that has heat, one for its lead.

    Columns are motions. The hottest place is printed in the colour of the ambient temperature.
    """
    data, table = result.dataset, result.table
    motions = list(dict.fromkeys(table["motion"]))
    shown = motions[:MOST_COLUMNS]
    rows = _rows(result)
    more = f" (first {len(shown)} of {len(motions)} motions)" if len(motions) > len(shown) else ""
    title = f"{data.attrs['structure']}: rise of the temperature in one bearing{more}"
    size = (max(WIDTH * len(shown), 5.0) + 0.6, HEIGHT * len(rows) + 1.0)
    figure, axes = drawing.panels(len(rows), len(shown), size, title)
    ambients = sorted(set(table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    looks = dict(zip(ambients, colours, strict=True))
    for panel, ax in enumerate(axes):
        row, motion = rows[panel // len(shown)], shown[panel % len(shown)]
        mine = table[(table["bearing"] == row.bearing) & (table["motion"] == motion)]
        mine = mine.sort_values("ambient_degC", kind="stable")
        _panel(ax, result, row, {int(run): looks[mine["ambient_degC"][run]] for run in mine.index})
        start, end = strong_part(data, list(table.index[table["motion"] == motion]))
        ax.set_xlim(start, end)
        last, first = panel // len(shown) == len(rows) - 1, panel % len(shown) == 0
        drawing.name_axes(ax, "time [s]" if last else "", "rise [K]" if first else "")
    sides = [f"{row.bearing}\n{'lead' if row.lead else 'rubber'}" for row in rows]
    drawing.head_grid(axes, shown, sides)
    _same_heights(axes, rows, len(shown))
    drawing.legend_below(figure, _handles(result, looks))
    return figure


def _rows(result: EarthquakeResult) -> list[_Row]:
    """What has a temperature: a bearing without heat makes no row."""
    rows = []
    for bearing in dict.fromkeys(result.table["bearing"]):
        for lead, name in ((False, "rubber_temperature"), (True, "lead_temperature")):
            values = result[name].values[result["bearing"].values == bearing]
            if np.isfinite(values).any():
                rows.append(_Row(str(bearing), lead))
    return rows


def _panel(ax: Axes, result: EarthquakeResult, row: _Row, runs: dict[int, str]) -> None:
    """Layers from thin (outer) to thick (innermost), or the lead, and what they reach."""
    data, hottest = result.dataset, []
    both = len(set(result.modes)) > 1
    for run, colour in runs.items():
        time = data["time"].values[run]
        told = np.isfinite(time)
        if row.lead:
            values = data["lead_temperature"].values[run][told].astype(float)[:, None]
        else:
            values = data["rubber_temperature"].values[run][told].astype(float)
            values = values[:, np.isfinite(values).all(axis=0)]
        rise, count = values - values[0], values.shape[1]
        line = "--" if both and result.modes[run] == "pd" else "-"
        for j in range(count):
            kept = drawing.thin(rise[:, j], TIME_BINS)
            share = (j + 1) / count if count > 1 else 0.5
            look: drawing.Look = {"color": colour, "linewidth": THIN + share * (THICK - THIN)}
            ax.plot(time[told][kept], rise[kept, j], linestyle=line, alpha=0.8, **look)
        hottest.append(float(values.max()) if values.size else np.nan)
        end = result.tested_to([run], "lead_temperature")
        if row.lead and np.isfinite(end):
            drawing.mark_tested(ax, end - float(values[0, 0]), "tested to here")
    texts = [f"{value:.0f}" for value in hottest]
    texts[-1] += " °C"
    drawing.note_values(ax, "hottest", texts, list(runs.values()))


def _same_heights(axes: list[Axes], rows: list[_Row], columns: int) -> None:
    """One scale for the rubber of all bearings, and one for the lead, with room for the notes."""
    for lead in (False, True):
        mine = [ax for k, ax in enumerate(axes) if rows[k // columns].lead == lead]
        highest = max((ax.get_ylim()[1] for ax in mine), default=0.0)
        for ax in mine:
            ax.set_ylim(-0.04 * highest, (1.0 + ROOM) * highest)


def _handles(result: EarthquakeResult, looks: dict[float, str]) -> list[Line2D]:
    """Legend: temperatures, layers, and modes of a laboratory where there are two."""
    found = [
        Line2D([], [], color=colour, label=f"ambient {drawing.degrees(value)}")
        for value, colour in looks.items()
    ]
    half = bool(result.dataset.attrs.get("half_stack", 1))
    names = ("outer layer", "innermost layer") if half else ("upper layer", "lower layer")
    for name, width in zip(names, (THIN, THICK), strict=True):
        found.append(Line2D([], [], color=drawing.GREY, linewidth=width, label=name))
    if len(set(result.modes)) > 1:
        look: drawing.Look = {"color": drawing.GREY, "linestyle": "--"}
        found.append(Line2D([], [], label="pseudo-dynamic (dashed)", **look))
    return found
