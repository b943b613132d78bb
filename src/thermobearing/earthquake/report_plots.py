"""Figures of the document of an earthquake study: the drawn ones, and what a reader can move."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from thermobearing.earthquake.part_histories import told_of
from thermobearing.earthquake.parts import has_parts, told_of_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.report.pieces import Plot, ReportFigure, Trace
from thermobearing.report.traces import POINTS, history, path, rounded
from thermobearing.report.words import degrees, plain
from thermobearing.results import drawing
from thermobearing.results.drawing import Floats

ALL_POINTS = 40_000  # of the traces of one plot together
MOST_CHOICES = 40  # entries of a menu
MOMENTS = 24  # places of a slider
UNTESTED = "#aa3333"
CAPTIONS = {
    "loops": "Force of one bearing against its shear strain. Shaded: beyond the tested strain.",
    "strain": "Shear strain of one bearing in the strong part of each motion; dots are peaks.",
    "energy": "Energy that one bearing takes.",
    "pier": "Displacement of the pier top relative to its base in the strong part of each motion.",
    "pier_acceleration": "Absolute acceleration of the pier top.",
    "deck": "Absolute acceleration of the deck.",
    "peaks": "Peaks of every run against the ambient temperature.",
    "parts": "Every bearing line and every pier beside each other.",
    "largest_loops": "The largest loop of each run, bearings over each other.",
    "modes": "Real time over pseudo-dynamic: loops of the specimen.",
    "hinge": "Moment against rotation of the pier base; dashed: where it yields.",
    "temperature": "Rise of the rubber layers and of the lead over the start.",
    "profiles": "Temperature through the height of the bearings.",
    "shares": "Shares of rubber, lead and rate branch in the force of the largest loop.",
    "speed": "Loading speed of the specimen on its own clock.",
}
OF_ALL = ("peaks", "parts", "deck")  # figures of the whole structure
ORDER = ("peaks", "loops", "strain", "pier", "hinge", "deck", "pier_acceleration", "temperature")


def figures_of(result: EarthquakeResult) -> dict[str, ReportFigure]:
    """Every figure that the study holds data for, by name."""
    held = result.plot.held() if result.runs else {}
    plots = plots_of(result)
    names = [name for name in ORDER if name in held] + [n for n in held if n not in ORDER]
    shown = told_of_parts(result.dataset)
    about = {n: CAPTIONS[n] for n in names}
    about |= {n: f"{about[n]} Shown: {shown}." for n in names if shown and n not in OF_ALL}
    return {
        name: ReportFigure(
            about[name],
            draw=held[name],
            alt=about[name] + _largest(result, name),
            plot=plots.get(name),
        )
        for name in names
    }


def _largest(result: EarthquakeResult, name: str) -> str:
    """Return the largest value that a figure shows, and its run, for those who do not see it."""
    column = {
        "loops": ("bearing_strain_max", "largest shear strain {:.0%}"),
        "strain": ("bearing_strain_max", "largest shear strain {:.0%}"),
        "pier": ("pier_displacement_max_mm", "largest {:.1f} mm"),
        "hinge": ("pier_ductility", "largest ductility {:.2f}"),
        "deck": ("deck_acceleration_max_m_s2", "largest {:.2f} m/s²"),
        "pier_acceleration": ("pier_top_acceleration_max_m_s2", "largest {:.2f} m/s²"),
    }.get(name)
    if column is None:
        return ""
    view = result.dataset
    for part in ("line", "pier") if has_parts(view) else ():
        view = told_of(view, part, None)
    values = EarthquakeResult(view).table[column[0]]
    if not values.notna().any():
        return ""
    run = result.run_names[int(np.nanargmax(values.to_numpy(dtype=float)))]
    told = column[1].format(values.max()).replace("%", " %")
    return f" {told[:1].upper()}{told[1:]} ({plain(run)})."


def plots_of(result: EarthquakeResult) -> dict[str, Plot]:
    """Plots by the name of the figure that they stand beside."""
    runs = [run for run in range(result.runs)][: MOST_CHOICES * 10]
    if not runs:
        return {}
    force, strain = "force of one bearing [kN]", "shear strain [%]"
    found = {
        "loops": _plane(result, "bearing_strain", "bearing_force", 100.0, (strain, force)),
        "strain": _histories(result, "bearing_strain", 100.0, strain),
        "pier": _histories(result, "pier_displacement", 1.0, "pier top, of its base [mm]"),
        "deck": _histories(result, "deck_acceleration", 1.0, "acceleration of the deck [m/s²]"),
        "hinge": _plane(
            result, "pier_rotation", "pier_moment", 1e3, ("rotation [mrad]", "moment [kN m]")
        ),
        "temperature": _temperatures(result),
        "profiles": _profiles(result),
    }
    return {name: plot for name, plot in found.items() if plot is not None}


def _groups(result: EarthquakeResult) -> dict[str, list[int]]:
    """Runs of each menu entry: a bearing and a motion, at all temperatures."""
    table = result.table
    several = table["bearing"].nunique() > 1
    groups: dict[str, list[int]] = {}
    for run, row in enumerate(table.to_dict("records")):
        name = f"{row['bearing']}, {row['motion']}" if several else str(row["motion"])
        if name in groups or len(groups) < MOST_CHOICES:
            groups.setdefault(name, []).append(run)
    return groups


def _colours(result: EarthquakeResult) -> dict[float, str]:
    ambients = sorted(set(result.table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    return dict(zip(ambients, colours, strict=True))


def _label(result: EarthquakeResult, run: int) -> str:
    """Temperature of a run, and its mode where there are several."""
    air = degrees([float(result["ambient"].values[run])])
    mode = result.modes[run] if len(set(result.modes)) > 1 else ""
    return f"{air}, {mode}" if mode else air


def _values(result: EarthquakeResult, name: str, run: int) -> Floats:
    told = np.isfinite(result["time"].values[run])
    return np.asarray(result[name].values[run][told], dtype=float)


def _points(result: EarthquakeResult) -> int:
    return int(np.clip(ALL_POINTS // max(result.runs, 1), 120, POINTS))


def _choices(
    result: EarthquakeResult, make: Callable[[int], tuple[Floats, Floats] | None]
) -> dict[str, list[Trace]]:
    """Traces of every run that has any, by menu entry."""
    colours = _colours(result)
    found: dict[str, list[Trace]] = {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            made = make(run)
            if made is not None:
                slow = result.modes[run] == "pd" and len(set(result.modes)) > 1
                colour = colours[float(result["ambient"].values[run])]
                look = "dashed" if slow else "line"
                traces.append(Trace(_label(result, run), *made, colour, look))
        if traces:
            found[name] = traces
    return found


def _plane(
    result: EarthquakeResult, x: str, y: str, factor: float, titles: tuple[str, str]
) -> Plot | None:
    """Paths in the plane of two histories."""
    points = _points(result)

    def make(run: int) -> tuple[Floats, Floats] | None:
        a, b = factor * _values(result, x, run), _values(result, y, run)
        known = len(a) and np.isfinite(a).all() and np.isfinite(b).all()
        return path(a, b, points) if known else None

    choices = _choices(result, make)
    if not choices:
        return None
    if x == "bearing_strain":
        _add_tested(result, choices, along="x")
    return Plot(*titles, choices)


def _add_tested(
    result: EarthquakeResult, choices: dict[str, list[Trace]], along: Literal["x", "y"]
) -> None:
    """Dashed lines at the largest tested strain in the panels that go beyond it.

    Bearings are tested to different strains, so that one band for all entries would be wrong.
    """
    for name, runs in _groups(result).items():
        end = 100.0 * result.tested_to(runs, "strain")
        if name not in choices or not np.isfinite(end):
            continue
        across = [trace.y if along == "x" else trace.x for trace in choices[name]]
        low, high = (float(f([f(v) for v in across])) for f in (np.nanmin, np.nanmax))
        gap, span = np.nan, (low, high)
        at, other = np.array([end, end, gap, -end, -end]), np.array([*span, gap, *span])
        points = (at, other) if along == "x" else (other, at)
        choices[name].append(Trace(f"tested to {end:g} %", *points, UNTESTED, "dashed"))


def _histories(result: EarthquakeResult, name: str, factor: float, title: str) -> Plot | None:
    """A history of every run."""
    points = _points(result)

    def make(run: int) -> tuple[Floats, Floats] | None:
        time, values = _values(result, "time", run), factor * _values(result, name, run)
        known = len(values) and np.isfinite(values).all()
        return history(time, values, points) if known else None

    choices = _choices(result, make)
    if name == "bearing_strain":
        _add_tested(result, choices, along="y")
    return Plot("time [s]", title, choices) if choices else None


def _temperatures(result: EarthquakeResult) -> Plot | None:
    """Innermost rubber layer (full) and lead (dashed) of every run."""
    points, colours, choices = _points(result) // 2, _colours(result), {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            places, time = result.places(run), _values(result, "time", run)
            colour = colours[float(result["ambient"].values[run])]
            for place, look in (("inner layer", "line"), ("lead", "dashed")):
                values = places[place]
                if len(values) and np.isfinite(values).all():
                    what = "rubber" if place == "inner layer" else place
                    label = f"{what}, {_label(result, run)}"
                    traces.append(Trace(label, *history(time, values, points), colour, look))
        if traces:
            choices[name] = traces
    return Plot("time [s]", "temperature [°C]", choices) if choices else None


def _profiles(result: EarthquakeResult) -> Plot | None:
    """Temperature through the height, moved through the motion by a slider."""
    data = result.dataset
    if "temperature" not in data:
        return None
    longest = float(np.nanmax(data["time"].values))
    moments = np.linspace(0.0, longest, MOMENTS)
    colours, choices = _colours(result), {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            depth = data["depth"].values[run]
            own = np.isfinite(depth)
            if not own.any():
                continue
            time = _values(result, "time", run)
            at = np.searchsorted(time, moments).clip(0, len(time) - 1)
            frames = rounded(data["temperature"].values[run][at][:, own])
            level = -rounded(depth[own])
            y = np.tile(level, (len(moments), 1))
            colour = colours[float(data["ambient"].values[run])]
            label = _label(result, run)
            traces.append(Trace(label, frames[0], level, colour, "line with points", y, frames))
        if traces:
            choices[name] = traces
    if not choices:
        return None
    return Plot(
        "temperature [°C]",
        "level relative to the upper face [mm]",
        choices,
        slider=[f"{moment:.1f} s" for moment in moments],
        slider_title="time",
    )
