"""Lognormal capacities of which some were not reached: mean and deviation of their logarithms.

Where every motion was scaled until it reached the capacity, the estimates are those of Porter,
Kennedy & Bachman (2007, method A) and Baker (2015, Eq. 2 and 3): mean and sample deviation (n - 1)
of the logarithms. Motions that did not reach it at their largest intensity say that their
capacity is above it (Baker 2015, truncated incremental dynamic analysis): the likelihood then is
that of a right-censored normal sample, concave in slope and intercept (Olsen 1978, Econometrica
46: 1211-1215).

Porter, K., Kennedy, R., Bachman, R. (2007). Creating fragility functions for performance-based
earthquake engineering. Earthquake Spectra 23(2): 471-489.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from thermobearing.studies.binary import MOST_ROUNDS, ROOT_TWO_PI, STEADY, Curves, uphill

Floats = NDArray[np.float64]
SAME = 1e-12  # logarithms that differ by less are the same but for rounding


def fit_capacities(
    reached: Floats, at: Floats, weight_reached: Floats, weight_at: Floats
) -> Curves:
    """The likeliest lognormal distribution of capacities, for each row of weights.

    Parameters
    ----------
    reached : capacities [intensity], > 0.
    at : intensities that were not enough, > 0; may be empty.
    weight_reached, weight_at : how often each counts, shape (rows, capacities) and (rows, at).

    Returns
    -------
    Curves : a jump where all capacities are the same, infinite where none was reached.
    """
    y, c = np.log(reached), np.log(at)
    count = weight_reached.sum(-1)
    some = np.maximum(count, 1.0)
    mean = (weight_reached * y).sum(-1) / some
    spread = (weight_reached * (y - mean[:, None]) ** 2).sum(-1)
    deviation = np.sqrt(spread / np.maximum(count - 1.0, 1.0))
    place = np.where(count > 0, mean, np.inf)
    slope = np.full(len(count), np.inf)
    apart = deviation > SAME
    slope[apart] = 1.0 / deviation[apart]
    slope[count == 0] = 1.0
    open_ = (weight_at.sum(-1) > 0) & (count > 0)
    if open_.any():
        place[open_], slope[open_] = _censored(y, c, weight_reached[open_], weight_at[open_])
    return Curves(place, slope)


def _censored(y: Floats, c: Floats, w: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Newton's method in intercept a and slope b, scores a + b y; concave."""
    centre = float(np.concatenate([y, c]).mean())
    y, c = y - centre, c - centre
    n, first, second = w.sum(-1), (w * y).sum(-1), (w * y**2).sum(-1)
    total = n + v.sum(-1)
    mean = (first + (v * c).sum(-1)) / total
    around = (second + (v * c**2).sum(-1)) / total - mean**2
    b = 1.0 / np.sqrt(np.maximum(around, 1e-6))
    a = -mean * b

    def value(a: Floats, b: Floats) -> Floats:
        tail = (v * log_ndtr(-(a[:, None] + b[:, None] * c))).sum(-1)
        return np.asarray(
            n * np.log(b) - 0.5 * (n * a**2 + 2.0 * a * b * first + b**2 * second) + tail
        )

    for _ in range(MOST_ROUNDS):
        score = a[:, None] + b[:, None] * c
        rate = np.exp(-0.5 * score**2 - ROOT_TWO_PI - log_ndtr(-score))
        bend = v * rate * (rate - score)
        g0 = -(n * a + b * first) - (v * rate).sum(-1)
        g1 = n / b - (a * first + b * second) - (v * rate * c).sum(-1)
        h0 = n + bend.sum(-1)
        h1 = first + (bend * c).sum(-1)
        h2 = n / b**2 + second + (bend * c**2).sum(-1)
        da, db = uphill(value, a, b, (g0, g1), (h0, h1, h2), positive=True)
        a, b = a + da, b + db
        if float(np.abs(da).max()) + float(np.abs(db / b).max()) < STEADY:
            break
    return centre - a / b, b
