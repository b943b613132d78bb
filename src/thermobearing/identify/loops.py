"""Loops of a test and of a model beside each other: every full cycle, and the largest loop."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.cycles import cycles_of
from thermobearing.identify.record import TestRecord
from thermobearing.results.largest_loop import find_largest_loop
from thermobearing.results.metrics import loop_energy

Floats = NDArray[np.float64]

ALIKE = 0.01  # of the largest displacement: noise, and samples that miss a turn by so much
SMOOTHED = 20  # running means of a loop over a twentieth of it, for its peaks


@dataclass(frozen=True)
class Loop:
    """One loop of a test and of the model.

    Attributes
    ----------
    first, last : samples.
    cycle, number : of the record, and within its amplitude, from 1; 0 where it is no full cycle.
    amplitude : of the displacement [mm]; that of the test moves the model.
    displacement_max, displacement_min : D+ and D- [mm].
    test, model : F+ and F- [kN], K_eq [kN/mm], h_eq and energy [kN mm], by name.
    """

    first: int
    last: int
    cycle: int
    number: int
    amplitude: float
    displacement_max: float
    displacement_min: float
    test: dict[str, float]
    model: dict[str, float]

    @property
    def ratios(self) -> dict[str, float]:
        """Model over test."""
        return {name: self.model[name] / value for name, value in self.test.items()}

    @property
    def peak_ratio(self) -> float:
        """Model over test, of the largest force to either side."""
        model, test = (max(abs(side["F+"]), abs(side["F-"])) for side in (self.model, self.test))
        return model / test


def loops_of(record: TestRecord, force: Floats) -> list[Loop]:
    """Full cycles of a record, measured in the test and in the model.

    Parameters
    ----------
    record : a test.
    force : of the model at its samples [kN].

    Returns
    -------
    list of Loop : in the order of time; without closing cycles and those that do no work.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> x, f = 30.0 * np.sin(2.0 * np.pi * t), 60.0 * np.sin(2.0 * np.pi * t + 0.3)
    >>> (loop,) = loops_of(record_from_arrays(t, x, f, 23.0), 1.1 * f)
    >>> {name: round(ratio, 3) for name, ratio in loop.ratios.items()}
    {'F+': 1.1, 'F-': 1.1, 'K_eq': 1.1, 'h_eq': 1.0, 'energy': 1.1}
    """
    found = []
    for place, cycle in enumerate(cycles_of(record), start=1):
        loop = _loop(record, force, cycle.first, cycle.last)
        if not cycle.closing and loop.test["energy"] > 0.0:
            found.append(replace(loop, cycle=place, number=cycle.number))
    return found


def largest_of(record: TestRecord, force: Floats, loops: list[Loop]) -> Loop | None:
    """The largest loop of a record (results/largest_loop.py), in the test and in the model.

    Of loops as large as it but for 1 % the first: noise does not choose between a first cycle and
    a later one.

    Parameters
    ----------
    record : a test.
    force : of the model at its samples [kN].
    loops : from `loops_of`; the one of the same samples is given again, as it is.

    Returns
    -------
    Loop, or None where no loop holds the largest displacement, or the one that does has no work.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 3.0, 3001)
    >>> x = np.exp(-t) * np.sin(2.0 * np.pi * t)
    >>> record = record_from_arrays(t, x, 2.0 * x + 0.5 * np.gradient(x, t), 23.0)
    >>> largest_of(record, record.force, loops_of(record, record.force)).cycle
    1
    """
    found = find_largest_loop(record.displacement, ALIKE)
    if found is None:
        return None
    for loop in loops:  # which may begin a sample later, inside its zeros
        if abs(loop.first - found[0]) <= 1 and abs(loop.last - found[1]) <= 1:
            return loop
    loop = _loop(record, force, *found)
    return loop if loop.test["energy"] > 0.0 else None


def _loop(record: TestRecord, force: Floats, first: int, last: int) -> Loop:
    rows = slice(first, last + 1)
    x = record.displacement[rows]
    high, low = float(x.max()), float(x.min())
    test, model = _measures(x, record.force[rows]), _measures(x, force[rows])
    return Loop(first, last, 0, 0, 0.5 * (high - low), high, low, test, model)


def _measures(x: Floats, force: Floats) -> dict[str, float]:
    """K_eq and h_eq as in Eq. 3.1 and 3.2."""
    high, low = _peaks(force)
    span = float(np.ptp(x))
    stiffness, energy = (high - low) / span, loop_energy(x, force)
    damping = 2.0 * energy / (np.pi * stiffness * span**2)
    return {"F+": high, "F-": low, "K_eq": stiffness, "h_eq": damping, "energy": energy}


def _peaks(force: Floats) -> tuple[float, float]:
    """Highest and lowest force of a loop, of a short running mean: noise adds to extremes."""
    window = max(1, len(force) // SMOOTHED)
    mean = np.convolve(force, np.full(window, 1.0 / window), "valid")
    return float(mean.max()), float(mean.min())
