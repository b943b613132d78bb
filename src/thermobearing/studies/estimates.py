"""The estimators behind a fragility curve: stripes, capacities of single motions, a cloud.

Each gives the curve, and the same of every bootstrap sample; `fragility` has the sources.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import chi2

from thermobearing.border.errors import InputError
from thermobearing.studies.binary import FLAT, Curves, fit_curves, likelihood_edge
from thermobearing.studies.classes import equal_classes
from thermobearing.studies.crossed import fit_capacities
from thermobearing.studies.ida import Ida
from thermobearing.studies.peaks import COMPLETED
from thermobearing.studies.resampling import Draw

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
MOST_STRIPES = 200  # more intensities are put into so many classes, equally filled
MORE_BETWEEN = (
    "all runs up to {0:.4g} stay below, all from {1:.4g} go beyond: add intensities between"
)
ONE_MIXED = (
    "none goes beyond below {0:.4g} and all do above it; at {0:.4g} itself {1:.0f} of {2:.0f}: one "
    "intensity says too little of the spread, add intensities close to it"
)
REASONS = {
    "none_beyond": "no run went beyond the capacity: add larger intensities",
    "all_beyond": "every run went beyond the capacity: add smaller intensities",
    "not_rising": "the share beyond the capacity does not rise with the intensity: is it one that "
    "tells motions apart here? Add runs or intensities",
    "one_beyond": "one motion only reached the capacity: add larger intensities",
}


@dataclass(frozen=True)
class Estimate:
    """A curve, and what its band is made of.

    Attributes
    ----------
    best : the likeliest curve.
    others : those of the bootstrap, or on the edge of the likelihood region.
    collapse, collapses : logistic curves of the share of collapse, of both; None without.
    outcome : "completed", or why there is no curve.
    sentence : likewise, and what to try.
    drawn : the same with the curves of the bootstrap as it drew them, where `others` are pivots.
    groups : that the bootstrap draws from; 0 where it is no matter.
    """

    best: Curves
    others: Curves
    collapse: Curves | None = None
    collapses: Curves | None = None
    outcome: str = COMPLETED
    sentence: str = ""
    drawn: "Estimate | None" = None
    groups: int = 0

    @property
    def known(self) -> bool:
        """Whether there is a curve."""
        return self.outcome == COMPLETED

    def probability(self, intensity: Floats) -> Floats:
        """Of the curve, at intensities."""
        beyond = _with_collapse(self.best, self.collapse, intensity)
        return np.asarray(beyond[0])

    def probabilities(self, intensity: Floats) -> Floats:
        """Of all that the band is made of: shape (curves, intensities)."""
        return _with_collapse(self.others, self.collapses, intensity)


def _with_collapse(curves: Curves, collapse: Curves | None, intensity: Floats) -> Floats:
    beyond = curves.probability(intensity)
    if collapse is None:
        return beyond
    share = collapse.probability(intensity)
    return beyond * (1.0 - share) + share


def classes(at: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Intensities, and which of them each run has; many are put into classes of equal number.

    The intensity of a class is the geometric mean of its runs.
    """
    levels, place = np.unique(at, return_inverse=True)
    if len(levels) <= MOST_STRIPES:
        return levels, place
    place = equal_classes(at, MOST_STRIPES)
    means = np.bincount(place, np.log(at)) / np.bincount(place)
    return np.exp(means), place


def counts(at: Floats, beyond: Bools, name: str) -> pd.DataFrame:
    """Runs, and how many of them are beyond, at each intensity or in each class of them."""
    levels, place = classes(at)
    runs = np.bincount(place, minlength=len(levels))
    over = np.bincount(place, beyond, minlength=len(levels)).astype(int)
    return pd.DataFrame({name: levels, "runs": runs, "beyond": over})


def _counted(
    at: Floats, beyond: Bools, draw: Draw
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Intensities; runs beyond and not at each, and the same of every bootstrap sample."""
    levels, place = classes(at)
    size = len(levels)
    yes, no = (
        np.bincount(place, part, minlength=size).astype(float)[None, :]
        for part in (beyond, ~beyond)
    )
    if draw.alone:  # drawn again within each stripe: a binomial number
        runs = (yes + no)[0]
        shape = (draw.samples, size)
        drawn = draw.generator().binomial(runs.astype(int), yes[0] / runs, size=shape)
        again = drawn.astype(float)
        return levels, yes, no, again, runs - again
    cells = np.zeros((draw.count, 2 * size))
    np.add.at(cells, (draw.groups, place + np.where(beyond, 0, size)), 1.0)
    again = draw.again(cells)
    return levels, yes, no, again[:, :size], again[:, size:]


def stripes(at: Floats, beyond: Bools, draw: Draw, level: float | None = None) -> Estimate:
    """The likeliest lognormal curve through counts.

    Parameters
    ----------
    at : intensity of each run.
    beyond : whether it went beyond the capacity.
    draw : how the bootstrap draws them again.
    level : of a band by profile likelihood, instead of the bootstrap.
    """
    levels, yes, no, again, but = _counted(at, beyond, draw)
    best = fit_curves(levels, yes, no)
    outcome, sentence = _why_not(levels, yes[0], no[0], best)
    if level is not None and outcome == COMPLETED:
        drop = 0.5 * float(chi2.ppf(level, 1))
        others = likelihood_edge(levels, yes[0], no[0], best, drop)
    else:
        others = fit_curves(levels, again, but)
    return Estimate(best, others, outcome=outcome, sentence=sentence)


def _why_not(levels: Floats, yes: Floats, no: Floats, best: Curves) -> tuple[str, str]:
    """Outcome of counts, with a sentence where they have no likeliest curve."""
    if not yes.any() or not no.any():
        outcome = "all_beyond" if yes.any() else "none_beyond"
        return outcome, REASONS[outcome]
    if np.isinf(best.slope[0]):
        last, first = levels[no > 0].max(), levels[yes > 0].min()
        if last == first:
            here = int(np.flatnonzero(levels == first)[0])
            return "apart", ONE_MIXED.format(first, yes[here], yes[here] + no[here])
        return "apart", MORE_BETWEEN.format(last, first)
    if best.slope[0] <= FLAT:
        return "not_rising", REASONS["not_rising"]
    return COMPLETED, ""


def incremental(ida: Ida, capacity: float, draw: Draw) -> Estimate:
    """The lognormal curve of the intensities at which motions reach a capacity.

    Parameters
    ----------
    ida : curves.
    capacity : of their demand.
    draw : how the bootstrap draws their runs again; a curve goes with its first run.
    """
    table = ida.crossings(capacity)
    reached = np.isfinite(table["capacity"].to_numpy(dtype=float))
    y = table.loc[reached, "capacity"].to_numpy(dtype=float)
    c = table.loc[~reached, "largest"].to_numpy(dtype=float)
    groups = draw.groups[[curve.first for curve in ida.curves]]
    if draw.alone:
        draw = Draw.of_labels(None, len(ida.curves), draw.samples, draw.seed[0])
        groups = draw.groups
    ones = np.ones((1, len(groups)))
    best = fit_capacities(y, c, ones[:, reached], ones[:, ~reached])
    parts = [
        fit_capacities(y, c, weights[:, groups[reached]], weights[:, groups[~reached]])
        for weights in draw.weights()
    ]
    others = _joined(parts)
    if not reached.any():
        return Estimate(best, others, outcome="none_beyond", sentence=REASONS["none_beyond"])
    if np.isinf(best.slope[0]):
        return Estimate(best, others, outcome="apart", sentence=REASONS["one_beyond"])
    return Estimate(best, others)


def cloud(at: Floats, demand: Floats, capacity: float, draw: Draw) -> Estimate:
    """The lognormal curve of a regression of the demand, and the share of collapse beside it.

    Parameters
    ----------
    at : intensity of each run.
    demand : of each, > 0; infinite for a collapse.
    capacity : of the demand.
    draw : how the bootstrap draws them again.

    Raises
    ------
    InputError : fewer than three runs that did not collapse.
    """
    stood = np.isfinite(demand)
    if stood.sum() < 3 or len(np.unique(at[stood])) < 2:
        raise InputError(
            f"{stood.sum()} runs that did not collapse: a regression needs three, at two "
            "intensities at least"
        )
    x = np.where(stood, np.log(at), 0.0)
    y = np.where(stood, np.log(np.where(stood, demand, 1.0) / capacity), 0.0)
    # About their means, so that the sums of squares lose no digits.
    x_mean, y_mean = x[stood].mean(), y[stood].mean()
    x, y = np.where(stood, x - x_mean, 0.0), np.where(stood, y - y_mean, 0.0)
    terms = np.column_stack([stood.astype(float), x, y, x * x, x * y, y * y])
    best = _line(terms.sum(axis=0)[None, :], x_mean, y_mean)
    others = _line(draw.sums(terms), x_mean, y_mean)
    outcome = COMPLETED if best.slope[0] > FLAT else "not_rising"
    sentence = REASONS.get(outcome, "")
    if stood.all():
        return Estimate(best, others, outcome=outcome, sentence=sentence)
    levels, yes, no, again, but = _counted(at, ~stood, draw)
    share = fit_curves(levels, yes, no, "logit")
    return Estimate(best, others, share, fit_curves(levels, again, but, "logit"), outcome, sentence)


def _line(sums: Floats, x_mean: float, y_mean: float) -> Curves:
    """Curves of the regression from sums of 1, x, y, xx, xy, yy; flat ones where it falls."""
    n, x, y, xx, xy, yy = sums.T
    some = np.maximum(n, 1.0)
    across = xx - x * x / some
    with np.errstate(divide="ignore", invalid="ignore"):
        b = np.where(across > 1e-12 * some, (xy - x * y / some) / across, 0.0)
        left = np.maximum(yy - y * y / some - b * (xy - x * y / some), 0.0)
        sigma = np.sqrt(left / np.maximum(n - 2.0, 1.0))
        middle = y_mean + y / some - b * (x_mean + x / some)  # ln(demand/capacity) at ln im = 0
        rising = b > FLAT
        slope = np.where(rising, np.where(sigma > 0.0, b / sigma, np.inf), FLAT)
        flat = -np.where(sigma > 0.0, middle / sigma, 0.0) / FLAT
        place = np.where(rising, -middle / b, flat)
    return Curves(place, slope)


def _joined(parts: list[Curves]) -> Curves:
    return Curves(
        np.concatenate([part.place for part in parts]),
        np.concatenate([part.slope for part in parts]),
        parts[0].link,
    )
