"""Measures per cycle from displacement and force, whether simulated or measured.

Displacement and force carry the same sign, so a dissipating loop encloses positive work.

The excursion that holds the largest |displacement|, and of its neighbours on the other side the
one that reaches farther (the later of equal ones), make the largest loop. It begins at the last
zero displacement before the peak of the first excursion and ends at the first one after the
peak of the second. An excursion that the history does not bring back to zero is not closed, and
belongs to no loop; one within 2 % of the largest displacement is none. One that comes to
rest near zero, within half the largest displacement, ends where it first comes there.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.units import HUGEST
from thermobearing.core.records import Floats
from thermobearing.quantities.governing import TIE, place_of_largest, place_of_least
from thermobearing.results.loop import FIT_FROM, FIT_TO, measure_loop

# Smallest reference energy of a balance error. Sums of forces of up to 1e4 kN over
# millimetres are rounded by less than 1e-8 kN mm; temperatures near 100 degC by 1.4e-14 K a
# step, so that a million steps may lose what warms the bearing by 1e-8 K.
LEAST_ENERGY = 1e-6  # [kN mm]
LEAST_WARMING = 1e-4  # [K], mean of the bearing: 1 kN mm for one of 240 mm
LEAST_HEAT = 1.0  # [kN mm], the same where the heat capacity is not known
BALANCE = (  # energies of a bearing
    "work_in",
    "heat_released",
    "recoverable",
    "heat_stored",
    "heat_lost_ends",
    "heat_lost_sides",
)
DWELL, SHORTEST_DWELL = 0.02, 5  # points at zero that are a rest: part of all per cycle, and least
STRAIGHT = 0.05  # of the amplitude: path before a rest used to extrapolate the force
# Loops of high-damping rubber are curved: other definitions give other numbers, for instance
# K_d = (F_max - Q_d)/D of a bilinear loop through the same peak.
BACKBONE_DEFINITION = (
    "Q_d is half the difference of the forces at zero displacement, K_d the slope of loading "
    f"branches from {100.0 * FIT_FROM:.0f} to {100.0 * FIT_TO:.0f} % of the peak displacement"
)
THIRD_CYCLE = 3  # of an amplitude, whose properties codes take
FEWEST_POINTS = 8  # in a cycle that is measured; 5 (zeros and peaks) where its work is known


@dataclass(frozen=True)
class CycleMeasures:
    """Measures of one loop."""

    amplitude_mm: float  # half the range of displacement
    G_eq_MPa: float  # equivalent shear modulus, Eq. 3.1
    h_eq: float  # equivalent damping ratio E / (4 pi W), Eq. 3.2, W the elastic triangle
    energy_kN_mm: float  # area of the loop
    stiffness_kN_mm: float  # (|f_max| + |f_min|) / (|d_max| + |d_min|)
    characteristic_strength_kN: float  # half the difference of the forces at zero displacement
    post_yield_stiffness_kN_mm: float  # mean of both loading branches, 50 to 90 % of peak x
    force_max_kN: float
    force_min_kN: float
    displacement_max_mm: float
    displacement_min_mm: float


def loop_energy(displacement: Floats, force: Floats) -> float:
    """Return the work done over a path, by the trapezoidal rule [kN mm]."""
    return float(np.trapezoid(force, displacement))


def relative_residual(missing: Any, energies: Iterable[Any], least: float = LEAST_ENERGY) -> Any:
    """Return the error of an energy balance, relative to its largest energy [kN mm].

    Of one run, or of columns of runs.
    """
    if isinstance(missing, float):  # of one run: faster, in studies of very many runs
        sizes = [least, *map(abs, energies)]
        return missing / (max(sizes) if all(size == size for size in sizes) else math.nan)
    return missing / reduce(np.maximum, map(np.abs, energies), least)


def energy_balance(energies: Mapping[str, Any], *, capacity: float | None = None) -> dict[str, Any]:
    """Return the residuals of the mechanical and the thermal balance of a bearing.

    Parameters
    ----------
    energies : mapping
        Those that `BALANCE` names, each of one run or a column of runs [kN mm].
    capacity : float, optional
        Heat capacity of the bearing [kN mm/K], which gives the least heat of the thermal residual.
    """
    work, heat, recoverable, stored, ends, sides = (energies[name] for name in BALANCE)
    # A bearing that warms or cools to the ambient exchanges more heat than its work: the largest
    # energy is the scale of both residuals.
    largest = [work, stored, ends + sides]
    least_heat = LEAST_HEAT if capacity is None else LEAST_WARMING * capacity
    return {
        "mechanical_residual": relative_residual(work - heat - recoverable, largest),
        "thermal_residual": relative_residual(heat - stored - (ends + sides), largest, least_heat),
    }


def balance_row(energies: Mapping[str, float], *, capacity: float) -> dict[str, float]:
    """Return the energies of a bearing by their columns, and the residuals of `energy_balance`."""
    columns = {f"{name}_kN_mm": energies[name] for name in BALANCE}
    return columns | energy_balance(energies, capacity=capacity)


def measure_cycle(
    displacement: Floats,
    force: Floats,
    *,
    area: float,
    total_rubber_thickness: float,
    work: float | None = None,
    slope: bool = True,
) -> CycleMeasures:
    """Return the measures of one closed cycle, whose first point is repeated at the end.

    The histories are in mm and kN, the gross plan area in mm2, the rubber thickness in mm. `work`
    is the energy of the cycle where it is known better than from the points [kN mm]. Without
    `slope` the post-yield stiffness, which takes most of the time, is NaN.
    """
    d, f = _histories(displacement, force)
    if not area > 0.0 or not total_rubber_thickness > 0.0:
        raise InputError(f"area {area} mm2 and rubber {total_rubber_thickness} mm must be positive")
    fewest = FEWEST_POINTS if work is None else 5
    if len(d) < fewest:
        raise InputError(f"a cycle of {len(d)} points cannot be measured; {fewest} are needed")
    if d.min() == d.max():
        raise InputError("a cycle without displacement cannot be measured")
    d, f = np.ascontiguousarray(d), np.ascontiguousarray(f)
    energy = np.nan if work is None else float(work)
    size = float(area), float(total_rubber_thickness)
    return CycleMeasures(*measure_loop(d, f, *size, energy, bool(slope)))


@dataclass(frozen=True)
class FoundCycle:
    """Points `first` to `last`, the first one at or past zero, of a cycle, and how it ends."""

    first: int
    last: int
    ends: str  # "closed" if the motion goes on, "rest" if it stops at zero, else "incomplete"
    moving: int  # the last point before a rest, if there is one; else `last`
    side: float = 1.0  # to which it moves first, 1.0 or -1.0


def first_side(displacement: Floats, smallest: float = 0.02) -> float:
    """Return the side to which a history moves first, 1.0 or -1.0.

    Motions within `smallest` times the largest displacement do not count. Cycles are cut where the
    motion crosses zero to that side: cut at the other crossings, a cycle would mix two amplitudes
    wherever the amplitude changes.
    """
    sizes = np.abs(displacement)
    moved = np.flatnonzero(sizes > smallest * sizes.max()) if len(sizes) else sizes
    return 1.0 if len(moved) == 0 or displacement[moved[0]] > 0.0 else -1.0


def cut_cycles(
    displacement: Floats,
    *,
    smallest: float = 0.02,
    rests: Sequence[tuple[int, int]] = (),
    side: float | None = None,
) -> list[FoundCycle]:
    """Return the cycles of a displacement history [mm], and how each of them ends.

    A cycle runs from one crossing of zero to a `side`, 1.0 or -1.0, to the next one; by default to
    the side of the first motion. It must swing to both sides by more than `smallest` times the
    largest displacement, so that noise makes no cycles. It begins where the motion last leaves
    zero and ends where it first comes back: what happens at zero in between (a rest, in which the
    force relaxes) belongs to no cycle.
    """
    d = np.asarray(displacement, float)
    cut = first_side(d, smallest) if side is None else side
    d = cut * d  # below, cycles begin upwards
    limit = smallest * float(np.abs(d).max()) if len(d) else 0.0
    if limit == 0.0:
        return []
    # Which side the history is on, remembered while it is within the threshold of zero.
    sign = np.where(d > limit, 1, np.where(d < -limit, -1, 0))
    outside = np.flatnonzero(sign)
    turns = [(int(a), int(b)) for a, b in pairwise(outside) if sign[a] < sign[b]]
    if sign[outside[0]] > 0:
        # A history that begins upwards has no point below zero before its first crossing.
        turns = [(0, int(outside[0])), *turns]
    dwell = max(SHORTEST_DWELL, DWELL * len(d) / max(len(turns), 1))
    crossings = [_crossing(d, before, after, rests, dwell) for before, after in turns]
    # A cycle lasts from where the motion leaves zero to where it comes back at the next crossing.
    spans = [
        (departed, arrived, moving)
        for (_, departed, _), (arrived, _, moving) in pairwise(crossings)
    ]
    tail, end, incomplete = crossings[-1][1] if crossings else len(d), len(d) - 1, []
    outside_tail = tail + np.flatnonzero(sign[tail:])
    # After the last upward crossing there is a cycle only if the motion reaches the other side
    # and ends near zero, where no further crossing follows.
    if len(outside_tail) and (sign[tail:] < 0).any() and abs(d[-1]) <= limit:
        arrived, _, moving = _crossing(d, int(outside_tail[-1]), end, rests, dwell)
        spans.append((tail, end if moving is None else arrived, moving))
    elif len(outside_tail):
        incomplete.append(FoundCycle(tail, end, "incomplete", end, cut))
    return [
        FoundCycle(a, b, *(("closed", b) if moving is None else ("rest", moving)), cut)
        for a, b, moving in spans
        if d[a : b + 1].min() < -limit < limit < d[a : b + 1].max()
    ] + incomplete


def _crossing(
    d: Floats, before: int, after: int, rests: Sequence[tuple[int, int]], dwell: float
) -> tuple[int, int, int | None]:
    """Points at which the motion comes to zero and leaves it; if it rests, the last that moves.

    From a point on one side (`before`) to one on the other (`after`). Without a rest (known, or
    more than `dwell` points long) the cycles follow each other at once; points on the same spot
    belong to neither of them, since the logger may have slept between them.
    """
    path = d[before : after + 1]
    at_or_above, at_or_below = np.flatnonzero(path >= 0.0), np.flatnonzero(path <= 0.0)
    arrived = before + int(at_or_above[0]) if len(at_or_above) else after
    departed = before + int(at_or_below[-1]) if len(at_or_below) else before
    for first, last in rests:
        if before < first < last <= after:
            unsampled = last - first == 1  # no samples of the rest: its first point still moved
            arrival = min(arrived, first)
            return arrival, max(departed, last), arrival if unsampled else max(arrival - 1, before)
    if departed - arrived > dwell:
        return arrived, departed, max(arrived - 1, before)
    if departed > arrived and np.ptp(d[arrived : departed + 1]) == 0.0:
        return arrived, departed, None
    # The next cycle follows at once: this one ends at zero, or at the first point past it.
    return departed if d[departed] == 0.0 else min(departed + 1, after), departed, None


def find_cycles(displacement: Floats, *, smallest: float = 0.02) -> list[tuple[int, int]]:
    """Return the first and the last point of each full cycle of a history; see `cut_cycles`."""
    cycles = cut_cycles(displacement, smallest=smallest)
    return [(cycle.first, cycle.last) for cycle in cycles if cycle.ends != "incomplete"]


@checked
def measure_history(
    displacement: Floats,
    force: Floats,
    *,
    area: float,
    total_rubber_thickness: float,
    rests: Sequence[tuple[int, int]] = (),
    side: float | None = None,
) -> list[CycleMeasures]:
    """Return the measures of every full cycle of a history, simulated or from a laboratory.

    Parameters
    ----------
    displacement, force : histories [mm, kN].
    area : gross plan area [mm2].
    total_rubber_thickness : [mm].
    rests : first and last point of each, where they are known: a cycle ends where a rest begins.
    side : 1.0 or -1.0 [1], to which cycles begin; by default that of the first motion.

    Raises
    ------
    InputError : lists of different length or not of numbers, no full cycle in them, or another
        `side`.

    Examples
    --------
    >>> angle = np.linspace(0.0, 6.0 * np.pi, 1201)
    >>> d, f = 10.0 * np.sin(angle), 5.0 * np.sin(angle) + 2.0 * np.cos(angle)
    >>> len(measure_history(d, f, area=1e4, total_rubber_thickness=20.0))
    3
    """
    d, f = _histories(displacement, force)
    if side not in (None, 1.0, -1.0):
        raise InputError(f"side is {side}: must be 1.0 or -1.0, to which cycles begin")
    cycles = [
        cycle for cycle in cut_cycles(d, rests=rests, side=side) if cycle.ends != "incomplete"
    ]
    if not cycles:
        raise InputError("no full cycle (zero, one side, other side, zero) was found")
    size: dict[str, Any] = {"area": area, "total_rubber_thickness": total_rubber_thickness}
    return [measure_cycle(*closed_loop(d, f, cycle), **size) for cycle in cycles]


def _histories(displacement: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Return both as arrays; refuse all but equally long lists of finite numbers."""
    try:
        d, f = np.asarray(displacement, float), np.asarray(force, float)
    except (TypeError, ValueError, OverflowError):
        raise InputError("displacement and force must be lists of numbers") from None
    if d.ndim != 1 or d.shape != f.shape:
        raise InputError(f"displacement has {d.size} points but force {f.size}")
    for name, values in (("displacement", d), ("force", f)):
        if not np.isfinite(values).all():
            index = int(np.argmin(np.isfinite(values)))
            raise InputError(f"{name} is {values[index]} at point {index + 1}; must be finite")
        if len(values) and float(np.abs(values).max()) > HUGEST:
            raise InputError(f"{name} reaches {np.abs(values).max():g}, more than {HUGEST:g}")
    return d, f


def cut_at_zeros(displacement: Floats, *others: Floats) -> list[Floats]:
    """Return histories of a loop whose first and last point are moved to zero displacement.

    A point moves along the straight line to its neighbour if that is on the other side of zero.
    """
    histories = [np.array(values, float) for values in (displacement, *others)]
    for end, inner in ((0, 1), (-1, -2)):
        outside, inside = histories[0][end], histories[0][inner]
        if outside * inside < 0.0:
            share = outside / (outside - inside)
            for values in histories:
                values[end] += share * (values[inner] - values[end])
            histories[0][end] = 0.0
    return histories


def closed_loop(d: Floats, f: Floats, cycle: FoundCycle) -> tuple[Floats, Floats]:
    """Return displacement and force of a cycle, cut off at its crossings of zero.

    Its first and last intervals are shared with its neighbours; counted fully in both, a cycle
    of 200 points gains some 2 % of energy. One that ends in a rest is extrapolated to zero: the
    force is lost as soon as the motion stops, often within one interval of the logger.
    """
    rows = slice(cycle.first, (cycle.moving if cycle.ends == "rest" else cycle.last) + 1)
    d, f = cut_at_zeros(d[rows], f[rows])
    if cycle.ends == "rest" and d[-1] != 0.0:
        # Distance from the last point, towards the side of the second excursion.
        before_end = cycle.side * (d[-1] - d)
        far_points = np.flatnonzero(before_end >= STRAIGHT * float(np.abs(d).max()))
        slope = 0.0
        if len(far_points):
            far = far_points[-1]
            slope = (f[-1] - f[far]) / (d[-1] - d[far])
        d, f = np.append(d, 0.0), np.append(f, f[-1] - slope * d[-1])
    return d, f


RESTING = 0.1  # of a history, at its end: it is at rest there if it moves less than NOISE
LEFT = 0.5  # of the largest displacement: an excursion may come to rest at most this far from zero
NOISE = 0.02  # of the largest displacement: excursions within it are none


@dataclass(frozen=True)
class LargestLoop:
    """The largest loop: points `first` to `last`, just outside of it, and its measures."""

    first: int
    last: int
    measures: CycleMeasures


def find_largest_loop(displacement: Floats, tolerance: float = 0.0) -> tuple[int, int] | None:
    """Return the points just outside the largest loop; None if the largest displacement is in none.

    Measured excursions that are meant to be equal differ by `tolerance`, a part of the largest
    displacement; the first of them counts. 0 where none is measured.
    """
    d = np.asarray(displacement, float)
    if not len(d) or not d.any():
        return None
    sizes = np.abs(d)
    first = int((sizes >= (1.0 - tolerance) * sizes.max()).argmax())
    opposite = (d * d[first] < 0.0)[first:]  # on the other side
    end = first + int(opposite.argmax()) if opposite.any() else len(d)
    peak = first + place_of_largest(sizes[first:end]) if tolerance else place_of_largest(sizes)
    e = d / d[peak]  # 1 at the peak
    rests = not tolerance and np.ptp(e[-max(2, int(RESTING * len(e))) :]) < NOISE
    after = _excursions_after_peak(e[peak:], LEFT if rests else NOISE)
    before = _excursions_after_peak(e[peak::-1])
    if after.own_end is None or before.own_end is None:
        return None
    # The neighbour that reaches farther, the later of equal ones; depths within a rounding are
    # equal, so that the processor does not decide.
    if after.next_end is not None and (
        before.next_end is None or after.depth >= before.depth - TIE
    ):
        return peak - before.own_end, peak + after.next_end
    return None if before.next_end is None else (peak - before.next_end, peak + after.own_end)


class _Side(NamedTuple):
    """What follows a peak: where its excursion is back at zero, the next one and its end."""

    own_end: int | None
    depth: float
    next_end: int | None


def _excursions_after_peak(e: Floats, left: float = NOISE) -> _Side:
    """Along a history that begins at its peak, 1; the next excursion is that beyond -NOISE."""
    own_end = _back_at_zero(e, left)
    beyond = e < -NOISE
    first = int(beyond.argmax())
    if not beyond[first]:
        return _Side(own_end, 0.0, None)
    returned = e[first:] > NOISE
    stop = first + int(returned.argmax()) if returned.any() else len(e)
    deepest = first + place_of_least(e[first:stop])
    end = _back_at_zero(-e[deepest:], left)
    return _Side(own_end, float(-e[deepest]), None if end is None else deepest + end)


def _back_at_zero(e: Floats, left: float) -> int | None:
    """First point at or past zero of an excursion, or at its end if that is less than `left`."""
    past = e <= 0.0
    # Only an excursion that never comes back to zero ends beside it: where the history comes to
    # rest says nothing about the excursions before.
    if not past.any() and e[-1] <= left:
        past = e <= e[-1]
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
    """Return the measures of the largest loop, cut at its zeros; None if there is none.

    Histories in mm and kN; `work` since the start where it is known [kN mm].
    """
    points = find_largest_loop(displacement)
    if points is None or points[1] - points[0] + 1 < FEWEST_POINTS:
        return None
    part = slice(points[0], points[1] + 1)
    columns = [displacement, force] if work is None else [displacement, force, work]
    histories = cut_at_zeros(*(values[part] for values in columns))
    energy = None if work is None else float(histories[2][-1] - histories[2][0])
    size: dict[str, Any] = {"area": area, "total_rubber_thickness": total_rubber_thickness}
    # The slope of a loop among others says little.
    return LargestLoop(*points, measure_cycle(*histories[:2], **size, work=energy, slope=False))
