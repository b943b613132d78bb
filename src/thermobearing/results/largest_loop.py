"""The largest loop of a history that is no test: the one that holds the largest displacement.

The excursion that holds the largest |displacement|, and of its neighbours on the other side the
one that reaches farther (the later of equal ones), make the largest loop. It begins at the last
zero displacement before the peak of the first excursion and ends at the first one after the
peak of the second. An excursion that the history does not bring back to zero is not closed, and
belongs to no loop; one within 2 % of the largest displacement is none.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from thermobearing.results.metrics import FEWEST_POINTS, CycleMeasures, measure_cycle

Floats = NDArray[np.float64]
NOISE = 0.02  # of the largest displacement: excursions within it are none


@dataclass(frozen=True)
class LargestLoop:
    """Points `first` to `last` of the history, just outside the loop, and its measures."""

    first: int
    last: int
    measures: CycleMeasures


def find_largest_loop(displacement: Floats) -> tuple[int, int] | None:
    """First and last point of the largest loop; None if no loop holds the largest displacement.

    Parameters
    ----------
    displacement : history [mm].

    Returns
    -------
    Last point before or at the zero where the loop begins, first point at or past its end.

    Examples
    --------
    >>> find_largest_loop(np.array([0.0, 1.0, 0.0, -3.0, -1.0, 2.0, 0.0, -1.0, 0.0]))
    (2, 6)
    """
    d = np.asarray(displacement, float)
    limit = NOISE * float(np.abs(d).max()) if len(d) else 0.0
    side = np.where(d > limit, 1, np.where(d < -limit, -1, 0))
    known = np.flatnonzero(side)
    if limit == 0.0:
        return None
    ends = np.flatnonzero(np.diff(side[known], prepend=0, append=0))  # excursions on one side
    peaks = [int(a + np.abs(d[a:b]).argmax()) for a, b in pairwise([*known[ends[:-1]], len(d)])]
    largest = int(np.argmax(np.abs(d[peaks])))
    neighbours = [k for k in (largest + 1, largest - 1) if 0 <= k < len(peaks)]
    around = {
        k: (_zero_before(d, peaks[k], limit), _zero_after(d, peaks[k], limit))
        for k in (largest, *neighbours)
    }
    closed = [k for k in neighbours if None not in around[k]]
    if None in around[largest] or not closed:
        return None
    other = max(closed, key=lambda k: abs(d[peaks[k]]))
    first, last = around[min(largest, other)][0], around[max(largest, other)][1]
    return None if first is None or last is None else (first, last)


def _zero_before(d: Floats, peak: int, limit: float) -> int | None:
    """Last point at or past zero before a peak; the first one if it is within the limit."""
    beyond = np.flatnonzero(d[:peak] * d[peak] <= 0.0)
    if len(beyond):
        return int(beyond[-1])
    return 0 if abs(d[0]) <= limit else None


def _zero_after(d: Floats, peak: int, limit: float) -> int | None:
    """First point at or past zero after a peak; the last one if it is within the limit."""
    beyond = np.flatnonzero(d[peak:] * d[peak] <= 0.0)
    if len(beyond):
        return int(peak + beyond[0])
    return len(d) - 1 if abs(d[-1]) <= limit else None


def largest_loop(
    displacement: Floats,
    force: Floats,
    work: Floats | None = None,
    *,
    area: float,
    total_rubber_thickness: float,
) -> LargestLoop | None:
    """Measures of the largest loop, cut at its zeros; None if there is none.

    Parameters
    ----------
    displacement, force : histories [mm, kN].
    work : done since the start [kN mm], where it is known better than from the points.
    area : gross plan area [mm2].
    total_rubber_thickness : [mm].

    Examples
    --------
    >>> angle = np.linspace(0.0, 6.0 * np.pi, 1201)
    >>> d = np.exp(-angle / 20.0) * 10.0 * np.sin(angle)
    >>> loop = largest_loop(d, 2.0 * d, area=1e4, total_rubber_thickness=20.0)
    >>> loop.first, loop.last, round(loop.measures.stiffness_kN_mm, 9)
    (0, 400, 2.0)
    """
    found = find_largest_loop(displacement)
    if found is None or found[1] - found[0] + 1 < FEWEST_POINTS:
        return None
    part = slice(found[0], found[1] + 1)
    histories = [np.array(displacement[part], float), np.array(force[part], float)]
    histories += [] if work is None else [np.array(work[part], float)]
    for end, inner in ((0, 1), (-1, -2)):
        outside, inside = histories[0][end], histories[0][inner]
        if outside * inside < 0.0:  # the last values are those where a straight line meets zero
            way = outside / (outside - inside)
            for values in histories:
                values[end] += way * (values[inner] - values[end])
            histories[0][end] = 0.0
    measures = measure_cycle(
        histories[0],
        histories[1],
        area=area,
        total_rubber_thickness=total_rubber_thickness,
        work=None if work is None else float(histories[2][-1] - histories[2][0]),
    )
    return LargestLoop(*found, measures)
