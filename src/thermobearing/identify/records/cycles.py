"""Cycles and loops of a record."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.records.record import TestRecord
from thermobearing.results.metrics import (
    CycleMeasures,
    find_cycles,
    find_largest_loop,
    loop_energy,
    measure_history,
)

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


def _first_side(displacement: Floats) -> float:
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
    >>> _first_side(np.array([0.0, 0.001, -1.0, 1.0]))
    -1.0
    """
    away = np.flatnonzero(np.abs(displacement) > AWAY * np.abs(displacement).max())
    return 1.0 if len(away) == 0 or displacement[away[0]] > 0.0 else -1.0


def full_cycles(record: TestRecord) -> list[Cycle]:
    """Full cycles of a record, zero to zero, each beginning to the side of the first move.

    Parameters
    ----------
    record : a test.

    Returns
    -------
    list of Cycle : in the order of time.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> x = np.sin(2.0 * np.pi * t)
    >>> [cycle.number for cycle in full_cycles(record_from_arrays(t, x, 2.0 * x, 23.0))]
    [1, 2]
    """
    found: list[Cycle] = []
    before, number = 0.0, 0
    side = _first_side(record.displacement)
    for first, last in find_cycles(side * record.displacement):
        amplitude = 0.5 * float(np.ptp(record.displacement[first : last + 1]))
        closing = amplitude < CLOSING * before
        same = before > 0.0 and abs(amplitude / before - 1.0) < SAME
        number = number + 1 if same and not closing else 1
        if not closing:
            before = amplitude
        found.append(Cycle(first, last, amplitude, number, closing))
    return found


def compute_measures(
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
    list of CycleMeasures : in the order of `full_cycles`.

    Raises
    ------
    InputError : a cycle with too few samples to be measured.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> record = record_from_arrays(t, np.sin(2.0 * np.pi * t), np.sin(2.0 * np.pi * t), 23.0)
    >>> round(compute_measures(record, record.force, 1000.0, 1.0)[0].G_eq_MPa, 3)
    1.0
    """
    side = _first_side(record.displacement)
    return measure_history(
        side * record.displacement, side * force, area=area, total_rubber_thickness=rubber
    )


def loop_middles(values: Floats, cycles: list[Cycle]) -> Floats:
    """Half-way between the extremes of each loop that is no closing one.

    Parameters
    ----------
    values : force or displacement.
    cycles : from `full_cycles`.

    Returns
    -------
    ndarray : in the unit of `values`.

    Examples
    --------
    >>> loop_middles(np.array([0.0, 3.0, 0.0, -1.0, 0.0]), [Cycle(0, 4, 1.0, 1, False)])
    array([1.])
    """
    loops = [values[cycle.first : cycle.last + 1] for cycle in cycles if not cycle.closing]
    return np.array([0.5 * (loop.max() + loop.min()) for loop in loops])


def loop_zeros(values: Floats, cycles: list[Cycle]) -> Floats:
    """Middle of each loop, where the zero of a signal shows, free of what heating does to it.

    A rubber that softens makes the second side of each loop weaker than the first, by up to 1 %
    of the peak in the cold. So the first extreme is held against the mean of those before and
    after it. First cycles lean to their first side and have no say.

    Parameters
    ----------
    values : force or displacement.
    cycles : from `full_cycles`, in the order of time.

    Returns
    -------
    ndarray : in the unit of `values`, one for each cycle that is the third of its amplitude or
        later.

    Examples
    --------
    >>> angle = np.linspace(0.0, 8.0 * np.pi, 801)
    >>> softer = (1.0 - 0.002 * angle) * np.sin(angle) + 0.1
    >>> cycles = [Cycle(200 * k, 200 * k + 200, 1.0, k + 1, False) for k in range(4)]
    >>> loop_zeros(softer, cycles).round(3)
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


def compare_loops(record: TestRecord, force: Floats) -> list[Loop]:
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
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> x, f = 30.0 * np.sin(2.0 * np.pi * t), 60.0 * np.sin(2.0 * np.pi * t + 0.3)
    >>> (loop,) = compare_loops(record_from_arrays(t, x, f, 23.0), 1.1 * f)
    >>> {name: round(ratio, 3) for name, ratio in loop.ratios.items()}
    {'F+': 1.1, 'F-': 1.1, 'K_eq': 1.1, 'h_eq': 1.0, 'energy': 1.1}
    """
    found = []
    for place, cycle in enumerate(full_cycles(record), start=1):
        loop = _loop(record, force, cycle.first, cycle.last)
        if not cycle.closing and loop.test["energy"] > 0.0:
            found.append(replace(loop, cycle=place, number=cycle.number))
    return found


def compare_largest_loops(record: TestRecord, force: Floats, loops: list[Loop]) -> Loop | None:
    """The largest loop of a record (results/largest_loop.py), in the test and in the model.

    Of loops as large as it but for 1 % the first: noise does not choose between a first cycle and
    a later one.

    Parameters
    ----------
    record : a test.
    force : of the model at its samples [kN].
    loops : from `compare_loops`; the one of the same samples is given again, as it is.

    Returns
    -------
    Loop, or None where no loop holds the largest displacement, or the one that does has no work.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 3.0, 3001)
    >>> x = np.exp(-t) * np.sin(2.0 * np.pi * t)
    >>> record = record_from_arrays(t, x, 2.0 * x + 0.5 * np.gradient(x, t), 23.0)
    >>> compare_largest_loops(record, record.force, compare_loops(record, record.force)).cycle
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
