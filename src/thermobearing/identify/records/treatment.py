"""What is done to a record between reading it and fitting it: rests, spikes, drift of zeros.

Rests are always treated as rests: there is one right way. Spikes and drift are found and told;
they are taken away only where the record says so, since a leap or a drift may be the bearing's.

A resting bearing jitters in the record and not in the rig. Taken for motion, each wiggle
unloads the model a little, and thousands of them walk its force down; and where most samples are
rest, a fit by samples is a fit to the rests.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.identify.fit.forward import PAUSE, turning_points
from thermobearing.identify.records.cycles import Cycle, full_cycles, loop_middles
from thermobearing.identify.records.noise import (
    WINDOW,
    bridged,
    estimate_noise,
    find_spikes,
    split_runs,
)
from thermobearing.identify.records.record import TestRecord

Floats = NDArray[np.float64]
WITHIN = 5.0  # of the noise to either side of the mean: one sample in 2e6 is beyond
STILL = 0.002  # of the largest displacement to either side: a servo that hunts is at rest
FEWEST = 5  # samples: a rest that the logger slept through needs no treatment
LARGE = 0.2  # of the largest displacement: legs that tell how fast the test is
PART = 0.25  # of the time of a leg from 10 to 90 % of its way: a sine dwells less at its turns
KEPT = 20  # samples of a rest with thermocouples, denser in its beginning


def find_rests(record: TestRecord) -> list[tuple[int, int]]:
    """Where the displacement stays within its noise for longer than a turn takes.

    Parameters
    ----------
    record : a test.

    Returns
    -------
    list of (first, last) : samples of each rest.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 30.0, 3001)
    >>> x = np.where(t < 10.0, 30.0 * np.sin(np.pi * t), 0.0)
    >>> record = record_from_arrays(t, x, 2.0 * x, 23.0)
    >>> [(round(float(t[a])), round(float(t[b]))) for a, b in find_rests(record)]
    [(10, 30)]
    """
    time, x = record.time, record.displacement
    band = 2.0 * max(WITHIN * estimate_noise(x), STILL * record.peak_displacement)
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
    rests : from `find_rests`.

    Returns
    -------
    TestRecord

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
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
    rests : from `find_rests`.

    Returns
    -------
    TestRecord, the samples that it kept, and which of them are of a rest; the force and the
    temperatures of these are means of the samples they stand for.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
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


Flags = NDArray[np.bool_]
Words = tuple[Literal["warning", "note"], str, str]
FAST = 3.0  # times the speed of the test: no actuator leaps so
STEEP = 10.0  # times the stiffness of the whole test: no loop is steeper where it turns
LONGEST = 1.0  # step of time [s] in which an actuator may move: longer ones are rests
DRIFT = 0.03  # of the peak, over the record: heating and growing cycles move the middles by 2 %
SURE = 4.0  # standard errors of its slope: less may be chance
FEWEST_CYCLES = 4  # a line through fewer middles, without first cycles, says nothing
UNITS = {"displacement": "mm", "force": "kN"}


@dataclass(frozen=True)
class Drift:
    """How the zero of a signal wanders: a straight line in time through the middles of its loops.

    Attributes
    ----------
    times, middles : time [s] and middle of each cycle that is looked at [mm or kN].
    slope, begin : of the line, per second, and its value at the first of these times.
    total : over the record [mm or kN].
    """

    times: Floats
    middles: Floats
    slope: float
    begin: float
    total: float


@dataclass(frozen=True)
class Treatment:
    """What was found in a record, and the record as it is looked at and as it is fitted.

    Attributes
    ----------
    record : as it was read.
    noise : standard deviation by signal [mm, kN].
    rests : first and last sample of each.
    spikes : by signal, which samples.
    drifts : by signal, where there is one, to be taken away or not.
    cycles : of `steady`.
    steady : all samples, rests at their mean and spikes bridged, for the checks.
    cleaned : all samples, rests at their mean, and what was told taken away.
    """

    record: TestRecord
    noise: dict[str, float]
    rests: list[tuple[int, int]]
    spikes: dict[str, Flags]
    drifts: dict[str, Drift]
    cycles: list[Cycle]
    steady: TestRecord
    cleaned: TestRecord

    @property
    def resting(self) -> int:
        """Samples of rests."""
        return sum(last - first + 1 for first, last in self.rests)

    def to_fit(self, left_out: Flags) -> tuple[TestRecord, Flags]:
        """The record that a fit sees, and which of its samples have no say in the force.

        Parameters
        ----------
        left_out : samples of the whole record that have none besides.

        Returns
        -------
        TestRecord, ndarray of bool
        """
        bad = left_out | self.spikes["force"] if self.record.despike else left_out
        short, kept, resting = thinned(self.cleaned, self.rests)
        return short, bad[kept] | resting

    def summary(self) -> dict[str, Any]:
        """What summary.json says of it."""
        return {
            "noise": {f"{name}_{UNITS[name]}": value for name, value in self.noise.items()},
            "rests": len(self.rests),
            "samples_at_rest": self.resting,
            "spikes": {name: len(split_runs(flags)) for name, flags in self.spikes.items()},
            "spikes_removed": self.record.despike,
            "drift": {f"{name}_{UNITS[name]}": drift.total for name, drift in self.drifts.items()},
            "drift_removed": _detrended(self.record),
        }


def _detrended(record: TestRecord) -> list[str]:
    """Signals whose drift is to be taken away.

    Parameters
    ----------
    record : with its `detrend`.

    Returns
    -------
    list of str : "force" and "displacement", or one of them, or none.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> record = record_from_arrays(np.arange(3.0), np.arange(3.0), np.arange(3.0), 23.0)
    >>> _detrended(replace(record, detrend="both"))
    ['displacement', 'force']
    """
    return [name for name in UNITS if record.detrend in (name, "both")]


def to_be_treated(
    records: list[TestRecord], despike: bool, detrend: str, ambient_uncertainty: float | None = None
) -> list[TestRecord]:
    """Return the records with treatments besides those that their sidecars ask for.

    Parameters
    ----------
    records : tests.
    despike : take spikes out.
    detrend : "force", "displacement", "both", or "" for what the sidecars say.
    ambient_uncertainty : standard uncertainty of all ambient temperatures [K], 0 to 20; None for
        what the sidecars say.

    Returns
    -------
    list of TestRecord

    Raises
    ------
    InputError : another word, or a number out of range.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> record = record_from_arrays(np.arange(3.0), np.arange(3.0), np.arange(3.0), 23.0)
    >>> to_be_treated([record], True, "force")[0].despike
    True
    """
    if detrend not in ("", *UNITS, "both"):
        raise InputError(f'detrend = "{detrend}"{nearest(detrend, [*UNITS, "both"])}')
    if ambient_uncertainty is not None:
        if not 0.0 <= ambient_uncertainty <= 20.0:
            raise InputError(f"ambient_uncertainty = {ambient_uncertainty} K: must be 0 to 20 K")
        records = [replace(r, ambient_uncertainty=ambient_uncertainty) for r in records]
    return [replace(r, despike=r.despike or despike, detrend=detrend or r.detrend) for r in records]


def treat(record: TestRecord) -> Treatment:
    """Find rests, spikes and drift of a record, and do to it what is to be done.

    Parameters
    ----------
    record : a test whose time increases and whose signals are not constant.

    Returns
    -------
    Treatment

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 40.0, 4001)
    >>> x = np.where(t < 10.0, 30.0 * np.sin(np.pi * t), 0.0)
    >>> found = treat(record_from_arrays(t, x, 2.0 * x, 23.0))
    >>> short, left_out = found.to_fit(np.zeros(len(t), dtype=bool))
    >>> len(found.rests), len(short.time) < 1010, int(left_out.sum())
    (1, True, 2)
    """
    time = record.time
    spikes = {"displacement": find_spikes(record.displacement, _possible_way(record))}
    x = bridged(time, record.displacement, spikes["displacement"])
    spikes["force"] = find_spikes(record.force, _possible_force(x, record.force))
    bare = replace(record, displacement=x, force=bridged(time, record.force, spikes["force"]))
    rests = find_rests(bare)
    steady = held(bare, rests)
    cycles = full_cycles(steady)
    drifts = _drifts(steady, cycles)
    cleaned = bare if record.despike else record
    lines = {
        name: drifts[name].slope * (time - time[0]) for name in _detrended(record) if name in drifts
    }
    if lines:
        bare, cleaned = _less(bare, lines), _less(cleaned, lines)
        rests = find_rests(bare)
        steady = held(bare, rests)
    return Treatment(
        record=record,
        noise={"displacement": estimate_noise(x), "force": estimate_noise(bare.force)},
        rests=rests,
        spikes=spikes,
        drifts=drifts,
        cycles=full_cycles(steady),
        steady=steady,
        cleaned=held(cleaned, rests),
    )


def _less(record: TestRecord, lines: dict[str, Floats]) -> TestRecord:
    """A record less what its zeros drift by."""
    return replace(record, **{name: getattr(record, name) - line for name, line in lines.items()})


def _around(steps: Floats) -> Floats:
    """The largest step from one sample to the next in the window around each sample."""
    from scipy.ndimage import maximum_filter1d

    beside = np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0))
    return np.asarray(maximum_filter1d(beside, WINDOW))


def _possible_way(record: TestRecord) -> Floats:
    """What an actuator might move in a step of time [mm]: by the fastest leg of the test."""
    from scipy.ndimage import median_filter

    smooth = median_filter(record.displacement, WINDOW, mode="nearest")
    fastest = 0.0
    for a, b in pairwise(turning_points(smooth, LARGE * float(np.abs(smooth).max())).tolist()):
        fastest = max(fastest, abs(smooth[b] - smooth[a]) / (record.time[b] - record.time[a]))
    steps = np.minimum(np.diff(record.time), LONGEST)
    return np.asarray(FAST * fastest * _around(steps))


def _possible_force(x: Floats, force: Floats) -> Floats:
    """What the loop might do to the force where the bearing moves as it does [kN]."""
    from scipy.ndimage import median_filter

    peak = float(np.abs(median_filter(force, WINDOW, mode="nearest")).max())
    steps = np.abs(np.diff(x)) / max(float(np.abs(x).max()), 1e-12)
    return np.asarray(STEEP * peak * _around(steps))


def _drifts(record: TestRecord, cycles: list[Cycle]) -> dict[str, Drift]:
    """Lines through the middles of the loops, of the signals that have one."""
    # First cycles are stronger to the side they move to first, the more the larger they are.
    used = [cycle for cycle in cycles if cycle.number > 1 and not cycle.closing]
    if len(used) < FEWEST_CYCLES:
        return {}
    found = {}
    times = np.array([0.5 * (record.time[c.first] + record.time[c.last]) for c in used])
    for name in UNITS:
        values = getattr(record, name)
        middles = loop_middles(values, used)
        (slope, begin), error = np.polyfit(times - times[0], middles, 1, cov=True)
        total = float(slope * (record.time[-1] - record.time[0]))
        sure = abs(slope) > SURE * np.sqrt(error[0, 0])
        if sure and abs(total) > DRIFT * float(np.abs(values).max()):
            found[name] = Drift(times, middles, float(slope), float(begin), total)
    return found


def told(found: Treatment) -> Iterator[Words]:
    """What there is to say of it, as level, check and sentence.

    Parameters
    ----------
    found : from `treat`.

    Yields
    ------
    tuple of str : "warning" where something is left in that the user may take out, else "note".
    """
    record = found.record
    if found.rests:
        part = found.resting / len(record.time)
        yield (
            "note",
            "rests",
            f"{_counted(len(found.rests), 'rest')}, {part:.0%} of the samples: a fit holds the "
            "displacement at its mean there, and leaves their force out",
        )
    shown = [
        f"{value:.2g} {UNITS[name]} in the {name}" for name, value in found.noise.items() if value
    ]
    if shown:
        yield "note", "noise", f"noise (standard deviation) of {' and '.join(shown)}"
    for name, flags in found.spikes.items():
        if flags.any():
            yield _told_spikes(record, name, flags)
    for name, drift in found.drifts.items():
        yield _told_drift(record, name, drift)


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"


def _told_spikes(record: TestRecord, name: str, flags: Flags) -> Words:
    runs, values = split_runs(flags), getattr(record, name)
    off = np.abs(values - bridged(record.time, values, flags))
    worst = int(np.argmax(off))
    said = (
        f"{_counted(len(runs), 'spike')} in the {name}, the largest "
        f"{off[worst]:.3g} {UNITS[name]} at {record.time[worst]:.6g} s"
    )
    if record.despike:
        return "note", "spikes", f"{said}: taken out, as told"
    return (
        "warning",
        "spikes",
        f"{said}: left in; despike = true in the sidecar, or --despike, takes them out",
    )


def _told_drift(record: TestRecord, name: str, drift: Drift) -> Words:
    unit = UNITS[name]
    said = f"the zero of the {name} drifts by {drift.total:.3g} {unit} over the record"
    if name in _detrended(record):
        return "note", "drift", f"{said}: taken out as a straight line in time, as told"
    return (
        "warning",
        "drift",
        f'{said}: left in; detrend = "{name}" in the sidecar, or --detrend {name}, takes a '
        "straight line in time out",
    )
