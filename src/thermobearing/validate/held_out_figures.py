"""Pictures of a fit that is judged by tests it has not seen: its parameters from fold to fold."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.validate.held_out_result import CrossValidation

FINAL, FOLD = "#8a8f98", "#CC3311"


class CrossValidationFigures:
    """Figures of a fit with tests held out: `found.plot.folds()`, a matplotlib Figure.

    Parameters
    ----------
    found : from `cross_validate`.
    """

    def __init__(self, found: CrossValidation) -> None:
        self._found = found

    def folds(self) -> Figure:
        """Each free parameter without each group of tests, over that of the fit to all of them."""
        found = self._found
        table, symbols = found.parameters, list(found.free)
        title = f"{found.final.bearing.name}: parameters without each group of tests"
        size = (max(6.0, 2.0 + 1.1 * len(symbols)), 4.2)
        figure, (ax,) = drawing.panels(1, 1, size, title)
        for place, symbol in enumerate(symbols):
            values = table[symbol].to_numpy(float)
            whole = abs(values[0]) or 1.0  # some may be zero
            error = table[f"{symbol}_stderr"].to_numpy(float)[0] / whole
            error = error if np.isfinite(error) else 0.0
            ax.errorbar(place, 0.0, 100.0 * error, color=FINAL, capsize=6, linewidth=2.0)
            off = 100.0 * (values[1:] - values[0]) / whole
            at = place + np.linspace(-0.25, 0.25, len(off))
            ax.plot(at, off, "o", color=FOLD, markersize=4)
            for x, y, fold in zip(at, off, table["fold"][1:], strict=True):
                ax.annotate(str(fold), (x, y), (3, 3), textcoords="offset points", fontsize=6.5)
        ax.axhline(0.0, color=drawing.INK, linewidth=0.8)
        ax.set_xticks(range(len(symbols)), symbols)
        drawing.name_axes(ax, y="off the fit to all tests [%]")
        lines = [
            Line2D([], [], color=FINAL, linewidth=2.0, label="standard error of the fit to all"),
            Line2D(
                [], [], color=FOLD, marker="o", linestyle="", label="without a fold, its number"
            ),
        ]
        drawing.legend_below(figure, lines)
        return figure

    def save_all(self, folder: Path) -> list[Path]:
        """Every figure, as PNG: parameters by fold, and tests of both kinds.

        Parameters
        ----------
        folder : where to; made if it does not exist.

        Returns
        -------
        list of the files written.
        """
        written = (
            drawing.save_figures({"folds": self.folds}, folder, vector=True)
            if self._found.folds
            else []
        )
        return written + self._found.judged.plot.save_all(folder, "held_out_")
