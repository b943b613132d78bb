"""Loading speed of a specimen in the time of the laboratory."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

WIDTH, HEIGHT = 4.2, 2.3  # of one panel [inch]
TIME_BINS = 900
MODES = {"": "", "rt": "real time", "pd": "pseudo-dynamic"}


def draw_speed(result: EarthquakeResult) -> Figure:
    """Rows are bearings, columns modes: a slow test takes longer and has its own axes.

    The first motion; the fastest run lies below, and the largest speeds are printed.
    """
    data, table = result.dataset, result.table
    motion = table["motion"].iloc[0]
    bearings, modes = list(dict.fromkeys(table["bearing"])), list(dict.fromkeys(result.modes))
    ambients = sorted(set(table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    looks = dict(zip(ambients, colours, strict=True))
    size = (max(WIDTH * len(modes), 5.0) + 0.6, HEIGHT * len(bearings) + 0.9)
    title = f"{data.attrs['structure']}: loading speed of the specimen, {motion}"
    figure, axes = drawing.panels(len(bearings), len(modes), size, title, share="col")
    for panel, ax in enumerate(axes):
        bearing, mode = bearings[panel // len(modes)], modes[panel % len(modes)]
        mine = table[(table["bearing"] == bearing) & (table["motion"] == motion)]
        mine = mine[[result.modes[run] == mode for run in mine.index]]
        mine = mine.sort_values("ambient_degC", kind="stable")
        runs = {int(run): looks[mine["ambient_degC"][run]] for run in mine.index}
        _panel(ax, result, runs)
        last = panel // len(modes) == len(bearings) - 1
        drawing.name_axes(
            ax,
            "time in the laboratory [s]" if last else "",
            "speed [mm/s]" if panel % len(modes) == 0 else "",
            ", ".join(part for part in (bearing, MODES[mode]) if part),
        )
        ax.title.set_fontsize(drawing.SMALL)
    drawing.legend_below(
        figure,
        [
            Line2D([], [], color=colour, label=f"ambient {drawing.degrees(value)}")
            for value, colour in looks.items()
        ],
    )
    return figure


def _panel(ax: Axes, result: EarthquakeResult, runs: dict[int, str]) -> None:
    """Runs of one bearing in one mode, on the clock of the bearing where the file has it."""
    data = result.dataset
    largest = {run: float(np.nanmax(np.abs(data["bearing_speed"].values[run]))) for run in runs}
    clock = "bearing_clock" if "bearing_clock" in data else "time"
    for place, run in enumerate(sorted(runs, key=lambda run: -largest[run])):
        told = np.isfinite(data["time"].values[run])
        speed = data["bearing_speed"].values[run][told].astype(float)
        kept = drawing.thin(speed, TIME_BINS)
        width = 1.1 if place == 0 else 0.7
        ax.plot(data[clock].values[run][told][kept], speed[kept], color=runs[run], linewidth=width)
    ax.margins(y=0.14)
    texts = [f"{largest[run]:.3g}" for run in runs]
    drawing.note_values(ax, "largest", texts, list(runs.values()))
