"""Demand of the runs of a study: failed runs, demand by temperature, bootstrap, worst runs.

Failed runs count with the demand that was computed, where it was computed to the end, are left out,
or count as collapse, as the user chooses; each result reports their numbers. A run that stopped has
a demand of at least its last value: ordered values below the smallest of these are not affected.
The band of a median comes from the bootstrap over motions. Of one motion it lies between the two
ordered values that contain the true one with the wanted confidence for any distribution (binomial:
Conover 1999, Practical Nonparametric Statistics, 3.2), which takes the runs as independent.

Runs of one motion at several intensities and temperatures are not independent. The bootstrap
therefore resamples motions with all their runs (cluster bootstrap: Davison & Hinkley 1997,
Bootstrap Methods and their Application, 3.8). Bands are percentiles (Efron & Tibshirani 1993, An
Introduction to the Bootstrap, 13) of pivots, or at a level `widened` for few motions.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import scipy
from numpy.typing import NDArray

from thermobearing.bearing.model import calibration_ranges
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats, Ints
from thermobearing.cyclic.protocol import LARGEST_STRAIN
from thermobearing.earthquake.result import STRAIN
from thermobearing.model.outcomes import (
    CAVITATED,
    MELTED,
    NOT_PHYSICAL,
    PIER_BEYOND_LIMIT,
    UNSTABLE,
    UPLIFT,
)
from thermobearing.quantities.governing import order_from_largest
from thermobearing.quantities.warned import BEYOND_TESTS, NO_RANGE, UNTESTED, Warned
from thermobearing.quantities.words import joined, percent
from thermobearing.results.base import COMPLETED
from thermobearing.results.ranges import NO_RANGE_STATED, TESTED, Ends
from thermobearing.studies.definition.designs import AMBIENT
from thermobearing.studies.run.shard import BAD_INPUT, BEYOND_TESTED, BROKEN, DAMPING, LIMITS_PASSED

SAMPLES = 500  # of a bootstrap, by default
LEVEL = 0.95  # confidence of bands, by default
NOT_COMPARED = (
    "the table of runs has no column beyond_tested: its version did not compare runs with the "
    "calibration range; run the study again, or repeat a run"
)
FEW_BEYOND = 0.05  # of the runs: fewer do not move the fractiles that tables state
ROUNDING = 1e-9  # of a number of samples
LEAST_MOTIONS = 5  # our choice: a bootstrap of fewer gives no band
ANY = -np.inf  # capacity that every demand exceeds: runs that stopped count with all others
MOST_AT_ONCE = 2_000_000  # numbers of one piece of work


def check_level(level: float) -> None:
    """Raise InputError for a confidence level that is not between 0 and 1."""
    if not 0.0 < level < 1.0:
        raise InputError(f"level = {level:g} is not between 0 and 1")


@dataclass(frozen=True)
class Draw:
    """How the bootstrap resamples runs."""

    groups: Ints  # number of the group of each run
    count: int  # of groups
    samples: int  # of the bootstrap
    seed: tuple[int, ...]
    alone: bool  # every run is its own group

    @classmethod
    def of_labels(
        cls, labels: "pd.Series | None", runs: int, samples: int = SAMPLES, seed: int = 0
    ) -> "Draw":
        """Group runs by their labels; without labels, or with one label, each run is a group."""
        if samples < 1 or seed < 0:
            raise InputError(f"samples = {samples} and seed = {seed}: at least 1 and 0")
        codes = np.arange(runs)
        if labels is not None:
            codes = levels(labels)[0]
        if labels is None or codes.max(initial=0) == 0:
            # With one group a bootstrap would draw the same sample each time, and its band would
            # have no width.
            return cls(np.arange(runs), runs, samples, (seed,), True)
        return cls(codes, int(codes.max()) + 1, samples, (seed,), False)

    def of(self, kept: NDArray[np.bool_]) -> "Draw":
        """Return the draw of some of the runs; groups are drawn as before."""
        if not self.alone:
            return replace(self, groups=self.groups[kept])
        count = int(kept.sum())
        seed = (*self.seed, int(kept.argmax()))  # single runs need not be drawn like others
        return replace(self, groups=np.arange(count), count=count, seed=seed)

    def weights(self) -> Iterator[Floats]:
        """Yield how often each group is in each sample, shape (some samples, groups)."""
        rng = np.random.default_rng(self.seed)
        # Of 1e5 runs the weights of all samples take 400 MB: some samples at a time.
        chunk = max(1, MOST_AT_ONCE // max(self.count, 1))
        shares = np.full(self.count, 1.0 / self.count)
        for first in range(0, self.samples, chunk):
            rows = min(chunk, self.samples - first)
            yield rng.multinomial(self.count, shares, size=rows).astype(float)

    def sums(self, values: Floats) -> Floats:
        """Return the sums over the runs of each sample, from a row of values for each run."""
        group_values = np.zeros((self.count, values.shape[1]))
        # Runs of one motion are drawn together, since they are not independent; their sum is all
        # that a sample needs of them.
        np.add.at(group_values, self.groups, values)
        return self.group_sums(group_values)

    def group_sums(self, group_values: Floats) -> Floats:
        """Return the sums over the groups of each sample, from a row of values for each group."""
        return np.concatenate([weights @ group_values for weights in self.weights()])


def widened(level: float, groups: int) -> float:
    """Return the level whose percentiles contain the truth at `level`, also with few groups.

    Hesterberg (2015), The American Statistician 69(4): 371-386, 3.3: quantiles of Student's t, and
    sqrt(n / (n - 1)) because a bootstrap of n groups is too narrow by that factor.

    >>> round(widened(0.95, 12), 4), round(widened(0.95, 1000), 4)
    (0.9785, 0.9504)
    """
    if groups < 2:
        return level
    quantile_of_t = scipy.special.stdtrit(groups - 1.0, 0.5 * (1.0 + level))
    score = quantile_of_t * np.sqrt(groups / (groups - 1.0))
    return float(2.0 * scipy.special.ndtr(score) - 1.0)


def quantile(values: Floats, share: float) -> float:
    """Return a sample quantile, linear between values, some of which may be infinite.

    >>> quantile(np.array([1.0, 3.0, np.inf]), 0.5), quantile(np.array([1.0, 3.0, np.inf]), 0.75)
    (3.0, inf)
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    place = share * (len(ordered) - 1)
    low = int(np.floor(place))
    part = place - low
    # Rounding of the place must not bring in the next value, which may be infinite.
    if part < 1e-12 or low + 1 >= len(ordered):
        return float(ordered[low])
    if np.isinf(ordered[low : low + 2]).any():
        return float(ordered[low + 1] if np.isinf(ordered[low + 1]) else ordered[low])
    return float(ordered[low] + part * (ordered[low + 1] - ordered[low]))


def percentiles(samples: Floats, level: float) -> tuple[Floats, Floats]:
    """Return the ends of the central interval of samples (some infinite) along the first axis."""
    ordered = np.sort(samples, axis=0)
    # By whole samples and not between them: some may be infinite, whose mean with a number would be
    # infinite too.
    outside = max(int(0.5 * (1.0 - level) * (len(ordered) + 1) + ROUNDING), 1)
    return np.asarray(ordered[outside - 1]), np.asarray(ordered[-outside])


Failed: TypeAlias = Literal["computed", "left-out", "collapse"]
TREATMENTS: tuple[Failed, ...] = get_args(Failed)
COMPUTED: Failed = "computed"  # the treatment that is not stated
OUTCOME, MOTION = "outcome", "motion"
NEVER_RUN = (BAD_INPUT, BROKEN)  # they do not describe the structure


@dataclass(frozen=True)
class Counted:
    """The runs that an estimate is made of."""

    table: "pd.DataFrame"  # their rows
    demand: Floats  # of each of them; infinite for a run that counts as collapse
    left_out: int  # number of failed runs that are left out, that count as collapse, and that
    collapsed: int  # count with the demand that was computed
    computed: int
    larger: int  # number of the collapsed that stopped at a smaller demand
    kept: NDArray[np.bool_]  # whether each row of the full table counts, and whether it completed
    completed: NDArray[np.bool_]

    @property
    def sentence(self) -> str:
        """How many runs failed and how they count."""
        runs = len(self.table) + self.left_out
        return describe_failures(runs, self.left_out, self.collapsed, self.computed, self.larger)


def describe_failures(
    runs: int, left_out: int, collapsed: int, computed: int = 0, larger: int = 0
) -> str:
    """Return how many runs failed and how they count; `larger` are some of the `collapsed`.

    >>> describe_failures(40, 2, 0)
    '2 of 40 runs failed and are left out'
    >>> describe_failures(40, 2, 0, 3)
    '5 of 40 runs failed: 3 counted with the computed demand and 2 left out'
    """
    failed = left_out + collapsed + computed
    if not failed:
        return f"{runs} runs, none failed"
    counts = {
        "counted with the computed demand": computed,
        "counted as larger than their recorded value": larger,
        "left out": left_out,
        "counted as collapse": collapsed - larger,
    }
    parts = {treatment: count for treatment, count in counts.items() if count}
    verb = "is" if failed == 1 else "are"
    if len(parts) == 1:
        return f"{failed} of {runs} runs failed and {verb} {next(iter(parts))}"
    treatments = joined(f"{count} {treatment}" for treatment, count in parts.items())
    return f"{failed} of {runs} runs failed: {treatments}"


def failure_rule(demand: str, failed: Failed) -> str:
    """Return the one rule for failed runs in the statistics of a demand, as a sentence."""
    if failed == "collapse":
        return (
            'Failed runs count as collapse (failed = "collapse"). Runs with bad input are left out.'
        )
    of_pier = "A run whose pier exceeded its limits counts as collapse: it exceeds every capacity."
    if failed == COMPUTED:
        computed = "A run whose pier exceeded its limits counts with the demand that was computed."
        return (
            f"{of_pier if is_of_pier(demand) else computed} A run whose lead melted or whose "
            f"bearing passed {percent(LARGEST_STRAIN)} strain counts as larger than its recorded "
            "value. A fragility of a capacity above that value leaves it out "
            '(failed = "computed"; others are "left-out" and "collapse").'
        )
    pier = (
        f"{of_pier} Other failed runs"
        if is_of_pier(demand)
        else "Failed runs, also those whose pier exceeded its limits,"
    )
    return (
        f'{pier} are left out (failed = "left-out"). With "computed" the demand that was computed '
        'counts, with "collapse" they count as collapse.'
    )


def is_of_pier(demand: str) -> bool:
    """Return whether a demand is one of the pier, which a pier beyond its limits exceeds."""
    return demand.startswith("pier_")


def describe_selection(table: "pd.DataFrame", demand: str, failed: Failed) -> str:
    """Return which runs a result is of, if leaving some out limits what it is of; "" otherwise."""
    if failed != "left-out" or is_of_pier(demand) or not _computed_to_the_end(table).any():
        return ""
    return "runs whose pier stays within its limits"


WITH_NUMBERS = (COMPLETED, CAVITATED, UPLIFT)  # outcomes whose numbers are results


def counted(
    table: "pd.DataFrame",
    demand: str,
    failed: Failed = COMPUTED,
    capacity: float = np.nan,
) -> Counted:
    """Return the rows that count, with their demand.

    Without a column `outcome` all runs completed. Runs with bad input or a program error are
    always left out. A run whose pier exceeded its limits exceeds every capacity of a pier. It is
    computed to the end of the motion, so that its other demands count if `failed` is "computed".
    Then a run that stopped after it had reached `capacity` has an infinite demand; with `ANY`
    every run that stopped has.
    """
    if failed not in TREATMENTS:
        choices = " or ".join(f'"{name}"' for name in TREATMENTS)
        raise InputError(f"failed must be {choices}, not {failed!r}")
    values = _numbers(table, demand)
    completed = np.ones(len(table), dtype=bool)
    # `exceeding` are runs that exceed every level of this demand.
    exceeding = computed = stopped = ~completed
    if OUTCOME in table:
        completed = table[OUTCOME].isin(WITH_NUMBERS).to_numpy(dtype=bool)
        modes = (UNSTABLE, PIER_BEYOND_LIMIT) if is_of_pier(demand) else (UNSTABLE,)
        exceeding = table[OUTCOME].isin(modes).to_numpy(dtype=bool)
    if OUTCOME in table and failed == COMPUTED:
        computed = ~exceeding & _computed_to_the_end(table) & np.isfinite(values)
        stopped = ~exceeding & stopped_runs(table) & (values >= capacity)
        exceeding = exceeding | stopped
    _refuse_missing(values, completed, demand)
    kept = completed | exceeding | computed
    if not kept.any():
        raise InputError(f"none of {len(table)} runs completed")
    if failed == "collapse" and OUTCOME in table:
        kept = kept | ~table[OUTCOME].isin(NEVER_RUN).to_numpy(dtype=bool)
    # Infinite exceeds any capacity, so that quantiles and counts need no case for collapse.
    demands = np.where(completed | computed, values, np.inf)[kept]
    return Counted(
        table=table if kept.all() else table[kept],
        demand=demands,
        left_out=int((~kept).sum()),
        collapsed=int(np.isinf(demands).sum()),
        computed=int(computed.sum()),
        larger=int(stopped.sum()),
        kept=kept,
        completed=completed,
    )


def computed_demand(table: "pd.DataFrame", demand: str) -> Floats:
    """Return the demand of each row; NaN for runs that were not computed to the end of the motion.

    Statistics that need numbers, such as a variance, have no place for a collapse: a run whose
    pier exceeded its limits has the demand that was computed, also one of the pier.
    """
    values = _numbers(table, demand)
    if OUTCOME not in table:
        _refuse_missing(values, np.ones(len(table), dtype=bool), demand)
        return values
    completed = table[OUTCOME].isin(WITH_NUMBERS).to_numpy(dtype=bool)
    _refuse_missing(values, completed, demand)
    demands = np.where(completed | _computed_to_the_end(table), values, np.nan)
    return np.where(np.isfinite(demands), demands, np.nan)


def _computed_to_the_end(table: "pd.DataFrame") -> NDArray[np.bool_]:
    """Return which runs failed by a limit of the pier, beyond which the run goes on."""
    return np.asarray(table[OUTCOME] == PIER_BEYOND_LIMIT, dtype=bool)


def stopped_runs(table: "pd.DataFrame") -> NDArray[np.bool_]:
    """Return which runs passed a limit of a bearing, with peaks that are valid until then.

    One whose lead melts ends there; a torn one goes on to its end, as if it were not torn. Of a
    run that is not physical only a torn bearing leaves valid peaks: temperatures that do not
    exist and energy that is missing say that the numbers are wrong.
    """
    stopped = np.asarray(table[OUTCOME] == MELTED, dtype=bool)
    if STRAIN in table:
        torn = (table[OUTCOME] == NOT_PHYSICAL) & (table[STRAIN] > LARGEST_STRAIN)
        stopped = stopped | np.asarray(torn, dtype=bool)
    return stopped


def _refuse_missing(values: Floats, completed: NDArray[np.bool_], demand: str) -> None:
    """Raise InputError if a completed run has no number."""
    missing = completed & ~np.isfinite(values)
    if missing.any():
        raise InputError(
            f'{missing.sum()} of {completed.sum()} completed runs have no number in "{demand}"; '
            "select the runs that have one"
        )


def column(table: "pd.DataFrame", name: str) -> "pd.Series":
    """Return a column; InputError with the nearest name if there is none."""
    if name not in table:
        raise InputError(f'no column "{name}"{nearest(name, [str(k) for k in table.columns])}')
    return table[name]


def levels(values: "pd.Series") -> tuple[Ints, list[Any]]:
    """Return the number of the level of each run, and the levels in order of appearance."""
    codes, different = pd.factorize(values, use_na_sentinel=False)
    return np.asarray(codes, dtype=np.int64), different.tolist()


def combinations(table: "pd.DataFrame", by: Sequence[str]) -> tuple[Ints, list[tuple[Any, ...]]]:
    """Return the number of the combination of columns of each run, and all in order of appearance.

    Without columns there is one combination, ().
    """
    codes = np.zeros(len(table), dtype=np.int64)
    for name in by:
        level_codes, different = levels(column(table, name))
        codes = np.asarray(pd.factorize(codes * len(different) + level_codes)[0], dtype=np.int64)
    first_runs = np.unique(codes, return_index=True)[1]
    rows = table[list(by)].iloc[first_runs]
    return codes, list(zip(*(rows[name].tolist() for name in by), strict=True)) or [()]


def members(group: Ints) -> list[Ints]:
    """Return the places of each group that has any, by the number of the group."""
    order = np.argsort(group, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(group[order])) + 1) if len(order) else []


def _numbers(table: "pd.DataFrame", name: str) -> Floats:
    """Return a column of numbers; InputError if it does not exist or has other values."""
    values = column(table, name)
    try:
        return values.to_numpy(dtype=float)
    except (TypeError, ValueError):
        raise InputError(f'column "{name}" does not contain numbers') from None


def positive(table: "pd.DataFrame", name: str) -> Floats:
    """Return a column whose logarithm is used; InputError for a number that is not positive."""
    values = _numbers(table, name)
    wrong = values[~(np.isfinite(values) & (values > 0.0))]
    if len(wrong):
        raise InputError(f'column "{name}" has {wrong[0]:g}; it must be greater than 0')
    return values


MOST_LEVELS, TEMPERATURE_CLASSES = 20, 12  # rows of different values; classes of more values
MOST_TEMPERATURES, CLASSES = 8, 4  # temperatures with a curve each; classes of more temperatures
CLASS = "temperature"  # column of such a class
FRACTILES = (0.05, 0.16, 0.5, 0.84, 0.95)


def equal_classes(values: Floats, count: int) -> Ints:
    """Return the number of the class of each value, of `count` classes of equal size."""
    # By rank, since bounds between values would put equal ones into one class of any size.
    rank = np.empty(len(values), dtype=np.int64)
    rank[np.argsort(values, kind="stable")] = np.arange(len(values))
    return rank * count // len(values)


def in_classes(table: "pd.DataFrame", by: str) -> "tuple[pd.DataFrame, str]":
    """Return the table and the column of its curves: temperatures, or classes of more than 8."""
    if by != AMBIENT or table[AMBIENT].nunique() <= MOST_TEMPERATURES:
        return table, by
    ordered = table.sort_values(AMBIENT, kind="stable")
    ambient = ordered[AMBIENT].to_numpy(dtype=float)
    place = equal_classes(ambient, CLASSES)
    ends = [ambient[place == k][[0, -1]] for k in range(CLASSES)]
    names = [f"{a:.0f} to {b:.0f} °C".replace("-", "\N{MINUS SIGN}") for a, b in ends]
    return ordered.assign(**{CLASS: np.array(names, dtype=object)[place]}), CLASS


def demand_against(
    table: "pd.DataFrame",
    demand: str,
    across: str = AMBIENT,
    *,
    by: Sequence[str] = (),
    failed: Failed = COMPUTED,
    least: bool = False,
) -> "pd.DataFrame":
    """Return mean, `FRACTILES` and band of the median of a demand at each temperature.

    More than 20 different values of `across` are put into 12 classes of equal size, at their
    mean; each combination of the columns `by` has its rows. A collapse is an infinite demand, and
    so is that of a run that stopped, unless the `least` values are wanted: those with its last one.
    """
    runs = counted(table, demand, failed, ANY)
    abscissae = _numbers(table, across)
    values, place = np.unique(abscissae, return_inverse=True)
    if len(values) > MOST_LEVELS:
        place = equal_classes(abscissae, TEMPERATURE_CLASSES)
        values = np.bincount(place, abscissae) / np.bincount(place)
    demands = np.full(len(table), np.nan)
    demands[runs.kept] = runs.demand
    if least and failed == COMPUTED and OUTCOME in table:
        last_values = _numbers(table, demand)
        stopped = stopped_runs(table) & np.isfinite(last_values)
        demands[stopped] = last_values[stopped]
    draw = Draw.of_labels(column(table, MOTION) if MOTION in table else None, len(table))
    codes, labels = combinations(table, by)
    group = codes * len(values) + place
    rows = []
    for indices in members(group):
        combination, cell = divmod(int(group[indices[0]]), len(values))
        label = labels[combination]
        inside = indices[~np.isnan(demands[indices])]
        inside = inside[np.argsort(demands[inside], kind="stable")]
        row: dict[str, Any] = {**dict(zip(by, label, strict=True)), across: values[cell]}
        row |= {"runs": len(inside), "all_runs": len(indices)}
        row |= {"failed": int((~runs.completed[indices]).sum())}
        spread = _spread(demands[inside])
        if not draw.alone and len(inside):
            spread |= _median_band(demands[inside], replace(draw, groups=draw.groups[inside]))
        rows.append(row | spread)
    return pd.DataFrame(rows)


def _median_band(ordered: Floats, draw: Draw) -> dict[str, float]:
    """Return the band of the median of ordered values, from the bootstrap over motions."""
    groups = int(np.count_nonzero(np.bincount(draw.groups)))
    if groups < LEAST_MOTIONS:
        return {"median_low": np.nan, "median_high": np.nan}
    medians = [_medians(ordered, draw.groups, weights) for weights in draw.weights()]
    low, high = percentiles(np.concatenate(medians), widened(LEVEL, groups))
    return {"median_low": float(low), "median_high": float(high)}


def _medians(ordered: Floats, groups: Ints, weights: Floats) -> Floats:
    """Return the median of ordered values in each sample [samples, groups] that has any.

    It is the first value up to which there is half of the weight. Weights are whole numbers, whose
    sums are exact in any order: those at the ends of blocks give the block, and those inside it the
    value, without the sums up to every value.
    """
    count, motions = len(ordered), weights.shape[1]
    blocks = int(np.clip(np.sqrt(count), 1, max(MOST_AT_ONCE // motions, 1)))
    size = -(-count // blocks)
    blocks = -(-count // size)
    cells = np.arange(count) // size * motions + groups
    rows = np.bincount(cells, minlength=blocks * motions).reshape(blocks, motions)
    sums = weights @ rows.cumsum(axis=0).T.astype(float)
    # Motions without a run here may be drawn alone: such samples have no median.
    drawn = sums[:, -1] > 0.0
    weights, sums = weights[drawn], sums[drawn]
    half = 0.5 * sums[:, -1]
    block = (sums >= half[:, None]).argmax(axis=1)
    sample = np.arange(len(weights))
    before = np.where(block > 0, sums[sample, block - 1], 0.0)
    # Beyond the last value the last block repeats it, where the half is reached already.
    places = np.minimum(block[:, None] * size + np.arange(size), count - 1)
    inside = weights[sample[:, None], groups[places]].cumsum(axis=1)
    first = (before[:, None] + inside >= half[:, None]).argmax(axis=1)
    return np.asarray(ordered[places[sample, first]])


def _spread(ordered: Floats) -> dict[str, float]:
    names = [f"{share:g}" for share in FRACTILES]
    if len(ordered) == 0:
        return dict.fromkeys(["mean", *names, "median_low", "median_high"], np.nan)
    low, high = _median_places(len(ordered), LEVEL)
    return {
        "mean": float(ordered.mean()),
        **{name: quantile(ordered, share) for name, share in zip(names, FRACTILES, strict=True)},
        "median_low": float(ordered[low]) if low >= 0 else -np.inf,
        "median_high": float(ordered[high]) if high < len(ordered) else np.inf,
    }


def _median_places(count: int, level: float) -> tuple[int, int]:
    """Return the places of the ordered values that bound the median; (5, 14) of 20 at 0.95."""
    from scipy.stats import binom  # takes a second to read; starting a study does without

    # The number of values below the median is binomial with 1/2, whatever the distribution of the
    # demand.
    tail = int(binom.ppf(0.5 * (1.0 - level), count, 0.5))
    return tail - 1, count - tail


RANKED = ("pier_ductility", "pier_displacement_max_mm", "bearing_displacement_max_mm")
RANKED_OUTCOMES = (*WITH_NUMBERS, PIER_BEYOND_LIMIT)
WORST = 10


def ranked_by(table: "pd.DataFrame") -> str:
    """Return the column that ranks runs: the first of `RANKED` that has numbers."""
    for name in RANKED:
        if name in table and table[name].notna().any():
            return name
    raise InputError(f"runs cannot be ranked: none of {', '.join(RANKED)} has numbers")


def worst_runs(table: "pd.DataFrame", count: int = WORST, by: str | None = None) -> list[int]:
    """Return the numbers of the runs with the largest demand, in decreasing order.

    Also those whose pier exceeded its limits, and those that stopped, with their last values; no
    other failed runs.
    """
    ranked = table[OUTCOME].isin(RANKED_OUTCOMES).to_numpy(dtype=bool) | stopped_runs(table)
    if not ranked.any():
        return []
    by = by or ranked_by(table)
    runs = table[ranked & np.isfinite(_numbers(table, by))]
    order = order_from_largest(_numbers(runs, by))
    return [int(run) for run in runs["run"].iloc[order[:count]]]


# Column with the values of a limit, of which tables tell the side that a run is outside on.
SIDES = {"strain": STRAIN, "ambient": AMBIENT, "lead_temperature": "lead_max_degC"}
# Columns that statistics of a demand need besides it and the factors.
STATISTICS = (OUTCOME, "sentence", LIMITS_PASSED, BEYOND_TESTED, DAMPING, *RANKED, *SIDES.values())


def extrapolations(
    table: "pd.DataFrame",
    bearings: Sequence[Any],
    *,
    own_lines: bool = False,
    least: float = FEW_BEYOND,
) -> list[Warned]:
    """Return, for each bearing, how many runs leave its calibration range, if not few do.

    Counts the limits in the column `beyond_tested`, that with most runs first, if the share of
    runs that pass any is above `least`. With `own_lines` a limit may be that of another bearing of
    the run, so that its numbers are not stated.
    """
    warnings = []
    for level in bearings:
        columns = [name for name in (BEYOND_TESTED, *SIDES.values()) if name in table]
        runs = table.loc[(table["bearing"] == str(level.name)).to_numpy(dtype=bool), columns]
        bearing = getattr(level, "bearing", level)
        if not len(runs):
            continue
        ranges = calibration_ranges(bearing)
        if ranges is None or BEYOND_TESTED not in runs:
            missing = NO_RANGE_STATED if ranges is None else NOT_COMPARED
            warnings.append(Warned(missing, NO_RANGE, UNTESTED, level.name))
            continue
        # Of very many runs few texts differ.
        kinds, texts = pd.factorize(runs[BEYOND_TESTED], use_na_sentinel=False)
        passed = [set(str(text or "").split()) for text in texts]
        counts = _outside_by_limit(runs, passed, kinds, {} if own_lines else ranges)
        outside = int(np.array([bool(names) for names in passed])[kinds].sum())
        if outside > least * len(runs):
            by_count = sorted(counts.items(), key=lambda entry: -entry[1])
            stated = joined(f"{words} in {runs_outside}" for words, runs_outside in by_count)
            verb = "leave" if len(runs) > 1 else "leaves"
            sentence = (
                f"{outside} of {len(runs)} runs ({percent(outside / len(runs))}) {verb} the "
                f"calibration range; their results are extrapolated: {stated}"
            )
            warnings.append(Warned(sentence, BEYOND_TESTS, UNTESTED, level.name))
    return warnings


def _outside_by_limit(
    runs: "pd.DataFrame",
    passed: Sequence[set[str]],
    kinds: NDArray[np.intp],
    ranges: Mapping[str, Ends],
) -> Counter[str]:
    """Return the number of runs outside each limit, by its words: "strain below 50 %".

    `passed` has the limits that are passed by runs of each kind, `kinds` the kind of each run.
    """
    counts: Counter[str] = Counter()
    for limit in dict.fromkeys(name for names in passed for name in TESTED if name in names):
        _, title, factor, unit = TESTED[limit]
        outside = np.array([limit in names for names in passed])[kinds]
        if limit not in ranges:
            counts[title] = int(outside.sum())
            continue
        low, high = (factor * end for end in ranges[limit])
        if SIDES.get(limit) not in runs:
            counts[f"{title} outside {low:.3g} to {high:.3g}{unit}"] = int(outside.sum())
            continue
        above = outside & (factor * runs[SIDES[limit]].to_numpy(dtype=float) > high)
        counts[f"{title} above {high:.3g}{unit}"] = int(above.sum())
        counts[f"{title} below {low:.3g}{unit}"] = int((outside & ~above).sum())
    return +counts  # without zeros
