"""Estimators of a fragility curve: stripes, capacities of single motions, a cloud.

Each returns the curve and those of all bootstrap samples; `fragility` cites the methods.

The likelihood of z exceedances in n runs at several intensities is that of Baker (2015), Eq. 11:
binomial terms with P = Phi(ln(im/theta)/beta). With slope b = 1/beta and intercept
a = -ln(theta)/beta it is a probit regression, whose log-likelihood is concave in a and b (Pratt
1981, JASA 76: 103-106), so that Newton's method finds the only maximum. All bootstrap samples are
estimated at once.

Baker, J. W. (2015). Efficient analytical fragility function fitting using dynamic structural
analysis. Earthquake Spectra 31(1): 579-599.

Where every motion was scaled until it reached the capacity, the estimates are those of Porter,
Kennedy & Bachman (2007, method A) and Baker (2015, Eq. 2 and 3): mean and sample deviation (n - 1)
of the logarithms. The capacity of a motion that did not reach it is above its largest intensity
(Baker 2015, truncated incremental dynamic analysis). A capacity before a collapse, or where the
demand rises faster than with the square of the intensity, is known to lie between two runs only.
The likelihood then is that of a censored normal sample, concave in slope and intercept (Olsen 1978,
Econometrica 46: 1211-1215; of intervals Pratt 1981).

Porter, K., Kennedy, R., Bachman, R. (2007). Creating fragility functions for performance-based
earthquake engineering. Earthquake Spectra 23(2): 471-489.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats, Ints
from thermobearing.results.base import COMPLETED
from thermobearing.studies.statistics.comparison import Bounds, least_runs
from thermobearing.studies.statistics.demand import Draw, equal_classes, widened

Bools = NDArray[np.bool_]
Link = Literal["probit", "logit"]
MOST_ROUNDS, MOST_HALVINGS = 60, 30
STEADY = 1e-10  # of a standard score: the largest change of the last step
FLAT = 1e-6  # slope of a curve that does not rise
UNREACHED = 0.6  # assumed dispersion of a capacity that no motion reached
ROOT_TWO_PI = 0.5 * np.log(2.0 * np.pi)
LEAST_FACTOR = 1e-200  # of a dispersion, below which the curve is a jump
STEEPEST = 3.0  # limit of the dispersion of an estimate over that of a bootstrap curve
LARGEST_LOGARITHM = 700.0  # of an intensity; exp overflows at 710
BISECTIONS = 60
SAME = 1e-12  # difference of logarithms by rounding
MOST_STRIPES = 200  # more intensities are put into as many classes
MORE_BETWEEN = "no run exceeds the capacity up to {0}, all do from {1}: add intensities between"
ONE_MIXED = (
    "only at {0} do some runs exceed the capacity and others not ({1:.0f} of {2:.0f} do): one "
    "intensity does not determine the dispersion; add {3}"
)
ALL_BETWEEN = "all curves reach the capacity between {0} and {1}: add intensities between"
# Outcomes without a curve.
NONE_BEYOND, ALL_BEYOND, NOT_RISING, APART = "none_beyond", "all_beyond", "not_rising", "apart"
ONE_BEYOND = "only one motion reaches the capacity: add larger intensities"
REASONS = {
    NONE_BEYOND: "no run exceeds the capacity: add larger intensities",
    ALL_BEYOND: "all runs exceed the capacity: add smaller intensities",
    NOT_RISING: "the share of exceedances does not rise with the intensity: add runs or "
    "intensities, or use another intensity measure",
}


@dataclass(frozen=True)
class Curves:
    """Curves P = F(slope (ln im - place)), F normal or logistic; one a row."""

    place: Floats  # logarithm of the median; infinite if none (+) or all (-) exceed the capacity
    slope: Floats  # one over the dispersion; infinite for a jump
    link: Link = "probit"  # "probit" or "logit"

    def probability(self, im: Floats) -> Floats:
        """Return the probability of exceedance at intensities, shape (curves, intensities)."""
        return self._at_distance(np.log(np.asarray(im, dtype=float))[None, :] - self.place[:, None])

    def _at_distance(self, distance: Floats) -> Floats:
        """Return the probability of each curve at distances of ln im from its median."""
        jump = np.isinf(self.slope)[:, None]
        steep = np.where(jump, 1.0, self.slope[:, None])
        score = np.where(jump & (distance != 0.0), np.copysign(np.inf, distance), steep * distance)
        return np.asarray(
            scipy.special.ndtr(score) if self.link == "probit" else scipy.special.expit(score)
        )

    def logarithm_at(self, share: float) -> Floats:
        """Return the logarithm of the intensity at which each curve has a probability."""
        inverse = scipy.special.ndtri if self.link == "probit" else scipy.special.logit
        return np.asarray(self.place + inverse(share) / self.slope)


def _terms(score: Floats, link: Link) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """Return ln P and ln(1 - P), their first and negative second derivatives by the score."""
    if link == "logit":
        yes, p = scipy.special.log_expit(score), scipy.special.expit(score)
        return yes, scipy.special.log_expit(-score), 1.0 - p, -p, p * (1.0 - p), p * (1.0 - p)
    yes, no = scipy.special.log_ndtr(score), scipy.special.log_ndtr(-score)
    # The ratios of density and probability come from logarithms: both underflow far out.
    density = -0.5 * score**2 - ROOT_TWO_PI
    up, down = np.exp(density - yes), np.exp(density - no)
    return yes, no, up, -down, up * (up + score), down * (down - score)


def _likelihood(score: Floats, yes: Floats, no: Floats, link: Link = "probit") -> Floats:
    """Return the logarithm of the likelihood of counts, without the binomial coefficients."""
    # Zero counts are left out, since zero times the logarithm of zero is no number.
    above, below = _terms(score, link)[:2]
    return np.asarray((np.where(yes > 0, yes * above, 0) + np.where(no > 0, no * below, 0)).sum(-1))


def _fit_curves(im: Floats, yes: Floats, no: Floats, link: Link = "probit") -> Curves:
    """Return the most likely curve of each row of counts.

    `im`: different intensities > 0; `yes`, `no`: numbers of exceedances and non-exceedances, shape
    (rows, intensities). Without a maximum of the likelihood, the curve is its limit: a jump
    half-way between two intensities, 0, 1, or a constant share if it does not rise.
    """
    x = np.log(im)
    place, slope, has_maximum = _limits(x, yes, no, link)
    if has_maximum.any():
        # Standardised logarithms, so that the start and the steps do not depend on the unit.
        centre, width = x.mean(), max(float(x.std()), 1e-12)
        a, b = _newton((x - centre) / width, yes[has_maximum], no[has_maximum], link)
        rising = b > FLAT
        constant = _score_of_share(yes[has_maximum], no[has_maximum], link)
        b = np.where(rising, b / width, FLAT)
        a = np.where(rising, a, constant)
        slope[has_maximum], place[has_maximum] = b, centre - a / b
    return Curves(place, slope, link)


def _score_of_share(yes: Floats, no: Floats, link: Link) -> Floats:
    above, below = yes.sum(-1), no.sum(-1)
    return np.asarray(
        scipy.special.ndtri(above / (above + below)) if link == "probit" else np.log(above / below)
    )


def _limits(x: Floats, yes: Floats, no: Floats, link: Link) -> tuple[Floats, Floats, Bools]:
    """Return the limit curves of counts without a maximum, and the rows that have one."""
    lowest_yes = np.where(yes > 0, x, np.inf).min(-1)
    highest_no = np.where(no > 0, x, -np.inf).max(-1)
    place = np.full(len(yes), np.nan)
    slope = np.full(len(yes), np.inf)
    none_beyond, all_beyond = np.isinf(lowest_yes), np.isinf(highest_no)
    place[none_beyond], place[all_beyond] = np.inf, -np.inf
    separated = ~none_beyond & ~all_beyond & (highest_no <= lowest_yes)
    place[separated] = _between(
        x, yes[separated], no[separated], highest_no[separated], lowest_yes[separated]
    )
    slope[none_beyond | all_beyond] = 1.0  # any: the place is infinite
    # Separated in the wrong order, or at one intensity: the share does not rise.
    highest_yes = np.where(yes > 0, x, -np.inf).max(-1)
    lowest_no = np.where(no > 0, x, np.inf).min(-1)
    has_maximum = ~none_beyond & ~all_beyond & ~separated
    falls = has_maximum & (highest_yes <= lowest_no)
    slope[falls] = FLAT
    # FLAT (x - place) is the score of the share of all runs, at the mean intensity.
    place[falls] = x.mean() - _score_of_share(yes[falls], no[falls], link) / FLAT
    return place, slope, has_maximum & ~falls


def _between(x: Floats, yes: Floats, no: Floats, highest_no: Floats, lowest_yes: Floats) -> Floats:
    """Return where separated counts pass one half: midway between the adjacent intensities.

    If one intensity has both outcomes, it is between this one and the next above if fewer than
    half of its runs exceed the capacity, and the next below if more do.
    """
    mixed = (x == highest_no[:, None]) & (x == lowest_yes[:, None])
    # Exceedances less non-exceedances at the intensity with both.
    excess = np.where(mixed, yes - no, 0.0).sum(-1)
    occupied = yes + no > 0
    above = np.where(occupied & (x > highest_no[:, None]), x, np.inf).min(-1)
    below = np.where(occupied & (x < lowest_yes[:, None]), x, -np.inf).max(-1)
    upper = np.where((excess < 0.0) & np.isfinite(above), above, lowest_yes)
    lower = np.where((excess > 0.0) & np.isfinite(below), below, highest_no)
    return np.asarray(0.5 * (lower + upper))


def _newton(x: Floats, yes: Floats, no: Floats, link: Link) -> tuple[Floats, Floats]:
    share = yes.sum(-1) / (yes + no).sum(-1)

    def _value(a: Floats, b: Floats) -> Floats:
        return _likelihood(a[:, None] + b[:, None] * x, yes, no, link)

    def _derivatives(a: Floats, b: Floats) -> tuple[Floats, ...]:
        _, _, up, down, bend_up, bend_down = _terms(a[:, None] + b[:, None] * x, link)
        slope = yes * up + no * down
        weight = yes * bend_up + no * bend_down
        rise = slope.sum(-1), (slope * x).sum(-1)
        return *rise, weight.sum(-1), (weight * x).sum(-1), (weight * x**2).sum(-1)

    return _maximise(
        _value, _derivatives, np.asarray(scipy.special.ndtri(share)), np.zeros(len(yes))
    )


def _maximise(
    value: Callable[[Floats, Floats], Floats],
    derivatives: Callable[[Floats, Floats], tuple[Floats, ...]],
    a: Floats,
    b: Floats,
    *,
    positive: bool = False,
) -> tuple[Floats, Floats]:
    """Return intercepts and slopes that maximise a concave likelihood, by Newton's method."""
    for _ in range(MOST_ROUNDS):
        g0, g1, h0, h1, h2 = derivatives(a, b)
        # The solution of two equations; h is the negative matrix of second derivatives.
        area = np.maximum(h0 * h2 - h1**2, 1e-300)
        da, db = (h2 * g0 - h1 * g1) / area, (h0 * g1 - h1 * g0) / area
        step = np.ones(len(b))
        # A step that would make the slope negative goes half-way to zero.
        if positive:
            step = np.where(b + db > 0.0, 1.0, 0.5 * b / np.maximum(-db, 1e-300))
        # Far from the maximum Newton's step can go beyond it and down again: it is halved until the
        # likelihood does not decrease by more than rounding.
        current = value(a, b)
        for _ in range(MOST_HALVINGS):
            worse = value(a + step * da, b + step * db) < current - 1e-12 * (1.0 + abs(current))
            if not worse.any():
                break
            step = np.where(worse, 0.5 * step, step)
        da, db = step * da, step * db
        a, b = a + da, b + db
        if max(np.abs(da).max(), np.abs(db / b if positive else db).max()) < STEADY:
            break
    return a, b


def pivoted(best: Curves, samples: Curves, groups: int, level: float) -> Curves:
    """Return studentised curves of a bootstrap of `groups`: draws of the true curve.

    The error of a bootstrap curve, in units of its dispersion, is distributed as that of the
    estimate: median and logarithm of the dispersion are reflected (Davison & Hinkley 1997, 2.4 and
    5.2). A bootstrap of n groups is too narrow by sqrt(n / (n - 1)); the spread of the dispersion
    is that of `widened` for the confidence `level`. Ratios are limited by `STEEPEST`, since a jump
    has no dispersion. Flat curves stay.
    """
    if not (np.isfinite(best.place[0]) and 2.0 * FLAT < best.slope[0] < np.inf):
        return samples
    widening = np.sqrt(groups / max(groups - 1.0, 1.0))
    ndtri = scipy.special.ndtri
    exponent = ndtri(0.5 + 0.5 * widened(level, groups)) / ndtri(0.5 + 0.5 * level)
    rising = np.isfinite(samples.place) & (samples.slope > 2.0 * FLAT)
    place, slope = samples.place.copy(), samples.slope.copy()
    ratio = slope[rising] / best.slope[0]
    distance = np.minimum(ratio, STEEPEST) * (place[rising] - best.place[0])
    place[rising] = best.place[0] - widening * distance
    factor = np.minimum(ratio**exponent, STEEPEST)
    # With two or three motions the exponent is so large that the dispersion may have no digits.
    jump = np.full(len(factor), np.inf)
    slope[rising] = np.divide(best.slope[0], factor, out=jump, where=factor > LEAST_FACTOR)
    return Curves(place, slope, samples.link)


def unreached(largest: Floats, shares: Floats) -> Curves:
    """Return curves for which no motion exceeds the capacity with the given probabilities.

    `largest`: largest intensity of each motion. For probabilities evenly spread over (0, 1) the
    percentiles are the bounds of Clopper & Pearson (1934, Biometrika 26: 404-413) for no success.
    """
    # The logarithm of the probability that no motion exceeds the capacity, for assumed medians from
    # far below to far above all intensities; interpolated at the wanted probabilities.
    x = np.log(largest)
    place = np.linspace(x.min() - 8.0 * UNREACHED, x.max() + 8.0 * UNREACHED, 2000)
    none = scipy.special.log_ndtr((place - x[:, None]) / UNREACHED).sum(axis=0)
    return Curves(np.interp(np.log(shares), none, place), np.full(len(shares), 1.0 / UNREACHED))


def least_median(largest: Floats, level: float) -> float:
    """Return the intensity above which the median is, if no motion exceeds the capacity.

    `largest`: largest intensity of each motion. Below the median each motion exceeds the capacity
    with a probability of one half or less, so that n motions of which none does exclude a median
    at or below the smallest of their largest intensities, if 1 / 2^n is not above the probability
    outside one end of the band (sign test: six motions at 95 %). NaN of fewer motions.

    >>> least_median(np.array([3.0, 3.0, 3.0, 3.0, 2.0, 2.0, 1.0]), 0.95)
    2.0
    """
    needed = least_runs(level)
    return float(np.sort(largest)[-needed]) if len(largest) >= needed else np.nan


class _Capacities(NamedTuple):
    """Logarithms of capacities: values, and bounds of those that are known to lie between two."""

    exact: Floats
    low: Floats  # of the others; minus infinity for a collapse at the smallest intensity
    high: Floats  # plus infinity for a motion that did not reach the capacity


def _fit_capacities(sample: _Capacities, weight: Floats, weight_between: Floats) -> Curves:
    """Return the most likely lognormal distribution of capacities, for each row of weights.

    Without a maximum of the likelihood the curve is its limit: never reached, or a jump.
    """
    count = weight.sum(-1)
    divisor = np.maximum(count, 1.0)
    mean = (weight * sample.exact).sum(-1) / divisor
    spread = (weight * (sample.exact - mean[:, None]) ** 2).sum(-1)
    deviation = np.sqrt(spread / np.maximum(count - 1.0, 1.0))
    present = weight_between > 0
    # What all capacities could have in common: the largest lower and the smallest upper bound.
    low = np.where(present, sample.low, -np.inf).max(-1, initial=-np.inf)
    high = np.where(present, sample.high, np.inf).min(-1, initial=np.inf)
    reached = (count > 0) | (present & np.isfinite(sample.high)).any(-1)
    equal = deviation <= SAME
    place, slope = np.where(count > 0, mean, np.inf), np.full(len(count), np.inf)
    differing = ~present.any(-1) & ~equal
    slope[differing] = 1.0 / deviation[differing]
    between = reached & (count == 0) & (low <= high)
    ends = np.where(np.isfinite(low), low, high), high
    place[between] = 0.5 * (ends[0] + ends[1])[between]
    slope[~reached] = 1.0
    in_common = np.where(count > 0, equal & (low <= mean) & (mean <= high), low <= high)
    free = present.any(-1) & reached & ~in_common
    if free.any():
        place[free], slope[free] = _fit_between(sample, weight[free], weight_between[free])
    return Curves(place, slope)


def _fit_between(sample: _Capacities, w: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Return place and slope of an interval-censored normal sample; scores are a + b y."""
    inside = np.where(np.isfinite(sample.high), sample.high, sample.low)
    inside = 0.5 * (inside + np.where(np.isfinite(sample.low), sample.low, inside))
    centre = float(np.concatenate([sample.exact, inside]).mean())
    y, c = sample.exact - centre, inside - centre
    ends = sample.low - centre, sample.high - centre
    n, first, second = w.sum(-1), (w * y).sum(-1), (w * y**2).sum(-1)
    total = n + v.sum(-1)
    mean = (first + (v * c).sum(-1)) / total
    variance = (second + (v * c**2).sum(-1)) / total - mean**2
    # The start is the mean and the deviation of all, as if the middle were the capacity.
    b = 1.0 / np.sqrt(np.maximum(variance, 1e-6))

    def _value(a: Floats, b: Floats) -> Floats:
        low, high = (a[:, None] + b[:, None] * end for end in ends)
        between = (v * _log_between(low, high)).sum(-1)
        return np.asarray(
            n * np.log(b) - 0.5 * (n * a**2 + 2.0 * a * b * first + b**2 * second) + between
        )

    def _derivatives(a: Floats, b: Floats) -> tuple[Floats, ...]:
        scores = [a[:, None] + b[:, None] * end for end in ends]
        logarithm = _log_between(*scores)
        # Density over the probability, times powers of the bound and of its score; bounds that are
        # infinite have no density.
        sums = np.zeros((5, *logarithm.shape))
        for sign, end, score in zip((-1.0, 1.0), ends, scores, strict=True):
            at, z = np.where(np.isfinite(end), end, 0.0), np.where(np.isfinite(end), score, 0.0)
            density = np.exp(-0.5 * z**2 - ROOT_TWO_PI - logarithm)
            rate = np.where(np.isfinite(end), sign * density, 0.0)
            sums += rate, rate * at, rate * z, rate * z * at, rate * z * at**2
        r0, r1, s0, s1, s2 = sums
        bends = ((v * bend).sum(-1) for bend in (s0 + r0**2, s1 + r0 * r1, s2 + r1**2))
        h0, h1, h2 = bends
        g0 = -(n * a + b * first) + (v * r0).sum(-1)
        g1 = n / b - (a * first + b * second) + (v * r1).sum(-1)
        return g0, g1, n + h0, first + h1, n / b**2 + second + h2

    a, b = _maximise(_value, _derivatives, -mean * b, b, positive=True)
    return centre - a / b, b


def _log_between(low: Floats, high: Floats) -> Floats:
    """Return the logarithm of the normal probability between two scores."""
    # In the upper half the complements are small, and their difference has its digits.
    upper = low + high > 0.0
    above, below = np.where(upper, -low, high), np.where(upper, -high, low)
    largest = scipy.special.log_ndtr(above)
    part = -np.expm1(np.minimum(scipy.special.log_ndtr(below) - largest, -1e-15))
    return np.asarray(largest + np.log(part))


@dataclass(frozen=True)
class Estimate:
    """A curve, and the curves that its band is made of."""

    best: Curves  # the most likely curve
    samples: Curves  # of the bootstrap
    # logistic curves of the probability of collapse, of both; None without
    collapse: Curves | None = None
    collapses: Curves | None = None
    outcome: str = COMPLETED  # "completed", or why there is no curve
    sentence: str = ""  # the same in words, and what to try
    # the estimate with the curves as the bootstrap drew them, where `samples` are pivots
    drawn: "Estimate | None" = None
    groups: int = 0  # that the bootstrap draws from; 0 where it does not matter
    least_median: float = np.nan  # intensity; lower end of the median where no run is beyond
    between: int = 0  # number of curves of IDA whose capacity is known to lie between two runs
    ratio: float = 1.0  # of the intensities of such runs, if these are most of the curves
    bounds: Bounds | None = None  # of the probability, where counts determine no curve

    @property
    def known(self) -> bool:
        """Whether there is a curve."""
        return self.outcome == COMPLETED

    def probability(self, intensity: Floats) -> Floats:
        """Return the probability of exceedance at intensities."""
        return np.asarray(_with_collapse(self.best, self.collapse, intensity)[0])

    def family(self, intensity: Floats) -> Floats:
        """Return that of all curves of the band: shape (curves, intensities)."""
        return _with_collapse(self.samples, self.collapses, intensity)

    @property
    def median(self) -> float:
        """Logarithm of the intensity with a probability of one half."""
        return float(_medians(self.best, self.collapse)[0])

    @property
    def dispersion(self) -> float:
        """Standard deviation of the logarithm of the capacity, see `_dispersions`."""
        return float(_dispersions(self.best, self.collapse)[0])

    @property
    def medians(self) -> Floats:
        """That of all curves of the band."""
        return _medians(self.samples, self.collapses)

    @property
    def dispersions(self) -> Floats:
        """That of all curves of the band."""
        return _dispersions(self.samples, self.collapses)


def _medians(curves: Curves, collapse: Curves | None) -> Floats:
    return curves.place if collapse is None else _reached(curves, collapse, 0.5)


def _dispersions(curves: Curves, collapse: Curves | None) -> Floats:
    """Return the standard deviation of ln im; with collapse, half of that from 16 to 84 %.

    Between those probabilities, Phi(-1) and Phi(1), a lognormal curve has two standard deviations.
    """
    if collapse is None:
        with np.errstate(divide="ignore"):
            return 1.0 / curves.slope
    low, high = (_reached(curves, collapse, float(scipy.special.ndtr(z))) for z in (-1.0, 1.0))
    # A constant share of collapse above 84 % has neither end.
    differing = np.isfinite(low) | np.isfinite(high)
    return np.asarray(0.5 * np.subtract(high, low, out=np.full(len(low), np.inf), where=differing))


def _reached(curves: Curves, collapse: Curves, share: float) -> Floats:
    """Return the logarithm of the intensity at which each curve with collapse has a probability.

    Both terms rise, so that bisection finds it. Minus infinity where the share of collapse alone is
    larger at every intensity.
    """
    # The larger term alone has at most the probability, and both together at least the larger.
    high = np.minimum(curves.logarithm_at(share), collapse.logarithm_at(share))
    low = np.minimum(curves.logarithm_at(0.5 * share), collapse.logarithm_at(0.5 * share))
    low, high = (np.clip(end, -LARGEST_LOGARITHM, LARGEST_LOGARITHM) for end in (low, high))
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        under = _at_each(curves, collapse, middle) < share
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    ends = np.where(high <= -LARGEST_LOGARITHM + 1.0, -np.inf, high)
    return np.asarray(np.where(ends >= LARGEST_LOGARITHM - 1.0, np.inf, ends))


def _at_each(curves: Curves, collapse: Curves, logarithm: Floats) -> Floats:
    """Return the probability with collapse of each curve at its own intensity."""
    below, standing = (
        1.0 - curve._at_distance((logarithm - curve.place)[:, None])[:, 0]
        for curve in (curves, collapse)
    )
    return np.asarray(1.0 - below * standing)


def _with_collapse(curves: Curves, collapse: Curves | None, intensity: Floats) -> Floats:
    beyond = curves.probability(intensity)
    if collapse is None:
        return beyond
    share = collapse.probability(intensity)
    return beyond * (1.0 - share) + share


def _classes(at: Floats) -> tuple[Floats, Ints]:
    """Return intensities, of many those of equal classes, and the index of that of each run."""
    levels, place = np.unique(at, return_inverse=True)
    if len(levels) <= MOST_STRIPES:
        return levels, place
    place = equal_classes(at, MOST_STRIPES)
    means = np.bincount(place, np.log(at)) / np.bincount(place)
    return np.exp(means), place


def counts(at: Floats, beyond: Bools, name: str) -> "pd.DataFrame":
    """Return the numbers of runs and of exceedances at each intensity or class, with its ends."""
    levels, place = _classes(at)
    runs = np.bincount(place, minlength=len(levels))
    over = np.bincount(place, beyond, minlength=len(levels)).astype(int)
    first, last = np.full((2, len(levels)), [[np.inf], [-np.inf]])
    np.minimum.at(first, place, at)
    np.maximum.at(last, place, at)
    ends = {"first": first, "last": last}
    return pd.DataFrame({name: levels, "runs": runs, "beyond": over} | ends)


def _counted(
    at: Floats, beyond: Bools, draw: Draw
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return intensities, exceedances and non-exceedances at each, and those of all samples."""
    levels, place = _classes(at)
    size = len(levels)
    yes, no = (
        np.bincount(place, part, minlength=size).astype(float)[None, :]
        for part in (beyond, ~beyond)
    )
    if draw.alone:  # resampled within each stripe: a binomial number
        runs = (yes + no)[0]
        shape = (draw.samples, size)
        drawn = np.random.default_rng(draw.seed).binomial(
            runs.astype(int), yes[0] / runs, size=shape
        )
        beyond_samples = drawn.astype(float)
        return levels, yes, no, beyond_samples, runs - beyond_samples
    cells = np.zeros((draw.count, 2 * size))
    np.add.at(cells, (draw.groups, place + np.where(beyond, 0, size)), 1.0)
    beyond_samples = draw.group_sums(cells)
    return levels, yes, no, beyond_samples[:, :size], beyond_samples[:, size:]


def with_intensity_unit(intensity: float, unit: str) -> str:
    """Return an intensity with its unit, "12.75 m/s²"; `unit` may be ""."""
    return f"{intensity:.4g} {unit}".rstrip()


def stripes(at: Floats, beyond: Bools, draw: Draw, unit: str = "") -> Estimate:
    """Return the most likely lognormal curve of counts, from an entry for each run."""
    levels, yes, no, beyond_samples, below_samples = _counted(at, beyond, draw)
    best = _fit_curves(levels, yes, no)
    outcome, sentence = _why_not(levels, yes[0], no[0], best, unit)
    samples = _fit_curves(levels, beyond_samples, below_samples)
    return Estimate(best, samples, outcome=outcome, sentence=sentence)


def _why_not(levels: Floats, yes: Floats, no: Floats, best: Curves, unit: str) -> tuple[str, str]:
    if not yes.any() or not no.any():
        outcome = ALL_BEYOND if yes.any() else NONE_BEYOND
        return outcome, REASONS[outcome]
    if np.isinf(best.slope[0]):
        last, first = levels[no > 0].max(), levels[yes > 0].min()
        if last == first:
            index = int(np.flatnonzero(levels == first)[0])
            ends = [word for word, end in (("smaller", 0), ("larger", -1)) if levels[end] == first]
            advice = f"{' and '.join(ends)} intensities" if ends else "intensities close to it"
            runs = yes[index] + no[index]
            only = with_intensity_unit(first, unit)
            return APART, ONE_MIXED.format(only, yes[index], runs, advice)
        ends_between = (with_intensity_unit(end, unit) for end in (last, first))
        return APART, MORE_BETWEEN.format(*ends_between)
    if best.slope[0] <= FLAT:
        return NOT_RISING, REASONS[NOT_RISING]
    return COMPLETED, ""


def incremental(table: "pd.DataFrame", groups: Ints, draw: Draw, unit: str = "") -> Estimate:
    """Return the lognormal curve of the intensities (`Ida.crossings`) that reach a capacity."""
    low, high = (table[name].to_numpy(dtype=float) for name in ("low", "high"))
    exact, reached = low == high, np.isfinite(high)
    with np.errstate(divide="ignore"):
        sample = _Capacities(*map(np.log, (low[exact], low[~exact], high[~exact])))
    # Without motions each curve is drawn alone, not each of its runs.
    if draw.alone:
        draw = Draw.of_labels(None, len(table), draw.samples, draw.seed[0])
        groups = draw.groups
    unit_weights = np.ones((1, len(groups)))
    best = _fit_capacities(sample, unit_weights[:, exact], unit_weights[:, ~exact])
    parts = [
        _fit_capacities(sample, weights[:, groups[exact]], weights[:, groups[~exact]])
        for weights in draw.weights()
    ]
    place = np.concatenate([part.place for part in parts])
    samples = Curves(place, np.concatenate([part.slope for part in parts]))
    if not reached.any():
        return Estimate(best, samples, outcome=NONE_BEYOND, sentence=REASONS[NONE_BEYOND])
    between = ~exact & reached
    if np.isinf(best.slope[0]):
        sentence = ONE_BEYOND
        if between.sum() > 1:
            ends = (
                with_intensity_unit(low[~exact].max(), unit),
                with_intensity_unit(high[between].min(), unit),
            )
            sentence = ALL_BETWEEN.format(*ends)
        return Estimate(best, samples, outcome=APART, sentence=sentence)
    ratios = high[between & (low > 0.0)] / low[between & (low > 0.0)]
    ratio = float(np.median(ratios)) if 2 * between.sum() > reached.sum() and len(ratios) else 1.0
    return Estimate(best, samples, between=int(between.sum()), ratio=ratio)


def cloud(at: Floats, demand: Floats, capacity: float, draw: Draw) -> Estimate:
    """Return the lognormal curve of a regression of demands, of which infinite ones collapse."""
    stood = np.isfinite(demand)
    if stood.sum() < 3 or len(np.unique(at[stood])) < 2:
        raise InputError(
            f"{stood.sum()} runs did not collapse: a regression needs three at two intensities"
        )
    # The regression line of y = ln(demand / capacity) is zero at the median intensity.
    x = np.where(stood, np.log(at), 0.0)
    y = np.where(stood, np.log(np.where(stood, demand, 1.0) / capacity), 0.0)
    # Deviations from the means keep the digits of the sums of squares.
    x_mean, y_mean = x[stood].mean(), y[stood].mean()
    x, y = np.where(stood, x - x_mean, 0.0), np.where(stood, y - y_mean, 0.0)
    terms = np.column_stack([stood.astype(float), x, y, x * x, x * y, y * y])
    best = _line(terms.sum(axis=0)[None, :], x_mean, y_mean)
    samples = _line(draw.sums(terms), x_mean, y_mean)
    outcome = COMPLETED if best.slope[0] > FLAT else NOT_RISING
    sentence = REASONS.get(outcome, "")
    if stood.all():
        return Estimate(best, samples, outcome=outcome, sentence=sentence)
    levels, yes, no, beyond_samples, below_samples = _counted(at, ~stood, draw)
    collapse = _fit_curves(levels, yes, no, "logit")
    collapses = _fit_curves(levels, beyond_samples, below_samples, "logit")
    return Estimate(best, samples, collapse, collapses, outcome, sentence)


def _line(sums: Floats, x_mean: float, y_mean: float) -> Curves:
    """Return curves of the regression from sums of 1, x, y, xx, xy, yy; flat where it falls."""
    n, x, y, xx, xy, yy = sums.T
    divisor = np.maximum(n, 1.0)
    # Least squares: the slope, and the deviation of the residuals with n - 2 degrees of freedom.
    across = xx - x * x / divisor
    with np.errstate(divide="ignore", invalid="ignore"):
        b = np.where(across > 1e-12 * divisor, (xy - x * y / divisor) / across, 0.0)
        residual_squares = np.maximum(yy - y * y / divisor - b * (xy - x * y / divisor), 0.0)
        sigma = np.sqrt(residual_squares / np.maximum(n - 2.0, 1.0))
        # ln(demand / capacity) at ln im = 0.
        intercept = y_mean + y / divisor - b * (x_mean + x / divisor)
        rising = b > FLAT
        slope = np.where(rising, np.where(sigma > 0.0, b / sigma, np.inf), FLAT)
        flat = -np.where(sigma > 0.0, intercept / sigma, 0.0) / FLAT
        place = np.where(rising, -intercept / b, flat)
    return Curves(place, slope)
