"""Figures of a validation and of a cross-validation."""

from collections.abc import Callable
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from thermobearing.identify.figures import TEST, ComparisonFigures
from thermobearing.results import drawing
from thermobearing.validate.result import RATIOS, CrossValidation, Validation

FOLD = "#CC3311"
SPREAD = 0.2  # of the room of a test: between two models
LEAST_SPAN = 2.0  # of an axis of errors, to either side of none [%]
WORDS = {"K_eq": "stiffness K_eq", "h_eq": "damping h_eq"}


class ValidationFigures(ComparisonFigures):
    """Figures of a validation: `found.plot.loops()` and so on, each a matplotlib Figure."""

    def __init__(self, validation: Validation) -> None:
        super().__init__(validation, validation.comparisons, "Validation")
        self._limits = validation.limits

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"ratios": self.ratios, "cycles": self.cycles, **super().draw_all()}

    def _legend_of_limits(self, figure: Figure) -> None:
        band = Line2D([], [], label="within the limit", color=drawing.PALE, linewidth=7.0)
        self._legend(figure, *([band] if self._limits else []))

    def ratios(self) -> Figure:
        """Draw the error of the largest loop: a column for each measure (Figs. 5.11, 5.14)."""
        count = len(self._records)
        size = (drawing.WIDEST, 1.3 + max(0.22 * len(self._names), 0.35) * count)
        title = self._title("model error, largest loop")
        figure, axes = drawing.panels(1, len(RATIOS), size, title)
        for ax, measure in zip(axes, RATIOS, strict=True):
            for place, record in enumerate(self._records):
                for item, colour in self._comparisons(record):
                    if item.largest is None:
                        continue
                    number = self._names.index(self._model_name(item))
                    at = place + (number - 0.5 * (len(self._names) - 1)) * SPREAD
                    errors = [0.0, 100.0 * (item.largest.ratios[measure] - 1.0)]
                    look: drawing.Look = {"color": colour, "linewidth": 1.4, "ms": 4.5}
                    ax.plot(errors, [at, at], marker="o", markevery=[1], **look)
            self._shade_limit(ax, measure, "x")
            # Zero in the middle, and no errors of rounding drawn over the whole width.
            widest = max(LEAST_SPAN, *(abs(v) for v in (*ax.get_xlim(), *ax.dataLim.intervalx)))
            ax.set_xlim(-1.1 * widest, 1.1 * widest)
            ax.set_ylim(count - 0.5, -0.5)
            ax.set_yticks(range(count), [""] * count)
            ax.grid(False, axis="y")
            drawing.name_axes(ax, "error [%]")
        drawing.head_grid(axes, [WORDS.get(name, name) for name in RATIOS], [])
        axes[0].set_yticks(
            range(count), [self._test_name(r).replace(", ", "\n") for r in self._records]
        )
        self._legend_of_limits(figure)
        return figure

    def _shade_limit(self, ax: Axes, measure: str, along: Literal["x", "y"]) -> None:
        """Draw the limit of a measure as a band around zero error, where there is one."""
        limit = self._limits.get("force" if measure[0] == "F" else measure)
        span, line = (ax.axvspan, ax.axvline) if along == "x" else (ax.axhspan, ax.axhline)
        if limit is not None:
            span(-100.0 * limit, 100.0 * limit, color=drawing.PALE, zorder=0.1, linewidth=0)
        line(0.0, color=drawing.INK, linewidth=0.8, zorder=1.2)

    def cycles(self) -> Figure:
        """Draw the error of every cycle: a column for each test, a row for each measure."""
        columns = len(self._records)
        size = (max(5.0, 1.0 + 2.6 * columns), 1.2 + 1.3 * len(RATIOS))
        title = self._title("model error, every cycle")
        figure, axes = drawing.panels(len(RATIOS), columns, size, title, share="col")
        for number, ax in enumerate(axes):
            measure, record = RATIOS[number // columns], self._records[number % columns]
            for item, colour in self._comparisons(record):
                errors = [100.0 * (loop.ratios[measure] - 1.0) for loop in item.loops]
                look: drawing.Look = {"color": colour, "linewidth": 0.9}
                ax.plot([loop.cycle for loop in item.loops], errors, marker=".", **look)
            low, high = ax.dataLim.intervaly
            widest = max(LEAST_SPAN, abs(low), abs(high)) if np.isfinite([low, high]).all() else 1.0
            self._shade_limit(ax, measure, "y")
            ax.set_ylim(-1.15 * widest, 1.15 * widest)
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
            is_lowest, is_leftmost = number // columns == len(RATIOS) - 1, number % columns == 0
            name = f"{WORDS.get(measure, measure)}\nerror [%]"
            drawing.name_axes(ax, "cycle" if is_lowest else "", name if is_leftmost else "")
        drawing.head_grid(axes, [self._test_name(record) for record in self._records], [])
        figure.align_ylabels()
        self._legend_of_limits(figure)
        return figure


class CrossValidationFigures(drawing.Figures):
    """Figures of a cross-validation: `found.plot.folds()`, a matplotlib Figure."""

    vector = True
    _result: CrossValidation

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return what draws the figures of the final fit, of the folds, and of all tests."""
        result = self._result
        folds = {"folds": self.folds} if result.folds else {}
        judged = result.judged.plot.draw_all()
        judged = {f"held_out_{name}": draw for name, draw in judged.items()}
        return {**result.final.plot.draw_all(), **folds, **judged}

    def folds(self) -> Figure:
        """Draw each free parameter without each group of tests, over that of the fit to all."""
        result = self._result
        table, symbols = result.parameters, list(result.free)
        title = f"{result.final.bearing.name}: parameters without each group of tests"
        size = (max(6.0, 2.0 + 1.1 * len(symbols)), 4.2)
        figure, (ax,) = drawing.panels(1, 1, size, title)
        for place, symbol in enumerate(symbols):
            values = table[symbol].to_numpy(float)
            reference = abs(values[0]) or 1.0  # some may be zero
            error = np.nan_to_num(
                table[f"{symbol}_stderr"].to_numpy(float)[0] / reference, posinf=0.0
            )
            ax.errorbar(place, 0.0, 100.0 * error, color=TEST, capsize=6, linewidth=2.0)
            # The first row is the fit to all tests, the others are fits without one group.
            deviations = 100.0 * (values[1:] - values[0]) / reference
            positions = place + np.linspace(-0.25, 0.25, len(deviations))
            ax.plot(positions, deviations, "o", color=FOLD, markersize=4)
            for x, y, fold in zip(positions, deviations, table["fold"][1:], strict=True):
                ax.annotate(
                    str(fold), (x, y), (3, 3), textcoords="offset points", fontsize=drawing.SMALLEST
                )
        ax.axhline(0.0, color=drawing.INK, linewidth=0.8)
        ax.set_xticks(range(len(symbols)), symbols)
        drawing.name_axes(ax, y="deviation from the fit to all tests [%]")
        error_bar = Line2D([], [], color=TEST, lw=2.0, label="standard error of the fit to all")
        dots: drawing.Look = {"color": FOLD, "marker": "o", "linestyle": ""}
        dot = Line2D([], [], label="fit without a fold (its number)", **dots)
        drawing.legend_below(figure, [error_bar, dot])
        return figure
