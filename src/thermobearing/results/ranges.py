"""Comparison of runs with the limits of a rig, or with the calibration range of a bearing.

Input: names, units and numbers; output: table rows and sentences, for all analyses.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise, product
from statistics import NormalDist
from typing import Any

import numpy as np

from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.quantities.governing import (
    SLACK_KELVIN,
    largest_by,
    place_of_largest,
    place_words,
)
from thermobearing.quantities.warned import BEYOND_TESTS, NO_RANGE, UNTESTED, Warned
from thermobearing.quantities.words import counted

Ends = tuple[float, float]
FloatsOrNumber = Floats | float
Row = dict[Any, Any]

# Of a tested range (its width, or its upper end where that is more), beyond either end: what the
# nominal and the measured value of one test differ by.
SLACK = 0.02
MARKED = "Marked: outside the calibration range of the bearing"
WARM_LEAD = 40.0  # rise of lead from which the adjacent rubber is mentioned [K]
EXTREME = 0.5  # part of the largest displacement above which an extreme counts
# Legs of a measured history, whose slopes are its speed.
LEAST_LEG = 0.1  # of the largest displacement, to either side
MIDDLE = 0.8  # of the way of a leg
FEWEST_OF_LEG = 6  # samples of the middle
LARGEST_STEP = 0.5  # of the time of the middle
CURVED = 1.2  # residual of a line over that of a cubic, above which the leg is curved
OFF_LEG = 0.02  # of the way: residual of a leg that neither describes
REST = 600.0  # between two loadings, after which cycles are counted from zero [s]
NOT_GIVEN = "calibration range not given"
NEVER_TESTED = "never tested as such"  # of an example
NO_RANGE_STATED = f"{NOT_GIVEN}; state tested_range in the bearing file to have it checked"
OUTSIDE = "outside"  # column: whether a limit is exceeded
# Phrases that only warnings on validity contain: those below and that of the temperature law.
TESTED_TO = " tested ("
OF_VALIDITY = (NOT_GIVEN, TESTED_TO, "the range of the temperature law")
TESTED = {  # of a bearing: unit in rows; title, factor and unit in sentences
    "strain": ("1", "strain", 100.0, " %"),
    "strain_rate": ("1/s", "strain rate", 1.0, "/s"),
    "ambient": ("degC", "ambient", 1.0, " degC"),
    "cycles": ("1", "consecutive cycles", 1.0, ""),
    "lead_temperature": ("degC", "lead", 1.0, " degC"),
}


def compared(
    run: str,
    reached: Mapping[str, float | Ends],
    limits: Mapping[str, Ends],
    units: Mapping[str, str],
    *,
    slack: float = 0.0,
) -> list[Row]:
    """Compare a run with limits: one row for each limit whose quantity it has.

    `reached` has the value of each quantity, or its lowest and highest (NaN: none), `limits` the
    lowest and largest value that is allowed. Beyond `slack`, a part of the range (of its width or
    upper end; of temperatures 2 K at least), the run is outside; the row has the end that is
    farther out.
    """
    rows = []
    for name, (low, high) in limits.items():
        slack_kelvin = SLACK_KELVIN if slack and units[name] == "degC" else 0.0
        value = reached.get(name, np.nan)
        ends = value if isinstance(value, tuple) else (value, value)
        if not all(map(math.isfinite, ends)):
            continue
        allowance = max(slack * max(high - low, abs(high)), slack_kelvin)
        below, above = low - ends[0], ends[1] - high
        rows.append(
            {
                "run": run,
                "limit": name,
                "unit": units[name],
                "demand": float(ends[0] if below > max(above, 0.0) else ends[1]),
                "lowest": float(low),
                "largest": float(high),
                OUTSIDE: bool(max(below, above) > allowance),
            }
        )
    return rows


def reached_by(
    time: Floats,
    displacement: Floats,
    speed: float,
    *,
    rubber: float,
    ambient: Ends,
    lead: Floats | None = None,
) -> dict[str, float | Ends]:
    """Return the quantities of a tested range that a history reaches.

    Of times [s], displacements [mm], the largest speed [mm/s], the total rubber thickness [mm],
    the coldest and warmest ambient temperature and the temperatures of the lead [degC].
    """
    ends = None if lead is None or not len(lead) else (float(lead.min()), float(lead.max()))
    largest = float(np.abs(displacement).max())
    reached = reached_by_peaks(largest, speed, rubber=rubber, ambient=ambient, lead=ends)
    if speed > 0.0:  # else the rubber is not loaded
        reached["cycles"] = cycles_in_a_row(time, displacement)
    return reached


def reached_by_peaks(
    displacement: float, speed: float, *, rubber: float, ambient: Ends, lead: Ends | None = None
) -> dict[str, float | Ends]:
    """Return the quantities of a tested range that do not need a history.

    Of the largest displacement [mm] and speed [mm/s], either way; the others as in `reached_by`,
    of the lead the lowest and the highest temperature. Cycles need a history.
    """
    reached: dict[str, float | Ends] = {"ambient": ambient}
    if speed > 0.0:  # else the rubber is not loaded
        reached |= {"strain": displacement / rubber, "strain_rate": speed / rubber}
    if lead is not None and np.isfinite(lead).all():
        reached["lead_temperature"] = lead
    return reached


def farthest(values: Iterable[Mapping[str, float | Ends]]) -> dict[str, float | Ends]:
    """Return how far several bearings with one tested range go in it together.

    >>> farthest([{"strain": 0.5, "ambient": (-20.0, -20.0)}, {"ambient": (23.0, 23.0)}])
    {'strain': 0.5, 'ambient': (-20.0, 23.0)}
    """
    together: dict[str, float | Ends] = {}
    for reached in values:
        for name, value in reached.items():
            together[name] = _outer(together.get(name, value), value)
    return together


def _outer(first: float | Ends, second: float | Ends) -> float | Ends:
    if isinstance(first, tuple) and isinstance(second, tuple):
        return min(first[0], second[0]), max(first[1], second[1])
    return first if isinstance(first, tuple) or isinstance(second, tuple) else max(first, second)


def cycles_in_a_row(time: Floats, displacement: Floats) -> float:
    """Return the most cycles without a rest: half the number of alternating extremes.

    Extremes below a part EXTREME of the largest one, such as noise of a measurement, do not count.
    """
    large = np.flatnonzero(np.abs(displacement) > EXTREME * np.abs(displacement).max())
    if not len(large):
        return 0.0
    side, at = np.sign(displacement[large]), time[large]
    # A change of side is half a cycle; after a rest the count begins again.
    rested = np.diff(at, prepend=at[0]) > REST
    turned = np.diff(side, prepend=0.0) != 0.0
    starts = np.flatnonzero(rested | (np.arange(len(at)) == 0))
    return 0.5 * float(np.add.reduceat((turned | rested).astype(int), starts).max())


def largest_speed(time: Floats, displacement: Floats) -> float:
    """Return that of a measured history [mm/s], of the fastest of its legs.

    A line or, where that fits clearly better, a cubic describes the middle of a leg, so that noise
    hardly changes its slope. Legs that neither describes, such as those with a rest or of an
    earthquake, count only where there are no others: then the speed is the largest mean over a
    tenth of half a cycle.
    """
    large = np.flatnonzero(np.abs(displacement) > LEAST_LEG * np.abs(displacement).max())
    if len(time) < 2 or not len(large):
        return 0.0
    starts = np.flatnonzero(np.diff(np.sign(displacement[large]), prepend=0.0))
    sides = np.split(large, starts[1:])
    turns = [int(side[np.abs(displacement[side]).argmax()]) for side in sides]
    slopes = [_slope_of_leg(time, displacement, leg) for leg in pairwise(turns)]
    if fitted := [slope for slope in slopes if slope is not None]:
        return max(fitted)
    spacing = np.diff(turns) if len(turns) > 1 else np.array([len(time)])
    lag = min(max(1, int(np.median(spacing)) // 10), len(time) - 1)
    travel = np.abs(displacement[lag:] - displacement[:-lag])
    return float((travel / np.maximum(time[lag:] - time[:-lag], np.finfo(float).tiny)).max())


def _slope_of_leg(time: Floats, displacement: Floats, leg: tuple[int, int]) -> float | None:
    """Return the largest slope in the middle of a leg; None if no line or cubic describes it.

    The middle is a part MIDDLE of the way: a constant speed ends at the turns.
    """
    x, elapsed = (values[leg[0] : leg[1] + 1] for values in (displacement, time))
    progress = (x - x[0]) / (x[-1] - x[0])
    begin = int(np.flatnonzero(progress < 0.5 * (1.0 - MIDDLE))[-1])
    ends = np.flatnonzero(progress > 0.5 * (1.0 + MIDDLE))
    rows = slice(begin, int(ends[0]) + 1)
    x, elapsed = x[rows], elapsed[rows]
    # A gap in time is a rest, whatever curve joins its ends.
    if len(x) < FEWEST_OF_LEG or np.diff(elapsed).max() > LARGEST_STEP * np.ptp(elapsed):
        return None
    line, cubic = (np.polynomial.Polynomial.fit(elapsed, x, degree) for degree in (1, 3))
    of_line, of_cubic = (float(np.std(curve(elapsed) - x)) for curve in (line, cubic))
    # A cubic through the noise of a constant speed would be too steep at its ends.
    curve, residual = (line, of_line) if of_line < CURVED * of_cubic else (cubic, of_cubic)
    if residual > OFF_LEG * np.ptp(x):
        return None
    return float(np.abs(curve.deriv()(elapsed)).max())


def compare_with_tests(
    run: str, reached: Mapping[str, float | Ends], ranges: Mapping[str, Ends] | None
) -> list[Row]:
    """Return the rows of `compared` for the tested range of a bearing; none without a range."""
    units = {name: unit for name, (unit, _, _, _) in TESTED.items()}
    return compared(run, reached, ranges or {}, units, slack=SLACK)


class Beyond(Strict):
    """How much less is known of a force outside the calibration range."""

    limit: str  # of `TESTED`
    relative: float  # standard uncertainty for each unit of distance
    ratio: bool = False  # of values, of which the logarithm is the distance
    source: str
    note: str = ""


class _Table(Strict):
    """Content of data/results/extrapolation.toml."""

    beyond: list[Beyond]


def extrapolation(rows: Iterable[Mapping[Any, Any]], *, only: Collection[str] = TESTED) -> float:
    """Return the relative standard uncertainty of a force that lies outside the tests.

    `rows` are those of `compare_with_tests` for a run, `only` the limits that count. Tests at one
    ambient temperature determine no coefficient: it is held, and has its own uncertainty.
    """
    table = read_data(_Table, "results", "extrapolation.toml")
    limits = {item.limit: item for item in table.beyond}
    square = 0.0
    for row in rows:
        limit, low, high, value = (row[k] for k in ("limit", "lowest", "largest", "demand"))
        if not row["outside"] or limit not in limits or limit not in only:
            continue
        if limit == "ambient" and low == high:
            continue
        # Temperatures of tests at one ambient say nothing on its influence, so no distance counts.
        distance = max(low - value, value - high)
        if limits[limit].ratio:
            end = low if value < low else high
            distance = abs(math.log(value / end)) if value > 0.0 < end else 0.0
        square += (limits[limit].relative * distance) ** 2
    return math.sqrt(square)


def widened(
    low: FloatsOrNumber,
    high: FloatsOrNumber,
    middle: FloatsOrNumber,
    uncertainty: FloatsOrNumber,
    level: float,
) -> tuple[Any, Any]:
    """Return the ends of a band with another error, independent of it.

    `more` is its standard uncertainty over the middle, `level` the probability of the upper end.
    """
    reach = NormalDist().inv_cdf(level) * np.abs(middle) * uncertainty
    # Independent errors add by their squares, on each side of the middle for itself.
    below, above = np.maximum(middle - low, 0.0), np.maximum(high - middle, 0.0)
    return low - (np.hypot(below, reach) - below), high + (np.hypot(above, reach) - above)


def outside_tests(
    name: str,
    rows: Sequence[Row],
    ranges: Mapping[str, Ends] | None,
    *,
    skip: Collection[str] = (),
    never_tested: bool = False,
) -> list[Warned]:
    """Return a sentence for each quantity in which runs leave the calibration range of a bearing.

    That with the largest effect on the force, as `extrapolation` estimates it, is the first.
    Without `ranges` one sentence says so, of a bearing without tests (`never_tested`) that it has
    none; quantities in `skip` are left out.
    """
    if ranges is None:
        sentence = NO_RANGE_STATED
        if never_tested:
            sentence = f"{NOT_GIVEN}; its parameters are chosen, and it was {NEVER_TESTED}"
        return [Warned(sentence, NO_RANGE, UNTESTED, name)]
    runs = len({row["run"] for row in rows})
    warnings: list[Warned] = []
    ends = (("largest", 1.0), ("lowest", -1.0))
    for limit, (end, sign) in product([n for n in TESTED if n not in skip], ends):
        passed = [row for row in rows if row["limit"] == limit and row["outside"]]
        if out := [row for row in passed if sign * (row["demand"] - row[end]) > 0]:
            worst = out[place_of_largest([sign * row["demand"] for row in out])]
            where = str(worst["run"]).removeprefix(f"{name}, ")
            place = place_words(len(out), runs, where)
            text = f"{beyond_words(worst)} ({place})"
            # Bounded: no uncertainty makes a warning of the range one of an exceeded limit.
            effect = UNTESTED + min(extrapolation([worst]), 0.99)
            warnings.append(Warned(text, f"{BEYOND_TESTS}.{limit}", effect, name))
    return sorted(warnings, key=lambda warning: -warning.effect)


def beyond_words(row: Mapping[Any, Any]) -> str:
    """Return by how much a row of `compare_with_tests` is outside the tests, in words.

    >>> beyond_words({"limit": "strain", "demand": 3.17, "lowest": 0.5, "largest": 2.5})
    'strain 317 %, above the 250 % tested'
    """
    _, title, factor, unit = TESTED[row["limit"]]
    side, end = ("above", "largest") if row["demand"] > row["largest"] else ("below", "lowest")
    return (
        f"{title} {factor * row['demand']:.3g}{unit}, {side} the "
        f"{factor * row[end]:.3g}{unit} tested"
    )


def runs_of(rows: Iterable[Mapping[Any, Any]]) -> set[str]:
    """Return the runs that some rows are about: a run with several bearings has a row for each."""
    return {str(run) for row in rows for run in row.get("runs", [row["run"]])}


def _rates(rows: Iterable[Mapping[Any, Any]]) -> tuple[list[Mapping[Any, Any]], ...]:
    """Return the rows on strain rates: those above the tests, and all."""
    rates = [row for row in rows if row["limit"] == "strain_rate"]
    return [row for row in rates if row["outside"] and row["demand"] > row["largest"]], rates


def rate_clause(rows: Iterable[Mapping[Any, Any]]) -> str:
    """Return in how many runs strain rates are above those of the tests; empty if in none.

    For sentences that count or mark what is outside the range, and leave strain rates out.
    """
    out, rates = _rates(rows)
    if not out:
        return ""
    count = f"{len(runs_of(out))} of {counted(len(runs_of(rates)), 'run')}"
    return f"strain rates, which are above those tested in {count}"


def rate_note(rows: Iterable[Mapping[Any, Any]]) -> str:
    """Return a sentence on strain rates above those of the tests; empty if there are none.

    Most earthquakes exceed them, so this is a note and not a warning.
    """
    out, rates = _rates(rows)
    if not out:
        return ""
    worst = largest_by(out, lambda row: float(row["demand"] / row["largest"]))
    place = place_words(len(runs_of(out)), len(runs_of(rates)), str(worst["run"]))
    return (
        f"strain rates reach {worst['demand']:.2g}/s, "
        f"{worst['demand'] / worst['largest']:.2g} times the largest rate tested, "
        f"{worst['largest']:.2g}/s ({place}). Most earthquakes exceed the "
        "rates of bearing tests"
    )


def ring_note(rise: float) -> str:
    """Return a sentence on the rubber next to a warm lead core; empty where it stays cool."""
    if not rise > WARM_LEAD:
        return ""
    return (
        f"lead warms by up to {rise:.0f} K, and the rubber at the core nearly as much. Rubber "
        "temperatures are means of a layer, and damage of the rubber at the core is not modelled"
    )


def names_by_sentence(sentences: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return each sentence once, behind the names of all that have it.

    >>> names_by_sentence([("a", "cold"), ("b", "warm"), ("c", "cold")])
    [('a, c', 'cold'), ('b', 'warm')]
    """
    names: dict[str, list[str]] = {}
    for name, sentence in sentences:
        names.setdefault(sentence, []).append(name)
    return [
        (", ".join(same_sentence_names), sentence)
        for sentence, same_sentence_names in names.items()
    ]


def parted(warnings: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the warnings on the range behind a bearing's parameters, and the others."""
    on_validity: list[str] = []
    other_warnings: list[str] = []
    for text in warnings:
        group = on_validity if any(words in text for words in OF_VALIDITY) else other_warnings
        group.append(text)
    return on_validity, other_warnings


def largest_tested(rows: Iterable[Mapping[Any, Any]], run: str, limit: str) -> float:
    """Return the largest tested value of a quantity that a run exceeds; else infinity."""
    selected = [row for row in rows if (row["run"], row["limit"]) == (run, limit)]
    return min(
        (float(r["largest"]) for r in selected if r["demand"] > r["largest"]), default=np.inf
    )


def limits_passed(rows: Iterable[Mapping[Any, Any]], runs: Sequence[str]) -> list[str]:
    """Return the names of the limits that each run passes, for a column of a table."""
    passed = [(row["run"], str(row["limit"])) for row in rows if row["outside"]]
    return [" ".join(limit for name, limit in passed if name == run) for run in runs]
