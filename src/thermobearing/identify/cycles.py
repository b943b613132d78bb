"""Cycles of a record: where they are, which of them are the first of their amplitude."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.record import TestRecord
from thermobearing.results.metrics import CycleMeasures, find_cycles, measure_history

Floats = NDArray[np.float64]

SAME = 0.05  # amplitudes closer than this, relative, are one level
AWAY = 0.02  # of the largest displacement: moved at all
CLOSING = 0.25  # of the amplitude before: a smaller cycle stops the motion, and is no level


@dataclass(frozen=True)
class Cycle:
    """Samples first to last of one cycle; `number` counts within its amplitude, from 1."""

    first: int
    last: int
    amplitude: float  # [mm]
    number: int
    closing: bool


def first_side(displacement: Floats) -> float:
    """1.0 or -1.0: the side to which a history moves first.

    Cycles are cut where the motion comes back to that side: cut at the other crossings, a
    cycle would mix two amplitudes wherever the amplitude changes.

    Parameters
    ----------
    displacement : in any unit.

    Returns
    -------
    float : 1.0 where it moves to the positive side first, or not at all.

    Examples
    --------
    >>> first_side(np.array([0.0, 0.001, -1.0, 1.0]))
    -1.0
    """
    away = np.flatnonzero(np.abs(displacement) > AWAY * np.abs(displacement).max())
    return 1.0 if len(away) == 0 or displacement[away[0]] > 0.0 else -1.0


def cycles_of(record: TestRecord) -> list[Cycle]:
    """Full cycles of a record, zero to zero, each beginning to the side of the first move.

    Parameters
    ----------
    record : a test.

    Returns
    -------
    list of Cycle : in the order of time.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> x = np.sin(2.0 * np.pi * t)
    >>> [cycle.number for cycle in cycles_of(record_from_arrays(t, x, 2.0 * x, 23.0))]
    [1, 2]
    """
    found: list[Cycle] = []
    before, number = 0.0, 0
    side = first_side(record.displacement)
    for first, last in find_cycles(side * record.displacement):
        amplitude = 0.5 * float(np.ptp(record.displacement[first : last + 1]))
        closing = amplitude < CLOSING * before
        same = before > 0.0 and abs(amplitude / before - 1.0) < SAME
        number = number + 1 if same and not closing else 1
        if not closing:
            before = amplitude
        found.append(Cycle(first, last, amplitude, number, closing))
    return found


def measures_of(
    record: TestRecord, force: Floats, area: float, rubber: float
) -> list[CycleMeasures]:
    """Measures of every cycle of a record, with its own force or the model's.

    Parameters
    ----------
    record : a test.
    force : at its samples [kN].
    area : plan area [mm2], > 0.
    rubber : total rubber thickness [mm], > 0.

    Returns
    -------
    list of CycleMeasures : in the order of `cycles_of`.

    Raises
    ------
    InputError : a cycle with too few samples to be measured.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> record = record_from_arrays(t, np.sin(2.0 * np.pi * t), np.sin(2.0 * np.pi * t), 23.0)
    >>> round(measures_of(record, record.force, 1000.0, 1.0)[0].G_eq_MPa, 3)
    1.0
    """
    side = first_side(record.displacement)
    return measure_history(
        side * record.displacement, side * force, area=area, total_rubber_thickness=rubber
    )


def middles_of(values: Floats, cycles: list[Cycle]) -> Floats:
    """Half-way between the extremes of each loop that is no closing one.

    Parameters
    ----------
    values : force or displacement.
    cycles : from `cycles_of`.

    Returns
    -------
    ndarray : in the unit of `values`.

    Examples
    --------
    >>> middles_of(np.array([0.0, 3.0, 0.0, -1.0, 0.0]), [Cycle(0, 4, 1.0, 1, False)])
    array([1.])
    """
    loops = [values[cycle.first : cycle.last + 1] for cycle in cycles if not cycle.closing]
    return np.array([0.5 * (loop.max() + loop.min()) for loop in loops])


def zeros_of(values: Floats, cycles: list[Cycle]) -> Floats:
    """Middle of each loop, where the zero of a signal shows, free of what heating does to it.

    A rubber that softens makes the second side of each loop weaker than the first, by up to 1 %
    of the peak in the cold. So the first extreme is held against the mean of those before and
    after it. First cycles lean to their first side and have no say.

    Parameters
    ----------
    values : force or displacement.
    cycles : from `cycles_of`, in the order of time.

    Returns
    -------
    ndarray : in the unit of `values`, one for each cycle that is the third of its amplitude or
        later.

    Examples
    --------
    >>> angle = np.linspace(0.0, 8.0 * np.pi, 801)
    >>> softer = (1.0 - 0.002 * angle) * np.sin(angle) + 0.1
    >>> cycles = [Cycle(200 * k, 200 * k + 200, 1.0, k + 1, False) for k in range(4)]
    >>> zeros_of(softer, cycles).round(3)
    array([0.1, 0.1])
    """
    full = [cycle for cycle in cycles if not cycle.closing]
    ends = [_extremes(values[cycle.first : cycle.last + 1]) for cycle in full]
    found = []
    for k in range(1, len(full)):
        if full[k - 1].number >= 2 and full[k].number == full[k - 1].number + 1:
            found.append(0.5 * ends[k][0] + 0.25 * (ends[k - 1][1] + ends[k][1]))
    return np.array(found)


def _extremes(values: Floats) -> tuple[float, float]:
    """Those of a loop, in the order of time."""
    high, low = float(values.max()), float(values.min())
    return (high, low) if values.argmax() < values.argmin() else (low, high)
