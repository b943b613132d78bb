"""Pictures of a validation: loops, ratios of the largest loops, cycles, temperatures, residuals."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.identify.record import TestRecord
from thermobearing.results import drawing
from thermobearing.validate.result import RATIOS, Comparison, Validation

TEST = "#8a8f98"
BINS = 3000


class ValidationFigures:
    """Figures of a validation: `found.plot.loops()` and so on, each a matplotlib Figure.

    Parameters
    ----------
    found : from `validate`.
    """

    def __init__(self, found: Validation) -> None:
        self._found = found
        done = [item for item in found.comparisons if item.prediction is not None]
        self._done = done
        self._names = list(dict.fromkeys(_name(item) for item in done))
        colours = drawing.ordered_colours(max(len(self._names), 1), "turbo")
        self._colours = dict(zip(self._names, colours, strict=False))
        self._records: list[TestRecord] = []
        for item in found.comparisons:
            if not any(item.record is record for record in self._records):
                self._records.append(item.record)

    def _of(self, record: TestRecord) -> list[Comparison]:
        return [item for item in self._done if item.record is record]

    def _handles(self, *, test: bool = True) -> list[Line2D]:
        lines = [Line2D([], [], color=TEST, linewidth=2.0, label="test")] if test else []
        return lines + [
            Line2D([], [], color=self._colours[name], linewidth=2.0, label=name)
            for name in self._names
        ]

    def loops(self) -> Figure:
        """Loops of each test, those of the models over them."""
        columns = min(len(self._records), 3)
        rows = -(-len(self._records) // columns)
        size = (max(5.5, 1.0 + 3.4 * columns), 0.9 + 3.6 * rows)
        figure, axes = drawing.panels(rows, columns, size, "tests and models as they are")
        for ax, record in zip(axes, self._records, strict=False):
            x = record.displacement
            spans = float(np.ptp(x)), float(np.ptp(record.force))
            kept = drawing.thin_loops(x, record.force, *spans)
            ax.plot(x[kept], record.force[kept], color=TEST, linewidth=1.0)
            for item in self._of(record):
                assert item.prediction is not None
                force = item.prediction.force
                kept = drawing.thin_loops(x, force, *spans)
                ax.plot(x[kept], force[kept], color=self._colours[_name(item)], linewidth=0.7)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]", _title(record))
            end = self._tested_to(record)
            drawing.shade_untested([ax], [(-end, end)])
        for ax in axes[len(self._records) :]:
            ax.set_visible(False)
        drawing.legend_below(figure, self._handles())
        return figure

    def _tested_to(self, record: TestRecord) -> float:
        """Displacement [mm] of the largest tested strain that a test goes beyond; else infinite."""
        ends = [
            row["largest"] / row["asked"] * record.peak_displacement
            for item in self._of(record)
            for row in item.asked
            if row["limit"] == "strain" and row["passed"] and row["asked"] > row["largest"]
        ]
        return min(ends, default=np.inf)

    def ratios(self) -> Figure:
        """Model over test of the largest loop: a group of bars for each test (Figs. 5.11, 5.14)."""
        size = (max(6.5, 2.0 + 2.6 * len(self._records)), 1.9 * len(RATIOS))
        figure, axes = drawing.panels(len(RATIOS), 1, size, "largest loop, model over test")
        width = 0.8 / max(len(self._names), 1)
        for ax, measure in zip(axes, RATIOS, strict=True):
            for place, record in enumerate(self._records):
                for item in self._of(record):
                    if item.largest is None:
                        continue
                    number = self._names.index(_name(item))
                    at = place + (number - 0.5 * (len(self._names) - 1)) * width
                    ratio = item.largest.ratios[measure]
                    ax.bar(at, ratio, 0.92 * width, color=self._colours[_name(item)])
            limit = self._found.limits.get("force" if measure[0] == "F" else measure)
            for off in () if limit is None else (-limit, limit):
                ax.axhline(1.0 + off, color=drawing.GREY, linewidth=0.8, linestyle="--")
            ax.axhline(1.0, color=drawing.INK, linewidth=0.9)
            ax.set_xticks(range(len(self._records)), [""] * len(self._records))
            drawing.name_axes(ax, y=measure)
        titles = [_title(record) for record in self._records]
        axes[-1].set_xticks(range(len(titles)), titles, fontsize=drawing.SMALL)
        drawing.legend_below(figure, self._handles(test=False))
        return figure

    def cycles(self) -> Figure:
        """Model over test of every cycle: a column for each test."""
        size = (max(5.5, 1.0 + 3.4 * len(self._records)), 1.0 + 1.9 * len(RATIOS))
        title = "every cycle: model over test"
        figure, axes = drawing.panels(len(RATIOS), len(self._records), size, title)
        for line, measure in enumerate(RATIOS):
            for place, record in enumerate(self._records):
                ax = axes[line * len(self._records) + place]
                for item in self._of(record):
                    ax.plot(
                        [loop.cycle for loop in item.loops],
                        [loop.ratios[measure] for loop in item.loops],
                        color=self._colours[_name(item)],
                        marker=".",
                        linewidth=0.9,
                    )
                ax.axhline(1.0, color=drawing.INK, linewidth=0.8)
                drawing.name_axes(ax, y=measure if place == 0 else "")
                if line == 0:
                    drawing.name_axes(ax, title=_title(record))
                if line == len(RATIOS) - 1:
                    drawing.name_axes(ax, "cycle")
        drawing.legend_below(figure, self._handles(test=False))
        return figure

    def temperatures(self) -> Figure:
        """Thermocouples of the tests, and the models at their places, in time."""
        some = [record for record in self._records if record.temperatures]
        size = (9.0, 0.9 + 3.0 * len(some))
        figure, axes = drawing.panels(len(some), 1, size, "temperatures")
        for ax, record in zip(axes, some, strict=True):
            for title, values in record.temperatures.items():
                ax.plot(record.time, values, color=TEST, linewidth=1.2)
                ax.annotate(title, (record.time[-1], values[-1]), fontsize=drawing.SMALL)
                for item in self._of(record):
                    assert item.prediction is not None
                    model = item.prediction.temperatures[title]
                    ax.plot(record.time, model, color=self._colours[_name(item)], linewidth=0.8)
            drawing.name_axes(ax, "time [s]", "temperature [degC]", _title(record))
        drawing.legend_below(figure, self._handles())
        return figure

    def residuals(self) -> Figure:
        """Model less test over the samples, relative to the largest force of the test."""
        size = (9.0, 0.9 + 2.2 * len(self._records))
        figure, axes = drawing.panels(len(self._records), 1, size, "residuals")
        for ax, record in zip(axes, self._records, strict=True):
            for item in self._of(record):
                assert item.prediction is not None
                off = 100.0 * (item.prediction.force - record.force) / record.peak_force
                kept = drawing.thin(off, BINS)
                ax.plot(kept, off[kept], color=self._colours[_name(item)], linewidth=0.5)
            ax.axhline(0.0, color=drawing.INK, linewidth=0.8)
            drawing.name_axes(ax, "sample", "model - test [% of peak]", _title(record))
        drawing.legend_below(figure, self._handles(test=False))
        return figure

    def save_all(self, folder: Path, prefix: str = "") -> list[Path]:
        """Every figure, as PNG.

        Parameters
        ----------
        folder : where to; made if it does not exist.
        prefix : of the names of the files.

        Returns
        -------
        list of the files written.
        """
        figures: dict[str, Callable[[], Figure]] = {
            "loops": self.loops,
            "ratios": self.ratios,
            "cycles": self.cycles,
            "residuals": self.residuals,
        }
        if any(record.temperatures for record in self._records):
            figures["temperatures"] = self.temperatures
        return drawing.save_figures(
            {prefix + name: draw for name, draw in figures.items()}, folder, vector=True
        )


def _name(item: Comparison) -> str:
    return f"{item.bearing}, {item.model}"


def _title(record: TestRecord) -> str:
    return f"{record.name}, {drawing.degrees(record.ambient)}"
