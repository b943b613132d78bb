"""Sensitivity of a demand: the share of each factor in its variance.

From Saltelli's arrangement (matrices A and B, and A with one column of B): Sobol' indices, of first
order by Saltelli, Annoni, Azzini, Campolongo, Ratto & Tarantola (2010, Computer Physics
Communications 181(2): 259-270, Table 2 b) and total by Jansen (1999; the same table, f). They equal
those of `scipy.stats.sobol_indices`, which accepts powers of two only; here a sample with a failed
run is removed from all matrices. The bootstrap resamples samples.

From any other design: the correlation ratio of each factor, which is the variance of the means over
its levels (numbers without levels: over classes of equal size), corrected for chance (epsilon
squared: Kelley 1935, PNAS 21: 554-559). In a full factorial design the ratios and the interaction
add up to one.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats, Ints
from thermobearing.quantities.words import joined
from thermobearing.studies.statistics.demand import (
    FEW_BEYOND,
    LEVEL,
    MOST_LEVELS,
    ROUNDING,
    SAMPLES,
    Draw,
    column,
    computed_demand,
    equal_classes,
    in_classes,
    levels,
    percentiles,
)

MATRIX, SAMPLE = "matrix", "sample"
SWAPPED = "AB "
LEAST_ROWS = 8
MOST_CLASSES = 60
MOST_LOTS = 2000  # that the bootstrap draws from; of more runs, lots of several
SAMPLING_ERROR = -0.05  # of the variance; a share that is nothing may be as small
SELECTIVE = 1.5  # share of a level in the lost runs over that in all, from which it is named
WIDE = 0.2  # width of the band of an index, our choice
REST = "interaction and rest"  # row of the interaction of factors


def _sobol_indices(
    a: Floats, b: Floats, swapped: Floats, draw: Draw | None = None
) -> tuple[Floats, Floats]:
    """Return first-order and total indices from A, B and [factors, rows] A with columns of B."""
    # About the mean of A and B, as in scipy.stats.sobol_indices.
    mean = np.concatenate([a, b]).mean()
    a, b, swapped = a - mean, b - mean, swapped - mean
    sums = np.column_stack(
        [np.ones(len(a)), a + b, a**2 + b**2, *(b * (swapped - a)), *(0.5 * (a - swapped) ** 2)]
    )
    parts = sums.sum(axis=0)[None, :] if draw is None else draw.sums(sums)
    count, total, squares = parts[:, 0], parts[:, 1], parts[:, 2]
    # Of the values of A and B together.
    variance = squares / (2.0 * count) - (total / (2.0 * count)) ** 2
    scale = (count * np.where(variance > 0.0, variance, np.nan))[:, None]
    factors = len(swapped)
    first_sums, total_sums = np.split(parts[:, 3:], [factors], axis=1)
    first_indices, total_indices = first_sums / scale, total_sums / scale
    return (first_indices[0], total_indices[0]) if draw is None else (first_indices, total_indices)


def sobol_table(
    table: "pd.DataFrame",
    demand: str,
    *,
    samples: int = SAMPLES,
    seed: int = 0,
) -> "pd.DataFrame":
    """Return Sobol' indices of every drawn factor of a study in Saltelli's arrangement.

    The table has the columns `matrix` ("A", "B", "AB <factor>") and `sample`, for one combination
    of levels. The result has `first` and `total` with their bands, `rows` and `left_out`.
    """
    demands = computed_demand(table, demand)
    matrix, sample = column(table, MATRIX), column(table, SAMPLE)
    factors = list(dict.fromkeys(m[len(SWAPPED) :] for m in matrix if m.startswith(SWAPPED)))
    names = ["A", "B", *(f"{SWAPPED}{factor}" for factor in factors)]
    place = {name: row for row, name in enumerate(names)}
    numbers = {value: k for k, value in enumerate(dict.fromkeys(sample))}
    values = np.full((len(names), len(numbers)), np.nan)
    if len(table) != values.size:
        raise InputError(
            f"{len(table)} runs do not form {len(names)} matrices of {len(numbers)} samples: "
            "select the runs of one combination of levels"
        )
    for value, name, number in zip(demands, matrix, sample, strict=True):
        values[place[name], numbers[number]] = value
    complete = np.isfinite(values).all(axis=0)
    if complete.sum() < LEAST_ROWS:
        raise InputError(
            f"{complete.sum()} of {len(complete)} samples are complete: {LEAST_ROWS} are needed"
        )
    values = values[:, complete]
    if np.ptp(values[:2]) == 0.0:
        raise InputError(f'"{demand}" is the same in all runs and has no variance')
    draw = Draw.of_labels(None, values.shape[1], samples, seed)
    first, total = _sobol_indices(values[0], values[1], values[2:])
    firsts, totals = _sobol_indices(values[0], values[1], values[2:], draw)
    first_low, first_high = percentiles(firsts, LEVEL)
    total_low, total_high = percentiles(totals, LEVEL)
    columns: dict[str, Any] = {
        "factor": factors,
        "first": first,
        "first_low": first_low,
        "first_high": first_high,
        "total": total,
        "total_low": total_low,
        "total_high": total_high,
    }
    return pd.DataFrame(columns).assign(rows=int(complete.sum()), left_out=int((~complete).sum()))


def variance_shares(
    table: "pd.DataFrame",
    demand: str,
    factors: Sequence[str],
    *,
    together: Sequence[str] = (),
    samples: int = SAMPLES,
    seed: int = 0,
) -> "pd.DataFrame":
    """Return the share of the variance that each factor explains alone (correlation ratio).

    The factors `together` have the same draws and therefore one share. The last row is the
    interaction, and what else no factor explains alone. Failed runs without a demand that was
    computed to the end are left out, those that count as collapse too: a variance needs numbers.
    """
    demands = computed_demand(table, demand)
    finite = np.isfinite(demands)
    left_out, values = int((~finite).sum()), demands[finite]
    values = values - values.mean() if len(values) else values
    if len(values) < LEAST_ROWS or np.ptp(values) == 0.0:
        raise InputError(
            f'"{demand}" has {len(values)} values: at least {LEAST_ROWS} that differ are needed'
        )
    separate_factors = [factor for factor in factors if len(together) < 2 or factor not in together]
    codes = [_codes(column(table, factor)[finite]) for factor in separate_factors]
    if len(separate_factors) < len(factors):
        separate_factors.append(", ".join(together))
        codes.append(levels(table[SAMPLE][finite])[0])
    lot = np.arange(len(values))
    if len(values) > MOST_LOTS:
        lot = np.random.default_rng(seed).permutation(len(values)) % MOST_LOTS
    cells = [_cells(values, code, lot) for code in codes]
    unit_weights = np.ones((1, int(lot.max()) + 1))
    estimates = np.array([_ratios(cell, unit_weights)[0] for cell in cells])
    draw = Draw.of_labels(None, unit_weights.shape[1], samples, seed)
    resampled = np.concatenate(
        [np.column_stack([_ratios(cell, weights) for cell in cells]) for weights in draw.weights()]
    )
    shares = np.append(estimates, max(1.0 - estimates.sum(), 0.0))
    resampled = np.column_stack([resampled, np.maximum(1.0 - resampled.sum(axis=1), 0.0)])
    # Runs that are drawn twice make classes look uniform: the samples are moved to the estimate.
    low, high = percentiles(resampled - resampled.mean(axis=0) + shares, LEVEL)
    columns: dict[str, Any] = {
        "factor": [*separate_factors, REST],
        "share": shares,
        "share_low": low,
        "share_high": high,
        "levels": [*(int(code.max()) + 1 for code in codes), 0],
    }
    return pd.DataFrame(columns).assign(rows=len(values), left_out=left_out)


class Lost(NamedTuple):
    """Runs or samples that a variance lacks, since their demand was not computed to the end."""

    missing: int  # number of samples of Saltelli's arrangement, of runs otherwise
    total: int
    unit: str  # "samples" or "runs"
    concentration: str  # where most of the runs are: "11 of 12 runs have motion jra-i-i-3", or ""

    @property
    def many(self) -> bool:
        """Whether they change the shares."""
        return self.missing > FEW_BEYOND * self.total

    @property
    def sentence(self) -> str:
        """How many are left out, where they are, and what that means where they are many."""
        sentences = [f"{self.total - self.missing} {self.unit}, {self.missing} failed and left out"]
        if self.many:
            sentences += [
                "Runs beyond a limit of their bearing have the largest demands",
                "These are missing in the shares, and bands do not contain that error",
            ]
        return ". ".join(filter(None, [*sentences, self.concentration]))


def find_lost(
    table: "pd.DataFrame", demand: str, factors: Mapping[str, tuple[str, str]], *, sobol: bool
) -> Lost:
    """Return how many runs have no demand that was computed to the end, or samples of Sobol'.

    `factors` are words and unit of factors by their columns.
    """
    lost = np.isnan(computed_demand(table, demand))
    concentration = _concentration(table, lost, factors)
    if not sobol:
        return Lost(int(lost.sum()), len(table), "runs", concentration)
    samples = table[SAMPLE]
    return Lost(samples[lost].nunique(), samples.nunique(), "samples", concentration)


def _concentration(
    table: "pd.DataFrame", lost: NDArray[np.bool_], factors: Mapping[str, tuple[str, str]]
) -> str:
    """Return the levels of factors that have far more of the lost runs than of all runs."""
    total, texts = int(lost.sum()), []
    for factor, (words, unit) in factors.items() if total >= LEAST_ROWS else ():
        runs, name = in_classes(table[[factor]], factor)
        codes, different = levels(runs[name])
        if not 2 <= len(different) <= MOST_LEVELS:
            continue
        counts = np.bincount(codes)
        of_lost = np.bincount(codes[lost[runs.index]], minlength=len(different))
        highest = int(of_lost.argmax())
        level, most = different[highest], int(of_lost[highest])
        if most * len(table) > SELECTIVE * total * int(counts[highest]):
            stated = f"{level:.4g} {unit}".rstrip() if isinstance(level, float) else str(level)
            texts.append(f"{most} have {words} {stated}")
    return f"Of {total} failed runs {joined(texts)}" if texts else ""


def wide_note(indices: "pd.DataFrame") -> str:
    """Return how wide the bands of Sobol' indices are, with a remedy, or "".

    The variance of an index decreases as 1/n with the number of samples.

    >>> row = {"factor": ["ambient"], "first": [0.3], "first_low": [0.1], "first_high": [0.5]}
    >>> wide_note(pd.DataFrame(row).assign(rows=128)).partition(": ")[2]
    'first-order up to 0.40 (ambient), which some 512 samples make 0.2'
    """
    texts, rows = [], int(indices["rows"].iloc[0])
    for kind, words in (("first", "first-order"), ("total", "total")):
        if f"{kind}_low" not in indices:
            continue
        widths = (indices[f"{kind}_high"] - indices[f"{kind}_low"]).to_numpy(dtype=float)
        widest, factor = float(widths.max()), indices["factor"].iloc[int(widths.argmax())]
        if widest > WIDE:
            needed = 2 ** math.ceil(math.log2(rows * (widest / WIDE) ** 2) - ROUNDING)
            remedy = f"which some {needed} samples make {WIDE:g}"
            texts.append(f"{words} up to {widest:.2f} ({factor}), {remedy}")
    return f"bands of Sobol' indices of {rows} samples are wide: {'; '.join(texts)}" * bool(texts)


def sampling_note(contributions: "pd.DataFrame") -> str:
    """Return a sentence if contributions are visibly wrong because of too few runs, or ""."""
    if "total" in contributions and (contributions["total"] < contributions["first"]).any():
        return "A total index below the first-order index is a sampling error: use more samples."
    if "share" in contributions and (contributions["share"] < SAMPLING_ERROR).any():
        return (
            "A share below zero is a sampling error, as of a few runs of each paired draw: "
            "use more motions or levels, or paired = false in [design]."
        )
    return ""


def _codes(values: "pd.Series") -> Ints:
    """Return the class of each run: its level, or one of several classes of numbers."""
    codes, different = levels(values)
    is_of_numbers = values.dtype.kind in "iuf" or all(isinstance(v, int | float) for v in different)
    if len(different) <= MOST_LEVELS or not is_of_numbers:
        return codes
    numbers = values.to_numpy(dtype=float)
    finite = ~np.isnan(numbers)
    codes = np.zeros(len(numbers), dtype=np.int64)
    classes = min(int(np.sqrt(finite.sum())), MOST_CLASSES)
    # Runs without a number are class 0.
    codes[finite] = equal_classes(numbers[finite], classes) + int(not finite.all())
    return codes


def _cells(values: Floats, codes: Ints, lot: Ints) -> tuple[Floats, Floats, Floats]:
    """Return count and sum of each class in each lot of runs, and the sum of squares of the lot."""
    lots, classes = int(lot.max()) + 1, int(codes.max()) + 1
    place = lot * classes + codes
    count = np.bincount(place, minlength=lots * classes).astype(float)
    sums = np.bincount(place, values, minlength=lots * classes).astype(float)
    squares = np.bincount(lot, values**2, minlength=lots).astype(float)
    return count.reshape(lots, classes), sums.reshape(lots, classes), squares[:, None]


def _ratios(cells: tuple[Floats, Floats, Floats], weights: Floats) -> Floats:
    """Return epsilon squared for each row of weights of the lots."""
    # 1 - (SS_within / (n - k)) / (SS_total / (n - 1)) of n runs in k classes.
    count, sums, second = (weights @ part for part in cells)
    total, first = count.sum(axis=1), sums.sum(axis=1)
    squares = second[:, 0] - first**2 / total
    between = (sums**2 / np.maximum(count, 1.0)).sum(axis=1) - first**2 / total
    classes = (count > 0.0).sum(axis=1)
    within = np.maximum(squares - between, 0.0) / np.maximum(total - classes, 1.0)
    return np.asarray(1.0 - within * (total - 1.0) / np.where(squares > 0.0, squares, np.nan))
