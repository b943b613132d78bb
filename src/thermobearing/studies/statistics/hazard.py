"""Annual rate of exceedance of a capacity: hazard curve and fragility integrated.

The rate is the integral of the probability of exceedance over the rates of intensities,
lambda = int P(exceedance | im) |dH(im)| (Cornell 1996; Cornell and others 2002), by numerical
integration. Between its points a hazard curve is a power law. For a hazard H = k0 im^-k and a
lognormal fragility it is

    lambda = H(median) exp(k^2 beta^2 / 2)

the closed form of Cornell, C.A. (1996), Calculating building seismic performance reliability: a
basis for multi-level design norms, 11th World Conference on Earthquake Engineering, paper 2122.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.results.base import COMPLETED
from thermobearing.studies.definition.record import INTENSITY_UNITS
from thermobearing.studies.statistics.comparison import Bounds
from thermobearing.studies.statistics.demand import LEVEL, percentiles, widened
from thermobearing.studies.statistics.fragility import Fragility, describe_few
from thermobearing.studies.statistics.likelihood import UNREACHED
from thermobearing.tables.columns import plain_title, read_columns

# Names of the curve over all temperatures: of a climate or weather, or of a distribution.
CLIMATE, ALL_TEMPERATURES = "climate", "all temperatures"
TOGETHER = (CLIMATE, ALL_TEMPERATURES)
STEP = 0.02  # of the logarithm of intensity, at most, in the integral
MOST_STEPS = 10_000
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)  # Gauss points of a step
# Notes: probability of exceedance at the first intensity of the hazard curve; share of the rate
# that larger intensities than the last may add.
TOO_LATE, TOO_EARLY = 0.01, 0.05
RATE_OF_MISFIT = "the rate is that of a curve that contradicts its own runs"

RATE_OF_COUNTS = (
    "the counts determine no curve: low and high are the bounds of the rate that they allow, which "
    "has no estimate between"
)
RATE_OF_NONE = (
    "no run exceeds the capacity: the upper bound of the rate assumes a dispersion of "
    f"{UNREACHED:g} of the capacity"
)


@dataclass(frozen=True)
class Hazard:
    """Annual rate of exceedance of an intensity at a site."""

    intensity: Floats  # increasing, > 0, in the unit of the measure
    rate: Floats  # of exceedance [1/year], decreasing, > 0
    measure: str = ""  # of the intensity: "PGA" [m/s2], "PGV" [m/s], "Sa" [m/s2], or another

    def __post_init__(self) -> None:
        for name in ("intensity", "rate"):
            try:
                values = np.asarray(getattr(self, name), dtype=float)
            except (TypeError, ValueError):
                raise InputError(f"{name} of a hazard curve: must be a list of numbers") from None
            object.__setattr__(self, name, values)
        im, rate = self.intensity, self.rate
        if im.ndim != 1 or im.shape != rate.shape or len(im) < 2:
            raise InputError(
                "a hazard curve needs two lists of the same length, of 2 numbers or more"
            )
        for name, values, direction in (("intensity", im, "increase"), ("rate", rate, "decrease")):
            if not (np.isfinite(values) & (values > 0.0)).all():
                raise InputError(f"{name} of a hazard curve: must be greater than 0")
            wrong = np.flatnonzero(np.diff(values if direction == "increase" else -values) <= 0.0)
            if len(wrong):
                first, second = values[wrong[0] : wrong[0] + 2]
                raise InputError(
                    f"{name} of a hazard curve must {direction}, not go from {first:g} to "
                    f"{second:g}"
                )

    def at(self, intensity: Any) -> Floats:
        """Return the annual rate of exceedance of intensities; NaN outside the curve."""
        x = np.log(np.atleast_1d(np.asarray(intensity, dtype=float)))
        log_intensity = np.log(self.intensity)
        log_rate = np.interp(x, log_intensity, np.log(self.rate), left=np.nan, right=np.nan)
        return np.asarray(np.exp(log_rate))

    def _points(self) -> tuple[Floats, Floats]:
        """Return Gauss points between the points of the curve: intensities and annual rates."""
        x = np.log(self.intensity)
        steps = min(int(np.ceil((x[-1] - x[0]) / STEP)), MOST_STEPS)
        ends = np.unique(np.concatenate([x, np.linspace(x[0], x[-1], steps + 1)]))
        middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
        at = middle[:, None] + half[:, None] * POINTS
        # Between two points ln H is linear in ln im, so that |dH| = fall H d(ln im).
        fall = -np.diff(np.log(self.rate)) / np.diff(x)
        piece = np.clip(np.searchsorted(x, middle, side="right") - 1, 0, len(fall) - 1)
        intensity = np.exp(at)
        weight = (
            (half * fall[piece])[:, None] * WEIGHTS * self.at(intensity.ravel()).reshape(at.shape)
        )
        return np.asarray(intensity.ravel()), np.asarray(weight.ravel())


def load_hazard(path: str | Path, measure: str = "PGA") -> Hazard:
    """Return a hazard curve from a file with columns of intensity and of rate or return period."""
    unit = INTENSITY_UNITS[measure]
    name, period = plain_title(measure), "return period"
    units = {name: unit, "rate": "1/year", period: "year"}
    columns = read_columns(path, units, optional=("rate", period))
    if ("rate" in columns) == (period in columns):
        raise InputError("needs a column rate [1/year], or return_period [year]", str(path))
    try:
        if "rate" not in columns:
            if not (columns[period] > 0.0).all():
                raise InputError(f"{period}: must be greater than 0")
            columns["rate"] = 1.0 / columns[period]
        return Hazard(columns[name], columns["rate"], measure)
    except InputError as error:
        raise InputError(error.problems, str(path)) from None


@dataclass(frozen=True)
class Rate:
    """Annual rate of exceedance of a capacity."""

    rate: float  # [1/year]; NaN without a fragility curve, where counts may give bounds
    low: float  # ends of its band; if no motion exceeded the capacity, the rate is 0
    high: float
    family: Floats  # of each bootstrap sample
    notes: tuple[str, ...] = ()  # on intensities outside the hazard curve
    groups: int = 0  # motions that the bootstrap draws from; 0 where it does not matter
    outcome: str = COMPLETED  # that of the fragility curve, such as "contradicted"
    # of each sample, where counts give bounds; `family` has the lower bounds then
    largest: Floats | None = None

    @property
    def is_bounded(self) -> bool:
        """Whether the rate has bounds by counts in place of an estimate."""
        return self.largest is not None

    @property
    def upper(self) -> Floats:
        """The largest rate of each bootstrap sample."""
        return self.family if self.largest is None else self.largest

    @property
    def few_motions(self) -> str:
        """Why the rate has no band, "" if it has one; a bound of no exceedance is always one."""
        return describe_few(self.groups) if self.rate > 0.0 or self.is_bounded else ""

    @property
    def return_period(self) -> float:
        """Mean time between exceedances [year]."""
        return np.inf if self.rate == 0.0 else 1.0 / self.rate

    def probability(self, years: float) -> float:
        """Return the probability of an exceedance in some years (a Poisson process)."""
        return float(-np.expm1(-self.rate * years))


def _bounds_of_rate(bounds: Bounds, hazard: Hazard) -> tuple[float, float]:
    """Return the smallest and the largest rate of probabilities between bounds.

    The smallest rises at the largest intensity that it may, and the largest at the smallest.
    """
    begin, end = hazard.intensity[0], hazard.intensity[-1]
    rates = [hazard.at(np.clip(at, begin, end)) for at in (bounds.last, bounds.first)]
    rates[0] = np.where(bounds.last > end, 0.0, rates[0])
    smallest = float(np.diff(bounds.low, prepend=0.0) @ rates[0])
    largest = bounds.high[0] * hazard.rate[0] + np.diff(bounds.high, append=1.0) @ rates[1]
    return smallest, float(largest)


def annual_rate(curve: Fragility, hazard: Hazard) -> Rate:
    """Return the annual rate of exceedance of a capacity, or its bounds where there is no curve.

    Earthquakes above the last intensity of the hazard curve count with the probability there;
    those below the first do not count. The notes state where that may matter. Percentiles of a
    bootstrap may be biased: a band that does not contain the rate is extended to it.
    """
    at, weights = hazard._points()
    ends, last = hazard.intensity[[0, -1]], float(hazard.rate[-1])

    def _total(probability: Callable[[Any], Floats]) -> Floats:
        inner: Floats = probability(at) @ weights
        return np.asarray(inner + last * probability(ends[1:])[..., 0])

    samples = len(curve.estimate.samples.place)
    rate, least, most = 0.0, 0.0, 0.0
    pivots, family = np.zeros((2, samples))
    at_ends = np.zeros(2)  # probabilities at the ends of the hazard curve
    for share, estimate in curve.parts:
        if estimate.bounds is None:
            rate += share * float(_total(estimate.probability))
            pivots += share * _total(estimate.family)
            family += share * _total((estimate.drawn or estimate).family)
            at_ends += share * estimate.probability(ends)
        else:
            smallest, largest = _bounds_of_rate(estimate.bounds, hazard)
            least, most = least + share * smallest, most + share * largest
            at_ends += share * estimate.bounds.at_ends(*ends)
    is_bounded = most > 0.0 and curve.is_rising
    low = float(curve.ends((pivots + least)[:, None])[0][0])
    high = float(curve.ends((pivots + most)[:, None])[1][0])
    low, high = min(low, rate + least), max(high, rate + most)
    rate = np.nan if is_bounded or not curve.is_rising else rate
    return Rate(
        rate=rate,
        low=low if rate != 0.0 else 0.0,
        high=high,
        family=family + least,
        notes=_notes(curve, hazard, low if is_bounded else rate, at_ends),
        groups=curve.estimate.groups,
        outcome=curve.outcome,
        largest=family + most if is_bounded else None,
    )


def _notes(curve: Fragility, hazard: Hazard, rate: float, at_ends: Floats) -> tuple[str, ...]:
    """Return what limits a rate, from the probabilities at the ends of the hazard curve."""
    unit = INTENSITY_UNITS.get(hazard.measure, "").replace("^2", "\N{SUPERSCRIPT TWO}")
    begins, ends = (f"{float(im):.4g} {unit}".strip() for im in hazard.intensity[[0, -1]])
    notes = []
    if not curve.is_rising:
        return ()
    if at_ends[0] > TOO_LATE:
        notes.append(
            f"the hazard curve begins at {begins}, where the probability of exceedance is above "
            f"{100.0 * TOO_LATE:g} %: smaller earthquakes are not counted"
        )
    if hazard.rate[-1] * (1.0 - at_ends[1]) > TOO_EARLY * rate:
        notes.append(
            f"the hazard curve ends at {ends}: larger earthquakes may add more "
            f"than {100.0 * TOO_EARLY:g} % to the rate"
        )
    has_bounds = any(estimate.bounds is not None for _, estimate in curve.parts)
    if has_bounds:
        notes.append(RATE_OF_COUNTS)
    if curve.misfit:
        notes.append(RATE_OF_MISFIT)
    if rate == 0.0 and not has_bounds:
        notes.append(RATE_OF_NONE)
    return tuple(notes)


def ratio(rate: Rate, to: Rate, level: float = LEVEL) -> tuple[float, float, float]:
    """Return the ratio of two rates, whose bootstraps drew the same motions, and its band.

    Of rates with bounds there is no ratio; its band begins with the lower bound over the upper one
    of the other, and ends with the reverse. A band is extended to the ratio, as that of a rate.
    """
    if len(rate.family) != len(to.family):
        raise InputError("the bands of two rates need the same number of bootstrap samples")
    if any(np.isnan(side.rate) and not side.is_bounded for side in (rate, to)):
        return np.nan, np.nan, np.nan
    if rate.rate == to.rate == 0.0:
        return np.nan, np.nan, np.nan
    if rate is to:
        return 1.0, 1.0, 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient = float(np.divide(rate.rate, to.rate))
        lows, highs = rate.family / to.upper, rate.upper / to.family
    # Without samples that have no exceedance.
    lows, highs = lows[~np.isnan(lows)], highs[~np.isnan(highs)]
    if len(lows) == 0 or len(highs) == 0:
        return quotient, np.nan, np.nan
    confidence = widened(level, rate.groups)
    low = float(percentiles(lows[:, None], confidence)[0][0])
    high = float(percentiles(highs[:, None], confidence)[1][0])
    if np.isfinite(quotient):
        low, high = min(low, quotient), max(high, quotient)
    # A rate of zero has curves of its bound in place of a bootstrap, which lie above it.
    return quotient, low, np.inf if to.rate == 0.0 else high


def shares_of_time(levels: Sequence[float], temperatures: Any) -> Floats:
    """Return the share of the time of each temperature level.

    An hour between two levels counts for both by linear interpolation; an hour outside counts
    for the nearest level.
    """
    at = np.asarray(levels, dtype=float)
    values = np.asarray(temperatures, dtype=float).ravel()
    if len(at) == 0 or len(values) == 0 or not np.isfinite(values).all():
        raise InputError("needs temperature levels, and temperatures of the site without gaps")
    order = np.argsort(at, kind="stable")
    ordered = at[order]
    if (np.diff(ordered) <= 0.0).any():
        raise InputError("a temperature level is given twice")
    place = np.interp(values, ordered, np.arange(len(ordered), dtype=float))
    low = np.minimum(place.astype(int), max(len(ordered) - 2, 0))
    part = place - low
    shares = np.bincount(low, 1.0 - part, minlength=len(ordered))
    if len(ordered) > 1:
        shares += np.bincount(low + 1, part, minlength=len(ordered))
    shares_by_level = np.empty(len(ordered))
    shares_by_level[order] = shares / len(values)
    return shares_by_level
