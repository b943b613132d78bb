"""Figures of histories and loops in earthquakes.

Rows are bearings, columns motions, colours ambient temperatures from cold (blue) to warm (red).
A study with many motions shows the first few; the table has them all.
"""

import copy
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.earthquake.modes import has_both
from thermobearing.earthquake.parts import GOVERNING, has_parts, told_of_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.summary_figures import (
    draw_parts,
    draw_peaks,
    draw_profiles,
    draw_rises,
    draw_speed,
    peak_place,
    strong_part,
)
from thermobearing.results import drawing

Floats = NDArray[np.float64]
MOST_COLUMNS = 4
MODE_LOOKS: dict[str, drawing.Look] = {
    "rt": {"color": "#CC3311"},
    "pd": {"color": "#0077BB", "linestyle": "--"},
}
LOOP_WIDTH, LOOP_HEIGHT = 3.0, 2.7  # of one panel [inch]


def _draw_largest_loops(result: EarthquakeResult) -> Figure:
    """The largest loop of every bearing: a row for each temperature, a column for each motion."""
    loops, data = result.largest_loops, result.dataset
    bearings = list(dict.fromkeys(loops["bearing"]))
    ambients = sorted(set(loops["ambient_degC"]))
    motions = list(dict.fromkeys(loops["motion"]))
    columns = min(len(motions), MOST_COLUMNS)
    more = f" (first {columns} of {len(motions)} motions)" if len(motions) > columns else ""
    colours = dict(zip(bearings, drawing.ordered_colours(len(bearings), "viridis"), strict=True))
    size = (max(LOOP_WIDTH * columns, 5.0) + 0.6, LOOP_HEIGHT * len(ambients) + 1.0)
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


def _draw_modes(result: EarthquakeResult) -> Figure:
    """Loops of the specimen in both modes: a row for each bearing, a column a temperature."""
    table, data = result.table, result.dataset
    bearings = list(dict.fromkeys(table["bearing"]))
    ambients = sorted(set(table["ambient_degC"]))
    motion = table["motion"].iloc[0]
    size = (max(LOOP_WIDTH * len(ambients), 5.0) + 0.6, LOOP_HEIGHT * len(bearings) + 1.0)
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


def _has_loops(result: EarthquakeResult) -> bool:
    """Whether any run has a largest loop to be drawn."""
    data = result.dataset
    return "loop_start" in data and bool(np.isfinite(data["loop_start"].values).any())


def describe_all(dataset: xr.Dataset, part: str, name: str | None) -> xr.Dataset:
    """Return the dataset whose peaks, and histories where it has them, are those of one part.

    Parameters
    ----------
    dataset : of a study.
    part : "pier" or "line".
    name : of the part; None for the one whose histories the dataset holds.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError : no part has that name; the nearest is named.
    """
    name = dataset.attrs.get(part) if name is None else name
    if name is None or (name == dataset.attrs.get(part) and not has_parts(dataset)):
        return dataset
    dimension = "line" if part == "line" else "pier_part"
    names = [str(one) for one in dataset[dimension].values] if has_parts(dataset) else []
    known = names or [str(dataset.attrs.get(part, ""))]
    if name not in names:
        raise InputError(f'{part} = "{name}": no {part} has that name{nearest(str(name), known)}')
    own = dataset.sel({dimension: name}, drop=True)
    if part == "pier":
        changed = {
            "pier_displacement": own["pier_part_displacement"],
            "pier_rotation": own["pier_part_rotation"],
            "pier_moment": own["pier_part_moment"],
        }
        changed |= {key: own[of] for key, of in GOVERNING.items() if key.startswith("pier_")}
    else:
        way = own["line_displacement_max"]
        per_mm = own["line_strain_max"] / way.where(way > 0.0)
        changed = {
            "bearing_strain": own["line_displacement"] * per_mm,
            "bearing_strain_max": own["line_strain_max"],
        }
    kept = {key: value.variable for key, value in changed.items()}
    return dataset.assign(kept).assign_attrs({part: name})


def _yield_point(data: xr.Dataset, run: int) -> tuple[float, float] | None:
    """Rotation [rad] and moment [kN m] at which the hinge of the pier yields; None without one.

    The moment is that of the elastic branch, on which the hinge is up to its first yielding.

    Parameters
    ----------
    data : of an earthquake study.
    run : its number.
    """
    ductility = float(data["pier_ductility"][run])
    if not np.isfinite(ductility) or ductility <= 0.0:
        return None
    rotation = float(data["pier_rotation_max"][run]) / ductility
    path = data["pier_rotation"].values[run].astype(float)
    path = path[np.isfinite(path)]
    beyond = np.abs(path) > rotation
    elastic = slice(0, int(beyond.argmax()) if beyond.any() else len(path))
    place = int(np.abs(path[elastic]).argmax()) if len(path[elastic]) else 0
    if not path[place]:
        return None
    return rotation, rotation * float(data["pier_moment"][run, place]) / path[place]


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


def _draw_shares(result: EarthquakeResult) -> Figure:
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


TIME_BINS = 900  # points of a history are thinned to two per bin
KJ, MN_M = 1e-3, 1e-3
WIDER = 0.8  # of its width: each line that lies below another
NOTE_ROOM = 0.12  # of the height of a panel, for the values that are printed in it
SIZES = "bearing_strain_max"
LINES: dict[str, Any] = {"": "-", "rt": "-", "pd": "--"}
MODES = {"rt": "real time", "pd": "pseudo-dynamic"}
Draw = Callable[[Axes, int, str], None]


class EarthquakeFigures:
    """Figures of a study: `result.plot.loops()` and so on, each a matplotlib Figure."""

    def __init__(self, result: EarthquakeResult) -> None:
        self._result = result
        self._data = result.dataset
        self._table = result.table
        self._bearings = list(dict.fromkeys(self._table["bearing"]))
        self._motions = list(dict.fromkeys(self._table["motion"]))
        self._ambients = sorted(set(self._table["ambient_degC"]))
        colours = drawing.ambient_colours(np.array(self._ambients, dtype=float))
        self._colours = dict(zip(self._ambients, colours, strict=True))
        self._run_modes = np.array(result.modes)
        self._modes = list(dict.fromkeys(result.modes))

    def _values(self, name: str, run: int) -> Floats:
        values = self._data[name].values[run]
        return np.asarray(values[np.isfinite(self._data["time"].values[run])], dtype=float)

    def _legend(self, figure: Figure, *, modes: bool = True) -> None:
        handles = [
            Line2D([], [], color=self._colours[value], label=f"ambient {drawing.degrees(value)}")
            for value in self._ambients
        ]
        drawing.legend_below(figure, handles + (self._mode_handles() if modes else []))

    def _mode_handles(self) -> list[Line2D]:
        """Legend entries of the modes of a laboratory, if there are several."""
        if len(self._modes) < 2:
            return []
        return [
            Line2D([], [], color=drawing.GREY, linestyle=LINES[mode], label=MODES[mode])
            for mode in self._modes
        ]

    def _line(self, run: int) -> Any:
        """Style of the lines of a run: dashed for pseudo-dynamic beside real time."""
        return LINES[self._result.modes[run]] if len(self._modes) > 1 else "-"

    def _grid(
        self,
        what: str,
        x: str,
        y: str,
        draw: Draw,
        ax: Axes | None = None,
        *,
        strain: Literal["x", "y"] | None = None,
        sizes: str = "",
        notes: bool = False,
    ) -> Figure:
        """One panel per bearing and motion; `draw` is called for every run in it.

        All runs go into `ax` where somebody gives one. `strain` is the axis that shows the strain
        [%]: beyond the tested range it is shaded. `sizes` names the variable whose largest run
        is drawn first, below the others; `notes` leaves room for `_note`. The panels of a motion
        have the same axes.
        """
        if ax is not None:
            for run, ambient in zip(self._table.index, self._table["ambient_degC"], strict=True):
                draw(ax, int(run), self._colours[ambient])
            drawing.name_axes(ax, x, y)
            return drawing.parent_figure(ax)
        untested = []
        motions = self._motions[:MOST_COLUMNS]
        rows, columns = len(self._bearings), len(motions)
        size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * rows + 0.9)
        more = len(self._motions) - columns
        note = f" (first {columns} of {len(self._motions)} motions)" if more else ""
        about = told_of_parts(self._data)
        title = f"{self._data.attrs['structure']}: {what}{note}{f' ({about})' if about else ''}"
        figure, axes = drawing.panels(rows, columns, size, title, share="col")
        for panel, ax in enumerate(axes):
            bearing, motion = self._bearings[panel // columns], motions[panel % columns]
            of_motion = self._table[self._table["motion"] == motion]
            chosen = of_motion[of_motion["bearing"] == bearing]
            runs = self._largest_first([int(run) for run in chosen.index], sizes)
            for run in runs:
                draw(ax, run, self._colours[self._table["ambient_degC"][run]])
            for place, line in enumerate(ax.get_lines()):  # equal ones remain visible
                line.set_linewidth(line.get_linewidth() * (1.0 + WIDER * (len(runs) - 1 - place)))
            untested.append(100.0 * self._result.tested_to(runs, "strain"))
            foot, side = panel // columns == rows - 1, panel % columns == 0
            drawing.name_axes(ax, x if foot else "", y if side else "")
            if side and self._knows_no_heat(runs):
                drawing.say_why(ax, "bilinear: the same\nat all temperatures")
        drawing.head_grid(axes, motions, self._bearings)
        for ax in axes[:columns] if notes else []:
            low, high = ax.get_ylim()
            ax.set_ylim(low, high + NOTE_ROOM * (high - low))
        if strain is not None:
            drawing.shade_untested(axes, [(-end, end) for end in untested], strain)
        self._legend(figure)
        return figure

    def _knows_no_heat(self, runs: list[int]) -> bool:
        """Whether the lines of a panel lie over each other since its bearing has no temperature."""
        names = {str(self._data["bearing"].values[run]) for run in runs}
        same = all(self._data.attrs.get(f"bilinear:{name}", 0) for name in names)
        return len(runs) > 1 and same

    def _largest_first(self, runs: list[int], name: str) -> list[int]:
        """Runs of a panel in the order they are drawn, so that none hides a smaller one."""
        if name not in self._data:
            return runs
        sizes = np.nan_to_num(self._data[name].values)
        return sorted(runs, key=lambda run: -float(sizes[run]))

    def _panel_runs(self, figure: Figure) -> list[tuple[Axes, list[int], str]]:
        """Panels of a grid, the runs in each from cold to warm, and its motion."""
        motions = self._motions[:MOST_COLUMNS]
        found = []
        for panel, ax in enumerate(figure.axes):
            bearing, motion = self._bearings[panel // len(motions)], motions[panel % len(motions)]
            table = self._table[self._table["bearing"] == bearing]
            table = table[table["motion"] == motion].sort_values("ambient_degC", kind="stable")
            runs = [int(run) for run in table.index]
            found.append((ax, runs, motion))
        return found

    def _note(self, ax: Axes, name: str, runs: list[int], values: list[float]) -> None:
        """Values of the runs of a panel, each in the colour of its temperature."""
        colours = [self._colours[self._table["ambient_degC"][run]] for run in runs]
        drawing.note_values(ax, name, [f"{value:.3g}" for value in values], colours)

    def _history(
        self,
        name: str,
        what: str,
        y: str,
        ax: Axes | None,
        factor: float = 1.0,
        strain: Literal["y"] | None = None,
    ) -> Figure:
        """A history in the strong part of each motion, with its peaks marked and printed."""
        told = f"{what}, strong part of the motion"
        draw, peaks = self._time(name, factor), f"{name}_max"
        if ax is not None:
            return self._grid(what, "time [s]", y, draw, ax)
        figure = self._grid(told, "time [s]", y, draw, strain=strain, sizes=peaks, notes=True)
        for ax, runs, motion in self._panel_runs(figure):
            same = list(self._table.index[self._table["motion"] == motion])
            ax.set_xlim(*strong_part(self._data, same, name))
            for run in runs:
                values = factor * self._values(name, run)
                place = peak_place(values)
                if place is None:
                    continue
                look: drawing.Look = {"color": self._colours[self._table["ambient_degC"][run]]}
                at = [self._values("time", run)[place]], [values[place]]
                ax.plot(*at, "o", markersize=4.0, markeredgecolor="white", zorder=4, **look)
            self._note(ax, "peak", runs, [factor * float(self._data[peaks][run]) for run in runs])
        return figure

    def _plane(self, x: str, y: str, factor: float = 1.0, other: float = 1.0) -> Draw:
        """A path in the plane of two histories."""

        def draw(ax: Axes, run: int, colour: str) -> None:
            a, b = factor * self._values(x, run), other * self._values(y, run)
            width, height = max(np.ptp(a), 1e-12), max(np.ptp(b), 1e-12)
            kept = drawing.thin_loops(a, b, width, height)
            ax.plot(a[kept], b[kept], color=colour, linewidth=0.8, linestyle=self._line(run))

        return draw

    def _time(self, name: str, factor: float = 1.0) -> Draw:
        """A history."""

        def draw(ax: Axes, run: int, colour: str) -> None:
            time, values = self._values("time", run), factor * self._values(name, run)
            if not np.isfinite(values).all():
                return
            kept = drawing.thin(values, TIME_BINS)
            line = self._line(run)
            ax.plot(time[kept], values[kept], color=colour, linewidth=0.7, linestyle=line)

        return draw

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str | None = None) -> Figure:
        """Force of one bearing against its strain, as Fig. 6.9 and 6.12 (3.16 to 3.19).

        Parameters
        ----------
        ax : draw all runs into this panel instead of one for each bearing and motion.
        label, color : of what is drawn into it; the colours of the temperatures by default.
        """
        plain = self._plane("bearing_strain", "bearing_force", 100.0)

        def draw(panel: Axes, run: int, colour: str) -> None:
            plain(panel, run, color or colour)
            if label and run == 0:
                panel.get_lines()[-1].set_label(label)

        what, x = "hysteresis of one bearing", "shear strain [%]"
        return self._grid(what, x, "force [kN]", draw, ax, strain="x", sizes=SIZES)

    def largest_loops(self) -> Figure:
        """The largest loop, the bearings over each other, as Fig. 4.12 and 6.6."""
        return _draw_largest_loops(self._result)

    def parts(self) -> Figure:
        """Every bearing line and every pier beside each other, where there are several."""
        return draw_parts(self._result)

    def modes(self) -> Figure:
        """Real time over pseudo-dynamic: loops of the specimen, as Fig. 3.16 to 3.19."""
        return _draw_modes(self._result)

    def _of(self, part: str, name: str | None) -> "EarthquakeFigures":
        """The same figures of another line or pier."""
        view = copy.copy(self)
        view._data = describe_all(self._data, part, name)
        return view

    def strain(self, ax: Axes | None = None, *, line: str | None = None) -> Figure:
        """Shear strain in time, as Fig. 6.10 and 6.13; of the bearings of any `line`."""
        what, y = "shear strain of the bearings", "shear strain [%]"
        return self._of("line", line)._history("bearing_strain", what, y, ax, 100.0, "y")

    def pier(self, ax: Axes | None = None, *, pier: str | None = None) -> Figure:
        """Displacement of a pier's top relative to its base, as Fig. 6.17 and 6.19; of any pier."""
        what = "pier top relative to its base"
        return self._of("pier", pier)._history("pier_displacement", what, "displacement [mm]", ax)

    def pier_acceleration(self, ax: Axes | None = None) -> Figure:
        """Absolute acceleration of the pier top, as Fig. 3.27, 3.29, 4.15, 5.18 and 5.20."""
        what = "acceleration of the pier top"
        view = self._of("pier", None)
        return view._history("pier_top_acceleration", what, "acceleration [m/s2]", ax)

    def hinge(self, ax: Axes | None = None) -> Figure:
        """Moment against rotation of the pier base, as Fig. 6.21 and 6.22; its yield point."""
        return self._of("pier", None)._hinge(ax)

    def _hinge(self, ax: Axes | None) -> Figure:
        """That of the pier whose data these figures show."""
        draw = self._plane("pier_rotation", "pier_moment", 1e3, MN_M)
        x, y = "rotation [mrad]", "moment [MN m]"
        what = "pier base (dashed: where it yields; numbers: ductility)"
        if ax is not None:
            return self._grid(what, x, y, draw, ax)
        figure = self._grid(what, x, y, draw, sizes="pier_rotation_max")
        for panel, runs, _ in self._panel_runs(figure):
            found = [_yield_point(self._data, run) for run in runs]
            for point in [point for point in found if point is not None][:1]:
                rotation, moment = 1e3 * point[0], MN_M * point[1]
                look: drawing.Look = {"color": drawing.GREY, "linewidth": 0.8, "linestyle": "--"}
                for sign in (-1.0, 1.0):
                    panel.axhline(sign * moment, zorder=1.2, **look)
                    panel.plot([sign * rotation], [sign * moment], "D", color=drawing.INK, ms=3.5)
            ductility = [float(self._data["pier_ductility"][run]) for run in runs]
            self._note(panel, "", runs, ductility)
            if max(ductility) < 1.0:
                drawing.say_why(panel, "stays elastic", (0.98, 0.12))
        for panel in figure.axes:  # with room above the line where it yields
            panel.relim()
            low, high = panel.dataLim.intervaly
            panel.set_ylim(1.08 * low, (1.08 + 2.0 * NOTE_ROOM) * high)
        return figure

    def deck(self, ax: Axes | None = None) -> Figure:
        """Absolute acceleration of the deck, as Fig. 6.23 and 6.25."""
        what = "acceleration of the deck"
        return self._history("deck_acceleration", what, "acceleration [m/s2]", ax)

    def energy(self, ax: Axes | None = None) -> Figure:
        """Work done on one bearing in time, as Fig. 3.25."""
        draw = self._time("bearing_energy", KJ)
        return self._grid("energy taken by one bearing", "time [s]", "energy [kJ]", draw, ax)

    def temperature(self) -> Figure:
        """Rise of the rubber layers and, below them, of the lead, as Fig. 3.20 and 5.16."""
        return draw_rises(self._result)

    def speed(self) -> Figure:
        """Loading speed of the bearing on its own clock, as Fig. 3.15."""
        return draw_speed(self._result)

    def profiles(self, times: Sequence[float] | None = None) -> Figure:
        """Temperature through the height, the bearings below each other, as Fig. 4.14 and 5.17.

        Parameters
        ----------
        times : since the start of the motion [s], at most 8; quarters of it by default.

        Raises
        ------
        InputError : the study did not keep cells, or a time is not in it.
        """
        return draw_profiles(self._result, times)

    def shares(self) -> Figure:
        """Shares of the force in the largest loop of the first motion, as Fig. 5.15."""
        return _draw_shares(self._result)

    def peaks(self) -> Figure:
        """Peaks of every run, as Fig. 6.11, 6.14 to 6.16, 6.18, 6.20, 6.24 and 6.26."""
        return draw_peaks(self._result)

    def held(self) -> dict[str, Callable[[], Figure]]:
        """What draws each figure that the study holds data for, by name of its file."""
        figures: dict[str, Callable[[], Figure]] = {
            "loops": self.loops,
            "strain": self.strain,
            "energy": self.energy,
            "pier": self.pier,
            "pier_acceleration": self.pier_acceleration,
            "deck": self.deck,
            "peaks": self.peaks,
        }
        if has_parts(self._data):
            figures["parts"] = self.parts
        if _has_loops(self._result):
            figures["largest_loops"] = self.largest_loops
        if has_both(self._result):
            figures["modes"] = self.modes
        if np.isfinite(self._data["pier_rotation"].values).any():
            figures["hinge"] = self.hinge
        if np.isfinite(self._data["rubber_temperature"].values).any():
            figures["temperature"] = self.temperature
        if np.isfinite(self._data.get("depth", np.nan)).any():
            figures["profiles"] = self.profiles
        if np.isfinite(self._data["lead_temperature"].values).any():
            figures["shares"] = self.shares
        if self._data.attrs["command"] == "hybrid":
            figures["speed"] = self.speed
        return figures

    def save_all(self, folder: Path) -> list[Path]:
        """Every figure that the study holds, as PNG."""
        return drawing.save_figures(self.held(), folder)
