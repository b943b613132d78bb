"""Figures of the document of a cyclic test: the drawn ones, and what a reader can move."""

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from thermobearing.cyclic.figures import Figures, TimeAxis
from thermobearing.cyclic.result import Result
from thermobearing.report.figures import history, path, rounded
from thermobearing.report.pieces import Plot, ReportFigure, Trace
from thermobearing.report.words import degrees
from thermobearing.results import drawing
from thermobearing.results.drawing import Floats
from thermobearing.results.time_axis import duration

LOOP_POINTS = 2400  # of all cycles of a run
WARM_POINTS = 1500  # of a temperature in time
MOMENTS = 24  # places of the slider


def report_figures(result: Result) -> dict[str, ReportFigure]:
    """Every figure that the result holds data for, by name."""
    plot, data = result.plot, result.dataset
    moves = any(about["kind"] != "rest" for about in result.segments)
    layers, cells = "rubber_temperature" in data, "temperature" in data
    cycles = any(about["kind"] == "cycles" for about in result.segments)
    kinds: tuple[tuple[bool, str, str, Callable[[Result], Plot] | None], ...] = (
        (moves, "loops", LOOPS, _loops_plot),
        (len(result.cycles) > 0, "measures", MEASURES, None),
        (True, "displacement", "Imposed displacement; long rests are cut out.", None),
        (layers, "layer_temperatures", LAYERS, _temperature_plot),
        (layers and result.has_lead, "lead_temperature", LEAD, None),
        (cells, "profiles", PROFILES, _profile_plot),
        (cycles and result.has_lead, "force_shares", SHARES, None),
        ("layer_displacement" in data, "layer_shear", SHEAR, None),
        (True, "energy", ENERGY, None),
    )
    return {
        name: ReportFigure(
            caption,
            draw=_drawer(plot, name),
            alt=_alt(result, name) or caption,
            plot=make(result) if make else None,
        )
        for held, name, caption, make in kinds
        if held
    }


LOOPS = (
    "Shear stress (force over the gross plan area) against shear strain (displacement over the "
    "total rubber thickness) at each ambient temperature. Shaded: beyond the tested strain."
)
MEASURES = (
    "Equivalent shear modulus G_e (Eq. 3.1) and damping ratio h_eq (Eq. 3.2) of single cycles "
    "against their strain."
)
LAYERS = "Temperature of the rubber layers during the test; rests are shortened or cut out."
LEAD = "Temperature of the lead beside that of the innermost rubber layer."
PROFILES = "Temperature through the height of the bearing at the end of each loading."
SHARES = "Shares of rubber, lead and rate-dependent branch in the force of single cycles."
SHEAR = "Displacement of each layer at the last peak of each amplitude."
ENERGY = "Where the work goes: heat released, stored and lost, and recoverable energy."


def _drawer(plot: Figures, name: str) -> Callable[[], Figure]:
    draw: Callable[[], Figure] = getattr(plot, name)
    return draw


def _alt(result: Result, name: str) -> str:
    """What somebody who does not see the loops must know."""
    if name != "loops":
        return ""
    told = []
    for run, ambient in enumerate(result["ambient"].values):
        stress, strain = (np.nanmax(np.abs(result[n].values[run])) for n in ("stress", "strain"))
        told.append(f"at {degrees([float(ambient)])} up to {stress:.2f} MPa and {strain:.0%}")
    return f"Hysteresis loops: {'; '.join(told)}.".replace("%", " %")


def _colours(result: Result) -> list[str]:
    return drawing.ambient_colours(np.asarray(result["ambient"].values, dtype=float))


def _loops_plot(result: Result) -> Plot:
    """Loops, one trace a temperature."""
    time, traces, ends = TimeAxis(result), [], []
    for run, (ambient, colour) in enumerate(
        zip(result["ambient"].values, _colours(result), strict=True)
    ):
        pieces = [
            path(100.0 * result["strain"].values[run, rows], result["stress"].values[run, rows], n)
            for rows, n in _shares(time.moving_rows(run))
        ]
        gap = np.array([np.nan])
        xs = [part for x, _ in pieces for part in (x, gap)]
        ys = [part for _, y in pieces for part in (y, gap)]
        x, y = (np.concatenate(parts) if parts else np.empty(0) for parts in (xs, ys))
        traces.append(Trace(degrees([float(ambient)]), x, y, colour))
        ends.append(100.0 * result.tested_to(run, "strain"))
    return Plot(
        "shear strain [%]",
        "shear stress [MPa]",
        {"all": traces},
        bands=untested(min(ends), traces),
    )


def _shares(rows: list[slice]) -> list[tuple[slice, int]]:
    """Rows of each loading with the points that it may have."""
    return [(one, max(LOOP_POINTS // max(len(rows), 1), 200)) for one in rows]


def untested(end: float, traces: list[Trace]) -> list[tuple[float, float, str]]:
    """Bands beyond the tested strain [%], as far as traces go."""
    if not np.isfinite(end):
        return []
    reach = max(float(np.nanmax(np.abs(trace.x))) for trace in traces if len(trace.x))
    if reach <= end:
        return []
    return [(end, 1.05 * reach, "not tested"), (-1.05 * reach, -end, "not tested")]


def _temperature_plot(result: Result) -> Plot:
    """Temperature of the layers and the lead, a menu entry for each ambient temperature.

    Long rests are cut out: loadings last seconds, and would be strokes beside hours of cooling.
    """
    data = result.dataset
    names = drawing.layer_names(data.sizes["layer"], bool(data.attrs["half_stack"]))
    colours = drawing.ordered_colours(len(names), "plasma")
    time = TimeAxis(result, cut=True)
    choices = {}
    for run, ambient in enumerate(result["ambient"].values):
        count = time.rows[run]
        values = result["rubber_temperature"].values[run, :count]
        lines = [(name, values[:, j], colours[j], "line") for j, name in enumerate(names)]
        if result.has_lead:
            lead = result["lead_temperature"].values[run, :count]
            lines.append(("lead", lead, drawing.INK, "dashed"))
        traces = []
        for name, told, colour, look in lines:
            x, y = time.trace(run, told)
            traces.append(Trace(name, *history(x / time.unit, y, WARM_POINTS), colour, look))
        choices[degrees([float(ambient)])] = traces
    cut = ", long rests cut out" if time.shortened else ""
    return Plot(f"time{cut} [{time.unit_name}]", "temperature [°C]", choices)


def _profile_plot(result: Result) -> Plot:
    """Temperature through the height, moved through the test by a slider."""
    depth = result.dataset["depth"].values
    time = TimeAxis(result)
    moments = _moments(time.times[time.farthest])
    traces = []
    for run, (ambient, colour) in enumerate(
        zip(result["ambient"].values, _colours(result), strict=True)
    ):
        values = result["temperature"].values[run, : time.rows[run]]
        at = np.searchsorted(time.times[run], moments).clip(0, len(values) - 1)
        frames = rounded(values[at])
        name = degrees([float(ambient)])
        y = np.tile(-depth, (len(moments), 1))
        traces.append(Trace(name, frames[0], -depth, colour, "line with points", y, frames))
    return Plot(
        "temperature [°C]",
        "level relative to the upper face [mm]",
        {"all": traces},
        slider=[duration(float(moment)) for moment in moments],
        slider_title="time",
    )


def _moments(time: Floats) -> Floats:
    """Moments of a test that are worth a look: as many kept steps between each two."""
    rows = np.linspace(0, len(time) - 1, min(MOMENTS, len(time))).round().astype(int)
    return np.asarray(time[np.unique(rows)])
