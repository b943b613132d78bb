"""What the parts of a bearing carry of its force, in its largest loop."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

WIDTH, HEIGHT = 2.9, 2.4  # of one panel [inch]
WHOLE = ("bearing_force", "whole force", "#b5b5b5")
SHARES = (
    ("rubber_force", "rubber", "#0072B2"),
    ("lead_force", "lead cores", "#000000"),
    ("viscous_force", "rate-dependent branch", "#D55E00"),
)
# The two terms of a bilinear model are no parts of the bearing: an HDR bearing has no lead.
BILINEAR = (
    ("rubber_force", "bilinear: elastic part", "#56B4E9"),
    ("lead_force", "bilinear: yielding part", "#CC79A7"),
)


def draw_shares(result: EarthquakeResult) -> Figure:
    """Shares against displacement in the largest loop of the first motion (Fig. 5.15).

    Rows are bearings, columns ambient temperatures. Without a closed loop the whole history is
    drawn, and the panel says so.
    """
    data, table = result.dataset, result.table
    bearings = list(dict.fromkeys(table["bearing"]))
    ambients, motion = sorted(set(table["ambient_degC"])), table["motion"].iloc[0]
    columns = len(ambients)
    size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * len(bearings) + 1.0)
    title = f"{data.attrs['structure']}: shares of the force in the largest loop, {motion}"
    figure, axes = drawing.panels(len(bearings), columns, size, title, share=True)
    used: dict[str, str] = {}
    for panel, ax in enumerate(axes):
        bearing, ambient = bearings[panel // columns], ambients[panel % columns]
        mine = table[(table["bearing"] == bearing) & (table["ambient_degC"] == ambient)]
        mine = mine[mine["motion"] == motion]
        for run in mine.index:
            used |= _draw(ax, result, int(run))
        drawing.name_axes(
            ax,
            "displacement [mm]" if panel // columns == len(bearings) - 1 else "",
            "force [kN]" if panel % columns == 0 else "",
        )
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        ax.axvline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
    drawing.head_grid(axes, [f"ambient {drawing.degrees(t)}" for t in ambients], bearings)
    known = [label for _, label, _ in (WHOLE, *SHARES, *BILINEAR)]
    told = [label for label in known if label in used]
    handles = [Line2D([], [], color=used[label], label=label) for label in told]
    if len(set(result.modes)) > 1:
        look: drawing.Look = {"color": drawing.GREY, "linestyle": "--"}
        handles.append(Line2D([], [], label="pseudo-dynamic (dashed)", **look))
    drawing.legend_below(figure, handles)
    return figure


def _draw(ax: Axes, result: EarthquakeResult, run: int) -> dict[str, str]:
    """Shares of one run; what was drawn, with its colour."""
    data = result.dataset
    time = data["time"].values[run]
    inside = np.isfinite(time)
    ends = [
        float(data[name][run]) if name in data else np.nan for name in ("loop_start", "loop_end")
    ]
    if np.isfinite(ends).all():
        inside &= (time >= ends[0]) & (time <= ends[1])
    else:
        look: drawing.Look = {"fontsize": drawing.SMALL - 0.5, "color": drawing.GREY, "va": "top"}
        ax.text(0.01, 0.985, "no closed loop: all of it", transform=ax.transAxes, **look)
    bilinear = bool(data.attrs.get(f"bilinear:{data['bearing'].values[run]}", 0))
    dashed = len(set(result.modes)) > 1 and result.modes[run] == "pd"
    used = {}
    x = data["bearing_displacement"].values[run][inside].astype(float)
    for name, label, colour in (WHOLE, *(BILINEAR if bilinear else SHARES)):
        y = data[name].values[run][inside].astype(float)
        if not y.any():  # the bearing has no such branch
            continue
        kept = drawing.thin_loops(x, y, max(np.ptp(x), 1e-12), max(np.ptp(y), 1e-12))
        width = 2.4 if name == WHOLE[0] else 1.0
        line: drawing.Look = {"linewidth": width, "linestyle": "--" if dashed else "-"}
        ax.plot(x[kept], y[kept], color=colour, **line)
        used[label] = colour
    return used
