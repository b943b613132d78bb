"""Treatment of a record before a calibration: rests, spikes and drift of the zeros.

Rests are always treated as rests. Spikes and drift are found and reported; they are removed only
if the record requests it, since a jump or a drift may be caused by the bearing.

The displacement of a resting bearing jitters in the record, not in the rig. Used as motion, each
fluctuation unloads the model a little, and thousands of them reduce its force; and where most
samples are at rest, a calibration to samples is one to the rests.
"""

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.core.records import Floats, Ints
from thermobearing.identify.records.cycles import (
    NORMAL,
    Cycle,
    dead_band,
    estimate_noise,
    full_cycles,
    measure_zeros,
    split_runs,
    turning_points,
)
from thermobearing.identify.records.record import PAUSE, TestRecord
from thermobearing.identify.records.turns import measure_added_turns
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.words import counted, percent
from thermobearing.tables.gaps import mean_reading

Flags = NDArray[np.bool_]
UNITS = {"displacement": "mm", "force": "kN"}
WITHIN = 5.0  # of the noise to either side of the mean: one sample in 2e6 is beyond
STILL = 0.002  # of the largest displacement to either side: a servo that hunts is at rest
FEWEST = 5  # samples: a rest that the logger slept through needs no treatment
LARGE = 0.2  # of the largest displacement: legs that show how fast the test is
PART = 0.25  # of the time of a leg from 10 to 90 % of its way: a sine dwells less at its turns
KEPT = 20  # samples of a rest with thermocouples, denser in its beginning
WINDOW = 7  # samples of the running median: spikes of up to three are seen
SPIKE = 8.0  # of the noise: that of filtered noise is measured too small by up to a half
OF_SPAN = 0.5  # of what the force does anyway within the window: the tip of a loop is no spike
SMALL = 0.02  # of the peak: smaller ones do a fit no harm
FAST = 3.0  # times the speed of the test: no actuator leaps so
STEEP = 10.0  # times the stiffness of the test: no loop is steeper where it turns
LONGEST = 1.0  # step of time [s] in which an actuator may move: longer ones are rests
DRIFT = 0.01  # of the peak of the smallest cycles, over the record: a smaller one is left out
MUCH_DRIFT = 0.03  # ... that is warned of
SURE = 4.0  # standard errors of a slope or an offset that is warned of: less may be chance
FEWEST_ZEROS = 4  # a line through fewer zeros says nothing
# Neighbouring zeros have legs in common: with the weights 1/4, 1/2 and 1/4 of `measure_zeros`, the
# variance of their mean is 1/(1/16 + 1/4 + 1/16) times that of independent zeros.
SHARED_LEGS = math.sqrt(8.0 / 3.0)
UPPER_END = 0.975  # of a 95 % interval
# Two-sided: of tests without a drift, one in a hundred has one by chance.
SIGNIFICANCE = 0.01
NOT_SIGNIFICANT = (
    f"It is not significant (two-sided, {percent(1.0 - SIGNIFICANCE)}) and may be chance"
)
MAY_REMAIN = "may remain or be too much"  # of a drift that was removed


@dataclass(frozen=True)
class Finding:
    """A finding in a record: its severity, the check, and a sentence with numbers."""

    level: Literal["refused", "warning", "note"]
    check: str
    sentence: str


refuse, warn, note = (partial(Finding, level) for level in ("refused", "warning", "note"))


def _find_rests(record: TestRecord) -> list[tuple[int, int]]:
    """Return where the displacement stays within its noise for longer than a turn takes."""
    time, x = record.time, record.displacement
    band = 2.0 * max(WITHIN * estimate_noise(x), STILL * record.peak_displacement)
    shortest = max(PAUSE, PART * _leg_time(record))
    first = _reach(x, band)
    ends = np.flatnonzero(time - time[first] >= shortest)
    rests: list[tuple[int, int]] = []
    for end in ends.tolist():
        begin = int(first[end])
        # A later sample that the same band reaches extends the rest.
        if rests and begin <= rests[-1][0]:
            rests[-1] = (rests[-1][0], end)
            continue
        begin = max(begin, rests[-1][1] + 1) if rests else begin  # after one that crept away
        if time[end] - time[begin] >= shortest:
            rests.append((begin, end))
    return [(a, b) for a, b in rests if b - a + 1 >= FEWEST]


def _leg_time(record: TestRecord) -> float:
    """Return the median time from 10 to 90 % of the way of a large leg [s]."""
    x, peak = record.displacement, record.peak_displacement
    times = []
    for a, b in pairwise(turning_points(x, LARGE * peak).tolist()):
        travel = np.maximum.accumulate(np.abs(x[a : b + 1] - x[a]))
        if travel[-1] >= LARGE * peak:
            low, high = np.searchsorted(travel, [0.1 * travel[-1], 0.9 * travel[-1]])
            times.append(record.time[a + high] - record.time[a + low])
    return float(np.median(times)) if times else 0.0


def _reach(x: Floats, band: float) -> Ints:
    """Return the earliest sample from which the signal stays in a band until each sample."""
    first, begin = np.zeros(len(x), dtype=np.int64), 0
    highs, lows = deque[int](), deque[int]()
    values = x.tolist()
    for i, value in enumerate(values):
        while highs and values[highs[-1]] <= value:
            highs.pop()
        while lows and values[lows[-1]] >= value:
            lows.pop()
        highs.append(i)
        lows.append(i)
        # Monotonic queues hold the candidates for the extremes of the window, so that the search is
        # linear in the number of samples.
        while values[highs[0]] - values[lows[0]] > band:
            begin += 1
            for extremes in (highs, lows):
                if extremes[0] < begin:
                    extremes.popleft()
        first[i] = begin
    return first


def _hold_rests(record: TestRecord, rests: list[tuple[int, int]]) -> TestRecord:
    """Return the record with the displacement of each rest at its mean."""
    x = record.displacement.copy()
    for first, last in rests:
        x[first : last + 1] = x[first : last + 1].mean()
    return replace(record, displacement=x)


def _thin_rests(record: TestRecord, rests: list[tuple[int, int]]) -> tuple[TestRecord, Ints, Flags]:
    """Return a record in which a rest is a gap, the samples kept, and which of them are at rest.

    Of a rest its ends are kept, and with thermocouples some samples between them; their force and
    temperatures are means of the samples that they stand for.
    """
    resting = np.zeros(len(record.time), dtype=bool)
    parts, next_sample = [], 0
    columns = {"force": record.force.copy()}
    columns |= {title: values.copy() for title, values in record.temperatures.items()}
    for first, last in rests:
        resting[first : last + 1] = True
        # Squares: a bearing cools fastest at the beginning of a rest.
        places = np.linspace(0.0, 1.0, KEPT if record.temperatures else 2) ** 2
        nodes = np.unique(np.rint(first + (last - first) * places).astype(np.int64))
        edges = [first, *((nodes[:-1] + nodes[1:] + 1) // 2).tolist(), last + 1]
        for values in columns.values():
            values[nodes] = [mean_reading(values[a:b]) for a, b in pairwise(edges)]
        parts += [np.arange(next_sample, first), nodes]
        next_sample = last + 1
    kept = np.concatenate([*parts, np.arange(next_sample, len(record.time))])
    short = replace(
        record,
        time=record.time[kept],
        displacement=record.displacement[kept],
        force=columns.pop("force")[kept],
        block=record.block[kept],
        temperatures={title: values[kept] for title, values in columns.items()},
    )
    return short, kept, resting[kept]


class Drift(NamedTuple):
    """Drift of the zero of a signal: a straight line in time."""

    times: Floats  # of the zeros [s]
    middles: Floats  # of their legs [mm or kN]
    slope: float  # [mm/s or kN/s]
    begin: float  # of the line at the first of these times [mm or kN]
    total: float  # over the record [mm or kN]
    error: float  # half the 95 % interval of `total` [mm or kN]
    significant: bool  # unlikely to be chance
    matters: bool  # to the smallest cycles, and its interval excludes zero: it is warned of


@dataclass(frozen=True)
class Treatment:
    """Findings in a record, and the record as it is checked and as it is used in a calibration."""

    record: TestRecord  # as it was read
    noise: dict[str, float]  # standard deviation by signal [mm, kN]
    rests: list[tuple[int, int]]  # first and last sample of each
    spikes: dict[str, Flags]  # samples, by signal
    drifts: dict[str, Drift]  # by signal, if it has one, removed or not
    cycles: list[Cycle]  # of `steady`
    steady: TestRecord  # all samples, rests at their mean and spikes bridged, for the checks
    cleaned: TestRecord  # all samples, rests at their mean; spikes and drift removed on request

    def to_fit(self, left_out: Flags) -> tuple[TestRecord, Flags]:
        """Return the record for a calibration, and the samples whose force has no weight."""
        bad = left_out | self.spikes["force"] if self.record.despike else left_out
        short, samples, resting = _thin_rests(self.cleaned, self.rests)
        return short, bad[samples] | resting

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the treatment."""
        moved = _thin_rests(self.cleaned, self.rests)[0]  # what a model follows
        added = measure_added_turns(moved)
        return {
            "turns_added": added.turns,
            "farthest_turn_mm": added.farthest,
            "largest_sample_mm": added.sampled,
            "largest_displacement_mm": added.largest,
            "dead_band_mm": dead_band(moved.displacement),
            "noise": {f"{name}_{UNITS[name]}": value for name, value in self.noise.items()},
            "rests": len(self.rests),
            "samples_at_rest": sum(last - first + 1 for first, last in self.rests),
            "spikes": {name: len(split_runs(flags)) for name, flags in self.spikes.items()},
            "spikes_removed": self.record.despike,
            "drift": {f"{name}_{UNITS[name]}": drift.total for name, drift in self.drifts.items()},
            "drift_error": {
                f"{name}_{UNITS[name]}": drift.error for name, drift in self.drifts.items()
            },
            "drift_significant": {
                f"{name}_{UNITS[name]}": drift.significant for name, drift in self.drifts.items()
            },
            "drift_removed": [name for name in _detrended(self.record) if name in self.drifts],
            "subtracted": {
                f"{name}_{UNITS[name]}": offset
                for name, offset in self.record.subtracted.items()
                if offset
            },
            "force_reversed": self.record.reversed_force,
            "missing_readings": {
                item.title: {"readings": item.missing, "filled": item.chamber}
                for item in self.record.gaps
            },
        }

    def without_drifts(self) -> TestRecord:
        """Return `steady` without the drifts that were measured, removed or not."""
        remaining = set(self.drifts) - set(_detrended(self.record))
        return _remove_drifts(self.steady, {name: self.drifts[name] for name in remaining})


def _detrended(record: TestRecord) -> list[str]:
    """Return the signals whose drift is to be removed."""
    return [name for name in UNITS if record.detrend in (name, "both")]


def request_treatment(
    records: list[TestRecord],
    despike: bool = False,
    detrend: str = "",
    ambient_uncertainty: float | None = None,
) -> list[TestRecord]:
    """Return the records with treatments in addition to those in their sidecars.

    Parameters
    ----------
    despike : remove spikes from all tests.
    detrend : remove the drift of the zero from all tests: force, displacement or both.
    ambient_uncertainty : standard uncertainty of the ambient temperature of every test [K], 0 to
        20; 0.6 by default.
    """
    if detrend not in ("", *UNITS, "both"):
        raise InputError(f'detrend = "{detrend}"{nearest(detrend, [*UNITS, "both"])}')
    if ambient_uncertainty is not None:
        if not 0.0 <= ambient_uncertainty <= 20.0:
            raise InputError(f"ambient_uncertainty = {ambient_uncertainty} K: must be 0 to 20 K")
        records = [replace(r, ambient_uncertainty=ambient_uncertainty) for r in records]
    return [replace(r, despike=r.despike or despike, detrend=detrend or r.detrend) for r in records]


def treat(record: TestRecord) -> Treatment:
    """Find rests, spikes and drift of a record, and remove them if its settings request it.

    Its time increases, and its signals are not constant.
    """
    time = record.time
    spikes = {"displacement": _find_spikes(record.displacement, _possible_way(record))}
    x = _bridge(time, record.displacement, spikes["displacement"])
    spikes["force"] = _find_spikes(record.force, _possible_force(x, record.force))
    bare = replace(record, displacement=x, force=_bridge(time, record.force, spikes["force"]))
    rests = _find_rests(bare)
    steady = _hold_rests(bare, rests)
    cycles = full_cycles(steady)
    drifts = _drifts(steady, cycles)
    cleaned = bare if record.despike else record
    unwanted = {name: drifts[name] for name in _detrended(record) if name in drifts}
    # Rests are sought again: a drift of the displacement looks like motion.
    if unwanted:
        bare, cleaned = (_remove_drifts(signals, unwanted) for signals in (bare, cleaned))
        rests = _find_rests(bare)
        steady = _hold_rests(bare, rests)
    return Treatment(
        record=record,
        noise={"displacement": estimate_noise(x), "force": estimate_noise(bare.force)},
        rests=rests,
        spikes=spikes,
        drifts=drifts,
        cycles=full_cycles(steady),
        steady=steady,
        cleaned=_hold_rests(cleaned, rests),
    )


def _remove_drifts(record: TestRecord, drifts: Mapping[str, Drift]) -> TestRecord:
    """Return a record without straight lines in time, which are zero at its first sample."""
    elapsed = record.time - record.time[0]
    signals = {
        name: getattr(record, name) - drift.slope * elapsed for name, drift in drifts.items()
    }
    return replace(record, **signals)


def _find_spikes(values: Floats, possible: Floats | float = 0.0) -> NDArray[np.bool_]:
    """Return which samples jump out of a signal and back.

    A Hampel test for loops: a sample is a spike if it lies outside all running medians around it
    by more than eight times the noise, by more than half of what the signal does there anyway, so
    that the tip of a loop is none, and by more than the motion makes possible.
    """
    from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d

    level = median_filter(values, WINDOW, mode="nearest")
    # The first sees noise that repeats itself, the second noise on what is sampled sparsely.
    noise = max(NORMAL * float(np.median(np.abs(values - level))), estimate_noise(values))
    high, low = maximum_filter1d(level, WINDOW), minimum_filter1d(level, WINDOW)
    excess = np.maximum(values - high, low - values)
    threshold = np.maximum(SPIKE * noise, SMALL * float(np.abs(level).max()))
    return np.asarray(excess > np.maximum(threshold, OF_SPAN * (high - low)) + possible)


def _bridge(time: Floats, values: Floats, bad: NDArray[np.bool_]) -> Floats:
    """Return a signal with its bad samples on straight lines between their good neighbours."""
    if not bad.any():
        return values
    good = ~bad
    return np.where(bad, np.interp(time, time[good], values[good]), values)


def _around(steps: Floats) -> Floats:
    """Return the largest step from one sample to the next in the window around each sample."""
    from scipy.ndimage import maximum_filter1d

    steepest = np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0))
    return np.asarray(maximum_filter1d(steepest, WINDOW))


def _possible_way(record: TestRecord) -> Floats:
    """Return the largest possible motion in a step [mm], from the fastest leg of the test."""
    from scipy.ndimage import median_filter

    smooth = median_filter(record.displacement, WINDOW, mode="nearest")
    fastest = 0.0
    for a, b in pairwise(turning_points(smooth, LARGE * float(np.abs(smooth).max())).tolist()):
        fastest = max(fastest, abs(smooth[b] - smooth[a]) / (record.time[b] - record.time[a]))
    steps = np.minimum(np.diff(record.time), LONGEST)
    return np.asarray(FAST * fastest * _around(steps))


def _possible_force(x: Floats, force: Floats) -> Floats:
    """Return the largest possible change of force in a step as the bearing moves [kN]."""
    from scipy.ndimage import median_filter

    peak = float(np.abs(median_filter(force, WINDOW, mode="nearest")).max())
    steps = np.abs(np.diff(x)) / max(float(np.abs(x).max()), 1e-12)
    return np.asarray(STEEP * peak * _around(steps))


def _drifts(record: TestRecord, cycles: list[Cycle]) -> dict[str, Drift]:
    """Return the drifts of signals, by lines through their zeros.

    A signal whose drift is to be removed has its line in any case; others where it is significant
    and matters.
    """
    from scipy.special import stdtrit

    requested = _detrended(record)
    length = float(record.time[-1] - record.time[0])
    smallest = min(
        (cycle for cycle in cycles if not cycle.closing),
        key=lambda cycle: cycle.amplitude,
        default=None,
    )
    drifts = {}
    for name in UNITS:
        times, middles = measure_zeros(record, name, cycles)
        if len(times) < FEWEST_ZEROS or smallest is None:
            continue
        small_peak = 0.5 * float(np.ptp(getattr(record, name)[smallest.first : smallest.last + 1]))
        (slope, begin), covariance = np.polyfit(times - times[0], middles, 1, cov=True)
        slope_error = float(np.sqrt(covariance[0, 0]))
        half_width, least = (
            float(stdtrit(len(times) - 2, end)) * SHARED_LEGS * slope_error
            for end in (UPPER_END, 1.0 - 0.5 * SIGNIFICANCE)
        )
        # A drift matters to the smallest cycles most, whose stiffness and damping it changes.
        share = abs(slope) * length / small_peak
        significant = abs(slope) > least
        # Few zeros cannot show even a large drift to be significant: it is warned of all the same.
        matters = abs(slope) > max(SURE * slope_error, half_width) and share > MUCH_DRIFT
        if name in requested or matters or (significant and share > DRIFT):
            line = float(slope), float(begin), float(slope) * length
            error = half_width * length
            drifts[name] = Drift(times, middles, *line, error, bool(significant), bool(matters))
    return drifts


def describe_treatment(treatment: Treatment) -> Iterator[Finding]:
    """Yield the findings; a warning where the user may remove something."""
    record = treatment.record
    for item in record.gaps:
        yield note("gaps", item.sentence)
    if treatment.rests:
        part = sum(last - first + 1 for first, last in treatment.rests) / len(record.time)
        are = "is" if len(treatment.rests) == 1 else "are"
        message = (
            f"{counted(len(treatment.rests), 'rest')} ({percent(part)} of the samples) {are} used "
        )
        yield note("rests", message + "for cooling only")
    noise_texts = [
        f"{v:.2g} {UNITS[name]} in the {name}" for name, v in treatment.noise.items() if v
    ]
    if noise_texts:
        yield note("noise", f"standard deviation of the noise: {' and '.join(noise_texts)}")
    for name, flags in treatment.spikes.items():
        if flags.any():
            values = getattr(record, name)
            jumps = np.abs(values - _bridge(record.time, values, flags))
            worst = place_of_largest(jumps)
            message = (
                f"{counted(len(split_runs(flags)), 'spike')} in the {name}, the largest "
                f"{jumps[worst]:.3g} {UNITS[name]} at {record.time[worst]:.6g} s"
            )
            advice = "despike = true in the sidecar, or --despike, removes them"
            level, end = (note, "they were removed") if record.despike else (warn, advice)
            yield level("spikes", f"{message}; {end}")
    for name, drift in treatment.drifts.items():
        unit = UNITS[name]
        size = f"{drift.total:.3g} \N{PLUS-MINUS SIGN} {drift.error:.2g} {unit} (95 %)"
        chance = "" if drift.significant else f". {NOT_SIGNIFICANT}"
        if name in _detrended(record):
            message = (
                f"the drift of the zero of the {name}, {size} over the record, was removed as a "
                "straight line in time"
            )
            yield note(
                "drift",
                f"{message}{chance}. Up to {drift.error:.2g} {unit} {MAY_REMAIN}: "
                f"{counted(len(drift.times), 'half cycle')} determine the line",
            )
        else:
            message = (
                f"the zero of the {name} drifts by {size} over the record; "
                f'detrend = "{name}" in the sidecar, or --detrend {name}, removes it{chance}'
            )
            yield (warn if drift.matters else note)("drift", message)
    for name in _detrended(record):
        if name not in treatment.drifts:
            message = (
                f"the drift of the {name} was not removed, as detrend asks: a line needs "
                f"{FEWEST_ZEROS} half cycles besides the first three of each amplitude"
            )
            yield warn("drift", message)
