"""Fragility: the probability of exceeding a capacity, given the intensity of the motion.

Three estimators of a lognormal curve, each with bands:

- stripes: number of exceedances at each intensity; maximum likelihood (Baker 2015);
- ida: the intensity at which each motion reaches the capacity (Porter and others 2007; Baker 2015);
- cloud: regression of the demand in logarithms, ln D = ln a + b ln IM + error (Cornell, Jalayer,
  Hamburger & Foutch 2002, J. Struct. Eng. 128(4): 526-533; Jalayer & Cornell 2009, Earthquake Eng.
  Struct. Dyn. 38(8): 951-972). If failed runs count as collapse, their share is a logistic curve:
  P = P(exceedance | no collapse) (1 - P(collapse)) + P(collapse), the five parameters of
  Jalayer, Ebrahimian, Miano, Manfredi & Sezen (2017, Earthquake Eng. Struct. Dyn. 46(15):
  2639-2663).

Bands are those of a studentised bootstrap over motions. Where no motion exceeds the capacity, they
are the bounds by Clopper & Pearson.

Over a climate the fragility is the mean of the curves of some temperatures, each by its share of
the time (total probability): the temperature is independent of the size of an earthquake.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import itemgetter
from typing import Any, Literal, TypeAlias, TypedDict, Unpack, get_args

import numpy as np
import scipy
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.quantities.words import joined, percent
from thermobearing.results.base import COMPLETED
from thermobearing.studies.definition.record import COLUMNS, INTENSITY_UNITS
from thermobearing.studies.statistics.comparison import (
    CONTRADICTED,
    Contradiction,
    allowed_probabilities,
    compare_counts,
    find_contradiction,
    find_half,
    reached_counts,
)
from thermobearing.studies.statistics.demand import (
    COMPUTED,
    FEW_BEYOND,
    LEAST_MOTIONS,
    LEVEL,
    MOST_LEVELS,
    MOTION,
    SAMPLES,
    Draw,
    Failed,
    check_level,
    column,
    counted,
    describe_failures,
    levels,
    percentiles,
    positive,
)
from thermobearing.studies.statistics.ida import LEAST_AT_LEVEL, curves_of
from thermobearing.studies.statistics.likelihood import (
    ALL_BEYOND,
    APART,
    FLAT,
    LARGEST_LOGARITHM,
    NONE_BEYOND,
    NOT_RISING,
    Estimate,
    cloud,
    counts,
    incremental,
    least_median,
    pivoted,
    stripes,
    unreached,
    with_intensity_unit,
)

Method: TypeAlias = Literal["stripes", "ida", "cloud"]
LEAST_BEYOND = 3  # exceedances; our choice: fewer determine no median
LEAST_MIXED = 3  # intensities with both outcomes, of which a dispersion says something
UNREACHED_SHARE = 1e-6  # of the time, above one half, so that a median is at a finite intensity
MEDIAN_DIFFERENCE = 0.02  # of a median, from which both treatments of failed runs are stated
COARSE = 2.0  # ratio of intensities around a capacity, in logarithms, over the dispersion
USUAL_MOTIONS = 12  # from which on the error of the dispersion adds little to a band
WITH_COLLAPSE = (
    "with collapse the curve is not lognormal: the median is where it is one half, the dispersion "
    "half of ln(im_84/im_16) of the intensities where it has 84 and 16 %"
)
# All outcomes of a curve.
OUTCOMES = (COMPLETED, CONTRADICTED, NONE_BEYOND, ALL_BEYOND, APART, NOT_RISING)
CONTRADICTS = "the curve contradicts its own runs"
NOT_LOGNORMAL = (
    "one lognormal curve does not describe them: use the shares of runs at each intensity, "
    'intensities closer together, or method = "cloud" with failed = "collapse", whose curve has a '
    "part for collapse (failed runs then exceed the capacity)"
)
INSTEAD = {  # what to use in place of a curve that contradicts its runs
    "cloud": "the demand is not log-linear with constant scatter: use stripes",
    "stripes": NOT_LOGNORMAL,
    "ida": NOT_LOGNORMAL,
}
UNITS = {name: INTENSITY_UNITS[measure].replace("^2", "²") for measure, name in COLUMNS.items()}


def describe_wide(groups: int) -> str:
    """Return why bands of so many motions are wide, "" of more.

    >>> describe_wide(11).partition(":")[0], describe_wide(12)
    ('11 motions', '')
    """
    if not LEAST_MOTIONS <= groups < USUAL_MOTIONS:
        return ""
    return (
        f"{groups} motions: the bands allow for the error of the dispersion, which is large below "
        f"{USUAL_MOTIONS} motions, so that they are wider than percentiles of a bootstrap"
    )


def describe_few(groups: int) -> str:
    """Return why so many motions give no band, "" if they do.

    >>> describe_few(4), describe_few(5)
    ('too few motions for a band: 4', '')
    """
    return f"too few motions for a band: {groups}" if 0 < groups < LEAST_MOTIONS else ""


@dataclass(frozen=True, repr=False)
class Fragility:
    """A fragility curve, or the mean of the curves of several temperatures."""

    name: str  # of the curve, such as "-20"; may be empty
    method: Method
    demand: str  # names of the columns
    intensity: str
    capacity: float  # of the demand, in the unit of its column
    # curves with their shares of the time: one, or that of each temperature that occurs
    parts: Sequence[tuple[float, Estimate]]
    level: float  # confidence of the bands, a share in (0, 1)
    runs: int
    # for each intensity `runs` and `beyond`; many intensities in classes from `first` to `last`
    counts: "pd.DataFrame"
    left_out: int  # number of failed runs that are left out, that count as collapse, and that
    collapsed: int  # count with the demand that was computed
    computed: int = 0
    larger: int = 0  # number of the collapsed that stopped beyond the capacity
    # number of runs that count and of all, at intensities where more than a few are left out
    incomplete: Mapping[float, tuple[int, int]] = field(default_factory=dict)
    # of IDA: for each intensity number of single curves, and of those that reached the capacity
    reached: "pd.DataFrame | None" = None
    contradicted: Sequence[str] = ()  # of several curves: names of those that contradict their runs
    shares: Mapping[float, float] = field(default_factory=dict)  # of several curves: by temperature

    def __repr__(self) -> str:
        """Return method, question and median on one line; `row` has all numbers."""
        of = f"{self.name}: " if self.name else ""
        median = f"median {self.median:.4g}" if self.median == self.median else self.outcome
        remark = self.beyond_levels or (CONTRADICTS.removeprefix("the curve ") * bool(self.misfit))
        remark = f" ({remark})" if remark else ""
        dispersion = f", dispersion {self.dispersion:.3g}" if self.dispersion > 0.0 else ""
        exceedances = int(self.counts["beyond"].sum())
        return (
            f"Fragility({of}{self.method}, {self.demand} above {self.capacity:g} against "
            f"{self.intensity}: {median}{remark}{dispersion}, {exceedances} of {self.runs} runs)"
        )

    @property
    def estimate(self) -> Estimate:
        """The curve, or the first of several that are combined."""
        return self.parts[0][1]

    @property
    def sentence(self) -> str:
        """How many runs failed and how they count."""
        runs = self.runs + self.left_out
        return describe_failures(runs, self.left_out, self.collapsed, self.computed, self.larger)

    @property
    def incomplete_levels(self) -> str:
        """At which intensities more than a few runs are left out, and how many count; or ""."""
        unit = UNITS.get(self.intensity, "")
        levels = sorted(self.incomplete.items())
        texts = (
            f"{used} of {runs} runs at {with_intensity_unit(x, unit)}" for x, (used, runs) in levels
        )
        return f"counted are {joined(texts)}" if levels else ""

    @property
    def outcome(self) -> str:
        """One of `OUTCOMES`: "completed", "contradicted" by its own runs, or why there is none."""
        if self.misfit:
            return CONTRADICTED
        outcomes = [estimate.outcome for _, estimate in self.parts]
        if self.is_drawable:  # a temperature without exceedances takes no curve from the others
            return COMPLETED
        return next(
            (text for text in outcomes if text not in (COMPLETED, NONE_BEYOND)), outcomes[0]
        )

    @property
    def median(self) -> float:
        """Intensity with a probability of one half; NaN where a curve does not reach it."""
        with_curve = [(share, estimate) for share, estimate in self.parts if estimate.known]
        if not self.is_drawable or sum(share for share, _ in with_curve) <= 0.5 + UNREACHED_SHARE:
            return np.nan
        medians = [float(np.exp(estimate.median)) for _, estimate in with_curve]
        low, high = min(medians), max(medians)
        if self.probability(low)[0] >= 0.5 or (low == high and len(with_curve) == len(self.parts)):
            return low
        # Temperatures without exceedances have the probability zero at every intensity.
        while self.probability(high)[0] < 0.5:
            high *= 2.0
            if not np.isfinite(high):
                return np.nan
        return float(scipy.optimize.brentq(lambda at: self.probability(at)[0] - 0.5, low, high))

    @property
    def dispersion(self) -> float:
        """Standard deviation of the logarithm of the capacity, in intensity; NaN for a climate.

        Of a cloud with collapse, half the logarithm of the ratio of the intensities at which the
        curve has 84 and 16 %.
        """
        is_one = self.estimate.known and len(self.parts) == 1
        return self.estimate.dispersion if is_one else np.nan

    @property
    def mixture(self) -> str:
        """How the median and the dispersion of a cloud with collapse are defined; "" of others."""
        return WITH_COLLAPSE if self.estimate.collapse is not None else ""

    @property
    def is_drawable(self) -> bool:
        """Whether there is a curve: none of its temperatures lacks one for another reason than 0.

        A temperature at which no run exceeds the capacity has the probability zero. Where the
        counts determine a step or a constant, there is no curve.
        """
        outcomes = {estimate.outcome for _, estimate in self.parts}
        return COMPLETED in outcomes and outcomes <= {COMPLETED, NONE_BEYOND}

    @property
    def is_rising(self) -> bool:
        """Whether the shares of exceedances rise with the intensity, of all temperatures."""
        return all(estimate.outcome != NOT_RISING for _, estimate in self.parts)

    @property
    def few_motions(self) -> str:
        """Why there is no band, such as "too few motions for a band: 4"; "" where there is one."""
        return "" if self.outcome == NONE_BEYOND else describe_few(self.estimate.groups)

    @property
    def wide_bands(self) -> str:
        """Why the bands are wide, with fewer than twelve motions; "" with more or without bands."""
        return describe_wide(self.estimate.groups) if self.estimate.known else ""

    @property
    def beyond_levels(self) -> str:
        """Why the median is no result; "" where it is one, or where there is none.

        It is above all intensities, or fewer than `LEAST_BEYOND` runs exceed the capacity.
        """
        beyond = int(self.counts["beyond"].sum())
        if self.median > 0.0 and beyond < LEAST_BEYOND:
            return f"too few exceedances: {beyond} of {self.runs} runs exceed the capacity"
        largest = float(self.counts["last"].max())
        if not self.median > largest:
            return ""
        return (
            f"too few levels: the median is beyond the largest intensity of the runs, {largest:.3g}"
        )

    @property
    def few_words(self) -> str:
        """What there is too little of for a median: "too few levels", or ""."""
        return self.beyond_levels.partition(":")[0]

    @property
    def has_median(self) -> bool:
        """Whether there is a curve whose median is a result."""
        return self.is_drawable and not self.beyond_levels

    @property
    def stated_median(self) -> float:
        """The median; NaN where it is no result."""
        return self.median if self.has_median else np.nan

    def differs_from(self, median: float) -> bool:
        """Return whether another `stated_median` differs noticeably from that of the curve."""
        if not self.has_median or np.isnan(median):
            return self.has_median or bool(np.isfinite(median))
        return abs(median - self.median) > MEDIAN_DIFFERENCE * self.median

    @property
    def coarse(self) -> str:
        """Why the levels of IDA are too far apart; "" where they are not.

        Most capacities are known to lie between two runs only, whose intensities are farther apart
        than `COARSE` dispersions: the result rests on the lognormal shape.
        """
        ratio = self.estimate.ratio
        if len(self.parts) > 1 or not np.log(ratio) > COARSE * self.dispersion:
            return ""
        return (
            f"{self.estimate.between} capacities of single curves lie between intensities with the "
            f"ratio {ratio:.3g}, which is wide for a dispersion of {self.dispersion:.2g}: median "
            "and dispersion rest on the lognormal shape; add intensities between"
        )

    @property
    def few_mixed(self) -> str:
        """Why the dispersion of stripes is hardly determined; "" where it is.

        Intensities at which no run or all runs exceed the capacity say little of it, so that fewer
        than `LEAST_MIXED` others leave bootstrap samples with separated levels.
        """
        shares = self.counts["beyond"] / self.counts["runs"]
        mixed = int(((shares > 0.0) & (shares < 1.0)).sum())
        in_stripes = self.method == "stripes" and self.counts["runs"].min() >= LEAST_AT_LEVEL
        if not in_stripes or not self.has_median or mixed >= LEAST_MIXED:
            return ""
        verb = "intensity has" if mixed == 1 else "intensities have"
        return (
            f"{mixed} {verb} exceedances and non-exceedances: dispersion and band rest on them, "
            "so that intensities near the median are worth adding"
        )

    @cached_property
    def comparison(self) -> "pd.DataFrame":
        """Counts of runs with the share of the curve and its binomial interval.

        See `comparison.compare_counts`; of IDA the counts are those of single curves.
        """
        counts = self.counts if self.reached is None else self.reached
        return compare_counts(counts, self.intensity, self.probability, self.level)

    @cached_property
    def contradiction(self) -> Contradiction | None:
        """The count of the runs behind one curve that contradicts it most; None where none does."""
        if len(self.parts) > 1 or not self.estimate.known:
            return None
        return find_contradiction(self.comparison)

    @property
    def misfit_words(self) -> str:
        """Which count contradicts the curve, or which curves of several; "" where none does."""
        if self.contradiction is None:
            names = joined(self.contradicted)
            return f"it is the mean of curves that do ({names})" if names else ""
        first, last, beyond, runs, low, high = self.contradiction
        place = with_intensity_unit(last, UNITS.get(self.intensity, ""))
        place = f"at {place}" if first == last else f"from {first:.4g} to {place}"
        return (
            f"{place} {beyond} of {runs} {self._exceeding} the capacity, where the curve has "
            f"{low} to {high}"
        )

    @property
    def _exceeding(self) -> str:
        return "runs exceed" if self.reached is None else "single curves reach"

    @property
    def half_words(self) -> str:
        """Between which intensities half of the runs exceed the capacity; "" if unknown."""
        ends = None if len(self.parts) > 1 else find_half(self.comparison)
        if ends is None:
            return ""
        high = with_intensity_unit(ends[1], UNITS.get(self.intensity, ""))
        return f"half of the {self._exceeding} it between {ends[0]:.4g} and {high}"

    @property
    def misfit(self) -> str:
        """Why the curve contradicts the exceedances of its runs; "" where it does not."""
        sentence = f"{CONTRADICTS}: {self.misfit_words}" if self.misfit_words else ""
        if self.contradiction is None:
            return sentence
        return (
            f"{sentence} (binomial, {percent(self.level)} for all {len(self.comparison)} "
            f"counts together, of independent runs); "
            + "; ".join(filter(None, [self.half_words, INSTEAD[self.method]]))
        )

    def probability(self, intensity: Any) -> Floats:
        """Return the probability at intensities; NaN where the share does not rise with them."""
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        if not self.is_rising:
            return np.full(len(at), np.nan)
        return np.asarray(sum(share * estimate.probability(at) for share, estimate in self.parts))

    def family(self, intensity: Any, *, drawn: bool = False) -> Floats:
        """Return that of all curves of the band [curves, intensities], or those that were drawn."""
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        parts = ((share, (drawn and estimate.drawn) or estimate) for share, estimate in self.parts)
        return np.asarray(sum(share * estimate.family(at) for share, estimate in parts))

    def ends(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the ends of the band of a number that was computed from each curve of `family`."""
        if not self.is_rising:
            missing = np.full(values.shape[1:], np.nan)
            return missing, missing
        return percentiles(values, self.level)

    def band_at(self, intensity: Any) -> tuple[Floats, Floats]:
        """Return the ends of the band of the probability at each intensity."""
        return self.ends(self.family(intensity))

    def row(self) -> dict[str, Any]:
        """Return the parameters of one lognormal curve with their bands, as a row of a table."""
        median_low = median_high = dispersion_low = dispersion_high = np.nan
        # The mean of several curves is no lognormal one, and has no band of its parameters.
        is_one = len(self.parts) == 1
        if is_one and self.estimate.outcome == NONE_BEYOND:
            # The curves of the bound have an assumed dispersion, which the median does not need.
            median_low, median_high = self.estimate.least_median, np.inf
        if is_one and self.estimate.known:
            # A sample in which no run exceeds the capacity has an infinite place, and so may the
            # end of the band.
            medians = np.exp(np.minimum(self.estimate.medians, LARGEST_LOGARITHM))
            median_low, median_high = (float(end[0]) for end in self.ends(medians[:, None]))
            if not median_high < np.exp(LARGEST_LOGARITHM):
                median_high = np.inf
            ends = self.ends(self.estimate.dispersions[:, None])
            dispersion_low, dispersion_high = (float(end[0]) for end in ends)
            # Beyond half the dispersion of a flat curve, the end is that of flat curves.
            if dispersion_high >= 0.5 / FLAT:
                dispersion_high = np.inf
        return {
            "name": self.name,
            "method": self.method,
            "capacity": self.capacity,
            "median": self.median,
            "median_low": median_low,
            "median_high": median_high,
            "dispersion": self.dispersion,
            "dispersion_low": dispersion_low,
            "dispersion_high": dispersion_high,
            "runs": self.runs,
            "all_runs": self.runs + self.left_out,
            "beyond": int(self.counts["beyond"].sum()),
            "left_out": self.left_out,
            "collapsed": self.collapsed,
            "computed": self.computed,
            "larger": self.larger,
            "outcome": self.outcome,
            "sentence": self.estimate.sentence or self.sentence,
        }


def combine_curves(
    curves: Mapping[float, Fragility], shares: Any, name: str = "climate"
) -> Fragility:
    """Return the mean of the curves of some temperatures, each by its share of the time."""
    fragilities, shares = list(curves.values()), np.asarray(shares, dtype=float)
    if len(shares) != len(fragilities) or (shares < 0.0).any() or abs(shares.sum() - 1.0) > 1e-9:
        raise InputError("each temperature needs a share of the time; their sum must be 1")
    if len({len(curve.estimate.samples.place) for curve in fragilities}) > 1:
        raise InputError("the curves of a climate need the same number of bootstrap samples")
    weighted = list(zip(shares.tolist(), fragilities, strict=True))
    counts = pd.concat([curve.counts for curve in fragilities])
    return replace(
        fragilities[0],
        name=name,
        parts=[(share, curve.estimate) for share, curve in weighted if share > 0.0],
        runs=sum(curve.runs for curve in fragilities),
        counts=counts.groupby(fragilities[0].intensity, as_index=False).agg(
            {"runs": "sum", "beyond": "sum", "first": "min", "last": "max"}
        ),
        left_out=sum(curve.left_out for curve in fragilities),
        collapsed=sum(curve.collapsed for curve in fragilities),
        computed=sum(curve.computed for curve in fragilities),
        larger=sum(curve.larger for curve in fragilities),
        incomplete={},  # those of the temperatures stay with their curves
        reached=None,
        shares=dict(zip(curves, shares.tolist(), strict=True)),
        contradicted=[
            curve.name for share, curve in weighted if share > 0.0 and curve.contradiction
        ],
    )


class Options(TypedDict, total=False):
    """Keyword arguments of fragility curves."""

    method: Method  # "stripes" by default
    failed: Failed  # treatment of failed runs: "computed" (default), "left-out" or "collapse"
    groups: str | None  # column whose values the bootstrap resamples; None: single runs
    curves: Sequence[str]  # columns that identify curves of the method "ida"
    level: float  # confidence of the bands, 0.95 by default
    samples: int  # of the bootstrap
    seed: int  # of the bootstrap


DEFAULTS: dict[str, Any] = {
    "method": "stripes",
    "failed": COMPUTED,
    "groups": MOTION,
    "curves": (MOTION,),
    "level": LEVEL,
    "samples": SAMPLES,
    "seed": 0,
}


def fragility_curve(
    table: "pd.DataFrame",
    demand: str,
    capacity: float,
    intensity: str,
    *,
    name: str = "",
    **options: Unpack[Options],
) -> Fragility:
    """Return a fragility curve from a table of runs; the column `outcome` marks failed ones."""
    draw, settings = _resample(table, options)
    return _fragility(table, draw, name, demand, capacity, intensity, **settings)


def fragility_curves(
    table: "pd.DataFrame",
    demand: str,
    capacity: float,
    intensity: str,
    by: str,
    **options: Unpack[Options],
) -> dict[Any, Fragility]:
    """Return a curve for each value of a column; the bootstrap draws the same motions for all."""
    draw, settings = _resample(table, options)
    codes, values = levels(column(table, by))
    numbered = list(enumerate(values))
    if all(isinstance(value, int | float) for value in values):
        numbered.sort(key=itemgetter(1))
    curves = {}
    for number, value in numbered:
        selected = codes == number
        name = f"{value:g}" if isinstance(value, float) else str(value)
        try:
            curves[value] = _fragility(
                table[selected], draw.of(selected), name, demand, capacity, intensity, **settings
            )
        except InputError as error:
            raise InputError(error.problems, f"{by} = {name}") from None
    return curves


def _resample(table: "pd.DataFrame", settings: Options) -> tuple[Draw, dict[str, Any]]:
    """Return the bootstrap of options, and the other options."""
    options = {**DEFAULTS, **settings}
    groups = options.pop("groups")
    labels = table[groups] if groups is not None and groups in table else None
    draw = Draw.of_labels(labels, len(table), options.pop("samples"), options.pop("seed"))
    return draw, options


def _fragility(
    table: "pd.DataFrame",
    draw: Draw,
    name: str,
    demand: str,
    capacity: float,
    intensity: str,
    *,
    method: Method,
    failed: Failed,
    curves: Sequence[str],
    level: float,
) -> Fragility:
    check_level(level)
    if not (np.isfinite(capacity) and capacity > 0.0):
        raise InputError(f"capacity = {capacity:g} must be greater than 0")
    if method not in get_args(Method):
        raise InputError(f'method must be "stripes", "ida" or "cloud", not {method!r}')
    runs = counted(table, demand, failed, capacity)
    at = positive(runs.table, intensity)
    if len(np.unique(at)) < 2:
        raise InputError(
            f"all runs have {intensity} = {at[0]:g}: a curve needs at least two intensities"
        )
    draw = draw.of(runs.kept)
    beyond, reached = runs.demand >= capacity, None
    if method == "stripes":
        estimate = stripes(at, beyond, draw, UNITS.get(intensity, ""))
    elif method == "cloud":
        if (runs.demand <= 0.0).any():
            raise InputError(f'column "{demand}" has values without a logarithm (0 or less)')
        estimate = cloud(at, runs.demand, capacity, draw)
    else:
        ida = curves_of(runs, at, demand, intensity, curves)
        curve_groups = draw.groups[[curve.first for curve in ida.curves]]
        crossings = ida.crossings(capacity)
        estimate = incremental(crossings, curve_groups, draw, UNITS.get(intensity, ""))
        reached = reached_counts(crossings, at, intensity)
    estimate = _limited(_studentised(estimate, draw, at, level), draw, at, beyond, level)
    numbers = counts(at, beyond, intensity)
    if estimate.outcome in (APART, ALL_BEYOND):
        bounds = allowed_probabilities(numbers if reached is None else reached, intensity, level)
        estimate = replace(estimate, bounds=bounds)
    return Fragility(
        name=name,
        method=method,
        demand=demand,
        intensity=intensity,
        capacity=capacity,
        parts=[(1.0, estimate)],
        level=level,
        runs=len(runs.table),
        counts=numbers,
        left_out=runs.left_out,
        collapsed=runs.collapsed,
        computed=runs.computed,
        larger=runs.larger,
        incomplete=_incomplete(table[intensity].to_numpy(dtype=float), runs.kept),
        reached=reached,
    )


def _incomplete(at: Floats, kept: NDArray[np.bool_]) -> dict[float, tuple[int, int]]:
    """Return the number of runs that count and of all where more than `FEW_BEYOND` are left out."""
    levels, place = np.unique(at, return_inverse=True)
    if len(levels) > MOST_LEVELS:
        return {}
    runs = np.bincount(place)
    used = np.bincount(place, kept).astype(int)
    rows = zip(levels.tolist(), used.tolist(), runs.tolist(), strict=True)
    return {x: (part, count) for x, part, count in rows if count - part > FEW_BEYOND * count}


def _limited(
    estimate: Estimate, draw: Draw, at: Floats, beyond: NDArray[np.bool_], level: float
) -> Estimate:
    """Return the estimate with medians of its band between the levels that counts exclude.

    Where all runs of all n motions exceed the capacity, a probability below one half has a chance
    of at most 1 / 2^n (sign test: Conover 1999, 3.4): from six motions at 95 %, the median is not
    above that intensity, nor below one at which no run exceeds it. Few motions make the
    distribution of a bootstrap so wide that it contains such medians.
    """
    samples, best = estimate.samples, float(estimate.best.place[0])
    is_bounded = not draw.alone and estimate.known and estimate.collapse is None
    if not is_bounded or 0.5**draw.count > 0.5 * (1.0 - level):
        return estimate
    levels, place = np.unique(at, return_inverse=True)
    low, high = -np.inf, np.inf
    for number, intensity in enumerate(levels if len(levels) <= MOST_LEVELS else ()):
        here = place == number
        if len(np.unique(draw.groups[here])) < draw.count:
            continue
        if not beyond[here].any():
            low = float(np.log(intensity))
        elif beyond[here].all():
            high = min(high, float(np.log(intensity)))
    # The curve may have its own median there, of counts that do not rise with the intensity.
    place_in = np.clip(samples.place, min(low, best), max(high, best))
    return replace(estimate, samples=replace(samples, place=place_in))


def _studentised(estimate: Estimate, draw: Draw, at: Floats, level: float) -> Estimate:
    """Return the estimate with a band that is valid at `level`, also with few motions."""
    if estimate.outcome == NONE_BEYOND:
        # The last run of each motion has its largest intensity. Evenly spread probabilities make
        # the percentiles the bounds of Clopper & Pearson; samples have no order: they are shuffled.
        order = np.lexsort((at, draw.groups))
        last = np.append(np.diff(draw.groups[order]) > 0, True)
        ranks = np.random.default_rng(draw.seed).permutation(draw.samples)
        shares = (ranks + 0.5) / draw.samples
        largest = at[order][last]
        return replace(
            estimate,
            samples=unreached(largest, shares),
            groups=draw.count,
            least_median=least_median(largest, level),
        )
    samples = pivoted(estimate.best, estimate.samples, draw.count, level)
    collapses = estimate.collapses
    if estimate.collapse is not None and collapses is not None:
        collapses = pivoted(estimate.collapse, collapses, draw.count, level)
    return replace(
        estimate, samples=samples, collapses=collapses, drawn=estimate, groups=draw.count
    )
