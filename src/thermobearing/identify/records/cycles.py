"""Noise, reversals and cycles of a record, and its loops in the test and in the model."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.records import Floats, Ints
from thermobearing.identify.records.record import TestRecord
from thermobearing.results.loop import measure_loop
from thermobearing.results.metrics import (
    CycleMeasures,
    FoundCycle,
    closed_loop,
    cut_cycles,
    find_largest_loop,
    measure_history,
)

# Sixth differences remove smooth signals: of a sine with 40 samples per cycle they leave 1e-5,
# second differences 2 %, more than the noise to be measured.
ORDER = 6
GAIN = math.sqrt(math.comb(2 * ORDER, ORDER))  # of their standard deviation, over white noise
NORMAL = 1.4826  # standard deviation over median absolute deviation of normal noise
NONE = 1e-6  # of the peak: rounding, not noise
TURN = 0.005  # of the largest displacement: smaller fluctuations are noise, not reversals
DEAD = 10.0  # of the noise of the displacement: five below to five above, 1 sample in 2e6
LARGEST_DEAD = 0.02  # of the largest displacement: larger fluctuations are not noise
SAME = 0.05  # amplitudes closer than this, relative, are one level
CLOSING = 0.25  # of the amplitude before: a smaller cycle stops the motion and is no level
MOSTLY = 0.9  # of the samples of a loop and a cycle: they are the same
ALIKE = 0.01  # of the largest displacement: noise, and reversals between two samples
PART_OF_LEG = 0.5  # of the amplitude: larger motions back and forth are legs


def estimate_noise(values: Floats) -> float:
    """Return the standard deviation of the noise of a signal; 0 without noise.

    It comes from the median absolute sixth difference, which neither the motion nor spikes move.
    """
    if len(values) <= ORDER + 1:
        return 0.0
    noise = NORMAL * float(np.median(np.abs(np.diff(values, ORDER)))) / GAIN
    return noise if noise > NONE * float(np.abs(values).max()) else 0.0


def split_runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first and last sample of each run of flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def turning_points(x: Floats, threshold: float) -> Ints:
    """Return the first and last sample, and those between where the motion turns.

    Fluctuations smaller than `threshold`, in the unit of `x`, are noise.
    """
    turns, extreme, rising = [0], 0, 0
    values = x.tolist()
    for i, value in enumerate(values):
        # The extreme of a leg moves on until the signal is back by the threshold: then it was a
        # turn.
        if (rising >= 0 and value > values[extreme]) or (rising <= 0 and value < values[extreme]):
            extreme = i
        elif rising >= 0 and value < values[extreme] - threshold:
            turns.append(extreme)
            extreme, rising = i, -1
        elif rising <= 0 and value > values[extreme] + threshold:
            turns.append(extreme)
            extreme, rising = i, 1
        # The first leg has a direction once the motion exceeds the noise.
        if rising == 0 and abs(values[extreme] - values[0]) > threshold:
            rising = 1 if values[extreme] > values[0] else -1
    return np.unique([*turns, len(values) - 1]).astype(np.int64)


def dead_band(x: Floats, noise: float | None = None) -> float:
    """Return the motion below which a displacement is jitter [mm]; 0 without noise.

    `noise` is that of the displacement [mm], estimated by default.
    """
    noise = estimate_noise(x) if noise is None else noise
    return min(DEAD * noise, LARGEST_DEAD * float(np.abs(x).max()))


@dataclass(frozen=True)
class Cycle:
    """Samples first to last of one cycle; `number` counts within its amplitude, from 1."""

    first: int
    last: int
    amplitude: float  # [mm]
    number: int
    closing: bool


def closing_cycles(amplitudes: Sequence[float]) -> list[bool]:
    """Return which cycles stop the motion after a level, from the amplitudes in their order [mm].

    >>> closing_cycles([15.0, 15.0, 3.0, 30.0])
    [False, False, True, False]
    """
    flags, level = list[bool](), 0.0
    for amplitude in amplitudes:
        flags.append(amplitude < CLOSING * level)
        level = level if flags[-1] else amplitude
    return flags


def full_cycles(record: TestRecord) -> list[Cycle]:
    """Return the full cycles, from zero to zero, each beginning to the side of the first move."""
    return [cycle for _, cycle in _numbered_cycles(record)]


def _numbered_cycles(record: TestRecord) -> list[tuple[FoundCycle, Cycle]]:
    """Return where each full cycle begins and ends, whether in a rest, and its level."""
    x, cycles = record.displacement, list[tuple[FoundCycle, Cycle]]()
    places = [place for place in cut_cycles(x) if place.ends != "incomplete"]
    amplitudes = [0.5 * float(np.ptp(x[ends.first : ends.last + 1])) for ends in places]
    last_amplitude, number = 0.0, 0
    rows = zip(places, amplitudes, closing_cycles(amplitudes), strict=True)
    for ends, amplitude, closing in rows:
        # Closing cycles do not change the level: the next cycle is compared with the one before
        # them.
        same = last_amplitude > 0.0 and abs(amplitude / last_amplitude - 1.0) < SAME
        number = number + 1 if same and not closing else 1
        if not closing:
            last_amplitude = amplitude
        cycles.append((ends, Cycle(ends.first, ends.last, amplitude, number, closing)))
    return cycles


def level_amplitudes(record: TestRecord) -> dict[int, float]:
    """Return the amplitude [mm] of each full cycle by its number in the record, from 0.

    Closing cycles stop the motion and belong to no level. As the only amplitude that tests have in
    common they would stand for the bearing, at a tenth of the strain of the levels.
    """
    return {
        number: cycle.amplitude
        for number, cycle in enumerate(full_cycles(record))
        if not cycle.closing
    }


def property_cycles(amplitudes: Sequence[Mapping[int, float]]) -> list[list[int]]:
    """Return the numbers of the cycles of each test that its properties are means over."""
    common = [
        size
        for size in amplitudes[0].values()
        if all(
            any(abs(amplitude / size - 1.0) < SAME for amplitude in test.values())
            for test in amplitudes
        )
    ]
    places = []
    for test in amplitudes:
        size = max(common) if common else max(test.values())
        same_amplitude = [
            number for number, amplitude in test.items() if abs(amplitude / size - 1.0) < SAME
        ]
        # The first cycle of an amplitude is stiffer (scragging) and is left out if there are more.
        places.append(same_amplitude[1:] or same_amplitude)
    return places


def compute_measures(
    record: TestRecord, force: Floats, area: float, rubber: float
) -> list[CycleMeasures]:
    """Return the measures of each full cycle, with the force [kN] of the test or of the model."""
    return measure_history(record.displacement, force, area=area, total_rubber_thickness=rubber)


class Zeros(NamedTuple):
    """The zero of a signal in the course of a record."""

    times: Floats  # [s]
    values: Floats  # [mm or kN]


def measure_zeros(record: TestRecord, name: str, cycles: list[Cycle]) -> Zeros:
    """Return the zero of the force or of the displacement, from legs that follow each other.

    A symmetric bearing has opposite mean forces, over the displacement, in legs to opposite sides.
    Rubber that softens makes each leg weaker than the one before it. The mean of three legs with
    the weights 1/4, 1/2 and 1/4 is free of a softening that is linear in their number, which the
    middle of a loop is not: in the first loop it is up to 2 % of the peak.

    The first three legs of an amplitude, which contain virgin rubber, count only where there are
    no others. A single cycle has one complete leg: halves of two legs take its place.
    """
    values, times, zeros = getattr(record, name), list[float](), list[float]()
    for first, last, amplitude in _levels(cycles):
        x = record.displacement[first : last + 1]
        turns = first + turning_points(x, PART_OF_LEG * amplitude)[1:-1]
        legs = list(pairwise(turns.tolist()))
        if len(legs) == 1:
            (begin, end) = legs[0]
            lengths = (0.5 * abs(x[end - first] - x[begin - first]), abs(x[-1] - x[end - first]))
            means = [
                _mean_over_displacement(record.displacement, values, leg, min(lengths))
                for leg in (legs[0], (end, last))
            ]
            times.append(float(record.time[end]))
            zeros.append(0.5 * sum(means))
            continue
        means = [_mean_over_displacement(record.displacement, values, leg) for leg in legs]
        windows = range(1, len(means) - 1)
        for k in windows[1:] or windows:
            begin, end = legs[k]
            times.append(0.5 * float(record.time[begin] + record.time[end]))
            zeros.append(0.5 * means[k] + 0.25 * (means[k - 1] + means[k + 1]))
    return Zeros(np.array(times), np.array(zeros))


def _levels(cycles: list[Cycle]) -> Iterator[tuple[int, int, float]]:
    """Yield the first and last sample of each row of cycles with one amplitude, and that [mm]."""
    full = [cycle for cycle in cycles if not cycle.closing]
    starts = np.cumsum([cycle.number == 1 for cycle in full])
    for _, pairs in groupby(zip(starts, full, strict=True), key=lambda pair: pair[0]):
        level = [cycle for _, cycle in pairs]
        yield level[0].first, level[-1].last, level[0].amplitude


def _mean_over_displacement(
    x: Floats, values: Floats, leg: tuple[int, int], length: float | None = None
) -> float:
    """Return the mean of a signal over the displacement of a leg, or over its first `length`."""
    rows = slice(leg[0], leg[1] + 1)
    travel = np.maximum.accumulate(np.abs(x[rows] - x[leg[0]]))
    length = float(travel[-1]) if length is None else length
    inside = travel < length
    places = np.append(travel[inside], length)
    heights = np.append(values[rows][inside], np.interp(length, travel, values[rows]))
    return float(np.trapezoid(heights, places) / length)


def loop_middles(values: Floats, cycles: list[Cycle]) -> Floats:
    """Return the mean of the extremes of a signal in each loop but closing ones."""
    loops = [values[cycle.first : cycle.last + 1] for cycle in cycles if not cycle.closing]
    return np.array([0.5 * (loop.max() + loop.min()) for loop in loops])


@dataclass(frozen=True)
class Loop:
    """One loop of a test and of the model, which follows the measured displacement.

    `test` and `model` hold F+ and F- [kN], K_eq [kN/mm], h_eq and energy [kN mm]; `strengths` is
    Q_d [kN] of the test and of the model, half the difference of the forces at zero displacement.
    """

    first: int  # sample
    last: int
    cycle: int  # of the record, from 1; 0 if it is no full cycle
    number: int  # within its amplitude, from 1; 0 if it is no full cycle
    amplitude: float  # [mm]
    displacement_max: float  # D+ [mm]
    displacement_min: float  # D- [mm]
    test: dict[str, float]
    model: dict[str, float]
    strengths: tuple[float, float]

    @property
    def ratios(self) -> dict[str, float]:
        """Model / test."""
        return {name: self.model[name] / value for name, value in self.test.items()}

    @property
    def model_measures(self) -> dict[str, float]:
        """Force of the model [kN], the larger of both sides; K_eq [kN/mm], h_eq, Q_d, energy."""
        return {
            "force": max(abs(self.model["F+"]), abs(self.model["F-"])),
            "K_eq": self.model["K_eq"],
            "h_eq": self.model["h_eq"],
            "Q_d": self.strengths[1],
            "energy": self.model["energy"],
        }

    @property
    def errors(self) -> dict[str, float]:
        """Model / test - 1 of G_e, h_eq, energy and the largest force on either side."""
        ratios = self.ratios
        test = max(abs(self.test["F+"]), abs(self.test["F-"]))
        model = self.model_measures["force"]
        return {
            "G_eq_error": ratios["K_eq"] - 1.0,  # displacements are the same, and cancel
            "h_eq_error": ratios["h_eq"] - 1.0,
            "energy_error": ratios["energy"] - 1.0,
            "force_max_error": model / test - 1.0,
        }

    def row(self, *, largest: bool) -> dict[str, Any]:
        """Return a row of cycles.csv: the test, the model, and the ratio of the two."""
        row: dict[str, Any] = {
            "cycle": self.cycle,
            "number": self.number,
            "largest": largest,
            "D+_mm": self.displacement_max,
            "D-_mm": self.displacement_min,
        }
        for name, ratio in self.ratios.items():
            row[f"{name}_test"] = self.test[name]
            row[f"{name}_model"] = self.model[name]
            row[f"{name}_ratio"] = ratio
        row["Q_d_test"], row["Q_d_model"] = self.strengths
        return row


def compare_loops(record: TestRecord, force: Floats) -> tuple[list[Loop], Loop | None]:
    """Return the full cycles of a record in the test and in the model, and the largest loop.

    `force` is the model's at the samples [kN]. Closing cycles and loops that dissipate no energy
    are left out. The largest loop is the first of those within 1 % of the largest, so that noise
    does not choose between a first cycle and a later one. It may be no full cycle; None without
    one.
    """
    signals, cycles = _signals(record, force), _numbered_cycles(record)
    loops = {
        place: _loop(signals, ends, place, cycle.number)
        for place, (ends, cycle) in enumerate(cycles, start=1)
        if not cycle.closing
    }
    loops = {place: loop for place, loop in loops.items() if loop.test["energy"] > 0.0}
    return list(loops.values()), _largest_loop(signals, cycles, loops)


def largest_measures(record: TestRecord, force: Floats) -> dict[str, float]:
    """Return the measures of the model in the largest loop, and its peak force in the record.

    `force` is the model's at the samples of the record [kN]. The loop is that of `compare_loops`; a
    record without a loop has a peak force only.
    """
    loop = _largest_loop(_signals(record, force), _numbered_cycles(record), {})
    measures = {} if loop is None else loop.model_measures
    return measures | {"force": float(np.abs(force).max())}


class _Signals(NamedTuple):
    """A record and the force of the model."""

    displacement: Floats  # [mm]
    test: Floats  # [kN]
    model: Floats


def _signals(record: TestRecord, force: Floats) -> _Signals:
    return _Signals(record.displacement, record.force, force)


def _largest_loop(
    signals: _Signals, cycles: Sequence[tuple[FoundCycle, Cycle]], measured: Mapping[int, Loop]
) -> Loop | None:
    """Return the largest loop; `measured` are loops of cycles, by their places from 1."""
    largest = find_largest_loop(signals.displacement, ALIKE)
    if largest is None:
        return None
    # A full cycle whose excursions are those of the largest loop is that loop. Their first samples
    # may differ: noise crosses zero more than once.
    for place, (ends, cycle) in enumerate(cycles, start=1):
        shared = min(ends.last, largest[1]) - max(ends.first, largest[0])
        longer = max(ends.last - ends.first, largest[1] - largest[0])
        if not cycle.closing and shared > MOSTLY * longer:
            loop = measured.get(place) or _loop(signals, ends, place, cycle.number)
            if loop.test["energy"] > 0.0:
                return loop
    loop = _loop(signals, FoundCycle(*largest, "closed", largest[1]))
    return loop if loop.test["energy"] > 0.0 else None


def _loop(signals: _Signals, ends: FoundCycle, cycle: int = 0, number: int = 0) -> Loop:
    x = signals.displacement[ends.first : ends.last + 1]
    high, low = float(x.max()), float(x.min())
    test, test_strength = _measures(signals, signals.test, ends)
    model, strength = _measures(signals, signals.model, ends)
    return Loop(
        ends.first,
        ends.last,
        cycle,
        number,
        0.5 * (high - low),
        high,
        low,
        test,
        model,
        (test_strength, strength),
    )


def _measures(signals: _Signals, force: Floats, ends: FoundCycle) -> tuple[dict[str, float], float]:
    """Return the extreme forces, K_eq and h_eq (Eq. 3.1, 3.2), energy and Q_d of a loop.

    They are those of `measure`, between the same zeros; `force` is one of the signals.
    """
    x, f = closed_loop(signals.displacement, force, ends)
    # The size of the bearing matters to G_e only.
    loop = CycleMeasures(*measure_loop(x, f, 1.0, 1.0, math.nan, False))
    measures = {
        "F+": loop.force_max_kN,
        "F-": loop.force_min_kN,
        "K_eq": loop.stiffness_kN_mm,
        "h_eq": loop.h_eq,
        "energy": loop.energy_kN_mm,
    }
    return measures, loop.characteristic_strength_kN
