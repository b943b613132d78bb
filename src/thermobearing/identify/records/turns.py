"""Turns of a motion that are between two samples, and whether the samples resolve them.

After a turn the loop is steep: within the displacement d_y the force changes by twice its
strength. A record of triangular cycles cuts up to half a step off each tip, and a model that is
driven through its samples alone turns too early, at each tip by another way.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from thermobearing.core.records import Floats, Ints
from thermobearing.identify.records.cycles import (
    NONE,
    SAME,
    TURN,
    dead_band,
    estimate_noise,
    full_cycles,
    turning_points,
)
from thermobearing.identify.records.record import TestRecord
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.words import joined, number, percent

LINES = (6, 4, 2)  # samples beside a turn through which a straight line is put; in short legs fewer
ROUNDED = 0.05  # of the largest cut: mean way of samples at turns from the lines
ALIKE_SPEED = 0.15  # of legs of one cycle, relative
EVEN = 1.5  # largest over median interval of these samples and the turn
STRAIGHT = 0.05  # of a step, or ...
SCATTER = 2.0  # ... of the noise: scatter about a straight line
STEEP = 4.0  # of the noise: shorter steps do not show whether a turn is sharp
SURELY_STEEP = 5.0  # of the noise: of shorter steps, some by chance do not exceed STEEP
NOISY = 3.0  # of the noise: a sample beyond its place
REVERSAL = 0.05  # of the largest displacement: between larger legs, steps are measured
CLOSE = 1.1  # of the largest step: no one records a test again at a rate that is a little higher
RESOLVED = 0.25  # of d_y: step at a reversal that resolves the tip of a loop, whatever its shape


class Turn(NamedTuple):
    """A sharp turn of the motion, which may be between two samples."""

    before: int  # the sample at or before the turn
    time: float  # [s]
    displacement: float  # [mm]
    cut: float  # way from the turn to the nearest sample; 0 if it is that sample [mm]
    beyond: float  # way from the outermost sample to the lines [mm]


def find_sharp_turns(time: Floats, x: Floats) -> list[Turn]:
    """Return the turns of a motion [s, mm] with straight legs; none if it rounds its turns.

    A turn is where the lines through the samples before and after it meet, mostly between two
    samples: without it, the record cuts up to half a step off each tip of a loop. A motion that
    slows down before it turns is not sharp, and its turns are nearly in the record: the largest
    sample of a sine is within 0.2 % of the peak with 50 samples per cycle.
    """
    noise, turns = _noise_of_motion(x), list[Turn]()
    reversals = turning_points(x, max(TURN * float(np.abs(x).max()), dead_band(x, noise)))
    for k in reversals[1:-1].tolist():
        before, after = (_line_beside(time, x, k, side, noise) for side in (-1, 1))
        if before is None or after is None or before.slope * after.slope >= 0.0:
            continue
        if min(before.step, after.step) <= STEEP * noise:
            continue
        # Two samples always are on a line: they count as a leg at the speed of the other one.
        fewer, more = sorted((before, after), key=lambda line: line.samples)
        difference = abs(before.slope + after.slope)
        if fewer.samples < 3 and (more.samples < 3 or difference > ALIKE_SPEED * abs(more.slope)):
            continue
        since = (before.at_turn - after.at_turn) / (after.slope - before.slope)
        gap = abs(float(time[k + 1 if since > 0.0 else k - 1] - time[k]))
        step = gap * min(abs(before.slope), abs(after.slope))
        on_line = before.at_turn if since > 0.0 else after.at_turn
        beyond = math.copysign(1.0, before.slope) * (on_line - float(x[k]))
        if abs(since) > gap or abs(beyond) > STRAIGHT * step + NOISY * noise:
            continue
        cut = step / gap * min(abs(since), gap - abs(since))
        turn = before.at_turn + before.slope * since
        place = k if since > 0.0 else k - 1
        turns.append(Turn(place, float(time[k]) + since, turn, cut, beyond))
    if not turns:
        return []
    # Single samples are as noisy as the rounding of an actuator may be large; their mean is not.
    least = ROUNDED * max(turn.cut for turn in turns) + NOISY * noise / math.sqrt(len(turns))
    return turns if float(np.mean([turn.beyond for turn in turns])) <= least else []


def find_cut_turns(time: Floats, x: Floats) -> list[Turn]:
    """Return the sharp turns of a motion [s, mm] that are between two samples."""
    least = NONE * float(np.abs(x).max())
    return [turn for turn in find_sharp_turns(time, x) if turn.cut > least]


class _Line(NamedTuple):
    """A straight line in time."""

    slope: float  # [mm/s]
    at_turn: float  # at the sample of the turn [mm]
    samples: int
    step: float  # way from one sample to the next [mm]


def _line_beside(time: Floats, x: Floats, k: int, side: int, noise: float) -> _Line | None:
    """Return the line through the samples before (-1) or after (1) sample k; None without one.

    They are as many as are on a line, noise apart, and have no gap.
    """
    for count in LINES:
        if not 0 <= k + side * count < len(x):
            continue
        rows = k + side * np.arange(1, count + 1)
        t, d = time[rows] - time[k], x[rows]
        gaps, centred = np.abs(np.diff(time[np.append(k, rows)])), t - t.mean()
        slope = float(np.sum(centred * d) / np.sum(centred**2))
        step = abs(slope) * float(gaps.mean())
        residual = d - d.mean() - slope * centred
        scatter = math.sqrt(float(np.sum(residual**2)) / max(count - 2, 1))
        straight = scatter <= max(STRAIGHT * step, SCATTER * noise)
        if straight and gaps.max() < EVEN * float(np.median(gaps)):
            return _Line(slope, float(d.mean() - slope * t.mean()), count, step)
    return None


def largest_displacement(record: TestRecord) -> float:
    """Return the largest displacement of a motion [mm], which may be between two samples."""
    k = place_of_largest(np.abs(record.displacement))
    return abs(_turned_samples(record).get(k, float(record.displacement[k])))


def turned_amplitudes(record: TestRecord) -> list[float]:
    """Return the amplitude of each full cycle [mm]; its turns may be between two samples."""
    ends = [(cycle.first, cycle.last) for cycle in full_cycles(record)]
    return amplitudes_between(record, ends)


def describe_levels(record: TestRecord, rubber: float) -> str:
    """Return which strains the amplitudes of a test are, of `rubber` [mm]; "" without cycles.

    A wrong description of the bearing shows in strains at which nobody tests.
    """
    cycles = zip(full_cycles(record), turned_amplitudes(record), strict=True)
    levels: list[float] = []
    for size in sorted(size for cycle, size in cycles if not cycle.closing):
        if not levels or size / levels[-1] - 1.0 > SAME:
            levels.append(size)
    if not levels:
        return ""
    sizes = joined(number(size, ".3g") for size in levels)
    strains = joined(number(100.0 * size / rubber, ".0f") for size in levels)
    verb, noun = ("is", "amplitude") if len(levels) == 1 else ("are", "amplitudes")
    return (
        f"the {noun} {sizes} mm {verb} {strains} % shear strain of the {rubber:g} mm of "
        "rubber of the bearing"
    )


def amplitudes_between(record: TestRecord, ends: Sequence[tuple[int, int]]) -> list[float]:
    """Return half the range of the motion between first and last samples of cycles [mm]."""
    turned, x, amplitudes = _turned_samples(record), record.displacement, []
    for first, last in ends:
        rows = x[first : last + 1]
        high, low = first + int(rows.argmax()), first + int(rows.argmin())
        amplitudes.append(0.5 * (turned.get(high, float(x[high])) - turned.get(low, float(x[low]))))
    return amplitudes


def _turned_samples(record: TestRecord) -> dict[int, float]:
    """Return the displacement of the sharp turns [mm] by the samples before and after them."""
    turns = find_sharp_turns(record.time, record.displacement)
    return {k: turn.displacement for turn in turns for k in (turn.before, turn.before + 1)}


class AddedTurns(NamedTuple):
    """Turns that a model makes between two samples of a record."""

    turns: int
    farthest: float  # largest way from such a turn to the nearest sample [mm]
    sampled: float  # largest displacement of the samples [mm]
    largest: float  # largest displacement of the motion with these turns [mm]


def measure_added_turns(record: TestRecord) -> AddedTurns:
    """Return how many turns a model adds to the samples of a record, and what they change."""
    turns, sampled = find_cut_turns(record.time, record.displacement), record.peak_displacement
    farthest = max((turn.cut for turn in turns), default=0.0)
    largest = largest_displacement(record) if turns else sampled
    return AddedTurns(len(turns), farthest, sampled, largest)


def describe_cut_turns(record: TestRecord) -> str:
    """Return a sentence on the turns that the record does not have; empty if it has them all."""
    added = measure_added_turns(record)
    if not added.turns:
        return ""
    return (
        f"turns of the motion between two samples: {added.turns}, up to {added.farthest:.2g} mm "
        "from the nearest sample; a calibration turns where the straight legs meet, so that the "
        f"largest displacement is {describe_change(added.sampled, added.largest)}"
    )


def describe_change(sampled: float, largest: float) -> str:
    """Return a largest displacement of samples and of the motion [mm], with their difference.

    >>> describe_change(52.25, 52.5)
    '52.50 mm instead of 52.25 mm, +0.48 %'
    """
    change = number(100.0 * (largest / sampled - 1.0), "+.2f")
    return f"{largest:.2f} mm instead of {sampled:.2f} mm, {change} %"


def step_at_reversals(record: TestRecord) -> float:
    """Return the median, over the reversals, of the larger step to a neighbouring sample [mm].

    It is the speed over the sampling rate in triangular cycles, and far less in sines. 0 without
    a reversal. Where the motion is straight next to a reversal, the step is that of the line
    through its samples: noise makes the difference of two samples larger, not the slope of six.
    """
    turns, time, x = _reversals(record), record.time, record.displacement
    if not len(turns):
        return 0.0
    noise, steps = _noise_of_motion(x), []
    for k in turns.tolist():
        lines = (_line_beside(time, x, k, side, noise) for side in (-1, 1))
        steps.append(
            max(
                line.step if line is not None and line.samples > 2 else abs(x[k + side] - x[k])
                for side, line in zip((-1, 1), lines, strict=True)
            )
        )
    return float(np.median(steps))


def _reversals(record: TestRecord) -> Ints:
    x = record.displacement
    return turning_points(x, max(dead_band(x), REVERSAL * record.peak_displacement))[1:-1]


def _noise_of_motion(x: Floats) -> float:
    """Return the noise of a displacement [mm] outside rests, which a treatment holds at a value."""
    return estimate_noise(x[np.append(True, np.diff(x) != 0.0)])


def describe_coarse_samples(record: TestRecord, d_y: float, *, also_sharp: bool = False) -> str:
    """Return a sentence on samples that are too far apart after a turn; empty if they are not.

    `d_y` is the yield displacement [mm]. Samples at sharp turns, which follow from the legs, may be
    up to d_y apart, unless the sentence is `also_sharp`.
    """
    return _coarse_samples(record, d_y, *_step_and_limit(record, d_y, also_sharp))


def _coarse_samples(record: TestRecord, d_y: float, step: float, limit: float) -> str:
    """Return the sentence of `describe_coarse_samples` on a step and the largest one [mm]."""
    if step <= CLOSE * limit:
        return ""
    rate = 1.0 / float(np.median(np.diff(record.time)))
    wanted = number(rate * step / (RESOLVED * d_y), ".2g")
    return (
        f"the displacement changes by {step:.2g} mm from one sample to the next at the reversals, "
        f"{percent(step / d_y)} of d_y = {d_y:.3g} mm. Record the test at "
        f"{wanted} Hz or more instead of {number(rate, '.3g')} Hz, which do not resolve the tips "
        "of the loops"
    )


def describe_coarsest(
    records: Sequence[TestRecord], d_y: float, *, also_sharp: bool = False
) -> str:
    """Return the sentence on the test whose samples are the farthest apart, with its name."""
    steps = [_step_and_limit(record, d_y, also_sharp) for record in records]
    worst = place_of_largest([step / limit for step, limit in steps])
    coarse = _coarse_samples(records[worst], d_y, *steps[worst])
    return f"{records[worst].name}: {coarse}" if coarse else ""


def _step_and_limit(record: TestRecord, d_y: float, also_sharp: bool) -> tuple[float, float]:
    """Return the step at the reversals, and the largest one that is not reported [mm]."""
    step = step_at_reversals(record)
    # Steps that noise makes say nothing about the motion, and noise is warned of by itself.
    noisy = step < SURELY_STEEP * _noise_of_motion(record.displacement)
    return step, d_y if noisy or (not also_sharp and _is_sharp(record)) else RESOLVED * d_y


def _is_sharp(record: TestRecord) -> bool:
    """Return whether most reversals are sharp, so that the legs determine them."""
    sharp = find_sharp_turns(record.time, record.displacement)
    return 2 * len(sharp) > len(_reversals(record))
