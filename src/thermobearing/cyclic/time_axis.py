"""A time axis for tests: loading to scale, long rests shortened or cut out. Only for figures.py.

The loadings of Table 3.4 last tens of seconds and the rests between them more than an hour.
A shortened rest starts to scale and turns logarithmic, so the first seconds of cooling stay
visible; a rest that would not be longer than the room it gets is drawn to scale.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from thermobearing.cyclic.result import Result
from thermobearing.results.drawing import GREY, INK, PALE, SMALL, Look, name_axes, panels, thin

Floats = NDArray[np.float64]

MOST_POINTS = 2000  # bins of a history across the page, about one per pixel
RESTS_SHARE = 0.55  # of the loading time: room that all shortened rests have together
REST_SHARE = 0.13  # ... and that one of them has at most
CUT_SHARE = 0.5  # of that room for a rest that is cut out
LETTER, BOLD_LETTER = 0.0082, 0.0105  # mean width of a letter of a label, of the axis
REST_TICKS = (
    (10.0, "10 s"),
    (60.0, "1 min"),
    (600.0, "10 min"),
    (3600.0, "1 h"),
    (36e3, "10 h"),
    (360e3, "100 h"),
)
# A rest that is cut out: the gap, the strokes at its ends, how long it is.
GAP: Look = {"color": "white", "linewidth": 0, "zorder": 3, "clip_on": False}
STROKE: Look = {"marker": [(-0.5, -1.0), (0.5, 1.0)], "markersize": 8, "linestyle": "none"}
STROKE |= {"color": GREY, "zorder": 4, "clip_on": False}
LENGTH: Look = {"color": GREY, "fontsize": SMALL, "rotation": 90, "ha": "center", "va": "center"}
TO_SCALE = math.inf


def duration(seconds: float) -> str:
    """A duration in the unit one would say it in."""
    for size, unit, most in ((1.0, "s", 120.0), (60.0, "min", 3600.0), (3600.0, "h", 360e3)):
        if seconds < most:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 86400.0:.3g} d"


@dataclass(frozen=True)
class Stretch:
    """Consecutive segments of a test that all move, or all rest, and their place on the axis."""

    first: int  # segment numbers
    last: int
    rest: bool
    shortest: float  # among the runs [s]
    longest: float
    left: float = 0.0  # [s] of the drawn axis
    width: float = 0.0
    bend: float = TO_SCALE  # [s] after which the scale turns logarithmic

    @property
    def shortened(self) -> bool:
        """Whether it gets less room than its time to scale."""
        return self.bend != TO_SCALE

    @property
    def right(self) -> float:
        """Where it ends on the drawn axis."""
        return self.left + self.width

    @property
    def middle(self) -> float:
        """Where a label goes."""
        return self.left + 0.5 * self.width

    def place(self, elapsed: Floats) -> Floats:
        """Where on the axis a time since the start of the stretch is drawn."""
        if not self.shortened:
            return self.left + elapsed
        return self.left + self.bend * np.log1p(elapsed / self.bend)

    def label(self) -> str:
        """How long the rest was; from the shortest to the longest if the runs differ."""
        low, high = duration(self.shortest), duration(self.longest)
        if low == high:
            return f"{high} rest"
        value, unit = low.split()
        return f"{value if high.endswith(unit) else low}\N{EN DASH}{high} rest"


def _bend(longest: float, room: float) -> float:
    """Tau with tau ln(1 + longest/tau) = room: drawn to scale at first, and filling the room."""
    low, high = math.log(room) - 50.0, math.log(longest)
    for _ in range(80):
        middle = 0.5 * (low + high)
        tau = math.exp(middle)
        low, high = (middle, high) if tau * math.log1p(longest / tau) < room else (low, middle)
    return math.exp(low)


class TimeAxis:
    """Where the rows of the runs of a result are drawn; with `cut`, without the long rests."""

    def __init__(self, result: Result, *, cut: bool = False) -> None:
        self.cut = cut
        segment = np.asarray(result["segment"].values)
        self.kinds = [str(about["kind"]) for about in result.segments]
        self.labels = [str(about["label"]).replace("%", " %") for about in result.segments]
        self.rows = [int((numbers >= 0).sum()) for numbers in segment]  # what follows is padding
        self.times = [result.time(run)[:rows] for run, rows in enumerate(self.rows)]
        self.numbers = [numbers[:rows] for numbers, rows in zip(segment, self.rows, strict=True)]
        self.stretches = self._arranged(list(self._grouped()))
        self.end = self.stretches[-1].right or 1.0
        self.unit, self.unit_name = self._chosen_unit()

    @property
    def farthest(self) -> int:
        """The run that got farthest, for what all runs have in common."""
        ends = zip(self.numbers, self.times, strict=True)
        reached = [(int(number[-1]), float(time[-1])) for number, time in ends]
        return reached.index(max(reached))

    @property
    def shortened(self) -> list[Stretch]:
        """The rests that are not drawn to scale."""
        return [s for s in self.stretches if s.shortened]

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

    def _arranged(self, found: list[Stretch]) -> list[Stretch]:
        """The stretches side by side, rests that are too long for their room shortened."""
        moving = sum(s.longest for s in found if not s.rest)
        room = moving * min(REST_SHARE, RESTS_SHARE / max(sum(s.rest for s in found), 1))
        room *= CUT_SHARE if self.cut else 1.0
        placed: list[Stretch] = []
        left = 0.0
        for s in found:
            shortened = s.rest and 0.0 < room < s.longest
            width = room if shortened else s.longest
            bend = _bend(s.longest, width) if shortened else TO_SCALE
            placed.append(
                Stretch(s.first, s.last, s.rest, s.shortest, s.longest, left, width, bend)
            )
            left += width
        return placed

    def _chosen_unit(self) -> tuple[float, str]:
        for most, size, name in ((1200.0, 1.0, "s"), (18e3, 60.0, "min"), (7e5, 3600.0, "h")):
            if self.end <= most:
                return size, name
        return 86400.0, "d"

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

    def _blocks(self) -> list[tuple[float, float]]:
        """Left and right end of what is drawn to scale without a break."""
        found: list[tuple[float, float]] = []
        for s in self.stretches:
            if s.shortened:
                continue
            if found and found[-1][1] == s.left:
                found[-1] = (found[-1][0], s.right)
            else:
                found.append((s.left, s.right))
        return found

    def set_ticks(self, ax: Axes, *, labels: bool = True) -> None:
        """Ticks from the start of each loading, and round times within shortened rests."""
        round_steps = MaxNLocator(nbins=20, steps=[1, 2, 2.5, 5, 10])
        ticks = round_steps.tick_values(0.0, self.end / self.unit)
        step = float(ticks[1] - ticks[0])
        places: list[float] = []
        names: list[str] = []
        for left, right in self._blocks():
            values = [k * step for k in range(int((right - left) / self.unit / step + 1e-6) + 1)]
            places += [left + self.unit * value for value in values]
            names += [f"{value:g}" for value in values]
        ax.set_xticks(places, names if labels else [""] * len(names))
        ax.set_xlim(0.0, self.end)
        if not self.cut:
            self._set_rest_ticks(ax, labels)

    def _set_rest_ticks(self, ax: Axes, labels: bool) -> None:
        places: list[float] = []
        names: list[str] = []
        apart = 0.013 * self.end  # room of one upright label
        for s in self.shortened:
            free_from = s.left + apart
            for seconds, name in REST_TICKS:
                x = float(s.place(np.array(seconds)))
                if free_from < x < s.right - apart:
                    places.append(x)
                    names.append(name)
                    free_from = x + apart
        ax.set_xticks(places, names if labels else [""] * len(names), minor=True)
        ax.tick_params(
            which="minor", labelrotation=90, labelsize=SMALL - 1.5, labelcolor=GREY, color=GREY
        )

    def caption(self) -> str:
        """Label of the axis."""
        if not self.shortened:
            return f"time [{self.unit_name}]"
        text = f"time from the start of each loading [{self.unit_name}]"
        return f"{text}, rests cut out" if self.cut else f"{text}; rests (shaded) shortened"

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
                    _write_above(ax, middle, label, INK, "bold")

    def shade_rests(self, ax: Axes, *, labels: bool) -> None:
        """A shaded band over each shortened rest, and above it how long it was."""
        for s in self.shortened:
            ax.axvspan(s.left, s.right, color=PALE, zorder=0)
            room = s.width / (LETTER * self.end)
            fitting = [text for text in (s.label(), s.label()[:-5]) if len(text) < room]
            if labels and fitting:
                _write_above(ax, s.middle, fitting[0], GREY, "normal")

    def cut_out_rests(self, ax: Axes) -> None:
        """A gap in the panel and its frame for each long rest, with strokes at its ends."""
        place = ax.get_xaxis_transform()
        for s in self.shortened:
            ax.fill_between([s.left, s.right], -0.01, 1.01, transform=place, **GAP)
            corners = ([s.left, s.left, s.right, s.right], [0.0, 1.0, 0.0, 1.0])
            ax.plot(*corners, transform=place, **STROKE)
            ax.text(s.middle, 0.5, s.label(), transform=place, zorder=4, **LENGTH)


def _write_above(ax: Axes, x: float, text: str, colour: str, weight: str) -> None:
    place = ax.get_xaxis_transform()
    look: Look = {"fontsize": SMALL, "fontweight": weight, "color": colour}
    ax.text(x, 1.02, text, ha="center", va="bottom", transform=place, **look)
