"""Yes or no against the logarithm of an intensity: probit and logit curves by maximum likelihood.

The likelihood of z of n runs beyond a capacity at each of some intensities is that of Baker
(2015), Eq. 11: binomial terms with P = Phi(ln(im/theta)/beta). With slope b = 1/beta and intercept
a = -ln(theta)/beta it is a probit regression, whose logarithm is concave in a and b (Pratt 1981,
JASA 76: 103-106), so that Newton's method finds the only maximum. The fits of all bootstrap
samples are made side by side.

Baker, J. W. (2015). Efficient analytical fragility function fitting using dynamic structural
analysis. Earthquake Spectra 31(1): 579-599.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit, log_expit, log_ndtr, ndtr, ndtri

from thermobearing.studies.resampling import widened

Floats = NDArray[np.float64]
Link = Literal["probit", "logit"]
MOST_ROUNDS, MOST_HALVINGS = 60, 30
STEADY = 1e-10  # of a standard score: the largest change of the last step
FLAT = 1e-6  # slope of a curve that does not rise
UNREACHED = 0.6  # dispersion that bounds a capacity that no motion reached; chosen
ROOT_TWO_PI = 0.5 * np.log(2.0 * np.pi)
STEEPEST = 3.0  # dispersion of an estimate over that of a bootstrap curve; chosen, as of 6 motions
RAYS = 240  # on which the edge of a likelihood region is looked for
BISECTIONS = 30


@dataclass(frozen=True)
class Curves:
    """Curves P = F(slope (ln im - place)), F normal or logistic; one a row.

    Attributes
    ----------
    place : logarithm of the median; infinite where none (+) or all (-) are beyond.
    slope : one over the dispersion; infinite for a jump.
    link : "probit" or "logit".
    """

    place: Floats
    slope: Floats
    link: Link = "probit"

    def probability(self, im: Floats) -> Floats:
        """Of being beyond, at intensities: shape (curves, intensities)."""
        away = np.log(np.asarray(im, dtype=float))[None, :] - self.place[:, None]
        jump = np.isinf(self.slope)[:, None]
        steep = np.where(jump, 1.0, self.slope[:, None])
        score = np.where(jump & (away != 0.0), np.copysign(np.inf, away), steep * away)
        return np.asarray(ndtr(score) if self.link == "probit" else expit(score))


def _terms(score: Floats, link: Link) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """Logarithms of P and 1 - P, their first and (negative) second derivatives in the score."""
    if link == "logit":
        yes, p = log_expit(score), expit(score)
        return yes, log_expit(-score), 1.0 - p, -p, p * (1.0 - p), p * (1.0 - p)
    yes, no = log_ndtr(score), log_ndtr(-score)
    density = -0.5 * score**2 - ROOT_TWO_PI
    up, down = np.exp(density - yes), np.exp(density - no)
    return yes, no, up, -down, up * (up + score), down * (down - score)


def likelihood(score: Floats, yes: Floats, no: Floats, link: Link = "probit") -> Floats:
    """Logarithm of the likelihood of counts, without the binomial coefficients."""
    above, below = _terms(score, link)[:2]
    return np.asarray((np.where(yes > 0, yes * above, 0) + np.where(no > 0, no * below, 0)).sum(-1))


def fit_curves(im: Floats, yes: Floats, no: Floats, link: Link = "probit") -> Curves:
    """The likeliest curve of each row of counts.

    Parameters
    ----------
    im : intensities that the counts are of, > 0, each once.
    yes, no : runs beyond and not beyond, shape (rows, intensities).
    link : "probit" for a lognormal curve, "logit" for a logistic one.

    Returns
    -------
    Curves : where counts have no likeliest curve, the limit that the likelihood rises to: a jump
        half-way between the intensities it lies between, nothing, everything, or (where the share
        does not rise with intensity) the same share everywhere.
    """
    x = np.log(im)
    place, slope, open_ = _limits(x, yes, no, link)
    if open_.any():
        centre, width = x.mean(), max(float(x.std()), 1e-12)
        a, b = _newton((x - centre) / width, yes[open_], no[open_], link)
        rising = b > FLAT
        same = _score_of_share(yes[open_], no[open_], link)
        b = np.where(rising, b / width, FLAT)
        a = np.where(rising, a, same)
        slope[open_], place[open_] = b, centre - a / b
    return Curves(place, slope, link)


def _score_of_share(yes: Floats, no: Floats, link: Link) -> Floats:
    """Score of the share beyond at all intensities together."""
    above, below = yes.sum(-1), no.sum(-1)
    return np.asarray(ndtri(above / (above + below)) if link == "probit" else np.log(above / below))


def _limits(
    x: Floats, yes: Floats, no: Floats, link: Link
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Curves of counts that have no likeliest one, and which rows have one."""
    lowest_yes = np.where(yes > 0, x, np.inf).min(-1)
    highest_no = np.where(no > 0, x, -np.inf).max(-1)
    place = np.full(len(yes), np.nan)
    slope = np.full(len(yes), np.inf)
    none, every = np.isinf(lowest_yes), np.isinf(highest_no)
    place[none], place[every] = np.inf, -np.inf
    apart = ~none & ~every & (highest_no <= lowest_yes)
    place[apart] = _between(x, yes[apart], no[apart], highest_no[apart], lowest_yes[apart])
    slope[none | every] = 1.0
    # Apart the wrong way round, or at one intensity: no curve rises through them.
    highest_yes = np.where(yes > 0, x, -np.inf).max(-1)
    lowest_no = np.where(no > 0, x, np.inf).min(-1)
    open_ = ~none & ~every & ~apart
    falls = open_ & (highest_yes <= lowest_no)
    slope[falls] = FLAT
    place[falls] = x.mean() - _score_of_share(yes[falls], no[falls], link) / FLAT
    return place, slope, open_ & ~falls


def _between(x: Floats, yes: Floats, no: Floats, highest_no: Floats, lowest_yes: Floats) -> Floats:
    """Where counts that are apart pass one half: amid the two intensities on both sides of it.

    At one intensity some may be beyond and some not; with less than half of them it is passed
    between that one and the next above, with more between it and the next below.
    """
    here = (x == highest_no[:, None]) & (x == lowest_yes[:, None])
    more = np.where(here, yes - no, 0.0).sum(-1)  # beyond than not, where both are
    met = yes + no > 0
    above = np.where(met & (x > highest_no[:, None]), x, np.inf).min(-1)
    below = np.where(met & (x < lowest_yes[:, None]), x, -np.inf).max(-1)
    upper = np.where((more < 0.0) & np.isfinite(above), above, lowest_yes)
    lower = np.where((more > 0.0) & np.isfinite(below), below, highest_no)
    return np.asarray(0.5 * (lower + upper))


def _newton(x: Floats, yes: Floats, no: Floats, link: Link) -> tuple[Floats, Floats]:
    """Intercepts and slopes of the maxima, one for each row of counts."""
    share = yes.sum(-1) / (yes + no).sum(-1)
    a, b = np.asarray(ndtri(share)), np.zeros(len(yes))

    def value(a: Floats, b: Floats) -> Floats:
        return likelihood(a[:, None] + b[:, None] * x, yes, no, link)

    for _ in range(MOST_ROUNDS):
        score = a[:, None] + b[:, None] * x
        _, _, up, down, bend_up, bend_down = _terms(score, link)
        slope = yes * up + no * down
        weight = yes * bend_up + no * bend_down
        rise = slope.sum(-1), (slope * x).sum(-1)
        bend = weight.sum(-1), (weight * x).sum(-1), (weight * x**2).sum(-1)
        da, db = uphill(value, a, b, rise, bend)
        a, b = a + da, b + db
        if max(float(np.abs(da).max()), float(np.abs(db).max())) < STEADY:
            break
    return a, b


def uphill(
    value: Callable[[Floats, Floats], Floats],
    a: Floats,
    b: Floats,
    rise: tuple[Floats, Floats],
    bend: tuple[Floats, Floats, Floats],
    *,
    positive: bool = False,
) -> tuple[Floats, Floats]:
    """Newton's step of intercepts and slopes, halved as long as the likelihood would fall.

    Parameters
    ----------
    value : logarithm of the likelihood, concave.
    a, b : intercepts and slopes.
    rise, bend : its first derivatives (a, b), its second ones with the sign changed (aa, ab, bb).
    positive : b stays above zero.
    """
    (g0, g1), (h0, h1, h2) = rise, bend
    area = np.maximum(h0 * h2 - h1**2, 1e-300)
    da, db = (h2 * g0 - h1 * g1) / area, (h0 * g1 - h1 * g0) / area
    step = np.ones(len(b))
    if positive:
        step = np.where(b + db > 0.0, 1.0, 0.5 * b / np.maximum(-db, 1e-300))
    now = value(a, b)
    for _ in range(MOST_HALVINGS):
        worse = value(a + step * da, b + step * db) < now - 1e-12 * (1.0 + abs(now))
        if not worse.any():
            break
        step = np.where(worse, 0.5 * step, step)
    return step * da, step * db


def pivoted(best: Curves, others: Curves, groups: int, level: float) -> Curves:
    """Return curves of the bootstrap as draws of the true curve: the studentised bootstrap.

    A bootstrap curve misses the estimate, in units of its own dispersion, as the estimate misses
    the truth: median and logarithm of the dispersion are reflected so (Davison & Hinkley 1997,
    2.4 and 5.2). A bootstrap of n groups is too narrow by sqrt(n / (n - 1)), and the dispersion is
    not studentised itself: it is spread as `widened` says. A jump has no dispersion to divide by,
    so that ratios end at `STEEPEST`. Flat curves stay as they are.

    Parameters
    ----------
    best : the estimate.
    others : of the bootstrap.
    groups : that it draws from.
    level : confidence of the band.
    """
    if not (np.isfinite(best.place[0]) and 2.0 * FLAT < best.slope[0] < np.inf):
        return others
    wider = np.sqrt(groups / max(groups - 1.0, 1.0))
    spread = ndtri(0.5 + 0.5 * widened(level, groups)) / ndtri(0.5 + 0.5 * level)
    usual = np.isfinite(others.place) & (others.slope > 2.0 * FLAT)
    place, slope = others.place.copy(), others.slope.copy()
    ratio = slope[usual] / best.slope[0]
    away = np.minimum(ratio, STEEPEST) * (place[usual] - best.place[0])
    place[usual] = best.place[0] - wider * away
    slope[usual] = best.slope[0] / np.minimum(ratio**spread, STEEPEST)
    return Curves(place, slope, others.link)


def unreached(largest: Floats, shares: Floats) -> Curves:
    """Return curves under which none of some motions goes beyond with given probabilities.

    With probabilities spread evenly over (0, 1) they are draws of the true curve whose percentiles
    are the bounds of Clopper & Pearson (1934, Biometrika 26: 404-413) for no success at all.

    Parameters
    ----------
    largest : intensity of each motion, > 0.
    shares : probabilities, in (0, 1).
    """
    x = np.log(largest)
    place = np.linspace(x.min() - 8.0 * UNREACHED, x.max() + 8.0 * UNREACHED, 2000)
    none = log_ndtr((place - x[:, None]) / UNREACHED).sum(axis=0)
    return Curves(np.interp(np.log(shares), none, place), np.full(len(shares), 1.0 / UNREACHED))


def likelihood_edge(im: Floats, yes: Floats, no: Floats, best: Curves, drop: float) -> Curves:
    """Curves on the edge of the region where the logarithm of the likelihood is so much lower.

    The region is convex, so that the largest and smallest value of a number on its edge are the
    ends of the interval by profile likelihood of that number (half of a chi-squared quantile with
    one degree of freedom as `drop`: Venzon & Moolgavkar 1988, Applied Statistics 37: 87-94).

    Parameters
    ----------
    im, yes, no : counts (one row of them).
    best : the likeliest curve, a probit.
    drop : of the logarithm of the likelihood, > 0.
    """
    x = np.log(im) - best.place[0]
    b = float(best.slope[0])
    _, _, _, _, bend_up, bend_down = _terms(b * x, "probit")
    weight = yes * bend_up + no * bend_down
    bend = np.array(
        [[weight.sum(), (weight * x).sum()], [(weight * x).sum(), (weight * x**2).sum()]]
    )
    # Where the region is an ellipse its edge is at sqrt(2 drop) on every ray.
    turned = np.linalg.inv(np.linalg.cholesky(bend)).T
    angle = np.linspace(0.0, 2.0 * np.pi, RAYS, endpoint=False)
    ray = turned @ np.array([np.cos(angle), np.sin(angle)])
    least = likelihood(b * x, yes, no) - drop

    def inside(far: Floats) -> NDArray[np.bool_]:
        score = (far * ray[0])[:, None] + (b + far * ray[1])[:, None] * x
        return np.asarray(likelihood(score, yes, no) >= least)

    near, far = np.zeros(RAYS), np.full(RAYS, np.sqrt(2.0 * drop))
    while (still := inside(far)).any():
        near, far = np.where(still, far, near), np.where(still, 2.0 * far, far)
    for _ in range(BISECTIONS):
        middle = 0.5 * (near + far)
        still = inside(middle)
        near, far = np.where(still, middle, near), np.where(still, far, middle)
    slope = np.maximum(b + near * ray[1], FLAT)
    return Curves(best.place[0] - near * ray[0] / slope, slope)
