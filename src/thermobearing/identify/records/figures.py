"""Figure of a test record with the findings of its checks."""

import math
import textwrap
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermobearing.border.errors import printable
from thermobearing.core.records import Floats, Ints
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.cycles import loop_middles
from thermobearing.identify.records.record import PAUSE
from thermobearing.identify.records.treatment import UNITS
from thermobearing.results import drawing
from thermobearing.results.time_axis import DrawnAxis, Stretch

BINS = 3000
FEW_TICKS = 14  # of a panel that is half as wide as the page
LETTERS, LINE = 110, 0.14  # of a line of the findings: most letters, its height [inch]
REST, MARK, BLOCK, DRIFT = "#dfe7f5", "#CC3311", "#009988", "#EE7733"
CHAMBER = "#8fa8cf"


class RecordFigures(drawing.Figures):
    """A figure of each of several tests."""

    _result: dict[str, Callable[[], Figure]]

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return self._result


def draw_record(
    report: CheckReport, ambient: Floats | None = None, *, assumed: bool = False
) -> Figure:
    """Draw histories, loops, middles of the loops and temperatures, with the findings.

    `ambient` are samples of the ambient temperature [degC]; with `assumed` that of the record is
    marked as an assumption.
    """
    record, axis = report.record, _time_axis(report)
    has_temperatures = bool(record.temperatures) or ambient is not None
    title = f"{printable(record.name)}: {report.outcome}, {len(record.time)} samples, "
    temperature = f"{drawing.degrees(record.ambient)}{' (assumed)' if assumed else ''}"
    title += f"ambient {'not known' if record.unclear else temperature}"
    sentences = [f"- {finding.level}: {finding.sentence}" for finding in report.findings]
    room = drawing.fitting(LETTERS)
    findings = "\n".join(textwrap.fill(printable(text), room) for text in sentences)
    size = (drawing.WIDEST, (7.6 if has_temperatures else 5.0) + LINE * (findings.count("\n") + 1))
    figure, axes = drawing.panels(
        3 if has_temperatures else 2, 2, size, title, least=drawing.NARROW
    )
    _draw_history(axes[0], report, axis, "displacement")
    _draw_history(axes[1], report, axis, "force")
    x, force, loops = record.displacement, record.force, axes[2]
    width, height = (max(float(np.ptp(values)), 1e-9) for values in (x, force))
    samples = drawing.thin_loops(x, force, width, height)
    loops.plot(x[samples], force[samples], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_middles(axes[3], report)
    if has_temperatures:
        _draw_temperatures(axes[4], report, axis, ambient)
        axes[5].set_visible(False)
    figure.supxlabel(findings, fontsize=drawing.SMALL, x=0.02, ha="left")
    return figure


def _time_axis(report: CheckReport) -> DrawnAxis:
    """Return a time axis with loadings to scale and rests shortened, logged or not."""
    time, treatment = report.record.time, report.treatment
    gaps = np.flatnonzero(np.diff(time) > PAUSE).tolist()
    rests = sorted({*(treatment.rests if treatment else []), *((k, k + 1) for k in gaps)})
    ends: list[tuple[int, int, bool]] = []
    drawn_to = 0
    for first, last in [*rests, (len(time) - 1, len(time) - 1)]:
        if first > drawn_to:
            ends.append((drawn_to, first, False))
        if last > max(first, drawn_to):
            ends.append((max(first, drawn_to), last, True))
        drawn_to = max(drawn_to, last)
    lasting = [(a, b, resting, float(time[b] - time[a])) for a, b, resting in ends]
    return DrawnAxis([Stretch(a, b, resting, span, span) for a, b, resting, span in lasting])


def _places(axis: DrawnAxis, time: Floats) -> Floats:
    """Return where each sample is drawn."""
    x = np.empty(len(time))
    for s in axis.stretches:
        rows = slice(s.first, s.last + 1)
        x[rows] = s.place(time[rows] - time[s.first])
    return x


def _kept(axis: DrawnAxis, values: Floats) -> Ints:
    """Return samples to draw, in proportion to the length of each stretch on the axis."""
    parts = []
    for s in axis.stretches:
        bins = math.ceil(BINS * s.width / axis.end)
        parts.append(s.first + drawing.thin(values[s.first : s.last + 1], bins))
    return np.concatenate(parts)


def _name_axes(ax: Axes, axis: DrawnAxis, label: str, title: str) -> None:
    axis.set_ticks(ax, in_rests=False, most=FEW_TICKS)
    ax.set_xlabel(axis.caption().replace("; ", ";\n"), fontsize=drawing.NORMAL)
    drawing.name_axes(ax, "", label, title)


def _draw_history(ax: Axes, report: CheckReport, axis: DrawnAxis, name: str) -> None:
    """Draw a signal: rests, spikes, clipped samples, beginnings of blocks and cycles, its drift."""
    record, treatment, unit = report.record, report.treatment, UNITS[name]
    time, values = _places(axis, record.time), getattr(record, name)
    samples = _kept(axis, values)
    ax.plot(time[samples], values[samples], color=drawing.INK, linewidth=0.7)
    starts = [cycle.first for cycle in report.cycles]
    ax.plot(time[starts], np.zeros(len(starts)), "|", color=MARK, markersize=7)
    marks = ["bars: cycles"] if starts else []
    for k in np.flatnonzero(np.diff(record.block)).tolist():
        ax.axvline(time[k + 1], color=BLOCK, linewidth=0.9, linestyle=":")
    if record.block[-1]:
        marks.append("dotted: blocks")
    if name == "force" and report.clipped.any():
        ax.plot(time[report.clipped], values[report.clipped], "+", color=MARK, markersize=4)
        marks.append("pluses: clipped")
    if treatment is not None:
        for first, last in treatment.rests:
            ax.axvspan(time[first], time[last], color=REST, linewidth=0.0, zorder=0)
        if treatment.rests:
            marks.append("shaded: rests")
        spikes = treatment.spikes[name]
        if spikes.any():
            ax.plot(time[spikes], values[spikes], "x", color=MARK, markersize=5)
            marks.append("crosses: spikes")
        if name in treatment.drifts:
            drift = treatment.drifts[name]
            # The line goes through the middles of the loops, not through zero.
            middle = float(np.median(drift.middles - drift.slope * drift.times))
            line = middle + drift.slope * record.time[samples]
            ax.plot(time[samples], line, color=DRIFT, linewidth=1.4)
            marks.append(f"line: drift of {drift.total:.3g} {unit}")
    _name_axes(ax, axis, f"{name} [{unit}]", ", ".join(marks) or "no findings")


def _draw_temperatures(
    ax: Axes, report: CheckReport, axis: DrawnAxis, ambient: Floats | None
) -> None:
    """Draw the thermocouples, and the ambient temperature as one line."""
    record = report.record
    time = _places(axis, record.time)
    colours = drawing.ordered_colours(max(len(record.temperatures), 1), "turbo")
    for (title, values), colour in zip(record.temperatures.items(), colours, strict=False):
        samples, label = _kept(axis, values), f"{title} ({record.places[title]})"
        ax.plot(time[samples], values[samples], color=colour, linewidth=0.9, label=label)
    if ambient is not None:
        samples = _kept(axis, ambient)
        ax.plot(
            time[samples], ambient[samples], color=CHAMBER, linewidth=0.9, zorder=0, label="chamber"
        )
    if not record.unclear:
        ax.axhline(
            record.ambient, color=drawing.GREY, linewidth=1.2, linestyle="--", label="ambient"
        )
    _name_axes(ax, axis, "temperature [degC]", "temperatures")
    ax.legend(fontsize=drawing.SMALL, frameon=False)


def _draw_middles(ax: Axes, report: CheckReport) -> None:
    """Draw the middle of each loop, and the lines of a drift."""
    full = [cycle for cycle in report.cycles if not cycle.closing]
    record = report.steady
    for name, colour in (("displacement", "#0077BB"), ("force", "#EE7733")):
        values = getattr(record, name)
        peak = max(float(np.abs(values).max()), 1e-12)
        mids = 100.0 * loop_middles(values, full) / peak
        ax.plot(np.arange(1, len(mids) + 1), mids, "o-", color=colour, markersize=3, label=name)
        drift = report.treatment.drifts.get(name) if report.treatment else None
        if drift is not None:
            begins = record.time[[cycle.first for cycle in full]]
            drifted = drift.begin + drift.slope * (begins - drift.times[0])
            number, label = np.arange(1, len(drifted) + 1), f"drift of {name}"
            ax.plot(number, 100.0 * drifted / peak, "--", color=colour, linewidth=1.0, label=label)
    ax.axhline(0.0, color=drawing.GREY, linewidth=0.8)
    drawing.name_axes(ax, "cycle", "middle of loop [% of peak]", "drift and offset")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
