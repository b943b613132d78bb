"""Demand of the runs of a study: which runs count, demand by temperature, the worst runs.

Failed runs never count as collapse in silence: they are left out and reported, or count where
that is asked for. The band of a median lies between the two ordered values that hold the true one
with the wanted confidence whatever the distribution (binomial: Conover 1999, Practical
Nonparametric Statistics, 3.2); it takes the runs as independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.core.records import Floats, Ints
from thermobearing.model.outcomes import PIER_BEYOND_LIMIT
from thermobearing.studies.definition.columns import AMBIENT
from thermobearing.studies.run.demand_parameters import BAD_INPUT, BROKEN, COMPLETED
from thermobearing.studies.statistics.bootstrap import LEVEL, check_level, quantile

Failed: TypeAlias = Literal["left-out", "collapse"]
OUTCOME = "outcome"
NEVER_RUN = (BAD_INPUT, BROKEN)  # they say nothing about the structure


@dataclass(frozen=True)
class Counted:
    """The runs that an estimate is made of."""

    table: pd.DataFrame  # their rows
    demand: Floats  # of each of them; infinite for a run that failed and counts as collapse
    left_out: int  # how many runs failed and are left out, or count as collapse
    collapsed: int
    kept: NDArray[np.bool_]  # whether each row of the full table counts, and whether it completed
    through: NDArray[np.bool_]

    @property
    def sentence(self) -> str:
        """How many runs there are, and how failed ones count."""
        return describe_all(len(self.table) + self.left_out, self.left_out, self.collapsed)


def describe_all(runs: int, left_out: int, collapsed: int) -> str:
    """Return how many runs failed and how they count: "2 of 40 runs failed and are left out"."""
    done = [
        f"{count} of {runs} runs failed and {what}"
        for count, what in ((left_out, "are left out"), (collapsed, "count as collapse"))
        if count
    ]
    return "; ".join(done) or f"all {runs} runs completed"


def counted(table: pd.DataFrame, demand: str, failed: Failed = "left-out") -> Counted:
    """Return the rows that count, with their demand.

    Without a column `outcome` all runs completed. Runs that could not start for their input or
    for a fault of the program are left out in any case. A run whose pier exceeded its limits
    exceeds every capacity of a pier; its other demands are those computed, but for "collapse".
    """
    if failed not in get_args(Failed):
        raise InputError(f'failed is "left-out" or "collapse", not {failed!r}')
    values = numbers(table, demand)
    through = np.ones(len(table), dtype=bool)
    pier = ~through  # runs whose pier exceeded its limits; all else in them was computed
    if OUTCOME in table:
        through = (table[OUTCOME] == COMPLETED).to_numpy(dtype=bool)
        pier = (table[OUTCOME] == PIER_BEYOND_LIMIT).to_numpy(dtype=bool)
    if failed == "left-out" and not demand.startswith("pier_"):
        through = through | pier
    missing = through & ~np.isfinite(values)
    if missing.any():
        raise InputError(
            f"{missing.sum()} of {through.sum()} completed runs have no number in "
            f'"{demand}"; take the runs that have one'
        )
    if not (through | pier).any():
        raise InputError(f"none of {len(table)} runs completed")
    kept = through | pier
    if failed == "collapse" and OUTCOME in table:
        kept = kept | ~table[OUTCOME].isin(NEVER_RUN).to_numpy(dtype=bool)
    demands = np.where(through, values, np.inf)[kept]
    collapsed = int(kept.sum() - through.sum())
    return Counted(table[kept], demands, int((~kept).sum()), collapsed, kept, through)


def column(table: pd.DataFrame, name: str) -> list[Any]:
    """Return a column as it is; InputError with the nearest name if there is none."""
    if name not in table:
        raise InputError(f'no column "{name}"{nearest(name, [str(k) for k in table.columns])}')
    return table[name].tolist()


def numbers(table: pd.DataFrame, name: str) -> Floats:
    """Return a column as numbers; InputError if it does not exist or holds something else."""
    values = column(table, name)
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f'column "{name}" does not hold numbers') from None


def positive(table: pd.DataFrame, name: str) -> Floats:
    """Return a column of positive numbers, whose logarithm is taken."""
    values = numbers(table, name)
    wrong = values[~(np.isfinite(values) & (values > 0.0))]
    if len(wrong):
        raise InputError(f'column "{name}" has {wrong[0]:g}; its logarithm is taken: above 0 only')
    return values


MOST_LEVELS = 20  # that have a row each; more numbers are put into classes
MOST_TEMPERATURES = 8  # with a curve each; more are put into classes
CLASSES = 4
CLASS = "temperature"  # column of such a class
FRACTILES = (0.05, 0.16, 0.5, 0.84, 0.95)
TEMPERATURE_CLASSES = 12  # of temperatures that are more than `MOST_LEVELS`


def equal_classes(values: Floats, count: int) -> Ints:
    """Return the class of each number, from 0, of so many that are equally filled."""
    rank = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return np.asarray(rank * count // len(values))


def in_classes(table: pd.DataFrame, by: str) -> tuple[pd.DataFrame, str]:
    """Return the table and the column whose values have a curve each, in their order.

    A temperature with many values is put into classes such as "-10 to -1 degC".
    """
    if by != AMBIENT or table[AMBIENT].nunique() <= MOST_TEMPERATURES:
        return table, by
    ordered = table.sort_values(AMBIENT, kind="stable")
    air = ordered[AMBIENT].to_numpy(dtype=float)
    place = equal_classes(air, CLASSES)
    names = np.empty(CLASSES, dtype=object)
    for k in range(CLASSES):
        mine = air[place == k]
        names[k] = f"{mine[0]:.0f} to {mine[-1]:.0f} °C".replace("-", "\N{MINUS SIGN}")
    return ordered.assign(**{CLASS: names[place]}), CLASS


def demand_against(
    table: pd.DataFrame,
    demand: str,
    across: str = AMBIENT,
    *,
    by: Sequence[str] = (),
    failed: Failed = "left-out",
    shares: Sequence[float] = FRACTILES,
    level: float = LEVEL,
) -> pd.DataFrame:
    """Return mean, fractiles (`shares`) and band of the median of a demand at each temperature.

    More than 20 different values of `across` are put into 12 classes of equally many runs, at
    their mean; the columns `by` have rows of their own. A collapse is an infinite demand.
    """
    check_level(level)
    runs = counted(table, demand, failed)
    at = numbers(table, across)
    values, place = np.unique(at, return_inverse=True)
    if len(values) > MOST_LEVELS:
        place = equal_classes(at, TEMPERATURE_CLASSES)
        values = np.bincount(place, at) / np.bincount(place)
    apart = list(zip(*(column(table, name) for name in by), strict=True)) or [()] * len(table)
    every = np.full(len(table), np.nan)
    every[runs.kept] = runs.demand
    cells: dict[tuple[Any, ...], list[int]] = {}
    for run, label in enumerate(apart):
        cells.setdefault((label, int(place[run])), []).append(run)
    rows = []
    order = {label: number for number, label in enumerate(dict.fromkeys(apart))}
    for label, cell in sorted(cells, key=lambda key: (order[key[0]], key[1])):
        mine = np.array(cells[label, cell])
        known = np.sort(every[mine][~np.isnan(every[mine])])
        row: dict[str, Any] = {**dict(zip(by, label, strict=True)), across: values[cell]}
        row |= {"runs": len(known), "failed": int((~runs.through[mine]).sum())}
        rows.append(row | _spread(known, shares, level))
    return pd.DataFrame(rows)


def _spread(known: Floats, shares: Sequence[float], level: float) -> dict[str, float]:
    names = [f"{share:g}" for share in shares]
    if len(known) == 0:
        return dict.fromkeys(["mean", *names, "median_low", "median_high"], np.nan)
    low, high = median_places(len(known), level)
    return {
        "mean": float(known.mean()),
        **{name: quantile(known, share) for name, share in zip(names, shares, strict=True)},
        "median_low": float(known[low]) if low >= 0 else -np.inf,
        "median_high": float(known[high]) if high < len(known) else np.inf,
    }


def median_places(count: int, level: float) -> tuple[int, int]:
    """Return places of ordered values between which the median lies with that confidence.

    >>> median_places(20, 0.95)  # the 6th and the 15th
    (5, 14)
    """
    from scipy.stats import binom  # takes a second to read; starting a study does without

    rest = int(binom.ppf(0.5 * (1.0 - level), count, 0.5))
    return rest - 1, count - rest


RANKED = ("pier_ductility", "pier_displacement_max_mm", "bearing_displacement_max_mm")
WORST = 10


def ranked_by(table: pd.DataFrame) -> str:
    """Return the column that runs are ranked by: the first of `RANKED` that has numbers."""
    found = [name for name in RANKED if name in table and table[name].notna().any()]
    if not found:
        raise InputError(f"what are runs to be ranked by? None of {', '.join(RANKED)} is there")
    return found[0]


def worst_runs(table: pd.DataFrame, count: int = WORST, by: str | None = None) -> list[int]:
    """Return the numbers of the completed runs with the largest demand, the worst first."""
    completed = table[table[OUTCOME] == COMPLETED]
    if len(completed) == 0:
        return []
    name = by or ranked_by(completed)
    order = pd.Series(numbers(completed, name), index=completed.index)
    worst = order.sort_values(ascending=False, kind="stable").index[:count]
    return [int(run) for run in completed.loc[worst, "run"]]
