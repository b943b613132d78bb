"""Figures of peaks, profiles, temperature rises and earlier models.

Every model drives its own motion of the structure: temperatures, forces and displacements are
compared at equal times, peaks with peaks.
"""

from collections.abc import Callable, Hashable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.earthquake.parts import has_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.earlier import REFERENCE
from thermobearing.results import drawing
from thermobearing.results.profiles import MOST_PROFILES, ProfilePanel, draw_profile_panels
from thermobearing.results.selection import force_differences, more, temperature_differences

Floats = NDArray[np.float64]
PART_PANELS = (  # part, column, label, factor
    ("line", "strain_max", "bearing strain [%]", 100.0),
    ("line", "total_force_max_kN", "force of the line [kN]", 1.0),
    ("pier", "displacement_max_mm", "pier displacement [mm]", 1.0),
    ("pier", "ductility", "pier ductility", 1.0),
)
PART_SPREAD = 0.9  # of the room of a part that its dots take


def draw_parts(result: EarthquakeResult) -> Figure:
    """Peaks of lines (strain, force) and piers (displacement, ductility), by ambient temperature.

    The bearings that are compared stand side by side at each part, with other markers; each has
    its motions from the left.
    """
    tables = {"line": result.lines, "pier": result.piers}
    shown = [item for item in PART_PANELS if tables[item[0]][item[1]].notna().any()]
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
        _part_dots(ax, tables[part], names[part], (part, column, factor), looks, bearings)
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


def _part_dots(
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
    offsets = np.linspace(-0.5, 0.5, len(motions) * len(bearings) + 2)[1:-1] * PART_SPREAD
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


KJ = 1e-3
SHOWN: list[tuple[str, str, float]] = [
    ("bearing_strain_max", "bearing strain [%]", 100.0),
    ("bearing_force_max_kN", "bearing force [kN]", 1.0),
    ("bearing_energy_kN_mm", "bearing energy [kJ]", KJ),
    ("pier_displacement_max_mm", "pier displacement [mm]", 1.0),
    ("pier_ductility", "pier ductility", 1.0),
    ("deck_acceleration_max_m_s2", "deck acceleration [m/s2]", 1.0),
]
PEAK_MODES = {"": "mean", "rt": "mean, real time", "pd": "mean, pseudo-dynamic"}
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
    drawing.legend_below(figure, _peak_handles(motions, list(dict.fromkeys(result.modes))))
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


def _peak_handles(motions: list[str], modes: list[str]) -> list[Line2D]:
    """Legend: marks of the motions, as far as they differ, and means."""
    look: drawing.Look = {"color": drawing.GREY}
    told = motions if len(motions) <= len(drawing.MARKERS) else []
    found = [
        Line2D([], [], marker=drawing.MARKERS[k], linestyle="none", label=motion, **look)
        for k, motion in enumerate(told)
    ]
    for mode in modes if len(modes) > 1 else [""]:
        dashed: drawing.Look = {"linestyle": "--" if mode == "pd" else "-"}
        found.append(Line2D([], [], label=PEAK_MODES[mode], **look, **dashed))
    return found


QUARTERS = 4


def draw_profiles(result: EarthquakeResult, times: Sequence[float] | None) -> Figure:
    """A row for each bearing that has heat, a column for each temperature (Fig. 4.14, 5.17)."""
    data, table = result.dataset, result.table
    if "temperature" not in data:
        raise InputError('profiles: the result holds no cells; run with keep = ["rubber", "cells"]')
    warm = [run for run in range(result.runs) if np.isfinite(data["depth"].values[run]).any()]
    chosen = table.loc[warm]
    told = [str(chosen["motion"].iloc[0])]
    chosen = chosen[chosen["motion"] == told[0]]
    if "mode" in chosen:
        told.append(str(chosen["mode"].iloc[0]))
        chosen = chosen[chosen["mode"] == told[1]]
    moments = _moments(data["time"].values[chosen.index.to_numpy()], times)
    bearings, ambients = (list(dict.fromkeys(chosen[k])) for k in ("bearing", "ambient_degC"))
    panels = []
    for bearing in bearings:
        for ambient in sorted(ambients):
            mine = chosen[(chosen["bearing"] == bearing) & (chosen["ambient_degC"] == ambient)]
            whose = f"{bearing}, " if len(bearings) > 1 else ""
            panels += [
                _profile_panel(data, int(run), whose, moments) for run in mine.index.to_numpy()
            ]
    columns = len(ambients)
    size = (max(5.5, 1.9 + 2.6 * columns), 0.9 + 4.0 * len(bearings))
    whole = str(data.attrs["structure"]) + (f", {bearings[0]}" if len(bearings) == 1 else "")
    title = f"{whole}: temperature through the height, {', '.join(told)}"
    names = [f"{moment:g} s" for moment in moments]
    return draw_profile_panels(title, size, columns, panels, names)


def _moments(time: np.ndarray, times: Sequence[float] | None) -> list[float]:
    """The times asked for, or quarters of the longest run [s]."""
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
    """Profiles of one run at the kept steps nearest to the times; `whose` begins its title."""
    mine = data.isel(run=run)
    time = mine["time"].values
    stack = mine.isel(cell=np.isfinite(mine["depth"].values))
    stack.attrs["half_stack"] = data.attrs["half_stack"]
    lead = mine["lead_temperature"].values
    lines: list[tuple[int, np.ndarray, float | None]] = []
    for number, moment in enumerate(moments):
        if moment > np.nanmax(time) * (1.0 + 1e-6):  # a run that ended early
            continue
        row = int(np.nanargmin(np.abs(time - moment)))
        core = float(lead[row]) if np.isfinite(lead[row]) else None
        lines.append((number, stack["temperature"].values[row].astype(float), core))
    ambient = float(mine["ambient"])
    return ProfilePanel(f"{whose}{drawing.degrees(ambient)}", ambient, stack, lines)


SPEED_WIDTH, SPEED_HEIGHT = 4.2, 2.3  # of one panel [inch]
TIME_BINS = 900
SPEED_MODES = {"": "", "rt": "real time", "pd": "pseudo-dynamic"}


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
    size = (max(SPEED_WIDTH * len(modes), 5.0) + 0.6, SPEED_HEIGHT * len(bearings) + 0.9)
    title = f"{data.attrs['structure']}: loading speed of the specimen, {motion}"
    figure, axes = drawing.panels(len(bearings), len(modes), size, title, share="col")
    for panel, ax in enumerate(axes):
        bearing, mode = bearings[panel // len(modes)], modes[panel % len(modes)]
        mine = table[(table["bearing"] == bearing) & (table["motion"] == motion)]
        mine = mine[[result.modes[run] == mode for run in mine.index]]
        mine = mine.sort_values("ambient_degC", kind="stable")
        runs = {int(run): looks[mine["ambient_degC"][run]] for run in mine.index}
        _speed_panel(ax, result, runs)
        last = panel // len(modes) == len(bearings) - 1
        drawing.name_axes(
            ax,
            "time in the laboratory [s]" if last else "",
            "speed [mm/s]" if panel % len(modes) == 0 else "",
            ", ".join(part for part in (bearing, SPEED_MODES[mode]) if part),
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


def _speed_panel(ax: Axes, result: EarthquakeResult, runs: dict[int, str]) -> None:
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


FIRST, LAST = 0.05, 0.95  # of the Arias intensity
MARGIN = 0.2  # of the strong part, on both sides: the answer of the structure comes later


def strong_part(data: xr.Dataset, runs: Sequence[int], name: str = "") -> tuple[float, float]:
    """Start and end [s] of what is shown of some runs of one motion.

    Parameters
    ----------
    data : of an earthquake study.
    runs : their numbers.
    name : of the history that is shown; its largest values are within.

    Returns
    -------
    From 5 to 95 % of the Arias intensity of what was run and a fifth more on both sides; the
    whole time without an acceleration of the ground.
    """
    starts, ends, lasts = [], [], []
    for run in runs:
        time = data["time"].values[run].astype(float)
        told = np.isfinite(time)
        time, ground = time[told], data["ground_acceleration"].values[run][told].astype(float)
        if not len(time):
            continue
        growth = np.cumsum(ground**2)
        first, last = time[0], time[-1]
        if growth[-1] > 0.0:
            first, last = time[np.searchsorted(growth, [FIRST * growth[-1], LAST * growth[-1]])]
        room = MARGIN * (last - first)
        starts.append(first - room)
        ends.append(last + room)
        lasts.append(time[-1])
        peak = peak_place(data[name].values[run][told]) if name else None
        if peak is not None:
            starts.append(time[peak] - room)
            ends.append(time[peak] + room)
    if not lasts:
        return 0.0, 1.0
    return max(0.0, min(starts)), min(max(lasts), max(ends))


def peak_place(values: Floats) -> int | None:
    """Place of the largest absolute value; None where a value is missing."""
    return int(np.abs(values).argmax()) if np.isfinite(values).all() else None


MOST_COLUMNS = 4
RISE_WIDTH, RISE_HEIGHT = 2.9, 2.1  # of one panel [inch]
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
    size = (max(RISE_WIDTH * len(shown), 5.0) + 0.6, RISE_HEIGHT * len(rows) + 1.0)
    figure, axes = drawing.panels(len(rows), len(shown), size, title)
    ambients = sorted(set(table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    looks = dict(zip(ambients, colours, strict=True))
    for panel, ax in enumerate(axes):
        row, motion = rows[panel // len(shown)], shown[panel % len(shown)]
        mine = table[(table["bearing"] == row.bearing) & (table["motion"] == motion)]
        mine = mine.sort_values("ambient_degC", kind="stable")
        _rise_panel(
            ax, result, row, {int(run): looks[mine["ambient_degC"][run]] for run in mine.index}
        )
        start, end = strong_part(data, list(table.index[table["motion"] == motion]))
        ax.set_xlim(start, end)
        last, first = panel // len(shown) == len(rows) - 1, panel % len(shown) == 0
        drawing.name_axes(ax, "time [s]" if last else "", "rise [K]" if first else "")
    sides = [f"{row.bearing}\n{'lead' if row.lead else 'rubber'}" for row in rows]
    drawing.head_grid(axes, shown, sides)
    _same_heights(axes, rows, len(shown))
    drawing.legend_below(figure, _rise_handles(result, looks))
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


def _rise_panel(ax: Axes, result: EarthquakeResult, row: _Row, runs: dict[int, str]) -> None:
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


def _rise_handles(result: EarthquakeResult, looks: dict[float, str]) -> list[Line2D]:
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


SINGLE, INNER = "single-temperature", "inner layer"
KEYS = ("bearing", "motion", "ambient_degC", "mode")
PEAKS = {  # compared with each other [%]: column of the table of a study
    "peak strain %": "bearing_strain_max",
    "energy %": "bearing_energy_kN_mm",
    "pier displacement %": "pier_displacement_max_mm",
    "pier acceleration %": "pier_top_acceleration_max_m_s2",
    "deck acceleration %": "deck_acceleration_max_m_s2",
    "loop K_eq %": "loop_K_eq_kN_mm",
    "loop h_eq %": "loop_h_eq",
}
UNDERESTIMATES = "underestimates inner layer"
WIDTH, HEIGHT = 3.1, 2.3  # of one panel [inch]
BLACK: drawing.Look = {"color": "#000000", "linewidth": 1.6}
LOOP_LOOKS = {REFERENCE: BLACK, SINGLE: {"color": "#EE7733", "linewidth": 0.9}}


def comparison_table(results: dict[str, EarthquakeResult]) -> pd.DataFrame:
    """Errors of each earlier model, one row per run and model.

    Parameters
    ----------
    results : by the name of the model, the multi-layer one among them (`compare_models`).

    Returns
    -------
    DataFrame : root mean square and largest temperature error of the outer layer, the inner
        layer and the lead [K], over the whole run; error of the largest rise of the inner layer
        [K] and whether the model underestimates it; root mean square error of the force [% of
        the peak]; errors of peaks and of the largest loop [%]. A model whose run ended early,
        which its outcome says, is compared as far as it got.
    """
    truth = results[REFERENCE]
    table = truth.table
    found = {name: _runs(other) for name, other in results.items() if name != REFERENCE}
    rows = [
        _errors(truth, run, name, results[name], runs[key])
        for run, key in enumerate(_keys(table))
        for name, runs in found.items()
        if key in runs
    ]
    return pd.DataFrame(rows)


def _keys(table: pd.DataFrame) -> list[tuple[Hashable, ...]]:
    """What tells runs apart."""
    known = [name for name in KEYS if name in table]
    return [tuple(row) for row in table[known].itertuples(index=False)]


def _runs(result: EarthquakeResult) -> dict[tuple[Hashable, ...], int]:
    return {key: run for run, key in enumerate(_keys(result.table))}


def _errors(
    truth: EarthquakeResult, run: int, name: str, other: EarthquakeResult, its: int
) -> dict[str, Any]:
    expected, found = truth.table.iloc[run], other.table.iloc[its]
    row: dict[str, Any] = {key: expected[key] for key in KEYS if key in expected}
    row |= {"model": name, "outcome": found["outcome"]}
    places, those = truth.places(run), other.places(its)
    length = min(len(places[INNER]), len(those[INNER]))  # of one that ended early
    for place, values in places.items():
        if np.isfinite(values).all():
            row |= temperature_differences(place, those[place][:length], values[:length])
    inner = those[INNER][:length], places[INNER][:length]
    row[f"{INNER} rise K"] = _rise(inner[0]) - _rise(inner[1])
    row[UNDERESTIMATES] = underestimates(*inner)
    force = [r["bearing_force"].values[k, :length] for r, k in ((other, its), (truth, run))]
    row |= force_differences(force[0].astype(float), force[1].astype(float))
    row |= {label: more(found[column], expected[column]) for label, column in PEAKS.items()}
    return row


def underestimates(found: Floats, expected: Floats) -> bool:
    """Whether both the largest rise of a temperature and its mean over the run are lower.

    Examples
    --------
    >>> late = np.array([0.0, 0.0, 3.0])
    >>> underestimates(late - [0.0, 0.0, 1.0], late), underestimates(late + [0.0, 4.0, -1.0], late)
    (True, False)
    """
    return _rise(found) < _rise(expected) and float(np.mean(found - expected)) < 0.0


def _rise(values: Floats) -> float:
    """Largest rise over the start [K]."""
    return float((values - values[0]).max())


def verdict(table: pd.DataFrame) -> str:
    """Whether a single temperature underestimates the inner layer (4.4.2, 5.4.2), in a sentence.

    It does where the largest rise of the inner layer and its mean over the run are both lower.
    """
    mine = table[table["model"] == SINGLE]
    missed = mine[~mine[UNDERESTIMATES].to_numpy(dtype=bool)]
    low, high = mine[f"{INNER} rise K"].min(), mine[f"{INNER} rise K"].max()
    text = (
        f"a single temperature underestimates the inner layer in {len(mine) - len(missed)} of "
        f"{len(mine)} runs: error of its largest rise {low:+.1f} to {high:+.1f} K"
    )
    known = [name for name in KEYS if name in mine]
    not_in = [", ".join(str(part) for part in row) for row in missed[known].to_numpy()]
    return f"{text}; not in {'; '.join(not_in)}" if not_in else text


def comparison_figure(results: dict[str, EarthquakeResult]) -> Figure:
    """Inner layer in time, all models over each other (Fig. 4.13, 5.16); the first motion.

    Returns
    -------
    Figure : a row for each bearing, a column for each ambient temperature.
    """
    names = [name for name in results if name != REFERENCE]
    colours = drawing.ordered_colours(len(names), "turbo")
    looks = {REFERENCE: BLACK} | {
        name: {"color": colour, "linewidth": 0.9}
        for name, colour in zip(names, colours, strict=True)
    }

    def draw(ax: Axes, name: str, run: int) -> None:
        values = results[name].places(run)[INNER]
        time = results[name]["time"].values[run][: len(values)]
        kept = drawing.thin(values, TIME_BINS)
        ax.plot(time[kept], values[kept], **looks[name])

    what = "temperature of the inner layer"
    return _panels(results, looks, draw, what, ("time [s]", "temperature [°C]"), True)


def comparison_loops(results: dict[str, EarthquakeResult]) -> Figure:
    """Loops of the multi-layer model and of a single temperature (Fig. 4.11, 5.9, 5.12)."""

    def draw(ax: Axes, name: str, run: int) -> None:
        data = results[name].dataset
        told = np.isfinite(data["time"].values[run])
        strain = 100.0 * data["bearing_strain"].values[run, told]
        ax.plot(strain, data["bearing_force"].values[run, told], **LOOP_LOOKS[name])

    what = "loops of one bearing"
    return _panels(results, LOOP_LOOKS, draw, what, ("shear strain [%]", "force [kN]"), False)


def comparison_strains(results: dict[str, EarthquakeResult]) -> Figure:
    """Strain in time of the multi-layer model and of a single temperature (Fig. 5.10, 5.13)."""

    def draw(ax: Axes, name: str, run: int) -> None:
        strain = 100.0 * results[name]["bearing_strain"].values[run].astype(float)
        kept = drawing.thin(strain[np.isfinite(strain)], TIME_BINS)
        ax.plot(results[name]["time"].values[run][kept], strain[kept], **LOOP_LOOKS[name])

    what = "strain of one bearing"
    return _panels(results, LOOP_LOOKS, draw, what, ("time [s]", "shear strain [%]"), False)


def _panels(
    results: dict[str, EarthquakeResult],
    looks: dict[str, drawing.Look],
    draw: Callable[[Axes, str, int], None],
    what: str,
    labels: tuple[str, str],
    own_limits: bool,
) -> Figure:
    """A row for each bearing, a column for each temperature; `draw` is called for each model."""
    truth = results[REFERENCE]
    table = truth.table
    bearings, ambients = list(dict.fromkeys(table["bearing"])), sorted(set(table["ambient_degC"]))
    first = table[table["motion"] == table["motion"].iloc[0]]
    told = [str(first["motion"].iloc[0])]
    if "mode" in first:
        first = first[first["mode"] == first["mode"].iloc[0]]
        told.append(str(first["mode"].iloc[0]))
    columns = len(ambients)
    size = (max(WIDTH * columns, 6.0) + 0.6, HEIGHT * len(bearings) + 1.1)
    title = f"{truth.dataset.attrs['structure']}: {what}, {', '.join(told)}"
    figure, axes = drawing.panels(len(bearings), columns, size, title, share=not own_limits)
    runs = {name: _runs(results[name]) for name in looks}
    keys = _keys(table)
    for panel, ax in enumerate(axes):
        bearing, ambient = bearings[panel // columns], ambients[panel % columns]
        mine = first[(first["bearing"] == bearing) & (first["ambient_degC"] == ambient)]
        for key in (keys[int(run)] for run in mine.index.to_numpy()):
            for name in looks:
                if key in runs[name]:
                    draw(ax, name, runs[name][key])
        drawing.name_axes(
            ax,
            labels[0] if panel // columns == len(bearings) - 1 else "",
            labels[1] if panel % columns == 0 else "",
            f"{bearing}, {drawing.degrees(ambient)}",
        )
        ax.title.set_fontsize(drawing.SMALL)
    drawing.legend_below(figure, [Line2D([], [], label=k, **look) for k, look in looks.items()])
    return figure
