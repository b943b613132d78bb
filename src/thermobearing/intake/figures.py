"""Figures of inspected files: histories, loops and temperatures, with findings marked."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermobearing.border.errors import printable
from thermobearing.core.records import Floats, Ints
from thermobearing.identify.fit.forward import PAUSE
from thermobearing.intake.run import Intake, Intakes
from thermobearing.results import drawing
from thermobearing.results.time_axis import DrawnAxis, Stretch

BINS = 3000
FEW_TICKS = 14  # of a panel that is half as wide as the page
REST, SPIKE, BLOCK, DRIFT = "#dfe7f5", "#CC3311", "#009988", "#EE7733"
UNITS = {"displacement": "mm", "force": "kN"}


class IntakeFigures(drawing.Figures):
    """A picture of each file."""

    _result: Intakes

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        pairs = zip(self._result.names, self._result.files, strict=True)
        return {name: partial(draw_intake, item) for name, item in pairs}


def draw_intake(found: Intake) -> Figure:
    """Draw histories, loops and temperatures of one file, with findings marked."""
    record, axis = found.record, time_axis(found)
    title = f"{printable(found.file.name)}: {found.rows} rows, {found.blocks} block(s)"
    figure, (way, force, loops, warm) = drawing.panels(2, 2, (drawing.WIDEST, 5.6), title)
    for ax, name in ((way, "displacement"), (force, "force")):
        _draw_history(ax, found, axis, name)
    x, f = record.displacement, record.force
    spans = max(float(np.ptp(x)), 1e-9), max(float(np.ptp(f)), 1e-9)
    kept = drawing.thin_loops(x, f, *spans)
    loops.plot(x[kept], f[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_temperatures(warm, found, axis)
    return figure


def time_axis(found: Intake) -> DrawnAxis:
    """Return a time axis with loadings to scale and rests shortened, logged or not.

    Ends of stretches are samples.
    """
    time, treatment = found.record.time, found.treatment
    gaps = np.flatnonzero(np.diff(time) > PAUSE).tolist()
    rests = sorted({*(treatment.rests if treatment else []), *((k, k + 1) for k in gaps)})
    ends: list[tuple[int, int, bool]] = []
    before = 0
    for first, last in [*rests, (len(time) - 1, len(time) - 1)]:
        if first > before:
            ends.append((before, first, False))
        if last > max(first, before):
            ends.append((max(first, before), last, True))
        before = max(before, last)
    lasting = [(a, b, rest, float(time[b] - time[a])) for a, b, rest in ends]
    return DrawnAxis([Stretch(a, b, rest, span, span) for a, b, rest, span in lasting])


def _places(axis: DrawnAxis, time: Floats) -> Floats:
    """Where each sample is drawn."""
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


def _draw_history(ax: Axes, found: Intake, axis: DrawnAxis, name: str) -> None:
    """Draw one signal: rests shaded, spikes crossed, starts of blocks, the line of its drift."""
    record, treatment, unit = found.record, found.treatment, UNITS[name]
    time, values = _places(axis, record.time), getattr(record, name)
    kept = _kept(axis, values)
    ax.plot(time[kept], values[kept], color=drawing.INK, linewidth=0.7)
    marks = []
    for k in np.flatnonzero(np.diff(record.block)).tolist():
        ax.axvline(time[k + 1], color=BLOCK, linewidth=0.9, linestyle=":")
    if record.block[-1]:
        marks.append("dotted: blocks")
    if treatment is not None:
        for first, last in treatment.rests:
            ax.axvspan(time[first], time[last], color=REST, linewidth=0.0, zorder=0)
        if treatment.rests:
            marks.append(f"shaded: {len(treatment.rests)} rests")
        spikes = treatment.spikes[name]
        if spikes.any():
            ax.plot(time[spikes], values[spikes], "x", color=SPIKE, markersize=5)
            marks.append(f"crosses: {int(spikes.sum())} samples of spikes")
        if name in treatment.drifts:
            drift = treatment.drifts[name]
            middle = float(np.median(drift.middles - drift.slope * drift.times))
            line = middle + drift.slope * record.time[kept]
            ax.plot(time[kept], line, color=DRIFT, linewidth=1.4)
            marks.append(f"line: drift of {drift.total:.3g} {unit}")
    _name_axes(ax, axis, f"{name} [{unit}]", ", ".join(marks) or "nothing out of the way")


def _draw_temperatures(ax: Axes, found: Intake, axis: DrawnAxis) -> None:
    """Thermocouples, and the ambient as one line."""
    record = found.record
    time = _places(axis, record.time)
    colours = drawing.ordered_colours(max(len(record.temperatures), 1), "turbo")
    for (title, values), colour in zip(record.temperatures.items(), colours, strict=False):
        label = f"{title} ({record.places[title]})"
        kept = _kept(axis, values)
        ax.plot(time[kept], values[kept], color=colour, linewidth=0.9, label=label)
    label = f"ambient {drawing.degrees(round(record.ambient, 2))}"
    label += " (assumed)" if found.ambient_is_assumed else ""
    if found.ambient is not None:
        kept = _kept(axis, found.ambient)
        ax.plot(time[kept], found.ambient[kept], color=REST, linewidth=0.5, zorder=0)
    ax.axhline(record.ambient, color=drawing.GREY, linewidth=1.2, linestyle="--", label=label)
    _name_axes(ax, axis, "temperature [degC]", "temperatures")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
