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
    """
    away = np.flatnonzero(np.abs(displacement) > AWAY * np.abs(displacement).max())
    return 1.0 if len(away) == 0 or displacement[away[0]] > 0.0 else -1.0


def cycles_of(record: TestRecord) -> list[Cycle]:
    """Full cycles of a record, zero to zero, each beginning to the side of the first move."""
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
    """Measures of every cycle of a record, with its own force or the model's."""
    side = first_side(record.displacement)
    return measure_history(
        side * record.displacement, side * force, area=area, total_rubber_thickness=rubber
    )
