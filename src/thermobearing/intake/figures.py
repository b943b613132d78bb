"""The picture of a file: histories with rests, spikes and drift, loops, temperatures."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermobearing.border.errors import printable
from thermobearing.intake.result import Intake
from thermobearing.results import drawing

Floats = NDArray[np.float64]

BINS = 3000
REST, SPIKE, BLOCK, DRIFT = "#dfe7f5", "#CC3311", "#009988", "#EE7733"
UNITS = {"displacement": "mm", "force": "kN"}


def intake_figure(found: Intake) -> Figure:
    """Histories, loops and temperatures, with what was found marked.

    Parameters
    ----------
    found : from `take_in`.

    Returns
    -------
    Figure
    """
    record = found.record
    title = f"{printable(found.file.name)}: {found.rows} rows, {found.blocks} block(s)"
    figure, (way, force, loops, warm) = drawing.panels(2, 2, (11.0, 7.2), title)
    for ax, name in ((way, "displacement"), (force, "force")):
        _draw_history(ax, found, name)
    x, f = record.displacement, record.force
    spans = max(float(np.ptp(x)), 1e-9), max(float(np.ptp(f)), 1e-9)
    kept = drawing.thin_loops(x, f, *spans)
    loops.plot(x[kept], f[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_temperatures(warm, found)
    return figure


def _draw_history(ax: Axes, found: Intake, name: str) -> None:
    """One signal in time: rests shaded, spikes crossed, begins of blocks, the line of its drift."""
    record, treatment = found.record, found.treatment
    time, values = record.time, getattr(record, name)
    kept = drawing.thin(values, BINS)
    ax.plot(time[kept], values[kept], color=drawing.INK, linewidth=0.7)
    told = []
    for k in np.flatnonzero(np.diff(record.block)).tolist():
        ax.axvline(time[k + 1], color=BLOCK, linewidth=0.9, linestyle=":")
    if record.block[-1]:
        told.append("dotted: blocks")
    if treatment is not None:
        for first, last in treatment.rests:
            ax.axvspan(time[first], time[last], color=REST, linewidth=0.0, zorder=0)
        if treatment.rests:
            told.append(f"shaded: {len(treatment.rests)} rests")
        spikes = treatment.spikes[name]
        if spikes.any():
            ax.plot(time[spikes], values[spikes], "x", color=SPIKE, markersize=5)
            told.append(f"crosses: {int(spikes.sum())} samples of spikes")
        if name in treatment.drifts:
            drift = treatment.drifts[name]
            middle = float(np.median(drift.middles - drift.slope * drift.times))
            ax.plot(time[[0, -1]], middle + drift.slope * time[[0, -1]], color=DRIFT, linewidth=1.4)
            told.append(f"line: drift of {drift.total:.3g} {UNITS[name]}")
    title = ", ".join(told) or "nothing out of the way"
    drawing.name_axes(ax, "time [s]", f"{name} [{UNITS[name]}]", title)


def _draw_temperatures(ax: Axes, found: Intake) -> None:
    """Thermocouples, and the ambient as one line."""
    record = found.record
    colours = drawing.ordered_colours(max(len(record.temperatures), 1), "turbo")
    for (title, values), colour in zip(record.temperatures.items(), colours, strict=False):
        label = f"{title} ({record.places[title]})"
        ax.plot(record.time, values, color=colour, linewidth=0.9, label=label)
    assumed = "ambient" in found.sidecar and "ambient" not in found.kept
    label = f"ambient {drawing.degrees(round(record.ambient, 2))}" + (
        " (assumed)" if assumed else ""
    )
    if found.ambient is not None:
        kept = drawing.thin(found.ambient, BINS)
        ax.plot(record.time[kept], found.ambient[kept], color=REST, linewidth=0.5, zorder=0)
    ax.set_xlim(*(record.time[[0, -1]].tolist()))
    ax.axhline(record.ambient, color=drawing.GREY, linewidth=1.2, linestyle="--", label=label)
    drawing.name_axes(ax, "time [s]", "temperature [degC]", "temperatures")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
