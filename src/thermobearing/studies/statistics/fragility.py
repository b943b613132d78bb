"""Fragility: the probability of going beyond a capacity, given the intensity of the motion.

Three of the field's estimators of a lognormal curve, each with bands:

- stripes: runs beyond the capacity counted at each intensity; maximum likelihood (Baker 2015);
- ida: the intensity at which each motion reaches it (Porter and others 2007; Baker 2015);
- cloud: regression of the demand in logarithms, ln D = ln a + b ln IM + error (Cornell, Jalayer,
  Hamburger & Foutch 2002, J. Struct. Eng. 128(4): 526-533; Jalayer & Cornell 2009, Earthquake Eng.
  Struct. Dyn. 38(8): 951-972). Where runs that failed count as collapse, their share is a logistic
  curve beside it: P = P(beyond | no collapse) (1 - P(collapse)) + P(collapse), the five parameters
  of Jalayer, Ebrahimian, Miano, Manfredi & Sezen (2017, Earthquake Eng. Struct. Dyn. 46(15):
  2639-2663).

Bands: studentised bootstrap over motions, its percentiles as they are, or profile likelihood
(stripes of independent runs). Where no motion goes beyond, they are bounds by Clopper & Pearson.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.studies.run.demand_parameters import COMPLETED
from thermobearing.studies.statistics.bootstrap import (
    LEVEL,
    SAMPLES,
    Draw,
    check_level,
    percentiles,
)
from thermobearing.studies.statistics.failed_runs import (
    Failed,
    column,
    counted,
    describe_all,
    positive,
)
from thermobearing.studies.statistics.ida import ida_curves
from thermobearing.studies.statistics.likelihood import (
    FLAT,
    Estimate,
    cloud,
    counts,
    incremental,
    pivoted,
    stripes,
    unreached,
)

Floats = NDArray[np.float64]
Method: TypeAlias = Literal["stripes", "ida", "cloud"]
Band: TypeAlias = Literal["bootstrap", "percentile", "profile"]
MOTION = "motion"
NONE_BEYOND = "none_beyond"


@dataclass(frozen=True)
class Fragility:
    """A fragility curve with what it was made of.

    Attributes
    ----------
    name : what tells it from others, such as "-20 degC"; may be empty.
    method : "stripes", "ida" or "cloud".
    demand, intensity : names of the columns.
    capacity : of the demand, in the unit of its column.
    estimate : the curve, and those of the bootstrap or on the edge of the likelihood region.
    band : "bootstrap", "percentile" or "profile".
    level : confidence of the bands, a share in (0, 1).
    runs : how many the curve is made of.
    counts : for each intensity `runs` and `beyond`; of many intensities in classes.
    left_out, collapsed : how many runs failed and are not among them, or count as collapse.
    """

    name: str
    method: Method
    demand: str
    intensity: str
    capacity: float
    estimate: Estimate
    band: Band
    level: float
    runs: int
    counts: pd.DataFrame
    left_out: int
    collapsed: int

    @property
    def sentence(self) -> str:
        """What became of runs that failed."""
        return describe_all(self.runs + self.left_out, self.left_out, self.collapsed)

    @property
    def outcome(self) -> str:
        """The word "completed", or why there is no curve, such as "none_beyond"."""
        return self.estimate.outcome

    @property
    def median(self) -> float:
        """Intensity at which half of the runs go beyond (of those that did not collapse)."""
        return float(np.exp(self.estimate.best.place[0])) if self.estimate.known else np.nan

    @property
    def dispersion(self) -> float:
        """Standard deviation of the logarithm of the capacity, in intensity."""
        return float(1.0 / self.estimate.best.slope[0]) if self.estimate.known else np.nan

    def probability(self, intensity: Any) -> Floats:
        """Of going beyond the capacity, at intensities; NaN where there is no curve."""
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        if not self.estimate.known:
            return np.full(len(at), np.nan)
        return self.estimate.probability(at)

    def family(self, intensity: Any, *, drawn: bool = False) -> Floats:
        """Return the same of every curve that the band is made of: shape (curves, intensities).

        Parameters
        ----------
        intensity : at which.
        drawn : those of the bootstrap as it drew them, which ratios of curves are made of.
        """
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        return ((drawn and self.estimate.drawn) or self.estimate).probabilities(at)

    @property
    def groups(self) -> int:
        """Number of motions that the bootstrap draws from; 0 where it is no matter."""
        return self.estimate.groups

    def ends(self, values: Floats) -> tuple[Floats, Floats]:
        """Ends of the band of what was computed from each curve of `family`."""
        if self.outcome not in (COMPLETED, NONE_BEYOND) or len(values) == 0:
            nothing = np.full(values.shape[1:], np.nan)
            return nothing, nothing
        if self.band == "profile":
            return values.min(axis=0), values.max(axis=0)
        return percentiles(values, self.level)

    def band_at(self, intensity: Any) -> tuple[Floats, Floats]:
        """Lower and upper end of the band of the probability, at each intensity by itself."""
        return self.ends(self.family(intensity))

    def row(self) -> dict[str, Any]:
        """Parameters with their bands, as a row of a table."""
        others = self.estimate.others
        low, high = self.ends(np.exp(np.minimum(others.place, 700.0))[:, None])
        with np.errstate(divide="ignore"):
            least, most = self.ends((1.0 / others.slope)[:, None])
        if not self.estimate.known:
            least = most = np.array([np.nan])
        if self.outcome == NONE_BEYOND:
            high = np.array([np.inf])
        flat = 0.5 / FLAT
        return {
            "name": self.name,
            "method": self.method,
            "capacity": self.capacity,
            "median": self.median,
            "median_low": float(low[0]),
            "median_high": float(high[0]) if high[0] < np.exp(700.0) else np.inf,
            "dispersion": self.dispersion,
            "dispersion_low": float(least[0]),
            "dispersion_high": np.inf if most[0] >= flat else float(most[0]),
            "runs": self.runs,
            "beyond": int(self.counts["beyond"].sum()),
            "left_out": self.left_out,
            "collapsed": self.collapsed,
            "outcome": self.outcome,
            "sentence": self.estimate.sentence or self.sentence,
        }


def fragility_curve(
    table: pd.DataFrame,
    demand: str,
    capacity: float,
    intensity: str,
    *,
    method: Method = "stripes",
    failed: Failed = "left-out",
    groups: str | None = MOTION,
    curves: Sequence[str] = (MOTION,),
    band: Band = "bootstrap",
    level: float = LEVEL,
    samples: int = SAMPLES,
    seed: int = 0,
    name: str = "",
) -> Fragility:
    """A fragility curve from a table of runs.

    Parameters
    ----------
    table : of runs; failed ones are told by the column `outcome`.
    demand : column that is held beside the capacity.
    capacity : > 0, in the unit of the demand.
    intensity : column of the intensity of the motion, > 0.
    method : "stripes", "ida" or "cloud".
    failed : runs that failed are "left-out", or count as "collapse" (beyond any capacity).
    groups : column whose values are drawn again as a whole by the bootstrap; None: every run by
        itself. A column that is not there is as None.
    curves : of "ida": columns that tell its curves apart.
    band : "bootstrap" (studentised, right with a dozen motions too), "percentile" (of the same
        bootstrap: too narrow with fewer than 40 motions), or "profile" (stripes only; the runs
        must be independent).
    level : confidence of the bands, a share in (0, 1).
    samples : of the bootstrap.
    seed : of the bootstrap.
    name : to tell the curve from others.

    Raises
    ------
    InputError : a column is missing, or holds what has no logarithm.

    Examples
    --------
    >>> runs = pd.DataFrame({"scale": [1.0] * 4 + [2.0] * 4, "drift": [1, 1, 1, 3, 1, 3, 3, 3]})
    >>> found = fragility_curve(runs, "drift", 2.0, "scale", band="profile")
    >>> round(found.median, 3), round(found.dispersion, 3)
    (1.414, 0.514)
    """
    draw = _resample(table, groups, samples, seed)
    settings = _Settings(demand, capacity, intensity, method, failed, tuple(curves), band, level)
    return _fragility(table, settings, draw, name)


def fragility_curves(
    table: pd.DataFrame,
    demand: str,
    capacity: float,
    intensity: str,
    by: str,
    *,
    method: Method = "stripes",
    failed: Failed = "left-out",
    groups: str | None = MOTION,
    curves: Sequence[str] = (MOTION,),
    level: float = LEVEL,
    samples: int = SAMPLES,
    seed: int = 0,
) -> dict[Any, Fragility]:
    """A fragility curve for each value of a column, such as each ambient temperature.

    The bootstrap draws the same motions for all of them, so that differences and ratios of what
    they lead to have bands too.

    Parameters
    ----------
    table, demand, capacity, intensity : as of `fragility_curve`.
    by : column whose values have a curve each.
    method, failed, groups, curves, level, samples, seed : as of `fragility_curve`.

    Returns
    -------
    dict : by value, in increasing order as far as they have one.

    Raises
    ------
    InputError : as of `fragility_curve`, with the value that it is about.

    Examples
    --------
    >>> cold = pd.DataFrame({"scale": [1.0] * 4 + [2.0] * 4, "drift": [1, 1, 1, 3, 1, 3, 3, 3]})
    >>> warm = cold.assign(scale=2.0 * cold["scale"])
    >>> runs = pd.concat([cold.assign(air=-20.0), warm.assign(air=23.0)])
    >>> found = fragility_curves(runs, "drift", 2.0, "scale", "air")
    >>> {air: round(curve.median, 3) for air, curve in found.items()}
    {-20.0: 1.414, 23.0: 2.828}
    """
    draw = _resample(table, groups, samples, seed)
    settings = _Settings(
        demand, capacity, intensity, method, failed, tuple(curves), "bootstrap", level
    )
    labels = np.asarray(column(table, by), dtype=object)
    values = list(dict.fromkeys(labels.tolist()))
    if all(isinstance(value, int | float) for value in values):
        values.sort()
    found = {}
    for value in values:
        mine = np.array([label == value for label in labels])
        told = f"{value:g}" if isinstance(value, float) else str(value)
        try:
            found[value] = _fragility(table[mine], settings, draw.of(mine), told)
        except InputError as error:
            raise InputError(error.problems, f"{by} = {told}") from None
    return found


@dataclass(frozen=True)
class _Settings:
    """How a curve is made; checked."""

    demand: str
    capacity: float
    intensity: str
    method: Method
    failed: Failed
    curves: tuple[str, ...]
    band: Band
    level: float

    def __post_init__(self) -> None:
        check_level(self.level)
        if not (np.isfinite(self.capacity) and self.capacity > 0.0):
            raise InputError(f"capacity = {self.capacity:g} is not above 0")
        if self.method not in get_args(Method):
            raise InputError(f'method is "stripes", "ida" or "cloud", not {self.method!r}')
        if self.band not in get_args(Band):
            raise InputError(f'band is "bootstrap", "percentile" or "profile", not {self.band!r}')
        if self.band == "profile" and self.method != "stripes":
            raise InputError(f'band = "profile" is of stripes; of {self.method} take "bootstrap"')


def _resample(table: pd.DataFrame, groups: str | None, samples: int, seed: int) -> Draw:
    labels = table[groups].tolist() if groups is not None and groups in table else None
    return Draw.of_labels(labels, len(table), samples, seed)


def _fragility(table: pd.DataFrame, of: _Settings, draw: Draw, name: str) -> Fragility:
    """One curve: the runs that count, and the estimator that was asked for."""
    runs = counted(table, of.demand, of.failed)
    at = positive(runs.table, of.intensity)
    if len(np.unique(at)) < 2:
        raise InputError(
            f"all runs have {of.intensity} = {at[0]:g}: a curve needs two intensities at least"
        )
    mine = draw.of(runs.kept)
    beyond = runs.demand >= of.capacity
    if of.method == "stripes":
        drop = of.level if of.band == "profile" else None
        estimate = stripes(at, beyond, mine, drop)
    elif of.method == "cloud":
        if (runs.demand <= 0.0).any():
            raise InputError(f'column "{of.demand}" has values that have no logarithm')
        estimate = cloud(at, runs.demand, of.capacity, mine)
    else:
        found = ida_curves(runs.table, of.demand, of.intensity, of.curves, failed=of.failed)
        estimate = incremental(found, of.capacity, mine)
    if of.band == "bootstrap":
        estimate = _studentised(estimate, mine, at, of.level)
    return Fragility(
        name,
        of.method,
        of.demand,
        of.intensity,
        of.capacity,
        estimate,
        of.band,
        of.level,
        len(runs.table),
        counts(at, beyond, of.intensity),
        runs.left_out,
        runs.collapsed,
    )


def _studentised(estimate: Estimate, draw: Draw, at: Floats, level: float) -> Estimate:
    """The same with a band that holds the truth as often as it says with a dozen motions too."""
    if estimate.outcome == NONE_BEYOND:
        order = np.lexsort((at, draw.groups))
        last = np.append(np.diff(draw.groups[order]) > 0, True)
        shares = (draw.generator().permutation(draw.samples) + 0.5) / draw.samples
        bounds = unreached(at[order][last], shares)
        return replace(estimate, others=bounds, groups=draw.count)
    others = pivoted(estimate.best, estimate.others, draw.count, level)
    collapses = estimate.collapses
    if estimate.collapse is not None and collapses is not None:
        collapses = pivoted(estimate.collapse, collapses, draw.count, level)
    return replace(estimate, others=others, collapses=collapses, drawn=estimate, groups=draw.count)
