"""Figures of a calibration, and of any tests compared with models."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from thermobearing.core.records import Floats
from thermobearing.identify.comparison import Comparison
from thermobearing.identify.records.cycles import TURN, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.bands import OUTSIDE, Band
from thermobearing.quantities.governing import place_of_largest
from thermobearing.results import drawing
from thermobearing.results.metrics import (
    FEWEST_POINTS,
    CycleMeasures,
    cut_at_zeros,
    measure_cycle,
)

TEST, MODEL = "#8a8f98", "#CC3311"
BINS = 3000
LABELLED = 2.0  # parameters in an inch whose correlation is printed into the squares
BAND_WIDTH = 4.0  # of a test under the thin lines of models [pt]
PALE_TEST = "#c3c8d0"
PALENESS = 0.6  # part of white in the colour of a test, where the model has the colour itself
DASHES = ("--", ":", "-.")  # of the temperatures of models
SMALL_TURN = 0.1  # of the largest displacement: the force at smaller turns is not shown
MEASURES: dict[str, tuple[str, str, Callable[[CycleMeasures], float]]] = {
    # of a cycle, by name of its error: title of the panel, label of its axis, the measure
    "G_eq_error": ("equivalent shear modulus G_e", "G_e [MPa]", lambda m: m.G_eq_MPa),
    "h_eq_error": ("equivalent damping ratio h_eq", "h_eq", lambda m: m.h_eq),
    "energy_error": ("energy", "energy [kJ = kN m]", lambda m: m.energy_kN_mm / 1000.0),
    "force_max_error": ("peak force", "force [kN]", lambda m: max(m.force_max_kN, -m.force_min_kN)),
}


def _paler(colour: str) -> tuple[float, ...]:
    """Return a colour mixed with white, for the band of a test under the line of a model."""
    return tuple(PALENESS + (1.0 - PALENESS) * part for part in to_rgb(colour))


def _last_of_leg(x: Floats, force: Floats, turn: int, jitter: float) -> int:
    """Return the sample with the largest force of a leg, at the turn in which it ends.

    A turn is between two samples, and the one with the largest displacement [mm] may be after it,
    where the force [kN] has dropped: the loop is steep there. The leg ends at that sample or at a
    neighbour, or where the motion moves by less than `jitter` [mm] about the turn.
    """
    near = np.abs(x - x[turn]) <= jitter
    near[max(turn - 1, 0) : turn + 2] = True
    away = np.flatnonzero(~near)
    first = int(away[away < turn].max(initial=-1)) + 1
    end = int(away[away > turn].min(initial=len(x)))
    return first + place_of_largest(np.sign(x[turn]) * force[first:end])


class ComparisonFigures(drawing.Figures):
    """Figures of tests and of one or several models: loops, residuals, temperatures."""

    vector = True

    def __init__(self, result: Any, comparisons: Sequence[Comparison], subject: str) -> None:
        super().__init__(result)
        self._subject = subject
        self._completed = [item for item in comparisons if item.prediction is not None]
        self._names = list(dict.fromkeys(self._model_name(item) for item in self._completed))
        colours = drawing.ordered_colours(len(self._names), "turbo")
        self._colours = dict(zip(self._names, colours, strict=True))
        if len(self._names) == 1:
            self._colours = {self._names[0]: MODEL}
        self._records = list(
            {id(comparison.record): comparison.record for comparison in comparisons}.values()
        )

    def _title(self, content: str) -> str:
        return f"{self._subject}: {content}"

    @staticmethod
    def _model_name(comparison: Comparison) -> str:
        return f"{comparison.bearing}, {comparison.model}"

    @staticmethod
    def _test_name(record: TestRecord) -> str:
        return f"{record.name}, {drawing.degrees(record.ambient)}"

    def _comparisons(self, record: TestRecord) -> list[tuple[Comparison, str]]:
        """Return the comparisons of a test with models that completed it, and their colours."""
        return [
            (comparison, self._colours[self._model_name(comparison)])
            for comparison in self._completed
            if comparison.record is record
        ]

    def _legend(self, figure: Figure, *handles: Line2D) -> None:
        pairs = self._colours.items()
        models = [Line2D([], [], color=c, linewidth=1.5, label=name) for name, c in pairs]
        drawing.legend_below(figure, [*handles, *models])

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        figures = [self.loops, self.residuals]
        if any(record.temperatures for record in self._records):
            figures.append(self.temperatures)
        return {draw.__name__: draw for draw in figures}

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str = MODEL) -> Figure:
        """Draw the loops of each test as a broad band, those of the models as lines over it."""
        if ax is not None:
            for record in self._records:
                self._draw_loops(ax, record, color)
            ax.get_lines()[-1].set_label(label or self._subject)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]")
            return drawing.parent_figure(ax)
        columns = min(len(self._records), 3)
        rows = -(-len(self._records) // columns)
        size = (max(5.5, 1.0 + 3.4 * columns), 0.9 + 3.6 * rows)
        figure, axes = drawing.panels(rows, columns, size, self._title("loops of tests and models"))
        test_axes = axes[: len(self._records)]
        for place, record in zip(test_axes, self._records, strict=True):
            self._draw_loops(place, record)
            title = self._test_name(record)
            if len(self._names) == 1:
                title += "".join(
                    f", R² = {comparison.R2:.4f}" for comparison, _ in self._comparisons(record)
                )
            drawing.name_axes(place, "displacement [mm]", "force [kN]", title)
        force = drawing.common_limits(test_axes)  # one scale: the cold test is the stronger one
        # One scale for the displacement too, so that panels can be compared.
        widest = 1.06 * max(record.peak_displacement for record in self._records)
        for place, record in zip(test_axes, self._records, strict=True):
            place.set(xlim=(-widest, widest), ylim=force)
            end = self._tested_to(record)
            drawing.shade_untested([place], [(-end, end)])
        for place in axes[len(self._records) :]:
            place.set_visible(False)
        test = Line2D([], [], color=PALE_TEST, linewidth=BAND_WIDTH, label="test (band)")
        self._legend(figure, test)
        return figure

    def _draw_loops(self, ax: Axes, record: TestRecord, colour: str = "") -> None:
        x, lines = record.displacement, [(record.force, PALE_TEST, BAND_WIDTH, 1.5)]
        for comparison, model_colour in self._comparisons(record):
            if comparison.prediction is not None:
                lines.append((comparison.prediction.force, colour or model_colour, 0.8, 2.0))
        span = float(np.ptp(x)), float(np.ptp(record.force))
        for values, line_colour, width, order in lines:
            samples = drawing.thin_loops(x, values, *span)
            ax.plot(x[samples], values[samples], color=line_colour, linewidth=width, zorder=order)

    def _tested_to(self, record: TestRecord) -> float:
        """Return the displacement [mm] of the largest calibrated strain if a test exceeds it."""
        ends = [
            row["largest"] / row["demand"] * record.peak_displacement
            for comparison, _ in self._comparisons(record)
            for row in comparison.compared
            if row["limit"] == "strain" and row["outside"] and row["demand"] > row["largest"]
        ]
        return min(ends, default=np.inf)

    def residuals(self) -> Figure:
        """Draw the residual force over the samples of each test, and its distribution."""
        count = len(self._records)
        size = (9.5, 0.8 + 2.3 * count)
        figure, axes = drawing.panels(count, 2, size, self._title("residuals"))
        label = "model - test [% of peak]"
        for left, right, record in zip(axes[::2], axes[1::2], self._records, strict=True):
            spreads = []
            for comparison, colour in self._comparisons(record):
                assert comparison.prediction is not None
                residual = 100.0 * (comparison.prediction.force - record.force) / record.peak_force
                samples = drawing.thin(residual, BINS)
                left.plot(samples, residual[samples], color=colour, linewidth=0.5)
                right.hist(residual, bins=80, density=True, color=colour, histtype="step")
                sigma = max(float(residual.std()), 1e-12)
                grid = np.linspace(float(residual.min()), float(residual.max()), 200)
                area = sigma * np.sqrt(2.0 * np.pi)
                normal = np.exp(-0.5 * ((grid - residual.mean()) / sigma) ** 2) / area
                right.plot(grid, normal, color=colour, linewidth=0.8, linestyle="--")
                spreads.append(f"{sigma:.2g}")
            left.axhline(0.0, color=drawing.INK, linewidth=0.8)
            drawing.name_axes(left, "sample", label, self._test_name(record))
            spread = f"standard deviation {', '.join(spreads)} %" if spreads else ""
            drawing.name_axes(right, label, "density", spread)
        normal_line = Line2D([], [], color=drawing.INK, lw=0.8, ls="--", label="normal")
        self._legend(figure, normal_line)
        return figure

    def temperatures(self) -> Figure:
        """Draw the thermocouples of the tests in time, and the models at their places."""
        records = [record for record in self._records if record.temperatures]
        size = (9.0, 0.9 + 3.0 * max(len(records), 1))
        title = self._title("thermocouples")
        figure, axes = drawing.panels(max(len(records), 1), 1, size, title)
        dashes = {name: DASHES[k % len(DASHES)] for k, name in enumerate(self._names)}
        for ax, record in zip(axes, records, strict=False):
            colours = drawing.ordered_colours(len(record.temperatures), "turbo")
            for (place, test), colour in zip(record.temperatures.items(), colours, strict=True):
                label, pale = f"{place} ({record.places[place]})", _paler(colour)
                ax.plot(record.time, test, color=pale, linewidth=BAND_WIDTH, label=label)
                for comparison, _ in self._comparisons(record):
                    assert comparison.prediction is not None
                    style: drawing.Look = {
                        "linewidth": 1.0,
                        "linestyle": dashes[self._model_name(comparison)],
                    }
                    ax.plot(
                        record.time,
                        comparison.prediction.temperatures[place],
                        color=colour,
                        **style,
                    )
            ax.legend(fontsize=drawing.SMALL, frameon=False)
            drawing.name_axes(ax, "time [s]", "temperature [degC]", self._test_name(record))
        handles = [Line2D([], [], color=PALE_TEST, linewidth=BAND_WIDTH, label="test (band)")]
        handles += [
            Line2D([], [], color=drawing.INK, linewidth=1.0, ls=dash, label=name)
            for name, dash in dashes.items()
        ]
        drawing.legend_below(figure, handles)
        return figure


class IdentificationFigures(ComparisonFigures):
    """Figures of a calibration: `found.plot.loops()` and so on, each a matplotlib Figure."""

    def __init__(self, identification: Identification) -> None:
        super().__init__(identification, identification.fits, identification.bearing.name)
        self._identification = identification

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        figures = super().draw_all()
        for draw in (self.convergence, self.correlation, self.cycles):
            figures[draw.__name__] = draw
        bands = self._identification.forecast.bands if self._identification.forecast else ()
        return figures | {f"band_{band.ambient:g}": partial(self.band, band) for band in bands}

    def convergence(self) -> Figure:
        """Draw the best residual so far against evaluations."""
        figure, (ax,) = drawing.panels(1, 1, (6.5, 3.8), self._title("convergence"))
        count, squares = np.array(self._identification.history, dtype=float).T
        error = 100.0 * np.sqrt(squares)
        ax.step(count, error, where="post", color=drawing.INK, linewidth=1.3)
        ax.set_yscale("log")
        decades = np.log10(error.max() / error.min()) if error.min() > 0.0 else 2.0
        ax.yaxis.set_minor_formatter("{x:g}" if decades < 1.0 else "")
        ax.yaxis.set_major_formatter("{x:g}")
        ax.tick_params(which="both", labelsize=drawing.SMALL)
        drawing.name_axes(ax, "evaluations of all tests", "rms residual [% of peak]")
        return figure

    def correlation(self) -> Figure:
        """Draw the correlation matrix of the free parameters."""
        uncertainty = self._identification.uncertainty
        names = [item.parameter.kind.symbol for item in uncertainty.estimates.values()]
        size = 1.8 + 0.55 * len(names)
        inches = (max(size + 0.8, 4.5), max(size, 3.8))
        figure, (ax,) = drawing.panels(1, 1, inches, self._title("correlation"))
        ax.grid(False)
        image = ax.imshow(uncertainty.correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
        ax.set_xticks(range(len(names)), names, fontsize=drawing.NORMAL, rotation=45)
        ax.set_yticks(range(len(names)), names, fontsize=drawing.NORMAL)
        for (i, j), value in np.ndenumerate(uncertainty.correlation):
            if len(names) <= LABELLED * figure.get_figwidth():
                colour = "white" if abs(value) > 0.6 else drawing.INK
                text = f"{value:.2f}".replace("-", "\N{MINUS SIGN}")
                ax.text(
                    j, i, text, ha="center", va="center", fontsize=drawing.SMALLEST, color=colour
                )
        figure.colorbar(image, ax=ax, shrink=0.8).ax.tick_params(labelsize=drawing.SMALL)
        return figure

    def cycles(self) -> Figure:
        """Draw the measures of each cycle: the test as a broad band, the model as a line.

        Both are those of cycles.csv.
        """
        title = self._title("test and model, each cycle")
        figure, axes = drawing.panels(2, 2, (10.0, 6.4), title, least=drawing.NARROW)
        fits = self._identification.fits
        colours = drawing.ordered_colours(len(fits), "viridis")
        for ax, (measure, (title, unit, _)) in zip(axes, MEASURES.items(), strict=True):
            for k, (fit, colour) in enumerate(zip(fits, colours, strict=True)):
                self._draw_cycles(ax, fit, measure, colour, drawing.MARKERS[k % 8])
            ax.set_ylim(0.0, 1.06 * ax.get_ylim()[1])
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
            errors = [100.0 * loop.errors[measure] for fit in fits for loop in fit.loops]
            if errors:  # not without a full cycle
                words = f"model error {min(errors):+.1f} to {max(errors):+.1f} %"
                title += ": " + words.replace("-", "\N{MINUS SIGN}")
            drawing.name_axes(ax, "cycle", unit, title)
        handles = [
            Line2D(
                [], [], color=c, marker=drawing.MARKERS[k % 8], label=self._test_name(fit.record)
            )
            for k, (fit, c) in enumerate(zip(fits, colours, strict=True))
        ]
        broad = Line2D([], [], color=PALE_TEST, linewidth=6.0, label="test (band)")
        thin = Line2D([], [], color=drawing.INK, linewidth=1.0, label="model (line)")
        drawing.legend_below(figure, [broad, thin, *handles])
        return figure

    def _draw_cycles(self, ax: Axes, fit: Comparison, name: str, colour: str, marker: str) -> None:
        """Draw one measure of the cycles of a test, each amplitude a line."""
        assert fit.prediction is not None
        bearing, force, rows = self._identification.bearing, fit.prediction.force, []
        size = {"area": bearing.area, "total_rubber_thickness": bearing.total_rubber_thickness}
        loops = [loop for loop in fit.loops if loop.last - loop.first + 1 >= FEWEST_POINTS]
        for loop in loops:
            part = slice(loop.first, loop.last + 1)
            x, force_in_loop = cut_at_zeros(fit.record.displacement[part], force[part])
            measures = measure_cycle(x, force_in_loop, slope=False, **size)
            value = MEASURES[name][2](measures)
            rows.append((loop.cycle, value / (1.0 + loop.errors[name]), value))
        first = [k for k, loop in enumerate(loops) if k and loop.number <= loops[k - 1].number]
        columns = np.array(rows, dtype=float).reshape(-1, 3).T
        x, test, model = (np.insert(values, first, np.nan) for values in columns)
        ax.plot(x, test, "o-", color=colour, alpha=0.3, linewidth=6.0, markersize=6.0, mew=0.0)
        ax.plot(x, model, marker + "-", color=colour, markersize=3.5, linewidth=1.0)

    def band(self, band: Band) -> Figure:
        """Draw the loops at a temperature in their 95 % band, and the force at each reversal."""
        words = " (outside calibration range)" if band.beyond_tested else ""
        title = self._title(f"predicted at {drawing.degrees(band.ambient)}{words}")
        figure, (loops, peaks) = drawing.panels(1, 2, (10.0, 4.4), title, least=drawing.NARROW)
        x, force = band.displacement, band.best
        largest = float(np.abs(x).max())
        jitter = TURN * largest
        turns = turning_points(x, jitter)
        for first, last in pairwise(turns):  # each leg separately
            leg = slice(first, last + 1)
            samples = first + drawing.thin_loops(x[leg], force[leg], 2.0 * largest, 2.0 * band.peak)
            low, high = band.lower[samples], band.upper[samples]
            loops.fill_between(x[samples], low, high, color=PALE_TEST, linewidth=0.0)
        samples = drawing.thin_loops(x, force, 2.0 * largest, 2.0 * band.peak)
        loops.plot(x[samples], force[samples], color=MODEL, linewidth=0.7)
        text = f"peak {band.peak:.4g} kN, 95 % {band.peak_lower:.4g} to {band.peak_upper:.4g} kN"
        drawing.name_axes(loops, "displacement [mm]", "force [kN]", text)
        reversals = turns[np.abs(x[turns]) > SMALL_TURN * largest]
        number, side = np.arange(1, len(reversals) + 1), np.sign(x[reversals])
        reversals = np.array([_last_of_leg(x, force, k, jitter) for k in reversals.tolist()])
        ends = side * band.lower[reversals], side * band.upper[reversals]
        peaks.vlines(number, *ends, color=PALE_TEST, linewidth=BAND_WIDTH)
        peaks.plot(number, side * force[reversals], "o", color=MODEL, markersize=3.5)
        peaks.set_ylim(bottom=min(0.0, *peaks.get_ylim()))
        drawing.name_axes(peaks, "reversal", "force at the reversal [kN]")
        drawing.name_axes(peaks, title="force at each reversal")
        causes = (
            "parameters and extrapolation" if OUTSIDE in band.main.shares else "parameters only"
        )
        band95 = Line2D([], [], color=PALE_TEST, linewidth=6.0, label=f"95 % band ({causes})")
        best = Line2D([], [], color=MODEL, marker="o", markersize=3.5, label="best estimate")
        drawing.legend_below(figure, [band95, best])
        return figure
