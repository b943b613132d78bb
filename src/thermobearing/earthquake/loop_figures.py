"""Loops of different bearings over each other: what each makes of the same motion."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.modes import has_both
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

MOST_COLUMNS = 4
MODE_LOOKS: dict[str, drawing.Look] = {
    "rt": {"color": "#CC3311"},
    "pd": {"color": "#0077BB", "linestyle": "--"},
}
WIDTH, HEIGHT = 3.0, 2.7  # of one panel [inch]


def draw_largest_loops(result: EarthquakeResult) -> Figure:
    """The largest loop of every bearing: a row for each temperature, a column for each motion."""
    loops, data = result.largest_loops, result.dataset
    bearings = list(dict.fromkeys(loops["bearing"]))
    ambients = sorted(set(loops["ambient_degC"]))
    motions = list(dict.fromkeys(loops["motion"]))
    columns = min(len(motions), MOST_COLUMNS)
    more = f" (first {columns} of {len(motions)} motions)" if len(motions) > columns else ""
    colours = dict(zip(bearings, drawing.ordered_colours(len(bearings), "viridis"), strict=True))
    size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * len(ambients) + 1.0)
    title = f"{data.attrs['structure']}: largest loop of one bearing{more}"
    figure, axes = drawing.panels(len(ambients), columns, size, title, share=True)
    for panel, ax in enumerate(axes):
        ambient, motion = ambients[panel // columns], motions[panel % columns]
        mine = loops[(loops["ambient_degC"] == ambient) & (loops["motion"] == motion)]
        for run, loop in zip(mine.index.to_numpy(), mine.to_dict("records"), strict=True):
            time = data["time"].values[run]
            inside = (time >= loop["start_s"]) & (time <= loop["end_s"])  # none if there is none
            x = data["bearing_displacement"].values[run, inside]
            y = data["bearing_force"].values[run, inside]
            dashed = has_both(result) and loop["mode"] == "pd"
            look: drawing.Look = {"linestyle": "--" if dashed else "-", "linewidth": 1.1}
            ax.plot(x, y, color=colours[loop["bearing"]], **look)
        drawing.name_axes(
            ax,
            "displacement [mm]" if panel // columns == len(ambients) - 1 else "",
            "force [kN]" if panel % columns == 0 else "",
        )
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        ax.axvline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
    drawing.head_grid(axes, motions[:columns], [f"ambient {drawing.degrees(t)}" for t in ambients])
    handles = [Line2D([], [], color=colours[name], label=name) for name in bearings]
    if has_both(result):
        look = {"color": drawing.GREY, "linestyle": "--"}
        handles.append(Line2D([], [], label="pseudo-dynamic (dashed)", **look))
    drawing.legend_below(figure, handles)
    return figure


def draw_modes(result: EarthquakeResult) -> Figure:
    """Loops of the specimen in both modes: a row for each bearing, a column a temperature."""
    table, data = result.table, result.dataset
    bearings = list(dict.fromkeys(table["bearing"]))
    ambients = sorted(set(table["ambient_degC"]))
    motion = table["motion"].iloc[0]
    size = (max(WIDTH * len(ambients), 5.0) + 0.6, HEIGHT * len(bearings) + 1.0)
    title = f"{data.attrs['structure']}: real time over pseudo-dynamic, {motion}"
    figure, axes = drawing.panels(len(bearings), len(ambients), size, title, share=True)
    for panel, ax in enumerate(axes):
        bearing, ambient = bearings[panel // len(ambients)], ambients[panel % len(ambients)]
        mine = table[(table["bearing"] == bearing) & (table["ambient_degC"] == ambient)]
        mine = mine[mine["motion"] == motion]
        for run, mode in zip(mine.index.to_numpy(), mine["mode"], strict=True):
            told = np.isfinite(data["time"].values[run])
            strain = 100.0 * data["bearing_strain"].values[run, told]
            force = data["bearing_force"].values[run, told]
            ax.plot(strain, force, linewidth=0.9, **MODE_LOOKS[mode])
        drawing.name_axes(
            ax,
            "shear strain [%]" if panel // len(ambients) == len(bearings) - 1 else "",
            "force [kN]" if panel % len(ambients) == 0 else "",
        )
    drawing.head_grid(axes, [f"ambient {drawing.degrees(t)}" for t in ambients], bearings)
    names = {"pd": "pseudo-dynamic", "rt": "real time"}
    handles = [Line2D([], [], label=names[mode], **MODE_LOOKS[mode]) for mode in ("rt", "pd")]
    drawing.legend_below(figure, handles)
    return figure


def has_loops(result: EarthquakeResult) -> bool:
    """Whether any run has a largest loop to be drawn."""
    data = result.dataset
    return "loop_start" in data and bool(np.isfinite(data["loop_start"].values).any())
