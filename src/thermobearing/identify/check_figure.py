"""What an engineer looks at before a fit: a record as it was found, and what is odd in it."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermobearing.identify.checks import CheckReport
from thermobearing.results import drawing

BINS = 3000
REST, FOUND = "#8a8f98", "#CC3311"


def check_figure(report: CheckReport) -> Figure:
    """A record at a glance: histories over samples, loops, middles of the loops, findings.

    Parameters
    ----------
    report : from `check_test`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> import thermobearing as tb
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> report = tb.identify.check_test(tb.identify.record_from_arrays(t, 0.0 * t, np.sin(t), 23.0))
    >>> len(check_figure(report).axes)
    4
    """
    record = report.record
    title = f"{record.name}: {report.outcome}"
    figure, (top, middle, loops, centre) = drawing.panels(2, 2, (10.0, 6.8), title)
    _draw_histories(report, top, middle)
    x, force = record.displacement, record.force
    spans = max(float(np.ptp(x)), 1e-9), max(float(np.ptp(force)), 1e-9)
    kept = drawing.thin_loops(x, force, *spans)
    loops.plot(x[kept], force[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_middles(report, centre)
    if report.findings:
        sentences = [f"{finding.level}: {finding.sentence}" for finding in report.findings]
        shown = "\n".join(textwrap.fill(f"- {text}", 150) for text in sentences)
        figure.supxlabel(shown, fontsize=drawing.SMALL, x=0.02, ha="left")
    return figure


def _draw_histories(report: CheckReport, top: Axes, middle: Axes) -> None:
    """Displacement and force over samples, cycles, rests, spikes, clipped samples."""
    record = report.record
    number = np.arange(len(record.time))
    starts = [cycle.first for cycle in report.cycles]
    for ax, values, name in (
        (top, record.displacement, "displacement [mm]"),
        (middle, record.force, "force [kN]"),
    ):
        kept = drawing.thin(values, BINS)
        ax.plot(number[kept], values[kept], color=drawing.INK, linewidth=0.7)
        ax.plot(starts, np.zeros(len(starts)), "|", color=FOUND, markersize=7)
        drawing.name_axes(ax, "sample", name)
    told = "bars: begin of each cycle found"
    clipped = report.clipped
    middle.plot(number[clipped], record.force[clipped], "x", color=FOUND, markersize=4)
    found = report.treatment
    if found is not None:
        for ax, name in ((top, "displacement"), (middle, "force")):
            for first, last in found.rests:
                ax.axvspan(first, last, color=REST, alpha=0.25, linewidth=0.0)
            bad = found.spikes[name]
            ax.plot(number[bad], getattr(record, name)[bad], "o", color=FOUND, markersize=4)
        told += "; grey: rests" if found.rests else ""
        told += "; dots: spikes" if any(bad.any() for bad in found.spikes.values()) else ""
    top.set_title(told, fontsize=drawing.NORMAL, loc="left")


def _draw_middles(report: CheckReport, ax: Axes) -> None:
    """Middle of each loop, for drift and offset."""
    full = [cycle for cycle in report.cycles if not cycle.closing]
    record = report.steady
    for name, colour in (("displacement", "#0077BB"), ("force", "#EE7733")):
        values = getattr(record, name)
        peak = max(float(np.abs(values).max()), 1e-12)
        loops = [values[cycle.first : cycle.last + 1] for cycle in full]
        mids = [50.0 * (loop.max() + loop.min()) / peak for loop in loops]
        ax.plot(np.arange(1, len(mids) + 1), mids, "o-", color=colour, markersize=3, label=name)
        drift = report.treatment.drifts.get(name) if report.treatment else None
        if drift is not None:
            begins = record.time[[cycle.first for cycle in full]]
            away = drift.begin + drift.slope * (begins - drift.times[0])
            number, label = np.arange(1, len(away) + 1), f"drift of {name}"
            ax.plot(number, 100.0 * away / peak, "--", color=colour, linewidth=1.0, label=label)
    ax.axhline(0.0, color=drawing.GREY, linewidth=0.8)
    drawing.name_axes(ax, "cycle", "middle of loop [% of peak]", "drift and offset")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
