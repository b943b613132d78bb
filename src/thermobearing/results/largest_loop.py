"""The largest loop of a history that is no test: the one that holds the largest displacement.

The excursion that holds the largest |displacement|, and of its neighbours on the other side the
one that reaches farther (the later of equal ones), make the largest loop. It begins at the last
zero displacement before the peak of the first excursion and ends at the first one after the
peak of the second. An excursion that the history does not bring back to zero is not closed, and
belongs to no loop; one within 2 % of the largest displacement is none. One that comes to
rest beside zero, nearer than half the largest displacement, ends where it first comes there.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.results.metrics import FEWEST_POINTS, CycleMeasures, measure_cycle

Floats = NDArray[np.float64]
RESTING = 0.1  # of a history, at its end: it is at rest there if it moves less than NOISE
LEFT = 0.5  # of the largest displacement: as far beside zero an excursion may come to rest
NOISE = 0.02  # of the largest displacement: excursions within it are none


@dataclass(frozen=True)
class LargestLoop:
    """Points `first` to `last` of the history, just outside the loop, and its measures."""

    first: int
    last: int
    measures: CycleMeasures


def find_largest_loop(displacement: Floats, alike: float = 0.0) -> tuple[int, int] | None:
    """First and last point of the largest loop; None if no loop holds the largest displacement.

    Parameters
    ----------
    displacement : history [mm].
    alike : part of the largest displacement by which measured excursions differ although they are
        meant to be one: the first of them counts. 0 where none is measured.

    Returns
    -------
    Last point before or at the zero where the loop begins, first point at or past its end.

    Examples
    --------
    >>> find_largest_loop(np.array([0.0, 1.0, 0.0, -3.0, -1.0, 2.0, 0.0, -1.0, 0.0]))
    (2, 6)
    """
    d = np.asarray(displacement, float)
    if not len(d) or not d.any():
        return None
    ways = np.abs(d)
    first = int((ways >= (1.0 - alike) * ways.max()).argmax())
    other = (d * d[first] < 0.0)[first:]  # on the other side
    end = first + int(other.argmax()) if other.any() else len(d)
    peak = first + int(ways[first:end].argmax()) if alike else int(ways.argmax())
    e = d / d[peak]  # 1 at the peak
    rests = not alike and np.ptp(e[-max(2, int(RESTING * len(e))) :]) < NOISE
    after, before = _look_from(e[peak:], LEFT if rests else NOISE), _look_from(e[peak::-1])
    if after.own_end is None or before.own_end is None:
        return None
    if after.next_end is not None and (before.next_end is None or after.depth >= before.depth):
        return peak - before.own_end, peak + after.next_end
    if before.next_end is not None:
        return peak - before.next_end, peak + after.own_end
    return None


class _Side(NamedTuple):
    """What follows a peak: where its excursion is back at zero, the next one and its end."""

    own_end: int | None
    depth: float
    next_end: int | None


def _look_from(e: Floats, left: float = NOISE) -> _Side:
    """Along a history that begins at its peak, 1; the next excursion is that beyond -NOISE."""
    own_end = _back_at_zero(e, left)
    beyond = e < -NOISE
    first = int(beyond.argmax())
    if not beyond[first]:
        return _Side(own_end, 0.0, None)
    back = e[first:] > NOISE
    stop = first + int(back.argmax()) if back.any() else len(e)
    deepest = first + int(e[first:stop].argmin())
    end = _back_at_zero(-e[deepest:], left)
    return _Side(own_end, float(-e[deepest]), None if end is None else deepest + end)


def _back_at_zero(e: Floats, left: float) -> int | None:
    """First point at or past zero of an excursion, or at its end if that is less than `left`."""
    past = e <= max(0.0, e[-1] if e[-1] <= left else 0.0)
    first = int(past.argmax())
    return first if past[first] else None


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
        slope=False,  # of a loop among others it says little
    )
    return LargestLoop(*found, measures)
