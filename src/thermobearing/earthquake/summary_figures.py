"""Figures that set runs side by side: peaks, lines and piers, profiles, earlier models."""

from collections.abc import Callable, Hashable, Sequence
from typing import Any, Literal

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import INNER, SINGLE, run_keys
from thermobearing.model.earlier import REFERENCE
from thermobearing.quantities.register import quantity
from thermobearing.results import drawing
from thermobearing.results.profiles import MOST_PROFILES, ProfilePanel, draw_profile_panels

MOST_COLUMNS = 4
TIME_BINS = 900  # points of a history are thinned to two per bin
LINES: dict[str, Any] = {"": "-", "rt": "-", "pd": "--"}
MODES = {"": "", "rt": "real time", "pd": "pseudo-dynamic"}
STRAIN, FORCE, DISPLACEMENT = "shear strain [%]", "force [kN]", "displacement [mm]"
Cell = tuple[Axes, Any, Any]  # a panel, what its row and what its column stand for


class RunPanels(drawing.Figures):
    """Labels of the runs of an analysis, their colours and lines, and grids of panels.

    Colours are ambient temperatures from cold (blue) to warm (red); lines of pseudo-dynamic tests
    compared with real time are dashed.
    """

    def __init__(self, result: EarthquakeResult) -> None:
        self._result, self._data, self._table = result, result.dataset, result.table
        self._bearings = list(dict.fromkeys(self._table["bearing"]))
        self._motions = list(dict.fromkeys(self._table["motion"]))
        self._ambients = sorted(set(self._table["ambient_degC"]))
        colours = drawing.ambient_colours(np.array(self._ambients, dtype=float))
        self._colours = dict(zip(self._ambients, colours, strict=True))
        self._run_modes = list(dict.fromkeys(result.modes))

    def _title(self, what: str, motions: bool = False) -> str:
        """Return the title of a figure, which says how many motions it shows of how many."""
        count = min(len(self._motions), MOST_COLUMNS)
        several = motions and count < len(self._motions)
        more = f" (first {count} of {len(self._motions)} motions)" if several else ""
        return f"{self._data.attrs['structure']}: {what}{more}"

    def _values(self, name: str, run: int) -> Floats:
        """Return a history of a run as far as it goes."""
        values = self._data[name].values[run]
        return np.asarray(values[np.isfinite(self._data["time"].values[run])], dtype=float)

    def _runs_of(self, **labels: Any) -> list[int]:
        """Return the runs with some labels (columns of the table), from cold to warm."""
        frame = self._table
        for name, value in labels.items():
            frame = frame[frame[name] == value]
        return [int(run) for run in frame.sort_values("ambient_degC", kind="stable").index]

    def _colour(self, run: int) -> str:
        """Return the colour of the ambient temperature of a run."""
        return str(self._colours[self._table["ambient_degC"][run]])

    def _line(self, run: int) -> Any:
        """Return the style of the lines of a run."""
        return LINES[self._result.modes[run]] if len(self._run_modes) > 1 else "-"

    def _handles(self) -> list[Line2D]:
        """Return legend entries of the ambient temperatures."""
        return [
            Line2D([], [], color=colour, label=f"ambient {drawing.degrees(value)}")
            for value, colour in self._colours.items()
        ]

    def _mode_handles(self) -> list[Line2D]:
        """Return legend entries of the modes of a laboratory, if there are several."""
        several = self._run_modes if len(self._run_modes) > 1 else []
        return [
            Line2D([], [], color=drawing.GREY, linestyle=LINES[mode], label=MODES[mode])
            for mode in several
        ]

    def _note(self, ax: Axes, name: str, runs: list[int], values: Sequence[float]) -> None:
        """Print a value of each run of a panel, in the colour of its temperature."""
        texts = [f"{value:.3g}" for value in values]
        drawing.note_values(ax, name, texts, [self._colour(run) for run in runs])


def grid(
    title: str,
    size: tuple[float, float],
    rows: Sequence[Any],
    columns: Sequence[Any],
    labels: tuple[str, str],
    *,
    heads: list[str] | None = None,
    sides: list[str] | None = None,
    share: bool | Literal["row", "col"] = True,
    zero: bool = False,
) -> tuple[Figure, list[Cell]]:
    """Return a figure and its panels, each with what its row and its column stand for.

    `size` is that of a panel [inch]; `labels` are of the axes; `zero` draws lines through zero.
    """
    count = len(columns)
    inches = (max(size[0] * count, 5.0) + 0.6, size[1] * len(rows) + 1.0)
    figure, axes = drawing.panels(len(rows), count, inches, title, share=share)
    for k, ax in enumerate(axes):
        last, first = k // count == len(rows) - 1, k % count == 0
        drawing.name_axes(ax, labels[0] if last else "", labels[1] if first else "")
        for line in (ax.axhline, ax.axvline) if zero else ():
            line(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
    if heads is not None:
        drawing.head_grid(axes, heads, sides or [])
    return figure, [(ax, rows[k // count], columns[k % count]) for k, ax in enumerate(axes)]


def bearing_grid(
    panels: RunPanels,
    what: str,
    size: tuple[float, float],
    labels: tuple[str, str],
    draw: Callable[[Axes, int], None],
    *,
    share: bool = True,
    zero: bool = False,
) -> Figure:
    """Return the runs of the first motion: rows are bearings, columns ambient temperatures."""
    motion = panels._motions[0]
    heads = [f"ambient {drawing.degrees(value)}" for value in panels._ambients]
    figure, cells = grid(
        panels._title(f"{what}, {motion}"), size, panels._bearings, panels._ambients, labels,
        heads=heads, sides=panels._bearings, share=share, zero=zero,
    )  # fmt: skip
    for ax, bearing, ambient in cells:
        for run in panels._runs_of(bearing=bearing, ambient_degC=ambient, motion=motion):
            draw(ax, run)
    return figure


PART_PANELS = (  # part, column, label
    ("line", "strain_max", "bearing strain [%]"),
    ("line", "total_force_max_kN", "force of the line [kN]"),
    ("pier", "displacement_max_mm", "pier displacement [mm]"),
    ("pier", "ductility", "pier ductility"),
)
PART_SPREAD = 0.9  # of the room of a part that its dots take


def draw_parts(panels: RunPanels) -> Figure:
    """Return peaks of lines (strain, force) and piers (displacement, ductility).

    The bearings that are compared stand side by side at each part, with other markers; each has
    its motions from the left.
    """
    tables = {"line": panels._result.lines, "pier": panels._result.piers}
    shown = [item for item in PART_PANELS if tables[item[0]][item[1]].notna().any()]
    names = {part: list(dict.fromkeys(table[part])) for part, table in tables.items()}
    motions, rows = panels._motions, (len(shown) + 1) // 2
    wide = max(len(parts) for parts in names.values())
    size = (max(3.6, 1.0 + 0.8 * wide) * 2, 2.7 * rows + 0.9)
    few = 1 < len(motions) < 5
    order = f" (motions from the left: {', '.join(motions)})" if few else ""
    title = panels._title(f"bearing lines and piers{order}")
    figure, axes = drawing.panels(rows, 2, size, title)
    markers = {
        name: drawing.MARKERS[k % len(drawing.MARKERS)] for k, name in enumerate(panels._bearings)
    }
    offsets = np.linspace(-0.5, 0.5, len(motions) * len(markers) + 2)[1:-1] * PART_SPREAD
    for spare in axes[len(shown) :]:
        spare.set_visible(False)
    for ax, (part, column, label) in zip(axes, shown, strict=False):
        for row in tables[part].to_dict("records"):
            place = panels._bearings.index(row["bearing"]) * len(motions)
            at = names[part].index(row[part]) + offsets[place + motions.index(row["motion"])]
            look: drawing.Look = {"color": panels._colours[row["ambient_degC"]], "markersize": 3.5}
            look |= {"marker": markers[row["bearing"]], "linestyle": "none"}
            ax.plot([at], [quantity(column).shown(row[column])], **look)
        ticks: drawing.Look = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"}
        ax.set_xticks(range(len(names[part])), names[part], **ticks)
        ax.set_xlim(-0.6, len(names[part]) - 0.4)
        ax.set_ylim(bottom=0.0)
        ax.grid(False, axis="x")
        drawing.name_axes(ax, "", label)
    handles = [
        Line2D([], [], color=c, marker="o", linestyle="none", label=drawing.degrees(t))
        for t, c in panels._colours.items()
    ]
    for name, marker in markers.items() if len(markers) > 1 else ():
        look = {"color": drawing.GREY, "marker": marker, "linestyle": "none"}
        handles.append(Line2D([], [], label=name, **look))
    drawing.legend_below(figure, handles)
    return figure


SHOWN = {  # columns of the table of runs: label
    "bearing_strain_max": "bearing strain",
    "bearing_force_max_kN": "bearing force",
    "bearing_energy_kN_mm": "bearing energy",
    "pier_displacement_max_mm": "pier displacement",
    "pier_ductility": "pier ductility",
    "deck_acceleration_max_m_s2": "deck acceleration",
}
SPREAD = 0.5  # of the room of a temperature that its dots take
MEAN = 0.36  # half the length of the line at a mean


def draw_peaks(panels: RunPanels) -> Figure:
    """Return peaks: rows are quantities, columns bearings; ambient temperatures, marks of motions.

    The lines are means over the motions; a pseudo-dynamic test has empty marks and dashed means.
    """
    table, ambients = panels._table.assign(mode=panels._result.modes), panels._ambients
    shown = [quantity(name, head=head) for name, head in SHOWN.items()]
    shown = [item for item in shown if np.isfinite(table[item.name]).any()]
    columns = len(panels._bearings)
    wide = max(1.9, 0.5 * len(ambients) + 0.9)
    size = (max(wide * columns, 4.0) + 0.8, 1.55 * len(shown) + 1.2)
    of_all = " (largest of all lines and piers)" if panels._result.has_parts else ""
    figure, axes = drawing.panels(len(shown), columns, size, panels._title(f"peaks{of_all}"))
    names = [drawing.degrees(value).removesuffix(" °C") for value in ambients]
    for panel, ax in enumerate(axes):
        item, last = shown[panel // columns], panel // columns == len(shown) - 1
        mine = table[table["bearing"] == panels._bearings[panel % columns]]
        for place, (ambient, colour) in enumerate(panels._colours.items()):
            rows = mine[mine["ambient_degC"] == ambient]
            _dots(ax, place, rows.assign(value=item.shown(rows[item.name])), panels, colour)
        top = item.shown(float(np.nanmax(table[item.name])))
        ax.set_ylim(0.0, 1.2 * top or 1.0)  # a deck on the ground has no pier that moves
        if item.name == "bearing_strain_max":
            end = panels._result.tested_to(list(mine.index), "strain")
            drawing.mark_tested(ax, item.shown(end), "tested to here")
        if item.name == "pier_ductility" and ax.get_ylim()[1] > 1.0:
            drawing.mark_tested(ax, 1.0, "yields")
        label = item.title if panel % columns == 0 else ""
        drawing.name_axes(ax, "ambient [°C]" if last else "", label)
        ax.yaxis.label.set_fontsize(drawing.SMALL)
        ax.set_xticks(range(len(names)), names if last else [""] * len(names))
        ax.set_xlim(-0.6, len(names) - 0.4)
        ax.grid(False, axis="x")
    drawing.head_grid(axes, panels._bearings, [])
    figure.align_ylabels()
    look: drawing.Look = {"color": drawing.GREY}
    motions = panels._motions if len(panels._motions) <= len(drawing.MARKERS) else []
    handles = [
        Line2D([], [], marker=drawing.MARKERS[k], linestyle="none", label=motion, **look)
        for k, motion in enumerate(motions)
    ]
    for mode in panels._run_modes if len(panels._run_modes) > 1 else [""]:
        label = f"mean, {MODES[mode]}" if mode else "mean"
        handles.append(Line2D([], [], label=label, linestyle=LINES[mode], **look))
    drawing.legend_below(figure, handles)
    return figure


def _dots(ax: Axes, place: int, rows: pd.DataFrame, panels: RunPanels, colour: str) -> None:
    """Draw marks of one temperature side by side by motion, and their mean for each mode."""
    offsets = np.linspace(-0.5, 0.5, len(panels._motions) + 2)[1:-1] * SPREAD
    for mode, same in rows.groupby("mode", sort=False):
        slow = mode == "pd"
        for row in same.to_dict("records"):
            number = panels._motions.index(row["motion"])
            look: drawing.Look = {"markerfacecolor": "none" if slow else colour}
            look |= {"marker": drawing.MARKERS[number % len(drawing.MARKERS)]}
            at = [place + offsets[number]], [row["value"]]
            ax.plot(*at, color=colour, markersize=4.5, linestyle="none", **look)
        line: drawing.Look = {"linewidth": 1.2, "linestyle": "--" if slow else "-"}
        ends = [place - MEAN, place + MEAN]
        ax.plot(ends, [float(same["value"].mean())] * 2, color=colour, zorder=1.5, **line)


QUARTERS = 4


def draw_profiles(panels: RunPanels, times: Sequence[float] | None) -> Figure:
    """Return profiles: a row for each bearing that has heat, a column for each temperature."""
    data, table = panels._data, panels._table
    if "temperature" not in data:
        raise InputError('profiles: the result holds no cells; run with keep = ["rubber", "cells"]')
    chosen = table[np.isfinite(data["depth"].values).any(axis=1)]
    shown = []  # the first motion, the first mode
    for label in ("motion", "mode"):
        if label in chosen:
            shown.append(str(chosen[label].iloc[0]))
            chosen = chosen[chosen[label] == shown[-1]]
    moments = _moments(data["time"].values[chosen.index.to_numpy()], times)
    bearings = list(dict.fromkeys(chosen["bearing"]))
    chosen = chosen.sort_values("ambient_degC", kind="stable")
    drawn = [
        _profile_panel(data, int(run), f"{bearing}, " if len(bearings) > 1 else "", moments)
        for bearing in bearings
        for run in chosen.index[chosen["bearing"] == bearing]
    ]
    columns = chosen["ambient_degC"].nunique()
    size = (max(5.5, 1.9 + 2.6 * columns), 0.9 + 4.0 * len(bearings))
    whole = str(data.attrs["structure"]) + (f", {bearings[0]}" if len(bearings) == 1 else "")
    title = f"{whole}: temperature through the height, {', '.join(shown)}"
    return draw_profile_panels(title, size, columns, drawn, [f"{moment:g} s" for moment in moments])


def _moments(time: Floats, times: Sequence[float] | None) -> list[float]:
    """Return the given times, or quarters of the longest run [s]."""
    longest = float(np.nanmax(time))
    if times is None:
        return [longest * (k + 1) / QUARTERS for k in range(QUARTERS)]
    faults = [f"times: {t} s is not in 0 to {longest:g} s" for t in times if not 0 <= t <= longest]
    if not 1 <= len(times) <= MOST_PROFILES:
        faults.append(f"times: {len(times)} given; 1 to {MOST_PROFILES} can be shown")
    if faults:
        raise InputError(faults, "profiles()")
    return [float(t) for t in times]


def _profile_panel(data: xr.Dataset, run: int, whose: str, moments: list[float]) -> ProfilePanel:
    """Return profiles of one run at the kept steps nearest to the times."""
    mine = data.isel(run=run)
    time = mine["time"].values
    stack = mine.isel(cell=np.isfinite(mine["depth"].values))
    stack.attrs["half_stack"] = data.attrs["half_stack"]
    lead = mine["lead_temperature"].values
    lines: list[tuple[int, Floats, float | None]] = []
    for number, moment in enumerate(moments):
        if moment > np.nanmax(time) * (1.0 + 1e-6):  # a run that ended early
            continue
        row = int(np.nanargmin(np.abs(time - moment)))
        core = float(lead[row]) if np.isfinite(lead[row]) else None
        lines.append((number, stack["temperature"].values[row].astype(float), core))
    ambient = float(mine["ambient"])
    return ProfilePanel(f"{whose}{drawing.degrees(ambient)}", ambient, stack, lines)


COMPARISON_SIZE = (3.1, 2.3)  # of one panel [inch]
BLACK: drawing.Look = {"color": "#000000", "linewidth": 1.6}
LOOP_LOOKS = {REFERENCE: BLACK, SINGLE: {"color": "#EE7733", "linewidth": 0.9}}


def comparison_figure(results: dict[str, EarthquakeResult]) -> Figure:
    """Return the inner layer in time, all models over each other (Fig. 4.13, 5.16)."""
    names = [name for name in results if name != REFERENCE]
    colours = drawing.ordered_colours(len(names), "turbo")
    looks = {REFERENCE: BLACK} | {
        name: {"color": colour, "linewidth": 0.9}
        for name, colour in zip(names, colours, strict=True)
    }

    def _draw(ax: Axes, name: str, run: int) -> None:
        values = results[name].places(run)[INNER]
        time = results[name]["time"].values[run][: len(values)]
        kept = drawing.thin(values, TIME_BINS)
        ax.plot(time[kept], values[kept], **looks[name])

    what = "temperature of the inner layer"
    return _compare(results, looks, _draw, what, ("time [s]", "temperature [°C]"), share=False)


def comparison_loops(results: dict[str, EarthquakeResult]) -> Figure:
    """Return loops of the multi-layer model and of a single temperature (Fig. 4.11, 5.9, 5.12)."""
    return _compare_single(results, "loops", ("bearing_strain", "bearing_force"), (STRAIN, FORCE))


def comparison_strains(results: dict[str, EarthquakeResult]) -> Figure:
    """Return strains of the multi-layer model and of a single temperature (Fig. 5.10, 5.13)."""
    return _compare_single(results, "strain", ("time", "bearing_strain"), ("time [s]", STRAIN))


def _compare_single(
    results: dict[str, EarthquakeResult],
    what: str,
    names: tuple[str, str],
    labels: tuple[str, str],
) -> Figure:
    """Return the multi-layer model and a single temperature in the plane of two histories."""

    def _draw(ax: Axes, name: str, run: int) -> None:
        data = results[name].dataset
        kept = np.isfinite(data["time"].values[run])
        path = (quantity(one).shown(data[one].values[run, kept].astype(float)) for one in names)
        ax.plot(*path, **LOOP_LOOKS[name])

    return _compare(results, LOOP_LOOKS, _draw, f"{what} of one bearing", labels)


def _compare(
    results: dict[str, EarthquakeResult],
    looks: dict[str, drawing.Look],
    draw: Callable[[Axes, str, int], None],
    what: str,
    labels: tuple[str, str],
    share: bool = True,
) -> Figure:
    """Return a row for each bearing, a column for each temperature; `draw` draws each model."""
    panels = RunPanels(results[REFERENCE])
    runs: dict[str, dict[tuple[Hashable, ...], int]] = {n: run_keys(results[n]) for n in looks}
    keys = list(run_keys(results[REFERENCE]))
    modes = panels._result.modes

    def _draw_models(ax: Axes, run: int) -> None:
        for name in looks if modes[run] == modes[0] else ():
            if keys[run] in runs[name]:
                draw(ax, name, runs[name][keys[run]])

    what = f"{what}, {modes[0]}" if modes[0] else what
    figure = bearing_grid(panels, what, COMPARISON_SIZE, labels, _draw_models, share=share)
    drawing.legend_below(figure, [Line2D([], [], label=k, **look) for k, look in looks.items()])
    return figure
