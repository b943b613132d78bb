"""A time axis with loadings to scale and long rests shortened or cut out.

The loadings of Table 3.4 last tens of seconds and the rests between them more than an hour.
A shortened rest starts to scale and turns logarithmic, so the first seconds of cooling stay
visible; a rest that would not be longer than the room it gets is drawn to scale.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from thermobearing.core.records import Floats
from thermobearing.results.drawing import GREY, PALE, SMALL, WIDEST, Look, parent_figure
from thermobearing.results.figure_style import SMALLEST

RESTS_SHARE = 0.55  # of the loading time: room that all shortened rests have together
REST_SHARE = 0.13  # ... and that one of them has at most
CUT_SHARE = 0.5  # of that room for a rest that is cut out
LETTER = 0.0082  # mean width of a letter of a label, of the axis
REST_TICKS = {10.0: "10 s", 60.0: "1 min", 600.0: "10 min"}
REST_TICKS |= {3600.0: "1 h", 36e3: "10 h", 360e3: "100 h"}
# A rest that is cut out: the gap, the strokes at its ends, how long it is.
GAP: Look = {"color": "white", "linewidth": 0, "zorder": 3, "clip_on": False}
STROKE: Look = {"marker": [(-0.5, -1.0), (0.5, 1.0)], "markersize": 8, "linestyle": "none"}
STROKE |= {"color": GREY, "zorder": 4, "clip_on": False}
LENGTH: Look = {"color": GREY, "fontsize": SMALL, "rotation": 90, "ha": "center", "va": "center"}
TO_SCALE = math.inf


def duration(seconds: float) -> str:
    """Return a duration [s] as text in a suitable unit."""
    for size, unit, limit in ((1.0, "s", 120.0), (60.0, "min", 3600.0), (3600.0, "h", 360e3)):
        if seconds < limit:
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
        """Return whether it is drawn shorter than to scale."""
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
        """Return where on the axis a time since the start of the stretch is drawn."""
        if not self.shortened:
            return self.left + elapsed
        return self.left + self.bend * np.log1p(elapsed / self.bend)

    def label(self) -> str:
        """Return how long the rest was; from the shortest to the longest if the runs differ."""
        low, high = duration(self.shortest), duration(self.longest)
        if low == high:
            return f"{high} rest"
        value, unit = low.split()
        return f"{value if high.endswith(unit) else low}\N{EN DASH}{high} rest"


def _bend(longest: float, room: float) -> float:
    """Tau with tau ln(1 + longest/tau) = room: drawn to scale at first, and filling the room."""
    # tau ln(1 + longest/tau) increases with tau: bisection of ln(tau), of any magnitude.
    low, high = math.log(room) - 50.0, math.log(longest)
    for _ in range(80):
        middle = 0.5 * (low + high)
        tau = math.exp(middle)
        low, high = (middle, high) if tau * math.log1p(longest / tau) < room else (low, middle)
    return math.exp(low)


class DrawnAxis:
    """Stretches of a test side by side; with `cut`, without the long rests."""

    def __init__(self, stretches: list[Stretch], *, cut: bool = False) -> None:
        self.cut = cut
        self.stretches = self._arranged(stretches)
        self.end = self.stretches[-1].right or 1.0
        self.unit, self.unit_name = self._chosen_unit()

    @property
    def shortened(self) -> list[Stretch]:
        """The rests that are not drawn to scale."""
        return [s for s in self.stretches if s.shortened]

    def _arranged(self, stretches: list[Stretch]) -> list[Stretch]:
        """Return the stretches side by side, rests that are too long for their room shortened."""
        moving = sum(s.longest for s in stretches if not s.rest)
        rest_width = moving * min(REST_SHARE, RESTS_SHARE / max(sum(s.rest for s in stretches), 1))
        rest_width *= CUT_SHARE if self.cut else 1.0
        placed, left = [], 0.0
        for s in stretches:
            shortened = s.rest and 0.0 < rest_width < s.longest
            width = rest_width if shortened else s.longest
            bend = _bend(s.longest, width) if shortened else TO_SCALE
            placed.append(replace(s, left=left, width=width, bend=bend))
            left += width
        return placed

    def _chosen_unit(self) -> tuple[float, str]:
        for limit, size, name in ((1200.0, 1.0, "s"), (18e3, 60.0, "min"), (7e5, 3600.0, "h")):
            if self.end <= limit:
                return size, name
        return 86400.0, "d"

    def _blocks(self) -> list[tuple[float, float]]:
        """Return left and right end of what is drawn to scale without a break."""
        blocks: list[tuple[float, float]] = []
        for s in self.stretches:
            if not s.shortened:
                first = blocks.pop()[0] if blocks and blocks[-1][1] == s.left else s.left
                blocks.append((first, s.right))
        return blocks

    def set_ticks(
        self, ax: Axes, *, labels: bool = True, in_rests: bool = True, most: int = 20
    ) -> None:
        """About so many from the starts of loadings, and round times within shortened rests."""
        count = max(round(most / self._narrower(ax)), 3)
        round_steps = MaxNLocator(nbins=count, steps=[1, 2, 2.5, 5, 10])
        ticks = round_steps.tick_values(0.0, self.end / self.unit)
        step = float(ticks[1] - ticks[0])
        positions = [
            (left + self.unit * k * step, f"{k * step:g}")
            for left, right in self._blocks()
            for k in range(int((right - left) / self.unit / step + 1e-6) + 1)
        ]
        ax.set_xticks([x for x, _ in positions], [name if labels else "" for _, name in positions])
        ax.set_xlim(0.0, self.end)
        if in_rests and not self.cut:
            self._set_rest_ticks(ax, labels)

    def _set_rest_ticks(self, ax: Axes, labels: bool) -> None:
        positions: list[tuple[float, str]] = []
        label_width = 0.013 * self._narrower(ax) * self.end  # room of one upright label
        for s in self.shortened:
            free_from = s.left + label_width
            for seconds, name in REST_TICKS.items():
                x = float(s.place(np.array(seconds)))
                if free_from < x < s.right - label_width:
                    positions.append((x, name if labels else ""))
                    free_from = x + label_width
        ax.set_xticks([x for x, _ in positions], [name for _, name in positions], minor=True)
        look: Look = {"labelrotation": 90, "labelsize": SMALLEST, "labelcolor": GREY}
        ax.tick_params(which="minor", color=GREY, **look)

    def _narrower(self, ax: Axes) -> float:
        """Return the factor by which letters are wider, of the axis, than on a full page."""
        return max(WIDEST / parent_figure(ax).get_figwidth(), 1.0)

    def caption(self) -> str:
        """Label of the axis."""
        if not self.shortened:
            return f"time [{self.unit_name}]"
        text = f"time from the start of each loading [{self.unit_name}]"
        return f"{text}, rests cut out" if self.cut else f"{text}; rests (shaded) shortened"

    def shade_rests(self, ax: Axes, *, labels: bool) -> None:
        """Draw a shaded band over each shortened rest, and above it how long it was."""
        for s in self.shortened:
            ax.axvspan(s.left, s.right, color=PALE, zorder=0)
            letter_count = s.width / (LETTER * self._narrower(ax) * self.end)
            fitting = [text for text in (s.label(), s.label()[:-5]) if len(text) < letter_count]
            if labels and fitting:
                write_above(ax, s.middle, fitting[0], GREY, "normal")

    def cut_out_rests(self, ax: Axes) -> None:
        """Draw a gap in the panel and its frame for each long rest, with strokes at its ends."""
        place = ax.get_xaxis_transform()
        for s in self.shortened:
            ax.fill_between([s.left, s.right], -0.01, 1.01, transform=place, **GAP)
            corners = ([s.left, s.left, s.right, s.right], [0.0, 1.0, 0.0, 1.0])
            ax.plot(*corners, transform=place, **STROKE)
            ax.text(s.middle, 0.5, s.label(), transform=place, zorder=4, **LENGTH)


def write_above(ax: Axes, x: float, text: str, colour: str, weight: str) -> None:
    """Write a label above a panel, at x of its axis."""
    place = ax.get_xaxis_transform()
    look: Look = {"fontsize": SMALL, "fontweight": weight, "color": colour}
    ax.text(x, 1.02, text, ha="center", va="bottom", transform=place, **look)
