"""Rests that a logger ran through: where they are, and a record that holds them as rests.

A resting bearing jitters in the record and not in the rig. Taken for motion, each wiggle
unloads the model a little, and thousands of them walk its force down; and where most samples are
rest, a fit by samples is a fit to the rests.
"""

from collections import deque
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.forward import PAUSE, turning_points
from thermobearing.identify.noise import noise_of
from thermobearing.identify.record import TestRecord

Floats = NDArray[np.float64]

WITHIN = 5.0  # of the noise to either side of the mean: one sample in 2e6 is beyond
STILL = 0.002  # of the largest displacement to either side: a servo that hunts is at rest
FEWEST = 5  # samples: a rest that the logger slept through needs no treatment
LARGE = 0.2  # of the largest displacement: legs that tell how fast the test is
PART = 0.25  # of the time of a leg from 10 to 90 % of its way: a sine dwells less at its turns
KEPT = 20  # samples of a rest with thermocouples, denser in its beginning


def rests_of(record: TestRecord) -> list[tuple[int, int]]:
    """Where the displacement stays within its noise for longer than a turn takes.

    Parameters
    ----------
    record : a test.

    Returns
    -------
    list of (first, last) : samples of each rest.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 30.0, 3001)
    >>> x = np.where(t < 10.0, 30.0 * np.sin(np.pi * t), 0.0)
    >>> record = record_from_arrays(t, x, 2.0 * x, 23.0)
    >>> [(round(float(t[a])), round(float(t[b]))) for a, b in rests_of(record)]
    [(10, 30)]
    """
    time, x = record.time, record.displacement
    band = 2.0 * max(WITHIN * noise_of(x), STILL * record.peak_displacement)
    shortest = max(PAUSE, PART * _leg_time(record))
    first = _reach(x, band)
    ends = np.flatnonzero(time - time[first] >= shortest)
    found: list[tuple[int, int]] = []
    for end in ends.tolist():
        begin = int(first[end])
        if found and begin <= found[-1][0]:
            found[-1] = (found[-1][0], end)
            continue
        begin = max(begin, found[-1][1] + 1) if found else begin  # after one that crept away
        if time[end] - time[begin] >= shortest:
            found.append((begin, end))
    return [(a, b) for a, b in found if b - a + 1 >= FEWEST]


def _leg_time(record: TestRecord) -> float:
    """Median time from 10 to 90 % of the way of a large leg [s]."""
    x, peak = record.displacement, record.peak_displacement
    times = []
    for a, b in pairwise(turning_points(x, LARGE * peak).tolist()):
        way = np.maximum.accumulate(np.abs(x[a : b + 1] - x[a]))
        if way[-1] >= LARGE * peak:
            low, high = np.searchsorted(way, [0.1 * way[-1], 0.9 * way[-1]])
            times.append(record.time[a + high] - record.time[a + low])
    return float(np.median(times)) if times else 0.0


def _reach(x: Floats, band: float) -> NDArray[np.int64]:
    """The earliest sample from which the signal stays in a band until each sample."""
    first, begin = np.zeros(len(x), dtype=np.int64), 0
    highs: deque[int] = deque()
    lows: deque[int] = deque()
    values = x.tolist()
    for i, value in enumerate(values):
        while highs and values[highs[-1]] <= value:
            highs.pop()
        while lows and values[lows[-1]] >= value:
            lows.pop()
        highs.append(i)
        lows.append(i)
        while values[highs[0]] - values[lows[0]] > band:
            begin += 1
            if highs[0] < begin:
                highs.popleft()
            if lows[0] < begin:
                lows.popleft()
        first[i] = begin
    return first


def held(record: TestRecord, rests: list[tuple[int, int]]) -> TestRecord:
    """The same samples, the displacement of each rest at its mean.

    Parameters
    ----------
    record : a test.
    rests : from `rests_of`.

    Returns
    -------
    TestRecord

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> record = record_from_arrays(np.arange(4.0), [0.1, -0.1, 5.0, 9.0], np.arange(4.0), 23.0)
    >>> held(record, [(0, 1)]).displacement.tolist()
    [0.0, 0.0, 5.0, 9.0]
    """
    x = record.displacement.copy()
    for first, last in rests:
        x[first : last + 1] = x[first : last + 1].mean()
    return replace(record, displacement=x)


def thinned(
    record: TestRecord, rests: list[tuple[int, int]]
) -> tuple[TestRecord, NDArray[np.int64], NDArray[np.bool_]]:
    """A record in which a rest is a gap: its ends, and with thermocouples some samples between.

    Parameters
    ----------
    record : from `held`.
    rests : from `rests_of`.

    Returns
    -------
    TestRecord, the samples that it kept, and which of them are of a rest; the force and the
    temperatures of these are means of the samples they stand for.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.arange(100.0)
    >>> record = record_from_arrays(t, np.maximum(t - 90.0, 0.0), t, 23.0)
    >>> short, kept, resting = thinned(record, [(0, 90)])
    >>> kept[:3].tolist(), resting[:3].tolist(), short.force[:3].tolist()
    ([0, 90, 91], [True, True, False], [22.0, 67.5, 91.0])
    """
    resting = np.zeros(len(record.time), dtype=bool)
    parts, before = [], 0
    columns = {"force": record.force.copy()}
    columns |= {title: values.copy() for title, values in record.temperatures.items()}
    for first, last in rests:
        resting[first : last + 1] = True
        places = np.linspace(0.0, 1.0, KEPT if record.temperatures else 2) ** 2
        nodes = np.unique(np.rint(first + (last - first) * places).astype(np.int64))
        edges = [first, *((nodes[:-1] + nodes[1:] + 1) // 2).tolist(), last + 1]
        for values in columns.values():
            values[nodes] = [values[a:b].mean() for a, b in pairwise(edges)]
        parts += [np.arange(before, first), nodes]
        before = last + 1
    kept = np.concatenate([*parts, np.arange(before, len(record.time))])
    short = replace(
        record,
        time=record.time[kept],
        displacement=record.displacement[kept],
        force=columns.pop("force")[kept],
        block=record.block[kept],
        temperatures={title: values[kept] for title, values in columns.items()},
    )
    return short, kept, resting[kept]
