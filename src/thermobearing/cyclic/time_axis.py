"""Where the runs of a cyclic test are drawn in time (results/time_axis.py); only for figures."""

import math
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermobearing.cyclic.result import Result
from thermobearing.results.drawing import INK, name_axes, panels, thin
from thermobearing.results.time_axis import DrawnAxis, Stretch, write_above

Floats = NDArray[np.float64]

MOST_POINTS = 2000  # bins of a history across the page, about one per pixel
BOLD_LETTER = 0.0105  # mean width of a letter of a label, of the axis


class TimeAxis(DrawnAxis):
    """Where the rows of the runs of a result are drawn; with `cut`, without the long rests."""

    def __init__(self, result: Result, *, cut: bool = False) -> None:
        segment = np.asarray(result["segment"].values)
        self.kinds = [str(about["kind"]) for about in result.segments]
        self.labels = [str(about["label"]).replace("%", " %") for about in result.segments]
        self.rows = [int((numbers >= 0).sum()) for numbers in segment]  # what follows is padding
        self.times = [result.time(run)[:rows] for run, rows in enumerate(self.rows)]
        self.numbers = [numbers[:rows] for numbers, rows in zip(segment, self.rows, strict=True)]
        super().__init__(list(self._grouped()), cut=cut)

    @property
    def farthest(self) -> int:
        """The run that got farthest, for what all runs have in common."""
        ends = zip(self.numbers, self.times, strict=True)
        reached = [(int(number[-1]), float(time[-1])) for number, time in ends]
        return reached.index(max(reached))

    def inside(self, run: int, first: int, last: int) -> slice:
        """Rows of segments first to last of a run, with the row before, where they start."""
        a, b = np.searchsorted(self.numbers[run], [first, last + 1])
        return slice(max(int(a) - 1, 0), int(b)) if b > a else slice(0, 0)

    def last_row(self, run: int, segment: int) -> int | None:
        """Where a segment ended in a run; None if the run did not reach it."""
        return self.inside(run, segment, segment).stop - 1 if segment in self.numbers[run] else None

    def moving_rows(self, run: int) -> list[slice]:
        """Rows of each stretch of a run in which the bearing moves."""
        found = [self.inside(run, s.first, s.last) for s in self.stretches if not s.rest]
        return [inside for inside in found if inside != slice(0, 0)]

    def loading_ends(self, most: int) -> list[tuple[int, str]]:
        """Number and name of the segments whose end is worth a look: the loadings, if any."""
        found: list[int] = []
        for kinds in ({"cycles", "recorded"}, {"ramp"}, {"rest", "closing cycle"}):
            found = found or [i for i, kind in enumerate(self.kinds) if kind in kinds]
        names = [self.labels[i] for i in found]
        names = [
            name if names.count(name) == 1 else f"{name} (step {i + 1})"
            for i, name in zip(found, names, strict=True)
        ]
        chosen = np.unique(np.linspace(0, len(found) - 1, most).round().astype(int))
        return [(found[k], names[k]) for k in chosen]

    def _grouped(self) -> Iterator[Stretch]:
        """Stretches that any run reached, not yet placed."""
        rests = [kind == "rest" for kind in self.kinds]
        starts = [i for i, rest in enumerate(rests) if i == 0 or rest != rests[i - 1]]
        for first, after in zip(starts, [*starts[1:], len(rests)], strict=True):
            spans = [
                float(np.ptp(time[inside]))
                for run, time in enumerate(self.times)
                if (inside := self.inside(run, first, after - 1)) != slice(0, 0)
            ]
            if spans:
                yield Stretch(first, after - 1, rests[first], min(spans), max(spans))

    def trace(self, run: int, values: Floats) -> tuple[Floats, Floats]:
        """Places and thinned values of a history of a run; NaN between stretches."""
        xs, ys = [np.empty(0)], [np.empty(0)]
        for s in self.stretches:
            inside = self.inside(run, s.first, s.last)
            if inside == slice(0, 0) or (self.cut and s.shortened):
                continue
            y, time = values[inside], self.times[run][inside]
            kept = thin(y, math.ceil(MOST_POINTS * s.width / self.end))
            xs += [s.place(time[kept] - time[0]), np.array([np.nan])]
            ys += [y[kept], np.array([np.nan])]
        return np.concatenate(xs), np.concatenate(ys)

    def rows_of_panels(self, title: str, titles: list[str]) -> tuple[Figure, list[Axes]]:
        """A panel per run, one below the other, with loadings and rests marked."""
        count = len(titles)
        figure, axes = panels(count, 1, (9.5, 1.4 + 2.2 * count), title)
        for run, ax in enumerate(axes):
            self.set_ticks(ax, labels=run == count - 1)
            self.shade_rests(ax, labels=run == 0)
            if run == 0:
                self.label_loadings(ax)
            name_axes(ax, title=titles[run], pad=17.0 if ax.texts else 5.0)
        name_axes(axes[-1], self.caption())
        return figure, axes

    def label_loadings(self, ax: Axes) -> None:
        """What is imposed, above each loading that is wide enough for its label."""
        run = self.farthest
        for s in (s for s in self.stretches if not s.rest):
            start = self.times[run][self.inside(run, s.first, s.last)]
            for number in range(s.first, s.last + 1):
                time, label = self.times[run][self.inside(run, number, number)], self.labels[number]
                if self.kinds[number] not in ("cycles", "recorded") or len(time) == 0:
                    continue
                if time[-1] - time[0] > BOLD_LETTER * len(label) * self.end:
                    middle = s.left + 0.5 * (time[0] + time[-1]) - start[0]
                    write_above(ax, middle, label, INK, "bold")
