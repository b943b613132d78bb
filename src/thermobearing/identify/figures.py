"""Figures of a calibration and of the check of its records."""

import textwrap
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from thermobearing.bearing.model import Bearing
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.cycles import TURN, Loop, loop_middles, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification, RecordFit
from thermobearing.identify.uncertainty.posterior import Band
from thermobearing.results import drawing
from thermobearing.results.metrics import FEWEST_POINTS, CycleMeasures, measure_cycle

TEST, MODEL, REST = "#8a8f98", "#CC3311", "#8a8f98"
BINS = 3000
LABELLED = 14  # parameters whose correlation is printed into the squares
BAND_WIDTH = 4.0  # of a test under the thin line of the model [pt]
PALE_TEST = "#c3c8d0"
SMALL_TURN = 0.1  # of the largest displacement: the force at smaller turns is not shown
MEASURES: dict[str, tuple[str, str, Callable[[CycleMeasures], float]]] = {
    # of a cycle, by name of its error: name of the panel, its unit, the measure in it
    "G_eq_error": ("equivalent shear modulus G_e", "G_e [MPa]", lambda m: m.G_eq_MPa),
    "h_eq_error": ("equivalent damping ratio h_eq", "h_eq", lambda m: m.h_eq),
    "energy_error": ("energy", "energy [kJ = kN m]", lambda m: m.energy_kN_mm / 1000.0),
    "force_max_error": ("peak force", "force [kN]", lambda m: max(m.force_max_kN, -m.force_min_kN)),
}


class Panel(NamedTuple):
    """One record for the figures: the test, the model, and the full cycles of the two."""

    title: str
    record: TestRecord
    prediction: Prediction
    fit: RecordFit
    measures: list[tuple[Loop, CycleMeasures]]  # of cycles with samples enough, in the model


def _panel(fit: RecordFit, prediction: Prediction, bearing: Bearing) -> Panel:
    record, force = fit.record, prediction.force
    size = {"area": bearing.area, "total_rubber_thickness": bearing.total_rubber_thickness}
    measures = []
    for loop in fit.loops:
        if loop.last - loop.first + 1 >= FEWEST_POINTS:
            rows = slice(loop.first, loop.last + 1)
            found = measure_cycle(record.displacement[rows], force[rows], slope=False, **size)
            measures.append((loop, found))
    title = f"{record.name}, {drawing.degrees(record.ambient)}, R² = {fit.R2:.4f}"
    return Panel(title, record, prediction, fit, measures)


def _draw_loops(ax: Axes, panel: Panel, colour: str) -> None:
    """Draw a test as a broad band, and the model as a thin line in it."""
    x, force = panel.record.displacement, panel.record.force
    span = float(np.ptp(x)), float(np.ptp(force))
    broad, thin = (PALE_TEST, BAND_WIDTH, 1.5), (colour, 0.8, 2.0)
    for values, (shown, width, order) in ((force, broad), (panel.prediction.force, thin)):
        kept = drawing.thin_loops(x, values, *span)
        ax.plot(x[kept], values[kept], color=shown, linewidth=width, zorder=order)


def _draw_cycles(ax: Axes, panel: Panel, measure: str, colour: str, marker: str) -> None:
    """Draw one measure of the cycles of a record, each amplitude a line."""
    loops, shown = [loop for loop, _ in panel.measures], MEASURES[measure][2]
    first = [k for k, loop in enumerate(loops) if k and loop.number <= loops[k - 1].number]
    model = np.array([shown(found) for _, found in panel.measures], dtype=float)
    off = np.array([loop.errors[measure] for loop in loops], dtype=float)
    number = np.array([loop.cycle for loop in loops], dtype=float)
    x, test, model = (np.insert(v, first, np.nan) for v in (number, model / (1.0 + off), model))
    ax.plot(x, test, "o-", color=colour, alpha=0.3, linewidth=6.0, markersize=6.0, mew=0.0)
    ax.plot(x, model, marker + "-", color=colour, markersize=3.5, linewidth=1.0)


class IdentificationFigures(drawing.Figures):
    """Figures of a calibration: `found.plot.loops()` and so on, each a matplotlib Figure."""

    vector = True

    def __init__(self, found: Identification) -> None:
        super().__init__(found)
        self._found = found
        self._panels = [
            _panel(fit, prediction, found.bearing)
            for fit, prediction in zip(found.fits, found.predictions, strict=True)
        ]

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        shown = [self.loops, self.residuals, self.convergence, self.correlation, self.cycles]
        if any(panel.record.temperatures for panel in self._panels):
            shown.append(self.temperatures)
        figures: dict[str, Callable[[], Figure]] = {draw.__name__: draw for draw in shown}
        bands = self._found.forecast.bands if self._found.forecast else ()
        return figures | {f"band_{band.ambient:g}": partial(self.band, band) for band in bands}

    def _title(self, what: str) -> str:
        return f"{self._found.bearing.name}: {what}"

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str = MODEL) -> Figure:
        """Draw the loops of each test, the model over them."""
        panels = self._panels
        if ax is not None:
            for panel in panels:
                _draw_loops(ax, panel, color)
            ax.get_lines()[-1].set_label(label or self._found.bearing.name)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]")
            return drawing.parent_figure(ax)
        columns = min(len(panels), 3)
        rows = -(-len(panels) // columns)
        size = (max(5.5, 1.0 + 3.4 * columns), 0.9 + 3.6 * rows)
        figure, axes = drawing.panels(rows, columns, size, self._title("test and model"))
        for place, panel in zip(axes, panels, strict=False):
            _draw_loops(place, panel, MODEL)
            drawing.name_axes(place, "displacement [mm]", "force [kN]", panel.title)
        force = drawing.common_limits(axes[: len(panels)])  # one scale: the cold is the stronger
        widest = 1.06 * max(panel.record.peak_displacement for panel in panels)
        for place in axes[: len(panels)]:
            place.set(xlim=(-widest, widest), ylim=force)
        for place in axes[len(panels) :]:
            place.set_visible(False)
        band = Line2D([], [], color=PALE_TEST, linewidth=BAND_WIDTH, label="test (band)")
        line = Line2D([], [], color=MODEL, linewidth=1.2, label="model")
        drawing.legend_below(figure, [band, line])
        return figure

    def residuals(self) -> Figure:
        """Draw the residual force over samples, and its distribution, for each record."""
        size = (9.5, 0.8 + 2.3 * len(self._panels))
        figure, axes = drawing.panels(len(self._panels), 2, size, self._title("residuals"))
        for k, panel in enumerate(self._panels):
            force = panel.record.force
            off = 100.0 * (panel.prediction.force - force) / panel.record.peak_force
            left, right = axes[2 * k], axes[2 * k + 1]
            kept = drawing.thin(off, BINS)
            left.plot(kept, off[kept], color=drawing.INK, linewidth=0.5)
            left.axhline(0.0, color=MODEL, linewidth=0.8)
            drawing.name_axes(left, "sample", "model - test [% of peak]", panel.title)
            right.hist(off, bins=80, density=True, color=TEST)
            sigma = max(float(off.std()), 1e-12)
            grid = np.linspace(float(off.min()), float(off.max()), 200)
            area = sigma * np.sqrt(2.0 * np.pi)
            normal = np.exp(-0.5 * ((grid - off.mean()) / sigma) ** 2) / area
            right.plot(grid, normal, color=MODEL, linewidth=1.2, label="normal")
            spread = f"standard deviation {sigma:.2g} %"
            drawing.name_axes(right, "model - test [% of peak]", "density", spread)
            right.legend(fontsize=drawing.SMALL, frameon=False)
        return figure

    def convergence(self) -> Figure:
        """Draw the best residual so far against evaluations."""
        figure, (ax,) = drawing.panels(1, 1, (6.5, 3.8), self._title("convergence"))
        count, squares = np.array(self._found.history, dtype=float).T
        error = 100.0 * np.sqrt(squares)
        ax.step(count, error, where="post", color=drawing.INK, linewidth=1.3)
        ax.set_yscale("log")
        decades = np.log10(error.max() / error.min()) if error.min() > 0.0 else 2.0
        ax.yaxis.set_minor_formatter("{x:g}" if decades < 1.0 else "")
        ax.yaxis.set_major_formatter("{x:g}")
        ax.tick_params(which="both", labelsize=drawing.SMALL)
        drawing.name_axes(ax, "evaluations (all records each)", "rms residual [% of peak]")
        return figure

    def correlation(self) -> Figure:
        """Draw the correlation matrix of the free parameters."""
        found = self._found.uncertainty
        names = [item.parameter.kind.symbol for item in found.estimates.values()]
        size = 1.8 + 0.55 * len(names)
        inches = (max(size + 0.8, 4.5), max(size, 3.8))
        figure, (ax,) = drawing.panels(1, 1, inches, self._title("correlation"))
        ax.grid(False)
        image = ax.imshow(found.correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
        ax.set_xticks(range(len(names)), names, fontsize=drawing.NORMAL, rotation=45)
        ax.set_yticks(range(len(names)), names, fontsize=drawing.NORMAL)
        for (i, j), value in np.ndenumerate(found.correlation):
            if len(names) <= LABELLED:
                colour = "white" if abs(value) > 0.6 else drawing.INK
                text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
                ax.text(j, i, text, ha="center", va="center", fontsize=6.5, color=colour)
        figure.colorbar(image, ax=ax, shrink=0.8).ax.tick_params(labelsize=drawing.SMALL)
        return figure

    def cycles(self) -> Figure:
        """Draw the measures of each cycle: the test as a broad band, the model as a line.

        The model's are those of its own force; the test's are as far from them as the table says,
        by a short running mean of both: extremes of noisy samples are too large.
        """
        figure, axes = drawing.panels(2, 2, (10.0, 6.4), self._title("test and model, each cycle"))
        colours = drawing.ordered_colours(len(self._panels), "viridis")
        for ax, (measure, (title, unit, _)) in zip(axes, MEASURES.items(), strict=True):
            for k, (panel, colour) in enumerate(zip(self._panels, colours, strict=True)):
                _draw_cycles(ax, panel, measure, colour, drawing.MARKERS[k % 8])
            ax.set_ylim(0.0, 1.06 * ax.get_ylim()[1])
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
            loops = [loop for panel in self._panels for loop in panel.fit.loops]
            errors = [100.0 * loop.errors[measure] for loop in loops]
            if errors:  # not without a full cycle
                words = f"model off by {min(errors):+.1f} to {max(errors):+.1f} %"
                title += ": " + words.replace("-", "\N{MINUS SIGN}")
            drawing.name_axes(ax, "cycle", unit, title)
        handles = [
            Line2D([], [], color=colour, marker=drawing.MARKERS[k % 8], label=panel.title)
            for k, (panel, colour) in enumerate(zip(self._panels, colours, strict=True))
        ]
        broad = Line2D([], [], color=PALE_TEST, linewidth=6.0, label="test (band)")
        thin = Line2D([], [], color=drawing.INK, linewidth=1.0, label="model (line)")
        drawing.legend_below(figure, [broad, thin, *handles])
        return figure

    def temperatures(self) -> Figure:
        """Draw the thermocouples of the tests in time, the model at their places dashed."""
        panels = [panel for panel in self._panels if panel.record.temperatures]
        size = (9.0, 0.9 + 3.0 * max(len(panels), 1))
        title = self._title("thermocouples (full: test, dashed: model)")
        figure, axes = drawing.panels(max(len(panels), 1), 1, size, title)
        for ax, (name, record, prediction, *_) in zip(axes, panels, strict=False):
            colours = drawing.ordered_colours(len(record.temperatures), "turbo")
            for (place, test), colour in zip(record.temperatures.items(), colours, strict=True):
                label, model = f"{place} ({record.places[place]})", prediction.temperatures[place]
                ax.plot(record.time, test, color=colour, linewidth=1.4, label=label)
                ax.plot(record.time, model, color=colour, linewidth=1.0, linestyle="--")
            ax.legend(fontsize=drawing.SMALL, frameon=False)
            drawing.name_axes(ax, "time [s]", "temperature [degC]", name)
        return figure

    def band(self, band: Band) -> Figure:
        """Draw the loops at a temperature within their 95 % band, and the force at each turn."""
        words = " (not tested)" if band.beyond_tested else ""
        title = self._title(f"predicted at {drawing.degrees(band.ambient)}{words}")
        figure, (loops, peaks) = drawing.panels(1, 2, (10.0, 4.4), title)
        x, force = band.displacement, band.best
        most = float(np.abs(x).max())
        turns = turning_points(x, TURN * most)
        for first, last in pairwise(turns):  # each leg separately
            leg = slice(first, last + 1)
            kept = first + drawing.thin_loops(x[leg], force[leg], 2.0 * most, 2.0 * band.peak)
            low, high = band.lower[kept], band.upper[kept]
            loops.fill_between(x[kept], low, high, color=PALE_TEST, linewidth=0.0)
        kept = drawing.thin_loops(x, force, 2.0 * most, 2.0 * band.peak)
        loops.plot(x[kept], force[kept], color=MODEL, linewidth=0.7)
        text = f"peak {band.peak:.4g} kN, 95 % {band.peak_lower:.4g} to {band.peak_upper:.4g} kN"
        drawing.name_axes(loops, "displacement [mm]", "force [kN]", text)
        shown = turns[np.abs(x[turns]) > SMALL_TURN * most]
        number, side = np.arange(1, len(shown) + 1), np.sign(x[shown])
        ends = side * band.lower[shown], side * band.upper[shown]
        peaks.vlines(number, *ends, color=PALE_TEST, linewidth=BAND_WIDTH)
        peaks.plot(number, side * force[shown], "o", color=MODEL, markersize=3.5)
        peaks.set_ylim(bottom=min(0.0, *peaks.get_ylim()))
        drawing.name_axes(peaks, "turn of the motion", "force on the side of the turn [kN]")
        drawing.name_axes(peaks, title="force at each turn")
        band95 = Line2D([], [], color=PALE_TEST, linewidth=6.0, label="95 %, parameters alone")
        best = Line2D([], [], color=MODEL, marker="o", markersize=3.5, label="best fit")
        drawing.legend_below(figure, [band95, best])
        return figure


def check_figure(report: CheckReport) -> Figure:
    """Draw a record: histories over samples, loops, middles of the loops, findings."""
    record = report.record
    title = f"{record.name}: {report.outcome}"
    figure, (top, middle, loops, centre) = drawing.panels(2, 2, (10.0, 6.8), title)
    _draw_histories(report, top, middle)
    x, force = record.displacement, record.force
    width, height = (max(float(np.ptp(values)), 1e-9) for values in (x, force))
    kept = drawing.thin_loops(x, force, width, height)
    loops.plot(x[kept], force[kept], color=drawing.INK, linewidth=0.6)
    drawing.name_axes(loops, "displacement [mm]", "force [kN]", "loops as recorded")
    _draw_middles(report, centre)
    if report.findings:
        sentences = [f"{finding.level}: {finding.sentence}" for finding in report.findings]
        shown = "\n".join(textwrap.fill(f"- {text}", 150) for text in sentences)
        figure.supxlabel(shown, fontsize=drawing.SMALL, x=0.02, ha="left")
    return figure


def _draw_histories(report: CheckReport, top: Axes, middle: Axes) -> None:
    record = report.record
    number, found = np.arange(len(record.time)), report.treatment
    starts = [cycle.first for cycle in report.cycles]
    for ax, name, unit in ((top, "displacement", "mm"), (middle, "force", "kN")):
        values = getattr(record, name)
        kept = drawing.thin(values, BINS)
        ax.plot(number[kept], values[kept], color=drawing.INK, linewidth=0.7)
        ax.plot(starts, np.zeros(len(starts)), "|", color=MODEL, markersize=7)
        drawing.name_axes(ax, "sample", f"{name} [{unit}]")
        if found is not None:
            for first, last in found.rests:
                ax.axvspan(first, last, color=REST, alpha=0.25, linewidth=0.0)
            bad = found.spikes[name]
            ax.plot(number[bad], values[bad], "o", color=MODEL, markersize=4)
    clipped, words = report.clipped, "bars: begin of each cycle found"
    middle.plot(number[clipped], record.force[clipped], "x", color=MODEL, markersize=4)
    words += "; grey: rests" if found and found.rests else ""
    words += "; dots: spikes" if found and any(map(np.any, found.spikes.values())) else ""
    top.set_title(words, fontsize=drawing.NORMAL, loc="left")


def _draw_middles(report: CheckReport, ax: Axes) -> None:
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
            away = drift.begin + drift.slope * (begins - drift.times[0])
            number, label = np.arange(1, len(away) + 1), f"drift of {name}"
            ax.plot(number, 100.0 * away / peak, "--", color=colour, linewidth=1.0, label=label)
    ax.axhline(0.0, color=drawing.GREY, linewidth=0.8)
    drawing.name_axes(ax, "cycle", "middle of loop [% of peak]", "drift and offset")
    ax.legend(fontsize=drawing.SMALL, frameon=False)
