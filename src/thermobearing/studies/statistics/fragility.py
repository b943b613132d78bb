"""Fragility: the probability of exceeding a capacity, given the intensity of the motion.

Three of the field's estimators of a lognormal curve, each with bands:

- stripes: runs beyond the capacity counted at each intensity; maximum likelihood (Baker 2015);
- ida: the intensity at which each motion reaches it (Porter and others 2007; Baker 2015);
- cloud: regression of the demand in logarithms, ln D = ln a + b ln IM + error (Cornell, Jalayer,
  Hamburger & Foutch 2002, J. Struct. Eng. 128(4): 526-533; Jalayer & Cornell 2009, Earthquake Eng.
  Struct. Dyn. 38(8): 951-972). Where runs that failed count as collapse, their share is a logistic
  curve: P = P(beyond | no collapse) (1 - P(collapse)) + P(collapse), the five parameters of
  Jalayer, Ebrahimian, Miano, Manfredi & Sezen (2017, Earthquake Eng. Struct. Dyn. 46(15):
  2639-2663).

Bands: studentised bootstrap over motions, its percentiles as they are, or profile likelihood
(stripes of independent runs). Where no motion goes beyond, they are bounds by Clopper & Pearson.

Incremental dynamic analysis has curves of demand against intensity, their fractiles (16, 50 and
84 %, demand given intensity) and the intensity at which a curve first reaches a capacity:
Vamvatsikos, D., Cornell, C.A. (2002), Earthquake Engineering and Structural Dynamics 31(3):
491-514; (2004), Earthquake Spectra 20(2): 523-553. Between two runs a curve is straight here, not
a spline; it begins at zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict, Unpack, get_args

import numpy as np
import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.studies.run.shard import COMPLETED
from thermobearing.studies.statistics.demand import (
    LEVEL,
    SAMPLES,
    Counted,
    Draw,
    Failed,
    check_level,
    column,
    counted,
    describe_all,
    percentiles,
    positive,
    quantile,
)
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

FRACTILES = (0.16, 0.5, 0.84)
Method: TypeAlias = Literal["stripes", "ida", "cloud"]
Band: TypeAlias = Literal["bootstrap", "percentile", "profile"]
MOTION = "motion"
NONE_BEYOND = "none_beyond"


class IdaCurve(NamedTuple):
    """Demand of one motion against its intensity."""

    name: tuple[Any, ...]  # values of the columns that identify the curve
    intensity: Floats  # increasing, beginning with 0
    demand: Floats  # at each, beginning with 0; infinite where a run failed and counts as collapse
    first: int  # place of its first run among the runs that count

    def _at(self, intensity: Floats) -> Floats:
        """Return the demand at intensities; NaN beyond the last run.

        It is infinite beyond the last run before a collapse: what collapsed does not stand up
        again at a larger intensity.
        """
        failed = np.isinf(self.demand)
        first = int(failed.argmax()) if failed.any() else len(failed)
        found = np.full(len(intensity), np.inf if failed.any() else np.nan)
        inside = intensity <= self.intensity[first - 1]
        found[inside] = np.interp(intensity[inside], self.intensity[:first], self.demand[:first])
        return found

    def _crossing(self, capacity: float) -> float:
        """Return the lowest intensity with a demand at the capacity; infinite without one.

        Towards a collapse it is the largest intensity of a completed run (that of the collapse,
        if none completed).
        """
        beyond = np.flatnonzero(self.demand >= capacity)
        if len(beyond) == 0:
            return float("inf")
        first = int(beyond[0])
        x0, x1 = self.intensity[first - 1 : first + 1]
        y0, y1 = self.demand[first - 1 : first + 1]
        if np.isinf(y1):
            return float(x0 if x0 > 0.0 else x1)
        return float(x0 + (capacity - y0) / (y1 - y0) * (x1 - x0))


class Ida(NamedTuple):
    """Curves of all motions."""

    curves: list[IdaCurve]  # one for each motion (and whatever else differs)
    by: tuple[str, ...]  # columns that identify curves
    demand: str  # names of the columns
    intensity: str
    sentence: str  # how runs that failed count

    def fractiles(
        self, intensity: Floats | None = None, shares: Sequence[float] = FRACTILES
    ) -> pd.DataFrame:
        """Return fractiles of the demand over the curves, by default at every intensity run.

        The columns are the intensity, `curves` (that reach so far), and one for each share, such
        as `0.5`; infinite where so many curves collapsed.
        """
        if intensity is None:
            intensity = np.unique(np.concatenate([curve.intensity[1:] for curve in self.curves]))
        values = np.array([curve._at(intensity) for curve in self.curves])
        rows = []
        for place, at in zip(values.T, intensity, strict=True):
            known = place[~np.isnan(place)]
            found = {f"{share:g}": quantile(known, share) for share in shares} if len(known) else {}
            rows.append({self.intensity: float(at), "curves": len(known), **found})
        return pd.DataFrame(rows)

    def crossings(self, capacity: float) -> pd.DataFrame:
        """Return the intensity at which each curve first reaches a capacity.

        The columns are those that identify the curves, `capacity` (infinite where it was not
        reached) and `largest`, the largest intensity of the curve.
        """
        rows = []
        for curve in self.curves:
            name = dict(zip(self.by, curve.name, strict=True))
            found = {"capacity": curve._crossing(capacity), "largest": float(curve.intensity[-1])}
            rows.append({**name, **found})
        return pd.DataFrame(rows)


def ida_curves(
    table: pd.DataFrame,
    demand: str,
    intensity: str,
    by: Sequence[str] = (MOTION,),
    *,
    failed: Failed = "left-out",
) -> Ida:
    """Return curves of incremental dynamic analysis; the columns `by` identify them."""
    runs = counted(table, demand, failed)
    return _ida(runs, positive(runs.table, intensity), demand, intensity, by)


def _ida(runs: Counted, values: Floats, demand: str, intensity: str, by: Sequence[str]) -> Ida:
    labels = list(zip(*(column(runs.table, name) for name in by), strict=True))
    places: dict[tuple[Any, ...], list[int]] = {}
    for place, label in enumerate(labels):
        places.setdefault(label, []).append(place)
    curves = []
    for label, mine in places.items():
        order = np.array(mine)[np.argsort(values[mine], kind="stable")]
        x, y = values[order], runs.demand[order]
        if (np.diff(x) == 0.0).any():
            twice = x[:-1][np.diff(x) == 0.0][0]
            which = ", ".join(f"{key} {value}" for key, value in zip(by, label, strict=True))
            raise InputError(
                f"two runs of {which} at {intensity} = {twice:g}: name the column in which they "
                f'differ in "by"'
            )
        curves.append(IdaCurve(label, np.append(0.0, x), np.append(0.0, y), mine[0]))
    if all(len(curve.intensity) == 2 for curve in curves):
        raise InputError(
            f"each of the {len(curves)} curves has a run at one intensity only, so that it is no "
            "curve: the same draws are needed at several intensities (`paired = true` in "
            "[design]); or take stripes or cloud"
        )
    return Ida(curves, tuple(by), demand, intensity, runs.sentence)


@dataclass(frozen=True)
class Fragility:
    """A fragility curve with what it was made of."""

    name: str  # of the curve, such as "-20 degC"; may be empty
    method: Method  # "stripes", "ida" or "cloud"
    demand: str  # names of the columns
    intensity: str
    capacity: float  # of the demand, in the unit of its column
    # the curve, and those of the bootstrap or on the edge of the likelihood region
    estimate: Estimate
    band: Band  # "bootstrap", "percentile" or "profile"
    level: float  # confidence of the bands, a share in (0, 1)
    runs: int  # how many the curve is made of
    counts: pd.DataFrame  # for each intensity `runs` and `beyond`; of many intensities in classes
    left_out: int  # how many runs failed and are left out, or count as collapse
    collapsed: int

    @property
    def sentence(self) -> str:
        """How runs that failed count."""
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
        """Return the probability of exceedance at intensities; NaN where there is no curve."""
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        if not self.estimate.known:
            return np.full(len(at), np.nan)
        return self.estimate.probability(at)

    def family(self, intensity: Any, *, drawn: bool = False) -> Floats:
        """Return that of every curve that the band is made of: shape (curves, intensities).

        With `drawn` the curves are those of the bootstrap as it drew them, of which ratios of
        curves are made.
        """
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        return ((drawn and self.estimate.drawn) or self.estimate).probabilities(at)

    @property
    def groups(self) -> int:
        """Number of motions that the bootstrap draws from; 0 where it does not matter."""
        return self.estimate.groups

    def ends(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the ends of the band of what was computed from each curve of `family`."""
        if self.outcome not in (COMPLETED, NONE_BEYOND) or len(values) == 0:
            nothing = np.full(values.shape[1:], np.nan)
            return nothing, nothing
        if self.band == "profile":
            return values.min(axis=0), values.max(axis=0)
        return percentiles(values, self.level)

    def band_at(self, intensity: Any) -> tuple[Floats, Floats]:
        """Return the ends of the band of the probability, at each intensity by itself."""
        return self.ends(self.family(intensity))

    def row(self) -> dict[str, Any]:
        """Return the parameters with their bands, as a row of a table."""
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


class Options(TypedDict, total=False):
    """Keyword arguments of fragility curves."""

    method: Method  # "stripes" by default
    failed: Failed  # runs that failed are "left-out" (default), or count as "collapse"
    groups: str | None  # column that the bootstrap draws again with all its runs; None: single runs
    curves: Sequence[str]  # columns that identify curves of the method "ida"
    level: float  # confidence of the bands, 0.95 by default
    samples: int  # of the bootstrap
    seed: int  # of the bootstrap


DEFAULTS: dict[str, Any] = {"method": "stripes", "failed": "left-out", "groups": MOTION}
DEFAULTS |= {"curves": (MOTION,), "level": LEVEL, "samples": SAMPLES, "seed": 0}


def fragility_curve(
    table: pd.DataFrame,
    demand: str,
    capacity: float,
    intensity: str,
    *,
    band: Band = "bootstrap",
    name: str = "",
    **options: Unpack[Options],
) -> Fragility:
    """Return a fragility curve from a table of runs; the column `outcome` marks failed ones.

    The `demand` is compared with the `capacity` in its unit, against the `intensity` > 0. `band` is
    "bootstrap" (studentised, right with a dozen motions too), "percentile" (of the same bootstrap:
    too narrow with fewer than 40 motions), or "profile" (stripes of independent runs only).
    """
    draw, how = _resample(table, {**DEFAULTS, **options})
    return _fragility(table, draw, name, demand, capacity, intensity, band, **how)


def fragility_curves(
    table: pd.DataFrame,
    demand: str,
    capacity: float,
    intensity: str,
    by: str,
    **options: Unpack[Options],
) -> dict[Any, Fragility]:
    """Return a fragility curve for each value of a column, such as each ambient temperature.

    The bootstrap draws the same motions for all of them, so that differences and ratios of what
    they lead to have bands too.
    """
    draw, how = _resample(table, {**DEFAULTS, **options})
    labels = np.asarray(column(table, by), dtype=object)
    values = list(dict.fromkeys(labels.tolist()))
    if all(isinstance(value, int | float) for value in values):
        values.sort()
    found = {}
    for value in values:
        mine = np.array([label == value for label in labels])
        name = f"{value:g}" if isinstance(value, float) else str(value)
        what = name, demand, capacity, intensity
        try:
            found[value] = _fragility(table[mine], draw.of(mine), *what, "bootstrap", **how)
        except InputError as error:
            raise InputError(error.problems, f"{by} = {name}") from None
    return found


def _resample(table: pd.DataFrame, options: dict[str, Any]) -> tuple[Draw, dict[str, Any]]:
    """Return the bootstrap of options, and the other options."""
    groups = options.pop("groups")
    labels = table[groups].tolist() if groups is not None and groups in table else None
    draw = Draw.of_labels(labels, len(table), options.pop("samples"), options.pop("seed"))
    return draw, options


def _fragility(
    table: pd.DataFrame,
    draw: Draw,
    name: str,
    demand: str,
    capacity: float,
    intensity: str,
    band: Band,
    *,
    method: Method,
    failed: Failed,
    curves: Sequence[str],
    level: float,
) -> Fragility:
    check_level(level)
    if not (np.isfinite(capacity) and capacity > 0.0):
        raise InputError(f"capacity = {capacity:g} is not above 0")
    if method not in get_args(Method):
        raise InputError(f'method is "stripes", "ida" or "cloud", not {method!r}')
    if band not in get_args(Band):
        raise InputError(f'band is "bootstrap", "percentile" or "profile", not {band!r}')
    if band == "profile" and method != "stripes":
        raise InputError(f'band = "profile" is of stripes; of {method} take "bootstrap"')
    runs = counted(table, demand, failed)
    at = positive(runs.table, intensity)
    if len(np.unique(at)) < 2:
        raise InputError(
            f"all runs have {intensity} = {at[0]:g}: a curve needs two intensities at least"
        )
    draw = draw.of(runs.kept)
    beyond = runs.demand >= capacity
    if method == "stripes":
        estimate = stripes(at, beyond, draw, level if band == "profile" else None)
    elif method == "cloud":
        if (runs.demand <= 0.0).any():
            raise InputError(f'column "{demand}" has values that have no logarithm')
        estimate = cloud(at, runs.demand, capacity, draw)
    else:
        ida = _ida(runs, at, demand, intensity, curves)
        own = draw.groups[[curve.first for curve in ida.curves]]
        estimate = incremental(ida.crossings(capacity), own, draw)
    if band == "bootstrap":
        estimate = _studentised(estimate, draw, at, level)
    return Fragility(
        name=name,
        method=method,
        demand=demand,
        intensity=intensity,
        capacity=capacity,
        estimate=estimate,
        band=band,
        level=level,
        runs=len(runs.table),
        counts=counts(at, beyond, intensity),
        left_out=runs.left_out,
        collapsed=runs.collapsed,
    )


def _studentised(estimate: Estimate, draw: Draw, at: Floats, level: float) -> Estimate:
    """Return the estimate with a band that holds the truth at `level` with few motions too."""
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
